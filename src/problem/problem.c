/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/problem.h"

#include <math.h>
#include <stdlib.h>

#include "base/progress.h"
#include "base/work_counters.h"
#include "problem/drive_positions.h"
#include "problem/goal_avoid.h"
#include "prove/certify.h"

void mt_problem_delete(mt_problem *p)
{
    if (p != NULL) {
        for (int i = 0; i < p->n_views; i++) {
            mt_analysis_delete(p->views[i].original);
        }
        mt_families_free(p);
        if (p->references != NULL) {
            mt_reference_cache_free(p->references);
        }
        mt_arena_free(&p->mem);
        free(p);
    }
}

/* Values of a parameter below this part of the original are next to nothing: there t is linear
 * in x, so that 0 itself is within reach (t = ln(floor) - 1). It is no smaller because the
 * slope of a goal over t falls with it, and a search must still feel that slope to arrive at
 * 0. */
static const double FLOOR_PART = 1e-3;

double mt_problem_t(const mt_problem *p, int i, double x)
{
    const double floor = p->floor[i];
    if (MT_HAS(p->scale[i])) {
        return x / p->scale[i];
    }
    return x < floor ? log(floor) + ((x - floor) / floor) : log(x);
}

double mt_problem_value(const mt_problem *p, int i, double t)
{
    const double floor = p->floor[i];
    if (MT_HAS(p->scale[i])) {
        return t * p->scale[i];
    }
    const double below = floor > 0.0 ? t - log(floor) : 0.0;
    return below < 0.0 ? floor * (1.0 + below) : exp(t);
}

/* The measure of one variable's change. */
static void init_measure(mt_problem *p, int i)
{
    const mt_variable *const v = &p->study->variables[i];
    /* of the whole catalogue, also where the bounds have been closed on one of its values */
    const double least = v->n_catalogue > 0 ? v->catalogue[0] : v->lower;
    const bool logarithmic = !MT_HAS(v->scale) && least >= 0.0 && v->original > 0.0;
    const double linear = MT_HAS(v->scale) ? v->scale : v->range;
    p->scale[i] = logarithmic ? nan("") : linear;
    p->floor[i] = logarithmic && !(least > 0.0) ? FLOOR_PART * v->original : 0.0;
}

static mt_status init_variables(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    p->inputs = mt_arena_int(&p->mem, n);
    p->original = mt_arena_f64(&p->mem, n, 1);
    p->scale = mt_arena_f64(&p->mem, n, 1);
    p->floor = mt_arena_f64(&p->mem, n, 1);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        p->inputs[i] = v->parameter;
        p->original[i] = v->original;
        init_measure(p, i);
    }
    return MT_OK;
}

static mt_status init_references(mt_problem *p, mt_err *err)
{
    p->references = mt_arena_alloc(&p->mem, 1, sizeof *p->references);
    MT_TRY(mt_arena_check(&p->mem, err));
    return mt_reference_cache_init(p->references, p->study, p->run, &p->mem, err);
}

static double proof_work(const mt_search *s)
{
    return MT_HAS(s->proof_s) ? s->proof_s * MT_CERTIFY_WORK_PER_S : MT_CERTIFY_WORK;
}

/* The whole study as a subproblem. */
static mt_status init_whole(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n + 1;
    mt_subproblem *const c = &p->whole;
    double *const weight = mt_arena_f64(&p->mem, (size_t)p->n_requirements, 1);
    double *const change_weight = mt_arena_f64(&p->mem, n, 1);
    *c = (mt_subproblem){.p = p,
                         .lower = mt_arena_f64(&p->mem, n, 1),
                         .upper = mt_arena_f64(&p->mem, n, 1),
                         .lower_t = mt_arena_f64(&p->mem, n, 1),
                         .upper_t = mt_arena_f64(&p->mem, n, 1),
                         .origin_t = mt_arena_f64(&p->mem, n, 1),
                         .change_weight = change_weight,
                         .n_stages = p->n_stages,
                         .stages = p->stages,
                         .weight = weight,
                         .search = p->study->search,
                         .proof_work = proof_work(&p->study->search)};
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        mt_subproblem_bound(c, i, v->lower, v->upper);
        c->origin_t[i] = mt_problem_t(p, i, v->original);
        change_weight[i] = v->weight;
    }
    for (int i = 0; i < p->n_requirements; i++) {
        weight[i] = p->requirements[i].goal->weight;
    }
    return mt_subproblem_lay_out(c, NULL, 0, NULL, NULL, &p->mem, err);
}

mt_system_def mt_problem_system(const mt_problem *p, int configuration, const double *x)
{
    return (mt_system_def){.model = p->study->model,
                           .run = p->run,
                           .configuration = configuration,
                           .n_inputs = p->n,
                           .inputs = p->inputs,
                           .at = x};
}

mt_status mt_problem_new(const mt_study *study, const mt_run *run, mt_problem **out,
                         mt_err *err)
{
    *out = NULL;
    mt_problem *const p = calloc(1, sizeof *p);
    if (p == NULL) {
        return mt_fail_memory(err);
    }
    p->study = study;
    p->run = mt_run_or_none(run);
    p->n = study->n_variables;
    mt_status rc = mt_arena_init(&p->mem, 0, err);
    rc = rc == MT_OK ? init_references(p, err) : rc;
    rc = rc == MT_OK ? init_variables(p, err) : rc;
    rc = rc == MT_OK ? mt_problem_check_responses(p, err) : rc;
    rc = rc == MT_OK ? mt_problem_init_requirements(p, err) : rc;
    rc = rc == MT_OK ? mt_avoidances_compile(p, err) : rc;
    if (rc == MT_OK) {
        mt_problem_query(p);
    }
    rc = rc == MT_OK ? mt_problem_init_program(p, err) : rc;
    rc = rc == MT_OK ? init_whole(p, err) : rc;
    if (rc != MT_OK) {
        mt_problem_delete(p);
        return rc;
    }
    *out = p;
    return MT_OK;
}

mt_status mt_problem_try(const mt_study *study, mt_err *err)
{
    mt_problem *p = NULL;
    const mt_status rc = mt_problem_new(study, NULL, &p, err);
    mt_problem_delete(p);
    return rc;
}

void mt_problem_note_modal(const mt_problem *p, long n)
{
    mt_work_counters_note(p->run->work, MT_WORK_MODAL, n);
    mt_progress_solved(p->run->progress, n);
}
