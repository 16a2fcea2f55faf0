/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_GRADED_H
#define LINALG_GRADED_H

#include "base/arena.h"

/* Eigenvalues (*descending*, w[n]) and orthonormal eigenvectors (over A) of symmetric positive
 * definite A (lower read) to the accuracy of its grading: for A = D C D, D diagonal and C well
 * conditioned, all eigenvalues have all digits, and the entry of a vector that mixes two of
 * them has an error of eps times the square root of their quotient, not eps times the quotient.
 * Cholesky, then Jacobi's method on the factor (dgejsv; Demmel and Veselic, SIAM J. Matrix
 * Anal. 13). Fails MT_E_NOT_SPD, or as mt_svd_jacobi. */
mt_status mt_eig_graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err);

#endif
