/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Parameters into program nodes. Which definition counts: an override of the configuration, else an input of the caller, else the parameter's own expression. Emission
 * follows the dependences depth first with an explicit stack, so a long chain cannot overflow the C stack; the model was checked for cycles.
 */
#include "mechanics/system.h"

typedef struct source {
    bool input;
    const mt_number *number;
} source;

static source source_of(const mt_model *model, int configuration, const int *is_input,
                        int parameter)
{
    if (configuration >= 0) {
        const mt_configuration *const c = &model->configurations[configuration];
        for (int i = 0; i < c->n_overrides; i++) {
            if (c->overrides[i].parameter == parameter) {
                return (source){false, &model->nums[c->overrides[i].value]};
            }
        }
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

mt_status mt_emit_parameters(const mt_model *model, int configuration, const int *is_input,
                             mt_program *program, mt_node *nodes, mt_arena *scratch,
                             mt_err *err)
{
    const int n = model->n_parameters;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    int *const stack = mt_arena_int(scratch, (size_t)n + 1);
    if (stack == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < n; i++) {
        nodes[i] = MT_NO_NODE;
    }
    for (int i = 0; i < n; i++) {
        int depth = 0;
        stack[0] = i;
        while (depth >= 0) {
            const int p = stack[depth];
            const source s = source_of(model, configuration, is_input, p);
            const int waits_for = nodes[p] != MT_NO_NODE || s.input
                                      ? -1
                                      : missing_operand(&s.number->expr, nodes);
            if (waits_for >= 0) {
                if (depth >= n) {
                    return mt_fail(err, MT_E_INTERNAL, "parameter \"%s\" depends on itself",
                                   model->parameters[p].name.s);
                }
                stack[++depth] = waits_for;
                continue;
            }
            if (nodes[p] == MT_NO_NODE) {
                nodes[p] =
                    s.input ? mt_program_input(program, is_input[p], s.number->addr)
                            : mt_program_expr(program, &s.number->expr, nodes, s.number->addr);
            }
            depth--;
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_parameter_values(const mt_model *model, int configuration, double *values,
                              mt_err *err)
{
    mt_arena mem = {0};
    mt_program program;
    MT_TRY(mt_arena_init(&mem, 0, err));
    const size_t n = (size_t)model->n_parameters;
    mt_node *const nodes = mt_arena_alloc(&mem, n, sizeof *nodes);
    mt_status rc =
        nodes == NULL ? mt_fail_memory(err) : mt_program_init(&program, 0, &mem, err);
    if (rc == MT_OK) {
        rc = mt_emit_parameters(model, configuration, NULL, &program, nodes, &mem, err);
    }
    if (rc == MT_OK) {
        rc = mt_program_finish(&program, err);
    }
    if (rc == MT_OK) {
        double *const all = mt_arena_f64(&mem, (size_t)program.count, 1);
        rc =
            all == NULL ? mt_fail_memory(err) : mt_program_eval(&program, NULL, all, NULL, err);
        for (size_t i = 0; i < n && rc == MT_OK; i++) {
            values[i] = all[nodes[i]];
        }
    }
    mt_arena_free(&mem);
    return rc;
}
