/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_INTERVAL_H
#define EXPR_INTERVAL_H

#include "expr/expr.h"

/*
 * Intervals of real numbers, lo <= hi, lo < +inf, hi > -inf. An operation on intervals encloses
 *   the exact result of the operation for any finite real operands in them, and
 *   the result of mt_op_value for any doubles in them, rounding errors included,
 * wherever that result is finite. Where an operand may leave the domain, or a divisor may be
 * zero, the result is the whole line. Assumptions: round to nearest; + - * / sqrt correctly
 * rounded (IEEE 754); functions of the C library accurate to MT_LIBM_ULPS units in the last
 * place.
 */
typedef struct mt_interval {
    double lo;
    double hi;
} mt_interval;

/* The GNU C library's table of errors for x86-64 (libm-test-ulps, its manual's "Known Maximum
 * Errors in Math Functions") has exp, ln, sin, cos, tan, pow, hypot and the inverse functions
 * at 1 unit or below, log10, sinh, cosh and tanh at 2, cbrt at 4 (3.07 measured over 2e5
 * arguments). An enclosure allows for this error twice: in its bound, and in the value it
 * encloses. */
enum { MT_LIBM_ULPS = 4, MT_INTERVAL_ULPS = 2 * MT_LIBM_ULPS };

mt_interval mt_interval_all(void);
mt_interval mt_interval_of(double lo, double hi);
bool mt_interval_has(mt_interval a, double x);
/* The smallest interval that contains both. */
mt_interval mt_interval_hull(mt_interval a, mt_interval b);

mt_interval mt_interval_add(mt_interval a, mt_interval b);
mt_interval mt_interval_sub(mt_interval a, mt_interval b);
mt_interval mt_interval_mul(mt_interval a, mt_interval b);
mt_interval mt_interval_div(mt_interval a, mt_interval b);
/* { x * x }: tighter than mt_interval_mul(a, a), whose factors are independent. */
mt_interval mt_interval_square(mt_interval a);

/* { op(x, y) }; b is ignored where op has one operand. The whole line for MT_OP_INTERP. */
mt_interval mt_interval_op(mt_op op, mt_interval a, mt_interval b);

typedef struct mt_interval_partials {
    mt_interval a;
    mt_interval b;
} mt_interval_partials;

/* Partial derivatives for all operands in a and b, v = mt_interval_op(op, a, b), by the
 * formulas of mt_op_partials term by term, so that they also enclose its rounded results. Not
 * for min and max. */
mt_interval_partials mt_interval_op_partials(mt_op op, mt_interval a, mt_interval b,
                                             mt_interval v);

#endif
