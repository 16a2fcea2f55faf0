/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/cholesky.h"

#include "linalg/lapack_priv.h"

#include <cblas.h>

#include <math.h>

mt_status mt_cholesky(int n, double *a, int *bad, mt_err *err)
{
    if (bad != NULL) {
        *bad = -1;
    }
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dpotrf", err);
    }
    const lapack_int info = LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', n, a, n);
    if (info < 0) {
        return mt_lapack_bug("dpotrf", info, err);
    }
    /* products of finite entries may overflow: every such entry reaches a later diagonal one */
    int pivot = (int)info - 1;
    for (int i = 0; i < n && pivot < 0; i++) {
        const double d = a[i + (ptrdiff_t)i * n];
        if (!(d > 0.0 && isfinite(d))) {
            pivot = i;
        }
    }
    if (pivot < 0) {
        return MT_OK;
    }
    if (bad != NULL) {
        *bad = pivot;
    }
    return mt_fail(err, MT_E_NOT_SPD, "the matrix loses positivity at row %d", pivot + 1);
}

void mt_tri_solve(bool trans, int n, int nrhs, const double *l, double *x, int ldx)
{
    if (n > 0 && nrhs > 0) {
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, trans ? CblasTrans : CblasNoTrans,
                    CblasNonUnit, n, nrhs, 1.0, l, n, x, ldx > 1 ? ldx : 1);
    }
}

void mt_congruence_inverse(int n, const double *l, double *a)
{
    if (n == 0) {
        return;
    }
    mt_symmetrise_lower(n, a);
    mt_tri_solve(false, n, n, l, a, n);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, n, n, 1.0, l,
                n, a, n);
    mt_symmetrise_lower(n, a); /* the two triangles differ by rounding */
}

void mt_tri_inverse(int n, const double *l, double *x)
{
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            x[i + (ptrdiff_t)j * n] = i == j ? 1.0 : 0.0;
        }
    }
    mt_tri_solve(false, n, n, l, x, n);
}
