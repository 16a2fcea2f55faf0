/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Interval arithmetic by widening: an operation is rounded to nearest, so its exact result lies
 * no further than the neighbouring double; where an error-free transformation
 * proves the rounded result exact, it stands as it is. That keeps signs: [0, 1] + [0, 1] begins
 * at 0, not below, and its square root exists.
 */
#include "expr/interval.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "expr/op.h"

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

/* The neighbour above, nextafter(x, HUGE_VAL): doubles of one sign follow each other as the
 * integers do that have their bits. */
static double up(double x)
{
    uint64_t bits = 0;
    if (!(x < HUGE_VAL)) {
        return x;
    }
    if (x == 0.0) {
        return DBL_TRUE_MIN;
    }
    memcpy(&bits, &x, sizeof bits);
    bits = x > 0.0 ? bits + 1 : bits - 1;
    memcpy(&x, &bits, sizeof bits);
    return x;
}

static double down(double x)
{
    return -up(-x);
}

/* True where s = fl(a + b) is exact: the rounding error by Knuth's two-sum is 0. NaN after an
 * overflow says no. */
static bool sum_exact(double a, double b, double s)
{
    const double bb = s - a;
    return (a - (s - bb)) + (b - bb) == 0.0;
}

/* Below this a product's rounding error may itself underflow, and fma(a, b, -p) prove
 * nothing. */
static const double EXACT_ABOVE = DBL_MIN / DBL_EPSILON;

/* True where p = fl(a * b) is exact, p /= 0. */
static bool product_exact(double a, double b, double p)
{
    return fabs(p) > EXACT_ABOVE && isfinite(p) && fma(a, b, -p) == 0.0;
}

static bool both_finite(double a, double b)
{
    return isfinite(a) && isfinite(b);
}

static mt_interval negative(mt_interval a)
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
    return mt_interval_add(a, negative(b));
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

/* a * b, a >= 0: by signs two products are the bounds. */
static mt_interval times_positive(mt_interval a, mt_interval b)
{
    return mt_interval_of(product_of(b.lo >= 0.0 ? a.lo : a.hi, b.lo).lo,
                          product_of(b.hi >= 0.0 ? a.hi : a.lo, b.hi).hi);
}

mt_interval mt_interval_mul(mt_interval a, mt_interval b)
{
    if (a.lo >= 0.0) {
        return times_positive(a, b);
    }
    if (b.lo >= 0.0) {
        return times_positive(b, a);
    }
    if (a.hi <= 0.0) {
        return negative(times_positive(negative(a), b));
    }
    if (b.hi <= 0.0) {
        return negative(times_positive(negative(b), a));
    }
    return mt_interval_hull(mt_interval_hull(product_of(a.lo, b.lo), product_of(a.hi, b.hi)),
                            mt_interval_hull(product_of(a.lo, b.hi), product_of(a.hi, b.lo)));
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

/* a / b, b > 0: by signs two quotients are the bounds. */
static mt_interval over_positive(mt_interval a, mt_interval b)
{
    return mt_interval_of(quotient_of(a.lo, a.lo >= 0.0 ? b.hi : b.lo).lo,
                          quotient_of(a.hi, a.hi >= 0.0 ? b.lo : b.hi).hi);
}

mt_interval mt_interval_div(mt_interval a, mt_interval b)
{
    if (mt_interval_has(b, 0.0)) {
        return mt_interval_all();
    }
    return b.lo > 0.0 ? over_positive(a, b) : over_positive(negative(a), negative(b));
}

/* The lesser and the greater of |x| over the interval. */
static double mig(mt_interval a)
{
    return mt_interval_has(a, 0.0) ? 0.0 : fmin(fabs(a.lo), fabs(a.hi));
}

static double mag(mt_interval a)
{
    return fmax(fabs(a.lo), fabs(a.hi));
}

mt_interval mt_interval_square(mt_interval a)
{
    const double low = mig(a);
    const double high = mag(a);
    return mt_interval_hull(product_of(low, low), product_of(high, high));
}

/*
 * Elementary functions of intervals. A monotone function takes its bounds at the ends, computed
 * by the C library and widened by MT_INTERVAL_ULPS neighbours; bounds that the function never
 * passes (|sin| <= 1, exp > 0) cut that off again. The library keeps to those bounds, too.
 */

/* pi rounded to a double lies below pi by 1.2e-16, its neighbour above. */
static const double PI = 3.14159265358979323846;

static double far_up(double x)
{
    for (int i = 0; i < MT_INTERVAL_ULPS; i++) {
        x = up(x);
    }
    return x;
}

/* [lo, hi] widened, but not beyond [least, most]. */
static mt_interval widen_within(double lo, double hi, double least, double most)
{
    const double wide_lo = -far_up(-lo);
    const double wide_hi = far_up(hi);
    if (isnan(lo) || isnan(hi)) {
        return mt_interval_of(least, most);
    }
    return mt_interval_of(wide_lo > least ? wide_lo : least, wide_hi < most ? wide_hi : most);
}

static mt_interval increasing(double (*f)(double), mt_interval a, double least, double most)
{
    return widen_within(f(a.lo), f(a.hi), least, most);
}

static mt_interval logarithm(double (*f)(double), mt_interval a)
{
    return a.lo <= 0.0 ? mt_interval_all() : increasing(f, a, -HUGE_VAL, HUGE_VAL);
}

/*
 * True where the interval may contain a point (k + phase) * period, k an integer. With t = x /
 * period - phase that is an integer between t(lo) and t(hi). The four roundings (period,
 * quotient, product and difference) leave an error below 4 eps (|t| + 1); twice that is allowed
 * for, and true is the safe side.
 */
static bool has_point(mt_interval a, double phase, double period)
{
    static const double GUARD = 8.0 * DBL_EPSILON;
    const double lo = a.lo / period - phase;
    const double hi = a.hi / period - phase;
    return floor(hi + GUARD * (fabs(hi) + 1.0)) >= ceil(lo - GUARD * (fabs(lo) + 1.0));
}

/* A wave with maxima at (k + crest) * 2 pi and minima half a period on. */
static mt_interval wave(double (*f)(double), mt_interval a, double crest)
{
    if (!(a.hi - a.lo < 2.0 * PI)) {
        return mt_interval_of(-1.0, 1.0);
    }
    const double first = f(a.lo);
    const double last = f(a.hi);
    const double lo = has_point(a, crest + 0.5, 2.0 * PI) ? -1.0 : fmin(first, last);
    const double hi = has_point(a, crest, 2.0 * PI) ? 1.0 : fmax(first, last);
    return widen_within(lo, hi, -1.0, 1.0);
}

static mt_interval op_tan(mt_interval a)
{
    if (!(a.hi - a.lo < PI) || has_point(a, 0.5, PI)) {
        return mt_interval_all();
    }
    return increasing(tan, a, -HUGE_VAL, HUGE_VAL);
}

static bool within_one(mt_interval a)
{
    return a.lo >= -1.0 && a.hi <= 1.0;
}

/* a^n, n an integer other than 0, |n| beyond 2^53 included: those are even. */
static mt_interval integer_power(mt_interval a, double n)
{
    if (n < 0.0 && mt_interval_has(a, 0.0)) {
        return mt_interval_all();
    }
    if (fmod(n, 2.0) == 0.0) {
        const double at_mig = pow(mig(a), n);
        const double at_mag = pow(mag(a), n);
        return widen_within(fmin(at_mig, at_mag), fmax(at_mig, at_mag), 0.0, HUGE_VAL);
    }
    /* odd: n > 0 increases everywhere, n < 0 decreases on either side of 0; the sign is that of
     * a */
    const double at_lo = pow(a.lo, n);
    const double at_hi = pow(a.hi, n);
    return widen_within(fmin(at_lo, at_hi), fmax(at_lo, at_hi), a.lo >= 0.0 ? 0.0 : -HUGE_VAL,
                        a.hi <= 0.0 ? 0.0 : HUGE_VAL);
}

/* a^b. For a > 0 it is monotone in a at fixed b, and in b at fixed a: the bounds are at the
 * corners. */
static mt_interval op_pow(mt_interval a, mt_interval b)
{
    if (b.lo == b.hi && b.lo == floor(b.lo)) {
        return b.lo == 0.0 ? mt_interval_of(1.0, 1.0) : integer_power(a, b.lo);
    }
    if (a.lo < 0.0 || (a.lo == 0.0 && b.lo <= 0.0)) {
        return mt_interval_all();
    }
    const double ll = pow(a.lo, b.lo);
    const double lh = pow(a.lo, b.hi);
    const double hl = pow(a.hi, b.lo);
    const double hh = pow(a.hi, b.hi);
    return widen_within(fmin(fmin(ll, lh), fmin(hl, hh)), fmax(fmax(ll, lh), fmax(hl, hh)), 0.0,
                        HUGE_VAL);
}

/* The angle of the points (x, y) of a rectangle: the bounds are at corners, unless it touches
 * the branch cut y = 0, x <= 0, on whose two sides the angle is pi and -pi. */
static mt_interval op_atan2(mt_interval y, mt_interval x)
{
    if (x.lo <= 0.0 && mt_interval_has(y, 0.0)) {
        return widen_within(-PI, PI, -HUGE_VAL, HUGE_VAL);
    }
    const double ll = atan2(y.lo, x.lo);
    const double lh = atan2(y.lo, x.hi);
    const double hl = atan2(y.hi, x.lo);
    const double hh = atan2(y.hi, x.hi);
    return widen_within(fmin(fmin(ll, lh), fmin(hl, hh)), fmax(fmax(ll, lh), fmax(hl, hh)),
                        -HUGE_VAL, HUGE_VAL);
}

mt_interval mt_interval_op(mt_op op, mt_interval a, mt_interval b)
{
    switch (op) {
    case MT_OP_NEG:
        return negative(a);
    case MT_OP_SQRT:
        return a.lo < 0.0 ? mt_interval_all() : increasing(sqrt, a, 0.0, HUGE_VAL);
    case MT_OP_CBRT:
        return increasing(cbrt, a, -HUGE_VAL, HUGE_VAL);
    case MT_OP_EXP:
        return increasing(exp, a, 0.0, HUGE_VAL);
    case MT_OP_LN:
        return logarithm(log, a);
    case MT_OP_LOG10:
        return logarithm(log10, a);
    case MT_OP_SIN:
        return wave(sin, a, 0.25);
    case MT_OP_COS:
        return wave(cos, a, 0.0);
    case MT_OP_TAN:
        return op_tan(a);
    case MT_OP_ASIN:
        return within_one(a) ? increasing(asin, a, -HUGE_VAL, HUGE_VAL) : mt_interval_all();
    case MT_OP_ACOS:
        return within_one(a) ? widen_within(acos(a.hi), acos(a.lo), 0.0, HUGE_VAL)
                             : mt_interval_all();
    case MT_OP_ATAN:
        return increasing(atan, a, -HUGE_VAL, HUGE_VAL);
    case MT_OP_SINH:
        return increasing(sinh, a, -HUGE_VAL, HUGE_VAL);
    case MT_OP_COSH:
        return widen_within(cosh(mig(a)), cosh(mag(a)), 1.0, HUGE_VAL);
    case MT_OP_TANH:
        return increasing(tanh, a, -1.0, 1.0);
    case MT_OP_ABS:
        return mt_interval_of(mig(a), mag(a));
    case MT_OP_ADD:
        return mt_interval_add(a, b);
    case MT_OP_SUB:
        return mt_interval_sub(a, b);
    case MT_OP_MUL:
        return mt_interval_mul(a, b);
    case MT_OP_DIV:
        return mt_interval_div(a, b);
    case MT_OP_POW:
        return op_pow(a, b);
    case MT_OP_ATAN2:
        return op_atan2(a, b);
    case MT_OP_MIN:
        return mt_interval_of(fmin(a.lo, b.lo), fmin(a.hi, b.hi));
    case MT_OP_MAX:
        return mt_interval_of(fmax(a.lo, b.lo), fmax(a.hi, b.hi));
    case MT_OP_HYPOT:
        return widen_within(hypot(mig(a), mig(b)), hypot(mag(a), mag(b)), 0.0, HUGE_VAL);
    case MT_OP_NOT: /* of conditions, which are decided, nothing is asked */
    case MT_OP_IF:
    case MT_OP_LESS:
    case MT_OP_AT_MOST:
    case MT_OP_GREATER:
    case MT_OP_AT_LEAST:
    case MT_OP_EQUAL:
    case MT_OP_AND:
    case MT_OP_OR:
    case MT_OP_THEN:
    case MT_OP_ELSE:
    case MT_OP_INTERP:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return mt_interval_all();
}

static mt_interval point(double x)
{
    return mt_interval_of(x, x);
}

static mt_interval inverse(mt_interval a)
{
    return mt_interval_div(point(1.0), a);
}

static mt_interval unary_op(mt_op op, mt_interval a)
{
    return mt_interval_op(op, a, a);
}

/* 1 / sqrt((1 - a) (1 + a)) */
static mt_interval asin_slope(mt_interval a)
{
    const mt_interval one = point(1.0);
    const mt_interval product =
        mt_interval_mul(mt_interval_sub(one, a), mt_interval_add(one, a));
    return inverse(unary_op(MT_OP_SQRT, product));
}

static mt_interval tanh_slope(mt_interval a)
{
    const mt_interval c = unary_op(MT_OP_COSH, a);
    return mt_interval_div(inverse(c), c);
}

/* abs'(0) = 1 by convention, so only an interval wholly below 0 has slope -1. */
static mt_interval abs_slope(mt_interval a)
{
    return mt_interval_of(a.lo >= 0.0 ? 1.0 : -1.0, a.hi < 0.0 ? -1.0 : 1.0);
}

static mt_interval_partials pow_partials(mt_interval a, mt_interval b, mt_interval v)
{
    mt_interval_partials d = {point(0.0), mt_interval_all()};
    if (b.lo != 0.0 || b.hi != 0.0) {
        const mt_interval less = mt_interval_sub(b, point(1.0));
        d.a = mt_interval_mul(b, mt_interval_op(MT_OP_POW, a, less));
    }
    if (a.lo > 0.0) {
        d.b = mt_interval_mul(v, unary_op(MT_OP_LN, a));
    }
    return d;
}

static mt_interval_partials atan2_partials(mt_interval a, mt_interval b)
{
    const mt_interval h = mt_interval_op(MT_OP_HYPOT, a, b);
    return (mt_interval_partials){
        mt_interval_div(mt_interval_div(b, h), h),
        negative(mt_interval_div(mt_interval_div(a, h), h)),
    };
}

/* a / v with v = hypot(a, b), which is never beyond 1 but for the rounding of hypot. */
static mt_interval cosine(mt_interval a, mt_interval v)
{
    static const double ONE = 1.0 + MT_INTERVAL_ULPS * DBL_EPSILON;
    const mt_interval q = mt_interval_div(a, v);
    return mt_interval_of(fmax(q.lo, -ONE), fmin(q.hi, ONE));
}

/* ln 10 itself, which no double is. */
static mt_interval ln_10(void)
{
    return (mt_interval){down(MT_LN_10), up(MT_LN_10)};
}

static mt_interval_partials slope(mt_interval a)
{
    return (mt_interval_partials){a, point(0.0)};
}

mt_interval_partials mt_interval_op_partials(mt_op op, mt_interval a, mt_interval b,
                                             mt_interval v)
{
    const mt_interval one = point(1.0);
    switch (op) {
    case MT_OP_NEG:
        return slope(point(-1.0));
    case MT_OP_SQRT:
        return slope(mt_interval_div(point(0.5), v));
    case MT_OP_CBRT:
        return slope(inverse(mt_interval_mul(point(3.0), mt_interval_square(v))));
    case MT_OP_EXP:
        return slope(v);
    case MT_OP_LN:
        return slope(a.lo <= 0.0 ? mt_interval_all() : inverse(a));
    case MT_OP_LOG10:
        return slope(a.lo <= 0.0 ? mt_interval_all() : inverse(mt_interval_mul(a, ln_10())));
    case MT_OP_SIN:
        return slope(unary_op(MT_OP_COS, a));
    case MT_OP_COS:
        return slope(negative(unary_op(MT_OP_SIN, a)));
    case MT_OP_TAN:
        return slope(mt_interval_add(one, mt_interval_square(v)));
    case MT_OP_ASIN:
        return slope(asin_slope(a));
    case MT_OP_ACOS:
        return slope(negative(asin_slope(a)));
    case MT_OP_ATAN:
        return slope(inverse(mt_interval_add(one, mt_interval_square(a))));
    case MT_OP_SINH:
        return slope(unary_op(MT_OP_COSH, a));
    case MT_OP_COSH:
        return slope(unary_op(MT_OP_SINH, a));
    case MT_OP_TANH:
        return slope(tanh_slope(a));
    case MT_OP_ABS:
        return slope(abs_slope(a));
    case MT_OP_ADD:
        return (mt_interval_partials){one, one};
    case MT_OP_SUB:
        return (mt_interval_partials){one, point(-1.0)};
    case MT_OP_MUL:
        return (mt_interval_partials){b, a};
    case MT_OP_DIV:
        return (mt_interval_partials){inverse(b), negative(mt_interval_div(v, b))};
    case MT_OP_POW:
        return pow_partials(a, b, v);
    case MT_OP_ATAN2:
        return atan2_partials(a, b);
    case MT_OP_HYPOT:
        return (mt_interval_partials){cosine(a, v), cosine(b, v)};
    case MT_OP_MIN:
    case MT_OP_MAX:
    case MT_OP_NOT: /* of conditions, which are decided, nothing is asked */
    case MT_OP_IF:
    case MT_OP_LESS:
    case MT_OP_AT_MOST:
    case MT_OP_GREATER:
    case MT_OP_AT_LEAST:
    case MT_OP_EQUAL:
    case MT_OP_AND:
    case MT_OP_OR:
    case MT_OP_THEN:
    case MT_OP_ELSE:
    case MT_OP_INTERP:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return (mt_interval_partials){mt_interval_all(), mt_interval_all()};
}
