/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LDL_H
#define LINALG_LDL_H

#include <complex.h>

#include "base/arena.h"

/* Pattern of a sparse symmetric matrix: row i is stored from column first[i] to the diagonal.
 * Entry (i, j), first[i] <= j <= i, is value[row[i] + j]. */
typedef struct mt_envelope {
    int n;
    int *first;     /* [n] */
    int *last;      /* [n] last row with an entry in column j */
    ptrdiff_t *row; /* [n] */
    size_t count;   /* number of values */
    int front;      /* greatest number of rows open at a time if no pivot is delayed */
} mt_envelope;

/* P A P^T = L D L^T, D in blocks of order one and two. */
typedef struct mt_ldl_pivot {
    int at[2];   /* rows of A; at[1] is -1 in a block of order one */
    double d[3]; /* d11, d21, d22 */
    int n;
    int *index;   /* [n] rows of A below the pivot */
    double *l[2]; /* [n] */
} mt_ldl_pivot;

typedef struct mt_ldl {
    int n;
    bool whole;   /* false: stopped, as more than `room` open rows were needed */
    int rank;     /* the remaining rows have no entry above tol */
    int negative; /* number of negative eigenvalues (Sylvester's law) */
    int n_pivots;
    mt_ldl_pivot *pivot;
    int n_rest;
    int *rest; /* [n_rest] rows of A that gave no pivot */
} mt_ldl;

/*
 * Factor a symmetric, possibly indefinite matrix of entries of about size one, possibly with
 * zeros on the diagonal. Rows enter a dense front in order and leave it as pivots of order one
 * or two as soon as all of their entries are assembled and no entry of L exceeds 10; other
 * pivots are delayed to a later front. room: greatest number of open rows. The factor is in
 * mem; O(n room^2). Fails: MT_E_DOMAIN (an entry is not finite), MT_E_MEMORY. Method: Duff and
 * Reid, ACM Trans. Math. Softw. 9 (1983) 302-325, with one front.
 */
mt_status mt_ldl_factor(const mt_envelope *p, const double *value, double tol, int room,
                        mt_arena *mem, mt_ldl *out, mt_err *err);
/* x [n] := A^-1 x. Singular A: a solution with 0 in the rows without a pivot, if x is in the
 * range. */
void mt_ldl_solve(const mt_ldl *f, double *x);
/* *norm: lower estimate of |A^-1| in the 1-norm, seldom more than 3 times too small (dlacn2);
 * infinite where A is singular. Costs a few solutions. Fails: MT_E_MEMORY. */
mt_status mt_ldl_inverse_norm(const mt_ldl *f, mt_arena *scratch, double *norm, mt_err *err);

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
