/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BOX_H
#define PROVE_BOX_H

#include "prove/enclosure.h"

/* Set the box lo <= x <= hi, which may exceed the bounds. False where the modes are not
 * enclosed over it: a coefficient may be negative or is not enclosed, the geometry would move,
 * or the work is interrupted. No heap. */
bool mt_enclosure_set(mt_enclosure *e, const double *lo, const double *hi);
/* An identifier of a corner, at least 0: MT_LOW of the soft one, MT_HIGH of the stiff one.
 * Where the identifiers of two nested boxes are equal, so are the corners (but for one pair in
 * 2^31, where the count at the outer corner still bounds the inner box). */
int mt_enclosure_corner_key(const mt_enclosure *e, mt_side side);
/* Bounds of the number of vibration modes below lambda [rad^2/s^2] over the box: no design has
 * more eigenvalues <= lambda than `most`, every design has at least `least` eigenvalues <
 * lambda (lambda shifted up or down by the rounding slack). Where nothing is proven: n_modes
 * and 0. No heap after the first calls; O(n^3 / 3), O(n) for chains. */
int mt_enclosure_most_below(mt_enclosure *e, double lambda);
int mt_enclosure_least_below(mt_enclosure *e, double lambda);
/* lambda of a frequency in Hz: (2 pi f)^2. */
double mt_enclosure_lambda(double hz);
/* low[n_modes], high[n_modes]: bounds of each vibration mode's frequency over the box [Hz],
 * from two eigensolves, widened by their error. */
mt_status mt_enclosure_ranges(mt_enclosure *e, double *low, double *high, mt_err *err);

#endif
