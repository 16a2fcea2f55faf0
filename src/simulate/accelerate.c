/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With A Z = 0 and a particular x_p, A x_p = b, both from one pivoted QR of A^T,
 *     x = x_p + Z y,   (Z^T M Z) y = Z^T (f - M x_p):
 * the formula's pseudo-inverses are not formed, and M need not be regular, Z^T M Z alone has to
 * be. lambda: A^T lambda = M x - f.
 */
#include "simulate/accelerate.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A direction whose mass is below this times the largest is one without mass: what rounding
 * leaves of none. */
static const double MASSLESS = 1e3 * DBL_EPSILON;
/* Such a direction is not pushed where the force along it is below this times the magnitudes
 * that cancel in it, or in another one. */
static const double UNPUSHED = 1e-9;
/* Z^T M Z = V diag(w) V^T with eigenvalues of 0: y = sum over the others of v (v . r)/w. size:
 * of the terms that r is the sum of. */
static mt_status solve_singular(int n, double *mass, double size, double *r, mt_arena *mem,
                                mt_err *err)
{
    double *const w = mt_arena_f64(mem, (size_t)n, 1);
    double *const along = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_eig_sym(n, mass, w, true, mem, err));
    mt_gemv(true, n, n, 1.0, mass, n, r, 0.0, along);
    for (int i = 0; i < n; i++) {
        const bool massless = !(w[i] > MASSLESS * w[n - 1]);
        if (massless && fabs(along[i]) > UNPUSHED * size) {
            return mt_fail(err, MT_E_SINGULAR,
                           "a direction without mass is pushed: mass and joints do not "
                           "determine its acceleration");
        }
        along[i] = massless ? 0.0 : along[i] / w[i];
    }
    mt_gemv(false, n, n, 1.0, mass, n, along, 0.0, r);
    return MT_OK;
}

/* r := (Z^T M Z)^-1 r. */
static mt_status solve_reduced(int n, double *mass, double size, double *r, mt_arena *mem,
                               mt_err *err)
{
    double *const l = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    double least = 1.0;
    memcpy(l, mass, (size_t)n * (size_t)n * sizeof *l);
    const mt_status rc = mt_cholesky(n, l, NULL, NULL);
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    for (ptrdiff_t i = 0; i < n && rc == MT_OK; i++) {
        /* what a pivot has left of its diagonal entry */
        least = fmin(least, l[i + (i * n)] * l[i + (i * n)] / mass[i + (i * n)]);
    }
    if (rc != MT_OK || !(least > MASSLESS)) {
        return solve_singular(n, mass, size, r, mem, err);
    }
    mt_tri_solve(false, n, 1, l, r, n);
    mt_tri_solve(true, n, 1, l, r, n);
    return MT_OK;
}

/* Largest sum of magnitudes of the terms of Z^T f. */
static double size_of_terms(const mt_elimination *e, const double *f)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < e->n; i++) {
        double sum = 0.0;
        for (ptrdiff_t k = 0; k < e->nq; k++) {
            sum += fabs(e->z[k + (i * e->nq)] * f[k]);
        }
        most = fmax(most, sum);
    }
    return most;
}

static mt_status solve_accelerations(const mt_system *sys, const mt_gauss *g, double *x,
                                     double *lambda, int *rank, mt_arena *mem, mt_err *err)
{
    const int nq = sys->nq;
    mt_elimination e;
    MT_TRY(mt_eliminate(sys, g->m, g->a, mem, &e, err));
    double *const mz = mt_arena_f64(mem, (size_t)nq, (size_t)e.n);
    double *const mass = mt_arena_f64(mem, (size_t)e.n, (size_t)e.n);
    double *const left = mt_arena_f64(mem, (size_t)nq, 1);
    double *const y = mt_arena_f64(mem, (size_t)e.n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_eliminate_particular(&e, g->b, x, mem, err));
    memcpy(left, g->force, (size_t)nq * sizeof *left);
    mt_gemv(false, nq, nq, -1.0, g->mass, nq, x, 1.0, left);
    if (e.n > 0) {
        mt_gemm(false, false, nq, e.n, nq, 1.0, g->mass, nq, e.z, nq, 0.0, mz, nq);
        mt_gemm(true, false, e.n, e.n, nq, 1.0, e.z, nq, mz, nq, 0.0, mass, e.n);
        mt_eliminate_project(&e, left, y);
        MT_TRY(solve_reduced(e.n, mass, size_of_terms(&e, left), y, mem, err));
        mt_eliminate_expand(&e, y, left);
        mt_axpy(nq, 1.0, left, x);
    }
    if (rank != NULL) {
        *rank = e.qr.rank;
    }
    if (lambda != NULL && g->m > 0) {
        memcpy(left, g->force, (size_t)nq * sizeof *left);
        mt_gemv(false, nq, nq, 1.0, g->mass, nq, x, -1.0, left);
        MT_TRY(mt_eliminate_multipliers(&e, left, lambda, mem, err));
    }
    return mt_all_finite(nq, x) ? MT_OK
                                : mt_fail(err, MT_E_DOMAIN, "an acceleration is not finite");
}

mt_status mt_gauss_solve(const mt_system *sys, const mt_gauss *g, double *x, double *lambda,
                         int *rank, mt_arena *mem, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = solve_accelerations(sys, g, x, lambda, rank, mem, err);
    mt_arena_rewind(mem, mark);
    return rc;
}
