/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How coordinates follow the free ones, and what is open of it: along a row of turned planes,
 *     z_k = R z_(k-1), z_0 free:   X_k = -R^k,
 * whose sizes are 1 where |R|^k, what errors that are carried along grow by, is 1e28. */
#include <float.h>
#include <math.h>

#include "mechanics/eliminate.h"
#include "support/mt_test.h"

enum { STEPS = 200, SIZE = 2 * (STEPS + 1), RANK = 2 * STEPS };

static const double ANGLE = 1.0;
/* Two hundred steps of rounding four eps each, summed without signs: a few times 200 eps 4. */
static const double MOST_OPEN = 1e-11;

static void set(double *g, double *e, int row, int column, double value)
{
    const ptrdiff_t at = column + ((ptrdiff_t)row * SIZE);
    g[at] = value;
    e[at] = 4.0 * DBL_EPSILON * fabs(value);
}

static void follow__errors_grow_as_the_mechanism_passes_them_on(mt_test *t)
{
    mt_arena mem = {0};
    double *const g = mt_arena_f64(&mem, RANK, SIZE);
    double *const e = mt_arena_f64(&mem, RANK, SIZE);
    bool *const follows = mt_arena_alloc(&mem, SIZE, sizeof *follows);
    bool holds = false;
    REQUIRE(t, mt_arena_check(&mem, NULL) == MT_OK);
    for (int k = 1; k <= STEPS; k++) {
        const double r[2][2] = {{cos(ANGLE), -sin(ANGLE)}, {sin(ANGLE), cos(ANGLE)}};
        for (int i = 0; i < 2; i++) {
            const int row = (2 * (k - 1)) + i;
            set(g, e, row, (2 * k) + i, 1.0);
            set(g, e, row, 2 * (k - 1), -r[i][0]);
            set(g, e, row, (2 * (k - 1)) + 1, -r[i][1]);
            follows[(2 * k) + i] = true;
        }
    }
    mt_follow f = {.rank = RANK, .nq = SIZE, .g = g, .e = e, .follows = follows};
    CHECK_INT(t, mt_follow_find(&f, &mem, &holds, NULL), MT_OK);
    if (CHECK(t, holds)) {
        for (int k = 1; k <= STEPS; k++) {
            const double c = cos(k * ANGLE);
            const double s = sin(k * ANGLE);
            const double exact[4] = {-c, s, -s, -c};
            mt_test_row(t, "step %d", k);
            for (int i = 0; i < 4; i++) {
                const ptrdiff_t at = ((ptrdiff_t)(k - 1) * 4) + i;
                CHECK(t, fabs(f.x[at] - exact[i]) <= f.dx[at] + DBL_EPSILON);
                CHECK(t, f.dx[at] > 0.0 && f.dx[at] <= MOST_OPEN);
            }
        }
    }
    mt_arena_free(&mem);
}

/* [1 1; 1 1 + d] with entries known to e: of d > 4 e the inverse is known, of d < e it is
 * not. */
static void follow__nothing_holds_where_errors_may_make_equations_dependent(mt_test *t)
{
    const bool follows[3] = {true, true, false};
    static const struct {
        double d;
        bool holds;
    } row[] = {{1e-3, true}, {1e-5, true}, {1e-7, false}, {0.0, false}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const double d = row[i].d;
        const double g[6] = {1.0, 1.0, 1.0, 1.0, 1.0 + d, 0.0};
        const double e[6] = {1e-7, 1e-7, 0.0, 1e-7, 1e-7, 0.0};
        mt_arena mem = {0};
        bool holds = !row[i].holds;
        mt_follow f = {.rank = 2, .nq = 3, .g = g, .e = e, .follows = follows};
        mt_test_row(t, "d = %g", d);
        CHECK_INT(t, mt_follow_find(&f, &mem, &holds, NULL), MT_OK);
        CHECK(t, holds == row[i].holds);
        if (holds) { /* (1 + d, -1) / d, by whose sizes the errors of its column are open */
            CHECK_NEAR(t, f.x[0], (1.0 + d) / d, 1e-9);
            CHECK_NEAR(t, f.x[1], -1.0 / d, 1e-9);
            CHECK(t, f.dx[0] > 1e-7 / d / d && f.dx[0] < 20.0 * 1e-7 / d / d);
        }
        mt_arena_free(&mem);
    }
}

MT_TEST_MAIN(MT_TEST(follow__errors_grow_as_the_mechanism_passes_them_on),
             MT_TEST(follow__nothing_holds_where_errors_may_make_equations_dependent))
