/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BOX_H
#define PROVE_BOX_H

#include "prove/enclosure.h"

/* Set the box lo <= x <= hi; it may leave the bounds. False where nothing is known over it: a
 * coefficient may be negative or is not enclosed, the geometry would move, or the work is
 * interrupted. No heap. */
bool mt_enclosure_set(mt_enclosure *e, const double *lo, const double *hi);
/* A number that tells corners apart: MT_LOW the soft one, MT_HIGH the stiff one. Where those of
 * two boxes, one in the other, are equal, the corners are (but for one pair in 2^31: then what
 * was counted at the outer one still bounds what the inner one has). At least 0. */
int mt_enclosure_corner_key(const mt_enclosure *e, mt_side side);
/* Note which stiffnesses are positive all over the box that is set; and whether they are so all
 * over the one that is set later. Where one is not, a design of that box may have one more
 * rigid-body mode. */
void mt_enclosure_note_held(mt_enclosure *e);
bool mt_enclosure_keeps_held(const mt_enclosure *e);
/* The most and the fewest vibration modes below lambda [rad^2/s^2] that a design of the box may
 * have: at no design are there more with eigenvalue <= lambda than most, at every design there
 * are at least `least` with eigenvalue < lambda (lambda counted up or down by the slack of
 * rounding). In doubt: n_modes and 0. No heap after the first calls; O(n^3 / 3), O(n) for
 * chains. */
int mt_enclosure_most_below(mt_enclosure *e, double lambda);
int mt_enclosure_least_below(mt_enclosure *e, double lambda);
/* lambda of a frequency in Hz: (2 pi f)^2. */
double mt_enclosure_lambda(double hz);
/* low[n_modes], high[n_modes]: what each vibration mode's frequency can be in the box [Hz], by
 * two eigensolves, widened by their error. */
mt_status mt_enclosure_ranges(mt_enclosure *e, double *low, double *high, mt_err *err);

#endif
