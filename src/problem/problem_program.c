/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits, objectives and published quantities as one program of the variables. */
#include "model/values.h"
#include "problem/objective.h"

mt_status mt_problem_init_program(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    const size_t n_parameters = (size_t)s->model->n_parameters;
    int *const is_input = mt_arena_int(&p->mem, n_parameters);
    mt_node *const nodes = mt_arena_alloc(&p->mem, n_parameters, sizeof *nodes);
    p->published = mt_arena_alloc(&p->mem, (size_t)s->n_published, sizeof *p->published);
    p->n_aims = s->n_objectives > 0 ? s->n_objectives : 1;
    p->aims = mt_arena_alloc(&p->mem, (size_t)p->n_aims, sizeof *p->aims);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_aims; i++) {
        const mt_objective *const o = s->n_objectives > 0 ? &s->objectives[i] : NULL;
        const mt_objective_type type = o != NULL ? o->type : MT_OBJECTIVE_NONE;
        p->aims[i] = (mt_aim){
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
    for (int i = 0; i < p->n_demands; i++) {
        mt_demand *const d = &p->demands[i];
        if (d->quantity == MT_QUANTITY_EXPRESSION) {
            d->node = mt_program_expr(&p->program, &d->goal->expression, nodes, d->goal->addr);
        }
    }
    for (int i = 0; i < p->n_aims; i++) {
        mt_aim *const a = &p->aims[i];
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
    return mt_program_finish(&p->program, err);
}
