/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products and norms. BLAS refuses leading dimensions below one, hence `ld`. */
#include "linalg/kernels.h"

#include <cblas.h>

#include <math.h>

static int ld(int rows)
{
    return rows > 1 ? rows : 1;
}

static enum CBLAS_TRANSPOSE op(bool trans)
{
    return trans ? CblasTrans : CblasNoTrans;
}

/* NOLINTNEXTLINE(readability-function-size): the argument list is BLAS's */
void mt_gemm(bool trans_a, bool trans_b, int m, int n, int k, double alpha, const double *a,
             int lda, const double *b, int ldb, double beta, double *c, int ldc)
{
    if (m > 0 && n > 0) {
        cblas_dgemm(CblasColMajor, op(trans_a), op(trans_b), m, n, k, alpha, a, ld(lda), b,
                    ld(ldb), beta, c, ld(ldc));
    }
}

/* NOLINTNEXTLINE(readability-function-size): the argument list is BLAS's */
void mt_gemv(bool trans, int m, int n, double alpha, const double *a, int lda, const double *x,
             double beta, double *y)
{
    /* an empty sum must still scale y, and BLAS returns early there */
    const int rows = trans ? n : m;
    const int terms = trans ? m : n;
    if (terms > 0 && rows > 0) {
        cblas_dgemv(CblasColMajor, op(trans), m, n, alpha, a, ld(lda), x, 1, beta, y, 1);
        return;
    }
    for (int i = 0; i < rows; i++) {
        y[i] = beta == 0.0 ? 0.0 : beta * y[i];
    }
}

void mt_symm(int n, int nrhs, const double *a, const double *b, double *c)
{
    if (n > 0 && nrhs > 0) {
        cblas_dsymm(CblasColMajor, CblasLeft, CblasLower, n, nrhs, 1.0, a, n, b, n, 0.0, c, n);
    }
}

double mt_dot(int n, const double *x, const double *y)
{
    return cblas_ddot(n, x, 1, y, 1);
}

double mt_norm2(int n, const double *x)
{
    return cblas_dnrm2(n, x, 1);
}

void mt_axpy(int n, double alpha, const double *x, double *y)
{
    cblas_daxpy(n, alpha, x, 1, y, 1);
}

int mt_max_index(int n, const double *x)
{
    return (int)cblas_idamax(n, x, 1);
}

double mt_max_abs(ptrdiff_t n, const double *x)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        const double v = fabs(x[i]);
        if (!(v <= most)) { /* also true for NaN, which then stays */
            most = v;
        }
        if (isnan(most)) {
            break;
        }
    }
    return most;
}

/* 0 * x is 0 for finite x and NaN otherwise, so one sum checks all entries without a branch. */
bool mt_all_finite(ptrdiff_t n, const double *x)
{
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        sum += 0.0 * x[i];
    }
    return sum == 0.0;
}

bool mt_lower_finite(int n, const double *a)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        const double *const aj = a + (ptrdiff_t)j * n;
        for (int i = j; i < n; i++) {
            sum += 0.0 * aj[i];
        }
    }
    return sum == 0.0;
}

/* NOLINTNEXTLINE(readability-function-size): as a product's */
void mt_turn_columns(ptrdiff_t n, int m, int count, const double *q, ptrdiff_t step, double *v,
                     double *row)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        for (int k = 0; k < m; k++) {
            row[k] = v[i + (n * k)];
        }
        for (int k = 0; k < count; k++) {
            v[i + (n * k)] = mt_dot(m, row, q + (step * k));
        }
    }
}

void mt_transpose(int m, int n, const double *a, double *b)
{
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            b[j + (ptrdiff_t)i * n] = a[i + (ptrdiff_t)j * m];
        }
    }
}

void mt_symmetrise_lower(int n, double *a)
{
    for (int j = 0; j < n; j++) {
        for (int i = j + 1; i < n; i++) {
            a[j + (ptrdiff_t)i * n] = a[i + (ptrdiff_t)j * n];
        }
    }
}
