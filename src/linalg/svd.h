/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_SVD_H
#define LINALG_SVD_H

#include "base/arena.h"

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

#endif
