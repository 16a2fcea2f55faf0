/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_KERNELS_H
#define LINALG_KERNELS_H

#include <stdbool.h>
#include <stddef.h>

/* C := alpha op(A) op(B) + beta C; op transposes where the flag says so. m x n result, inner
 * size k. */
void mt_gemm(bool trans_a, bool trans_b, int m, int n, int k, double alpha, const double *a,
             int lda, const double *b, int ldb, double beta, double *c, int ldc);
/* y := alpha op(A) x + beta y, A m x n. */
void mt_gemv(bool trans, int m, int n, double alpha, const double *a, int lda, const double *x,
             double beta, double *y);
double mt_dot(int n, const double *x, const double *y);
double mt_norm2(int n, const double *x);
void mt_axpy(int n, double alpha, const double *x, double *y);
/* Largest absolute entry; NaN if any entry is NaN. */
double mt_max_abs(ptrdiff_t n, const double *x);
/* Index of the first entry of largest magnitude; n >= 1, finite. */
int mt_max_index(int n, const double *x);
/* True where all n entries (of the lower triangle of an n x n matrix) are finite. */
bool mt_all_finite(ptrdiff_t n, const double *x);
bool mt_lower_finite(int n, const double *a);
/* C := A B with symmetric A (n x n, lower read), B and C n x nrhs. */
void mt_symm(int n, int nrhs, const double *a, const double *b, double *c);
/* V := V Q in place, V n x m and Q m x count, count <= m; column k of Q starts at q + k step;
 * row: work [m]. */
void mt_turn_columns(ptrdiff_t n, int m, int count, const double *q, ptrdiff_t step, double *v,
                     double *row);
/* B := A^T, A m x n, B n x m. */
void mt_transpose(int m, int n, const double *a, double *b);
/* Copy the lower triangle into the upper one. */
void mt_symmetrise_lower(int n, double *a);

#endif
