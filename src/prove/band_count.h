/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BAND_COUNT_H
#define PROVE_BAND_COUNT_H

#include "mechanics/linear.h"

/*
 * Independent check of one design: the number of modes inside a band by inertia of K - lambda M
 * alone (mt_inertia, pivoting, no eigenvalue; another path than everything above and than
 * mt_modal_solve), edges moved inwards by the relative tolerance. sure: the pivots are well
 * away from zero.
 */
typedef struct mt_band_count {
    int below;  /* vibration modes below the band */
    int inside; /* in it */
    bool sure;
} mt_band_count;
mt_status mt_certify_count(const mt_linear *lin, int n_rigid, double lower_hz, double upper_hz,
                           double tolerance, mt_arena *scratch, mt_band_count *out,
                           mt_err *err);

#endif
