/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_DENSE_H
#define LINALG_DENSE_H

#include <stdbool.h>

#include "base/arena.h"

/*
 * Dense kernels: column-major, the only door to LAPACKE and CBLAS. Matrices of order zero are fine everywhere. Every LAPACK `info` becomes a
 * status. Scratch is taken from the arena that is given and is back (rewound) on return, so repeated calls do not touch the heap.
 */

/* C := alpha op(A) op(B) + beta C; op transposes where the flag says so. m x n result, inner size k. */
void mt_gemm(bool trans_a, bool trans_b, int m, int n, int k, double alpha, const double *a, int lda, const double *b, int ldb,
             double beta, double *c, int ldc);
/* y := alpha op(A) x + beta y, A m x n. */
void mt_gemv(bool trans, int m, int n, double alpha, const double *a, int lda, const double *x, double beta, double *y);
double mt_dot(int n, const double *x, const double *y);
double mt_norm2(int n, const double *x);
void mt_axpy(int n, double alpha, const double *x, double *y);
/* Largest absolute entry; NaN if any entry is NaN. */
double mt_max_abs(ptrdiff_t n, const double *x);
/* Copy the lower triangle into the upper one. */
void mt_symmetrise_lower(int n, double *a);

/* L L^T = A (lower triangle read and overwritten; strictly upper part untouched). Fails MT_E_NOT_SPD, *bad (may be NULL) the pivot, 0-based. */
mt_status mt_cholesky(int n, double *a, int *bad, mt_err *err);
/* X := op(L)^-1 X for n x nrhs X (left), L lower from mt_cholesky. */
void mt_tri_solve(bool trans, int n, int nrhs, const double *l, double *x, int ldx);
/* A := L^-1 A L^-T, full symmetric A (lower read, full written). */
void mt_congruence_inverse(int n, const double *l, double *a);

/* All eigenvalues (ascending, w[n]) of symmetric A (lower read; destroyed; with vectors: overwritten by orthonormal eigenvectors). dsyevd.
 * Fails MT_E_NO_CONVERGENCE. */
mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err);
/* Number of negative, zero and positive eigenvalues of symmetric A - shift*B (B may be NULL: identity), by LDL^T (Bunch-Kaufman), with the smallest
 * |pivot block eigenvalue| relative to the largest in *gap (1: well separated from zero; near eps: the count is unsure). A, B lower read, unchanged. */
mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3], double *gap, mt_arena *scratch, mt_err *err);

/* QR with column pivoting of m x n A: A P = Q R. Rank is decided against tol * |R(0,0)|. */
typedef struct mt_qr {
    int m;
    int n;
    int rank;
    int *perm;   /* [n] column j of A P is column perm[j] of A */
    double *qr;  /* m x n, R in the upper triangle, reflectors below */
    double *tau; /* [min(m,n)] */
    double kept;    /* smallest kept |R(i,i)| / |R(0,0)|; 1 where rank is 0 */
    double dropped; /* largest dropped |R(i,i)| / |R(0,0)|; 0 where none */
} mt_qr;
/* Copies A; the factor lives in mem. */
mt_status mt_qr_factor(int m, int n, const double *a, int lda, double tol, mt_arena *mem, mt_qr *out, mt_err *err);
/* Q (m x m) or only columns from..m-1 of it, m x (m - from), into q (ld m). from = rank gives an orthonormal basis of the orthogonal complement of range(A). */
mt_status mt_qr_q(const mt_qr *f, int from, double *q, mt_arena *scratch, mt_err *err);
/* Minimum-residual basic solution of A x ~ b using the leading rank columns (other entries 0): x [n x nrhs], b [m x nrhs] (unchanged). */
mt_status mt_qr_solve(const mt_qr *f, int nrhs, const double *b, double *x, mt_arena *scratch, mt_err *err);
/* Minimum-norm solution of A^T y = c for c in the row space: y [m x nrhs] in span of Q's first rank columns; uses the leading `rank` pivoted equations. */
mt_status mt_qr_solve_transposed(const mt_qr *f, int nrhs, const double *c, double *y, mt_arena *scratch, mt_err *err);

/* LU with partial pivoting, A (n x n, destroyed) X = B (n x nrhs, overwritten). *rcond (may be NULL): reciprocal condition estimate. Fails MT_E_SINGULAR. */
mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch, mt_err *err);
/* Symmetric indefinite solve (dsysv), A lower read and destroyed. Fails MT_E_SINGULAR. */
mt_status mt_sym_solve(int n, double *a, int nrhs, double *b, mt_arena *scratch, mt_err *err);
/* Singular values (descending, s[min(m,n)]) and, where u / vt are not NULL, thin U (m x min) and V^T (min x n). dgesdd with fallback dgesvd. A destroyed. */
mt_status mt_svd(int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch, mt_err *err);
/* Singular values and right vectors (m x n A with m >= n; V n x n) to high *relative* accuracy for A = D C with D diagonal and C well conditioned, however
 * graded: one-sided Jacobi (dgejsv). Values descending. A destroyed. */
mt_status mt_svd_jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch, mt_err *err);
/* Moore-Penrose inverse: pinv [n x m] of A [m x n], singular values below tol * largest dropped. *rank may be NULL. */
mt_status mt_pinv(int m, int n, const double *a, double tol, double *pinv, int *rank, mt_arena *scratch, mt_err *err);
/* All eigenvalues of a general real matrix (destroyed): wr, wi [n]; right eigenvectors optional (vr n x n in LAPACK's packed real form, may be NULL). dgeev. */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr, mt_arena *scratch, mt_err *err);

/* One-to-one assignment that maximises the sum of score (m x n, column-major): row i is paired with pair[i], or -1 (m > n). O(min(m,n)^2 max(m,n)).
 * Deterministic: among equal sums the lexicographically smallest pairing of the algorithm's order. NaN scores count as -inf. */
mt_status mt_assign(int m, int n, const double *score, int *pair, mt_arena *scratch, mt_err *err);

#endif
