/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formulas as they are printed, on purpose without the scaling and elimination that the
 * rest of this room relies on: an oracle must not share its faults. */
#include "modetune/dynamics.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* Singular values of A M^-1/2 (of A) below this fraction of the largest belong to redundant
 * constraints. */
static const double DEPENDENT = 1e-9;
/* Singular values of [(I - A^+ A) M; A] below this fraction of the largest: accelerations not
 * determined. Masses and cosines stand side by side, so it is near rounding. */
static const double UNDETERMINED = 1e-13;

/* root = M^-1/2 = V diag(w^-1/2) V^T. */
static mt_status inverse_root(int n, const double *mass, double *root, mt_arena *mem,
                              mt_err *err)
{
    const size_t size = (size_t)n;
    double *const v = mt_arena_f64(mem, size, size);
    double *const scaled = mt_arena_f64(mem, size, size);
    double *const w = mt_arena_f64(mem, size, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(v, mass, size * size * sizeof *v);
    MT_TRY(mt_eig_sym(n, v, w, true, mem, err));
    if (!(w[0] > 0.0)) {
        return mt_fail(err, MT_E_NOT_SPD, "the mass matrix has the eigenvalue %g", w[0]);
    }
    for (int j = 0; j < n; j++) {
        const double s = 1.0 / sqrt(w[j]);
        for (int i = 0; i < n; i++) {
            scaled[i + ((ptrdiff_t)j * n)] = s * v[i + ((ptrdiff_t)j * n)];
        }
    }
    mt_gemm(false, true, n, n, n, 1.0, scaled, n, v, n, 0.0, root, n);
    return MT_OK;
}

typedef struct problem {
    int n;
    int m;
    const double *mass;
    const double *q;
    const double *a;
    const double *b;
} problem;

static mt_status check_arguments(const char *function, const problem *p, const double *xdd,
                                 mt_err *err)
{
    if (p->n < 1 || p->m < 0) {
        return mt_fail(err, MT_E_USAGE, "%s: %d coordinates, %d constraints", function, p->n,
                       p->m);
    }
    MT_TRY(mt_check_argument(p->mass, function, "mass", err));
    MT_TRY(mt_check_argument(p->q, function, "q", err));
    if (p->m > 0) {
        MT_TRY(mt_check_argument(p->a, function, "a", err));
        MT_TRY(mt_check_argument(p->b, function, "b", err));
    }
    return mt_check_argument(xdd, function, "xdd", err);
}

static mt_status kalaba(const problem *p, double *xdd, mt_arena *mem, mt_err *err)
{
    const int n = p->n;
    const int m = p->m;
    double *const root = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const ar = mt_arena_f64(mem, (size_t)m, (size_t)n);
    double *const pinv = mt_arena_f64(mem, (size_t)n, (size_t)m);
    double *const work = mt_arena_f64(mem, (size_t)n, 1);
    double *const miss = mt_arena_f64(mem, (size_t)m, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(inverse_root(n, p->mass, root, mem, err));
    mt_gemv(false, n, n, 1.0, root, n, p->q, 0.0, work);
    mt_gemv(false, n, n, 1.0, root, n, work, 0.0, xdd); /* a = M^-1 Q */
    if (m > 0) {
        mt_gemm(false, false, m, n, n, 1.0, p->a, m, root, n, 0.0, ar, m);
        MT_TRY(mt_pinv(m, n, ar, DEPENDENT, pinv, NULL, mem, err));
        memcpy(miss, p->b, (size_t)m * sizeof *miss);
        mt_gemv(false, m, n, -1.0, p->a, m, xdd, 1.0, miss); /* b - A a */
        mt_gemv(false, n, m, 1.0, pinv, n, miss, 0.0, work);
        mt_gemv(false, n, n, 1.0, root, n, work, 1.0, xdd);
    }
    return mt_all_finite(n, xdd) ? MT_OK
                                 : mt_fail(err, MT_E_DOMAIN, "an acceleration is not finite");
}

static mt_status phohomsiri(const problem *p, double *xdd, mt_arena *mem, mt_err *err)
{
    const int n = p->n;
    const int m = p->m;
    const int rows = n + m;
    int rank = 0;
    double *const apinv = mt_arena_f64(mem, (size_t)n, (size_t)m);
    double *const filter = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const full = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const stack = mt_arena_f64(mem, (size_t)rows, (size_t)n);
    double *const pinv = mt_arena_f64(mem, (size_t)n, (size_t)rows);
    double *const right = mt_arena_f64(mem, (size_t)rows, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        filter[i + (i * n)] = 1.0;
    }
    if (m > 0) {
        MT_TRY(mt_pinv(m, n, p->a, DEPENDENT, apinv, NULL, mem, err));
        mt_gemm(false, false, n, n, m, -1.0, apinv, n, p->a, m, 1.0, filter, n);
    }
    memcpy(full, p->mass, (size_t)n * (size_t)n * sizeof *full);
    mt_symmetrise_lower(n, full);
    mt_gemm(false, false, n, n, n, 1.0, filter, n, full, n, 0.0, stack, rows);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < m; i++) {
            stack[n + i + (j * rows)] = p->a[i + (j * m)];
        }
    }
    memcpy(right, p->q, (size_t)n * sizeof *right);
    if (m > 0) {
        memcpy(right + n, p->b, (size_t)m * sizeof *right);
    }
    MT_TRY(mt_pinv(rows, n, stack, UNDETERMINED, pinv, &rank, mem, err));
    if (rank < n) {
        return mt_fail(err, MT_E_SINGULAR,
                       "mass and constraints determine %d of %d accelerations", rank, n);
    }
    mt_gemv(false, n, rows, 1.0, pinv, n, right, 0.0, xdd);
    return mt_all_finite(n, xdd) ? MT_OK
                                 : mt_fail(err, MT_E_DOMAIN, "an acceleration is not finite");
}

mt_status mt_udwadia_kalaba(int n, int m, const double *mass, const double *q, const double *a,
                            const double *b, double *xdd, mt_err *err)
{
    const problem p = {n, m, mass, q, a, b};
    mt_arena mem = {0};
    MT_TRY(check_arguments(__func__, &p, xdd, err));
    mt_status rc = mt_arena_init(&mem, 0, err);
    if (rc == MT_OK) {
        rc = kalaba(&p, xdd, &mem, err);
    }
    mt_arena_free(&mem);
    return rc;
}

mt_status mt_udwadia_phohomsiri(int n, int m, const double *mass, const double *q,
                                const double *a, const double *b, double *xdd, mt_err *err)
{
    const problem p = {n, m, mass, q, a, b};
    mt_arena mem = {0};
    MT_TRY(check_arguments(__func__, &p, xdd, err));
    mt_status rc = mt_arena_init(&mem, 0, err);
    if (rc == MT_OK) {
        rc = phohomsiri(&p, xdd, &mem, err);
    }
    mt_arena_free(&mem);
    return rc;
}
