/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "expr/names.h"

#include <string.h>

#include "expr/kind.h"

/* One list makes the table of functions, that of constants and the names that are reserved. */
#define FUNCTION_LIST(X)    \
    X("sqrt", MT_OP_SQRT)   \
    X("cbrt", MT_OP_CBRT)   \
    X("exp", MT_OP_EXP)     \
    X("ln", MT_OP_LN)       \
    X("log10", MT_OP_LOG10) \
    X("sin", MT_OP_SIN)     \
    X("cos", MT_OP_COS)     \
    X("tan", MT_OP_TAN)     \
    X("asin", MT_OP_ASIN)   \
    X("acos", MT_OP_ACOS)   \
    X("atan", MT_OP_ATAN)   \
    X("sinh", MT_OP_SINH)   \
    X("cosh", MT_OP_COSH)   \
    X("tanh", MT_OP_TANH)   \
    X("abs", MT_OP_ABS)     \
    X("atan2", MT_OP_ATAN2) \
    X("min", MT_OP_MIN)     \
    X("max", MT_OP_MAX)     \
    X("hypot", MT_OP_HYPOT) \
    X("pow", MT_OP_POW)
/* The constants that are units are worth what expr/units.h says; pi is its own. */
#define CONSTANT_LIST(X) \
    X("pi", NULL)        \
    X("deg", "deg")      \
    X("rpm", "rpm")      \
    X("mm", "mm")        \
    X("cm", "cm")        \
    X("inch", "in")      \
    X("ft", "ft")

#define NAME_ENTRY(name, value)  name,
#define VALUE_ENTRY(name, value) value,

static const char *const reserved_names[] = {FUNCTION_LIST(NAME_ENTRY)
                                                 CONSTANT_LIST(NAME_ENTRY)};
static const mt_op function_ops[] = {FUNCTION_LIST(VALUE_ENTRY)};
static const char *const constant_units[] = {CONSTANT_LIST(VALUE_ENTRY)};

enum {
    N_NAMES = MT_COUNT(reserved_names),
    N_FUNCTIONS = MT_COUNT(function_ops),
};

static bool is_reserved_word(const char *name, size_t length, const char *reserved)
{
    return strlen(reserved) == length && memcmp(name, reserved, length) == 0;
}

bool mt_expr_find_function(const char *name, size_t length, mt_op *op)
{
    for (int i = 0; i < N_FUNCTIONS; i++) {
        if (is_reserved_word(name, length, reserved_names[i])) {
            *op = function_ops[i];
            return true;
        }
    }
    return false;
}

bool mt_expr_find_constant(const char *name, size_t length, double *value, mt_kind *kind)
{
    static const double pi = 3.14159265358979323846;
    for (int i = N_FUNCTIONS; i < N_NAMES; i++) {
        if (is_reserved_word(name, length, reserved_names[i])) {
            const char *const of = constant_units[i - N_FUNCTIONS];
            const mt_unit *const unit = of == NULL ? NULL : mt_unit_find(of);
            *value = unit == NULL ? pi : mt_unit_factor(unit);
            *kind = unit == NULL ? MT_KIND_PI : mt_kind_of_dimension(unit->dimension);
            return true;
        }
    }
    return false;
}

bool mt_expr_reserved(const char *name)
{
    for (int i = 0; i < N_NAMES; i++) {
        if (strcmp(name, reserved_names[i]) == 0) {
            return true;
        }
    }
    return false;
}

const char *const *mt_expr_names(int *n)
{
    *n = N_NAMES;
    return reserved_names;
}
