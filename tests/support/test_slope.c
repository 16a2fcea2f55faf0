/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The slope check accepts right derivatives and refuses planted errors. */
#include <float.h>
#include <math.h>

#include "mt_slope.h"
#include "mt_test.h"

static const double STEP = 1e-3;
static const double NOISE = DBL_EPSILON;

/* exp(2 x0) sin(x1) + 3 x0 */
static double smooth(const void *ctx, int n, const double *x)
{
    (void)ctx;
    (void)n;
    return exp(2.0 * x[0]) * sin(x[1]) + 3.0 * x[0];
}

static double linear(const void *ctx, int n, const double *x)
{
    (void)ctx;
    (void)n;
    return 5.0 * x[0] - 2.0 * x[1];
}

static double undefined(const void *ctx, int n, const double *x)
{
    (void)ctx;
    (void)n;
    (void)x;
    return nan("");
}

static void slope__right_derivatives_agree(mt_test *t)
{
    double x[2] = {0.3, 0.7};
    const double d0 = 2.0 * exp(0.6) * sin(0.7) + 3.0;
    const double d1 = exp(0.6) * cos(0.7);
    CHECK(t, mt_slope_agrees(smooth, NULL, 2, x, 0, d0, STEP, NOISE));
    CHECK(t, mt_slope_agrees(smooth, NULL, 2, x, 1, d1, STEP, NOISE));
    mt_test_row(t, "linear: nothing but rounding");
    CHECK(t, mt_slope_agrees(linear, NULL, 2, x, 0, 5.0, STEP, NOISE));
    CHECK(t, mt_slope_agrees(linear, NULL, 2, x, 1, -2.0, STEP, NOISE));
    mt_test_row(t, "the point is put back");
    CHECK(t, x[0] == 0.3 && x[1] == 0.7);
}

static void slope__an_error_of_1e_6_is_caught(mt_test *t)
{
    double x[2] = {0.3, 0.7};
    const double d0 = 2.0 * exp(0.6) * sin(0.7) + 3.0;
    CHECK(t, !mt_slope_agrees(smooth, NULL, 2, x, 0, d0 * (1.0 + 1e-6), STEP, NOISE));
    CHECK(t, !mt_slope_agrees(smooth, NULL, 2, x, 0, d0 * (1.0 - 1e-6), STEP, NOISE));
    CHECK(t, !mt_slope_agrees(linear, NULL, 2, x, 0, 5.0 * (1.0 + 1e-6), STEP, NOISE));
    mt_test_row(t, "sign");
    CHECK(t, !mt_slope_agrees(smooth, NULL, 2, x, 0, -d0, STEP, NOISE));
}

static void slope__nan_never_agrees(mt_test *t)
{
    double x[2] = {0.3, 0.7};
    CHECK(t, !mt_slope_agrees(undefined, NULL, 2, x, 0, 1.0, STEP, NOISE));
    CHECK(t, !mt_slope_agrees(smooth, NULL, 2, x, 0, nan(""), STEP, NOISE));
}

MT_TEST_MAIN(MT_TEST(slope__right_derivatives_agree),
             MT_TEST(slope__an_error_of_1e_6_is_caught), MT_TEST(slope__nan_never_agrees))
