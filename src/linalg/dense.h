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
 * Dense kernels: column-major, the only door to LAPACKE and CBLAS. Matrices of order zero are
 * fine everywhere, arrays do not overlap. Every LAPACK `info` becomes a status: below zero is
 * our bug (MT_E_INTERNAL), above zero is translated. Scratch is taken from the arena that is
 * given and is back (rewound) on return, so repeated calls do not touch the heap. LAPACK must
 * never see a NaN (some routines then spin or return a success): every function that returns a
 * status answers MT_E_DOMAIN where an entry that it reads is not finite, and MT_E_MEMORY where
 * the arena is out of memory; these two are not repeated below.
 */

#endif
