/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * All matrices stand transposed, T = A_d^-T, so that rows of the equations are contiguous:
 *     X^T = A_f^T T,   refined once by the residual,   X^T += (A_f^T - X^T A_d^T) T,
 * after which what is left of it is what its own evaluation leaves, k + 1 roundings of each of
 * the k terms of an equation. These join E. The second order, E_d dX, is less than a part of
 * the first:
 *     rho = || |A_d^-1| E_d ||_inf < 1,   dX / (1 - rho).
 */
#include "mechanics/follow.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Above this rho nothing is known of A_d^-1. */
static const double MOST_OPEN = 0.5;

typedef struct work {
    int rank;
    int n;
    int *place; /* [nq] of a coordinate among those that follow, or among the free ones */
    double *t;  /* rank x rank: T */
    double *r;  /* n x rank: A_f^T, the residual, then E_d |X| + E_f */
    double *s;  /* [rank] sums of the rows of E_d */
} work;

static mt_status claim_followers(mt_follow *f, work *w, mt_arena *mem, mt_err *err)
{
    const size_t rank = (size_t)w->rank;
    f->x = mt_arena_f64(mem, (size_t)w->n, rank);
    f->dx = mt_arena_f64(mem, (size_t)w->n, rank);
    w->place = mt_arena_int(mem, (size_t)f->nq);
    w->t = mt_arena_f64(mem, rank, rank);
    w->r = mt_arena_f64(mem, (size_t)w->n, rank);
    w->s = mt_arena_f64(mem, rank, 1);
    MT_TRY(mt_arena_check(mem, err));
    int count[2] = {0, 0};
    for (int j = 0; j < f->nq; j++) {
        w->place[j] = count[f->follows[j] ? 1 : 0]++;
    }
    return MT_OK;
}

static mt_status invert(const mt_follow *f, work *w, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t rank = w->rank;
    double *const a = mt_arena_f64(mem, (size_t)rank, (size_t)rank);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < rank; i++) {
        const double *const g = f->g + (i * f->nq);
        for (int j = 0; j < f->nq; j++) {
            if (f->follows[j]) {
                a[w->place[j] + (i * rank)] = g[j];
            }
        }
        w->t[i + (i * rank)] = 1.0;
    }
    return mt_lu_solve(w->rank, a, w->rank, w->t, NULL, mem, err);
}

/* r := A_f^T - X^T A_d^T. */
static void find_residual(const mt_follow *f, work *w)
{
    const ptrdiff_t n = w->n;
    memset(w->r, 0, (size_t)n * (size_t)w->rank * sizeof *w->r);
    for (ptrdiff_t i = 0; i < w->rank; i++) {
        const double *const g = f->g + (i * f->nq);
        double *const r = w->r + (i * n);
        for (int j = 0; j < f->nq; j++) {
            if (g[j] != 0.0 && f->follows[j]) {
                mt_axpy(w->n, -g[j], f->x + (w->place[j] * n), r);
            } else if (g[j] != 0.0) {
                r[w->place[j]] += g[j];
            }
        }
    }
}

/* x += (A_f^T - X^T A_d^T) T. */
static void correct(const mt_follow *f, work *w)
{
    find_residual(f, w);
    mt_gemm(false, false, w->n, w->rank, w->rank, 1.0, w->r, w->n, w->t, w->rank, 1.0, f->x,
            w->n);
}

/* r := E_d |X| + E_f, transposed, and s. */
static void find_open(const mt_follow *f, work *w)
{
    const ptrdiff_t n = w->n;
    memset(w->r, 0, (size_t)n * (size_t)w->rank * sizeof *w->r);
    for (ptrdiff_t i = 0; i < w->rank; i++) {
        const double *const g = f->g + (i * f->nq);
        const double *const e = f->e + (i * f->nq);
        double *const r = w->r + (i * n);
        double roundings = 1.0;
        for (int j = 0; j < f->nq; j++) {
            roundings += g[j] != 0.0 ? 1.0 : 0.0;
        }
        for (int j = 0; j < f->nq; j++) {
            const double open = e[j] + (roundings * DBL_EPSILON * fabs(g[j]));
            const double *const x = f->x + (w->place[j] * n);
            if (open == 0.0) {
                continue;
            }
            if (!f->follows[j]) {
                r[w->place[j]] += open;
                continue;
            }
            w->s[i] += open;
            for (ptrdiff_t c = 0; c < n; c++) {
                r[c] += open * fabs(x[c]);
            }
        }
    }
}

/* t := |T|; returns rho. */
static double find_rho(work *w)
{
    const ptrdiff_t rank = w->rank;
    double rho = 0.0;
    for (ptrdiff_t k = 0; k < rank; k++) {
        double sum = 0.0;
        for (ptrdiff_t i = 0; i < rank; i++) {
            double *const t = w->t + i + (k * rank);
            *t = fabs(*t);
            sum += *t * w->s[i];
        }
        rho = !(sum <= rho) ? sum : rho; /* NaN is kept */
    }
    return rho;
}

mt_status mt_follow_find(mt_follow *f, mt_arena *mem, bool *holds, mt_err *err)
{
    work w = {.rank = f->rank, .n = f->nq - f->rank};
    *holds = false;
    MT_TRY(claim_followers(f, &w, mem, err));
    const mt_status rc = invert(f, &w, mem, err);
    if (rc == MT_E_SINGULAR) {
        return MT_OK;
    }
    MT_TRY(rc);
    correct(f, &w); /* of 0 */
    correct(f, &w);
    find_open(f, &w);
    const double rho = find_rho(&w);
    if (!(rho < MOST_OPEN)) {
        return MT_OK;
    }
    mt_gemm(false, false, w.n, w.rank, w.rank, 1.0 / (1.0 - rho), w.r, w.n, w.t, w.rank, 0.0,
            f->dx, w.n);
    for (ptrdiff_t k = 0; k < (ptrdiff_t)w.n * w.rank; k++) {
        f->dx[k] += DBL_EPSILON * fabs(f->x[k]);
    }
    *holds = true;
    return MT_OK;
}
