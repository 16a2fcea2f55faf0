/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_OP_H
#define EXPR_OP_H

#include "expr/expr.h"

/*
 * One operation v = op(a, b): name, operands, value and partial derivatives. Conventions where
 * mathematics leaves a choice: pow follows C (x^0 = 1 for every x, 0^0 included; a negative
 * base needs an exponent that is an integer); atan2(0, 0) = 0.
 */

#define MT_LN_10 2.302585092994045684 /* ln 10, rounded to a double */

/* "sqrt", "+", "number", "parameter"; never NULL. */
const char *mt_op_name(mt_op op);
/* Number of operands: 0, 1 or 2. */
int mt_op_operands(mt_op op);
/* Value; b is ignored where op has one operand. NaN or infinite outside the domain, without a
 * division by zero; of a condition 1 or 0. NaN for MT_OP_CONST, MT_OP_PARAM, MT_OP_INTERP and
 * what if() is made of. */
double mt_op_value(mt_op op, double a, double b);

typedef struct mt_partials {
    double a; /* dv/da */
    double b; /* dv/db; 0 where op has one operand */
} mt_partials;

/* Partial derivatives at (a, b) with v = mt_op_value(op, a, b); not finite where there is none.
 * At a kink the derivative of the first operand is taken: abs'(0) = 1, min(x, x) and max(x, x)
 * follow the first. */
mt_partials mt_op_partials(mt_op op, double a, double b, double v);

#endif
