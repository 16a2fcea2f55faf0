/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/subproblem.h"

#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/at_position.h"
#include "problem/drive_positions.h"
#include "problem/goal_avoid.h"
#include "problem/mode_order.h"
#include "problem/tolerance.h"

mt_status mt_subproblem_copy(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                             mt_err *err)
{
    const size_t n = (size_t)from->p->n + 1;
    double *const numbers = mt_arena_f64(mem, n, 5);
    MT_TRY(mt_arena_check(mem, err));
    const double *const old[] = {from->lower, from->upper, from->lower_t, from->upper_t,
                                 from->origin_t};
    for (size_t k = 0; k < MT_COUNT(old); k++) {
        memcpy(numbers + (k * n), old[k], n * sizeof *numbers);
    }
    *out = *from;
    out->lower = numbers;
    out->upper = numbers + n;
    out->lower_t = numbers + (2 * n);
    out->upper_t = numbers + (3 * n);
    out->origin_t = numbers + (4 * n);
    return MT_OK;
}

void mt_subproblem_bound(mt_subproblem *c, int i, double lower, double upper)
{
    c->lower[i] = lower;
    c->upper[i] = upper;
    c->lower_t[i] = mt_problem_t(c->p, i, lower);
    c->upper_t[i] = mt_problem_t(c->p, i, upper);
    c->tolerance_box = NULL; /* its corners are those of all bounds */
}

/* Of rows of the objective "vibration": what it is told within. */
static const double SOFT_TOLERANCE = 1e-7;

/* Tolerances of all rows; those of corners and held objectives follow. */
static mt_status init_tolerances(mt_subproblem *c, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    mt_avoidance_row at;
    c->eq_tol = mt_arena_f64(mem, (size_t)p->n_eq + (size_t)p->n_res, 1);
    c->in_tol = mt_arena_f64(mem, (size_t)c->n_in + (size_t)c->n_stages, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->row_eq >= 0) {
            c->eq_tol[d->row_eq] = d->tolerance;
        }
        for (int k = 0; k < d->n_in; k++) {
            c->in_tol[d->row_in + k] = d->tolerance;
        }
        for (int k = 0; k < d->n_soft && c->forced_response; k++) {
            c->in_tol[c->first_soft_row + d->row_soft + k] = SOFT_TOLERANCE;
        }
    }
    for (int i = 0; i < c->n_at_position; i++) {
        for (int k = 0; k < c->at_position[i].n_in; k++) {
            c->in_tol[c->at_position[i].row_in + k] = c->at_position[i].tolerance;
        }
    }
    for (int k = 0; c->below != NULL && mt_avoidance_row_at(c, c->below, k, &at); k++) {
        c->in_tol[c->first_band_row + k] = c->avoidances[at.avoidance].tolerance;
    }
    return MT_OK;
}

/* Appends the rows of the objective "vibration" to those of the bands, and its coordinate: any
 * ratio of e^-49 to e^50. */
static void lay_out_soft(mt_subproblem *c)
{
    const int n = c->p->n;
    c->forced_response = mt_objective_is(c->stages[0].type, MT_SHAKES);
    c->first_soft_row = c->n_in;
    if (c->forced_response) {
        c->n_in += c->p->n_soft;
        c->n_t = n + 1;
        c->lower_t[n] = 1.0;
        c->upper_t[n] = 2.0 * MT_FORCED_RESPONSE_SHIFT;
        c->origin_t[n] = MT_FORCED_RESPONSE_SHIFT;
    }
}

mt_status mt_subproblem_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                                const mt_cut *cuts, mt_workspace *w, mt_arena *mem, mt_err *err)
{
    const mt_problem_tolerance_box *const known = c->tolerance_box;
    c->tolerance_box = NULL;
    c->n_next = 0;
    MT_TRY(mt_avoidance_lay_out(c, below, n_cuts, cuts, mem, err));
    lay_out_soft(c);
    MT_TRY(mt_at_position_lay_out(c, n_cuts, cuts, mem, err));
    MT_TRY(init_tolerances(c, mem, err));
    MT_TRY(mt_tolerance_init(c, known, mem, err));
    MT_TRY(mt_mode_order_init(c, mem, err));
    return w != NULL ? mt_workspace_use(w, c, err) : MT_OK;
}

mt_status mt_subproblem_in_placement(const mt_subproblem *from, const int *below, int n_cuts,
                                     const mt_cut *cuts, mt_workspace *w, mt_arena *mem,
                                     mt_subproblem *out, mt_err *err)
{
    MT_TRY(mt_subproblem_copy(from, mem, out, err));
    return mt_subproblem_lay_out(out, below, n_cuts, cuts, w, mem, err);
}

mt_status mt_subproblem_for_stages(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                                   mt_err *err)
{
    const size_t n_eq = (size_t)from->p->n_eq + (size_t)from->p->n_res;
    const size_t n_in = (size_t)from->n_in + (size_t)from->n_stages;
    *out = *from;
    out->held = mt_arena_alloc(mem, (size_t)from->n_stages, sizeof *out->held);
    out->r_held = mt_arena_f64(mem, (size_t)from->p->n_res, 1);
    out->eq_tol = mt_arena_f64(mem, n_eq, 1);
    out->in_tol = mt_arena_f64(mem, n_in, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(out->eq_tol, from->eq_tol, n_eq * sizeof *out->eq_tol);
    memcpy(out->in_tol, from->in_tol, (size_t)from->n_in * sizeof *out->in_tol);
    return MT_OK;
}

/* The catalogue value whose coordinate is exactly t; false where there is none. */
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

void mt_subproblem_x(const mt_subproblem *c, const double *t, double *x)
{
    const mt_problem *const p = c->p;
    for (int i = 0; i < p->n; i++) {
        /* the original value first: it may lie outside the bounds, where the baseline is
         * meant */
        if (t[i] == c->origin_t[i]) {
            x[i] = p->original[i];
        } else if (catalogue_value(p, i, t[i], &x[i])) {
            continue;
        } else if (!(t[i] < c->upper_t[i])) {
            x[i] = c->upper[i];
        } else if (!(t[i] > c->lower_t[i])) {
            x[i] = c->lower[i];
        } else {
            x[i] = mt_problem_value(p, i, t[i]);
        }
    }
}

double mt_subproblem_change(const mt_subproblem *c, const double *t)
{
    return mt_change(c->p->n, c->origin_t, c->change_weight, t);
}

int mt_subproblem_rows_res(const mt_subproblem *c)
{
    return mt_objective_is(c->stages[c->stage].type, MT_RESIDUALS) ? c->p->n_res : 0;
}

/* True where a misfit is among the objectives before the present one. */
static bool misfit_held(const mt_subproblem *c)
{
    for (int k = 0; k < c->stage; k++) {
        if (mt_objective_is(c->stages[k].type, MT_RESIDUALS)) {
            return true;
        }
    }
    return false;
}

int mt_subproblem_rows_in(const mt_subproblem *c)
{
    return c->n_in + c->stage - (misfit_held(c) ? 1 : 0);
}

int mt_subproblem_rows_eq(const mt_subproblem *c)
{
    return c->p->n_eq + (misfit_held(c) ? c->p->n_res : 0);
}

mt_status mt_subproblem_values_init(const mt_subproblem *c, mt_arena *mem, mt_nlp_values *out,
                                    mt_err *err)
{
    const size_t n = (size_t)c->n_t;
    const size_t n_res = (size_t)mt_subproblem_rows_res(c);
    const size_t n_eq = (size_t)mt_subproblem_rows_eq(c);
    const size_t n_in = (size_t)mt_subproblem_rows_in(c);
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
    return mt_arena_check(mem, err);
}

long mt_subproblem_solutions(const mt_subproblem *c)
{
    long n = c->n_views;
    for (int i = 0; c->tolerance_box != NULL && i < c->n_views; i++) {
        n += c->tolerance_box->views[i].n;
    }
    return n;
}

long mt_subproblem_worth(const mt_subproblem *c, long n)
{
    const long each = c->search.solutions_each;
    return each > 0 && n > 0 ? ((n - 1) / each) + 1 : 0;
}

long mt_subproblem_counted(const mt_subproblem *c, long evals)
{
    return evals + mt_subproblem_worth(
                       c, (mt_subproblem_solutions(c) - c->search.solutions_each) * evals);
}

long mt_subproblem_afford(const mt_subproblem *c, long evals)
{
    const long each = c->search.solutions_each;
    const long own = mt_subproblem_solutions(c);
    if (each <= 0 || own <= each) {
        return evals;
    }
    const double fewer = (double)evals * (double)each / (double)own;
    return fewer > 1.0 ? (long)fewer : 1;
}
