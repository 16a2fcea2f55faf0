/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_INTERVAL_H
#define EXPR_INTERVAL_H

#include "expr/expr.h"

/*
 * Intervals of real numbers, lo <= hi, lo < +inf, hi > -inf. An operation on intervals holds
 *   the exact result of the operation on any finite real operands within them, and
 *   what mt_op_value makes of any doubles within them, rounding errors included,
 * wherever that result exists (is finite). Where an operand may leave the domain, or a divisor
 * may be zero, the result is the whole line. What it rests on: round to nearest; + - * / sqrt
 * correctly rounded (IEEE 754); the functions of the C library wrong by at most MT_LIBM_ULPS
 * units in the last place.
 */
typedef struct mt_interval {
    double lo;
    double hi;
} mt_interval;

/* The GNU C library's own table of errors for x86-64 (libm-test-ulps, its manual's "Known
 * Maximum Errors in Math Functions") has exp, ln, sin, cos, tan, pow, hypot and the inverse
 * functions at 1 unit or below, log10, sinh, cosh and tanh at 2, cbrt at 4 (3.07 measured over
 * 2e5 arguments). An enclosure must bear this error twice: once in the bound, once in the value
 * it encloses. */
enum { MT_LIBM_ULPS = 4, MT_INTERVAL_ULPS = 2 * MT_LIBM_ULPS };

mt_interval mt_interval_all(void);
mt_interval mt_interval_of(double lo, double hi);
bool mt_interval_has(mt_interval a, double x);
/* The smallest interval that holds both. */
mt_interval mt_interval_hull(mt_interval a, mt_interval b);

mt_interval mt_interval_add(mt_interval a, mt_interval b);
mt_interval mt_interval_sub(mt_interval a, mt_interval b);
mt_interval mt_interval_mul(mt_interval a, mt_interval b);
mt_interval mt_interval_div(mt_interval a, mt_interval b);
/* { x * x }: tighter than the product of two that could differ. */
mt_interval mt_interval_square(mt_interval a);

/* { op(x, y) }; b is ignored where op has one operand. */
mt_interval mt_interval_op(mt_op op, mt_interval a, mt_interval b);

typedef struct mt_interval_partials {
    mt_interval a;
    mt_interval b;
} mt_interval_partials;

/* Partial derivatives, over all operands within a and b, v = mt_interval_op(op, a, b): term by
 * term the formulas of mt_op_partials, so that they hold its rounded results too. Not for min
 * and max. */
mt_interval_partials mt_interval_op_partials(mt_op op, mt_interval a, mt_interval b,
                                             mt_interval v);

#endif
