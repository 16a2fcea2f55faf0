/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_GROWTH_H
#define MODAL_GROWTH_H

#include <complex.h>

#include "base/arena.h"

/*
 * Which motions grow by themselves: the one rule that every answer asks which assumes that a
 * system comes to rest, or to a stationary response.
 *
 * The pole with the largest Re s of those with Im s >= 0 (the others are their images) and Re s
 * above rounding: 64 units in the last place of |s|, or `rounding` where that is more (an
 * eigenvalue solver's, in the unit of s). -1: none. O(n).
 */
int mt_modal_growing_pole(int n, const double complex *s, double rounding);

/*
 * *passive: nothing pushes the motions on. About a position that holds (K without a negative
 * direction), a pole grows only where C or H has a negative direction: for
 * x^H (s^2 M + s C + K + i H) x = 0 with Im s >= 0 and C, H >= 0 there is no Re s > 0. So a
 * pole that rounding puts to the right of a passive system's axis is none that grows.
 * @param[in]  c, h  n x n symmetric, lower triangles read; NULL: 0
 * O(n^3). Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
mt_status mt_modal_is_passive(int n, const double *c, const double *h, mt_arena *mem,
                              bool *passive, mt_err *err);

#endif
