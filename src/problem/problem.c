/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/problem.h"

#include <math.h>
#include <stdlib.h>

#include "problem/family.h"
#include "problem/robust.h"

void mt_problem_delete(mt_problem *p)
{
    if (p != NULL) {
        for (int i = 0; i < p->n_views; i++) {
            mt_analysis_delete(p->views[i].analysis);
            mt_analysis_delete(p->views[i].scout);
        }
        mt_families_free(p);
        mt_robust_free(p->robust);
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

/* The inverse of mt_problem_t, between the bounds. */
static double value_at(const mt_problem *p, int i, double t)
{
    const double floor = p->floor[i];
    if (MT_HAS(p->scale[i])) {
        return t * p->scale[i];
    }
    const double below = floor > 0.0 ? t - log(floor) : 0.0;
    return below < 0.0 ? floor * (1.0 + below) : exp(t);
}

/* The catalogue's value whose coordinate is t, to the last bit; false where there is none. */
static bool catalogue_value(const mt_problem *p, int i, double t, double *x)
{
    const mt_variable *const v = &p->study->variables[i];
    int low = 0;
    /* the first value with a coordinate of at least t is in low .. high */
    int high = v->n_catalogue;
    while (low < high) {
        const int middle = low + ((high - low) / 2);
        if (mt_problem_t(p, i, v->catalogue[middle]) < t) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (low == v->n_catalogue || mt_problem_t(p, i, v->catalogue[low]) != t) {
        return false;
    }
    *x = v->catalogue[low];
    return true;
}

void mt_problem_x(const mt_problem *p, const double *t, double *x)
{
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        /* the original value first: it may lie outside the bounds, where the baseline is
         * meant */
        if (t[i] == p->origin_t[i]) {
            x[i] = p->original[i];
        } else if (catalogue_value(p, i, t[i], &x[i])) {
            continue;
        } else if (!(t[i] < p->upper_t[i])) {
            x[i] = v->upper;
        } else if (!(t[i] > p->lower_t[i])) {
            x[i] = v->lower;
        } else {
            x[i] = value_at(p, i, t[i]);
        }
    }
}

double mt_problem_stretch_at(const mt_problem *p, int i, double x)
{
    return MT_HAS(p->scale[i]) ? p->scale[i] : fmax(x, p->floor[i]);
}

double mt_problem_stretch(const mt_problem *p, int i)
{
    return mt_problem_stretch_at(p, i, p->x[i]);
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
    p->lower_t[i] = mt_problem_t(p, i, v->lower);
    p->upper_t[i] = mt_problem_t(p, i, v->upper);
    p->origin_t[i] = mt_problem_t(p, i, v->original);
}

static mt_status init_variables(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    double **const arrays[] = {&p->original, &p->lower_t, &p->upper_t, &p->origin_t, &p->scale,
                               &p->floor,    &p->x,       &p->t,       &p->work};
    p->inputs = mt_arena_int(&p->mem, n);
    bool bad = p->inputs == NULL;
    for (int i = 0; i < MT_COUNT(arrays); i++) {
        *arrays[i] = mt_arena_f64(&p->mem, n + 1, 1); /* one more for the clearance */
        bad = bad || *arrays[i] == NULL;
    }
    if (bad) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        p->inputs[i] = v->parameter;
        p->original[i] = v->original;
        init_measure(p, i);
    }
    return MT_OK;
}

mt_status mt_problem_new(const mt_study *study, mt_reference_cache *references,
                         mt_problem **out, mt_err *err)
{
    return mt_problem_new_in_gap(study, references, NULL, out, err);
}

mt_status mt_problem_new_in_gap(const mt_study *study, mt_reference_cache *references,
                                const int *below, mt_problem **out, mt_err *err)
{
    return mt_problem_new_cut(study, references, below, 0, NULL, out, err);
}

static mt_status init_demands(mt_problem *p, const int *below, int n_cuts, const mt_cut *cuts,
                              mt_err *err)
{
    MT_TRY(mt_problem_init_demands(p, n_cuts, err));
    MT_TRY(mt_clear_init(p, below, n_cuts, cuts, err));
    return mt_problem_init_rows(p, err);
}

mt_status mt_problem_new_cut(const mt_study *study, mt_reference_cache *references,
                             const int *below, int n_cuts, const mt_cut *cuts, mt_problem **out,
                             mt_err *err)
{
    *out = NULL;
    mt_problem *const p = calloc(1, sizeof *p);
    if (p == NULL) {
        return mt_fail_memory(err);
    }
    p->study = study;
    p->references = references;
    p->n = study->n_variables;
    p->motion_room = HUGE_VAL;
    p->clearance = below != NULL && study->n_objectives > 0 &&
                   mt_objective_is(study->objectives[0].type, MT_BANDS);
    p->n_t = p->n + (p->clearance ? 1 : 0);
    mt_status rc = mt_arena_init(&p->mem, 0, err);
    rc = rc == MT_OK ? init_variables(p, err) : rc;
    rc = rc == MT_OK ? init_demands(p, below, n_cuts, cuts, err) : rc;
    rc = rc == MT_OK ? mt_problem_init_aims(p, err) : rc;
    rc = rc == MT_OK ? mt_robust_init(p, err) : rc;
    rc = rc == MT_OK ? mt_next_init(p, err) : rc;
    if (rc != MT_OK) {
        mt_problem_delete(p);
        return rc;
    }
    *out = p;
    return MT_OK;
}

static int residuals(const mt_problem *p)
{
    return mt_objective_is(p->aims[p->stage].type, MT_RESIDUALS) ? p->n_res : 0;
}

/* Is a misfit among the objectives before the present one? */
static bool misfit_held(const mt_problem *p)
{
    for (int k = 0; k < p->stage; k++) {
        if (mt_objective_is(p->aims[k].type, MT_RESIDUALS)) {
            return true;
        }
    }
    return false;
}

int mt_problem_rows_in(const mt_problem *p)
{
    return p->n_in + p->stage - (misfit_held(p) ? 1 : 0);
}

int mt_problem_rows_eq(const mt_problem *p)
{
    return p->n_eq + (misfit_held(p) ? p->n_res : 0);
}

mt_nlp mt_problem_nlp(mt_problem *p)
{
    const mt_nlp nlp = {.n = p->n_t,
                        .lower = p->lower_t,
                        .upper = p->upper_t,
                        .hint = p->hint,
                        .origin = p->origin_t,
                        .n_res = residuals(p),
                        .n_eq = mt_problem_rows_eq(p),
                        .n_in = mt_problem_rows_in(p),
                        .eq_tol = p->eq_tol,
                        .in_tol = p->in_tol,
                        .n_next = p->n_next,
                        .next_of = p->next_of,
                        .eval = mt_problem_eval,
                        .context = p};
    return nlp;
}

mt_status mt_problem_values_init(const mt_problem *p, mt_arena *mem, mt_nlp_values *out,
                                 mt_err *err)
{
    const size_t n = (size_t)p->n_t;
    const size_t n_res = (size_t)residuals(p);
    const size_t n_eq = (size_t)mt_problem_rows_eq(p);
    const size_t n_in = (size_t)mt_problem_rows_in(p);
    *out = (mt_nlp_values){
        .f = 0.0,
        .df = mt_arena_f64(mem, n, 1),
        .r = mt_arena_f64(mem, n_res, 1),
        .dr = mt_arena_f64(mem, n_res, n),
        .eq = mt_arena_f64(mem, n_eq, 1),
        .deq = mt_arena_f64(mem, n_eq, n),
        .in = mt_arena_f64(mem, n_in, 1),
        .din = mt_arena_f64(mem, n_in, n),
    };
    const bool bad = out->df == NULL || out->r == NULL || out->dr == NULL || out->eq == NULL ||
                     out->deq == NULL || out->in == NULL || out->din == NULL;
    return bad ? mt_fail_memory(err) : MT_OK;
}

mt_status mt_problem_try(const mt_study *study, mt_err *err)
{
    mt_arena mem;
    mt_reference_cache references = {.study = NULL};
    mt_problem *p = NULL;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_status rc = mt_reference_cache_init(&references, study, &mem, err);
    rc = rc == MT_OK ? mt_problem_new(study, &references, &p, err) : rc;
    mt_problem_delete(p);
    mt_reference_cache_free(&references);
    mt_arena_free(&mem);
    return rc;
}
