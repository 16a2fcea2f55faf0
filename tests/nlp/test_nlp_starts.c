/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starting points: the origin, then a sequence that fills the bounds in any dimension. */
#include "nlp/starts.h"
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

MT_TEST_MAIN(MT_TEST(nlp_starts__fill_the_bounds_in_any_dimension),
             MT_TEST(nlp_starts__beyond_40_variables_are_not_constant),
             MT_TEST(nlp_starts__seed_turns_the_sequence_reproducibly))
