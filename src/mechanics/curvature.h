/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_CURVATURE_H
#define MECHANICS_CURVATURE_H

#include "mechanics/lagrangian.h"

/*
 * Sum of the Hessians of consecutive measures between the same two bodies (a joint's equations,
 * a bushing's directions, a beam element's strains), by relative position; it is added to the
 * Hessian of all states when the bodies change, and finally by mt_curvature_flush.
 */
typedef struct mt_curvature_sum {
    mt_lagrangian *out;
    const mt_system *sys;
    int body[2];
    bool empty;
    mt_second second;
    mt_cx h[MT_RELATIVE_PAIRS];
} mt_curvature_sum;

void mt_curvature_begin(mt_curvature_sum *s, const mt_system *sys, mt_lagrangian *out);
/* h += scale a.h + outer (a.g b.g^T + b.g a.g^T)/2; a needs its h where scale is not 0, b may
 * be NULL where outer is 0. */
void mt_curvature_add(mt_curvature_sum *s, const int body[2], const mt_relative_jet *a,
                      const mt_relative_jet *b, mt_cx scale, mt_cx outer);
void mt_curvature_flush(mt_curvature_sum *s);
/* Entry of the Hessian of all states += value; of a sparse one, the lower triangle only. */
void mt_curvature_add_entry(mt_lagrangian *out, int nq, int r, int c, double value);

#endif
