/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_REDUCE_H
#define MECHANICS_REDUCE_H

#include "mechanics/linear.h"

/* reduced = Z^T row for all rows of all kinds at the present position, entries that are rounding made exactly 0, and blocked where nothing is left. After the elimination and the rows; the memory is
 * that of the geometry. O(rows n), and a solve with the factored constraints for each row that only its reactions can judge. */
mt_status mt_reduce_rows(mt_linear *lin, mt_err *err);

#endif
