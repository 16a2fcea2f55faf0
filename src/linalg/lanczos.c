/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * V orthonormal, H = V^T A V (j x j), A V = V H + v_(j+1) b^T. A new vector w = A v_j is made
 * orthogonal to all of V (twice: once leaves what cancellation hides), its coefficients are the
 * column of H. When V is full, the leading Ritz vectors and v_(j+1) stay, H becomes diagonal
 * with one row b, and the iteration goes on.
 */
#include "linalg/lanczos.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "linalg/dense.h"

enum { MOST_RESTARTS = 60, STEP = 4, ROOM = 22 };

/* A residual below this part of the eigenvalue leaves its square in the Rayleigh quotient. */
static const double FOUND = 1e-9;
/* In units of eps and the largest eigenvalue: what rounding leaves of a residual at least, and
 * what a careful method does. */
static const double LEAST = 4.0;
static const double ROUNDING = 64.0;

typedef struct iteration {
    const mt_lanczos *p;
    int most;            /* columns of V beside the one that comes next */
    int j;               /* columns that are there */
    double *v;           /* n x (most + 1) */
    double *h;           /* most x most, full */
    double *b;           /* [most] only the last entry before the first restart */
    double *q;           /* j x j: eigenvectors of H */
    double *theta;       /* [j] ascending */
    double *coefficient; /* [most + 1 + locked] */
    double *row;         /* [most] of V */
    double *mw;          /* [n] M w; NULL: M is the identity */
    double *start;       /* [n] then */
    mt_arena *mem;
} iteration;

static double *column(const iteration *it, int j)
{
    return it->v + ((ptrdiff_t)j * it->p->n);
}

/* M w; w itself where M is the identity. */
static const double *weigh(const iteration *it, const double *w)
{
    if (it->mw == NULL) {
        return w;
    }
    it->p->metric(it->p->context, w, it->mw);
    return it->mw;
}

static double norm(const iteration *it, const double *w)
{
    return it->mw == NULL ? mt_norm2(it->p->n, w)
                          : sqrt(fmax(mt_dot(it->p->n, w, weigh(it, w)), 0.0));
}

/* w := w - V V^T M w, locked vectors included; the coefficients of V are added to h[j]. */
static void orthogonalise(const iteration *it, int j, double *w, double *h)
{
    const int n = it->p->n;
    double *const c = it->coefficient;
    const double *const mw = weigh(it, w);
    if (it->p->n_locked > 0) {
        mt_gemv(true, n, it->p->n_locked, 1.0, it->p->locked, n, mw, 0.0, c);
        mt_gemv(false, n, it->p->n_locked, -1.0, it->p->locked, n, c, 1.0, w);
    }
    if (j > 0) {
        mt_gemv(true, n, j, 1.0, it->v, n, mw, 0.0, c);
        mt_gemv(false, n, j, -1.0, it->v, n, c, 1.0, w);
        for (int i = 0; i < j && h != NULL; i++) {
            h[i] += c[i];
        }
    }
}

/* A unit vector of its own direction, orthogonal to the first j; *is false where there is none.
 * No direction is of another iteration, of another seed: of a repeated eigenvalue each gives
 * but one vector, which then is locked. Where M may be blind, the vector is one that A made:
 * what M does not see of it would stay in all that follow (Nour-Omid, Parlett, Ericsson and
 * Jensen, Math. Comp. 48, 1987). */
static mt_status fresh(iteration *it, int j, bool *is, mt_err *err)
{
    double *const w = column(it, j);
    double *const random = it->mw == NULL ? w : it->start;
    const uint32_t seed = ((uint32_t)it->p->seed << 20U) + (uint32_t)j;
    uint32_t state = (2654435769U * (seed + 1U)) | 1U;
    for (int i = 0; i < it->p->n; i++) {
        state = (state * 1664525U) + 1013904223U;
        random[i] = ((double)(state >> 8U) / 8388608.0) - 1.0;
    }
    if (it->mw != NULL) { /* a small eigenvalue would drown in the largest */
        orthogonalise(it, j, random, NULL);
        MT_TRY(it->p->apply(it->p->context, random, w, err));
    }
    const double whole = norm(it, w);
    orthogonalise(it, j, w, NULL);
    orthogonalise(it, j, w, NULL);
    const double left = norm(it, w);
    for (int i = 0; i < it->p->n && left > 0.0; i++) {
        w[i] /= left;
    }
    *is = left > sqrt(DBL_EPSILON) * whole;
    return MT_OK;
}

/* Eigenpairs of H, ascending. */
static mt_status ritz(iteration *it, mt_err *err)
{
    for (int c = 0; c < it->j; c++) {
        for (int r = 0; r < it->j; r++) {
            it->q[r + ((ptrdiff_t)c * it->j)] = it->h[r + ((ptrdiff_t)c * it->most)];
        }
    }
    return mt_eig_sym(it->j, it->q, it->theta, true, it->mem, err);
}

/* Residual of the k-th largest: b^T q. */
static double residual(const iteration *it, int k)
{
    return fabs(mt_dot(it->j, it->b, it->q + ((ptrdiff_t)(it->j - 1 - k) * it->j)));
}

static int count_found(const iteration *it)
{
    const double unit = DBL_EPSILON * it->theta[it->j - 1];
    int k = 0;
    while (k < it->j && k < it->p->wanted &&
           residual(it, k) <=
               fmax(LEAST * unit, fmin(FOUND * it->theta[it->j - 1 - k], ROUNDING * unit))) {
        k++;
    }
    return k;
}

/* V := V Q for the `keep` largest. */
static void rotate(iteration *it, int keep)
{
    const ptrdiff_t j = it->j;
    mt_turn_columns(it->p->n, it->j, keep, it->q + ((j - 1) * j), -j, it->v, it->row);
}

/* Keep the largest; v_(j+1) comes behind them. */
static void restart(iteration *it, int keep)
{
    for (int k = 0; k < keep; k++) { /* b before q is of no more use */
        it->coefficient[k] = mt_dot(it->j, it->b, it->q + ((ptrdiff_t)(it->j - 1 - k) * it->j));
    }
    rotate(it, keep);
    memcpy(column(it, keep), column(it, it->j), (size_t)it->p->n * sizeof *it->v);
    memset(it->h, 0, (size_t)it->most * (size_t)it->most * sizeof *it->h);
    memset(it->b, 0, (size_t)it->most * sizeof *it->b);
    for (int k = 0; k < keep; k++) {
        it->h[k + ((ptrdiff_t)k * it->most)] = it->theta[it->j - 1 - k];
        it->b[k] = it->coefficient[k];
    }
    it->j = keep;
}

/* One more column of V and H; false: A has no more directions. */
static mt_status extend(iteration *it, bool *more, mt_err *err)
{
    const int j = it->j;
    double *const w = column(it, j + 1);
    double *const h = it->h + ((ptrdiff_t)j * it->most);
    MT_TRY(it->p->apply(it->p->context, column(it, j), w, err));
    memset(h, 0, (size_t)it->most * sizeof *h);
    const double whole = norm(it, w);
    orthogonalise(it, j + 1, w, h);
    orthogonalise(it, j + 1, w, h);
    for (int i = 0; i < j; i++) {
        it->h[j + ((ptrdiff_t)i * it->most)] = h[i];
    }
    const double beta = norm(it, w);
    memset(it->b, 0, (size_t)it->most * sizeof *it->b);
    it->j = j + 1;
    *more = true;
    if (!isfinite(whole)) {
        return mt_fail(err, MT_E_DOMAIN, "a vector of Lanczos' method is not finite");
    }
    if (beta > ROUNDING * DBL_EPSILON * whole && beta > 0.0) {
        it->b[j] = beta;
        for (int i = 0; i < it->p->n; i++) {
            w[i] /= beta;
        }
        return MT_OK;
    }
    *more = false;
    return it->j + it->p->n_locked < it->p->n ? fresh(it, it->j, more, err) : MT_OK;
}

static mt_status init(iteration *it, mt_err *err)
{
    const mt_lanczos *const p = it->p;
    const int room = p->n - p->n_locked;
    it->most = (2 * p->wanted) + ROOM < room ? (2 * p->wanted) + ROOM : room;
    const size_t most = (size_t)it->most;
    it->v = mt_arena_f64(it->mem, (size_t)p->n, most + 1);
    it->h = mt_arena_f64(it->mem, most, most);
    it->b = mt_arena_f64(it->mem, most, 1);
    it->q = mt_arena_f64(it->mem, most, most);
    it->theta = mt_arena_f64(it->mem, most, 1);
    it->coefficient = mt_arena_f64(it->mem, most + 1 + (size_t)p->n_locked, 1);
    it->row = mt_arena_f64(it->mem, most, 1);
    if (p->metric != NULL) {
        it->mw = mt_arena_f64(it->mem, (size_t)p->n, 1);
        it->start = mt_arena_f64(it->mem, (size_t)p->n, 1);
    }
    return mt_arena_check(it->mem, err);
}

static mt_status iterate(iteration *it, int *found, mt_err *err)
{
    const mt_lanczos *const p = it->p;
    int restarts = 0;
    bool more = false;
    if (it->most > 0) {
        MT_TRY(fresh(it, 0, &more, err));
    }
    if (!more) {
        return MT_OK;
    }
    while (more && *found < p->wanted && restarts <= MOST_RESTARTS) {
        MT_TRY(extend(it, &more, err));
        const bool full = it->j == it->most;
        if (more && !full && (it->j < p->wanted || (it->j - p->wanted) % STEP != 0)) {
            continue;
        }
        MT_TRY(ritz(it, err));
        *found = count_found(it);
        if (more && full && *found < p->wanted) {
            restart(it, p->wanted + ((it->most - p->wanted) / 2));
            restarts++;
        }
    }
    if (more && *found < p->wanted) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "Lanczos' method found %d of %d eigenvalues",
                       *found, p->wanted);
    }
    const double none = ROUNDING * DBL_EPSILON * it->theta[it->j - 1];
    while (*found > 0 && !(it->theta[it->j - *found] > none)) {
        --*found;
    }
    rotate(it, *found);
    return MT_OK;
}

mt_status mt_lanczos_largest(const mt_lanczos *problem, mt_arena *mem, double *x, int *found,
                             mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    iteration it = {.p = problem, .mem = mem};
    *found = 0;
    MT_TRY(init(&it, err));
    MT_TRY(iterate(&it, found, err));
    memcpy(x, it.v, (size_t)problem->n * (size_t)*found * sizeof *x);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
