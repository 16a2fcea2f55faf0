/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stationarity where eigenvalues repeat: sum k_i n_i n_i^T = I held at least there, n_i at 0,
 * 60 and 120 degrees, the cost sum w_i k_i. */
#include <math.h>

#include "mt_test.h"
#include "nlp/cone.h"

enum { SPRINGS = 3 };
static const double THIRD = 1.0471975511965976; /* pi/3 */

static void slopes(double *g)
{
    for (int i = 0; i < SPRINGS; i++) {
        const double n[2] = {cos(i * THIRD), sin(i * THIRD)};
        for (int k = 0; k < 4; k++) {
            g[4 * i + k] = n[k % 2] * n[k / 2];
        }
    }
}

static mt_status solve(const double *w, const double *g, double *u, double *z, double *kkt)
{
    mt_cone_block block = {.r = 2, .g = g};
    mt_cone c = {.n = SPRINGS, .gradient = w, .n_blocks = 1, .blocks = &block};
    mt_arena mem;
    block.u = u;
    c.z = z;
    mt_status rc = mt_arena_init(&mem, 0, NULL);
    if (rc == MT_OK) {
        rc = mt_cone_residual(&c, &mem, NULL);
        mt_arena_free(&mem);
    }
    *kkt = c.kkt;
    return rc;
}

/* n_i^T U n_i = w_i has one solution; the point is stationary where it is positive
 * semidefinite. */
static void cone__three_springs_have_their_multiplier(mt_test *t)
{
    static const double weights[][SPRINGS] = {
        {1.0, 1.0, 1.0}, {1.0, 1.3, 0.8}, {2.0, 0.8, 1.0}};
    double g[4 * SPRINGS];
    slopes(g);
    for (int k = 0; k < MT_COUNT(weights); k++) {
        double u[4];
        double z[SPRINGS];
        double kkt = -1;
        mt_test_row(t, "weights %d", k);
        REQUIRE(t, solve(weights[k], g, u, z, &kkt) == MT_OK);
        CHECK(t, kkt >= 0 && kkt < 1e-7);
        for (int i = 0; i < SPRINGS; i++) {
            double sum = 0;
            for (int j = 0; j < 4; j++) {
                sum += u[j] * g[4 * i + j];
            }
            CHECK_NEAR(t, sum, weights[k][i], 1e-6);
        }
        CHECK(t, u[0] >= 0 && u[0] * u[3] - u[1] * u[2] >= -1e-7);
    }
}

/* Where U would have a negative eigenvalue, -z lowers the cost and lifts every mode of the
 * cluster. */
static void cone__the_residual_is_a_way_down(mt_test *t)
{
    static const double w[SPRINGS] = {1.0, 0.1, 0.1};
    double g[4 * SPRINGS];
    double u[4];
    double z[SPRINGS];
    double s[4] = {0, 0, 0, 0};
    double kkt = -1;
    double down = 0;
    slopes(g);
    REQUIRE(t, solve(w, g, u, z, &kkt) == MT_OK);
    CHECK(t, kkt > 0.05);
    for (int i = 0; i < SPRINGS; i++) {
        down += z[i] * w[i];
        for (int k = 0; k < 4; k++) {
            s[k] -= z[i] * g[4 * i + k];
        }
    }
    CHECK(t, down > 0);
    const double least = 0.5 * (s[0] + s[3]) - hypot(0.5 * (s[0] - s[3]), s[1]);
    CHECK(t, least >= -1e-6);
}

/* A row that holds the point beside the cluster: x >= 0, or free for an equality. */
static void cone__rows_stand_beside_the_cluster(mt_test *t)
{
    static const double gradient[2] = {1.0, -1.0};
    static const double rows[2] = {0.0, 1.0};
    for (int k = 0; k < 2; k++) {
        const bool free_sign = k == 1;
        const double g[2] = {2.0, 0.0}; /* a cluster of one: a plain row */
        double u = 0;
        double x = 0;
        double z[2];
        const mt_cone_block block = {.r = 1, .g = g, .u = &u};
        mt_cone c = {.n = 2,
                     .gradient = gradient,
                     .n_rows = 1,
                     .rows = rows,
                     .free_sign = &free_sign,
                     .n_blocks = 1,
                     .blocks = &block,
                     .x = &x,
                     .z = z};
        mt_arena mem;
        mt_test_row(t, free_sign ? "equality" : "inequality");
        REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
        REQUIRE(t, mt_cone_residual(&c, &mem, NULL) == MT_OK);
        mt_arena_free(&mem);
        CHECK_NEAR(t, u, 0.5, 1e-12);
        CHECK_NEAR_ABS(t, x, free_sign ? -1.0 : 0.0, 1e-12);
        CHECK_NEAR_ABS(t, c.kkt, free_sign ? 0.0 : sqrt(0.5), 1e-12);
    }
}

MT_TEST_MAIN(MT_TEST(cone__three_springs_have_their_multiplier),
             MT_TEST(cone__the_residual_is_a_way_down),
             MT_TEST(cone__rows_stand_beside_the_cluster))
