/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/svd.h"

#include "linalg/lapack_priv.h"

#include <string.h>

typedef struct svd_job {
    int m;
    int n;
    int r; /* min(m, n) */
    bool vectors;
    double *a;
    double *s;
    double *u;  /* m x r, where vectors */
    double *vt; /* r x n, where vectors */
} svd_job;

static lapack_int gesdd(const svd_job *j, double *work, lapack_int lwork, lapack_int *iwork)
{
    return LAPACKE_dgesdd_work(LAPACK_COL_MAJOR, j->vectors ? 'S' : 'N', j->m, j->n, j->a, j->m,
                               j->s, j->u, j->m, j->vt, j->r, work, lwork, iwork);
}

static lapack_int gesvd(const svd_job *j, double *work, lapack_int lwork)
{
    const char job = j->vectors ? 'S' : 'N';
    return LAPACKE_dgesvd_work(LAPACK_COL_MAJOR, job, job, j->m, j->n, j->a, j->m, j->s, j->u,
                               j->m, j->vt, j->r, work, lwork);
}

/* One work array that serves both routines. */
static mt_status svd_work(const svd_job *j, mt_arena *scratch, double **work, lapack_int *lwork,
                          mt_err *err)
{
    double query[2] = {0.0, 0.0};
    lapack_int none = 0;
    const lapack_int info = gesdd(j, &query[0], -1, &none);
    const lapack_int info2 = gesvd(j, &query[1], -1);
    if (info != 0 || info2 != 0) {
        return mt_lapack_bug(info != 0 ? "dgesdd" : "dgesvd", info != 0 ? info : info2, err);
    }
    /* documented minima: dgesdd 4 r^2 + 7 r ('S') or 3 r + max(m, n, 7 r) ('N'), dgesvd max(3 r
     * + max(m, n), 5 r) */
    const double r = j->r;
    const double most = j->m > j->n ? j->m : j->n;
    const double least = 4.0 * r * r + 10.0 * r + most;
    return mt_lapack_work(scratch, query[0] > query[1] ? query[0] : query[1], least, work,
                          lwork, err);
}

static mt_status svd(svd_job *j, mt_arena *scratch, mt_err *err)
{
    const size_t m = (size_t)j->m;
    const size_t n = (size_t)j->n;
    const size_t r = (size_t)j->r;
    if (j->vectors && j->u == NULL) {
        j->u = mt_arena_f64(scratch, m, r);
    }
    if (j->vectors && j->vt == NULL) {
        j->vt = mt_arena_f64(scratch, r, n);
    }
    /* dgesdd destroys A even where it fails */
    double *const copy = mt_arena_f64(scratch, m, n);
    lapack_int *const iwork = mt_arena_alloc(scratch, 8 * r, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    memcpy(copy, j->a, m * n * sizeof *copy);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(svd_work(j, scratch, &work, &lwork, err));
    lapack_int info = gesdd(j, work, lwork, iwork);
    if (info > 0) {
        memcpy(j->a, copy, m * n * sizeof *copy);
        info = gesvd(j, work, lwork);
    }
    if (info < 0) {
        return mt_lapack_bug("dgesdd/dgesvd", info, err);
    }
    if (info > 0 || !mt_all_finite(j->r, j->s)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "the singular values did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_svd(int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch,
                 mt_err *err)
{
    svd_job j = {.m = m, .n = n, .r = m < n ? m : n, .a = a, .s = s, .u = u, .vt = vt};
    j.vectors = u != NULL || vt != NULL;
    if (j.r == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)m * n, a)) {
        return mt_lapack_not_finite("dgesdd", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = svd(&j, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* dgejsv: A as D1 C D2 with row pivoting ('F'), no left vectors ('N'), right ones ('V'), tiny
 * columns kept ('N'), no transposition ('N'), no perturbation ('N'). */
static mt_status jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err)
{
    enum { BLOCK = 64 }; /* room for the blocked QR inside; dgejsv has no workspace query */
    const double order = n;
    const double least = 2.0 * m + 2.0 * order * order + (6.0 + BLOCK) * order + 7.0;
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, 0.0, least, &work, &lwork, err));
    lapack_int *const iwork =
        mt_arena_alloc(scratch, (size_t)m + 3 * (size_t)n + 1, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    double none = 0.0;
    const lapack_int info =
        LAPACKE_dgejsv_work(LAPACK_COL_MAJOR, 'F', 'N', v == NULL ? 'N' : 'V', 'N', 'N', 'N', m,
                            n, a, m, s, &none, m, v == NULL ? &none : v, n, work, lwork, iwork);
    if (info < 0) {
        return mt_lapack_bug("dgejsv", info, err);
    }
    /* guards over- and underflow: values are scale * s */
    const double scale = work[0] / work[1];
    for (int i = 0; i < n; i++) {
        s[i] *= scale;
    }
    if (info > 0 || !mt_all_finite(n, s)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE,
                       "dgejsv: the singular values did not converge");
    }
    return MT_OK;
}

mt_status mt_svd_jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (m < n) {
        return mt_fail(err, MT_E_INTERNAL, "mt_svd_jacobi: %d rows for %d columns", m, n);
    }
    if (!mt_all_finite((ptrdiff_t)m * n, a)) {
        return mt_lapack_not_finite("dgejsv", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = jacobi(m, n, a, s, v, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status pinv_of(int m, int n, const double *a, double tol, double *pinv, int *rank,
                         mt_arena *scratch, mt_err *err)
{
    const int r = m < n ? m : n;
    double *const copy = mt_arena_f64(scratch, (size_t)m, (size_t)n);
    double *const s = mt_arena_f64(scratch, (size_t)r, 1);
    double *const u = mt_arena_f64(scratch, (size_t)m, (size_t)r);
    double *const vt = mt_arena_f64(scratch, (size_t)r, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    memcpy(copy, a, (size_t)m * (size_t)n * sizeof *copy);
    MT_TRY(mt_svd(m, n, copy, s, u, vt, scratch, err));
    int kept = 0;
    while (kept < r && s[kept] > tol * s[0]) {
        for (int i = 0; i < m; i++) {
            u[i + (ptrdiff_t)kept * m] /= s[kept];
        }
        kept++;
    }
    mt_gemm(true, true, n, m, kept, 1.0, vt, r, u, m, 0.0, pinv, n);
    *rank = kept;
    return MT_OK;
}

mt_status mt_pinv(int m, int n, const double *a, double tol, double *pinv, int *rank,
                  mt_arena *scratch, mt_err *err)
{
    int kept = 0;
    mt_status rc = MT_OK;
    if (m > 0 && n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(scratch);
        rc = pinv_of(m, n, a, tol, pinv, &kept, scratch, err);
        mt_arena_rewind(scratch, mark);
    }
    if (rank != NULL) {
        *rank = kept;
    }
    return rc;
}
