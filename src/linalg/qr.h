/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_QR_H
#define LINALG_QR_H

#include <stdbool.h>

#include "base/arena.h"

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

#endif
