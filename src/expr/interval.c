/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Interval arithmetic by widening: an operation is rounded to nearest, so its exact result lies
 * no further than the neighbouring double (nextafter); where an error-free transformation
 * proves the rounded result exact, it stands as it is. That keeps signs: [0, 1] + [0, 1] begins
 * at 0, not below, and its square root exists.
 */
#include "expr/interval.h"

#include <float.h>
#include <math.h>

mt_interval mt_interval_all(void)
{
    return (mt_interval){-HUGE_VAL, HUGE_VAL};
}

/* Everything that leaves this folder's arithmetic passes here: a NaN in a bound means nothing
 * known. */
mt_interval mt_interval_of(double lo, double hi)
{
    if (!(lo <= hi)) {
        return mt_interval_all();
    }
    return (mt_interval){lo < HUGE_VAL ? lo : DBL_MAX, hi > -HUGE_VAL ? hi : -DBL_MAX};
}

bool mt_interval_has(mt_interval a, double x)
{
    return a.lo <= x && x <= a.hi;
}

mt_interval mt_interval_hull(mt_interval a, mt_interval b)
{
    return mt_interval_of(a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi);
}

static double down(double x)
{
    return nextafter(x, -HUGE_VAL);
}

static double up(double x)
{
    return nextafter(x, HUGE_VAL);
}

/* Is s = fl(a + b) exact? The rounding error by Knuth's two-sum; NaN after an overflow says
 * no. */
static bool sum_exact(double a, double b, double s)
{
    const double bb = s - a;
    return (a - (s - bb)) + (b - bb) == 0.0;
}

/* Below this a product's rounding error may itself underflow, and fma(a, b, -p) prove
 * nothing. */
static const double EXACT_ABOVE = DBL_MIN / DBL_EPSILON;

/* Is p = fl(a * b) exact, p /= 0? */
static bool product_exact(double a, double b, double p)
{
    return fabs(p) > EXACT_ABOVE && isfinite(p) && fma(a, b, -p) == 0.0;
}

static bool both_finite(double a, double b)
{
    return isfinite(a) && isfinite(b);
}

mt_interval mt_interval_neg(mt_interval a)
{
    return (mt_interval){-a.hi, -a.lo};
}

mt_interval mt_interval_add(mt_interval a, mt_interval b)
{
    const double lo = a.lo + b.lo;
    const double hi = a.hi + b.hi;
    const bool lo_known = !both_finite(a.lo, b.lo) || sum_exact(a.lo, b.lo, lo);
    const bool hi_known = !both_finite(a.hi, b.hi) || sum_exact(a.hi, b.hi, hi);
    return mt_interval_of(lo_known ? lo : down(lo), hi_known ? hi : up(hi));
}

mt_interval mt_interval_sub(mt_interval a, mt_interval b)
{
    return mt_interval_add(a, mt_interval_neg(b));
}

/* Bounds of the exact product of two bounds. Zero times an infinite bound is 0: the factor that
 * the bound stands for is finite. A result that underflows to 0 keeps its sign. */
static mt_interval product_of(double a, double b)
{
    if (a == 0.0 || b == 0.0) {
        return (mt_interval){0.0, 0.0};
    }
    const double p = a * b;
    if (!both_finite(a, b) || product_exact(a, b, p)) {
        return (mt_interval){p, p};
    }
    const bool positive = (a > 0.0) == (b > 0.0);
    return (mt_interval){positive && p == 0.0 ? 0.0 : down(p),
                         !positive && p == 0.0 ? 0.0 : up(p)};
}

static mt_interval hull_of_four(mt_interval p, mt_interval q, mt_interval r, mt_interval s)
{
    return mt_interval_hull(mt_interval_hull(p, q), mt_interval_hull(r, s));
}

mt_interval mt_interval_mul(mt_interval a, mt_interval b)
{
    return hull_of_four(product_of(a.lo, b.lo), product_of(a.lo, b.hi), product_of(a.hi, b.lo),
                        product_of(a.hi, b.hi));
}

/* Bounds of the exact quotient of two bounds, b /= 0. */
static mt_interval quotient_of(double a, double b)
{
    if (a == 0.0 || isinf(b)) {
        /* a finite number over one that grows without bound tends to 0; inf / inf is settled by
         * the quotients of the other bounds, between which it must lie with 0 */
        return (mt_interval){0.0, 0.0};
    }
    const double q = a / b;
    if (isinf(a)) {
        return (mt_interval){q, q};
    }
    if (isfinite(q) && fabs(q) > EXACT_ABOVE && fabs(a) > EXACT_ABOVE && fma(q, b, -a) == 0.0) {
        return (mt_interval){q, q};
    }
    const bool positive = (a > 0.0) == (b > 0.0);
    return (mt_interval){positive && q == 0.0 ? 0.0 : down(q),
                         !positive && q == 0.0 ? 0.0 : up(q)};
}

mt_interval mt_interval_div(mt_interval a, mt_interval b)
{
    if (mt_interval_has(b, 0.0)) {
        return mt_interval_all();
    }
    return hull_of_four(quotient_of(a.lo, b.lo), quotient_of(a.lo, b.hi),
                        quotient_of(a.hi, b.lo), quotient_of(a.hi, b.hi));
}

double mt_interval_mig(mt_interval a)
{
    return mt_interval_has(a, 0.0) ? 0.0 : fmin(fabs(a.lo), fabs(a.hi));
}

double mt_interval_mag(mt_interval a)
{
    return fmax(fabs(a.lo), fabs(a.hi));
}

mt_interval mt_interval_square(mt_interval a)
{
    const double mig = mt_interval_mig(a);
    const double mag = mt_interval_mag(a);
    return mt_interval_hull(product_of(mig, mig), product_of(mag, mag));
}
