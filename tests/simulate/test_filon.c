/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Integrals of waves times 1 and s have closed forms; those of higher powers agree where the
 * two ways of computing them meet. */
#include <float.h>
#include <math.h>

#include "base/base.h"
#include "simulate/step.h"
#include "support/mt_test.h"

enum { POINTS = MT_FILON_POINTS };

/* sum_j weights of l_j times p at c_j. */
static double sum(const mt_filon *q, const double *weights, int i, int power)
{
    double value = 0.0;
    for (int j = 0; j < POINTS; j++) {
        value += weights[i + (j * POINTS)] * pow(q->point[j], power);
    }
    return value;
}

static void filon__lines_have_closed_forms(mt_test *t)
{
    static const double waves[] = {0.3, 3.0, 20.0, 49.0, 51.0, 300.0, 1e5};
    static mt_filon q;
    mt_filon_make(&q);
    for (int k = 0; k < MT_COUNT(waves); k++) {
        const double x = waves[k];
        mt_filon_weights w = {.x = nan("")};
        mt_filon_weigh(&q, x, &w);
        for (int i = 0; i < POINTS; i++) {
            const double c = q.point[i];
            const double turned = 2.0 * sin(0.5 * x * c) * sin(0.5 * x * c); /* 1 - cos */
            mt_test_row(t, "x = %g, point %d", x, i);
            CHECK_NEAR_ABS(t, w.c[i], cos(x * c), DBL_EPSILON);
            CHECK_NEAR_ABS(t, sum(&q, w.nc, i, 0), sin(x * c) / x, 1e-13);
            CHECK_NEAR_ABS(t, sum(&q, w.nd, i, 0), turned / x / x, 1e-13);
            CHECK_NEAR_ABS(t, sum(&q, w.nc, i, 1), turned / x / x, 1e-13);
        }
    }
}

static void filon__without_a_wave_they_are_integrals_of_powers(mt_test *t)
{
    static mt_filon q;
    mt_filon_weights w = {.x = nan("")};
    mt_filon_make(&q);
    mt_filon_weigh(&q, 0.0, &w);
    for (int i = 0; i < POINTS; i++) {
        for (int n = 0; n <= MT_FILON_DEGREE; n++) {
            const double c = q.point[i];
            mt_test_row(t, "power %d, point %d", n, i);
            CHECK_NEAR_ABS(t, sum(&q, w.nc, i, n), pow(c, n + 1) / (n + 1), 1e-14);
            CHECK_NEAR_ABS(t, sum(&q, w.nd, i, n), pow(c, n + 2) / ((n + 1) * (n + 2)), 1e-14);
        }
    }
}

static void filon__both_ways_meet(mt_test *t)
{
    static mt_filon q;
    mt_filon_weights below = {.x = nan("")};
    mt_filon_weights above = {.x = nan("")};
    mt_filon_make(&q);
    mt_filon_weigh(&q, 50.0, &below);
    mt_filon_weigh(&q, nextafter(50.0, 51.0), &above);
    for (int i = 0; i < POINTS * POINTS; i++) {
        mt_test_row(t, "entry %d", i);
        CHECK_NEAR_ABS(t, above.nc[i], below.nc[i], 1e-12);
        CHECK_NEAR_ABS(t, above.nd[i], below.nd[i], 1e-12);
    }
}

MT_TEST_MAIN(MT_TEST(filon__lines_have_closed_forms),
             MT_TEST(filon__without_a_wave_they_are_integrals_of_powers),
             MT_TEST(filon__both_ways_meet))
