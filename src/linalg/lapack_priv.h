/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LAPACK_PRIV_H
#define LINALG_LAPACK_PRIV_H

#include <lapacke.h>

#include "linalg/dense.h"

/* Up to this order LAPACK does not use blocks of 32 columns: the documented minimum workspace
 * gives the same operations, and no workspace query is needed. */
enum { MT_LAPACK_UNBLOCKED = 32 };

/* Status of info < 0, our bug; names the argument. */
mt_status mt_lapack_bug(const char *routine, lapack_int info, mt_err *err);
/* MT_E_DOMAIN: an argument of the routine has a NaN or infinite entry. */
mt_status mt_lapack_not_finite(const char *routine, mt_err *err);
/* Work array of max(query, minimum) doubles: queries of some routines return less than their
 * documented minimum. Sizes beyond LAPACK's integers are MT_E_MEMORY. Sizes are doubles because
 * LAPACK returns doubles and sums of products of orders must not wrap. */
mt_status mt_lapack_work(mt_arena *scratch, double query, double minimum, double **work,
                         lapack_int *lwork, mt_err *err);

#endif
