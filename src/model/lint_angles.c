/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Units of expressions: whole ones, which their reader has looked at, and angles. What goes
 * into sin, cos or tan is in rad. A part of it that has no unit (no parameter with a unit of
 * angles, no "*deg", no pi) and is more than a whole turn is in degrees, most likely. Each
 * expression is walked once: b is the part without unit of v,
 *     number, parameter: b = v; with a unit of angles: b = 0;   a + b: both parts;
 *     a * b, one of them with a unit: its b times the other's v;   anything else of numbers: v.
 */
#include "model/lint_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "expr/kind.h"
#include "expr/op.h"

static const double WHOLE_TURN = 6.283185307179586;

typedef struct part {
    double value;
    double bare;   /* the part of it without a unit */
    bool unit;     /* some of it has a unit of angles */
    int parameter; /* what makes it large; MT_ABSENT: a number of the expression */
} part;

/* The number that gives a parameter its value here. */
static mt_num number_of_parameter(const mt_lint *j, int parameter)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    for (int i = 0; i < c->n_overrides; i++) {
        if (c->overrides[i].parameter == parameter) {
            return c->overrides[i].value;
        }
    }
    return j->model->parameters[parameter].value;
}

static part leaf(const mt_lint *j, const mt_code *c)
{
    if (c->op == MT_OP_PARAM) {
        const mt_kind kind = mt_model_kind(j->model, c->param);
        const mt_num num = number_of_parameter(j, c->param);
        const double v = num == MT_ABSENT ? nan("") : j->value[num];
        const bool unit = kind == MT_KIND_ANGLE || kind == MT_KIND_PI;
        return (part){v, unit ? 0.0 : v, unit, c->param};
    }
    const bool unit = c->param == MT_KIND_ANGLE || c->param == MT_KIND_PI;
    return (part){c->value, unit ? 0.0 : c->value, unit, MT_ABSENT};
}

static part unary(mt_op op, const part *a)
{
    const double v = mt_op_value(op, a->value, 0.0);
    switch ((int)op) {
    case MT_OP_NEG:
        return (part){v, -a->bare, a->unit, a->parameter};
    case MT_OP_ABS:
        return (part){v, fabs(a->bare), a->unit, a->parameter};
    case MT_OP_ASIN:
    case MT_OP_ACOS:
    case MT_OP_ATAN:
        return (part){v, 0.0, true, MT_ABSENT};
    default:
        return (part){v, v, false, a->parameter};
    }
}

static part binary(mt_op op, const part *a, const part *b)
{
    const double v = mt_op_value(op, a->value, b->value);
    const int larger = fabs(a->bare) >= fabs(b->bare) ? a->parameter : b->parameter;
    if (op == MT_OP_ADD || op == MT_OP_SUB) {
        const double bare = op == MT_OP_ADD ? a->bare + b->bare : a->bare - b->bare;
        return (part){v, bare, a->unit || b->unit, larger};
    }
    if (op == MT_OP_ATAN2) {
        return (part){v, 0.0, true, MT_ABSENT};
    }
    if (!a->unit && !b->unit) {
        const bool named = a->parameter != MT_ABSENT;
        return (part){v, v, false, named ? a->parameter : b->parameter};
    }
    if (op == MT_OP_MUL && a->unit != b->unit) {
        return (part){v, a->unit ? a->bare * b->value : b->bare * a->value, true, larger};
    }
    if (op == MT_OP_DIV && a->unit && !b->unit) {
        return (part){v, a->bare / b->value, true, larger};
    }
    return (part){v, 0.0, true, MT_ABSENT};
}

/* True where this number has been reported here. An argument of cos() is reported for sin() as
 * well. */
static bool is_said(const mt_lint *j, mt_addr addr)
{
    const char *const here = j->model->configurations[j->configuration].name.s;
    for (int i = 0; i < j->out->n; i++) {
        const mt_warning *const d = &j->out->items[i];
        if (d->addr == addr && strcmp(d->kind, "angle") == 0 && d->configuration == here) {
            return true;
        }
    }
    return false;
}

static void warn_of_degrees(mt_lint *j, mt_num num, const part *angle, const char *function)
{
    const bool named = angle->parameter != MT_ABSENT;
    const mt_num given = named ? number_of_parameter(j, angle->parameter) : num;
    const double own = named ? j->value[given] : nan("");
    const bool whole = fabs(own) > WHOLE_TURN && !(fabs(own - angle->bare) > 0.0);
    const mt_addr addr = j->model->nums[whole ? given : num].addr;
    if (is_said(j, addr)) {
        return;
    }
    mt_warning *const warning =
        whole
            ? mt_warning_add(
                  j->out, MT_LEVEL_WARNING, "angle",
                  "\"%s\" is %g, without a unit, and an angle of a trigonometric "
                  "function: %g rad are more than a turn; if degrees are meant, give "
                  "it \"unit\": \"deg\"",
                  j->model->parameters[angle->parameter].name.s, own, own)
            : mt_warning_add(j->out, MT_LEVEL_WARNING, "angle",
                             "%s() of %g, without a unit: %g rad are more than a turn; degrees "
                             "are written \"%g*deg\"",
                             function, angle->bare, angle->bare, angle->bare);
    (void)mt_lint_addr(j, warning, addr, NULL);
}

static const char *function_of(mt_op op)
{
    return op == MT_OP_SIN ? "sin" : op == MT_OP_COS ? "cos" : op == MT_OP_TAN ? "tan" : NULL;
}

static bool has_function(const mt_expr *e)
{
    for (int i = 0; i < e->length; i++) {
        if (function_of(e->code[i].op) != NULL) {
            return true;
        }
    }
    return false;
}

static void lint_number(mt_lint *j, mt_num num, part *stack)
{
    const mt_expr *const e = &j->model->nums[num].expr;
    int n = 0;
    if (!has_function(e)) {
        return;
    }
    for (int i = 0; i < e->length; i++) {
        const mt_code *const c = &e->code[i];
        const char *const function = function_of(c->op);
        const int operands = mt_op_operands(c->op);
        if (operands <= 0) {
            stack[n++] = leaf(j, c);
            continue;
        }
        if (n < operands) { /* no expression that was parsed */
            return;
        }
        if (function != NULL && fabs(stack[n - 1].bare) > WHOLE_TURN) {
            warn_of_degrees(j, num, &stack[n - 1], function);
            return;
        }
        if (operands == 1) {
            stack[n - 1] = unary(c->op, &stack[n - 1]);
        } else {
            stack[n - 2] = binary(c->op, &stack[n - 2], &stack[n - 1]);
            n--;
        }
    }
}

void mt_lint_angles(mt_lint *j)
{
    part stack[MT_EXPR_MAX_CODE];
    for (mt_num num = 0; num < j->model->n_nums; num++) {
        lint_number(j, num, stack);
    }
}

void mt_lint_units(mt_lint *j)
{
    for (mt_num num = 0; num < j->model->n_nums; num++) {
        const mt_number *const number = &j->model->nums[num];
        if (number->unit_warning != NULL) {
            (void)mt_lint_addr(
                j, mt_warning_add(j->out, MT_LEVEL_WARNING, "unit", "%s", number->unit_warning),
                number->addr, NULL);
        }
    }
}
