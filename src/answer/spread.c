/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The spread of a misfit's answer under other weights. With residuals r_g of the goals and
 * their weights w_g the best design minimises
 *     sum_g w_g |r_g|^2    under the constraints;
 * each weight is multiplied and divided by the study's factor in turn and the minimum found
 * again, from the best design. Data that agree leave the design where it is; data that
 * contradict each other pull it about, and how far is what nobody can know better than from
 * them. The given weights are one opinion among these.
 */
#include "answer/spread.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "search/discrete.h"

/* Of a search without which none is begun. */
enum { EVALUATIONS_LEAST = 20 };

typedef struct spread {
    mt_workspace *w; /* set to c */
    mt_case c;
    double *weight; /* [n_demands] of c */
    mt_result *result;
    const mt_nlp_solution *best;
    double *x; /* [n] */
    long evaluations;
    long most; /* of each search; 0: no limit */
} spread;

static mt_status start(spread *s, mt_err *err)
{
    mt_result *const r = s->result;
    const size_t n = (size_t)s->w->p->n;
    s->x = mt_arena_f64(&r->mem, n, 1);
    r->spread = mt_arena_alloc(&r->mem, n, sizeof *r->spread);
    MT_TRY(mt_arena_check(&r->mem, err));
    mt_case_x(s->w->c, s->best->t, s->x);
    for (int i = 0; i < s->w->p->n; i++) {
        const mt_parameter *const parameter =
            &s->w->p->study->model->parameters[s->w->p->inputs[i]];
        r->spread[i] = (mt_result_spread){
            .parameter = mt_arena_strdup(&r->mem, parameter->name.s),
            .unit = parameter->unit == NULL ? NULL : mt_arena_strdup(&r->mem, parameter->unit),
            .display_unit = mt_unit_name(s->w->p->study->variables[i].shown, NULL),
            .display_factor = mt_unit_display(s->w->p->study->variables[i].shown),
            .value = s->x[i],
            .low = s->x[i],
            .high = s->x[i],
            .low_factor = nan(""),
            .high_factor = nan(""),
        };
    }
    MT_TRY(mt_arena_check(&r->mem, err));
    r->n_spread = s->w->p->n;
    return MT_OK;
}

static void scale_weight(const mt_problem *p, double *weight, int goal, double factor)
{
    for (int i = 0; i < p->n_demands; i++) {
        if (p->demands[i].goal_index == goal) {
            weight[i] = p->study->goals[goal].weight * factor;
        }
    }
}

/* Solve again with one weight changed, from the best design, which is also what undetermined
 * directions are kept at. */
static mt_status search_again(spread *s, int goal, double factor, mt_arena *mem, mt_err *err)
{
    mt_nlp nlp = mt_workspace_nlp(s->w);
    mt_nlp_options options = mt_nlp_options_default();
    mt_nlp_result found = {0};
    nlp.origin = s->best->t;
    options.starts = 1;
    options.max_evals = s->most;
    scale_weight(s->w->p, s->weight, goal, factor);
    const mt_status rc = mt_workspace_solve(s->w, &nlp, &options, mem, &found, err);
    scale_weight(s->w->p, s->weight, goal, 1.0);
    s->evaluations += found.evals;
    if (rc != MT_OK) {
        return rc;
    }
    if (found.n_solutions == 0 || found.compromise || found.stop != MT_STOP_DONE) {
        return mt_describe_warn(s->result, err,
                                "sensitivity to the weights: no design was found with the "
                                "weight of /goals/%d times %g; that part is missing",
                                goal, factor);
    }
    const char *const pointer = mt_arena_printf(&s->result->mem, "/goals/%d", goal);
    MT_TRY(mt_arena_check(&s->result->mem, err));
    mt_case_x(s->w->c, found.solutions[0].t, s->x);
    for (int i = 0; i < s->w->p->n; i++) {
        mt_result_spread *const r = &s->result->spread[i];
        if (s->x[i] < r->low) {
            r->low = s->x[i];
            r->low_goal = pointer;
            r->low_factor = factor;
        } else if (s->x[i] > r->high) {
            r->high = s->x[i];
            r->high_goal = pointer;
            r->high_factor = factor;
        }
    }
    return MT_OK;
}

static mt_status search_all(spread *s, mt_arena *mem, mt_err *err)
{
    const mt_study *const study = s->w->p->study;
    for (int g = 0; g < study->n_goals; g++) {
        const double factor = study->spread.factor;
        if (!MT_HAS(study->goals[g].weight)) {
            continue;
        }
        for (int side = 0; side < 2; side++) {
            const mt_arena_mark mark = mt_arena_get_mark(mem);
            MT_TRY(search_again(s, g, side == 0 ? factor : 1.0 / factor, mem, err));
            mt_arena_rewind(mem, mark);
        }
    }
    for (int i = 0; i < s->result->n_spread; i++) {
        mt_result_spread *const r = &s->result->spread[i];
        const double per_cent = r->value != 0.0 ? 100.0 / fabs(r->value) : nan("");
        r->low_percent = per_cent * (r->low - r->value);
        r->high_percent = per_cent * (r->high - r->value);
    }
    return MT_OK;
}

/* Searches that there are; one at least. */
static long count(const mt_study *study)
{
    long n = 0;
    for (int g = 0; g < study->n_goals; g++) {
        n += MT_HAS(study->goals[g].weight) ? 2 : 0;
    }
    return n > 0 ? n : 1;
}

bool mt_spread_is_asked(const mt_problem *p)
{
    return MT_HAS(p->study->spread.factor) && mt_objective_is(p->aims[0].type, MT_RESIDUALS) &&
           !mt_study_is_discrete(p->study);
}

mt_status mt_spread_solve(mt_workspace *w, const mt_nlp_solution *best, mt_arena *mem,
                          long most, long *evaluations, mt_result *result, mt_err *err)
{
    const mt_case *const asked = w->c;
    const size_t n = (size_t)w->p->n_demands;
    if (!mt_spread_is_asked(w->p)) {
        return MT_OK;
    }
    spread s = {
        .w = w, .c = *asked, .weight = mt_arena_f64(mem, n, 1), .result = result, .best = best};
    MT_TRY(mt_arena_check(mem, err));
    memcpy(s.weight, asked->weight, n * sizeof *s.weight);
    s.c.weight = s.weight;
    MT_TRY(start(&s, err));
    if (most < LONG_MAX) {
        s.most = most / count(w->p->study);
    }
    if (most < LONG_MAX && s.most < EVALUATIONS_LEAST) {
        result->n_spread = 0;
        return mt_describe_warn(result, err,
                                "sensitivity to the weights: not computed, since \"%s\" leaves "
                                "no evaluations for it",
                                mt_search_budget(&w->p->study->search));
    }
    mt_workspace_back(w, &s.c);
    const mt_status rc = search_all(&s, mem, err);
    mt_workspace_back(w, asked);
    *evaluations += s.evaluations;
    return rc;
}
