/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Branch and bound over catalogues against brute force: random chains of masses with lists of
 * values, beside continuous variables or not. Every combination is judged by a fresh analysis,
 * the continuous ones at many values: none may have what is excluded, and none may be better
 * than what a cap proves to be the best.
 */
#include <stdarg.h>
#include <stdlib.h>

#include "mechanics/mech.h"
#include "prove/certify.h"
#include "support/mt_random.h"

enum { TEXT = 4096, SYSTEMS = 60, MASSES = 3, VALUES = 7, SAMPLES = 400 };

typedef struct rig {
    mt_random r;
    mech s;
    mt_enclosure *e;
    mt_arena mem;
    int n_catalogue[MECH_INPUTS];
    double value[MECH_INPUTS][VALUES];
    const double *catalogue[MECH_INPUTS];
    double lower[MECH_INPUTS];
    double upper[MECH_INPUTS];
    mt_certify_band band;
    mt_certify_limit limit;
    mt_certify c;
} rig;

static void end(rig *g)
{
    mt_enclosure_delete(g->e);
    mt_arena_free(&g->mem);
    mech_free(&g->s);
}

/* k0 - m0 - k1 - m1 - k2 - m2 on rails; each third mass grows with its spring. */
static void chain(rig *g, char *text, size_t size)
{
    char body[TEXT] = "";
    char spring[TEXT] = "";
    char joint[TEXT] = "";
    for (int i = 0; i < MASSES; i++) {
        const size_t b = strlen(body);
        const size_t k = strlen(spring);
        const size_t j = strlen(joint);
        const char *const comma = i == 0 ? "" : ", ";
        char mass[32];
        (void)snprintf(mass, sizeof mass,
                       mt_random_int(&g->r, 3) == 0 ? "1 + k%d/2e4" : "0.5 + 0.5*m%d", i);
        (void)snprintf(body + b, sizeof body - b,
                       "%s{\"name\": \"b%d\", \"mass_kg\": \"%s\", \"centre\": [%d, 0]}", comma,
                       i, mass, i + 1);
        (void)snprintf(spring + k, sizeof spring - k,
                       "%s{\"name\": \"s%d\", \"type\": \"axial\", \"bodies\": [%s\"b%d\"], "
                       "\"at\": [[%d, 0], [%d, 0]], \"stiffness_n_per_m\": \"k%d\"}",
                       comma, i, i == 0 ? "\"ground\", " : (i == 1 ? "\"b0\", " : "\"b1\", "),
                       i, i, i + 1, i);
        (void)snprintf(joint + j, sizeof joint - j,
                       "%s{\"name\": \"r%d\", \"type\": \"pin-in-slot\", \"bodies\": "
                       "[\"ground\", \"b%d\"], \"at\": [%d, 0], \"axis\": [1, 0]}",
                       comma, i, i, i + 1);
    }
    (void)snprintf(text, size,
                   "{\"format\": \"modetune-model/1\", \"name\": \"chain\", \"dimension\": 2, "
                   "\"parameters\": {\"k0\": %.6g, \"k1\": %.6g, \"k2\": %.6g, \"m0\": 1, "
                   "\"m1\": 1, \"m2\": 1}, \"bodies\": [%s], \"springs\": [%s], \"joints\": "
                   "[%s], \"configurations\": {\"a\": {}}}",
                   mt_random_in(&g->r, 5e3, 3e4), mt_random_in(&g->r, 5e3, 3e4),
                   mt_random_in(&g->r, 5e3, 3e4), body, spring, joint);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y ? 1 : 0;
}

/* Inputs k0, k1, k2, m1: lists of values, but for `continuous` of them. */
static void choose_variables(rig *g, int continuous)
{
    for (int i = 0; i < g->s.n; i++) {
        g->n_catalogue[i] = i < g->s.n - continuous ? 1 + mt_random_int(&g->r, VALUES) : 0;
        for (int k = 0; k < g->n_catalogue[i]; k++) {
            g->value[i][k] = g->s.at[i] * mt_random_in(&g->r, 0.6, 1.6);
        }
        qsort(g->value[i], (size_t)g->n_catalogue[i], sizeof(double), ascending);
        g->catalogue[i] = g->value[i];
        g->lower[i] = g->n_catalogue[i] > 0 ? g->value[i][0] : 0.7 * g->s.at[i];
        g->upper[i] =
            g->n_catalogue[i] > 0 ? g->value[i][g->n_catalogue[i] - 1] : 1.4 * g->s.at[i];
    }
}

static bool begin(mt_test *t, int seed, int continuous, rig *g)
{
    char text[4 * TEXT];
    char reason[MT_REASON_SIZE] = "";
    mt_err err = {.text = ""};
    *g = (rig){.r = mt_random_seed((uint64_t)seed + 5)};
    chain(g, text, sizeof text);
    if (!CHECK(t, mt_arena_init(&g->mem, 0, &err) == MT_OK) ||
        !mech_must(t, mech_parse(t, text), NULL, "k0 k1 k2 m1", &g->s)) {
        return false;
    }
    choose_variables(g, continuous);
    if (!CHECK(t, mt_enclosure_new(g->s.a, g->lower, g->upper, &g->e, reason, &err) == MT_OK) ||
        !CHECK(t, g->e != NULL)) {
        return false;
    }
    const int mode = 1 + mt_random_int(&g->r, MASSES);
    const double f = mech_hz(&g->s, mode) * mt_random_in(&g->r, 0.85, 1.1);
    g->band = (mt_certify_band){0, f, f * mt_random_in(&g->r, 1.05, 1.6), 1e-6};
    g->limit = (mt_certify_limit){0, 1, mech_hz(&g->s, 1) * mt_random_in(&g->r, 0.8, 1.15),
                                  nan(""), 1e-6};
    g->c = (mt_certify){.n_views = 1,
                        .views = &g->e,
                        .n_bands = 1,
                        .bands = &g->band,
                        .n_limits = seed % 2,
                        .limits = &g->limit,
                        .n = g->s.n,
                        .lower = g->lower,
                        .upper = g->upper,
                        .n_catalogue = g->n_catalogue,
                        .catalogue = g->catalogue,
                        .max_work = 4e7};
    return true;
}

/* How many modes lie below the band at x; -1: the design does not meet the question, by more
 * than the tolerance. */
static int kind_of(mt_test *t, rig *g, const double *x, double tolerance)
{
    const mt_analysis_options opt = mt_analysis_options_default();
    mt_err err;
    int below = 0;
    CHECK(t, mt_analysis_solve(g->s.a, x, &opt, &err) == MT_OK);
    for (int k = 1; k <= MASSES; k++) {
        const double f = mech_hz(&g->s, k);
        if (f > g->band.lower_hz * (1.0 + tolerance) &&
            f < g->band.upper_hz * (1.0 - tolerance)) {
            return -1;
        }
        below += f <= g->band.lower_hz * (1.0 + tolerance) ? 1 : 0;
    }
    return g->c.n_limits > 0 && mech_hz(&g->s, 1) < g->limit.at_least_hz * (1.0 - tolerance)
               ? -1
               : below;
}

/* The next combination of picks; false after the last. */
static bool advance(const rig *g, int *pick)
{
    for (int i = 0; i < g->c.n; i++) {
        if (g->n_catalogue[i] > 0 && ++pick[i] < g->n_catalogue[i]) {
            return true;
        }
        pick[i] = 0;
    }
    return false;
}

static void place(rig *g, const int *pick, double *x)
{
    for (int i = 0; i < g->c.n; i++) {
        x[i] = g->n_catalogue[i] > 0 ? g->value[i][pick[i]]
                                     : mt_random_in(&g->r, g->lower[i], g->upper[i]);
    }
}

/* A sum that has its least value at other designs than the middle: least over a box by its
 * corners. */
static double cost(void *context, const double *lo, const double *hi)
{
    const rig *const g = context;
    double f = 0.0;
    for (int i = 0; i < g->c.n; i++) {
        const double above = (lo[i] / g->s.at[i]) - 1.0;
        const double below = 1.0 - (hi[i] / g->s.at[i]);
        const double d = fmax(fmax(above, below), 0.0);
        f += d * d;
    }
    return f;
}

typedef struct truth {
    bool kind[MASSES + 1];
    bool any;
    double best; /* least cost */
    double at[MECH_INPUTS];
} truth;

/* Every combination, with `continuous` variables at so many random values each. */
static truth brute_force(mt_test *t, rig *g, int values)
{
    truth out = {.best = HUGE_VAL};
    int pick[MECH_INPUTS] = {0};
    do {
        for (int k = 0; k < values; k++) {
            double x[MECH_INPUTS] = {0};
            place(g, pick, x);
            const int kind = kind_of(t, g, x, 0.0);
            if (kind < 0) {
                continue;
            }
            out.any = true;
            out.kind[kind] = true;
            if (cost(g, x, x) < out.best) {
                out.best = cost(g, x, x);
                memcpy(out.at, x, sizeof x);
            }
        }
    } while (advance(g, pick));
    return out;
}

static bool is_member(const rig *g, const double *x)
{
    bool member = true;
    for (int i = 0; i < g->c.n; i++) {
        bool listed = g->n_catalogue[i] == 0;
        for (int k = 0; k < g->n_catalogue[i]; k++) {
            listed = listed || g->value[i][k] == x[i];
        }
        member = member && listed;
    }
    return member;
}

typedef struct tally {
    int proven;
    int infeasible;
    int optimal;
} tally;

/* Where one design will do the search ends with it; where there is none it proves as much. */
static void check_any(mt_test *t, rig *g, const mt_certify_search *whole)
{
    mt_certify_search out;
    mt_err err = {.text = ""};
    mt_certify c = g->c;
    c.any = true;
    CHECK(t, mt_certify_assignments(&c, 0, NULL, &g->mem, &out, &err) == MT_OK);
    CHECK_INT(t, out.n_found, whole->n_found > 0 ? 1 : 0);
    CHECK(t, out.proven == (whole->proven && whole->n_found == 0));
    CHECK(t, out.boxes <= whole->boxes);
    CHECK(t, out.n_found == 0 || kind_of(t, g, out.at, 1e-6) == out.found[0]);
}

/* Which kinds there are: as brute force says, and exactly so where nothing is continuous. */
static void check_kinds(mt_test *t, rig *g, const truth *real, bool exact, tally *n)
{
    mt_certify_search out;
    mt_err err = {.text = ""};
    bool found[MASSES + 1] = {false};
    bool open[MASSES + 1] = {false};
    CHECK(t, mt_certify_assignments(&g->c, 0, NULL, &g->mem, &out, &err) == MT_OK);
    check_any(t, g, &out);
    n->proven += out.proven ? 1 : 0;
    n->infeasible += out.proven && out.n_found == 0 ? 1 : 0;
    for (int i = 0; i < out.n_found; i++) {
        const double *const x = out.at + ((ptrdiff_t)i * g->c.n);
        found[out.found[i]] = true;
        CHECK(t, is_member(g, x));
        CHECK_INT(t, kind_of(t, g, x, 1e-6), out.found[i]);
    }
    for (int i = 0; i < out.n_open; i++) {
        open[out.open[i]] = true;
    }
    for (int k = 0; k <= MASSES; k++) {
        CHECK(t, !real->kind[k] || found[k] || open[k]);
        CHECK(t, !exact || !found[k] || real->kind[k]);
    }
    CHECK(t, !exact || out.proven);
}

/* With the cost of the best as cap nothing is found; with a little more, something is. */
static void check_cap(mt_test *t, rig *g, const truth *real, bool exact, tally *n)
{
    mt_certify_cap cap = {.least = cost, .context = g};
    mt_certify_search out;
    mt_err err = {.text = ""};
    mt_certify c = g->c;
    c.cap = &cap;
    cap.below = real->best * (exact ? 1.0 - 1e-9 : 1.0);
    CHECK(t, mt_certify_assignments(&c, 0, NULL, &g->mem, &out, &err) == MT_OK);
    CHECK(t, !exact || (out.proven && out.n_found == 0));
    n->optimal += out.proven && out.n_found == 0 ? 1 : 0;
    for (int i = 0; i < out.n_found; i++) {
        const double *const x = out.at + ((ptrdiff_t)i * c.n);
        CHECK(t, cost(g, x, x) < cap.below && kind_of(t, g, x, 1e-6) == out.found[i]);
    }
    cap.below = real->best * (1.0 + 1e-6) + 1e-12;
    CHECK(t, mt_certify_assignments(&c, 0, NULL, &g->mem, &out, &err) == MT_OK);
    CHECK(t, !(out.proven && out.n_found == 0));
}

static int systems(void)
{
    return getenv("MT_TEST_LAUNCHED") != NULL ? 3 : SYSTEMS;
}

static void run(mt_test *t, int continuous)
{
    tally n = {0};
    for (int seed = 0; seed < systems(); seed++) {
        rig g;
        mt_test_row(t, "system %d, %d continuous", seed, continuous);
        if (begin(t, seed, continuous, &g)) {
            const truth real = brute_force(t, &g, continuous == 0 ? 1 : SAMPLES / 20);
            check_kinds(t, &g, &real, continuous == 0, &n);
            if (real.any) {
                check_cap(t, &g, &real, continuous == 0, &n);
            }
        }
        end(&g);
    }
    (void)printf("%d of %d proven, %d of them infeasible, %d best ones\n", n.proven, systems(),
                 n.infeasible, n.optimal);
    const bool launched = systems() < SYSTEMS;
    CHECK(t, launched || n.proven > SYSTEMS / 2);
    CHECK(t, launched || n.infeasible > 0);
    CHECK(t, launched || continuous > 0 || n.optimal > SYSTEMS / 2);
}

static void catalogues__agree_with_brute_force(mt_test *t)
{
    run(t, 0);
}

static void catalogues__beside_continuous_variables_exclude_no_sample(mt_test *t)
{
    run(t, 1);
    run(t, 2);
}

MT_TEST_MAIN(MT_TEST(catalogues__agree_with_brute_force),
             MT_TEST(catalogues__beside_continuous_variables_exclude_no_sample))
