/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Lee and Jung's bordered system for one eigenvector. Scaled first, so that neither units nor
 * stiffness decide how regular it is: with D = diag(m_ii)^-1/2 (a coordinate without mass takes
 * |k_ii|/s), s the largest k_ii/m_ii or |lambda|, g = D M y, f = (Kdot - lambda Mdot) y,
 *     [D (K - lambda M) D / s   -g] [D^-1 ydot    ]   [-D f / s       ]
 *     [-g^T                      0] [lambdadot / s] = [1/2 y^T Mdot y ]
 * has a reciprocal condition of about (gap to the next eigenvalue) / s. Below 16 n eps that gap
 * is rounding: the mode is repeated.
 */
#include "modal/derivative.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/mass.h"
#include "modal/modes.h"

typedef struct bordered {
    int n;
    double lambda;
    const double *y;
    double s;
    double *d;   /* [n] */
    double *my;  /* [n] M y */
    double *a;   /* (n + 1)^2 */
    double *rhs; /* (n + 1) x np */
} bordered;

static void choose_scales(const mt_pencil *p, bordered *b)
{
    double s = 0.0;
    for (int i = 0; i < p->n; i++) {
        const ptrdiff_t ii = i + (ptrdiff_t)i * p->n;
        s = p->m[ii] > 0.0 ? fmax(s, fabs(p->k[ii]) / p->m[ii]) : s;
    }
    s = fmax(s, fabs(b->lambda));
    b->s = s > 0.0 ? s : 1.0;
    for (int i = 0; i < p->n; i++) {
        const ptrdiff_t ii = i + (ptrdiff_t)i * p->n;
        const double mass = p->m[ii] > 0.0 ? p->m[ii] : fabs(p->k[ii]) / b->s;
        b->d[i] = mass > 0.0 ? 1.0 / sqrt(mass) : 1.0;
    }
}

static void fill_matrix(const mt_pencil *p, const bordered *b)
{
    const int n = p->n;
    const int ld = n + 1;
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            const ptrdiff_t ij = i + (ptrdiff_t)j * n;
            const double e = p->k[ij] - b->lambda * p->m[ij];
            b->a[i + (ptrdiff_t)j * ld] = b->d[i] * e * b->d[j] / b->s;
        }
        b->a[n + (ptrdiff_t)j * ld] = -b->d[j] * b->my[j];
    }
    b->a[n + (ptrdiff_t)n * ld] = 0.0;
    mt_symmetrise_lower(ld, b->a);
}

static void fill_rhs(const bordered *b, const mt_directions *dir)
{
    const int n = b->n;
    for (int p = 0; p < dir->np; p++) {
        double *const r = b->rhs + (ptrdiff_t)p * (n + 1);
        const double *const dky = dir->dky + (ptrdiff_t)p * n;
        const double *const dmy = dir->dmy == NULL ? NULL : dir->dmy + (ptrdiff_t)p * n;
        for (int i = 0; i < n; i++) {
            const double f = dky[i] - (dmy == NULL ? 0.0 : b->lambda * dmy[i]);
            r[i] = -b->d[i] * f / b->s;
        }
        r[n] = dmy == NULL ? 0.0 : 0.5 * mt_dot(n, b->y, dmy);
    }
}

static mt_status solve_bordered_system(const mt_pencil *p, bordered *b,
                                       const mt_directions *dir, mt_arena *scratch, mt_err *err)
{
    const size_t n = (size_t)p->n;
    b->d = mt_arena_f64(scratch, n, 1);
    b->my = mt_arena_f64(scratch, n, 1);
    b->a = mt_arena_f64(scratch, n + 1, n + 1);
    b->rhs = mt_arena_f64(scratch, n + 1, (size_t)dir->np);
    MT_TRY(mt_arena_check(scratch, err));
    choose_scales(p, b);
    mt_symm(p->n, 1, p->m, b->y, b->my);
    fill_matrix(p, b);
    fill_rhs(b, dir);
    double rcond = 0.0;
    const mt_status rc = mt_lu_solve(p->n + 1, b->a, dir->np, b->rhs, &rcond, scratch, err);
    if (rc != MT_OK && rc != MT_E_SINGULAR) {
        return rc;
    }
    if (rc == MT_E_SINGULAR || !(rcond > mt_modal_tolerance(p->n))) {
        return mt_fail(err, MT_E_SINGULAR, "a repeated mode has no derivative of its own");
    }
    return MT_OK;
}

mt_status mt_modal_dvector(const mt_pencil *p, double lambda, const double *y,
                           const mt_directions *dir, double *dy, double *dlambda,
                           mt_arena *scratch, mt_err *err)
{
    bordered b = {.n = p->n, .lambda = lambda, .y = y};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = solve_bordered_system(p, &b, dir, scratch, err);
    for (int k = 0; k < dir->np; k++) {
        const ptrdiff_t at = (ptrdiff_t)k * (p->n + 1);
        for (int i = 0; i < p->n; i++) {
            dy[i + (ptrdiff_t)k * p->n] = rc == MT_OK ? b.d[i] * b.rhs[at + i] : nan("");
        }
        if (dlambda != NULL) {
            dlambda[k] = rc == MT_OK ? b.s * b.rhs[at + p->n] : nan("");
        }
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}

/*
 * Differentiate K y = lambda M y and y^T M y = 1 along a parameter (a dot is d/dp), with
 * f = (Kdot - lambda Mdot) y:
 *     (K - lambda M) ydot - lambdadot M y = -f,
 *     y^T M ydot = -1/2 y^T Mdot y.
 * From the left with y^T:                   lambdadot = y^T f.
 * From the left with another mode's y_j^T:  y_j^T M ydot = y_j^T f / (lambda - lambda_j).
 */

/* f := dky - lambda dmy, entries count. */
static void mode_derivative_force(ptrdiff_t count, double lambda, const double *dky,
                                  const double *dmy, double *f)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        f[i] = dky[i] - (dmy == NULL ? 0.0 : lambda * dmy[i]);
    }
}

static void fill_nan(ptrdiff_t count, double *x)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        x[i] = nan("");
    }
}

mt_status mt_modal_dcluster(const mt_modes *modes, int first, int r, const double *dky,
                            const double *dmy, double *out, mt_arena *scratch, mt_err *err)
{
    const int n = modes->n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)n, (size_t)r);
    MT_TRY(mt_arena_check(scratch, err));
    double mean = 0.0;
    for (int i = 0; i < r; i++) {
        mean += modes->lambda[first + i] / r;
    }
    mode_derivative_force((ptrdiff_t)n * r, mean, dky, dmy, f);
    mt_gemm(true, false, r, r, n, 1.0, modes->y + (ptrdiff_t)first * n, n, f, n, 0.0, out, r);
    for (int j = 0; j < r; j++) {
        for (int i = j + 1; i < r; i++) {
            double *const lower = out + i + (ptrdiff_t)j * r;
            double *const upper = out + j + (ptrdiff_t)i * r;
            *lower = 0.5 * (*lower + *upper);
            *upper = *lower;
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* dy := sum over modes j of y_j a_j; a (count x np) comes in as Y^T f. */
static void combine(const mt_modes *modes, int i, const mt_directions *dir, double *a,
                    double *dy, double *dlambda)
{
    const int r = modes->count;
    for (int p = 0; p < dir->np; p++) {
        double *const ap = a + (ptrdiff_t)p * r;
        if (dlambda != NULL) {
            dlambda[p] = ap[i];
        }
        for (int j = 0; j < r; j++) {
            ap[j] /= j == i ? 1.0 : modes->lambda[i] - modes->lambda[j];
        }
        const double *const dmy = dir->dmy == NULL ? NULL : dir->dmy + (ptrdiff_t)p * modes->n;
        const double *const y = modes->y + (ptrdiff_t)i * modes->n;
        ap[i] = dmy == NULL ? 0.0 : -0.5 * mt_dot(modes->n, y, dmy);
    }
    mt_gemm(false, false, modes->n, dir->np, r, 1.0, modes->y, modes->n, a, r, 0.0, dy,
            modes->n);
}

static mt_status repeated_mode(ptrdiff_t entries, double *dy, int np, double *dlambda,
                               mt_err *err)
{
    fill_nan(entries, dy);
    if (dlambda != NULL) {
        fill_nan(np, dlambda);
    }
    return mt_fail(err, MT_E_SINGULAR, "a repeated mode has no derivative of its own");
}

mt_status mt_modal_dvector_by_modes(const mt_modes *modes, int i, const mt_directions *dir,
                                    double *dy, double *dlambda, mt_arena *scratch, mt_err *err)
{
    const int n = modes->n;
    if (modes->y == NULL || modes->n_condensed > 0 || modes->shaped < modes->all) {
        return mt_fail(err, MT_E_USAGE,
                       "mt_modal_dvector_by_modes: needs all modes with vectors");
    }
    const ptrdiff_t entries = (ptrdiff_t)n * dir->np;
    int size = 0;
    (void)mt_modal_cluster(modes, i, &size);
    if (size > 1) {
        return repeated_mode(entries, dy, dir->np, dlambda, err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)n, (size_t)dir->np);
    double *const a = mt_arena_f64(scratch, (size_t)n, (size_t)dir->np);
    const mt_status rc = mt_arena_check(scratch, err);
    if (rc == MT_OK) {
        mode_derivative_force(entries, modes->lambda[i], dir->dky, dir->dmy, f);
        mt_gemm(true, false, n, dir->np, n, 1.0, modes->y, n, f, n, 0.0, a, n);
        combine(modes, i, dir, a, dy, dlambda);
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* The adjoint of a cluster. */

/* The modes that are summed over. */
typedef struct cluster {
    int first;
    int size;
    double lambda;
} cluster;

/* x = sum over the modes j outside of C of y_j (y_j . b) / (lambda_j - lambda). */
static mt_status adjoint_by_modes(const mt_modes *modes, const cluster *c, const double *b,
                                  double *x, mt_arena *scratch, mt_err *err)
{
    const int n = modes->n;
    double *const part = mt_arena_f64(scratch, (size_t)modes->all, 1);
    MT_TRY(mt_arena_check(scratch, err));
    mt_gemv(true, n, modes->all, 1.0, modes->y, n, b, 0.0, part);
    for (int j = 0; j < modes->all; j++) {
        const bool own = j >= c->first && j < c->first + c->size;
        part[j] = own ? 0.0 : part[j] / (modes->lambda[j] - c->lambda);
    }
    mt_gemv(false, n, modes->all, 1.0, modes->y, n, part, 0.0, x);
    return MT_OK;
}

/* [D (K - lambda M) D / s  -D M Y; ...] [D^-1 x; c] = [D b / s; 0]. */
static mt_status adjoint_bordered(const mt_pencil *p, const mt_modes *modes, const cluster *of,
                                  const double *b, double *x, mt_arena *scratch, mt_err *err)
{
    const int n = p->n;
    const int r = of->size;
    const double lambda = of->lambda;
    const int ld = n + r;
    const double *const y = mt_modal_shape(modes, of->first);
    bordered w = {.n = n, .lambda = lambda};
    w.d = mt_arena_f64(scratch, (size_t)n, 1);
    w.my = mt_arena_f64(scratch, (size_t)n, (size_t)r);
    w.a = mt_arena_f64(scratch, (size_t)ld, (size_t)ld);
    w.rhs = mt_arena_f64(scratch, (size_t)ld, 1);
    MT_TRY(mt_arena_check(scratch, err));
    choose_scales(p, &w);
    mt_symm(n, r, p->m, y, w.my);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            const double e = p->k[i + (j * n)] - (lambda * p->m[i + (j * n)]);
            w.a[i + (j * ld)] = w.d[i] * e * w.d[j] / w.s;
        }
        for (ptrdiff_t c = 0; c < r; c++) {
            w.a[n + c + (j * ld)] = -w.d[j] * w.my[j + (c * n)];
        }
        w.rhs[j] = w.d[j] * b[j] / w.s;
    }
    mt_symmetrise_lower(ld, w.a);
    double rcond = 0.0;
    const mt_status rc = mt_lu_solve(ld, w.a, 1, w.rhs, &rcond, scratch, err);
    if (rc == MT_E_SINGULAR || (rc == MT_OK && !(rcond > mt_modal_tolerance(n)))) {
        return mt_fail(err, MT_E_SINGULAR,
                       "another mode is as close as rounding: its share has no derivative");
    }
    MT_TRY(rc);
    for (int i = 0; i < n; i++) {
        x[i] = w.d[i] * w.rhs[i];
    }
    return MT_OK;
}

mt_status mt_modal_adjoint(const mt_pencil *p, const mt_modes *modes, int first, int r,
                           const double *b, double *x, mt_arena *scratch, mt_err *err)
{
    const bool all = modes->n_condensed == 0 && modes->shaped == modes->all;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    cluster c = {.first = first, .size = r};
    for (int i = 0; i < r; i++) {
        c.lambda += modes->lambda[first + i] / r;
    }
    const mt_status rc = all ? adjoint_by_modes(modes, &c, b, x, scratch, err)
                             : adjoint_bordered(p, modes, &c, b, x, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
