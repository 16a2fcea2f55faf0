/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Responses of random trees, and of such with loops, by a few of their modes, and shapes of the
 * others, against those of all modes: within what both say of their errors, which is little. In
 * the plane and in space, held and free, hanging in gravity, by forces and by the ground; each
 * kind of damping.
 * MT_STRESS_ROUNDS=N: N times as many.
 */
#include <float.h>
#include <stdlib.h>

#include "mechanics/mech.h"
#include "response/response.h"
#include "support/random_tree.h"

enum { ROUNDS = 64, FEW = 7, FREQUENCIES = 8, OUTPUTS = 8, PAIRS = 2 * OUTPUTS };

/* What the medians over a kind are, of the largest value of each response: far below the first
 * of the modes that are left out. */
static const double USUALLY_OFF = 1e-11;
static const double USUALLY_TOLD = 1e-8;
/* Of damping ratios of modes that are left out. */
static const double RATIO_OFF = 1e-4;
static const double RATIO_TOLD = 0.1;

/* Motion that each output is, and what the dense way's freedoms turn from one direction into
 * another, in roundings of the largest: that is not in its errors, which are D's alone. */
static const int MOTION[OUTPUTS] = {0, 2, 1, 1, 0, 0, 0, 0};
static const double SCALE[OUTPUTS] = {1.0, 1.0, 1.0, 1.0, 5e3, 5e3, 5e3, 5e3};
static const double DENSE_ULPS = 2e5;

/* Errors of a kind, of all its mechanisms. */
typedef struct seen {
    int n;
    double off[ROUNDS * FREQUENCIES * PAIRS];
    double told[ROUNDS * FREQUENCIES * PAIRS];
} seen;

static seen seen_of[2][2]; /* with loops; of damping ratios of all modes */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(int n, double *x)
{
    qsort(x, (size_t)n, sizeof *x, ascending);
    return n == 0 ? nan("") : x[n / 2];
}

/* The largest displacement by one input, the ground's own included. */
static double unit_of(const double complex *h, double w, int in)
{
    double most = in == 1 ? 1.0 / (w * w) : 0.0;
    for (int o = 0; o < 4; o++) { /* sensors */
        most = fmax(most, cabs(h[(OUTPUTS * in) + o]) / pow(w, MOTION[o]));
    }
    return most;
}

/* n_in: what is free is not moved by the ground, and all ways have rounding then. */
static void compare(mt_test *t, mt_response *few, mt_response *all, double to, int n_in,
                    mt_random *g, seen *s)
{
    double complex h[2][FREQUENCIES][PAIRS];
    double error[2][FREQUENCIES][PAIRS];
    double largest[PAIRS] = {0.0};
    double ws[FREQUENCIES];
    mt_err err = {.text = ""};
    for (int i = 0; i < FREQUENCIES; i++) {
        const double w = to * mt_random_in(g, 0.02, 1.0);
        ws[i] = w;
        const mt_sample a = {.h = h[0][i], .error = error[0][i]};
        const mt_sample b = {.h = h[1][i], .error = error[1][i]};
        CHECK_INT(t, mt_transfer_at(few->chosen, w, &a, &few->mem, &err), MT_OK);
        CHECK_INT(t, mt_transfer_at(all->chosen, w, &b, &all->mem, &err), MT_OK);
        for (int p = 0; p < PAIRS; p++) {
            largest[p] = fmax(largest[p], cabs(h[1][i][p]));
        }
    }
    for (int at = 0; at < FREQUENCIES * OUTPUTS * n_in; at++) {
        const int i = at / (OUTPUTS * n_in);
        const int p = at % (OUTPUTS * n_in);
        const double off = cabs(h[0][i][p] - h[1][i][p]);
        const double size = unit_of(h[1][i], ws[i], p / OUTPUTS) *
                            pow(ws[i], MOTION[p % OUTPUTS]) * SCALE[p % OUTPUTS];
        CHECK(t, isfinite(error[0][i][p]) && off <= error[0][i][p] + error[1][i][p] +
                                                        (DENSE_ULPS * DBL_EPSILON * size));
        if (largest[p] > 0.0) {
            s->off[s->n] = off / largest[p];
            s->told[s->n++] = error[0][i][p] / largest[p];
        }
    }
}

static void try_tree(mt_test *t, random_tree *r, char *text)
{
    static const char *const IN[] = {"p0.x", "base.y"};
    /* the joint of the last body is in no loop */
    const char *const joint[] = {"joint.j49.x", r->looped ? "joint.j49.y" : "joint.j20.y"};
    const char *const out[OUTPUTS] = {"p0.x",
                                      "p1.y:acceleration",
                                      "p1.y:relative_velocity",
                                      "p0.y:velocity",
                                      "spring.s20",
                                      random_tree_damped(r) ? "damper.d1" : "spring.s30",
                                      r->hung ? "spring.s10" : joint[0],
                                      r->hung ? "spring.s40" : joint[1]};
    const mt_response_request request = {
        .n_in = 2, .inputs = IN, .n_out = OUTPUTS, .outputs = out};
    const mt_lowest_want want = {.count = FEW, .shapes = true};
    const mt_analysis_options opt = mt_analysis_options_default();
    char why[MT_LARGE_WHY] = "";
    bool is = false;
    mech m;
    mt_lowest *l = NULL;
    mt_response few = {.a = NULL};
    mt_response all = {.a = NULL};
    mt_writer w = {text, TREE_TEXT, 0};
    random_tree_write(r, &w);
    bool ok = mech_must(t, mech_parse(t, text), "c", "", &m) &&
              CHECK_INT(t, mt_analysis_solve(m.a, m.at, &opt, &m.err), MT_OK) &&
              CHECK_INT(t, mt_response_open(m.a, &request, &all, &m.err), MT_OK) &&
              CHECK_INT(t, mt_lowest_new(&(mt_system_def){.model = m.model}, want, &l, &m.err),
                        MT_OK) &&
              CHECK_INT(t, l->way, r->looped ? MT_LOWEST_SPARSE : MT_LOWEST_TREE);
    const double to = ok ? 0.5 * sqrt(l->found.tau) : nan("");
    ok = ok &&
         CHECK_INT(t, mt_response_open_large(l, &request, to, &few, &is, why, &m.err), MT_OK) &&
         CHECK(t, is);
    if (ok) {
        compare(t, &few, &all, to, r->free ? 1 : 2, &r->g,
                &seen_of[r->looped ? 1 : 0][r->kind == TREE_RATIO ? 1 : 0]);
    }
    mt_response_free(&few);
    mt_response_free(&all);
    mt_lowest_delete(l);
    mech_free(&m);
}

static void check_medians(mt_test *t, seen *plain, seen *by_ratio)
{
    const double figures[] = {median(plain->n, plain->off), median(plain->n, plain->told),
                              median(by_ratio->n, by_ratio->off),
                              median(by_ratio->n, by_ratio->told)};
    CHECK(t, figures[0] <= USUALLY_OFF);
    CHECK(t, figures[1] <= USUALLY_TOLD);
    CHECK(t, figures[2] <= RATIO_OFF);
    CHECK(t, figures[3] <= RATIO_TOLD);
}

static void try_all(mt_test *t, bool looped)
{
    const char *const more = getenv("MT_STRESS_ROUNDS");
    const int times = more == NULL ? 1 : (int)strtol(more, NULL, 10);
    char *const text = malloc(TREE_TEXT);
    seen *const own = seen_of[looped ? 1 : 0];
    for (int round = 0; round < times * ROUNDS && text != NULL; round++) {
        random_tree r = {.g = mt_random_seed((uint64_t)round + 1),
                         .kind = (tree_damping)(round % TREE_KINDS),
                         .looped = looped};
        r.axes = 2 + mt_random_int(&r.g, 2);
        r.hung = round / TREE_KINDS % 4 == 3 && r.kind != TREE_LOSS;
        r.axes = r.hung ? 2 : r.axes;
        r.free = !r.hung && round / TREE_KINDS % 4 == 2;
        mt_test_row(t, "%s %d", looped ? "loops" : "tree", round);
        own[0].n = round % ROUNDS == 0 ? 0 : own[0].n;
        own[1].n = round % ROUNDS == 0 ? 0 : own[1].n;
        try_tree(t, &r, text);
    }
    free(text);
    mt_test_row(t, "medians of %s", looped ? "loops" : "trees");
    check_medians(t, &own[0], &own[1]);
}

static void large__responses_are_those_of_all_modes(mt_test *t)
{
    try_all(t, false);
}

static void large__loops_have_them_too(mt_test *t)
{
    try_all(t, true);
}

/* A row of masses on rollers, from the ground to the ground where `both`, of elastic bars with
 * mass. */
static void write_row(mt_writer *w, bool both)
{
    enum { MASSES = 12 };
    mt_write(w, "{ \"format\": \"modetune-model/1\", \"name\": \"row\", \"dimension\": 2,"
                " \"bodies\": [ ");
    for (int i = 1; i <= MASSES; i++) {
        mt_write(w,
                 "%s{ \"name\": \"m%d\", \"mass_kg\": %g, \"inertia_kg_m2\": 1, \"centre\":"
                 " [%d, 0] }",
                 i == 1 ? "" : ", ", i, 0.5 + (0.1 * (i % 4)), i);
    }
    mt_write(w, " ], \"joints\": [ ");
    for (int i = 1; i <= MASSES; i++) {
        char before[16] = "ground";
        (void)snprintf(before, sizeof before, i == 1 ? "ground" : "m%d", i - 1);
        mt_write(w,
                 "%s{ \"name\": \"j%d\", \"type\": \"prismatic\", \"bodies\": [\"%s\","
                 " \"m%d\"], \"at\": [%d, 0], \"axis\": [1, 0] }",
                 i == 1 ? "" : ", ", i, before, i, i);
    }
    mt_write(w, " ], \"springs\": [ ");
    for (int i = 1; i <= MASSES + (both ? 1 : 0); i++) {
        char ends[2][16] = {"ground", "ground"};
        (void)snprintf(ends[0], sizeof ends[0], i == 1 ? "ground" : "m%d", i - 1);
        (void)snprintf(ends[1], sizeof ends[1], i > MASSES ? "ground" : "m%d", i);
        mt_write(w,
                 "%s{ \"name\": \"b%d\", \"type\": \"bar\", \"bodies\": [\"%s\", \"%s\"],"
                 " \"at\": [[%d, 0], [%d, 0]], \"youngs_modulus_pa\": 1e6, \"area_m2\": 0.01,"
                 " \"density_kg_per_m3\": 90 }",
                 i == 1 ? "" : ", ", i, ends[0], ends[1], i - 1, i);
    }
    mt_write(w,
             " ], \"sensors\": [ { \"name\": \"s\", \"on\": \"m1\", \"directions\": [\"x\"] },"
             " { \"name\": \"e\", \"on\": \"m%d\", \"directions\": [\"x\"] } ],"
             " \"configurations\": { \"c\": {} } }",
             MASSES);
}

/* By few modes as by all, which test_moving_ground.c compares with a table that moves. */
static void large__bars_on_the_ground_are_driven_by_it(mt_test *t)
{
    static const char *const IN[] = {"base.x"};
    static const char *const OUT[] = {"s.x:acceleration", "e.x:relative_displacement",
                                      "spring.b1"};
    const mt_response_request request = {.n_in = 1, .inputs = IN, .n_out = 3, .outputs = OUT};
    const mt_lowest_want want = {.count = FEW, .shapes = true};
    const mt_analysis_options opt = mt_analysis_options_default();
    char *const text = malloc(TREE_TEXT);
    for (int both = 0; both < 2 && text != NULL; both++) {
        char why[MT_LARGE_WHY] = "";
        bool is = false;
        mech m;
        mt_lowest *l = NULL;
        mt_response few = {.a = NULL};
        mt_response all = {.a = NULL};
        mt_writer row = {text, TREE_TEXT, 0};
        write_row(&row, both == 1);
        bool ok =
            mech_must(t, mech_parse(t, text), "c", "", &m) &&
            CHECK_INT(t, mt_analysis_solve(m.a, m.at, &opt, &m.err), MT_OK) &&
            CHECK_INT(t, mt_response_open(m.a, &request, &all, &m.err), MT_OK) &&
            CHECK_INT(t, mt_lowest_new(&(mt_system_def){.model = m.model}, want, &l, &m.err),
                      MT_OK) &&
            CHECK_INT(t, l->way, both == 1 ? MT_LOWEST_SPARSE : MT_LOWEST_TREE);
        const double to = ok ? 0.5 * sqrt(l->found.tau) : nan("");
        ok = ok &&
             CHECK_INT(t, mt_response_open_large(l, &request, to, &few, &is, why, &m.err),
                       MT_OK) &&
             CHECK(t, is);
        for (int i = 1; i < FREQUENCIES && ok; i++) {
            double complex h[2][3];
            double error[2][3];
            const double w = to * i / FREQUENCIES;
            const mt_sample a = {.h = h[0], .error = error[0]};
            const mt_sample b = {.h = h[1], .error = error[1]};
            CHECK_INT(t, mt_transfer_at(few.chosen, w, &a, &few.mem, &m.err), MT_OK);
            CHECK_INT(t, mt_transfer_at(all.chosen, w, &b, &all.mem, &m.err), MT_OK);
            for (int o = 0; o < 3; o++) {
                mt_test_row(t, "%s, w = %g, %s", both == 1 ? "both" : "one", w, OUT[o]);
                CHECK_NEAR_ABS(t, cabs(h[0][o] - h[1][o]), 0.0, 1e-9 * cabs(h[1][o]));
            }
        }
        mt_response_free(&few);
        mt_response_free(&all);
        mt_lowest_delete(l);
        mech_free(&m);
    }
    free(text);
}

MT_TEST_MAIN(MT_TEST(large__responses_are_those_of_all_modes),
             MT_TEST(large__loops_have_them_too),
             MT_TEST(large__bars_on_the_ground_are_driven_by_it))
