/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "problem/subproblem.h"

#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/drive_positions.h"
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

#define OPS(id, name) &mt_rows_##name,
static const mt_row_ops *const OPERATIONS[] = {MT_ROW_KIND_LIST(OPS)};

mt_status mt_subproblem_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                                const mt_cut *cuts, mt_workspace *w, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    const mt_row_layout l = {.c = c,
                             .below = below,
                             .n_cuts = n_cuts,
                             .cuts = cuts,
                             .known = c->tolerance_box,
                             .mem = mem};
    c->tolerance_box = NULL;
    c->n_t = p->n;
    c->n_views = p->n_views;
    c->views = p->views;
    c->n_requirements = p->n_requirements;
    c->requirements = p->requirements;
    c->rows = (mt_row_table){.next_of = NULL};
    for (int k = 0; k < MT_ROW_KINDS; k++) {
        const int first = c->rows.in.n;
        c->rows.of_kind[k].first = first;
        MT_TRY(OPERATIONS[k]->lay_out != NULL ? OPERATIONS[k]->lay_out(&l, err) : MT_OK);
        c->rows.of_kind[k].n = c->rows.in.n - first;
    }
    mt_row_block *const blocks[] = {&c->rows.res, &c->rows.eq, &c->rows.in, &c->rows.next};
    for (size_t k = 0; k < MT_COUNT(blocks); k++) {
        MT_TRY(mt_rows_finish(blocks[k], 0, mem, err));
    }
    return w != NULL ? mt_workspace_use(w, c, err) : MT_OK;
}

mt_status mt_subproblem_eval_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                                  mt_err *err)
{
    for (int k = 0; k < MT_ROW_KINDS; k++) {
        MT_TRY(OPERATIONS[k]->eval != NULL ? OPERATIONS[k]->eval(w, with_gradient, out, err)
                                           : MT_OK);
    }
    return MT_OK;
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
