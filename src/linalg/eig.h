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
/* The same in two steps, where the eigenvalues decide how many vectors are wanted: scale A = Q
 * T Q^T, T tridiagonal. dsytrd, dsterf; dstein, dormtr. */
typedef struct mt_tridiagonal {
    int n;
    /* power of 2 that makes A of size 1 where squares of its entries would over- or
     * underflow */
    double scale;
    double *a; /* n x n: reflectors of Q */
    double *tau;
    double *d; /* [n] diagonal of T */
    double *e; /* [n] off-diagonal of T */
} mt_tridiagonal;
/* All eigenvalues (ascending, w[n]) of symmetric A, lower read. *out keeps A, which is
 * overwritten; its other arrays are in mem. 4/3 n^3 flops. Errors and failure as of
 * mt_eig_sym. */
mt_status mt_eig_sym_values(int n, double *a, double *w, mt_arena *mem, mt_tridiagonal *out,
                            mt_err *err);
/* Orthonormal eigenvectors of the `count` lowest eigenvalues, z n x count. O(n^2 count). Fails
 * MT_E_NO_CONVERGENCE, possibly where mt_eig_sym would not. */
mt_status mt_eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                            mt_arena *scratch, mt_err *err);
/* All eigenvalues of a general real matrix (destroyed): wr, wi [n]; right eigenvectors optional
 * (vr n x n in LAPACK's packed real form, may be NULL). dgeev. */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err);
/* As mt_eig_general for a complex matrix: w [n], right eigenvectors vr n x n (may be NULL).
 * zgeev. */
mt_status mt_eig_complex(int n, double complex *a, double complex *w, double complex *vr,
                         mt_arena *scratch, mt_err *err);

#endif
