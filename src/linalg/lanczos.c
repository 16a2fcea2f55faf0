/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * V orthonormal, H = V^T A V (j x j), A V = V H + V_next B^T, V_next the columns that come
 * next. The products W = A V_next are made orthogonal to all of V (twice: once leaves what
 * cancellation hides) and to each other; their coefficients are columns of H and the next B.
 * What then is rounding is left out, and V_next has a column less. When V is full, the leading
 * Ritz vectors and V_next stay, H becomes diagonal with the rows B, and the iteration goes on.
 */
#include "linalg/lanczos.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "linalg/dense.h"

/* ROOM: for so many blocks beside twice what is wanted; what is not used of it is not there
 * (base/arena.h). */
enum { MOST_RESTARTS = 60, STEP = 4, ROOM = 22 };

/* A residual below this part of the eigenvalue leaves its square in the Rayleigh quotient. */
static const double FOUND = 1e-9;
/* In units of eps and the largest eigenvalue: what rounding leaves of a residual at least, and
 * what a careful method does. */
static const double LEAST = 4.0;
static const double ROUNDING = 64.0;

typedef struct iteration {
    const mt_lanczos *p;
    int block;           /* columns of V_next at most */
    int most;            /* columns of V beside V_next */
    int j;               /* columns that are there */
    int width;           /* of V_next */
    double *v;           /* n x (most + block): V, V_next, and W beyond */
    double *h;           /* most x most, lower triangle */
    double *b;           /* most x block */
    double *q;           /* j x j: eigenvectors of H */
    double *theta;       /* [j] ascending */
    double *coefficient; /* [most + block + locked], most x block */
    double *row;         /* [most] of V */
    double *mw;          /* [n] M w; NULL: M is the identity */
    double *start;       /* n x block then */
    mt_arena *mem;
} iteration;

static double *column(const iteration *it, int j)
{
    return it->v + ((ptrdiff_t)j * it->p->n);
}

/* M w; w itself where M is the identity. */
static const double *times_metric(const iteration *it, const double *w)
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
                          : sqrt(fmax(mt_dot(it->p->n, w, times_metric(it, w)), 0.0));
}

/* w := w - V V^T M w for the first j columns of V, locked vectors included; adds the
 * coefficients to h[j]. */
static void orthogonalise(const iteration *it, int j, double *w, double *h)
{
    const int n = it->p->n;
    double *const c = it->coefficient;
    const double *const mw = times_metric(it, w);
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

static mt_status check_finite(double size, mt_err *err)
{
    return isfinite(size)
               ? MT_OK
               : mt_fail(err, MT_E_DOMAIN, "a vector of Lanczos' method is not finite");
}

/* Append w as column j of V with size one; false where the part that is left, `none`, is too
 * small beside its size `whole`. */
static bool append(iteration *it, int j, const double *w, double whole, double none,
                   double *size)
{
    double *const to = column(it, j);
    *size = norm(it, w);
    const bool is = *size > none * whole && *size > 0.0;
    for (int i = 0; i < it->p->n && is; i++) {
        to[i] = w[i] / *size;
    }
    return is;
}

/* Append up to `count` random unit vectors, orthogonal to the first j columns, to V; width:
 * their number. Every iteration uses another seed: each gives only one vector of a repeated
 * eigenvalue per column, which is then locked. With a semidefinite M the vectors are products
 * with A: components that M does not see would remain in all later ones (Nour-Omid, Parlett,
 * Ericsson and Jensen, Math. Comp. 48, 1987). */
static mt_status fresh(iteration *it, int j, int count, mt_err *err)
{
    const ptrdiff_t n = it->p->n;
    double *const v = column(it, j);
    double *const random = it->mw == NULL ? v : it->start;
    for (int c = 0; c < count; c++) {
        double *const w = random + (n * c);
        const uint32_t seed = ((uint32_t)it->p->seed << 20U) + (uint32_t)(j + c);
        uint32_t state = (2654435769U * (seed + 1U)) | 1U;
        for (int i = 0; i < it->p->n; i++) {
            state = (state * 1664525U) + 1013904223U;
            w[i] = ((double)(state >> 8U) / 8388608.0) - 1.0;
        }
        if (it->mw != NULL) { /* a small eigenvalue would drown in the largest */
            orthogonalise(it, j, w, NULL);
        }
    }
    if (it->mw != NULL) {
        MT_TRY(it->p->apply(it->p->context, count, random, v, err));
    }
    it->width = 0;
    for (int c = 0; c < count; c++) {
        double *const w = v + (n * c);
        const int at = j + it->width;
        double size = 0.0;
        const double whole = norm(it, w);
        MT_TRY(check_finite(whole, err));
        orthogonalise(it, at, w, NULL);
        orthogonalise(it, at, w, NULL);
        it->width += append(it, at, w, whole, sqrt(DBL_EPSILON), &size) ? 1 : 0;
    }
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

/* A coefficient of V_next in A times the Ritz vector of the k-th largest. */
static double next_part(const iteration *it, int c, int k)
{
    return mt_dot(it->j, it->b + ((ptrdiff_t)c * it->most),
                  it->q + ((ptrdiff_t)(it->j - 1 - k) * it->j));
}

/* Residual of the k-th largest: |B^T q|. */
static double residual_of_value(const iteration *it, int k)
{
    double size = 0.0;
    for (int c = 0; c < it->width; c++) {
        size = hypot(size, next_part(it, c, k));
    }
    return size;
}

static int count_found(const iteration *it)
{
    const double unit = DBL_EPSILON * it->theta[it->j - 1];
    int k = 0;
    while (k < it->j && k < it->p->wanted &&
           residual_of_value(it, k) <=
               fmax(LEAST * unit, fmin(FOUND * it->theta[it->j - 1 - k], ROUNDING * unit))) {
        k++;
    }
    return k;
}

/* V := V Q for the `keep` largest. */
static void rotate_basis(iteration *it, int keep)
{
    const ptrdiff_t j = it->j;
    mt_turn_columns(it->p->n, it->j, keep, it->q + ((j - 1) * j), -j, it->v, it->row);
}

/* Keep the largest; V_next comes behind them. */
static void restart(iteration *it, int keep)
{
    const size_t most = (size_t)it->most;
    double *const rows = it->coefficient;
    for (int c = 0; c < it->width; c++) { /* b before q is of no more use */
        for (int k = 0; k < keep; k++) {
            rows[k + ((ptrdiff_t)c * it->most)] = next_part(it, c, k);
        }
    }
    rotate_basis(it, keep);
    memmove(column(it, keep), column(it, it->j),
            (size_t)it->p->n * (size_t)it->width * sizeof *it->v);
    memset(it->h, 0, most * most * sizeof *it->h);
    memset(it->b, 0, most * (size_t)it->block * sizeof *it->b);
    for (int k = 0; k < keep; k++) {
        it->h[k + ((ptrdiff_t)k * it->most)] = it->theta[it->j - 1 - k];
        for (int c = 0; c < it->width; c++) {
            const ptrdiff_t at = k + ((ptrdiff_t)c * it->most);
            it->b[at] = rows[at];
        }
    }
    it->j = keep;
}

/* V_next becomes part of V and its products, as far as there are directions, V_next. */
static mt_status extend(iteration *it, mt_err *err)
{
    const int n = it->p->n;
    const int j = it->j;
    const int all = j + it->width;
    const int room = n - it->p->n_locked;
    int kept = 0;
    MT_TRY(it->p->apply(it->p->context, it->width, column(it, j), column(it, all), err));
    memset(it->b, 0, (size_t)it->most * (size_t)it->block * sizeof *it->b);
    for (int c = 0; c < it->width; c++) {
        double *const w = column(it, all + c);
        double *const h = it->row; /* all of V and what is new of V_next */
        double size = 0.0;
        const double whole = norm(it, w);
        MT_TRY(check_finite(whole, err));
        memset(h, 0, (size_t)(all + kept) * sizeof *h);
        orthogonalise(it, all + kept, w, h);
        orthogonalise(it, all + kept, w, h);
        for (int i = 0; i < j; i++) {
            it->h[j + c + ((ptrdiff_t)i * it->most)] = h[i];
        }
        memcpy(it->h + j + c + ((ptrdiff_t)(j + c) * it->most), h + j + c,
               (size_t)(it->width - c) * sizeof *h);
        for (int k = 0; k < kept; k++) {
            it->b[j + c + ((ptrdiff_t)k * it->most)] = h[all + k];
        }
        if (all + kept < room &&
            append(it, all + kept, w, whole, ROUNDING * DBL_EPSILON, &size)) {
            it->b[j + c + ((ptrdiff_t)kept * it->most)] = size;
            kept++;
        }
    }
    it->j = all;
    it->width = kept;
    return kept == 0 && all < room ? fresh(it, all, 1, err) : MT_OK;
}

static mt_status init_iteration(iteration *it, mt_err *err)
{
    const mt_lanczos *const p = it->p;
    const int room = p->n - p->n_locked;
    it->block = p->block < room ? p->block : room;
    it->block = it->block > 1 ? it->block : 1;
    it->most = (2 * p->wanted) + (ROOM * it->block);
    it->most = it->most < room ? it->most : room;
    const size_t most = (size_t)it->most;
    const size_t block = (size_t)it->block;
    const size_t all = most + block + (size_t)p->n_locked;
    it->v = mt_arena_f64(it->mem, (size_t)p->n, most + block);
    it->h = mt_arena_f64(it->mem, most, most);
    it->b = mt_arena_f64(it->mem, most, block);
    it->q = mt_arena_f64(it->mem, most, most);
    it->theta = mt_arena_f64(it->mem, most, 1);
    it->coefficient = mt_arena_f64(it->mem, all > most * block ? all : most * block, 1);
    it->row = mt_arena_f64(it->mem, most + block, 1);
    if (p->metric != NULL) {
        it->mw = mt_arena_f64(it->mem, (size_t)p->n, 1);
        it->start = mt_arena_f64(it->mem, (size_t)p->n, block);
    }
    return mt_arena_check(it->mem, err);
}

/* True every few columns, where the Ritz pairs are examined. */
static bool is_time(const iteration *it, int before)
{
    const int over = it->j - it->p->wanted;
    return over >= 0 &&
           (before < it->p->wanted || over / STEP > (before - it->p->wanted) / STEP);
}

static mt_status iterate_lanczos(iteration *it, int *found, mt_err *err)
{
    const mt_lanczos *const p = it->p;
    int restarts = 0;
    if (it->most > 0) {
        MT_TRY(fresh(it, 0, it->block, err));
    }
    if (it->width == 0) {
        return MT_OK;
    }
    while (it->width > 0 && *found < p->wanted && restarts <= MOST_RESTARTS) {
        const int before = it->j;
        MT_TRY(extend(it, err));
        const bool full = it->j + it->width > it->most;
        if (it->width > 0 && !full && !is_time(it, before)) {
            continue;
        }
        MT_TRY(ritz(it, err));
        *found = count_found(it);
        if (it->width > 0 && full && *found < p->wanted) {
            restart(it, p->wanted + ((it->most - p->wanted) / 2));
            restarts++;
        }
    }
    if (it->width > 0 && *found < p->wanted) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "Lanczos' method found %d of %d eigenvalues",
                       *found, p->wanted);
    }
    const double none = ROUNDING * DBL_EPSILON * it->theta[it->j - 1];
    while (*found > 0 && !(it->theta[it->j - *found] > none)) {
        --*found;
    }
    rotate_basis(it, *found);
    return MT_OK;
}

mt_status mt_lanczos_largest(const mt_lanczos *problem, mt_arena *mem, double *x, int *found,
                             mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    iteration it = {.p = problem, .mem = mem};
    *found = 0;
    MT_TRY(init_iteration(&it, err));
    MT_TRY(iterate_lanczos(&it, found, err));
    memcpy(x, it.v, (size_t)problem->n * (size_t)*found * sizeof *x);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}
