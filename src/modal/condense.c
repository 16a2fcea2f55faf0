/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Directions without mass. With the basis [T1 T0] of mass.c, y = T1 a + T0 b, the lower rows of
 * the eigenproblem have no inertia force,
 *     K01 a + K00 b = 0   =>   b = -K00^-1 K01 a,
 * and the upper ones become (K11 - K10 K00^-1 K01) a = lambda a, so that
 *     Y = (T1 - T0 K00^-1 K01) Q.
 * K00 may be indefinite, so its eigenvalues decide. Its rows are scaled by
 * h_j = (|t_j|^T |K| |t_j|)^-1/2, the size of the terms that make the diagonal: what is left
 * after cancellation is then relative to one, and at most 16 n eps of that is nothing. A
 * negative eigenvalue is an instability without inertia (the limit of one whose rate grows
 * beyond bounds): it is condensed and counted.
 */
#include "modal/modal_priv.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

typedef struct parts {
    int n;
    int r;           /* with mass */
    int z;           /* without */
    const double *t; /* n x n */
    double *kt;      /* n x n: K T, then T^T K T */
    double *h;       /* [z] */
    double *vectors; /* z x z eigenvectors of scaled K00 */
    double *values;  /* [z] */
    double *k01;     /* z x r: scaled K01, then b for unit a */
    double *work;    /* z x r */
} parts;

static mt_status claim_parts(parts *p, mt_arena *scratch, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t z = (size_t)p->z;
    const size_t r = (size_t)p->r;
    p->kt = mt_arena_f64(scratch, n, n);
    p->h = mt_arena_f64(scratch, z, 1);
    p->vectors = mt_arena_f64(scratch, z, z);
    p->values = mt_arena_f64(scratch, z, 1);
    p->k01 = mt_arena_f64(scratch, z, r);
    p->work = mt_arena_f64(scratch, z, r);
    return mt_arena_check(scratch, err);
}

/* |t|^T |K| |t|, K lower. */
static double stiffness_terms(int n, const double *k, const double *t)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            const double term = fabs(t[i] * k[i + (ptrdiff_t)j * n] * t[j]);
            sum += i == j ? term : 2.0 * term;
        }
    }
    return sum;
}

static mt_status no_stiffness(const parts *p, int mode, mt_modes *out, mt_err *err)
{
    const int n = p->n;
    memset(out->massless, 0, (size_t)n * sizeof *out->massless);
    int at = 0;
    for (int j = 0; j < p->z; j++) {
        const double h = p->h[j] > 0.0 ? p->h[j] : 1.0;
        const double part = h * p->vectors[j + (ptrdiff_t)mode * p->z];
        mt_axpy(n, part, p->t + (ptrdiff_t)(p->r + j) * n, out->massless);
    }
    for (int i = 0; i < n; i++) {
        at = fabs(out->massless[i]) > fabs(out->massless[at]) ? i : at;
    }
    const double most = out->massless[at];
    for (int i = 0; i < n && most != 0.0; i++) {
        out->massless[i] /= most;
    }
    return mt_fail(err, MT_E_MASSLESS,
                   "a direction (mostly coordinate %d) has neither mass nor stiffness", at + 1);
}

/* Eigenvalues of the scaled K00; fails where one is nothing. */
static mt_status factor_k00(const parts *p, mt_arena *scratch, mt_modes *out, mt_err *err)
{
    const int n = p->n;
    for (int j = 0; j < p->z; j++) {
        for (int i = j; i < p->z; i++) {
            const double kij = p->kt[p->r + i + (ptrdiff_t)(p->r + j) * n];
            p->vectors[i + (ptrdiff_t)j * p->z] = p->h[i] * kij * p->h[j];
        }
    }
    MT_TRY(mt_eig_sym(p->z, p->vectors, p->values, true, scratch, err));
    for (int j = 0; j < p->z; j++) {
        if (fabs(p->values[j]) <= mt_modal_tolerance(n)) {
            return no_stiffness(p, j, out, err);
        }
        out->n_unstable_condensed += p->values[j] < 0.0 ? 1 : 0;
    }
    return MT_OK;
}

/* k01 := -K00^-1 K01 = -H V diag(1/values) V^T H K01. */
static void solve_k00(const parts *p)
{
    const int z = p->z;
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->k01[i + (ptrdiff_t)j * z] = p->h[i] * p->kt[p->r + i + (ptrdiff_t)j * p->n];
        }
    }
    mt_gemm(true, false, z, p->r, z, -1.0, p->vectors, z, p->k01, z, 0.0, p->work, z);
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->work[i + (ptrdiff_t)j * z] /= p->values[i];
        }
    }
    mt_gemm(false, false, z, p->r, z, 1.0, p->vectors, z, p->work, z, 0.0, p->k01, z);
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->k01[i + (ptrdiff_t)j * z] *= p->h[i];
        }
    }
}

mt_status mt_modal_condense(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                            double *a, double *t1, mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    parts p = {.n = n, .r = mass->rank, .z = n - mass->rank, .t = mass->t};
    MT_TRY(claim_parts(&p, scratch, err));
    const double *const t0 = p.t + (ptrdiff_t)p.r * n;
    for (int j = 0; j < p.z; j++) {
        const double terms = stiffness_terms(n, k, t0 + (ptrdiff_t)j * n);
        p.h[j] = terms > 0.0 ? 1.0 / sqrt(terms) : 0.0;
    }
    double *const kt = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    mt_symm(n, n, k, p.t, kt);
    mt_gemm(true, false, n, n, n, 1.0, p.t, n, kt, n, 0.0, p.kt, n);
    MT_TRY(factor_k00(&p, scratch, out, err));
    solve_k00(&p);
    for (int j = 0; j < p.r; j++) {
        memcpy(a + (ptrdiff_t)j * p.r, p.kt + (ptrdiff_t)j * n, (size_t)p.r * sizeof *a);
        memcpy(t1 + (ptrdiff_t)j * n, p.t + (ptrdiff_t)j * n, (size_t)n * sizeof *t1);
    }
    const double *const k10 = p.kt + (ptrdiff_t)p.r * n;
    mt_gemm(false, false, p.r, p.r, p.z, 1.0, k10, n, p.k01, p.z, 1.0, a, p.r);
    mt_gemm(false, false, n, p.r, p.z, 1.0, t0, n, p.k01, p.z, 1.0, t1, n);
    return MT_OK;
}
