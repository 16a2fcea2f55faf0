/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_MEASURES_H
#define EXPR_MEASURES_H

#include "expr/expr.h"
#include "expr/unit_text.h"

/* Finds the unit of a parameter; false: none given. */
typedef bool (*mt_measures_lookup)(const void *context, int parameter, mt_unit_worth *out);

/*
 * Dimension of an expression from the units of its parameters and constants: powers of m, kg, s
 * (rad is ignored). False where it is not determined: a parameter has no unit, a number may be
 * a quantity (an arm of 0.05; whole numbers up to 12 are factors), or nothing has a unit.
 * O(length).
 */
bool mt_expr_measures(const mt_expr *e, mt_measures_lookup lookup, const void *context,
                      mt_unit_worth *out);

#endif
