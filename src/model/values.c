/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/values.h"

#include <math.h>
#include <stddef.h>

#include "expr/program.h"

/* Emits parameters into a program, operands first: a walk in depth over "needs", with its own
 * stack, because a chain of parameters may be as long as the file allows. */
typedef struct order {
    const mt_model *model;
    mt_program program;
    mt_node *nodes; /* [n_parameters] MT_NO_NODE until emitted */
    int *stack;     /* parameters being worked on, innermost last */
    /* [n_parameters] where the reading of a parameter's code stands; MT_ABSENT: not begun */
    int *cursor;
    int depth;
} order;

static const mt_expr *value_of(const order *o, int parameter)
{
    return &o->model->nums[o->model->parameters[parameter].value].expr;
}

static mt_status push(order *o, int parameter, mt_err *err)
{
    if (o->cursor[parameter] != MT_ABSENT) {
        return mt_fail(err, MT_E_INPUT, "parameter \"%s\" depends on itself",
                       o->model->parameters[parameter].name.s);
    }
    o->cursor[parameter] = 0;
    o->stack[o->depth++] = parameter;
    return MT_OK;
}

/* The next parameter that the one on top of the stack needs and that has no node yet;
 * MT_ABSENT: all there. */
static int missing_operand(order *o)
{
    const int top = o->stack[o->depth - 1];
    const mt_expr *const e = value_of(o, top);
    for (int *at = &o->cursor[top]; *at < e->length; ++*at) {
        const mt_code *const code = &e->code[*at];
        if (code->op == MT_OP_PARAM && o->nodes[code->param] == MT_NO_NODE) {
            return code->param;
        }
    }
    return MT_ABSENT;
}

static mt_status emit(order *o, int parameter, mt_err *err)
{
    if (o->nodes[parameter] != MT_NO_NODE) {
        return MT_OK;
    }
    MT_TRY(push(o, parameter, err));
    while (o->depth > 0) {
        const int need = missing_operand(o);
        if (need != MT_ABSENT) {
            MT_TRY(push(o, need, err));
            continue;
        }
        const int top = o->stack[--o->depth];
        o->nodes[top] = mt_program_expr(&o->program, value_of(o, top), o->nodes,
                                        o->model->parameters[top].name.addr);
        MT_TRY(mt_arena_check(o->program.mem, err)); /* what waits would wait for ever */
    }
    return MT_OK;
}

static mt_status evaluate(order *o, mt_arena *mem, double *values, int *bad, mt_err *err)
{
    const int n = o->model->n_parameters;
    for (int i = 0; i < n; i++) {
        MT_TRY(emit(o, i, err));
    }
    MT_TRY(mt_program_finish(&o->program, err));
    double *const all = mt_arena_f64(mem, (size_t)o->program.count, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_node bad_node = MT_NO_NODE;
    const mt_status rc = mt_program_eval(&o->program, NULL, all, &bad_node, err);
    for (int i = 0; rc == MT_OK && i < n; i++) {
        values[i] = all[o->nodes[i]];
    }
    /* the node belongs to the first parameter, in order of evaluation, that it spoils: one
     * whose node follows it first */
    for (int i = 0; rc == MT_E_DOMAIN && i < n; i++) {
        if (o->nodes[i] >= bad_node && (*bad == MT_ABSENT || o->nodes[i] < o->nodes[*bad])) {
            *bad = i;
        }
    }
    if (rc == MT_E_DOMAIN && *bad != MT_ABSENT) {
        return mt_fail(err, rc, "parameter \"%s\" has no finite value",
                       o->model->parameters[*bad].name.s);
    }
    return rc;
}

mt_status mt_model_original_values(const mt_model *model, mt_arena *mem, double *values,
                                   int *bad, mt_err *err)
{
    const size_t n = (size_t)model->n_parameters;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    int ignored = MT_ABSENT;
    int *const which = bad == NULL ? &ignored : bad;
    *which = MT_ABSENT;
    order o = {
        .model = model,
        .nodes = mt_arena_int(mem, n),
        .stack = mt_arena_int(mem, n),
        .cursor = mt_arena_int(mem, n),
    };
    mt_status rc = mt_program_init(&o.program, 0, mem, err);
    for (size_t i = 0; rc == MT_OK && i < n; i++) {
        o.nodes[i] = MT_NO_NODE;
        o.cursor[i] = MT_ABSENT;
    }
    if (rc == MT_OK) {
        rc = evaluate(&o, mem, values, which, err);
    }
    mt_arena_rewind(mem, mark);
    return rc;
}

static mt_status expr_value(const mt_model *model, const double *values, const mt_expr *e,
                            mt_arena *mem, double *out, mt_err *err)
{
    mt_program program;
    mt_node *const nodes = mt_arena_int(mem, (size_t)model->n_parameters);
    MT_TRY(mt_program_init(&program, 0, mem, err));
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM) {
            nodes[e->code[i].param] = mt_program_const(&program, values[e->code[i].param]);
        }
    }
    const mt_node node = mt_program_expr(&program, e, nodes, MT_NO_ADDR);
    MT_TRY(mt_program_finish(&program, err));
    double *const all = mt_arena_f64(mem, (size_t)program.count, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_program_eval(&program, NULL, all, NULL, err));
    *out = all[node];
    return MT_OK;
}

mt_status mt_model_expr_value(const mt_model *model, const double *values, const mt_expr *e,
                              mt_arena *mem, double *out, mt_err *err)
{
    if (mt_expr_is_constant(e, out)) {
        return isfinite(*out) ? MT_OK : mt_fail(err, MT_E_DOMAIN, "the value is not finite");
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = expr_value(model, values, e, mem, out, err);
    mt_arena_rewind(mem, mark);
    return rc;
}
