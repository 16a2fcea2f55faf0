/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_INERTIA_H
#define LINALG_INERTIA_H

#include "base/arena.h"

/* count: numbers of negative, zero and positive eigenvalues of symmetric A - shift B (B NULL:
 * identity), by LDL^T (Bunch-Kaufman) after scaling by powers of two to unit diagonal of |A| +
 * |shift B|, so units of rows do not matter. *gap (may be NULL): smallest |eigenvalue of a
 * pivot block| relative to the largest; 1: well separated from zero; near n eps: the count is
 * unsure. A, B lower read, unchanged. */
mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3],
                     double *gap, mt_arena *scratch, mt_err *err);

#endif
