/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * An integer n below 1e15 over (or times) a power of ten, which as p + e of two doubles is
 * exact up to 1e44; the quotient is corrected by its remainder.
 */
#include "base/digits.h"

#include <math.h>
#include <stdlib.h>

double mt_few_digits(double x)
{
    enum { DIGITS = 15, EXACT = 22, SUM = 44 };
    const int k = x == 0.0 ? 0 : DIGITS - 1 - (int)floor(log10(fabs(x)));
    double power = 1.0;
    double more = 1.0;
    if (k > SUM || k < -EXACT) {
        return nan("");
    }
    for (int i = 0; i < abs(k); i++) {
        *(i < EXACT ? &power : &more) *= 10.0;
    }
    if (k < 0) {
        return round(x / power) * power;
    }
    const double p = power * more;
    const double n = round(x * p);
    const double q = n / p;
    return q + (fma(-q, p, n) - q * fma(power, more, -p)) / p;
}
