/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_SOLVE_H
#define LINALG_SOLVE_H

#include "base/arena.h"

/* LU with partial pivoting, A (n x n, destroyed) X = B (n x nrhs, overwritten). *rcond (may be
 * NULL): reciprocal condition estimate in the 1-norm, 0 where singular. Fails MT_E_SINGULAR
 * only at an exactly zero pivot; to detect nearly singular systems, scale them and check
 * rcond. */
mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch,
                      mt_err *err);
/* *sign of det A, -1, 0 or 1, by LU with partial pivoting; A (n x n) is destroyed. n = 0: 1. */
mt_status mt_lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err);

#endif
