/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_EIG_SMALL_H
#define LINALG_EIG_SMALL_H

#include <stdbool.h>

/* Up to this order it is the faster one. */
enum { MT_EIG_SMALL = 28 };

/* As mt_eig_sym, for 1 <= n <= MT_EIG_SMALL and finite entries of a moderate size (their
 * products are numbers). The operations do not depend on kernels of BLAS. false: no
 * convergence. */
bool mt_eig_small(int n, double *a, double *w, bool vectors);

#endif
