/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The original design as the answer. The total change is 0 there and above 0 at every other
 * design, as all weights are above 0: where the original meets all goals of a study that makes
 * the change least first, it is the best design there is, and nothing is left to search or to
 * prove. That it meets them is read from its description, which judges it as every design that
 * is reported: over its tolerances and between the positions of drives, too.
 */
#include "answer/solve_priv.h"

#include "describe/describe.h"

/* True where x is within the bounds of variable v and, where it has a catalogue, one of its
 * values. */
static bool is_allowed(const mt_variable *v, double x)
{
    bool listed = v->n_catalogue == 0;
    for (int i = 0; i < v->n_catalogue && !listed; i++) {
        listed = v->catalogue[i] == x;
    }
    return listed && x >= v->lower && x <= v->upper;
}

bool mt_answer_original_is_best(const mt_answer *a)
{
    const mt_problem *const p = a->p;
    const mt_recommendation *const original = &a->result->baseline;
    if (!a->searched || p->whole.rows.eq.n > 0 || p->stages[0].type != MT_OBJECTIVE_CHANGE ||
        !original->feasible || original->disagreement != NULL ||
        !mt_describe_keeps_between(original)) {
        return false;
    }
    for (int i = 0; i < p->n; i++) {
        if (!is_allowed(&p->study->variables[i], p->original[i])) {
            return false;
        }
    }
    return true;
}

mt_status mt_answer_take_original(mt_answer *a, mt_err *err)
{
    const size_t n = (size_t)a->p->n;
    mt_nlp_solution *const s = mt_arena_alloc(&a->mem, 1, sizeof *s);
    double *const t = mt_arena_f64(&a->mem, n, 1);
    int *const bound = mt_arena_int(&a->mem, n);
    a->found = (mt_nlp_result){.stop = MT_STOP_DONE,
                               .solutions = s,
                               .n_solutions = 1,
                               .steps = mt_steps_new(MT_STEPS_OF_TASK, &a->mem)};
    MT_TRY(mt_arena_check(&a->mem, err));
    for (size_t i = 0; i < n; i++) {
        t[i] = a->p->whole.origin_t[i];
    }
    /* the gradient of the change is 0 here, and so is each multiplier */
    *s = (mt_nlp_solution){.t = t, .feasible = true, .bound = bound};
    a->stage = 0;
    a->unsearched = true;
    return MT_OK;
}
