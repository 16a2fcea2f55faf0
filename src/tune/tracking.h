/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_TRACKING_H
#define TUNE_TRACKING_H

#include "tune/analysis.h"

/*
 * Named modes are followed by their shape. phi_0 is the named mode at the original design, M_0 the mass there, phi_j the modes of the present design:
 *
 *     share_j = (phi_0^T M_0 phi_j)^2 / sum_k (phi_0^T M_0 phi_k)^2       over all modes k, rigid-body modes included
 *
 * is the part of the named mode that mode j carries. Named modes and vibration modes are paired one to one so that the sum of the shares is greatest. The pairing depends on
 * the design alone, not on the way there, so that a search may come from anywhere; above one half a share cannot be beaten. Below that the mode is lost among others: the pair is
 * the best there is, and mt_view and results say so.
 */

/* Shares below this leave room for another mode with a larger one. */
#define MT_TRACK_LOST 0.5

/* w = M phi of the mode at position pos over all states, w[sys->nq]. Fails: MT_E_MEMORY. */
mt_status mt_track_weigh(mt_analysis *a, int pos, double *w, mt_err *err);
/*
 * Pair n named modes (weighed shapes w[n], made by mt_track_weigh for the same configuration) with the modes of the last solve, which had vectors.
 * pair[n]: positions in a->modes, -1 where there is no vibration mode left or the configuration is unstable; share[n] as above, 0 there.
 * O(n_modes (nq n + n_modes)); scratch from a->mem, given back. Fails: MT_E_MEMORY, MT_E_INTERNAL (no vectors).
 */
mt_status mt_track_assign(mt_analysis *a, int n, const double *const *w, int *pair,
                          double *share, mt_err *err);

#endif
