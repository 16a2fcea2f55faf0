/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Random networks of masses and springs, many of them 0 in the original or at a bound, and
 * random questions. Whatever is claimed of them is held against dense sampling: K and M are set
 * up here from the list of springs, eigenvalues found by Jacobi rotations, and modes counted by
 * the rank of K where every spring that can be there is.
 */
#include <stdarg.h>

#include "study_fixture.h"
#include "support/mt_random.h"

enum {
    MOST_MASSES = 4,
    MOST_SPRINGS = 7,
    STUDIES = 160,
    SAMPLES = 300,
    MOST_KINDS = 64,
    TEXT = 8192
};

typedef struct spring {
    int a; /* -1: ground */
    int b;
    double original;
    bool varies;
    double lower;
    double upper;
    bool catalogue; /* lower, a third, upper */
} spring;

typedef struct network {
    int n;
    double m[MOST_MASSES];
    int n_springs;
    spring springs[MOST_SPRINGS];
    int n_rigid;
    bool bands;
    double edge[2]; /* of the band; or at least, at most (NaN: none) */
    int mode;       /* of the limit */
} network;

/* Eigenvalues of M^-1/2 K M^-1/2 for stiffnesses k, ascending; rotations until what is off the
 * diagonal is rounding. */
static void eigenvalues(const network *w, const double *k, double *lambda)
{
    double a[MOST_MASSES][MOST_MASSES] = {{0.0}};
    for (int s = 0; s < w->n_springs; s++) {
        const int i = w->springs[s].a;
        const int j = w->springs[s].b;
        a[j][j] += k[s] / w->m[j];
        if (i >= 0) {
            a[i][i] += k[s] / w->m[i];
            a[i][j] -= k[s] / sqrt(w->m[i] * w->m[j]);
            a[j][i] = a[i][j];
        }
    }
    for (int sweep = 0; sweep < 30; sweep++) {
        for (int p = 0; p < w->n; p++) {
            for (int q = p + 1; q < w->n; q++) {
                const double theta = 0.5 * atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
                const double c = cos(theta);
                const double s = sin(theta);
                for (int r = 0; r < w->n; r++) {
                    const double x = a[r][p];
                    const double y = a[r][q];
                    a[r][p] = (c * x) - (s * y);
                    a[r][q] = (s * x) + (c * y);
                }
                for (int r = 0; r < w->n; r++) {
                    const double x = a[p][r];
                    const double y = a[q][r];
                    a[p][r] = (c * x) - (s * y);
                    a[q][r] = (s * x) + (c * y);
                }
            }
        }
    }
    for (int i = 0; i < w->n; i++) {
        int at = i;
        for (; at > 0 && lambda[at - 1] > a[i][i]; at--) {
            lambda[at] = lambda[at - 1];
        }
        lambda[at] = a[i][i];
    }
}

/* Below this part of the highest frequency null_of takes one for 0. */
static const double NO_PART = 4e-5;

/* Null directions: eigenvalues that are rounding beside the largest. */
static int null_of(const network *w, const double *lambda)
{
    int n = 0;
    while (n < w->n && lambda[n] <= 1e-9 * lambda[w->n - 1]) {
        n++;
    }
    return n;
}

/* Frequencies of the vibration modes; how many there are. */
static int frequencies(const network *w, const double *k, double *hz)
{
    double lambda[MOST_MASSES];
    eigenvalues(w, k, lambda);
    for (int i = 0; i < null_of(w, lambda); i++) {
        lambda[i] = 0.0;
    }
    for (int i = w->n_rigid; i < w->n; i++) {
        hz[i - w->n_rigid] = study_hz(lambda[i]);
    }
    return w->n - w->n_rigid;
}

static double some_stiffness(mt_random *r)
{
    return pow(10.0, mt_random_in(r, 1.0, 3.0));
}

static void make_springs(mt_random *r, network *w)
{
    for (int s = 0; s < w->n_springs; s++) {
        spring *const one = &w->springs[s];
        /* the first ones are a chain, so that most networks hang together; then anything */
        one->b = s < w->n ? s : mt_random_int(r, w->n);
        one->a = s < w->n ? s - 1 : mt_random_int(r, w->n + 1) - 1;
        one->a = one->a == one->b ? -1 : one->a;
        one->original = mt_random_int(r, 2) == 0 ? 0.0 : some_stiffness(r);
        one->varies = s == 0 || mt_random_int(r, 2) == 0;
        one->lower = mt_random_int(r, 2) == 0 ? 0.0 : 0.3 * some_stiffness(r);
        one->upper = one->lower + some_stiffness(r);
        one->catalogue = one->varies && mt_random_int(r, 8) == 0;
    }
}

static network make_network(mt_random *r)
{
    network w = {.n = 2 + mt_random_int(r, MOST_MASSES - 1)};
    double k[MOST_SPRINGS];
    double lambda[MOST_MASSES];
    w.n_springs = w.n + mt_random_int(r, MOST_SPRINGS - w.n + 1);
    for (int i = 0; i < w.n; i++) {
        w.m[i] = mt_random_in(r, 0.5, 2.0);
    }
    make_springs(r, &w);
    for (int s = 0; s < w.n_springs; s++) {
        k[s] = w.springs[s].varies ? w.springs[s].upper : w.springs[s].original;
    }
    eigenvalues(&w, k, lambda);
    w.n_rigid = null_of(&w, lambda);
    w.bands = mt_random_int(r, 2) == 0;
    w.mode = w.n_rigid == w.n ? 0 : 1 + mt_random_int(r, w.n - w.n_rigid);
    const double top = study_hz(lambda[w.n - 1]);
    const double from =
        w.bands && mt_random_int(r, 4) == 0 ? 0.0 : mt_random_in(r, 0.05, 0.6) * top;
    const int sides = mt_random_int(r, 3);
    w.edge[0] = w.bands || sides != 1 ? from : nan("");
    w.edge[1] = w.bands || sides != 0 ? from + (mt_random_in(r, 0.02, 0.4) * top) : nan("");
    return w;
}

static void add(char *text, const char *format, ...) MT_PRINTF(2, 3);

static void add(char *text, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text + used, TEXT - used, format, args);
    va_end(args);
}

static void write_model(const network *w, char *text)
{
    text[0] = '\0';
    add(text,
        "{'format': 'modetune-model/1', 'name': 'network', 'dimension': 2, 'parameters': {");
    for (int s = 0; s < w->n_springs; s++) {
        add(text, "%s'k%d': %.17g", s > 0 ? ", " : "", s, w->springs[s].original);
    }
    add(text, "}, 'bodies': [");
    for (int i = 0; i < w->n; i++) {
        add(text, "%s{'name': 'm%d', 'mass_kg': %.17g, 'centre': [%d, 0]}", i > 0 ? ", " : "",
            i, w->m[i], i + 1);
    }
    add(text, "], 'joints': [");
    for (int i = 0; i < w->n; i++) {
        add(text,
            "%s{'name': 'r%d', 'type': 'pin-in-slot', 'bodies': ['ground', 'm%d'], 'at': [%d, "
            "0], 'axis': [1, 0]}",
            i > 0 ? ", " : "", i, i, i + 1);
    }
    add(text, "], 'springs': [");
    for (int s = 0; s < w->n_springs; s++) {
        const spring *const one = &w->springs[s];
        char other[16] = "ground";
        if (one->a >= 0) {
            (void)snprintf(other, sizeof other, "m%d", one->a);
        }
        add(text,
            "%s{'name': 's%d', 'type': 'axial', 'bodies': ['%s', 'm%d'], 'at': [[%d, 0], [%d, "
            "0]], 'stiffness_n_per_m': 'k%d'}",
            s > 0 ? ", " : "", s, other, one->b, one->a + 1, one->b + 1, s);
    }
    add(text, "]}");
}

static void write_study(const network *w, char *text)
{
    const char *comma = "";
    text[0] = '\0';
    add(text, "'recommendations': 50, 'variables': [");
    for (int s = 0; s < w->n_springs; s++) {
        const spring *const one = &w->springs[s];
        if (one->varies && one->catalogue) {
            add(text, "%s{'parameter': 'k%d', 'catalogue': [%.17g, %.17g, %.17g]}", comma, s,
                one->lower, one->lower + ((one->upper - one->lower) / 3.0), one->upper);
        } else if (one->varies) {
            add(text, "%s{'parameter': 'k%d', 'lower': %.17g, 'upper': %.17g}", comma, s,
                one->lower, one->upper);
        }
        comma = one->varies ? ", " : comma;
    }
    if (w->bands) {
        add(text, "], 'goals': [{'type': 'avoid', 'bands_hz': [[%.17g, %.17g]]}]", w->edge[0],
            w->edge[1]);
        return;
    }
    add(text, "], 'goals': [{'type': 'frequency', 'mode': %d", w->mode);
    if (MT_HAS(w->edge[0])) {
        add(text, ", 'at_least_hz': %.17g", w->edge[0]);
    }
    if (MT_HAS(w->edge[1])) {
        add(text, ", 'at_most_hz': %.17g", w->edge[1]);
    }
    add(text, "}]");
}

/* Are the requirements met at k, with this much to spare (relative)? *below: modes below the
 * band. */
static bool meets(const network *w, const double *k, double spare, int *below)
{
    double hz[MOST_MASSES];
    const int n = frequencies(w, k, hz);
    *below = 0;
    for (int i = 0; i < n && w->bands; i++) {
        const bool under = hz[i] <= w->edge[0] * (1.0 - spare) && w->edge[0] > 0.0;
        *below += under ? 1 : 0;
        if (!under && hz[i] < w->edge[1] * (1.0 + spare)) {
            return false;
        }
    }
    return w->bands || (!(hz[w->mode - 1] < w->edge[0] * (1.0 + spare)) &&
                        !(hz[w->mode - 1] > w->edge[1] * (1.0 - spare)));
}

/* The design of recommendation r (NULL: the original). */
static void design_of(const network *w, const mt_recommendation *r, double *k)
{
    for (int s = 0; s < w->n_springs; s++) {
        k[s] = w->springs[s].original;
        for (int i = 0; r != NULL && i < r->n_parameters; i++) {
            char name[16];
            (void)snprintf(name, sizeof name, "k%d", s);
            k[s] =
                strcmp(r->parameters[i].name, name) == 0 ? r->parameters[i].recommended : k[s];
        }
    }
}

static void check_design(mt_test *t, const network *w, const mt_recommendation *r)
{
    double k[MOST_SPRINGS];
    double hz[MOST_MASSES];
    int below = 0;
    design_of(w, r, k);
    const int n = frequencies(w, k, hz);
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (CHECK(t, f->mode >= 1 && f->mode <= n)) {
            const double want = hz[f->mode - 1];
            CHECK(t, fabs(f->recommended_hz - want) <=
                         (1e-6 * want) + (want > 0.0 ? 0.0 : NO_PART * hz[n - 1]));
        }
    }
    CHECK(t, r->disagreement == NULL);
    if (r->feasible) {
        CHECK(t, meets(w, k, -2e-6, &below));
        CHECK(t, r->n_placements == 0 || r->placements[0].modes_below == below);
    }
}

/* A random design of the bounds: each spring anywhere, or at an end. */
static void sample(mt_random *r, const network *w, double *k)
{
    for (int s = 0; s < w->n_springs; s++) {
        const spring *const one = &w->springs[s];
        const int end = one->catalogue ? mt_random_int(r, 3) : mt_random_int(r, 6);
        const double range = one->upper - one->lower;
        const double part = end < 2          ? (double)end
                            : one->catalogue ? 1.0 / 3.0
                            : end == 2       ? pow(10.0, mt_random_in(r, -6.0, 0.0))
                                             : mt_random_in(r, 0.0, 1.0);
        k[s] = one->varies ? one->lower + (part * range) : one->original;
    }
}

static bool is_listed(const mt_result *result, int below)
{
    for (int i = 0; i < result->n_recommendations; i++) {
        const mt_recommendation *const r = &result->recommendations[i];
        if (r->feasible && r->n_placements == 1 && r->placements[0].modes_below == below) {
            return true;
        }
    }
    return false;
}

/* Ranges of modes, where certificates give them. */
static void check_ranges(mt_test *t, const network *w, const mt_result *result,
                         const double *hz)
{
    for (int i = 0; i < result->n_certificates && !w->bands; i++) {
        const mt_certificate *const c = &result->certificates[i];
        if (c->proven && MT_HAS(c->reachable_lower_hz)) {
            CHECK(t, hz[w->mode - 1] >= c->reachable_lower_hz * (1.0 - 1e-9));
            CHECK(t, hz[w->mode - 1] <= c->reachable_upper_hz * (1.0 + 1e-9));
        }
    }
}

static bool has_catalogue(const network *w)
{
    bool has = false;
    for (int s = 0; s < w->n_springs; s++) {
        has = has || w->springs[s].catalogue;
    }
    return has;
}

static bool proves_assignments(const mt_result *result)
{
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        if (c->proven && strcmp(c->kind, "gap_assignments") == 0) {
            return true;
        }
    }
    return false;
}

/* The tolerance box of a design: the requirements hold all over it. */
static void check_box(mt_test *t, mt_random *r, const network *w, const mt_recommendation *rec)
{
    double k[MOST_SPRINGS];
    double near[MOST_SPRINGS];
    const mt_tolerance_box *const box = rec->tolerance_box;
    design_of(w, rec, k);
    for (int i = 0; i < 20 && box != NULL && box->proven; i++) {
        int below = 0;
        for (int s = 0; s < w->n_springs; s++) {
            const double part = mt_random_int(r, 2) == 0 ? 1.0 : mt_random_in(r, 0.0, 1.0);
            const double sign = mt_random_int(r, 2) == 0 ? 1.0 : -1.0;
            const double way =
                w->springs[s].varies ? sign * part * box->all_percent / 100.0 : 0.0;
            near[s] = k[s] * (1.0 + way);
        }
        CHECK(t, meets(w, near, -2e-6, &below));
    }
}

static void check_claims(mt_test *t, mt_random *r, const network *w, const mt_result *result)
{
    int missed = 0;
    int unlisted = 0;
    /* with catalogues every combination is listed by its best design, not every assignment */
    const bool assignments = !has_catalogue(w) && proves_assignments(result);
    check_design(t, w, &result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        check_design(t, w, &result->recommendations[i]);
        check_box(t, r, w, &result->recommendations[i]);
    }
    for (int i = 0; i < SAMPLES; i++) {
        double k[MOST_SPRINGS];
        double hz[MOST_MASSES];
        int below = 0;
        sample(r, w, k);
        (void)frequencies(w, k, hz);
        check_ranges(t, w, result, hz);
        const bool met = meets(w, k, 1e-5, &below);
        missed += met && result->status != MT_RESULT_SOLVED ? 1 : 0;
        unlisted += met && assignments && !is_listed(result, below) ? 1 : 0;
    }
    CHECK_INT(t, missed, 0);
    CHECK_INT(t, unlisted, 0);
}

static void rank__claims_about_random_networks_hold_in_samples(mt_test *t)
{
    static char model[TEXT];
    static char members[TEXT];
    int statuses[4] = {0, 0, 0, 0};
    int asked = 0;
    for (int k = 0; k < STUDIES; k++) {
        mt_random r = mt_random_seed((uint64_t)k + 1);
        const network w = make_network(&r);
        study_case c;
        if (w.mode == 0) {
            continue; /* nothing vibrates */
        }
        write_model(&w, model);
        write_study(&w, members);
        mt_test_row(t, "network %d", k + 1);
        if (study_solve(t, model, members, &c)) {
            statuses[c.result->status]++;
            asked++;
            check_claims(t, &r, &w, c.result);
        }
        study_free(&c);
        if (t->failures > 20) {
            break;
        }
    }
    mt_test_row(t, "all");
    CHECK(t, asked > 9 * STUDIES / 10);
    CHECK(t, statuses[MT_RESULT_SOLVED] > asked / 4);
    CHECK(t, statuses[MT_RESULT_INFEASIBLE] > asked / 20);
}

MT_TEST_MAIN(MT_TEST(rank__claims_about_random_networks_hold_in_samples))
