/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_PRIV_H
#define RESPONSE_SLOPES_PRIV_H

#include "mechanics/products.h"
#include "response/slopes.h"

/* What slopes at one frequency and sums of them over many share. */

/* c_0 + c_1 s + c_2 s^2. */
typedef struct mt_slope_factor {
    double complex c[MT_FORCED_POWERS];
} mt_slope_factor;

/* D over the states as a sum, with its factors: K + s beta K, i H, s C, s^2 M + s alpha M.
 * Modal ratios stand apart. */
enum { MT_SLOPE_MATRICES = 4 };
void mt_slope_matrices(const mt_analysis *a, mt_slope_factor *d);

/* f[nq] += what an input pushes with; shift[nq]: along the axis of a base, to which it goes. */
void mt_slope_push(const mt_linear *lin, const mt_port *in, double *shift, double *f);
/* e, nq x (n + 1): the motions of the n freedoms, and minus v[nq] (NULL: 0). Fails:
 * MT_E_MEMORY. */
mt_status mt_slope_motions(const mt_linear *lin, int nq, int n, const double *v, double *e,
                           mt_arena *mem, mt_err *err);
/* Row of a sensor's direction, of the terms of channels. */
int mt_slope_channel(const mt_linear *lin, const mt_port *port);
/* An output that is no joint's force, as a sum of rows: factor times the motion along row. */
typedef struct mt_slope_part {
    int row;
    mt_term_kind kind;
    mt_slope_factor factor;
    mt_force_part force; /* of a spring or damper; term NULL: none */
} mt_slope_part;
/* How many parts there are; part[MT_FORCE_PARTS]. */
int mt_slope_parts(const mt_analysis *a, const mt_port *port, mt_slope_part *part);
/* Derivative of a part's factor with respect to input p. */
mt_slope_factor mt_slope_turn(const mt_analysis *a, int p, const mt_slope_part *part);
/* Derivative of a number that may not be there: then 0. */
double mt_slope_node(const mt_analysis *a, int p, mt_node node);
/* Fails: MT_E_INTERNAL (no gradient). */
mt_status mt_slope_admit(const mt_slope_problem *p, mt_err *err);

#endif
