/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_SECOND_H
#define EXPR_SECOND_H

#include "expr/program.h"

/* Second derivatives: of one operation, and of a program of one input. */
typedef struct mt_curvatures {
    double aa; /* d2v/da2 */
    double ab;
    double bb;
} mt_curvatures;

/* At (a, b) with v = mt_op_value(op, a, b); not finite where there is none, 0 at and beside
 * kinks. */
mt_curvatures mt_op_curvatures(mt_op op, double a, double b, double v);
/* node[count] = value, first and second derivative by the input at t, of a program with one
 * input. O(count). Fails: MT_E_DOMAIN where one of them is not finite. */
mt_status mt_program_second(const mt_program *p, double t, double (*node)[3], mt_err *err);

#endif
