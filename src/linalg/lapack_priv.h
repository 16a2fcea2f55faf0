/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LAPACK_PRIV_H
#define LINALG_LAPACK_PRIV_H

#include <lapacke.h>

#include "linalg/dense.h"

/* Up to this order LAPACK's blocks of 32 columns are never formed: the documented least
 * workspace does for the same operations, and nobody has to ask how much would be best. */
enum { MT_LAPACK_UNBLOCKED = 32 };

/* LAPACK said info < 0: our bug. Names the argument. */
mt_status mt_lapack_bug(const char *routine, lapack_int info, mt_err *err);
/* An entry handed to the routine is NaN or infinite: MT_E_DOMAIN. */
mt_status mt_lapack_not_finite(const char *routine, mt_err *err);
/* Work array of max(query, minimum) doubles: queries of some routines answer less than their
 * documented minimum. Sizes beyond LAPACK's integers are MT_E_MEMORY. The sizes are doubles
 * since LAPACK answers so and since sums of products of orders must not wrap. */
mt_status mt_lapack_work(mt_arena *scratch, double query, double minimum, double **work,
                         lapack_int *lwork, mt_err *err);

#endif
