/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_slope.h"

#include <math.h>

/* central difference of f in x[i] */
static double central(mt_slope_function *f, const void *ctx, int n, double *x, int i, double h)
{
    const double kept = x[i];
    x[i] = kept + h;
    const double up = x[i];
    const double f_up = f(ctx, n, x);
    x[i] = kept - h;
    const double down = x[i];
    const double f_down = f(ctx, n, x);
    x[i] = kept;
    return (f_up - f_down) / (up - down); /* the step that was really taken */
}

bool mt_slope_agrees(mt_slope_function *f, const void *ctx, int n, double *x, int i,
                     double slope, double step, double noise)
{
    /* the rounding of two evaluations over 2h, with room for a sum of terms that cancel */
    static const double ROUNDING_FACTOR = 100.0;
    const double size = fabs(f(ctx, n, x)) + fabs(step * slope);
    const double rounding = ROUNDING_FACTOR * noise * size / step;
    const double coarse = fabs(central(f, ctx, n, x, i, step) - slope);
    const double fine = fabs(central(f, ctx, n, x, i, 0.5 * step) - slope);
    if (coarse <= rounding && fine <= 2.0 * rounding) {
        return true;
    }
    const double ratio = coarse / fine;
    return ratio >= 3.5 && ratio <= 4.5;
}
