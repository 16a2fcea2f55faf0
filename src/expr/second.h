/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_SECOND_H
#define EXPR_SECOND_H

#include "expr/program.h"

/* node[count] = value, first and second derivative by the input at t, for a program with one
 * input. O(count). Fails: MT_E_DOMAIN where one of them is not finite. */
mt_status mt_program_second(const mt_program *p, double t, double (*node)[3], mt_err *err);

#endif
