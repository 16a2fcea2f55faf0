/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MEASURE_PRIV_H
#define MECHANICS_MEASURE_PRIV_H

#include "mechanics/measure.h"

/* What the files measure*.c share. Vectors named u, v, w, s, t, d have been rotated already. */

/* f(p, q) and its partial derivatives. */
typedef struct mt_chain2 {
    mt_cx f;
    mt_cx fp;
    mt_cx fq;
    mt_cx fpp;
    mt_cx fpq;
    mt_cx fqq;
} mt_chain2;

/* The local freedoms of which a Hessian is filled. */
typedef struct mt_jet_list {
    int n;
    int at[MT_LOCAL];
} mt_jet_list;
const mt_jet_list *mt_jet_filled(mt_second second);

void mt_jet_clear(mt_jet *j, mt_second second);
/* g[0..2] += scale v. */
void mt_jet_add_vec(mt_cx *g, mt_cx scale, const mt_cx *v);
/* Diagonal block, theta at `at`, of scale n . w (w turns): scale [1/2 (n w^T + w n^T) - (n . w)
 * I]. */
void mt_jet_add_rotation_block(mt_jet *j, int at, mt_cx scale, const mt_cx *n, const mt_cx *w);
/* Block (theta at p, dx at q) of scale (theta x u) . dx = scale theta . (u x dx): scale [u]x,
 * and its transpose. */
void mt_jet_add_cross_block(mt_jet *j, int p, int q, mt_cx scale, const mt_cx *u);
/* out = f(p, q); out is neither. */
void mt_jet_chain(const mt_chain2 *c, const mt_jet *p, const mt_jet *q, mt_jet *out);
/* |d + t - s|. */
void mt_jet_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, mt_second second,
                     mt_jet *out);
/* Component k of the rotation vector from triad e (on a) to triad f (on b). */
void mt_jet_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k, mt_second second, mt_jet *out);
/* Twist from triad e (on a) to triad f (on b): the turn about e1 that is left when the shortest
 * turn from e1 to f1 has been taken off. */
void mt_jet_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, mt_jet *out);
/* g(c) = acos(c)/sqrt(1 - c^2), g', g''. */
void mt_angle_over_sine(mt_cx c, mt_cx g[3]);
/* The parts of the beam element with triads e (on a), f (on b) and d = x_b - x_a; and its
 * strain m->component. out is cleared. */
void mt_jet_beam_parts(const mt_measure_data *m, mt_cx (*e)[3], mt_cx (*f)[3], const mt_cx *d,
                       mt_second second, mt_beam_parts *out);
void mt_jet_beam(const mt_measure_data *m, const mt_beam_parts *p, mt_jet *out);

#endif
