/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_SPECTRAL_PRIV_H
#define VIBRATION_SPECTRAL_PRIV_H

#include "vibration/spectral.h"

#define MT_TWO_PI 6.28318530717958647693

/* A segment of a density: G = (w / lower)^exponent from lower to upper [rad/s]. */
typedef struct mt_spectral_segment {
    double lower;
    double upper;
    double exponent;
} mt_spectral_segment;

mt_spectral_segment mt_spectral_segment_of(const mt_psd *input, int i);
/* G at a frequency of the segment. */
double mt_spectral_power(const mt_spectral_segment *segment, mt_near w);

/* An integral over a segment with the bound of its error. */
typedef struct mt_spectral_sum {
    double value;
    double bound;
} mt_spectral_sum;

/* Integral of |H|^2 (w / lower)^exponent dw in closed form (spectral_closed.c). Where the
 * closed form cannot be used, the bound is infinite. */
mt_spectral_sum mt_spectral_closed(const mt_spectral *r, const mt_spectral_segment *segment);

/* Bound of the rounding error of a sum over all poles, in units in the last place. */
double mt_spectral_ulps(const mt_frf *h);

#endif
