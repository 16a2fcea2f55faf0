/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/solve.h"

#include "linalg/lapack_priv.h"

static mt_status singular(const char *what, lapack_int pivot, mt_err *err)
{
    return mt_fail(err, MT_E_SINGULAR, "%s: the matrix is singular at row %d", what,
                   (int)pivot);
}

static mt_status estimate_rcond(int n, const double *lu, double norm, double *rcond,
                                mt_arena *scratch, mt_err *err)
{
    double *const work = mt_arena_f64(scratch, 4, (size_t)n);
    lapack_int *const iwork = mt_arena_alloc(scratch, (size_t)n, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info =
        LAPACKE_dgecon_work(LAPACK_COL_MAJOR, '1', n, lu, n, norm, rcond, work, iwork);
    return info < 0 ? mt_lapack_bug("dgecon", info, err) : MT_OK;
}

static mt_status lu_solve(int n, double *a, int nrhs, double *b, double *rcond,
                          mt_arena *scratch, mt_err *err)
{
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    double *const unused = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    const double norm =
        rcond == NULL ? 0.0 : LAPACKE_dlange_work(LAPACK_COL_MAJOR, '1', n, n, a, n, unused);
    lapack_int info = LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, a, n, ipiv);
    if (info < 0) {
        return mt_lapack_bug("dgetrf", info, err);
    }
    if (info > 0) {
        return singular("LU", info, err);
    }
    if (rcond != NULL) {
        MT_TRY(estimate_rcond(n, a, norm, rcond, scratch, err));
    }
    info =
        nrhs == 0 ? 0 : LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, 'N', n, nrhs, a, n, ipiv, b, n);
    return info < 0 ? mt_lapack_bug("dgetrs", info, err) : MT_OK;
}

mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch,
                      mt_err *err)
{
    if (rcond != NULL) {
        *rcond = n == 0 ? 1.0 : 0.0;
    }
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a) || !mt_all_finite((ptrdiff_t)n * nrhs, b)) {
        return mt_lapack_not_finite("dgetrf", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = lu_solve(n, a, nrhs, b, rcond, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err)
{
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info = LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, a, n, ipiv);
    if (info < 0) {
        return mt_lapack_bug("dgetrf", info, err);
    }
    *sign = info > 0 ? 0 : 1;
    for (ptrdiff_t i = 0; i < n; i++) {
        const bool swapped = ipiv[i] != i + 1;
        *sign = swapped == (a[i + (i * n)] < 0.0) ? *sign : -*sign;
    }
    return MT_OK;
}

mt_status mt_lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err)
{
    *sign = 1;
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("dgetrf", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = lu_sign(n, a, sign, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
