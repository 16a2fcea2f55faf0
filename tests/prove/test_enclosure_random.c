/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Certificates against brute force: over many small random systems, no sampled design has what
 * a certificate excludes, and no design inside a tolerance box fails. Two configurations each:
 * chains of masses (free or held, springs and masses by expressions of parameters, also such in
 * which one occurs twice), and trusses whose areas enter stiffness and mass.
 */
#include <stdlib.h>

#include "mechanics/mech.h"
#include "mt_writer.h"
#include "prove/boxes.h"
#include "prove/certify.h"
#include "prove/tolerance.h"
#include "support/mt_random.h"

enum {
    TEXT = 8192,
    VIEWS = 2,
    BANDS = 3,
    SYSTEMS = 45,
    SYSTEMS_ALL = 120, /* with MT_EVERY=1 */
    SAMPLES = 250,
    INSIDE = 60,
    MODES = 8,
    HALVINGS = 24
};

typedef struct writer {
    mt_writer out;
    int n; /* parameters p0, p1, ... */
    double value[MECH_INPUTS];
    mt_random r;
} writer;

#define put(w, ...) mt_write(&(w)->out, __VA_ARGS__)

/* A new parameter; its number. Values are decided here, written at the end of the text. */
static int parameter(writer *w, double value)
{
    w->value[w->n] = value;
    return w->n++;
}

static void put_stiffness(writer *w)
{
    const double k = mt_random_in(&w->r, 5e3, 4e4);
    const int kind = mt_random_int(&w->r, 6);
    if (kind == 0 || w->n >= MECH_INPUTS - 4) {
        put(w, "\"stiffness_n_per_m\": %.6g", k);
        return;
    }
    const int p = parameter(w, kind == 4 ? mt_random_in(&w->r, 0.5, 1.5) : k);
    put(w, "\"stiffness_n_per_m\": \"");
    /* some forms use their parameter twice */
    switch (kind) {
    case 1:
        put(w, "p%d", p);
        break;
    case 2:
        put(w, "p%d*(1 + p%d/3e4)", p, p);
        break;
    case 3:
        put(w, "1/(1/p%d + 2e-5)", p);
        break;
    case 4:
        put(w, "5e3*exp(p%d)", p);
        break;
    default:
        put(w, "2e4*p%d/(1e4 + p%d)", p, p);
        break;
    }
    put(w, "\"");
}

static void put_mass(writer *w)
{
    const double m = mt_random_in(&w->r, 0.5, 2.0);
    if (mt_random_int(&w->r, 2) == 0 || w->n >= MECH_INPUTS - 4) {
        put(w, "\"mass_kg\": %.6g", m);
    } else {
        put(w, "\"mass_kg\": \"0.2 + p%d\"", parameter(w, m));
    }
}

static void put_parameters(writer *w)
{
    put(w, "\"parameters\": {");
    for (int i = 0; i < w->n; i++) {
        put(w, "%s\"p%d\": %.17g", i == 0 ? "" : ", ", i, w->value[i]);
    }
    put(w, "}, \"configurations\": {\"a\": {}, \"b\": {}}}");
}

static void chain(writer *w)
{
    const int n = 2 + mt_random_int(&w->r, 4);
    const bool free_start = mt_random_int(&w->r, 3) == 0;
    put(w, "{\"format\": \"modetune-model/1\", \"name\": \"chain\", \"dimension\": 2, "
           "\"bodies\": [");
    for (int i = 1; i <= n; i++) {
        put(w, "%s{\"name\": \"m%d\", \"centre\": [%d, 0], ", i == 1 ? "" : ", ", i, i);
        put_mass(w);
        put(w, "}");
    }
    put(w, "], \"springs\": [");
    for (int i = free_start ? 2 : 1; i <= n; i++) {
        put(w, "{\"name\": \"k%d\", \"type\": \"axial\", ", i);
        if (i == 1) {
            put(w, "\"bodies\": [\"ground\", \"m1\"], \"at\": [[0, 0], [1, 0]], ");
        } else {
            put(w, "\"bodies\": [\"m%d\", \"m%d\"], ", i - 1, i);
        }
        put_stiffness(w);
        put(w, "}, ");
    }
    put(w,
        "{\"name\": \"stop\", \"type\": \"axial\", \"bodies\": [\"m%d\", \"ground\"], "
        "\"at\": [[%d, 0], [%d, 0]], \"in\": [\"b\"], ",
        n, n, n + 1);
    put_stiffness(w);
    put(w, "}], \"joints\": [");
    for (int i = 1; i <= n; i++) {
        put(w,
            "%s{\"name\": \"r%d\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", "
            "\"m%d\"], \"at\": [%d, 0], \"axis\": [1, 0]}",
            i == 1 ? "" : ", ", i, i, i);
    }
    put(w, "], ");
    put_parameters(w);
}

static void bar(writer *w, const char *from, const char *to, const char *at, const char *more)
{
    put(w,
        "{\"name\": \"%s_%s\", \"type\": \"bar\", \"bodies\": [\"%s\", \"%s\"], %s "
        "\"youngs_modulus_pa\": 7e10, \"density_kg_per_m3\": 2770, ",
        at, to, from, to, more);
    if (mt_random_int(&w->r, 4) == 0) {
        put(w, "\"area_m2\": %.6g}", mt_random_in(&w->r, 1e-4, 1e-3));
    } else {
        put(w, "\"area_m2\": \"p%d\"}", parameter(w, mt_random_in(&w->r, 1e-4, 1e-3)));
    }
}

static void truss(writer *w)
{
    const double x = mt_random_in(&w->r, 0.8, 1.5);
    put(w,
        "{\"format\": \"modetune-model/1\", \"name\": \"truss\", \"dimension\": 2, "
        "\"points\": {\"g0\": [0, 0], \"g1\": [0, 1], \"n0\": [%.6g, 0], \"n1\": [%.6g, 1.1]}, "
        "\"bodies\": [{\"name\": \"u\", \"mass_kg\": 1, \"centre\": \"n0\"}, {\"name\": "
        "\"v\", \"mass_kg\": 2, \"centre\": \"n1\"}], \"springs\": [",
        x, x);
    bar(w, "ground", "u", "A", "\"at\": [\"g0\", \"n0\"],");
    put(w, ", ");
    bar(w, "ground", "v", "B", "\"at\": [\"g1\", \"n1\"],");
    put(w, ", ");
    bar(w, "ground", "v", "C", "\"at\": [\"g0\", \"n1\"],");
    put(w, ", ");
    bar(w, "u", "v", "D", "");
    put(w, ", ");
    bar(w, "ground", "u", "E", "\"at\": [\"g1\", \"n0\"], \"in\": [\"b\"],");
    put(w, "], ");
    put_parameters(w);
}

typedef struct rig {
    writer w;
    mt_model *model;
    mt_analysis *a[VIEWS];
    mt_enclosure *e[VIEWS];
    mt_arena mem;
    double lower[MECH_INPUTS];
    double upper[MECH_INPUTS];
    mt_certify_band band[BANDS];
    mt_certify c;
    bool loose;
} rig;

static void end(rig *g)
{
    for (int v = 0; v < VIEWS; v++) {
        mt_enclosure_delete(g->e[v]);
        mt_analysis_delete(g->a[v]);
    }
    mt_arena_free(&g->mem);
    mt_model_delete(g->model);
}

static double hz(const mt_analysis *a, int mode)
{
    const int at = mt_modal_flexible(&a->modes, mode);
    return at < 0 ? nan("") : mt_modal_hz(&a->modes, at);
}

/* Bands about the original frequencies: two of view 0, in order, and one of view 1; one alone
 * where the two overlap. */
static void choose_bands(rig *g)
{
    mt_random *const r = &g->w.r;
    for (int b = 0; b < BANDS; b++) {
        const int view = b < 2 ? 0 : 1;
        const int mode = 1 + mt_random_int(r, g->e[view]->n_modes);
        const double f = hz(g->a[view], mode) * mt_random_in(r, 0.85, 1.2);
        g->band[b] = (mt_certify_band){view, f, f * mt_random_in(r, 1.02, 1.3), 1e-6};
    }
    if (g->band[1].lower_hz < g->band[0].lower_hz) {
        const mt_certify_band other = g->band[0];
        g->band[0] = g->band[1];
        g->band[1] = other;
    }
    g->c.n_bands = g->band[1].lower_hz < g->band[0].upper_hz ? 1 : BANDS;
}

static bool begin(mt_test *t, int seed, rig *g)
{
    static char text[TEXT];
    int inputs[MECH_INPUTS];
    mt_err err = {.text = ""};
    char reason[MT_REASON_SIZE] = "";
    *g = (rig){.w = {.out = {text, sizeof text, 0}, .r = mt_random_seed((uint64_t)seed + 1)}};
    if (seed % 3 == 2) {
        truss(&g->w);
    } else {
        chain(&g->w);
    }
    g->model = mech_parse(t, g->w.out.text);
    if (g->model == NULL || !CHECK(t, mt_arena_init(&g->mem, 0, &err) == MT_OK)) {
        return false;
    }
    for (int i = 0; i < g->w.n; i++) {
        const double reach = mt_random_in(&g->w.r, 1.05, 1.8);
        char name[16];
        (void)snprintf(name, sizeof name, "p%d", i);
        inputs[i] = mt_model_find_parameter(g->model, name);
        g->lower[i] = g->w.value[i] / reach;
        g->upper[i] = g->w.value[i] * reach;
    }
    for (int v = 0; v < VIEWS; v++) {
        const bool ok =
            mt_analysis_new(g->model, v, g->w.n, inputs, g->w.value, &g->a[v], &err) == MT_OK &&
            mt_enclosure_new(g->a[v], g->lower, g->upper, &g->e[v], reason, &err) == MT_OK;
        if (!CHECK(t, ok && g->e[v] != NULL)) {
            (void)fprintf(stderr, "%s %s\n", err.text, reason);
            return false;
        }
        for (int i = 0; i < g->w.n; i++) {
            g->loose = g->loose || mt_enclosure_loose(g->e[v], i);
        }
    }
    g->c = (mt_certify){.n_views = VIEWS,
                        .views = g->e,
                        .bands = g->band,
                        .n = g->w.n,
                        .lower = g->lower,
                        .upper = g->upper,
                        .max_work = 1.2e7};
    choose_bands(g);
    return true;
}

/* Modes in both views at x; how many lie below each band. False where one lies in a band by
 * more than `tolerance`. */
static bool feasible(mt_test *t, rig *g, const double *x, double tolerance, int *below)
{
    const mt_analysis_options opt = mt_analysis_options_default();
    mt_err err;
    for (int v = 0; v < VIEWS; v++) {
        CHECK(t, mt_analysis_solve(g->a[v], x, &opt, &err) == MT_OK);
    }
    for (int b = 0; b < g->c.n_bands; b++) {
        const mt_certify_band *const band = &g->band[b];
        below[b] = 0;
        for (int k = 1; k <= g->e[band->view]->n_modes; k++) {
            const double f = hz(g->a[band->view], k);
            below[b] += f <= band->lower_hz * (1.0 + tolerance) ? 1 : 0;
            if (f > band->lower_hz * (1.0 + tolerance) &&
                f < band->upper_hz * (1.0 - tolerance)) {
                return false;
            }
        }
    }
    return true;
}

static bool among(int n_bands, const int *list, int count, const int *one)
{
    for (int i = 0; i < count; i++) {
        if (memcmp(list + ((ptrdiff_t)i * n_bands), one, (size_t)n_bands * sizeof *one) == 0) {
            return true;
        }
    }
    return false;
}

/* Under valgrind a few systems are enough: what counts there is memory, not statistics. */
static bool launched(void)
{
    return getenv("MT_TEST_LAUNCHED") != NULL;
}

static int systems(void)
{
    return launched() ? 6 : getenv("MT_EVERY") != NULL ? SYSTEMS_ALL : SYSTEMS;
}

typedef struct tally {
    int proven;
    int infeasible;
    long feasible_samples;
    int boxes; /* tolerance boxes of some size */
    int tight; /* shown to be as large as can be */
} tally;

static void enclosure__no_sample_has_what_is_excluded(mt_test *t)
{
    tally n = {0};
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        mt_certify_search out;
        mt_err err = {.text = ""};
        mt_test_row(t, "system %d", seed);
        if (begin(t, seed, &g) &&
            CHECK(t, mt_certify_assignments(&g.c, 0, NULL, &g.mem, &out, &err) == MT_OK)) {
            int below[BANDS];
            double x[MECH_INPUTS];
            n.proven += out.proven ? 1 : 0;
            n.infeasible += out.proven && out.n_found == 0 ? 1 : 0;
            for (int i = 0; i < out.n_found; i++) {
                CHECK(t, feasible(t, &g, out.at + ((ptrdiff_t)i * g.c.n), 1e-6, below));
                CHECK(t, memcmp(below, out.found + ((ptrdiff_t)i * g.c.n_bands),
                                (size_t)g.c.n_bands * sizeof *below) == 0);
            }
            for (int i = 0; i < SAMPLES; i++) {
                mt_random_in_box(&g.w.r, 4, g.c.n, g.lower, g.upper, x);
                if (feasible(t, &g, x, 0.0, below)) {
                    n.feasible_samples++;
                    CHECK(t, out.more || among(g.c.n_bands, out.found, out.n_found, below) ||
                                 among(g.c.n_bands, out.open, out.n_open, below));
                }
            }
        }
        end(&g);
    }
    (void)printf("%d of %d proven, %d of them infeasible; %ld feasible samples\n", n.proven,
                 systems(), n.infeasible, n.feasible_samples);
    CHECK(t, launched() || n.proven > systems() / 2); /* or the test shows nothing */
    CHECK(t, launched() || n.infeasible > 0);
    CHECK(t, launched() || n.feasible_samples > systems());
}

static bool agrees(const mt_certify *c, const int *same_as, const int *below)
{
    for (int i = 0; i < c->n_bands; i++) {
        if (below[i] != below[same_as[i]]) {
            return false;
        }
    }
    return true;
}

/* Of two proven answers the one with tied bands has the assignments of the free one in which
 * they agree, and no other. */
static void enclosure__tied_bands_leave_what_agrees(mt_test *t)
{
    static const int same_as[BANDS] = {
        0, 1, 0}; /* over two views, another band between them in the order */
    int kept = 0;
    int dropped = 0;
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        mt_certify_search bound;
        mt_certify_search out;
        mt_err err = {.text = ""};
        mt_test_row(t, "system %d", seed);
        const bool ok =
            begin(t, seed, &g) && g.c.n_bands == BANDS &&
            CHECK(t, mt_certify_assignments(&g.c, 0, NULL, &g.mem, &out, &err) == MT_OK);
        g.c.same_as = same_as;
        if (ok &&
            CHECK(t, mt_certify_assignments(&g.c, 0, NULL, &g.mem, &bound, &err) == MT_OK) &&
            out.proven) {
            CHECK(t, bound.proven && bound.boxes <= out.boxes);
            for (int i = 0; i < out.n_found; i++) {
                const int *const below = out.found + ((ptrdiff_t)i * BANDS);
                const bool both = agrees(&g.c, same_as, below);
                CHECK(t, among(BANDS, bound.found, bound.n_found, below) == both);
                kept += both ? 1 : 0;
                dropped += both ? 0 : 1;
            }
            for (int i = 0; i < bound.n_found; i++) {
                CHECK(t, among(BANDS, out.found, out.n_found,
                               bound.found + ((ptrdiff_t)i * BANDS)));
            }
        }
        end(&g);
    }
    (void)printf("%d assignments kept, %d dropped\n", kept, dropped);
    CHECK(t, launched() || (kept > systems() / 12 && dropped > systems() / 12));
}

/* Frequencies of one view at x against the ranges, and counts at exactly these frequencies. */
static void check_view(mt_test *t, rig *g, int v, const double *low, const double *high)
{
    for (int k = 0; k < g->e[v]->n_modes; k++) {
        const double f = hz(g->a[v], k + 1);
        const double lambda = mt_enclosure_lambda(f);
        CHECK(t, low[k] <= f && f <= high[k]);
        CHECK(t, mt_enclosure_most_below(g->e[v], lambda) >= k + 1);
        CHECK(t, mt_enclosure_least_below(g->e[v], lambda) <= k);
    }
}

static void check_ranges(mt_test *t, rig *g, const double *lo, const double *hi)
{
    double low[MODES];
    double high[MODES];
    double x[MECH_INPUTS];
    int below[BANDS];
    mt_err err = {.text = ""};
    for (int v = 0; v < VIEWS; v++) {
        CHECK(t, mt_enclosure_set(g->e[v], lo, hi));
        CHECK(t, mt_enclosure_ranges(g->e[v], low, high, &err) == MT_OK);
        for (int i = 0; i < 40; i++) {
            mt_random_in_box(&g->w.r, 4, g->c.n, lo, hi, x);
            (void)feasible(t, g, x, 0.0, below);
            check_view(t, g, v, low, high);
        }
    }
}

static void enclosure__every_sample_lies_in_the_ranges(mt_test *t)
{
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        mt_test_row(t, "system %d", seed);
        if (begin(t, seed, &g)) {
            double lo[MECH_INPUTS];
            double hi[MECH_INPUTS];
            for (int i = 0; i < g.c.n;
                 i++) { /* every third box is one design: rounding decides */
                const double a = mt_random_in(&g.w.r, g.lower[i], g.upper[i]);
                const double b = mt_random_in(&g.w.r, g.lower[i], g.upper[i]);
                lo[i] = fmin(a, b);
                hi[i] = seed % 3 == 0 ? lo[i] : fmax(a, b);
            }
            check_ranges(t, &g, lo, hi);
        }
        end(&g);
    }
}

/* Sample the box of `percent` (of one input, or of all: alone = -1): the bands stay empty, the
 * assignment stays. */
static void check_inside(mt_test *t, rig *g, const double *x, double percent, int alone,
                         const int *assignment)
{
    double lo[MECH_INPUTS];
    double hi[MECH_INPUTS];
    double y[MECH_INPUTS];
    int below[BANDS];
    for (int i = 0; i < g->c.n; i++) {
        const double half = alone < 0 || alone == i ? percent / 100.0 * fabs(x[i]) : 0.0;
        lo[i] = x[i] - half;
        hi[i] = x[i] + half;
    }
    for (int k = 0; k < INSIDE; k++) {
        mt_random_in_box(&g->w.r, 4, g->c.n, lo, hi, y);
        CHECK(t, feasible(t, g, y, 0.0, below));
        CHECK(t, memcmp(below, assignment, (size_t)g->c.n_bands * sizeof *below) == 0);
    }
}

/* Where each input enters K alone or M alone, and one way only, the soft or stiff corner of a
 * slightly larger box breaks an edge. */
static bool tight(mt_test *t, rig *g, const double *x, double percent)
{
    double lo[MECH_INPUTS];
    double hi[MECH_INPUTS];
    double corner[VIEWS][2][MECH_INPUTS];
    char reason[MT_REASON_SIZE];
    int below[BANDS];
    int assignment[BANDS];
    bool breaks = false;
    CHECK(t, feasible(t, g, x, 0.0, assignment));
    for (int i = 0; i < g->c.n; i++) {
        const double half = percent * 1.001 / 100.0 * fabs(x[i]);
        lo[i] = x[i] - half;
        hi[i] = x[i] + half;
    }
    for (int v = 0; v < VIEWS; v++) {
        if (!mt_enclosure_corners(g->e[v], g->model, g->a[v]->sys->inputs, lo, hi, corner[v][0],
                                  corner[v][1], reason)) {
            return false;
        }
        for (int s = 0; s < 2; s++) {
            breaks = breaks || !feasible(t, g, corner[v][s], 0.0, below) ||
                     memcmp(below, assignment, (size_t)g->c.n_bands * sizeof *below) != 0;
        }
    }
    CHECK(t, breaks);
    return true;
}

static void check_tolerances(mt_test *t, rig *g, const double *x, const int *assignment,
                             tally *n)
{
    mt_tolerance all;
    mt_tolerance each[MECH_INPUTS];
    mt_err err = {.text = ""};
    const mt_tolerance_question q = {x, NULL, assignment, 60.0, 0};
    CHECK(t, mt_certify_tolerance(&g->c, &q, &g->mem, &all, each, &err) == MT_OK);
    n->boxes += all.percent > 0.01 ? 1 : 0;
    check_inside(t, g, x, all.percent, -1, assignment);
    for (int i = 0; i < g->c.n; i++) {
        CHECK(t, each[i].percent >= all.percent * 0.999);
        check_inside(t, g, x, each[i].percent, i, assignment);
    }
    if (all.end == MT_TOLERANCE_EDGE && !g->loose && all.percent > 0.0) {
        n->tight += tight(t, g, x, all.percent) ? 1 : 0;
    }
}

static void enclosure__no_design_in_a_tolerance_box_fails(mt_test *t)
{
    tally n = {0};
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        double x[MECH_INPUTS];
        int below[BANDS];
        bool found = false;
        mt_test_row(t, "system %d", seed);
        const bool ok = begin(t, seed, &g);
        for (int i = 0; ok && i < SAMPLES && !found; i++) {
            mt_random_in_box(&g.w.r, 4, g.c.n, g.lower, g.upper, x);
            found = feasible(t, &g, x, 0.0, below);
        }
        if (found) {
            check_tolerances(t, &g, x, below, &n);
        }
        end(&g);
    }
    (void)printf("%d tolerance boxes, %d shown to be the largest\n", n.boxes, n.tight);
    CHECK(t, launched() || n.boxes > systems() / 3);
    CHECK(t, launched() || n.tight > systems() / 6);
}

/* A box in a box in a box has what it would have alone. *saved: counts not needed. */
static void halve(mt_test *t, rig *g, long *saved)
{
    mt_edges d;
    CHECK(t, mt_edges_init(&d, &g->c, &g->mem, NULL) == MT_OK);
    for (int k = 0; k < HALVINGS; k++) {
        const int i = mt_random_int(&g->w.r, g->c.n);
        CHECK(t, mt_certify_set(&g->c, g->lower, g->upper));
        mt_edges_use(&d, d.root);
        for (int edge = 0; edge < d.n; edge++) {
            const mt_edge *const at = &d.edges[edge];
            mt_enclosure *const e = g->e[at->view];
            *saved += e->counts + 1;
            const int count = mt_edges_count(&d, edge);
            *saved -= e->counts;
            CHECK_INT(t, count,
                      at->asked == MT_LOW ? mt_enclosure_most_below(e, at->lambda)
                                          : mt_enclosure_least_below(e, at->lambda));
        }
        *(mt_random_int(&g->w.r, 2) == 0 ? &g->lower[i] : &g->upper[i]) =
            0.5 * (g->lower[i] + g->upper[i]);
    }
}

static void enclosure__what_a_box_inherits_is_what_it_has(mt_test *t)
{
    long saved = 0;
    rig g;
    for (int seed = 0; seed < systems(); seed++) {
        if (begin(t, seed, &g)) {
            halve(t, &g, &saved);
        }
        end(&g);
    }
    CHECK(t, saved > 20L * systems());
}

MT_TEST_MAIN(MT_TEST(enclosure__what_a_box_inherits_is_what_it_has),
             MT_TEST(enclosure__no_sample_has_what_is_excluded),
             MT_TEST(enclosure__tied_bands_leave_what_agrees),
             MT_TEST(enclosure__every_sample_lies_in_the_ranges),
             MT_TEST(enclosure__no_design_in_a_tolerance_box_fails))
