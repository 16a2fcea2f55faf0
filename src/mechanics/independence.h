/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_INDEPENDENCE_H
#define MECHANICS_INDEPENDENCE_H

#include "mechanics/linear.h"
#include "mechanics/names.h"

/*
 * Equations of joints that are redundant here need not be so at other values of input p. With w
 * a left null vector of A, a dot the derivative by p and the motion that it causes,
 *     w^T c. != 0         the joints do not stay closed: the position has no derivative
 *     w^T A. Z y != 0     the motion y, free here, is blocked at any other value of p: the
 *                         number of freedoms changes, and the mode y has no derivative.
 */
typedef struct mt_independence {
    bool opens;            /* w^T c. != 0 */
    bool blocks;           /* w^T A. Z y != 0 for some motion y */
    mt_joint_names joints; /* joints of these equations */
} mt_independence;
/* After an update with gradients; names in mem. Costs nothing where no equation is redundant or
 * p moves nothing. */
mt_status mt_linear_independence(mt_linear *lin, int p, mt_arena *mem, mt_independence *out,
                                 mt_err *err);
/* blocked[cols]: true for blocked motions y (n x cols). */
mt_status mt_linear_blocked(mt_linear *lin, int p, int cols, const double *y, bool *blocked,
                            mt_err *err);

#endif
