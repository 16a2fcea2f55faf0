/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_EIG_H
#define LINALG_EIG_H

#include <stdbool.h>

#include "base/arena.h"

/* All eigenvalues (ascending, w[n]) of symmetric A (lower read; destroyed; with vectors:
 * overwritten by orthonormal eigenvectors). dsyevd: 8 us for n = 11, about 9 n^3 flops. |error
 * of w| <= about n eps max|w|. Fails MT_E_NO_CONVERGENCE. */
mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err);
/* All eigenvalues of a general real matrix (destroyed): wr, wi [n]; right eigenvectors optional
 * (vr n x n in LAPACK's packed real form, may be NULL). dgeev. */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err);

#endif
