/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_REDUCE_H
#define MECHANICS_REDUCE_H

#include "mechanics/linear.h"

/* Replace the basis of the elimination by one local to the bodies (local.h), with bounds of its
 * errors. After the elimination and the rows. */
mt_status mt_reduce_basis(mt_linear *lin, mt_err *err);
/* reduced = Z^T row for all rows of all kinds at the present position; entries that are
 * rounding are set to 0, and rows without others are blocked. After the basis; in the memory of
 * the geometry. O(rows n). */
mt_status mt_reduce_rows(mt_linear *lin, mt_err *err);

#endif
