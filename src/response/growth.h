/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_GROWTH_H
#define RESPONSE_GROWTH_H

#include <complex.h>

#include "base/arena.h"
#include "response/forced.h"

/*
 * Whether a forced system about a position that holds (K without a negative direction) comes to
 * a stationary response. It does unless a pole grows by itself, and then C or H has a negative
 * direction: for x^H (s^2 M + s C + K + i H) x = 0 with Im s >= 0 and C, H >= 0 there is no
 * Re s > 0. So a pole that only rounding puts to the right of a passive system's axis is none.
 * @param[in]  poles    [n], as mt_response_pole_list gives them
 * @param[out] growing  the one that grows fastest; -1: none
 * O(n), O(f->n^3) where a pole lies to the right. Fails: MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
mt_status mt_response_growing(const mt_forced *f, int n, const double complex *poles,
                              mt_arena *mem, int *growing, mt_err *err);

#endif
