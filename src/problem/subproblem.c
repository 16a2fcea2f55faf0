/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subproblem: bounds, coordinates, the arrays of its rows, its budget. */

#include "problem/subproblem.h"

#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/problem.h"
#include "problem/tolerance.h"

mt_row mt_row_init(mt_row_kind kind, mt_row_sense sense)
{
    return (mt_row){.kind = kind,
                    .sense = sense,
                    .requirement = -1,
                    .avoidance = -1,
                    .view = -1,
                    .corner = -1,
                    .objective = -1,
                    .implied_by = -1,
                    .limit = nan(""),
                    .tolerance = nan("")};
}

mt_status mt_rows_append(mt_row_block *block, const mt_row *row, mt_arena *mem, mt_err *err)
{
    mt_row *const grown =
        mt_arena_grow(mem, block->rows, block->n, &block->room, sizeof *grown);
    MT_TRY(mt_arena_check(mem, err));
    block->rows = grown;
    block->rows[block->n++] = *row;
    return MT_OK;
}

mt_status mt_rows_finish(mt_row_block *block, int more, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)block->n + (size_t)more;
    mt_row *const rows = mt_arena_alloc(mem, n, sizeof *rows);
    double *const tol = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < block->n; i++) {
        rows[i] = block->rows[i];
        tol[i] = rows[i].tolerance;
    }
    *block = (mt_row_block){.n = block->n, .room = block->n + more, .rows = rows, .tol = tol};
    return MT_OK;
}

double mt_problem_t(const mt_problem *p, int i, double x)
{
    const double floor = p->floor[i];
    if (MT_HAS(p->scale[i])) {
        return x / p->scale[i];
    }
    return x < floor ? log(floor) + ((x - floor) / floor) : log(x);
}

/* Value of variable i at coordinate t; exact to rounding. */
static double value_of(const mt_problem *p, int i, double t)
{
    const double floor = p->floor[i];
    if (MT_HAS(p->scale[i])) {
        return t * p->scale[i];
    }
    const double below = floor > 0.0 ? t - log(floor) : 0.0;
    return below < 0.0 ? floor * (1.0 + below) : exp(t);
}

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

mt_status mt_subproblem_for_stages(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                                   mt_err *err)
{
    *out = *from;
    out->held = mt_arena_alloc(mem, (size_t)from->n_stages, sizeof *out->held);
    out->r_held = mt_arena_f64(mem, (size_t)from->rows.res.n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_rows_finish(&out->rows.eq, from->rows.res.n, mem, err));
    return mt_rows_finish(&out->rows.in, from->n_stages, mem, err);
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
            x[i] = value_of(p, i, t[i]);
        }
    }
}

double mt_subproblem_change(const mt_subproblem *c, const double *t)
{
    return mt_change(c->p->n, c->origin_t, c->change_weight, t);
}

int mt_subproblem_rows_res(const mt_subproblem *c)
{
    return mt_objective_is(c->stages[c->stage].type, MT_RESIDUALS) ? c->rows.res.n : 0;
}

mt_missed mt_subproblem_missed(const mt_subproblem *c, const mt_nlp_values *v)
{
    return mt_missed_of(c->rows.eq.n, v->eq, c->rows.eq.tol, c->rows.in.n, v->in,
                        c->rows.in.tol);
}

mt_status mt_subproblem_values_init(const mt_subproblem *c, mt_arena *mem, mt_nlp_values *out,
                                    mt_err *err)
{
    const size_t n = (size_t)c->n_t;
    const size_t n_res = (size_t)mt_subproblem_rows_res(c);
    const size_t n_eq = (size_t)c->rows.eq.n;
    const size_t n_in = (size_t)c->rows.in.n;
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
