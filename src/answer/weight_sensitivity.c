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
#include "answer/weight_sensitivity.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/workers.h"
#include "problem/evaluate.h"
#include "search/catalogue_search.h"

/* Of a search without which none is begun. */
enum { EVALUATIONS_LEAST = 20 };

/* One weight, multiplied: a task. */
typedef struct search {
    int goal;
    double factor;
    bool found;
    double *x; /* [n] the design */
    long evaluations;
} search;

typedef struct weight_sensitivity {
    mt_workspace *const *workers; /* set to asked */
    const mt_subproblem *asked;
    const mt_problem *p;
    search *searches; /* [n] */
    int n;
    mt_result *result;
    const mt_nlp_solution *best;
    long most; /* evaluations of each search; 0: no limit */
} weight_sensitivity;

static mt_status start(const weight_sensitivity *s, mt_err *err)
{
    mt_result *const r = s->result;
    const mt_problem *const p = s->p;
    const size_t n = (size_t)p->n;
    double *const x = mt_arena_f64(&r->mem, n, 1);
    r->weight_sensitivity = mt_arena_alloc(&r->mem, n, sizeof *r->weight_sensitivity);
    MT_TRY(mt_arena_check(&r->mem, err));
    mt_subproblem_x(s->asked, s->best->t, x);
    for (int i = 0; i < p->n; i++) {
        const mt_parameter *const parameter = &p->study->model->parameters[p->inputs[i]];
        r->weight_sensitivity[i] = (mt_result_weight_sensitivity){
            .parameter = mt_arena_strdup(&r->mem, parameter->name.s),
            .unit = parameter->unit == NULL ? NULL : mt_arena_strdup(&r->mem, parameter->unit),
            .display_unit = mt_unit_name(p->study->variables[i].shown, NULL),
            .display_factor = mt_unit_display(p->study->variables[i].shown),
            .value = x[i],
            .low = x[i],
            .high = x[i],
            .low_factor = nan(""),
            .high_factor = nan(""),
        };
    }
    MT_TRY(mt_arena_check(&r->mem, err));
    r->n_weight_sensitivity = p->n;
    return MT_OK;
}

static void scale_weight(const mt_problem *p, double *weight, int goal, double factor)
{
    for (int i = 0; i < p->n_requirements; i++) {
        if (p->requirements[i].goal_index == goal) {
            weight[i] = p->study->goals[goal].weight * factor;
        }
    }
}

/* Solves again with one weight changed, from the best design, at which unidentifiable
 * directions are kept. */
static mt_status solve_with_changed_weight(const weight_sensitivity *s, mt_workspace *w,
                                           search *a, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)s->p->n_requirements;
    double *const weight = mt_arena_f64(mem, n, 1);
    mt_subproblem c = *s->asked;
    mt_nlp_options options = mt_nlp_options_default();
    mt_nlp_result found = {0};
    MT_TRY(mt_arena_check(mem, err));
    memcpy(weight, s->asked->weight, n * sizeof *weight);
    scale_weight(s->p, weight, a->goal, a->factor);
    c.weight = weight;
    mt_workspace_back(w, &c);
    mt_nlp nlp = mt_workspace_nlp(w);
    nlp.origin = s->best->t;
    options.starts = 1;
    options.max_evals = s->most;
    const mt_status rc = mt_workspace_solve(w, &nlp, &options, mem, &found, err);
    a->evaluations = found.evals;
    a->found =
        rc == MT_OK && found.n_solutions > 0 && !found.compromise && found.stop == MT_STOP_DONE;
    if (a->found) {
        mt_subproblem_x(&c, found.solutions[0].t, a->x);
    }
    mt_workspace_back(w, s->asked);
    return rc;
}

static mt_status run_search(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    const weight_sensitivity *const s = context;
    mt_workspace *const w = s->workers[worker];
    mt_task_path *const before = w->task_path;
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    w->task_path = own;
    const mt_status rc = solve_with_changed_weight(s, w, &s->searches[task], &mem, err);
    w->task_path = before;
    mt_arena_free(&mem);
    return rc;
}

/* Result of one search for the weight sensitivity. */
static mt_status record_weight_search(const weight_sensitivity *s, const search *a, mt_err *err)
{
    if (!a->found) {
        return mt_describe_warn(s->result, err,
                                "sensitivity to the weights: no design was found with the "
                                "weight of /goals/%d times %g; that part is missing",
                                a->goal, a->factor);
    }
    const char *const pointer = mt_arena_printf(&s->result->mem, "/goals/%d", a->goal);
    MT_TRY(mt_arena_check(&s->result->mem, err));
    for (int i = 0; i < s->p->n; i++) {
        mt_result_weight_sensitivity *const r = &s->result->weight_sensitivity[i];
        if (a->x[i] < r->low) {
            r->low = a->x[i];
            r->low_goal = pointer;
            r->low_factor = a->factor;
        } else if (a->x[i] > r->high) {
            r->high = a->x[i];
            r->high_goal = pointer;
            r->high_factor = a->factor;
        }
    }
    return MT_OK;
}

static mt_status search_all(weight_sensitivity *s, int n_workers, long *evaluations,
                            mt_err *err)
{
    const mt_tasks tasks = {s->n, run_search, NULL, s, "weights"};
    const mt_status rc = mt_workers_run(n_workers, s->workers[0]->task_path, &tasks, err);
    for (int i = 0; i < s->n; i++) {
        *evaluations += s->searches[i].evaluations;
    }
    MT_TRY(rc);
    for (int i = 0; i < s->n; i++) {
        MT_TRY(record_weight_search(s, &s->searches[i], err));
    }
    for (int i = 0; i < s->result->n_weight_sensitivity; i++) {
        mt_result_weight_sensitivity *const r = &s->result->weight_sensitivity[i];
        const double per_cent = r->value != 0.0 ? 100.0 / fabs(r->value) : nan("");
        r->low_percent = per_cent * (r->low - r->value);
        r->high_percent = per_cent * (r->high - r->value);
    }
    return MT_OK;
}

/* The searches: each weighted goal on either side. */
static mt_status list_searches(weight_sensitivity *s, mt_arena *mem, mt_err *err)
{
    const mt_study *const study = s->p->study;
    const double factor = study->weight_sensitivity.factor;
    s->searches = mt_arena_alloc(mem, 2 * (size_t)study->n_goals, sizeof *s->searches);
    MT_TRY(mt_arena_check(mem, err));
    for (int g = 0; g < study->n_goals; g++) {
        for (int side = 0; side < 2 && MT_HAS(study->goals[g].weight); side++) {
            s->searches[s->n++] = (search){.goal = g,
                                           .factor = side == 0 ? factor : 1.0 / factor,
                                           .x = mt_arena_f64(mem, (size_t)s->p->n, 1)};
        }
    }
    return mt_arena_check(mem, err);
}

mt_status mt_weight_sensitivity_solve(mt_workspace *const *workers, int n_workers,
                                      const mt_nlp_solution *best, mt_arena *mem, long most,
                                      long *evaluations, mt_result *result, mt_err *err)
{
    const mt_problem *const p = workers[0]->p;
    weight_sensitivity s = {
        .workers = workers, .asked = workers[0]->c, .p = p, .result = result, .best = best};
    MT_TRY(list_searches(&s, mem, err));
    MT_TRY(start(&s, err));
    if (most < LONG_MAX) {
        s.most = most / (s.n > 0 ? s.n : 1);
    }
    if (most < LONG_MAX && s.most < EVALUATIONS_LEAST) {
        result->n_weight_sensitivity = 0;
        return mt_describe_warn(result, err,
                                "sensitivity to the weights: not computed, since \"%s\" leaves "
                                "no evaluations for it",
                                mt_search_budget(&p->whole.search));
    }
    return search_all(&s, n_workers, evaluations, err);
}
