/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Postfix code with powers in place of values:
 *     a b: sum of powers;   a/b: difference;   a^c, sqrt, cbrt: c times;   a + b, min, max:
 *     those of both, where they are equal;   sin, exp, ...: none
 * Powers are counted in sixths, so that a root of a root is exact.
 */
#include "expr/measures.h"

#include <math.h>
#include <string.h>

#include "expr/kind.h"
#include "expr/op.h"

enum { SIXTHS = 6 };

/* Formulas have whole factors up to this one, of inertias; a larger number may be a quantity,
 * and so may a fraction. */
static const double MOST_FACTOR = 12.0;
/* Sixths of a power that no quantity has. */
static const double MOST_SIXTHS = 100.0;

/* Rounding of a third of a whole number. */
static const double WHOLE = 1e-9;

typedef struct powers {
    double value; /* of a literal number, for exponents; NaN: none */
    int sixths[MT_BASE_RAD];
    bool known;
    bool number;  /* it has no unit in it: in a sum it is what the other is */
    bool literal; /* a unit: a number in front of it is one of these */
} powers;

static powers constant(const mt_code *c)
{
    powers p = {.known = true, .literal = true, .value = c->value};
    switch ((mt_kind)c->param) {
    case MT_KIND_LENGTH:
        p.sixths[MT_BASE_M] = SIXTHS;
        break;
    case MT_KIND_SPEED:
        p.sixths[MT_BASE_S] = -SIXTHS;
        break;
    case MT_KIND_ANGLE:
        break;
    case MT_KIND_PI:
        p.number = true;
        p.literal = false;
        break;
    case MT_KIND_NUMBER:
    case MT_KIND_ZERO:
    case MT_KIND_AREA:
    case MT_KIND_UNKNOWN:
    default:
        p.number = true;
        p.literal = false;
        p.known = c->value == floor(c->value) && fabs(c->value) <= MOST_FACTOR;
        break;
    }
    return p;
}

static powers raised(const powers *a, double exponent)
{
    powers p = *a;
    p.value = nan("");
    p.literal = false;
    /* a number to a power is an arm squared as well as a factor */
    p.known = a->known && !a->number && isfinite(exponent);
    for (int k = 0; k < MT_BASE_RAD && p.known; k++) {
        const double sixths = exponent * a->sixths[k];
        p.known = fabs(sixths) <= MOST_SIXTHS && fabs(sixths - round(sixths)) <= WHOLE;
        p.sixths[k] = p.known ? (int)lround(sixths) : 0;
    }
    return p;
}

static powers product_of_powers(const powers *a, const powers *b, int sign)
{
    const bool both = a->known && b->known;
    powers p = {.known = both || (a->number && b->literal) || (a->literal && b->number),
                .number = a->number && b->number,
                .value = nan("")};
    for (int k = 0; k < MT_BASE_RAD; k++) {
        p.sixths[k] = a->sixths[k] + (sign * b->sixths[k]);
    }
    return p;
}

static powers sum(const powers *a, const powers *b)
{
    powers p = a->number ? *b : *a;
    p.value = nan("");
    p.literal = false;
    if (!a->number && !b->number) {
        p.known = a->known && b->known && memcmp(a->sixths, b->sixths, sizeof a->sixths) == 0;
    }
    return p;
}

static powers unary(mt_op op, const powers *a)
{
    switch ((int)op) {
    case MT_OP_NEG: {
        powers p = *a;
        p.value = -a->value;
        return p;
    }
    case MT_OP_ABS:
        return *a;
    case MT_OP_SQRT:
        return raised(a, 1.0 / 2.0);
    case MT_OP_CBRT:
        return raised(a, 1.0 / 3.0);
    default:
        return (powers){.known = true, .number = true, .value = nan("")};
    }
}

static powers binary(mt_op op, const powers *a, const powers *b)
{
    switch ((int)op) {
    case MT_OP_ADD:
    case MT_OP_SUB:
    case MT_OP_MIN:
    case MT_OP_MAX:
    case MT_OP_HYPOT:
        return sum(a, b);
    case MT_OP_MUL:
        return product_of_powers(a, b, 1);
    case MT_OP_DIV:
        return product_of_powers(a, b, -1);
    case MT_OP_POW:
        return raised(a, b->value);
    default:
        return (powers){.known = true, .number = true, .value = nan("")};
    }
}

static powers leaf(const mt_code *c, mt_measures_lookup lookup, const void *context)
{
    mt_unit_worth is;
    powers p = {.known = true, .value = nan("")};
    if (c->op == MT_OP_CONST) {
        return constant(c);
    }
    if (!lookup(context, c->param, &is)) {
        return (powers){.known = false};
    }
    for (int k = 0; k < MT_BASE_RAD; k++) {
        p.sixths[k] = SIXTHS * is.power[k];
    }
    return p;
}

/* The whole expression, in stack[0]; false: none that was parsed. */
static bool measure_expression(const mt_expr *e, mt_measures_lookup lookup, const void *context,
                               powers *stack)
{
    int n = 0;
    for (int i = 0; i < e->length; i++) {
        const mt_op op = e->code[i].op;
        const int operands = mt_op_operands(op);
        if (operands <= 0) {
            stack[n++] = leaf(&e->code[i], lookup, context);
        } else if (n < operands) {
            return false;
        } else if (operands == 1) {
            stack[n - 1] = unary(op, &stack[n - 1]);
        } else {
            stack[n - 2] = binary(op, &stack[n - 2], &stack[n - 1]);
            n--;
        }
    }
    return n == 1;
}

bool mt_expr_measures(const mt_expr *e, mt_measures_lookup lookup, const void *context,
                      mt_unit_worth *out)
{
    powers stack[MT_EXPR_MAX_CODE];
    *out = (mt_unit_worth){.factor = 1.0};
    if (!measure_expression(e, lookup, context, stack) || !stack[0].known || stack[0].number) {
        return false;
    }
    bool any = e->length == 1; /* a multiple of a ratio may be a multiple of anything */
    for (int k = 0; k < MT_BASE_RAD; k++) {
        if (stack[0].sixths[k] % SIXTHS != 0) {
            return false;
        }
        out->power[k] = stack[0].sixths[k] / SIXTHS;
        any = any || out->power[k] != 0;
    }
    return any;
}
