/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_EIG_SMALL_H
#define LINALG_EIG_SMALL_H

#include <stdbool.h>

/* Up to this order mt_eig_small is faster than LAPACK. */
enum { MT_EIG_SMALL = 28 };

/* As mt_eig_sym, for 1 <= n <= MT_EIG_SMALL and finite entries whose products neither over- nor
 * underflow. The operations do not depend on BLAS kernels. false: no convergence. */
bool mt_eig_small(int n, double *a, double *w, bool vectors);

#endif
