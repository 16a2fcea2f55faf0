/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_NAMES_H
#define EXPR_NAMES_H

#include "expr/expr.h"
#include "expr/kind.h"

/* Find a function or constant of the expression language by name (length bytes); false:
 * unknown. A constant has a kind (expr/kind.h): "mm" is a length. */
bool mt_expr_find_function(const char *name, size_t length, mt_op *op);
bool mt_expr_find_constant(const char *name, size_t length, double *value, mt_kind *kind);
/* True where the name is that of a function or a constant. */
bool mt_expr_reserved(const char *name);
/* Names of all functions and constants, for suggestions; *n their number. */
const char *const *mt_expr_names(int *n);

#endif
