/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_GROWTH_H
#define MODAL_GROWTH_H

#include <complex.h>

#include "base/arena.h"

/*
 * The rule for growing motions, used wherever a system is assumed to come to rest or to a
 * steady response.
 *
 * Index of the pole with the largest Re s among those with Im s >= 0 (the others are their
 * conjugates) and Re s above rounding: 64 units in the last place of |s|, or `rounding` where
 * that is more (the error of an eigenvalue solver, in the unit of s). -1: none. O(n).
 */
int mt_modal_growing_pole(int n, const double complex *s, double rounding);

/*
 * *passive: C and H have no negative direction, so the system feeds no energy to its motions.
 * In a stable position (K without a negative direction) a pole grows only where C or H has a
 * negative direction: for x^H (s^2 M + s C + K + i H) x = 0 with Im s >= 0 and C, H >= 0 there
 * is no Re s > 0. A pole of a passive system with Re s > 0 is therefore rounding.
 * @param[in]  c, h  n x n symmetric, lower triangles read; NULL: 0
 * O(n^3). Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
mt_status mt_modal_is_passive(int n, const double *c, const double *h, mt_arena *mem,
                              bool *passive, mt_err *err);

#endif
