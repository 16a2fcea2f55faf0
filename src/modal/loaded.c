/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A load on top of the springs: K = B^T diag(c) B + G, G the part that is no sum of squares.
 * Summed into one matrix, G and the soft springs drown in eps times the stiffest spring.
 * Instead, with the modes Y of the springs alone from the factor (Y^T M Y = I, Y^T B^T diag(c)
 * B Y = D, the entries of D good to a relative error each, null directions first),
 *     H = Y^T K Y = D + W,   W = Y^T G Y:
 * W is as large as the loads are, whatever the springs, and H is graded: it is S A S with
 * S = diag(H)^1/2 and A well conditioned, since |w_ij| is small beside sqrt(h_ii h_jj) wherever
 * D dominates. For a positive definite matrix of that kind a Cholesky factor and one-sided
 * Jacobi on it give every eigenvalue to a relative n eps cond(A) (Demmel and Veselic, SIAM J.
 * Matrix Anal. Appl. 13 (1992) 1204-1245): H = F^T F, F = R S, A = R^T R, eigenvalues
 * sigma(F)^2.
 *
 * Where H is not positive definite (something is free, or topples), or A is nearly singular,
 * the same is done with H + tau, tau = 2 ||W||: then A is as good as diagonal, and tau, no
 * larger than the loads, takes no more than n eps tau from any eigenvalue.
 */
#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Pivots of A (unit diagonal) below this: its condition would cost more digits than the
 * shift. */
static const double LEAST_PIVOT = 1e-6;

typedef struct loaded {
    int n;
    double *h; /* n x n: H, lower */
    double *s; /* [n] */
    double *f; /* n x n: R S */
    double *sigma;
    double *v;   /* n x n */
    double size; /* ||W||: greatest sum of |w_ij| over a row, which no eigenvalue exceeds */
    double tau;
    double pivot; /* least of A */
} loaded;

static mt_status claim_loaded(loaded *l, mt_arena *scratch, mt_err *err)
{
    const size_t n = (size_t)l->n;
    l->h = mt_arena_f64(scratch, n, n);
    l->s = mt_arena_f64(scratch, n, 1);
    l->f = mt_arena_f64(scratch, n, n);
    l->sigma = mt_arena_f64(scratch, n, 1);
    l->v = mt_arena_f64(scratch, n, n);
    return mt_arena_check(scratch, err);
}

/* h := W + D; f is work. */
static mt_status project_load_stiffness(const double *g, const mt_modes *modes, loaded *l,
                                        mt_err *err)
{
    const int n = l->n;
    if (!mt_lower_finite(n, g)) {
        return mt_fail(err, MT_E_DOMAIN, "stiffness of the loads: an entry is not finite");
    }
    mt_symm(n, n, g, modes->y, l->f);
    mt_gemm(true, false, n, n, n, 1.0, modes->y, n, l->f, n, 0.0, l->h, n);
    for (int j = 0; j < n; j++) {
        double sum = 0.0;
        for (int i = 0; i < n; i++) {
            sum += fabs(l->h[i + (ptrdiff_t)j * n]);
        }
        l->size = fmax(l->size, sum);
    }
    for (int j = 0; j < n; j++) {
        l->h[j + (ptrdiff_t)j * n] += modes->lambda[j];
    }
    return MT_OK;
}

/* f := R S of H + tau. False where that is not positive definite, or nearly so. */
static bool square_root(loaded *l)
{
    const ptrdiff_t n = l->n;
    for (ptrdiff_t j = 0; j < n; j++) {
        const double diagonal = l->h[j + j * n] + l->tau;
        if (!(diagonal > 0.0)) {
            return false;
        }
        l->s[j] = sqrt(diagonal);
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        l->v[j + j * n] = 1.0;
        for (ptrdiff_t i = j + 1; i < n; i++) {
            l->v[i + j * n] = l->h[i + j * n] / l->s[i] / l->s[j];
        }
    }
    if (mt_cholesky(l->n, l->v, NULL, NULL) != MT_OK) {
        return false;
    }
    l->pivot = 1.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        l->pivot = fmin(l->pivot, l->v[j + j * n] * l->v[j + j * n]);
        for (ptrdiff_t i = 0; i < n; i++) {
            l->f[i + j * n] = i <= j ? l->v[j + i * n] * l->s[j] : 0.0;
        }
    }
    return l->pivot >= LEAST_PIVOT;
}

mt_status mt_modal_add_load(const double *g, const mt_mass_factor *mass, mt_arena *scratch,
                            mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    const double tolerance = mt_modal_tolerance(n);
    loaded l = {.n = n};
    MT_TRY(claim_loaded(&l, scratch, err));
    MT_TRY(project_load_stiffness(g, out, &l, err));
    if (l.size == 0.0) {
        return MT_OK;
    }
    if (!square_root(&l)) {
        l.tau = 2.0 * l.size;
        if (!square_root(&l)) {
            return mt_fail(err, MT_E_NO_CONVERGENCE, "the modes under load were not found");
        }
    }
    MT_TRY(mt_svd_jacobi(n, n, l.f, l.sigma, l.v, scratch, err));
    for (int i = 0; i < n; i++) {
        const double sigma = l.sigma[n - 1 - i];
        out->lambda[i] = sigma * sigma - l.tau;
        for (int k = 0; k < n; k++) {
            l.h[k + (ptrdiff_t)i * n] = l.v[k + (ptrdiff_t)(n - 1 - i) * n];
        }
    }
    mt_gemm(false, false, n, n, n, 1.0, out->y, n, l.h, n, 0.0, l.f, n);
    memcpy(out->y, l.f, (size_t)n * (size_t)n * sizeof *l.f);
    out->error_bound = tolerance * (l.size + l.tau);
    out->error_relative += tolerance / l.pivot;
    return MT_OK;
}
