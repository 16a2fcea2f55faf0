/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All numbers of a model as they stand in one configuration. */
#include <math.h>
#include <stddef.h>

#include "model/values.h"

/* A program with the parameters of a configuration (MT_ABSENT: of the file), some of them
 * inputs; nodes[n_parameters]. */
static mt_status begin(const mt_model *model, int configuration, int n_inputs,
                       const int *inputs, mt_arena *mem, mt_program *program, mt_node **nodes,
                       mt_err *err)
{
    const size_t n = (size_t)model->n_parameters;
    int *const is_input = mt_arena_int(mem, n);
    *nodes = mt_arena_int(mem, n);
    MT_TRY(mt_program_init(program, n_inputs, mem, err));
    for (size_t i = 0; i < n; i++) {
        is_input[i] = MT_ABSENT;
    }
    for (int i = 0; i < n_inputs; i++) {
        is_input[inputs[i]] = i;
    }
    return mt_emit_parameters(model, configuration, is_input, program, *nodes, mem, err);
}

static mt_status evaluate(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_arena *mem, double *value,
                          mt_err *err)
{
    const size_t n_nums = (size_t)model->n_nums;
    mt_node *const nodes = mt_arena_int(mem, n_nums);
    mt_node *parameters = NULL;
    mt_program program;
    MT_TRY(begin(model, configuration, n_inputs, inputs, mem, &program, &parameters, err));
    for (size_t i = 0; i < n_nums; i++) {
        const mt_number *const number = &model->nums[i];
        nodes[i] = mt_program_expr(&program, &number->expr, parameters, number->addr);
    }
    MT_TRY(mt_program_finish(&program, err));
    double *const all = mt_arena_f64(mem, (size_t)program.count, 1);
    mt_node bad = program.count;
    MT_TRY(mt_arena_check(mem, err));
    mt_err ignored = {.code = MT_OK}; /* who evaluates the model says what has no value */
    const mt_status rc = mt_program_eval(&program, at, all, &bad, &ignored);
    if (rc != MT_OK && rc != MT_E_DOMAIN) {
        return mt_fail(err, rc, "%s", ignored.text);
    }
    for (size_t i = 0; i < n_nums; i++) {
        value[i] = rc == MT_OK || nodes[i] < bad ? all[nodes[i]] : nan("");
    }
    return MT_OK;
}

mt_status mt_model_numbers(const mt_model *model, int configuration, int n_inputs,
                           const int *inputs, const double *at, mt_arena *mem, double *value,
                           mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = evaluate(model, configuration, n_inputs, inputs, at, mem, value, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

static mt_status evaluate_parameters(const mt_model *model, int n_inputs, const int *inputs,
                                     const double *at, mt_arena *mem, double *value,
                                     mt_err *err)
{
    mt_node *nodes = NULL;
    mt_program program;
    MT_TRY(begin(model, MT_ABSENT, n_inputs, inputs, mem, &program, &nodes, err));
    MT_TRY(mt_program_finish(&program, err));
    double *const all = mt_arena_f64(mem, (size_t)program.count, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_program_eval(&program, at, all, NULL, err));
    for (int i = 0; i < model->n_parameters; i++) {
        value[i] = all[nodes[i]];
    }
    return MT_OK;
}

mt_status mt_model_parameters(const mt_model *model, int n_inputs, const int *inputs,
                              const double *at, mt_arena *mem, double *value, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = evaluate_parameters(model, n_inputs, inputs, at, mem, value, err);
    mt_arena_rewind(mem, mark);
    return rc;
}
