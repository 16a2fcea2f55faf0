/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_EIG_H
#define LINALG_EIG_H

#include <complex.h>
#include <stdbool.h>

#include "base/arena.h"

/* All eigenvalues (ascending, w[n]) of symmetric A (lower read; destroyed; with vectors:
 * overwritten by orthonormal eigenvectors). QL up to n = 28: 4 us for n = 11 (dsyevd: 9), else
 * dsyevd; about 9 n^3 flops. |error of w| <= about n eps max|w|. Fails MT_E_NO_CONVERGENCE. */
mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err);
/* The same in two steps, for who learns from the eigenvalues how many vectors are wanted:
 * scale A = Q T Q^T, T tridiagonal. dsytrd, dsterf; dstein, dormtr. */
typedef struct mt_tridiagonal {
    int n;
    double scale; /* a power of 2: of size 1 where the range of numbers would not do */
    double *a;    /* n x n: reflectors of Q */
    double *tau;
    double *d; /* [n] diagonal of T */
    double *e; /* [n] beside it */
} mt_tridiagonal;
/* All eigenvalues (ascending, w[n]) of symmetric A, lower read; A becomes part of *out, of
 * which the rest lives in mem. 4/3 n^3 flops. Errors and failure as of mt_eig_sym. */
mt_status mt_eig_sym_values(int n, double *a, double *w, mt_arena *mem, mt_tridiagonal *out,
                            mt_err *err);
/* Orthonormal eigenvectors of the `count` lowest of them, z n x count. O(n^2 count). Fails
 * MT_E_NO_CONVERGENCE, which mt_eig_sym might not. */
mt_status mt_eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                            mt_arena *scratch, mt_err *err);
/* All eigenvalues of a general real matrix (destroyed): wr, wi [n]; right eigenvectors optional
 * (vr n x n in LAPACK's packed real form, may be NULL). dgeev. */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err);
/* The same of a complex matrix: w [n], right eigenvectors vr n x n (may be NULL). zgeev. */
mt_status mt_eig_complex(int n, double complex *a, double complex *w, double complex *vr,
                         mt_arena *scratch, mt_err *err);

#endif
