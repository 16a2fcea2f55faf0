/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MEASURE_PRIV_H
#define MECHANICS_MEASURE_PRIV_H

#include "mechanics/measure.h"

/* Shared by the files measure*.c. Vectors named u, v, w, s, t, d are rotated already. */

/* f(p, q) and its partial derivatives. */
typedef struct mt_chain2 {
    mt_cx f;
    mt_cx fp;
    mt_cx fq;
    mt_cx fpp;
    mt_cx fpq;
    mt_cx fqq;
} mt_chain2;

/* First of the three freedoms of each among the nine, and their bits in a span. */
enum { MT_AT_CHORD = 0, MT_AT_TURN_A = 3, MT_AT_TURN_B = 6 };
enum {
    MT_SPAN_CHORD = 1,
    MT_SPAN_TURN_A = 2,
    MT_SPAN_TURN_B = 4,
    MT_SPAN_TURNS = MT_SPAN_TURN_A | MT_SPAN_TURN_B,
    MT_SPAN_ALL = MT_SPAN_CHORD | MT_SPAN_TURNS
};

/* real: nothing that is added has a derivative. */
void mt_relative_clear(mt_relative_jet *j, mt_second second, unsigned span, bool real);
/* g[0..2] += scale v. */
void mt_relative_add_vec(mt_cx *g, double scale, const mt_cx *v);
/* Diagonal block at theta offset `at` of scale n . w (w rotates): scale [1/2 (n w^T + w n^T) -
 * (n . w) I]. */
void mt_relative_add_rotation(mt_relative_jet *j, int at, double scale, const mt_cx *n,
                              const mt_cx *w);
/* Block (theta at offset `at`, dd) of (theta x u) . dd = theta . (u x dd): [u]x. */
void mt_relative_add_cross(mt_relative_jet *j, int at, const mt_cx *u);
/* out += scale p. */
void mt_relative_add(mt_relative_jet *out, double scale, const mt_relative_jet *p);
/* out += scale p q. */
void mt_relative_add_product(mt_relative_jet *out, mt_cx scale, const mt_relative_jet *p,
                             const mt_relative_jet *q);
/* out = f(p, q); out must differ from p and q. */
void mt_relative_chain(const mt_chain2 *c, const mt_relative_jet *p, const mt_relative_jet *q,
                       mt_relative_jet *out);

/* |d + t - s|; s and t NULL: |d|. */
void mt_relative_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, mt_second second,
                          bool real, mt_relative_jet *out);
/* Cosine of the angle of the rotation from triad e (on a) to triad f (on b), (trace - 1)/2, and
 * g of it. */
void mt_relative_cosine(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real, mt_cx g[3],
                        mt_relative_jet *out);
/* Component k of the rotation vector of that rotation. */
void mt_relative_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k, const mt_relative_jet *cosine,
                          const mt_cx g[3], mt_relative_jet *out);
/* Twist from triad e (on a) to triad f (on b): the rotation about e1 that remains after the
 * shortest rotation from e1 to f1. */
void mt_relative_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real,
                       mt_relative_jet *out);
/* g(c) = acos(c)/sqrt(1 - c^2), g', g''. */
void mt_angle_over_sine(mt_cx c, mt_cx g[3]);
/* Fill the parts of the beam element with triads e (on a), f (on b) and d = x_b - x_a; compute
 * its strain m->component. */
void mt_beam_parts_fill(const mt_measure_data *m, mt_cx (*e)[3], mt_cx (*f)[3], const mt_cx *d,
                        mt_second second, bool real, mt_beam_parts *out);
void mt_beam_strain_fill(const mt_measure_data *m, const mt_beam_parts *p,
                         mt_relative_jet *out);

#endif
