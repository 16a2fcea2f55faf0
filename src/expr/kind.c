/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One walk over the postfix code with a stack of kinds; constants are folded, so that the
 * number which is told is the one that counts ("2*25" is 50). */
#include "expr/kind.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "expr/op.h"

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
    RULE_NUMBER, /* sin, exp, ln: a number, of whatever */
    RULE_SAME,
    RULE_ROOT,
    RULE_ANGLE,
    RULE_SUM,
    RULE_PRODUCT,
    RULE_POWER
} rule;
static const rule rule_of[MT_OP_COUNT] = {
    [MT_OP_NEG] = RULE_SAME,   [MT_OP_ABS] = RULE_SAME,    [MT_OP_SQRT] = RULE_ROOT,
    [MT_OP_CBRT] = RULE_ROOT,  [MT_OP_ASIN] = RULE_ANGLE,  [MT_OP_ACOS] = RULE_ANGLE,
    [MT_OP_ATAN] = RULE_ANGLE, [MT_OP_ATAN2] = RULE_ANGLE, [MT_OP_ADD] = RULE_SUM,
    [MT_OP_SUB] = RULE_SUM,    [MT_OP_MIN] = RULE_SUM,     [MT_OP_MAX] = RULE_SUM,
    [MT_OP_HYPOT] = RULE_SUM,  [MT_OP_MUL] = RULE_PRODUCT, [MT_OP_DIV] = RULE_PRODUCT,
    [MT_OP_POW] = RULE_POWER,
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
    case RULE_NUMBER:
    case RULE_SUM:
    case RULE_PRODUCT:
    case RULE_POWER:
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

static part binary(mt_op op, const part *a, const part *b)
{
    switch (rule_of[op]) {
    case RULE_SUM:
        return sum(op, a, b);
    case RULE_PRODUCT:
        return product_or_quotient(op, a, b);
    case RULE_POWER:
        return power(op, a, b);
    case RULE_NUMBER:
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
