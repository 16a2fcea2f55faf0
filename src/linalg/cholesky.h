/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_CHOLESKY_H
#define LINALG_CHOLESKY_H

#include <stdbool.h>

#include "base/base.h"

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

#endif
