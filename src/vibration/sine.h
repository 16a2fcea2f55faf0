/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_SINE_H
#define VIBRATION_SINE_H

#include "vibration/spectral.h"

/*
 * The largest response to a tone whose frequency lies anywhere in a range:
 *     max |H(w)|,   lower <= w <= upper.
 * It is found by branch and bound without a grid: a Taylor series about the middle of an
 * interval, its remainder from the distances of the poles, bounds |H|^2 on the interval;
 * intervals whose bound is not above the best known value are finished, others are halved. The
 * finished intervals prove that |H| is at most value (1 + excess) over the range.
 */
typedef struct mt_sine_peak {
    mt_forced_end end; /* numbers are NaN where it is not MT_FORCED_FINITE */
    int pole;          /* index of the responsible pole; else -1 */
    double value;      /* |H| [unit of H] */
    double omega;      /* frequency of the maximum [rad/s] */
    /* conj(H)/|H| there, 0 where H is 0: d value = Re(direction dH) at fixed frequency, since
     * the shift of the maximum contributes nothing */
    double complex direction;
    double excess; /* relative, see above */
    bool at_edge;  /* the maximum is an end of the range, beyond which |H| still grows */
} mt_sine_peak;

/* The peak for lower <= upper [rad/s]; where they are equal, the value there. O(n) for each of
 * some hundred intervals per resonance of the range. */
mt_sine_peak mt_sine_peak_find(const mt_frf *h, double lower, double upper);

#endif
