/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/qr.h"

#include "linalg/lapack_priv.h"

#include <math.h>
#include <string.h>

static int lesser_of(int m, int n)
{
    return m < n ? m : n;
}

static void decide_rank(double tol, mt_qr *f)
{
    const int r = lesser_of(f->m, f->n);
    const double first = r > 0 ? fabs(f->qr[0]) : 0.0;
    f->rank = 0;
    f->kept = 1.0;
    f->dropped = 0.0;
    for (int i = 0; i < r && first > 0.0; i++) {
        const double ratio = fabs(f->qr[i + (ptrdiff_t)i * f->m]) / first;
        if (!(ratio > tol)) {
            f->dropped = ratio;
            return;
        }
        f->kept = ratio;
        f->rank = i + 1;
    }
}

static mt_status factor_pivoted(mt_qr *f, mt_arena *scratch, mt_err *err)
{
    lapack_int *const jpvt = mt_arena_alloc(scratch, (size_t)f->n, sizeof *jpvt);
    MT_TRY(mt_arena_check(scratch, err));
    double query = 0.0;
    lapack_int info = 0;
    if (lesser_of(f->m, f->n) > MT_LAPACK_UNBLOCKED) {
        info = LAPACKE_dgeqp3_work(LAPACK_COL_MAJOR, f->m, f->n, f->qr, f->m, jpvt, f->tau,
                                   &query, -1);
    }
    if (info != 0) {
        return mt_lapack_bug("dgeqp3", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 3.0 * f->n + 1.0, &work, &lwork, err));
    info = LAPACKE_dgeqp3_work(LAPACK_COL_MAJOR, f->m, f->n, f->qr, f->m, jpvt, f->tau, work,
                               lwork);
    for (int j = 0; j < f->n; j++) {
        f->perm[j] = (int)jpvt[j] - 1;
    }
    return info != 0 ? mt_lapack_bug("dgeqp3", info, err) : MT_OK;
}

mt_status mt_qr_factor(int m, int n, const double *a, int lda, double tol, mt_arena *mem,
                       mt_qr *out, mt_err *err)
{
    *out = (mt_qr){.m = m, .n = n};
    out->perm = mt_arena_int(mem, (size_t)n);
    out->qr = mt_arena_f64(mem, (size_t)m, (size_t)n);
    out->tau = mt_arena_f64(mem, (size_t)lesser_of(m, n), 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < n; j++) {
        out->perm[j] = j;
        if (m > 0) {
            memcpy(out->qr + (ptrdiff_t)j * m, a + (ptrdiff_t)j * lda,
                   (size_t)m * sizeof *out->qr);
        }
    }
    if (!mt_all_finite((ptrdiff_t)m * n, out->qr)) {
        return mt_lapack_not_finite("dgeqp3", err);
    }
    if (m > 0 && n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_status rc = factor_pivoted(out, mem, err);
        mt_arena_rewind(mem, mark);
        if (rc != MT_OK) {
            return rc;
        }
    }
    decide_rank(tol, out);
    return MT_OK;
}

/* Up to so many columns the reflectors are applied one by one: the blocked routine first
 * multiplies them together, which costs as much as some ten columns, and wants a workspace of
 * 33 kB. */
enum { FEW_COLUMNS = 8 };

/* x := H_1 ... H_k x, or H_k ... H_1 x, with H_i = 1 - tau_i v v^T, v = (0, ..., 0, 1, below
 * the diagonal of column i). */
static void reflect(const mt_qr *f, bool trans, double *x)
{
    const int k = lesser_of(f->m, f->n);
    for (int step = 0; step < k; step++) {
        const int i = trans ? step : k - 1 - step;
        const double *const v = f->qr + ((ptrdiff_t)i * f->m);
        double s = x[i];
        for (int j = i + 1; j < f->m; j++) {
            s += v[j] * x[j];
        }
        s *= f->tau[i];
        x[i] -= s;
        for (int j = i + 1; j < f->m; j++) {
            x[j] -= s * v[j];
        }
    }
}

static mt_status apply_q(const mt_qr *f, char trans, int nrhs, double *x, mt_arena *scratch,
                         mt_err *err)
{
    const int k = lesser_of(f->m, f->n);
    double query = 0.0;
    lapack_int info = LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', trans, f->m, nrhs, k, f->qr,
                                          f->m, f->tau, x, f->m, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dormqr", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, nrhs, &work, &lwork, err));
    info = LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', trans, f->m, nrhs, k, f->qr, f->m, f->tau,
                               x, f->m, work, lwork);
    return info != 0 ? mt_lapack_bug("dormqr", info, err) : MT_OK;
}

mt_status mt_qr_apply_q(const mt_qr *f, bool trans, int nrhs, double *x, mt_arena *scratch,
                        mt_err *err)
{
    if (!mt_all_finite((ptrdiff_t)f->m * nrhs, x)) {
        return mt_lapack_not_finite("dormqr", err);
    }
    if (f->m == 0 || f->n == 0 || nrhs == 0) {
        return MT_OK;
    }
    if (nrhs <= FEW_COLUMNS) {
        for (int c = 0; c < nrhs; c++) {
            reflect(f, trans, x + ((ptrdiff_t)c * f->m));
        }
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = apply_q(f, trans ? 'T' : 'N', nrhs, x, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_qr_q(const mt_qr *f, int from, double *q, mt_arena *scratch, mt_err *err)
{
    const int columns = f->m - from;
    for (int j = 0; j < columns; j++) {
        for (int i = 0; i < f->m; i++) {
            q[i + (ptrdiff_t)j * f->m] = i == from + j ? 1.0 : 0.0;
        }
    }
    return mt_qr_apply_q(f, false, columns, q, scratch, err);
}

/* x := R11^-1 x (back substitution) or, transposed, R11^-T x (forward), with the leading rank x
 * rank block. */
static void solve_r(const mt_qr *f, bool trans, double *x)
{
    const int r = f->rank;
    for (int step = 0; step < r; step++) {
        const int i = trans ? step : r - 1 - step;
        double sum = x[i];
        for (int j = trans ? 0 : i + 1; j < (trans ? i : r); j++) {
            sum -= f->qr[trans ? j + (ptrdiff_t)i * f->m : i + (ptrdiff_t)j * f->m] * x[j];
        }
        x[i] = sum / f->qr[i + (ptrdiff_t)i * f->m];
    }
}

mt_status mt_qr_solve(const mt_qr *f, int nrhs, const double *b, double *x, mt_arena *scratch,
                      mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const size_t entries = (size_t)f->m * (size_t)nrhs;
    double *const qtb = mt_arena_f64(scratch, (size_t)f->m, (size_t)nrhs);
    mt_status rc = mt_arena_check(scratch, err);
    if (rc == MT_OK && entries > 0) {
        memcpy(qtb, b, entries * sizeof *qtb);
        rc = mt_qr_apply_q(f, true, nrhs, qtb, scratch, err);
    }
    for (int k = 0; k < nrhs && rc == MT_OK; k++) {
        double *const z = qtb + (ptrdiff_t)k * f->m;
        double *const xk = x + (ptrdiff_t)k * f->n;
        solve_r(f, false, z);
        for (int j = 0; j < f->n; j++) {
            xk[f->perm[j]] = j < f->rank ? z[j] : 0.0;
        }
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_qr_solve_transposed(const mt_qr *f, int nrhs, const double *c, double *y,
                                 mt_arena *scratch, mt_err *err)
{
    for (int k = 0; k < nrhs; k++) {
        double *const yk = y + (ptrdiff_t)k * f->m;
        for (int i = 0; i < f->m; i++) {
            yk[i] = i < f->rank ? c[f->perm[i] + (ptrdiff_t)k * f->n] : 0.0;
        }
        solve_r(f, true, yk);
    }
    return mt_qr_apply_q(f, false, nrhs, y, scratch, err);
}
