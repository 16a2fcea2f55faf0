/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Parameters into program nodes. Which definition counts: an override of the configuration,
 * else an input of the caller, else the parameter's own expression. Emission follows the
 * dependences depth first with an explicit stack, so a long chain cannot overflow the C stack;
 * the model was checked for cycles.
 */
#include "model/values.h"

typedef struct source {
    bool input;
    const mt_number *number;
} source;

static source source_of(const mt_model *model, const mt_num *override, const int *is_input,
                        int parameter)
{
    if (override[parameter] != MT_ABSENT) {
        return (source){false, &model->nums[override[parameter]]};
    }
    const mt_number *const own = &model->nums[model->parameters[parameter].value];
    return (source){is_input != NULL && is_input[parameter] >= 0, own};
}

/* First parameter in the expression that has no node yet, or -1. */
static int missing_operand(const mt_expr *e, const mt_node *nodes)
{
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM && nodes[e->code[i].param] == MT_NO_NODE) {
            return e->code[i].param;
        }
    }
    return -1;
}

/* What emission reads and fills. */
typedef struct emission {
    const mt_model *model;
    const mt_num *override; /* [n_parameters] the configuration's number, MT_ABSENT: none */
    const int *is_input;
    mt_program *program;
    mt_node *nodes;
    int *stack; /* model->n_parameters + 1 places */
} emission;

/* One parameter and all that it waits for, deepest first. */
static mt_status emit(const emission *x, int parameter, mt_err *err)
{
    mt_node *const nodes = x->nodes;
    int depth = 0;
    x->stack[0] = parameter;
    while (depth >= 0) {
        const int p = x->stack[depth];
        if (nodes[p] != MT_NO_NODE) {
            depth--;
            continue;
        }
        const source s = source_of(x->model, x->override, x->is_input, p);
        const int waits_for = s.input ? -1 : missing_operand(&s.number->expr, nodes);
        if (waits_for >= 0) {
            if (depth >= x->model->n_parameters) {
                return mt_fail(err, MT_E_INTERNAL, "parameter \"%s\" depends on itself",
                               x->model->parameters[p].name.s);
            }
            x->stack[++depth] = waits_for;
            continue;
        }
        nodes[p] = s.input
                       ? mt_program_input(x->program, x->is_input[p], s.number->addr)
                       : mt_program_expr(x->program, &s.number->expr, nodes, s.number->addr);
        MT_TRY(mt_arena_check(x->program->mem, err)); /* what waits would wait for ever */
    }
    return MT_OK;
}

mt_status mt_emit_parameters(const mt_model *model, int configuration, const int *is_input,
                             mt_program *program, mt_node *nodes, mt_arena *mem, mt_err *err)
{
    const int n = model->n_parameters;
    int *const stack = mt_arena_int(mem, (size_t)n + 1);
    mt_num *const override = mt_arena_alloc(mem, (size_t)n, sizeof *override);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        nodes[i] = MT_NO_NODE;
        override[i] = MT_ABSENT;
    }
    const mt_configuration *const c =
        configuration < 0 ? NULL : &model->configurations[configuration];
    for (int i = c == NULL ? -1 : c->n_overrides - 1; i >= 0; i--) { /* the first one counts */
        override[c->overrides[i].parameter] = c->overrides[i].value;
    }
    const emission x = {model, override, is_input, program, nodes, stack};
    for (int i = 0; i < n; i++) {
        MT_TRY(emit(&x, i, err));
    }
    return MT_OK;
}
