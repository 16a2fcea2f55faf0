/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_DENSE_H
#define LINALG_DENSE_H

#include "linalg/assign.h"
#include "linalg/cholesky.h"
#include "linalg/complex.h"
#include "linalg/eig.h"
#include "linalg/graded.h"
#include "linalg/inertia.h"
#include "linalg/kernels.h"
#include "linalg/ldl.h"
#include "linalg/qr.h"
#include "linalg/solve.h"
#include "linalg/sparse.h"
#include "linalg/svd.h"

/*
 * Dense kernels: column-major, the only callers of LAPACKE and CBLAS. Matrices of order zero
 * are allowed everywhere; arrays do not overlap. Every LAPACK `info` becomes a status: below
 * zero is our bug (MT_E_INTERNAL), above zero is translated. Scratch is taken from the given
 * arena and rewound on return, so repeated calls do not touch the heap. LAPACK must never see a
 * NaN (some routines then loop for ever or return success): every function that returns a
 * status fails with MT_E_DOMAIN where an entry that it reads is not finite, and with
 * MT_E_MEMORY where the arena is out of memory; these two are not repeated below.
 */

#endif
