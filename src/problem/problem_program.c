/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits, objectives and published quantities as one program of the variables. */
#include <math.h>

#include "model/values.h"
#include "problem/objective.h"

/* Change of a node with the variables, each by 1 in t, at the original design; its own value
 * where it does not change, and 1 where that is 0 too. The result has the node's unit alone. */
static double size_of(const mt_problem *p, mt_node node, const double *value,
                      const double *grad)
{
    double square = 0.0;
    for (int i = 0; i < p->n; i++) {
        const double slope =
            grad[((ptrdiff_t)node * p->n) + i] * mt_problem_dx_dt_at(p, i, p->original[i]);
        square += slope * slope;
    }
    const double moved = sqrt(square);
    const double own = fabs(value[node]);
    return moved > 0.0 && isfinite(moved) ? moved : own > 0.0 && isfinite(own) ? own : 1.0;
}

static double size_of_mass(const mt_problem *p, const mt_objective_stage *a)
{
    double sum = 0.0;
    for (int k = 0; k < a->n_mass; k++) {
        sum += mt_linear_value(p->views[0].original->lin, a->mass[k]);
    }
    return sum > 0.0 ? sum : 1.0;
}

/* A power of two rounds nothing. */
static double next_power(double size)
{
    return ldexp(1.0, ilogb(size));
}

/* Sizes that make the search independent of units. A value that does not exist at the original
 * design leaves 1. */
static mt_status set_sizes(mt_problem *p, mt_err *err)
{
    const size_t count = (size_t)p->program.count;
    const mt_arena_mark mark = mt_arena_get_mark(&p->mem);
    double *const value = mt_arena_f64(&p->mem, count, 1);
    double *const grad = mt_arena_f64(&p->mem, count, (size_t)p->n);
    mt_err own = {.code = MT_OK};
    MT_TRY(mt_arena_check(&p->mem, err));
    const bool known =
        mt_program_gradient(&p->program, p->original, value, grad, NULL, &own) == MT_OK;
    for (int i = 0; i < p->n_requirements && known; i++) {
        mt_requirement *const d = &p->requirements[i];
        d->size = d->node != MT_NO_NODE ? size_of(p, d->node, value, grad) : d->size;
    }
    for (int i = 0; i < p->n_stages; i++) {
        mt_objective_stage *const a = &p->stages[i];
        const double size = a->n_mass > 0                    ? size_of_mass(p, a)
                            : known && a->node != MT_NO_NODE ? size_of(p, a->node, value, grad)
                                                             : 1.0;
        a->size = next_power(size);
    }
    mt_arena_rewind(&p->mem, mark);
    return MT_OK;
}

mt_status mt_problem_init_program(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    const size_t n_parameters = (size_t)s->model->n_parameters;
    int *const is_input = mt_arena_int(&p->mem, n_parameters);
    mt_node *const nodes = mt_arena_alloc(&p->mem, n_parameters, sizeof *nodes);
    p->published = mt_arena_alloc(&p->mem, (size_t)s->n_published, sizeof *p->published);
    p->n_stages = s->n_objectives > 0 ? s->n_objectives : 1;
    p->stages = mt_arena_alloc(&p->mem, (size_t)p->n_stages, sizeof *p->stages);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_stages; i++) {
        const mt_objective *const o = s->n_objectives > 0 ? &s->objectives[i] : NULL;
        const mt_objective_type type = o != NULL ? o->type : MT_OBJECTIVE_NONE;
        p->stages[i] = (mt_objective_stage){
            .type = type, .ops = mt_objective_ops_of(type), .objective = o, .node = MT_NO_NODE};
    }
    for (size_t i = 0; i < n_parameters; i++) {
        is_input[i] = -1;
    }
    for (int i = 0; i < p->n; i++) {
        is_input[p->inputs[i]] = i;
    }
    MT_TRY(mt_program_init(&p->program, p->n, &p->mem, err));
    MT_TRY(mt_emit_parameters(s->model, MT_ABSENT, is_input, &p->program, nodes, &p->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        mt_requirement *const d = &p->requirements[i];
        if (d->quantity == MT_QUANTITY_EXPRESSION) {
            d->node = mt_program_expr(&p->program, &d->goal->expression, nodes, d->goal->addr);
        }
    }
    for (int i = 0; i < p->n_stages; i++) {
        mt_objective_stage *const a = &p->stages[i];
        if (a->ops->compile != NULL) {
            MT_TRY(a->ops->compile(p, a, nodes, err));
        }
    }
    p->n_searched = p->program.count;
    for (int i = 0; i < s->n_published; i++) {
        const mt_published *const pub = &s->published[i];
        p->published[i] = MT_NO_NODE;
        if (pub->kind == MT_PUBLISHED_QUANTITY) {
            p->published[i] = mt_program_expr(&p->program, &pub->quantity, nodes, pub->addr);
        } else if (pub->kind == MT_PUBLISHED_PARAMETER) {
            p->published[i] = nodes[pub->parameter];
        }
    }
    MT_TRY(mt_program_finish(&p->program, err));
    return set_sizes(p, err);
}
