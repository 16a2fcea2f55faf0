/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an expression measures: kinds, and powers of units. */
#include "expr/kind.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/format.h"
#include "expr/op.h"

/* One walk over the postfix code with a stack of kinds; constants are folded, so that the
 * number which is told is the one that counts ("2*25" is 50). */

typedef struct part {
    double value; /* where nothing but numbers is in it; NaN: not known */
    double bare;
    mt_kind kind;
    bool mixed; /* as in mt_kind_found */
} part;

static part made(mt_kind kind, double value, bool mixed, double bare)
{
    return (part){.value = value, .bare = bare, .kind = kind, .mixed = mixed};
}

/* Rule for the kind of an operation's result. */
typedef enum rule {
    RULE_NUMBER,  /* sin, exp, ln: a number, of whatever */
    RULE_UNKNOWN, /* interp */
    RULE_SAME,
    RULE_ROOT,
    RULE_ANGLE,
    RULE_SUM,
    RULE_PRODUCT,
    RULE_POWER,
    RULE_COMPARISON, /* a number, of two of one kind */
    RULE_LAST        /* THEN: the kind of what is chosen */
} rule;
static const rule rule_of[MT_OP_COUNT] = {
    [MT_OP_NEG] = RULE_SAME,
    [MT_OP_ABS] = RULE_SAME,
    [MT_OP_SQRT] = RULE_ROOT,
    [MT_OP_CBRT] = RULE_ROOT,
    [MT_OP_ASIN] = RULE_ANGLE,
    [MT_OP_ACOS] = RULE_ANGLE,
    [MT_OP_ATAN] = RULE_ANGLE,
    [MT_OP_ATAN2] = RULE_ANGLE,
    [MT_OP_ADD] = RULE_SUM,
    [MT_OP_SUB] = RULE_SUM,
    [MT_OP_MIN] = RULE_SUM,
    [MT_OP_MAX] = RULE_SUM,
    [MT_OP_HYPOT] = RULE_SUM,
    [MT_OP_MUL] = RULE_PRODUCT,
    [MT_OP_DIV] = RULE_PRODUCT,
    [MT_OP_POW] = RULE_POWER,
    [MT_OP_INTERP] = RULE_UNKNOWN,
    [MT_OP_IF] = RULE_SAME,
    [MT_OP_THEN] = RULE_LAST,
    [MT_OP_ELSE] = RULE_SUM,
    [MT_OP_NOT] = RULE_SAME,
    [MT_OP_AND] = RULE_COMPARISON,
    [MT_OP_OR] = RULE_COMPARISON,
    [MT_OP_LESS] = RULE_COMPARISON,
    [MT_OP_AT_MOST] = RULE_COMPARISON,
    [MT_OP_GREATER] = RULE_COMPARISON,
    [MT_OP_AT_LEAST] = RULE_COMPARISON,
    [MT_OP_EQUAL] = RULE_COMPARISON,
};

mt_kind mt_kind_of_dimension(mt_dimension dimension)
{
    static const mt_kind kinds[] = {MT_KIND_LENGTH, MT_KIND_ANGLE, MT_KIND_SPEED,
                                    MT_KIND_UNKNOWN};
    return kinds[dimension];
}

static bool is_number(mt_kind kind)
{
    return kind == MT_KIND_NUMBER || kind == MT_KIND_ZERO || kind == MT_KIND_PI;
}

/* Kind of a + b, and of operations with terms of one kind as in a sum. */
static mt_kind sum_kind(mt_kind a, mt_kind b)
{
    if (a == b || b == MT_KIND_ZERO) {
        return a;
    }
    if (a == MT_KIND_ZERO) {
        return b;
    }
    if (is_number(a)) {
        return is_number(b) ? MT_KIND_NUMBER : b;
    }
    if (is_number(b) || b == MT_KIND_UNKNOWN) {
        return a;
    }
    return a == MT_KIND_UNKNOWN ? b : MT_KIND_UNKNOWN;
}

/* True where a and b are of different kinds as terms of a sum. An unknown kind differs from
 * numbers only. */
static bool differs(mt_kind a, mt_kind b)
{
    if (a == b || a == MT_KIND_ZERO || b == MT_KIND_ZERO || (is_number(a) && is_number(b))) {
        return false;
    }
    if (is_number(a) || is_number(b)) {
        const mt_kind number = is_number(a) ? a : b;
        const mt_kind other = is_number(a) ? b : a;
        return !(number == MT_KIND_PI && other == MT_KIND_ANGLE);
    }
    return a != MT_KIND_UNKNOWN && b != MT_KIND_UNKNOWN;
}

static part sum(mt_op op, const part *a, const part *b)
{
    part out = made(sum_kind(a->kind, b->kind), mt_op_value(op, a->value, b->value), a->mixed,
                    a->bare);
    if (!out.mixed && b->mixed) {
        out.mixed = true;
        out.bare = b->bare;
    } else if (!out.mixed && differs(a->kind, b->kind)) {
        out.mixed = true;
        out.bare = is_number(a->kind) ? a->value : is_number(b->kind) ? b->value : nan("");
    }
    return out;
}

static mt_kind product_kind(mt_kind a, mt_kind b)
{
    if (is_number(a) && is_number(b)) {
        return a == MT_KIND_PI || b == MT_KIND_PI ? MT_KIND_PI : MT_KIND_NUMBER;
    }
    if (is_number(a) || is_number(b)) {
        return is_number(a) ? b : a;
    }
    /* an arc */
    const bool arc = (a == MT_KIND_LENGTH && b == MT_KIND_ANGLE) ||
                     (a == MT_KIND_ANGLE && b == MT_KIND_LENGTH);
    if (arc || (a == MT_KIND_LENGTH && b == MT_KIND_LENGTH)) {
        return arc ? MT_KIND_LENGTH : MT_KIND_AREA;
    }
    return MT_KIND_UNKNOWN;
}

static mt_kind quotient_kind(mt_kind a, mt_kind b)
{
    if (is_number(b)) {
        return product_kind(a, b);
    }
    if (a == MT_KIND_AREA && b == MT_KIND_LENGTH) {
        return MT_KIND_LENGTH;
    }
    return a == b && a != MT_KIND_UNKNOWN ? MT_KIND_NUMBER : MT_KIND_UNKNOWN;
}

static mt_kind root_kind(mt_op op, mt_kind a)
{
    if (op == MT_OP_SQRT && a == MT_KIND_AREA) {
        return MT_KIND_LENGTH;
    }
    return is_number(a) ? MT_KIND_NUMBER : MT_KIND_UNKNOWN;
}

static part unary(mt_op op, const part *a)
{
    const double value = mt_op_value(op, a->value, 0.0);
    switch (rule_of[op]) {
    case RULE_SAME:
        return made(a->kind, value, a->mixed, a->bare);
    case RULE_ANGLE:
        return made(MT_KIND_ANGLE, value, false, nan(""));
    case RULE_ROOT:
        return made(root_kind(op, a->kind), value, a->mixed, a->bare);
    case RULE_UNKNOWN:
        return made(MT_KIND_UNKNOWN, value, false, nan(""));
    case RULE_NUMBER:
    case RULE_SUM:
    case RULE_PRODUCT:
    case RULE_POWER:
    case RULE_COMPARISON:
    case RULE_LAST:
        break;
    }
    return made(MT_KIND_NUMBER, value, false, nan(""));
}

static part product_or_quotient(mt_op op, const part *a, const part *b)
{
    const part *const of = is_number(b->kind) ? a : b;
    const bool keeps = of == a || (op == MT_OP_MUL && is_number(a->kind));
    return made(op == MT_OP_MUL ? product_kind(a->kind, b->kind)
                                : quotient_kind(a->kind, b->kind),
                mt_op_value(op, a->value, b->value), keeps && of->mixed, of->bare);
}

static part power(mt_op op, const part *a, const part *b)
{
    const bool numbers = is_number(a->kind) && is_number(b->kind);
    const bool area = a->kind == MT_KIND_LENGTH && b->value == 2.0;
    return made(numbers ? MT_KIND_NUMBER
                : area  ? MT_KIND_AREA
                        : MT_KIND_UNKNOWN,
                mt_op_value(op, a->value, b->value), area && a->mixed, a->bare);
}

static part comparison(mt_op op, const part *a, const part *b)
{
    const part of = sum(op, a, b);
    return made(MT_KIND_NUMBER, nan(""), of.mixed, of.bare);
}

static part binary(mt_op op, const part *a, const part *b)
{
    switch (rule_of[op]) {
    case RULE_SUM:
        return sum(op, a, b);
    case RULE_PRODUCT:
        return product_or_quotient(op, a, b);
    case RULE_POWER:
        return power(op, a, b);
    case RULE_COMPARISON:
        return comparison(op, a, b);
    case RULE_LAST:
        return made(b->kind, b->value, a->mixed || b->mixed, a->mixed ? a->bare : b->bare);
    case RULE_NUMBER:
    case RULE_UNKNOWN:
    case RULE_SAME:
    case RULE_ROOT:
    case RULE_ANGLE: /* atan2, of two of one kind, whichever */
        break;
    }
    return made(MT_KIND_ANGLE, mt_op_value(op, a->value, b->value), false, nan(""));
}

static part leaf(const mt_code *c, mt_kind_lookup lookup, const void *context)
{
    if (c->op == MT_OP_PARAM) {
        return made(lookup(context, c->param), nan(""), false, nan(""));
    }
    return made((mt_kind)c->param, c->value, false, nan(""));
}

mt_kind_found mt_expr_kind(const mt_expr *e, mt_kind_lookup lookup, const void *context)
{
    part stack[MT_EXPR_MAX_CODE] = {{.kind = MT_KIND_NUMBER}};
    int top = 0;
    for (int i = 0; i < e->length; i++) {
        const mt_code *const c = &e->code[i];
        const int operands = mt_op_operands(c->op);
        if (top < operands) {
            break; /* no expression */
        }
        part p = operands == 0   ? leaf(c, lookup, context)
                 : operands == 1 ? unary(c->op, &stack[top - 1])
                                 : binary(c->op, &stack[top - 2], &stack[top - 1]);
        if (p.kind == MT_KIND_NUMBER && p.value == 0.0) {
            p.kind = MT_KIND_ZERO;
        }
        top -= operands;
        stack[top++] = p;
    }
    if (top != 1) {
        return (mt_kind_found){MT_KIND_UNKNOWN, false, nan("")};
    }
    const part *const p = &stack[0];
    return (mt_kind_found){p->kind, p->mixed, is_number(p->kind) ? p->value : p->bare};
}

/* "a length" for the kind of an expression; NULL: the kind has no name. */
static const char *kind_text(mt_kind kind)
{
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        if (kind == mt_kind_of_dimension((mt_dimension)d)) {
            return mt_dimension_text((mt_dimension)d);
        }
    }
    return kind == MT_KIND_AREA ? "an area" : NULL;
}

void mt_kind_bare_text(double number, const mt_unit *unit, const char *what, char *out,
                       size_t size)
{
    char is[MT_KIND_TEXT / 2];
    const char *const si = strcmp(unit->si, "1") == 0 ? "" : unit->si;
    (void)mt_snprintf(is, sizeof is, "%.10g is %.10g%s%s here, as %s are in SI units", number,
                      number, *si == '\0' ? "" : " ", si, what);
    if (unit->constant == NULL) {
        (void)mt_snprintf(out, size, "%s: %.10g %s is written \"%.10g\"", is, number,
                          unit->name, mt_unit_to_si(unit, number));
    } else if (fabs(number) < 1.0) {
        const double written = mt_unit_written(unit, number);
        (void)mt_snprintf(out, size, "%s: write %.10g %s as \"%.10g*%s\"", is, number, si,
                          written, unit->constant);
    } else {
        (void)mt_snprintf(out, size, "%s: write \"%.10g*%s\"", is, number, unit->constant);
    }
}

/* Factor that gives an expression the unit. */
static const char *factor_text(const mt_unit *unit, char *out, size_t size)
{
    if (unit->constant != NULL) {
        return unit->constant;
    }
    (void)mt_snprintf(out, size, "%.10g", mt_unit_factor(unit));
    return out;
}

/* Complaint about an expression without a unit, with mixed units, or of another kind; false:
 * none. */
static bool say_measures(const mt_kind_found *f, bool number, const mt_unit *unit, char *out,
                         size_t size)
{
    char factor[32];
    const char *const by = factor_text(unit, factor, sizeof factor);
    const bool other = unit->dimension == MT_OTHER;
    if (number) {
        (void)mt_snprintf(out, size,
                          "this has no unit and would be in %s, as expressions are in SI "
                          "units: say the \"unit\" of its parameters, or multiply by %s",
                          unit->si, by);
    } else if (f->mixed && !other) {
        (void)mt_snprintf(out, size,
                          "this adds or compares what has different units; expressions are in "
                          "SI units, and a number of %s is written \"...*%s\"",
                          unit->name, by);
    } else if (!other && kind_text(f->kind) != NULL &&
               f->kind != mt_kind_of_dimension(unit->dimension)) {
        (void)mt_snprintf(out, size, "this is %s, where %s belongs", kind_text(f->kind),
                          mt_dimension_text(unit->dimension));
    } else {
        return false;
    }
    return true;
}

bool mt_kind_complaint(const mt_expr *e, const mt_unit *unit, mt_kind_lookup lookup,
                       const void *context, char *out, size_t size)
{
    if (unit == NULL || mt_unit_is_si(unit)) {
        return false;
    }
    const mt_kind_found f = mt_expr_kind(e, lookup, context);
    const bool pure = strcmp(unit->si, "1") == 0; /* of numbers: expressions have no unit */
    const bool number = is_number(f.kind) && f.kind != MT_KIND_ZERO &&
                        !(f.kind == MT_KIND_PI && unit->dimension == MT_ANGLE);
    const bool bare = number || (f.mixed && !pure);
    if (bare && isfinite(f.bare)) {
        mt_kind_bare_text(f.bare, unit, "expressions", out, size);
        return true;
    }
    return say_measures(&f, number && !pure, unit, out, size);
}

/*
 * Postfix code with powers in place of values:
 *     a b: sum of powers;   a/b: difference;   a^c, sqrt, cbrt: c times;   a + b, min, max:
 *     those of both, where they are equal;   sin, exp, ...: none
 * Powers are counted in sixths, so that a root of a root is exact.
 */

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

static powers sum_powers(const powers *a, const powers *b)
{
    powers p = a->number ? *b : *a;
    p.value = nan("");
    p.literal = false;
    if (!a->number && !b->number) {
        p.known = a->known && b->known && memcmp(a->sixths, b->sixths, sizeof a->sixths) == 0;
    }
    return p;
}

static powers unary_powers(mt_op op, const powers *a)
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
    case MT_OP_INTERP:
        return (powers){.known = false, .value = nan("")};
    default:
        return (powers){.known = true, .number = true, .value = nan("")};
    }
}

static powers binary_powers(mt_op op, const powers *a, const powers *b)
{
    switch ((int)op) {
    case MT_OP_ADD:
    case MT_OP_SUB:
    case MT_OP_MIN:
    case MT_OP_MAX:
    case MT_OP_HYPOT:
    case MT_OP_ELSE:
        return sum_powers(a, b);
    case MT_OP_THEN:
        return *b;
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

static powers leaf_powers(const mt_code *c, mt_measures_lookup lookup, const void *context)
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
            stack[n++] = leaf_powers(&e->code[i], lookup, context);
        } else if (n < operands) {
            return false;
        } else if (operands == 1) {
            stack[n - 1] = unary_powers(op, &stack[n - 1]);
        } else {
            stack[n - 2] = binary_powers(op, &stack[n - 2], &stack[n - 1]);
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
