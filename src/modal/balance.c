/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every state held by a spring of one stiffness, K = D^-2 with D the units: then K x + A^T mu =
 * f, A x = 0 has one x, what of f the constraints do not hold, in units, is least, and it is 0
 * where they hold it all. What a second solution, with f - A^T mu for f, makes of mu tells what
 * the first one left open of it, by the condition of A as this f feels it.
 */
#include "modal/balance.h"

#include "modal/sparse_priv.h"

#include <math.h>
#include <string.h>

/* A constraint's stiffness over that of a state: forces that add up along some hundred thousand
 * joints converge still, and eps times this is well below 1. */
static const double STIFFER = 1e12;

/* D^-2. */
static mt_status springs(const mt_sparse_problem *of, mt_arena *mem, mt_squares *out,
                         mt_err *err)
{
    const size_t n = (size_t)of->n;
    double *const c = mt_arena_f64(mem, n, 1);
    mt_rows_begin(&out->row, of->n, n, mem);
    MT_TRY(mt_arena_check(mem, err));
    out->c = c;
    for (int j = 0; j < of->n; j++) {
        c[j] = 1.0;
        mt_rows_push(&out->row, j, j, 1.0 / of->unit[j]);
        mt_rows_end(&out->row, j);
    }
    return MT_OK;
}

static mt_status find_balancing_multipliers(const mt_sparse_problem *of, const double *f,
                                            double *mu, double *open, bool *found,
                                            mt_arena *mem, mt_err *err)
{
    const int rows = of->a.n_rows;
    mt_sparse_problem p = {.n = of->n,
                           .a = of->a,
                           .part = of->part,
                           .unit = of->unit,
                           .check = of->check,
                           .context = of->context};
    double *const left = mt_arena_f64(mem, (size_t)of->n, 1);
    MT_TRY(springs(of, mem, &p.k, err));
    p.m = p.k;
    mt_sparse s = {.p = &p, .mem = mem, .stiffer = STIFFER};
    MT_TRY(mt_sparse_prepare(&s, err));
    /* where the constraints leave no motion x is rounding, and this no matter */
    bool sound = false;
    MT_TRY(mt_sparse_factor(&s, 0.0, &sound, err));
    *found = s.factor.negative == 0 && s.least > 0.0;
    if (!*found) {
        return MT_OK;
    }
    memcpy(left, f, (size_t)of->n * sizeof *left);
    MT_TRY(mt_sparse_solve(&s, 1, left, MT_SPARSE_SOLVED, s.x, err));
    memcpy(mu, s.mu, (size_t)rows * sizeof *mu);
    for (int r = 0; r < rows; r++) {
        mt_rows_axpy(&of->a, r, -mu[r], left);
    }
    MT_TRY(mt_sparse_solve(&s, 1, left, MT_SPARSE_SOLVED, s.x, err));
    for (int r = 0; r < rows; r++) {
        mu[r] += s.mu[r];
        open[r] = fabs(s.mu[r]);
    }
    return MT_OK;
}

mt_status mt_modal_balance(const mt_sparse_problem *p, const double *f, double *mu,
                           double *open, bool *found, mt_err *err)
{
    mt_arena work = {.first = NULL};
    *found = false;
    mt_status rc = mt_arena_init(&work, 0, err);
    rc = rc == MT_OK ? find_balancing_multipliers(p, f, mu, open, found, &work, err) : rc;
    mt_arena_free(&work);
    return rc;
}
