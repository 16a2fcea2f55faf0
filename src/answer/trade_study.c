/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The study of one point of a trade study: a shallow copy with its numbers put in. */
#include <math.h>
#include <string.h>

#include "answer/trade.h"
#include "model/values.h"

static void *copied(mt_arena *mem, const void *items, int n, size_t size)
{
    void *const copy = mt_arena_alloc(mem, (size_t)n, size);
    if (copy != NULL && n > 0) {
        memcpy(copy, items, (size_t)n * size);
    }
    return copy;
}

/* A model with another value of a parameter; variables start from the values that follow. */
static mt_status put_parameter(mt_study *s, int parameter, double value, mt_arena *mem,
                               mt_err *err)
{
    mt_model *const model = copied(mem, s->model, 1, sizeof *model);
    mt_number *const nums =
        copied(mem, s->model->nums, s->model->n_nums, sizeof *s->model->nums);
    s->original = mt_arena_f64(mem, (size_t)s->model->n_parameters, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_number *const number = &nums[model->parameters[parameter].value];
    MT_TRY(mt_expr_number(value, mem, &number->expr, err));
    model->nums = nums;
    s->model = model;
    MT_TRY(mt_model_original_values(model, mem, s->original, NULL, err));
    for (int i = 0; i < s->n_variables; i++) {
        s->variables[i].original = s->original[s->variables[i].parameter];
    }
    return MT_OK;
}

static mt_status set_varied_number(mt_study *s, const mt_vary *v, double value, mt_arena *mem,
                                   mt_err *err)
{
    switch (v->kind) {
    case MT_VARY_BOUND: {
        mt_variable *const variable = &s->variables[v->variable];
        *(v->upper ? &variable->upper : &variable->lower) = value;
        return MT_OK;
    }
    case MT_VARY_GOAL: {
        mt_goal *const g = &s->goals[v->goal];
        if (v->slot != MT_SLOT_MARGIN) {
            g->number[v->slot] = value;
            return MT_OK;
        }
        mt_avoid *const avoid = copied(mem, g->avoid, 1, sizeof *avoid);
        MT_TRY(mt_arena_check(mem, err));
        g->avoid = avoid;
        return mt_bands_make(&avoid->source, value, mem, &avoid->bands, err);
    }
    case MT_VARY_PARAMETER:
        return put_parameter(s, v->parameter, value, mem, err);
    }
    return mt_fail(err, MT_E_INTERNAL, "a trade study varies nothing");
}

mt_status mt_trade_study(const mt_study *study, const double *values, mt_arena *mem,
                         mt_study *out, mt_err *err)
{
    *out = *study;
    out->trade.n_vary = 0;
    out->n_published = 0;
    out->n_warnings = 0;
    out->examined = true;
    out->weight_sensitivity.factor = nan("");
    out->recommendations = 1;
    out->search.settles = study->search.starts <= 0;
    out->variables =
        copied(mem, study->variables, study->n_variables, sizeof *study->variables);
    out->goals = copied(mem, study->goals, study->n_goals, sizeof *study->goals);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < study->trade.n_vary; k++) {
        MT_TRY(set_varied_number(out, &study->trade.vary[k], values[k], mem, err));
    }
    return MT_OK;
}
