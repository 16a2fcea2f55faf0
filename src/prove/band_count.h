/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BAND_COUNT_H
#define PROVE_BAND_COUNT_H

#include "mechanics/linear.h"

/*
 * Independent check of one design: the number of modes inside a band from the inertia of K -
 * lambda M (mt_inertia, pivoting, no eigenvalues; code shared neither with the enclosures nor
 * with mt_modal_solve), edges moved inwards by the relative tolerance.
 */
typedef struct mt_band_count {
    int below;  /* vibration modes below the band */
    int inside; /* in the band */
    bool sure;  /* the pivots are well away from zero */
} mt_band_count;
mt_status mt_certify_count(const mt_linear *lin, int n_rigid, double lower_hz, double upper_hz,
                           double tolerance, mt_arena *scratch, mt_band_count *out,
                           mt_err *err);

#endif
