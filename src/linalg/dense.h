/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_DENSE_H
#define LINALG_DENSE_H

#include <stdbool.h>

#include "base/arena.h"

/*
 * Dense kernels: column-major, the only door to LAPACKE and CBLAS. Matrices of order zero are
 * fine everywhere, arrays do not overlap. Every LAPACK `info` becomes a status: below zero is
 * our bug (MT_E_INTERNAL), above zero is translated. Scratch is taken from the arena that is
 * given and is back (rewound) on return, so repeated calls do not touch the heap. LAPACK must
 * never see a NaN (some routines then spin or return a success): every function that returns a
 * status answers MT_E_DOMAIN where an entry that it reads is not finite, and MT_E_MEMORY where
 * the arena is out of memory; these two are not repeated below.
 */

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
/* Are all n entries (of the lower triangle of an n x n matrix) finite? */
bool mt_all_finite(ptrdiff_t n, const double *x);
bool mt_lower_finite(int n, const double *a);
/* C := A B with symmetric A (n x n, lower read), B and C n x nrhs. */
void mt_symm(int n, int nrhs, const double *a, const double *b, double *c);
/* B := A^T, A m x n, B n x m. */
void mt_transpose(int m, int n, const double *a, double *b);
/* Copy the lower triangle into the upper one. */
void mt_symmetrise_lower(int n, double *a);

/* L L^T = A (lower triangle read and overwritten; strictly upper part untouched). Fails
 * MT_E_NOT_SPD, *bad (may be NULL) the pivot, 0-based; it is -1 unless so. n^3/3 flops. */
mt_status mt_cholesky(int n, double *a, int *bad, mt_err *err);
/* X := op(L)^-1 X for n x nrhs X (left), L lower from mt_cholesky. */
void mt_tri_solve(bool trans, int n, int nrhs, const double *l, double *x, int ldx);
/* A := L^-1 A L^-T, full symmetric A (lower read, full written). */
void mt_congruence_inverse(int n, const double *l, double *a);
/* x := L^-1, lower, upper part of x set to zero (n x n). L regular. */
void mt_tri_inverse(int n, const double *l, double *x);

/* All eigenvalues (ascending, w[n]) of symmetric A (lower read; destroyed; with vectors:
 * overwritten by orthonormal eigenvectors). dsyevd: 8 us for n = 11, about 9 n^3 flops. |error
 * of w| <= about n eps max|w|. Fails MT_E_NO_CONVERGENCE. */
mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err);
/* Number of negative, zero and positive eigenvalues of symmetric A - shift*B (B may be NULL:
 * identity), by LDL^T (Bunch-Kaufman) after scaling by powers of two to unit diagonal of |A| +
 * |shift B| (units of rows do not matter), with the smallest |pivot block eigenvalue| relative
 * to the largest in *gap (may be NULL; 1: well separated from zero; near n eps: the count is
 * unsure). count: negative, zero, positive. A, B lower read, unchanged. */
mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3],
                     double *gap, mt_arena *scratch, mt_err *err);

/* QR with column pivoting of m x n A: A P = Q R. Rank is decided against tol * |R(0,0)|: the
 * first diagonal entry at or below it ends the rank (the entries never grow). A zero matrix has
 * rank 0. dgeqp3. */
typedef struct mt_qr {
    int m;
    int n;
    int rank;
    int *perm;      /* [n] column j of A P is column perm[j] of A */
    double *qr;     /* m x n, R in the upper triangle, reflectors below */
    double *tau;    /* [min(m,n)] */
    double kept;    /* smallest kept |R(i,i)| / |R(0,0)|; 1 where rank is 0 */
    double dropped; /* largest dropped |R(i,i)| / |R(0,0)|; 0 where none */
} mt_qr;
/* Copies A; the factor lives in mem. */
mt_status mt_qr_factor(int m, int n, const double *a, int lda, double tol, mt_arena *mem,
                       mt_qr *out, mt_err *err);
/* X := Q X or (trans) Q^T X, X m x nrhs. */
mt_status mt_qr_apply_q(const mt_qr *f, bool trans, int nrhs, double *x, mt_arena *scratch,
                        mt_err *err);
/* Q (m x m) or only columns from..m-1 of it, m x (m - from), into q (ld m). from = rank gives
 * an orthonormal basis of the orthogonal complement of range(A). */
mt_status mt_qr_q(const mt_qr *f, int from, double *q, mt_arena *scratch, mt_err *err);
/* Minimum-residual basic solution of A x ~ b using the leading rank columns (other entries 0):
 * x [n x nrhs], b [m x nrhs] (unchanged). */
mt_status mt_qr_solve(const mt_qr *f, int nrhs, const double *b, double *x, mt_arena *scratch,
                      mt_err *err);
/* Minimum-norm solution of A^T y = c for c in the row space: y [m x nrhs] in span of Q's first
 * rank columns; uses the leading `rank` pivoted equations. */
mt_status mt_qr_solve_transposed(const mt_qr *f, int nrhs, const double *c, double *y,
                                 mt_arena *scratch, mt_err *err);

/* LU with partial pivoting, A (n x n, destroyed) X = B (n x nrhs, overwritten). *rcond (may be
 * NULL): reciprocal condition estimate in the 1-norm, 0 where singular. Fails MT_E_SINGULAR at
 * an exactly zero pivot only: whoever must know about nearly singular systems scales them and
 * looks at rcond. */
mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch,
                      mt_err *err);
/* Symmetric indefinite solve (dsysv), A lower read and destroyed, B overwritten. Fails
 * MT_E_SINGULAR (exactly zero pivot block). */
mt_status mt_sym_solve(int n, double *a, int nrhs, double *b, mt_arena *scratch, mt_err *err);
/* Singular values (descending, s[min(m,n)]) and, where u / vt are not NULL, thin U (m x min)
 * and V^T (min x n). dgesdd with fallback dgesvd. A destroyed. Fails MT_E_NO_CONVERGENCE. */
mt_status mt_svd(int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch,
                 mt_err *err);
/* Singular values and right vectors (m x n A with m >= n; V n x n or NULL) to high *relative*
 * accuracy for A = D C with D diagonal and C well conditioned, however graded: one-sided Jacobi
 * (dgejsv with row pivoting; Drmac and Veselic). Values descending. A destroyed. Fails
 * MT_E_NO_CONVERGENCE. */
mt_status mt_svd_jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err);
/* Moore-Penrose inverse: pinv [n x m] of A [m x n], singular values below tol * largest
 * dropped. *rank may be NULL. */
mt_status mt_pinv(int m, int n, const double *a, double tol, double *pinv, int *rank,
                  mt_arena *scratch, mt_err *err);
/* All eigenvalues of a general real matrix (destroyed): wr, wi [n]; right eigenvectors optional
 * (vr n x n in LAPACK's packed real form, may be NULL). dgeev. */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err);

/* One-to-one assignment that maximises the sum of score (m x n, column-major): row i is paired
 * with pair[i], or -1. min(m,n) rows are paired, fewer only where no more pairs with finite
 * scores exist: a score that is not finite never makes a pair. O(min(m,n)^2 max(m,n)), shortest
 * augmenting paths (Jonker and Volgenant's form of the Hungarian method). Deterministic: the
 * same scores give the same pairing, a tie goes to the lower column found first. */
mt_status mt_assign(int m, int n, const double *score, int *pair, mt_arena *scratch,
                    mt_err *err);

#endif
