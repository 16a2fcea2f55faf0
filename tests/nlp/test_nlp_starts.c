/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starting points: the origin, then a sequence that fills the bounds in any dimension; and when
 * there are enough of them. */
#include "nlp/nlp.h"
#include "nlp_problem.h"

enum { D_MOST = 1300, STARTS = 33 };

static mt_status unused(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                        mt_err *err)
{
    (void)context;
    (void)t;
    (void)with_gradient;
    (void)out;
    return mt_fail(err, MT_E_INTERNAL, "nobody asked");
}

typedef struct box {
    double lower[D_MOST];
    double upper[D_MOST];
    double origin[D_MOST];
} box;

/* Starts in the box [2, 6], the origin beyond it in variable 0, variable 1 fixed at 5. */
static double *starts_in(box *b, int n, unsigned long seed, mt_arena *mem)
{
    for (int j = 0; j < n; j++) {
        b->lower[j] = j == 1 ? 5 : 2;
        b->upper[j] = j == 1 ? 5 : 6;
        b->origin[j] = j == 0 ? 9 : 3;
    }
    const mt_nlp nlp = {
        .n = n, .lower = b->lower, .upper = b->upper, .origin = b->origin, .eval = unused};
    return mt_arena_init(mem, 0, NULL) == MT_OK ? mt_nlp_starts(&nlp, seed, STARTS, mem) : NULL;
}

/* Every variable has a third of the points in each half, at least: a generator that returns
 * zeros, or repeats a column, does not. */
static void nlp_starts__fill_the_bounds_in_any_dimension(mt_test *t)
{
    static box b;
    static const int sizes[] = {1, 2, 40, 41, 42, 60, 1230, 1231, D_MOST};
    for (int k = 0; k < (int)(sizeof sizes / sizeof sizes[0]); k++) {
        const int n = sizes[k];
        mt_test_row(t, "%d variables", n);
        mt_arena mem;
        const double *const s = starts_in(&b, n, 1, &mem);
        REQUIRE(t, s != NULL);
        CHECK(t, s[0] == 6); /* clamped origin */
        bool inside = true;
        bool balanced = true;
        for (int j = 0; j < n; j++) {
            int low = 0;
            for (int i = 1; i < STARTS; i++) {
                const double x = s[j + (ptrdiff_t)i * n];
                inside = inside && (j == 1 ? x == 5 : x >= 2 && x <= 6);
                low += x < 4;
            }
            /* pseudo-random columns (beyond 1229) may be off by four deviations of
             * sqrt(32)/2 */
            const int least = n <= 1230 ? 10 : 4;
            balanced = balanced && (j == 1 || (low >= least && low <= STARTS - 1 - least));
        }
        CHECK(t, inside);
        CHECK(t, n > 40 || balanced); /* Halton with large bases fills slowly */
        CHECK(t, n == 1 || s[1] == 5);
        mt_arena_free(&mem);
    }
}

static void nlp_starts__beyond_40_variables_are_not_constant(mt_test *t)
{
    static box b;
    for (int n = 42; n <= D_MOST; n += D_MOST - 42) {
        mt_test_row(t, "%d variables", n);
        mt_arena mem;
        const double *const s = starts_in(&b, n, 1, &mem);
        REQUIRE(t, s != NULL);
        int moving = 0;
        for (int j = 0; j < n; j++) {
            moving += s[j + n] != s[j + 2 * n] && s[j + 2 * n] != s[j + 3 * n];
        }
        CHECK_INT(t, moving, n - 1);
        mt_arena_free(&mem);
    }
}

static void nlp_starts__seed_turns_the_sequence_reproducibly(mt_test *t)
{
    static box b;
    mt_arena mem[3];
    const double *const one = starts_in(&b, 5, 7, &mem[0]);
    const double *const two = starts_in(&b, 5, 7, &mem[1]);
    const double *const other = starts_in(&b, 5, 8, &mem[2]);
    REQUIRE(t, one != NULL && two != NULL && other != NULL);
    const size_t bytes = (size_t)STARTS * 5 * sizeof(double);
    CHECK(t, same_bytes(one, two, bytes));
    CHECK(t, !same_bytes(one, other, bytes));
    CHECK(t, same_bytes(one, other, 5 * sizeof(double))); /* the origin stays the first */
    for (int k = 0; k < 3; k++) {
        mt_arena_free(&mem[k]);
    }
}

/* A bowl, with waves in it where target[0] is their height. */
static void valleys(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = (0.5 * t[0] * t[0]) + (c->target[0] * (1.0 - cos(4.0 * t[0]))) +
             (0.5 * (t[1] - 1.0) * (t[1] - 1.0));
    out->df[0] = t[0] + (4.0 * c->target[0] * sin(4.0 * t[0]));
    out->df[1] = t[1] - 1.0;
    out->in[0] = t[0] + 5.0; /* it always holds */
    out->din[0] = 1.0;
    out->din[1] = 0.0;
}

/* Where the first ones end at one design no more are made; else all of them. */
static void nlp_starts__end_where_the_first_ones_agree(mt_test *t)
{
    nlp_case c = {0};
    enum { ALL = 12, FIRST = 3 };
    for (int waves = 0; waves < 2; waves++) {
        for (int agree = 0; agree <= FIRST; agree += FIRST) {
            mt_test_row(t, "waves %d, agree %d", waves, agree);
            case_begin(&c, 2, valleys, -3, 3);
            c.nlp.n_in = 1;
            c.target[0] = waves == 1 ? 2.0 : 0.0;
            mt_nlp_options opt = mt_nlp_options_default();
            opt.starts = ALL;
            opt.agree = agree;
            REQUIRE(t, case_solve(&c, &opt) == MT_OK);
            CHECK_INT(t, c.result.starts, waves == 0 && agree > 0 ? FIRST : ALL);
            CHECK_NEAR_ABS(t, c.result.solutions[0].t[0], 0.0, 1e-8);
            CHECK_NEAR(t, c.result.solutions[0].t[1], 1.0, 1e-8);
            CHECK(t, waves == 0 ? c.result.n_solutions == 1 : c.result.n_solutions > 2);
        }
    }
    mt_arena_free(&c.mem);
}

/* A trough with its bottom at t0 = 0 and one value along it, and a second one at t0 = 2 that is
 * higher by target[0]. */
static void troughs(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const bool second = t[0] > 1.0;
    const double d = second ? t[0] - 2.0 : t[0];
    out->f = 1.0 + (0.5 * d * d) + (second ? c->target[0] : 0.0);
    out->df[0] = d;
    out->df[1] = 0.0;
    out->in[0] = t[0] + 5.0; /* it always holds */
    out->din[0] = 1.0;
    out->din[1] = 0.0;
}

/* Equally good ends in several places are enough where any of them will do, and only there. */
static void nlp_starts__end_where_the_first_ones_are_equally_good(mt_test *t)
{
    nlp_case c = {0};
    enum { ALL = 12, FIRST = 4 };
    for (int k = 0; k < 4; k++) {
        const bool any = k % 2 == 1;
        const bool higher = k >= 2;
        mt_test_row(t, "any best %d, second trough higher %d", any, higher);
        case_begin(&c, 2, troughs, -3, 3);
        c.nlp.n_in = 1;
        c.target[0] = higher ? 1e-3 : 0.0;
        mt_nlp_options opt = mt_nlp_options_default();
        opt.starts = ALL;
        opt.agree = FIRST;
        opt.any_best = any;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK_INT(t, c.result.starts, any && !higher ? FIRST : ALL);
        CHECK_NEAR(t, c.result.solutions[0].f, 1.0, 1e-8);
    }
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_starts__fill_the_bounds_in_any_dimension),
             MT_TEST(nlp_starts__beyond_40_variables_are_not_constant),
             MT_TEST(nlp_starts__seed_turns_the_sequence_reproducibly),
             MT_TEST(nlp_starts__end_where_the_first_ones_agree),
             MT_TEST(nlp_starts__end_where_the_first_ones_are_equally_good))
