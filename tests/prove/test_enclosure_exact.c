/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Enclosures against 113 bits: chains of masses on springs whose coefficients rise, fall, turn
 * within the box or use their parameter twice. Exact eigenvalues of designs in a box lie within
 * its ranges, and counts hold at a lambda next to them; where nothing is lost by the method the
 * bounds are the eigenvalues at the corners.
 */
#include "expr/exact.h"
#include "mechanics/mech.h"
#include "prove/box.h"
#include "prove/enclosure.h"
#include "support/mt_random.h"

enum { MASSES = 4, PARAMETERS = 2 * MASSES, SYSTEMS = 60, SAMPLES = 8, TEXT = 4096 };

/* What a coefficient is of its parameter; turns: where its slope is 0, NaN for nowhere. */
typedef struct form {
    const char *text; /* with the number of the parameter */
    quad (*value)(quad p);
    double turns;
    bool rises; /* before it turns */
} form;

static quad straight(quad p)
{
    return 10000 * p;
}

static quad hill(quad p)
{
    return 10000 * p * (3 - p);
}

static quad valley(quad p)
{
    return 2000 + (10000 * (p - 1) * (p - 1));
}

static quad swing(quad p)
{
    return 6000 + (5000 * exact_sin(3 * p));
}

static quad saturating(quad p)
{
    return 20000 * p / (1 + p);
}

static quad falling(quad p)
{
    return 10000 / p;
}

static quad light(quad p)
{
    return ((quad)1 / 4) + p;
}

static quad lightest(quad p)
{
    return 1 + ((p - 1) * (p - 1));
}

static const form springs[] = {
    {"1e4*p%d", straight, (double)NAN, true},
    {"1e4*p%d*(3 - p%d)", hill, 1.5, true},
    {"2000 + 1e4*(p%d - 1)^2", valley, 1.0, false},
    {"6000 + 5000*sin(3*p%d)", swing, 1.5707963267948966, false},
    {"2e4*p%d/(1 + p%d)", saturating, (double)NAN, true},
    {"1e4/p%d", falling, (double)NAN, false},
};
static const form bodies[] = {
    {"0.25 + p%d", light, (double)NAN, true},
    {"1 + (p%d - 1)^2", lightest, 1.0, false},
};

/* All of these keep the signs of their slopes here but where they turn (3 p: 1.8 to 5.1). */
static const double LEAST = 0.6;
static const double MOST = 1.7;

typedef struct rig {
    int n; /* masses: parameter i is that of spring i, n + i that of mass i */
    const form *form[PARAMETERS];
    mech s;
    mt_enclosure *e;
    double lo[PARAMETERS]; /* of the box */
    double hi[PARAMETERS];
} rig;

static size_t put_form(char *text, size_t length, const form *f, int parameter)
{
    char number[64];
    /* the compiler wants to see formats: the number goes in by hand */
    size_t at = length;
    (void)snprintf(number, sizeof number, "%d", parameter);
    for (const char *c = f->text; *c != '\0' && at + 16 < TEXT; c++) {
        if (c[0] == '%') {
            memcpy(text + at, number, strlen(number));
            at += strlen(number);
            c++;
        } else {
            text[at++] = *c;
        }
    }
    text[at] = '\0';
    return at;
}

static size_t put(char *text, size_t length, const char *more)
{
    const size_t n = strlen(more);
    if (length + n < TEXT) {
        memcpy(text + length, more, n + 1);
    }
    return length + n;
}

static void write_model(const rig *g, char *text)
{
    char part[256];
    size_t at = put(text, 0,
                    "{\"format\": \"modetune-model/1\", \"name\": \"chain\", "
                    "\"dimension\": 2, \"bodies\": [");
    for (int i = 0; i < g->n; i++) {
        (void)snprintf(part, sizeof part,
                       "%s{\"name\": \"m%d\", \"centre\": [%d, 0], \"mass_kg\": \"",
                       i == 0 ? "" : ", ", i, i + 1);
        at = put(text, at, part);
        at = put_form(text, at, g->form[g->n + i], g->n + i);
        at = put(text, at, "\"}");
    }
    at = put(text, at, "], \"springs\": [");
    for (int i = 0; i < g->n; i++) {
        (void)snprintf(part, sizeof part,
                       "%s{\"name\": \"k%d\", \"type\": \"axial\", \"bodies\": [\"",
                       i == 0 ? "" : ", ", i);
        at = put(text, at, part);
        (void)snprintf(part, sizeof part, i == 0 ? "ground" : "m%d", i - 1);
        at = put(text, at, part);
        (void)snprintf(part, sizeof part, "\", \"m%d\"], %s\"stiffness_n_per_m\": \"", i,
                       i == 0 ? "\"at\": [[0, 0], [1, 0]], " : "");
        at = put(text, at, part);
        at = put_form(text, at, g->form[i], i);
        at = put(text, at, "\"}");
    }
    at = put(text, at, "], \"joints\": [");
    for (int i = 0; i < g->n; i++) {
        (void)snprintf(
            part, sizeof part,
            "%s{\"name\": \"r%d\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", "
            "\"m%d\"], \"at\": [%d, 0], \"axis\": [1, 0]}",
            i == 0 ? "" : ", ", i, i, i + 1);
        at = put(text, at, part);
    }
    at = put(text, at, "], \"parameters\": {");
    for (int i = 0; i < 2 * g->n; i++) {
        (void)snprintf(part, sizeof part, "%s\"p%d\": 1.1", i == 0 ? "" : ", ", i);
        at = put(text, at, part);
    }
    (void)put(text, at, "}}");
}

/* kind 0: a box of some width; 1: one design; 2: coefficients that neither turn nor use their
 * parameter twice, in a box */
static bool begin(mt_test *t, mt_random *r, int kind, rig *g)
{
    static const int simple[] = {0, 5, 2};
    char text[TEXT];
    char names[128] = "";
    char reason[MT_REASON_SIZE] = "";
    double lower[PARAMETERS];
    double upper[PARAMETERS];
    mt_err err = {.text = ""};
    size_t at = 0;
    *g = (rig){.n = 2 + mt_random_int(r, MASSES - 1)};
    for (int i = 0; i < g->n; i++) {
        g->form[i] = kind == 2 ? &springs[simple[mt_random_int(r, 2)]]
                               : &springs[mt_random_int(r, MT_COUNT(springs))];
        g->form[g->n + i] =
            kind == 2 ? &bodies[0] : &bodies[mt_random_int(r, MT_COUNT(bodies))];
    }
    for (int i = 0; i < 2 * g->n; i++) {
        const double a = mt_random_in(r, LEAST, MOST);
        const double b = mt_random_in(r, LEAST, MOST);
        lower[i] = LEAST;
        upper[i] = MOST;
        g->lo[i] = fmin(a, b);
        g->hi[i] = kind == 1 ? g->lo[i] : fmax(a, b);
        at += (size_t)snprintf(names + at, sizeof names - at, "p%d ", i);
    }
    write_model(g, text);
    if (!mech_must(t, mech_parse(t, text), NULL, names, &g->s)) {
        return false;
    }
    const mt_status rc = mt_enclosure_new(g->s.a, lower, upper, &g->e, reason, &err);
    const bool ok = CHECK(t, rc == MT_OK && g->e != NULL) &&
                    CHECK_INT(t, g->e->n_modes, g->n) &&
                    CHECK(t, mt_enclosure_set(g->e, g->lo, g->hi));
    if (!ok) {
        (void)fprintf(stderr, "%s %s\n", err.text, reason);
    }
    return ok;
}

static void end(rig *g)
{
    mt_enclosure_delete(g->e);
    mech_free(&g->s);
}

/* Eigenvalues of the chain at x, ascending. */
static void exact_modes(const rig *g, const double *x, quad *lambda)
{
    quad k[MASSES + 1] = {0};
    quad m[MASSES];
    quad a[MASSES * MASSES] = {0};
    const ptrdiff_t n = g->n;
    for (ptrdiff_t i = 0; i < n; i++) {
        k[i] = g->form[i]->value((quad)x[i]);
        m[i] = g->form[g->n + i]->value((quad)x[g->n + i]);
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        a[i + (i * n)] = (k[i] + k[i + 1]) / m[i];
        if (i > 0) {
            const quad coupling = -k[i] / quad_root(m[i] * m[i - 1]);
            a[i + ((i - 1) * n)] = coupling;
            a[i - 1 + (i * n)] = coupling;
        }
    }
    quad_eigenvalues(g->n, a, lambda);
}

static quad exact_hz(quad lambda)
{
    return quad_root(lambda) / (2 * exact_pi());
}

/* The doubles next to it: below or equal, above or equal. */
static double double_below(quad x)
{
    const double d = (double)x;
    return (quad)d <= x ? d : nextafter(d, 0.0);
}

static double double_above(quad x)
{
    const double d = (double)x;
    return (quad)d >= x ? d : nextafter(d, HUGE_VAL);
}

static void enclosure__holds_exact_eigenvalues_of_its_designs(mt_test *t)
{
    mt_random r = mt_random_seed(281);
    for (int seed = 0; seed < SYSTEMS; seed++) {
        rig g;
        double low[MASSES];
        double high[MASSES];
        mt_err err = {.text = ""};
        mt_test_row(t, "system %d", seed);
        const bool ok = begin(t, &r, seed % 3, &g) &&
                        CHECK_INT(t, mt_enclosure_ranges(g.e, low, high, &err), MT_OK);
        for (int s = 0; ok && s < SAMPLES; s++) {
            double x[PARAMETERS];
            quad lambda[MASSES];
            mt_random_in_box(&r, 2, 2 * g.n, g.lo, g.hi, x);
            exact_modes(&g, x, lambda);
            for (int k = 0; k < g.n; k++) {
                CHECK(t, (quad)low[k] <= exact_hz(lambda[k]));
                CHECK(t, (quad)high[k] >= exact_hz(lambda[k]));
                CHECK(t, mt_enclosure_most_below(g.e, double_above(lambda[k])) > k);
                CHECK(t, mt_enclosure_least_below(g.e, double_below(lambda[k])) <= k);
            }
        }
        end(&g);
    }
}

/* Shares of lambda: bounds are known to 1e-8 and less (box.c shifts by HARMLESS), counts decide
 * beyond 1e-6 of an eigenvalue. */
static const double KNOWN = 1e-8;
static const double APART = 1e-6;

/* Soft and stiff corner of a box of coefficients that rise or fall. */
static void corners(const rig *g, double *soft, double *stiff)
{
    for (int i = 0; i < 2 * g->n; i++) {
        const bool stiffens = g->form[i]->rises == (i < g->n);
        soft[i] = stiffens ? g->lo[i] : g->hi[i];
        stiff[i] = stiffens ? g->hi[i] : g->lo[i];
    }
}

static void enclosure__is_exact_where_coefficients_only_rise_or_fall(mt_test *t)
{
    mt_random r = mt_random_seed(282);
    for (int seed = 0; seed < SYSTEMS; seed++) {
        rig g;
        double low[MASSES];
        double high[MASSES];
        mt_err err = {.text = ""};
        mt_test_row(t, "system %d", seed);
        if (begin(t, &r, 1 + (seed % 2), &g) &&
            CHECK_INT(t, mt_enclosure_ranges(g.e, low, high, &err), MT_OK)) {
            double soft[PARAMETERS];
            double stiff[PARAMETERS];
            quad least[MASSES];
            quad most[MASSES];
            corners(&g, soft, stiff);
            exact_modes(&g, soft, least);
            exact_modes(&g, stiff, most);
            for (int k = 0; k < g.n; k++) {
                CHECK_NEAR(t, low[k], (double)exact_hz(least[k]), KNOWN);
                CHECK_NEAR(t, high[k], (double)exact_hz(most[k]), KNOWN);
                /* chains have simple eigenvalues, far apart here */
                CHECK_INT(t, mt_enclosure_most_below(g.e, (double)least[k] * (1.0 - APART)), k);
                CHECK_INT(t, mt_enclosure_most_below(g.e, (double)least[k] * (1.0 + APART)),
                          k + 1);
                CHECK_INT(t, mt_enclosure_least_below(g.e, (double)most[k] * (1.0 + APART)),
                          k + 1);
                CHECK_INT(t, mt_enclosure_least_below(g.e, (double)most[k] * (1.0 - APART)), k);
            }
        }
        end(&g);
    }
}

/* What raising an input does over the box: by where its coefficient turns. */
static void enclosure__knows_what_an_input_does_to_the_modes(mt_test *t)
{
    mt_random r = mt_random_seed(283);
    int turned = 0;
    for (int seed = 0; seed < SYSTEMS; seed++) {
        rig g;
        int effects[PARAMETERS];
        mt_test_row(t, "system %d", seed);
        if (begin(t, &r, 0, &g)) {
            mt_enclosure_effects(g.e, g.lo, g.hi, effects);
            for (int i = 0; i < 2 * g.n; i++) {
                const form *const f = g.form[i];
                const bool turns = f->turns > g.lo[i] && f->turns < g.hi[i];
                const bool after = !(f->turns >= g.hi[i]) && !isnan(f->turns);
                const bool stiffens = (f->rises != after) == (i < g.n);
                const int want = turns      ? MT_STIFFENS | MT_SOFTENS
                                 : stiffens ? MT_STIFFENS
                                            : MT_SOFTENS;
                /* never less than the truth; more only where the parameter occurs twice */
                CHECK_INT(t, effects[i] & want, want);
                CHECK(t, effects[i] == want || f->value == hill || f->value == saturating);
                turned += turns ? 1 : 0;
            }
        }
        end(&g);
    }
    CHECK(t, turned > SYSTEMS / 4);
}

MT_TEST_MAIN(MT_TEST(enclosure__holds_exact_eigenvalues_of_its_designs),
             MT_TEST(enclosure__is_exact_where_coefficients_only_rise_or_fall),
             MT_TEST(enclosure__knows_what_an_input_does_to_the_modes))
