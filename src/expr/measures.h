/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_MEASURES_H
#define EXPR_MEASURES_H

#include "expr/expr.h"
#include "expr/unit_text.h"

/* The unit of a parameter; false: it has none, or nobody says. */
typedef bool (*mt_measures_lookup)(const void *context, int parameter, mt_unit_worth *out);

/*
 * What an expression measures, by the units of its parameters and constants: powers of m, kg, s
 * (those of rad are not told). False: that is not determined, since a parameter has no unit or
 * a number may stand for something that has one (an arm of 0.05, where whole numbers are
 * factors), or nothing in it has a unit. O(length).
 */
bool mt_expr_measures(const mt_expr *e, mt_measures_lookup lookup, const void *context,
                      mt_unit_worth *out);

#endif
