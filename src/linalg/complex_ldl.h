/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_COMPLEX_LDL_H
#define LINALG_COMPLEX_LDL_H

#include "base/arena.h"
#include "linalg/complex.h"

/* A = L D L^T of a complex symmetric matrix (not Hermitian), in place of its lower triangle. */
typedef struct mt_complex_ldl {
    int n;
    double complex *a;       /* n x n, the caller's, overwritten */
    int *pivot;              /* LAPACK's numbering */
    double complex *inverse; /* [n] inverse pivots of order one; NULL for large n */
    bool singular;           /* a pivot is exactly 0 */
} mt_complex_ldl;

/* Factor the lower triangle of A. n^3/3 complex flops. zsytrf; own code for small n. */
mt_status mt_complex_factor(int n, double complex *a, mt_arena *mem, mt_complex_ldl *out,
                            mt_err *err);
/* X := A^-1 B in place of B, n x nrhs. The factor must not be singular. Fails as
 * mt_complex_factor. */
mt_status mt_complex_solve(const mt_complex_ldl *f, int nrhs, double complex *b, mt_err *err);
/* Norm of A before it is factored, from its lower triangle: 1-norm of |re| + |im|. */
double mt_complex_norm(int n, double complex *a);
/* Estimated reciprocal condition number of A in that norm; 0 where singular. zsycon. */
mt_status mt_complex_rcond(const mt_complex_ldl *f, double norm, double *rcond,
                           mt_arena *scratch, mt_err *err);
#endif
