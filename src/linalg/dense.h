/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_DENSE_H
#define LINALG_DENSE_H

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/arena.h"
#include "base/base.h"
#include "linalg/assign.h"
#include "linalg/complex.h"
#include "linalg/ldl.h"
#include "linalg/sparse.h"

/*
 * Dense kernels: column-major, the only callers of LAPACKE and CBLAS. Matrices of order zero
 * are allowed everywhere; arrays do not overlap. Every LAPACK `info` becomes a status: below
 * zero is our bug (MT_E_INTERNAL), above zero is translated. Scratch is taken from the given
 * arena and rewound on return, so repeated calls do not touch the heap. LAPACK must never see a
 * NaN (some routines then loop for ever or return success): every function that returns a
 * status fails with MT_E_DOMAIN where an entry that it reads is not finite, and with
 * MT_E_MEMORY where the arena is out of memory; these two are not repeated below.
 */

/*
 * Control of OpenBLAS. Its threads and buffers belong to the whole process, so only a program
 * sets them, never the library. Two threads make matrices of order twelve five times slower and
 * change the last bits of results.
 */

/* Bytes of address space of the buffer that OpenBLAS keeps per concurrent caller, rounded up:
 * 32 MB times 4, and a page. */
enum { MT_BLAS_BUFFER = (128 + 1) * 1024 * 1024 };

/* Run OpenBLAS's constructor now, so that it reads the current environment
 * (OPENBLAS_NUM_THREADS). */
void mt_blas_load(void);
void mt_blas_set_threads(int threads);
/* Make OpenBLAS keep buffers for so many concurrent callers (at most 64), so that it never
 * allocates one later: without memory it would retry for ever. Call before any thread starts.
 * Fails: MT_E_MEMORY. */
mt_status mt_blas_claim(int callers, mt_err *err);
/* Name, version and processor kernel of the BLAS, for `run` of a result; never NULL, owned by
 * the BLAS. */
const char *mt_blas_description(void);

enum { MT_ARITHMETIC_TEXT = 17 };

/* Hash of the bits that the C library's functions give on this processor. Where two hashes
 * differ (fused multiply-add or not, another version), results may differ in their last
 * digits. */
void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT]);

/* Up to this order LAPACK does not use blocks of 32 columns: the documented minimum workspace
 * gives the same operations, and no workspace query is needed. */
enum { MT_LAPACK_UNBLOCKED = 32 };

/* Status of info < 0, our bug; names the argument. */
mt_status mt_lapack_bug(const char *routine, int info, mt_err *err);
/* MT_E_DOMAIN: an argument of the routine has a NaN or infinite entry. */
mt_status mt_lapack_not_finite(const char *routine, mt_err *err);
/* Work array of max(query, minimum) doubles: queries of some routines return less than their
 * documented minimum. Sizes beyond LAPACK's integers are MT_E_MEMORY. Sizes are doubles because
 * LAPACK returns doubles and sums of products of orders must not wrap. */
mt_status mt_lapack_work(mt_arena *scratch, double query, double minimum, double **work,
                         int *lwork, mt_err *err);

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

/* L L^T = A (lower triangle read and overwritten; strictly upper part untouched). Fails
 * MT_E_NOT_SPD; *bad (may be NULL) is then the 0-based index of the pivot, otherwise -1. n^3/3
 * flops. */
mt_status mt_cholesky(int n, double *a, int *bad, mt_err *err);
/* X := op(L)^-1 X for n x nrhs X (left), L lower from mt_cholesky. */
void mt_tri_solve(bool trans, int n, int nrhs, const double *l, double *x, int ldx);
/* A := L^-1 A L^-T, full symmetric A (lower read, full written). */
void mt_congruence_inverse(int n, const double *l, double *a);
/* x := L^-1, lower, upper part of x set to zero (n x n). L regular. */
void mt_tri_inverse(int n, const double *l, double *x);

/* LU with partial pivoting, A (n x n, destroyed) X = B (n x nrhs, overwritten). *rcond (may be
 * NULL): reciprocal condition estimate in the 1-norm, 0 where singular. Fails MT_E_SINGULAR
 * only at an exactly zero pivot; to detect nearly singular systems, scale them and check
 * rcond. */
mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch,
                      mt_err *err);
/* *sign of det A, -1, 0 or 1, by LU with partial pivoting; A (n x n) is destroyed. n = 0: 1. */
mt_status mt_lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err);

/* QR with column pivoting of m x n A: A P = Q R. The rank ends at the first diagonal entry of R
 * at or below tol |R(0,0)| (the entries never grow). A zero matrix has rank 0. dgeqp3. */
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
/* Columns from .. m - 1 of Q (m x m), m x (m - from), into q (ld m). from = rank gives an
 * orthonormal basis of the orthogonal complement of range(A). */
mt_status mt_qr_q(const mt_qr *f, int from, double *q, mt_arena *scratch, mt_err *err);
/* Minimum-residual basic solution of A x ~ b using the leading rank columns (other entries 0):
 * x [n x nrhs], b [m x nrhs] (unchanged). */
mt_status mt_qr_solve(const mt_qr *f, int nrhs, const double *b, double *x, mt_arena *scratch,
                      mt_err *err);
/* Minimum-norm solution of A^T y = c for c in the row space: y [m x nrhs] in span of Q's first
 * rank columns; uses the leading `rank` pivoted equations. */
mt_status mt_qr_solve_transposed(const mt_qr *f, int nrhs, const double *c, double *y,
                                 mt_arena *scratch, mt_err *err);

/* Singular values (descending, s[min(m,n)]) and, where u / vt are not NULL, thin U (m x min)
 * and V^T (min x n). dgesdd with fallback dgesvd. A destroyed. Fails MT_E_NO_CONVERGENCE. */
mt_status mt_svd(int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch,
                 mt_err *err);
/* Singular values and right vectors (m x n A with m >= n; V n x n or NULL) to high *relative*
 * accuracy for A = D C with any diagonal D and well conditioned C: one-sided Jacobi (dgejsv
 * with row pivoting; Drmac and Veselic). Values descending. A destroyed. Fails
 * MT_E_NO_CONVERGENCE. */
mt_status mt_svd_jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err);
/* Moore-Penrose inverse: pinv [n x m] of A [m x n], singular values below tol * largest
 * dropped. *rank may be NULL. */
mt_status mt_pinv(int m, int n, const double *a, double tol, double *pinv, int *rank,
                  mt_arena *scratch, mt_err *err);

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

/* Eigenvalues (*descending*, w[n]) and orthonormal eigenvectors (over A) of symmetric positive
 * definite A (lower read) to the accuracy of its grading: for A = D C D, D diagonal and C well
 * conditioned, all eigenvalues have all digits, and the entry of a vector that mixes two of
 * them has an error of eps times the square root of their quotient, not eps times the quotient.
 * Cholesky, then Jacobi's method on the factor (dgejsv; Demmel and Veselic, SIAM J. Matrix
 * Anal. 13). Fails MT_E_NOT_SPD, or as mt_svd_jacobi. */
mt_status mt_eig_graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err);

/* count: numbers of negative, zero and positive eigenvalues of symmetric A - shift B (B NULL:
 * identity), by LDL^T (Bunch-Kaufman) after scaling by powers of two to unit diagonal of |A| +
 * |shift B|, so units of rows do not matter. *gap (may be NULL): smallest |eigenvalue of a
 * pivot block| relative to the largest; 1: well separated from zero; near n eps: the count is
 * unsure. A, B lower read, unchanged. */
mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3],
                     double *gap, mt_arena *scratch, mt_err *err);

#endif
