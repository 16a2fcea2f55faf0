/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/tie.h"

#include <math.h>

bool mt_exceeds(double a, double b)
{
    const double size = fmax(fabs(a), fabs(b));
    return a > b && (isinf(size) || a - b > MT_TIE * size);
}

double mt_without_noise(double x, double noise)
{
    return fabs(x) < noise ? 0.0 : x;
}
