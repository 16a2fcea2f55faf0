/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row of six masses: m = (2, 1.5, 1, 1, 0.8, 0.5) kg, k = (4, 3, 2, 2, 1.5, 1)e4 exp(x) N/m,
 * four bands. All 210 monotone assignments are settled. */
#include "mechanics/mech.h"
#include "prove/certify.h"
#include "support/mt_alloc.h"

enum { N = 6, BANDS = 4 };

static const double LN_2 = 0.69314718055994530942;

static const mt_certify_band BAND[BANDS] = {{0, 3.87, 4.73, 1e-6},
                                            {0, 7.74, 9.46, 1e-6},
                                            {0, 15.48, 18.92, 1e-6},
                                            {0, 30.96, 37.84, 1e-6}};

typedef struct rig {
    mech s;
    mt_enclosure *e;
    mt_arena mem;
    double lower[N];
    double upper[N];
    mt_certify c;
} rig;

static bool begin(mt_test *t, double reach, rig *r)
{
    char reason[MT_REASON_SIZE] = "";
    mt_err err = {.text = ""};
    static const double linear[N] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    *r = (rig){0};
    if (!mech_must(t, mech_load(t, "six_masses"), NULL, "x1 x2 x3 x4 x5 x6", &r->s)) {
        return false;
    }
    for (int i = 0; i < N; i++) {
        r->lower[i] = -reach;
        r->upper[i] = reach;
    }
    const bool ok = mt_arena_init(&r->mem, 0, &err) == MT_OK &&
                    mt_enclosure_new(r->s.a, r->lower, r->upper, &r->e, reason, &err) == MT_OK;
    if (!CHECK(t, ok && r->e != NULL)) {
        (void)fprintf(stderr, "%s %s\n", err.text, reason);
        return false;
    }
    r->c = (mt_certify){.n_views = 1,
                        .views = &r->e,
                        .n_bands = BANDS,
                        .bands = BAND,
                        .n = N,
                        .lower = r->lower,
                        .upper = r->upper,
                        .scale = linear};
    return true;
}

static void end(rig *r)
{
    mt_enclosure_delete(r->e);
    mt_arena_free(&r->mem);
    mech_free(&r->s);
}

/* Number of modes below each band at x, or -1 in the first where a mode lies in one. */
static void assignment_at(mech *s, const double *x, int *out)
{
    mt_err err;
    const mt_analysis_options opt = mt_analysis_options_default();
    if (mt_analysis_solve(s->a, x, &opt, &err) != MT_OK) {
        out[0] = -1;
        return;
    }
    for (int b = 0; b < BANDS; b++) {
        out[b] = 0;
        for (int k = 1; k <= N; k++) {
            const double f = mech_hz(s, k);
            out[b] += f <= BAND[b].lower_hz * (1.0 + BAND[b].tolerance) ? 1 : 0;
            if (f > BAND[b].lower_hz * (1.0 + BAND[b].tolerance) &&
                f < BAND[b].upper_hz * (1.0 - BAND[b].tolerance)) {
                out[0] = -1;
                return;
            }
        }
    }
}

static void enclosure__six_masses_have_exactly_seven_assignments(mt_test *t)
{
    rig r;
    mt_certify_search out;
    mt_err err = {.text = ""};
    static const double hz[N] = {6.8086, 16.1960, 23.7702, 31.8310, 36.4612, 41.3828};
    if (begin(t, LN_2, &r)) {
        for (int i = 0; i < N; i++) {
            CHECK_NEAR_ABS(t, mech_hz(&r.s, i + 1), hz[i], 5.1e-5);
        }
        CHECK(t, mt_certify_assignments(&r.c, 0, NULL, &r.mem, &out, &err) == MT_OK);
        CHECK(t, out.proven);
        CHECK_INT(t, out.n_found, 7);
        CHECK_INT(t, out.n_open, 0);
        for (int i = 0; i < out.n_found; i++) {
            int have[BANDS];
            mt_test_row(t, "assignment %d", i);
            assignment_at(&r.s, out.at + ((ptrdiff_t)i * N), have);
            CHECK(t, memcmp(have, out.found + ((ptrdiff_t)i * BANDS), sizeof have) == 0);
        }
        (void)printf("seven assignments: %ld boxes, %ld counts, %ld by pivoting\n", out.boxes,
                     r.e->counts, r.e->fallbacks);
        /* known ones are not found again, and what is left is still proven */
        mt_certify_search again;
        CHECK(t, mt_certify_assignments(&r.c, out.n_found, out.found, &r.mem, &again, &err) ==
                     MT_OK);
        CHECK(t, again.proven && again.n_found == 0);
        CHECK(t, again.boxes <= out.boxes);
    }
    end(&r);
}

/* Is the assignment monotone? Number k of all (N + 1)^BANDS. */
static bool monotone(int k, int *one)
{
    bool ok = true;
    for (int b = BANDS - 1; b >= 0; b--) {
        one[b] = k % (N + 1);
        k /= N + 1;
        ok = ok && (b == BANDS - 1 || one[b] <= one[b + 1]);
    }
    return ok;
}

static void enclosure__every_single_assignment_is_settled(mt_test *t)
{
    rig r;
    mt_err err = {.text = ""};
    int verdicts[MT_VERDICT_COUNT] = {0};
    const bool ok = begin(t, LN_2, &r);
    for (int k = 0; ok && k < (N + 1) * (N + 1) * (N + 1) * (N + 1); k++) {
        int one[BANDS];
        int have[BANDS];
        double at[N];
        mt_verdict verdict = MT_VERDICT_OPEN;
        if (!monotone(k, one)) {
            continue;
        }
        mt_test_row(t, "%d %d %d %d", one[0], one[1], one[2], one[3]);
        CHECK(t, mt_certify_possible(&r.c, one, &r.mem, &verdict, at, NULL, &err) == MT_OK);
        verdicts[verdict]++;
        if (verdict == MT_VERDICT_POSSIBLE) {
            assignment_at(&r.s, at, have);
            CHECK(t, memcmp(have, one, sizeof have) == 0);
        }
    }
    CHECK_INT(t, verdicts[MT_VERDICT_POSSIBLE], 7);
    CHECK_INT(t, verdicts[MT_VERDICT_IMPOSSIBLE], 203);
    CHECK_INT(t, verdicts[MT_VERDICT_OPEN], 0);
    end(&r);
}

static void enclosure__six_masses_within_five_percent_are_infeasible(mt_test *t)
{
    rig r;
    mt_certify_search out;
    mt_err err = {.text = ""};
    if (begin(t, 0.05, &r)) {
        CHECK(t, mt_certify_assignments(&r.c, 0, NULL, &r.mem, &out, &err) == MT_OK);
        CHECK(t, out.proven);
        CHECK_INT(t, out.n_found, 0);
        (void)printf("infeasible: %ld boxes\n", out.boxes);
    }
    end(&r);
}

static int at_once(void *context)
{
    (void)context;
    return MT_STOP_REQUEST_FINISH;
}

static void enclosure__a_spent_budget_says_what_is_open(mt_test *t)
{
    rig r;
    mt_certify_search out;
    mt_err err = {.text = ""};
    static const int original[BANDS] = {0, 1, 2, 3};
    if (begin(t, LN_2, &r)) {
        const double before = r.e->operations;
        r.c.max_work = 3e5;
        CHECK(t, mt_certify_assignments(&r.c, 1, original, &r.mem, &out, &err) == MT_OK);
        CHECK(t, !out.proven);
        CHECK(t, out.n_open > 0);
        const double undecided = out.undecided;
        CHECK(t, undecided > 0.0 && undecided < 1.0);
        /* what is on the stack is still looked at */
        const double work = r.e->operations - before;
        CHECK(t, work > 1e5 && work < 6e5); /* the rest is for boxes as such */
        mt_interrupt interrupt;
        mt_interrupt_init(&interrupt, at_once, NULL, NULL);
        r.c.max_work = 0;
        r.c.interrupt = &interrupt;
        CHECK(t, mt_certify_assignments(&r.c, 0, NULL, &r.mem, &out, &err) == MT_OK);
        CHECK(t, !out.proven && out.stopped);
        CHECK(t, out.boxes == 1 && out.undecided == 1.0);
        r.c.interrupt = NULL;
        CHECK(t, mt_certify_assignments(&r.c, 0, NULL, &r.mem, &out, &err) == MT_OK);
        CHECK(t, out.proven && out.undecided == 0.0);
    }
    end(&r);
}

static void enclosure__a_frequency_out_of_reach_is_proven_so(mt_test *t)
{
    rig r;
    mt_err err = {.text = ""};
    mt_certify_reach reach;
    if (begin(t, LN_2, &r)) {
        /* all stiffnesses halved or doubled: sqrt(2) either way, exactly what is reachable */
        const double f1 = mech_hz(&r.s, 1);
        const double root = sqrt(2.0);
        const mt_certify_limit limit[] = {
            {0, 1, f1 * 1.5, nan(""), 1e-6},  {0, 1, nan(""), f1 / 1.5, 1e-6},
            {0, 1, f1 * 1.2, f1 * 1.2, 1e-6}, {0, 1, f1 * root * 1.01, f1 * root * 1.01, 1e-6},
            {0, 7, 1.0, nan(""), 1e-6},
        };
        static const mt_verdict want[] = {MT_VERDICT_IMPOSSIBLE, MT_VERDICT_IMPOSSIBLE,
                                          MT_VERDICT_POSSIBLE, MT_VERDICT_IMPOSSIBLE,
                                          MT_VERDICT_IMPOSSIBLE};
        r.c.limits = limit;
        r.c.n_limits = (int)(sizeof limit / sizeof *limit);
        for (int i = 0; i < r.c.n_limits; i++) {
            mt_test_row(t, "limit %d", i);
            CHECK(t, mt_certify_reach_of(&r.c, i, &r.mem, &reach, &err) == MT_OK);
            if (i == 2) { /* an exact target: reachable, but no box's middle needs to hit it */
                CHECK(t, reach.verdict != MT_VERDICT_IMPOSSIBLE);
            } else {
                CHECK_INT(t, reach.verdict, want[i]);
            }
            if (i < 4) {
                CHECK_NEAR(t, reach.low_hz, f1 / root, 1e-9);
                CHECK_NEAR(t, reach.high_hz, f1 * root, 1e-9);
                CHECK(t, reach.low_hz <= f1 / root && reach.high_hz >= f1 * root);
            }
        }
    }
    end(&r);
}

/* Where the first mass alone between its springs would have the frequency asked about, the
 * first pivot vanishes and the factorisation without pivoting says nothing. */
static void enclosure__a_pivot_that_vanishes_calls_for_pivoting(mt_test *t)
{
    rig r;
    if (begin(t, LN_2, &r)) {
        double low[N];
        double high[N];
        mt_err err = {.text = ""};
        CHECK(t, mt_enclosure_set(r.e, r.lower, r.upper));
        CHECK(t, mt_enclosure_ranges(r.e, low, high, &err) == MT_OK);
        const double first = r.e->at[MT_STIFFNESS][MT_LOW][0];
        const long before = r.e->fallbacks;
        for (int ulps = -40; ulps <= 40;
             ulps++) { /* about first / (1 + 1e-9), the shift of rounding */
            const double lambda = first / (1.0 + 1e-9) * (1.0 + (ulps * 2.2e-16));
            int below = 0;
            while (below < N && mt_enclosure_lambda(low[below]) < lambda) {
                below++;
            }
            CHECK_INT(t, mt_enclosure_most_below(r.e, lambda), below);
        }
        CHECK(t, r.e->fallbacks > before);
    }
    end(&r);
}

static void enclosure__a_box_costs_no_heap(mt_test *t)
{
    rig r;
    const bool seen = mt_alloc_works();
    if (begin(t, LN_2, &r)) {
        double low[N];
        double high[N];
        double lo[N];
        mt_err err = {.text = ""};
        long before = 0;
        for (int round = 0; round < 3; round++) {
            before = round == 1 ? mt_alloc_count() : before;
            for (int i = 0; i < N; i++) {
                lo[i] = 0.1 * (round - 1);
            }
            CHECK(t, mt_enclosure_set(r.e, lo, r.upper));
            CHECK(t, mt_enclosure_ranges(r.e, low, high, &err) == MT_OK);
            const double pivot = r.e->at[MT_STIFFNESS][MT_LOW][0] / (1.0 + 1e-9);
            (void)mt_enclosure_most_below(r.e, pivot); /* by pivoting */
            CHECK(t, mt_enclosure_least_below(r.e, mt_enclosure_lambda(high[2])) <= 2);
        }
        CHECK(t, r.e->fallbacks == 3);
        CHECK(t, !seen || mt_alloc_count() == before);
    }
    end(&r);
}

static void enclosure__limits_join_the_bands(mt_test *t)
{
    rig r;
    mt_certify_search out;
    mt_err err = {.text = ""};
    const mt_certify_limit limit = {0, 6, 50.0, nan(""), 1e-6};
    if (begin(t, LN_2, &r)) {
        r.c.limits = &limit;
        r.c.n_limits = 1;
        CHECK(t, mt_certify_assignments(&r.c, 0, NULL, &r.mem, &out, &err) == MT_OK);
        CHECK(t, out.proven);
        CHECK(t, out.n_found < 7);
        const mt_analysis_options opt = mt_analysis_options_default();
        for (int i = 0; i < out.n_found; i++) {
            CHECK(t,
                  mt_analysis_solve(r.s.a, out.at + ((ptrdiff_t)i * N), &opt, &err) == MT_OK);
            CHECK(t, mech_hz(&r.s, 6) >= 50.0 * (1.0 - 1e-6));
        }
    }
    end(&r);
}

MT_TEST_MAIN(MT_TEST(enclosure__six_masses_have_exactly_seven_assignments),
             MT_TEST(enclosure__every_single_assignment_is_settled),
             MT_TEST(enclosure__six_masses_within_five_percent_are_infeasible),
             MT_TEST(enclosure__a_spent_budget_says_what_is_open),
             MT_TEST(enclosure__a_frequency_out_of_reach_is_proven_so),
             MT_TEST(enclosure__a_pivot_that_vanishes_calls_for_pivoting),
             MT_TEST(enclosure__a_box_costs_no_heap), MT_TEST(enclosure__limits_join_the_bands))
