/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_MAC_H
#define MODAL_MAC_H

#include "base/arena.h"

/*
 * MAC (Ewins; paper Eq. 19) of shapes sampled at common sensors, a ns x ra, b ns x rb, mac ra x
 * rb column-major:
 *   mac_ij = (a_i . b_j)^2 / ((a_i . a_i)(b_j . b_j)), in [0, 1];
 * NaN where a shape vanishes at all sensors.
 */
void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac);
/* One-to-one pairing that maximises the sum of MAC; pair[ra] = column of b or -1 (none left, or
 * only NaN left). */
mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch,
                      mt_err *err);
/* Subspace MAC: squared cosine of each principal angle between span(a) and span(b), descending,
 * cos2[min(ra, rb)]; for clusters. Where the sensors see fewer independent shapes, the last
 * entries are NaN. Fails: MT_E_DOMAIN, MT_E_NO_CONVERGENCE, MT_E_MEMORY. */
mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err);
/* d mac(a, b) / dp for da = d a / dp (b fixed):
 *   2 (a.b)(da.b) / ((a.a)(b.b)) - 2 mac (a.da) / (a.a). */
double mt_mac_derivative(int ns, const double *a, const double *da, const double *b);

#endif
