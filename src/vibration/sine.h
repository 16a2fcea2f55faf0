/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_SINE_H
#define VIBRATION_SINE_H

#include "vibration/panels.h"

/*
 * The largest response to a tone whose frequency lies anywhere in a range:
 *     max |H(w)|,   lower <= w <= upper.
 * It is found by branch and bound, no grid: Taylor's series about the middle of an interval,
 * with the distances of the poles for its remainder, bound |H|^2 on it; an interval whose bound
 * is not above the best value known is done, others are halved. What is left when all are done
 * is a proof: no frequency of the range has more than value (1 + excess).
 */
typedef struct mt_sine_peak {
    mt_forced_end end; /* numbers are NaN where it is not MT_FORCED_FINITE */
    int pole;          /* which then is in the way; else -1 */
    double value;      /* |H| [unit of H] */
    double omega;      /* where [rad/s] */
    double complex
        direction; /* conj(H)/|H| there, 0 where H is 0: d value = Re(direction dH), at
                                 a fixed frequency (the peak's move has no part in it) */
    double excess; /* relative, see above */
    bool at_edge;  /* of the range: the response still grows there */
} mt_sine_peak;

/* lower <= upper [rad/s]; equal: the value there. O(n) for each of some hundred intervals for
 * each resonance of the range. */
mt_sine_peak mt_sine_peak_find(const mt_frf *h, double lower, double upper);

#endif
