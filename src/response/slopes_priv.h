/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_PRIV_H
#define RESPONSE_SLOPES_PRIV_H

#include "mechanics/products.h"
#include "response/slopes.h"

/* Shared by the derivatives at one frequency and their sums over many. */

/* c_0 + c_1 s + c_2 s^2. */
typedef struct mt_slope_factor {
    double complex c[MT_FORCED_POWERS];
} mt_slope_factor;

/* Factors of the sum D over the states: K + s beta K, i H, s C, s^2 M + s alpha M. Modal
 * damping ratios are separate. */
enum { MT_SLOPE_MATRICES = 4 };
void mt_slope_matrices(const mt_analysis *a, mt_slope_factor *d);

/* f[nq] += force of an input; shift[nq]: unit motion along the axis of a base input. */
void mt_slope_push(const mt_linear *lin, const mt_port *in, double *shift, double *f);
/* e, nq x (n + 1): the motions of the n degrees of freedom, and -v[nq] (NULL: 0). Fails:
 * MT_E_MEMORY. */
mt_status mt_slope_motions(const mt_linear *lin, int nq, int n, const double *v, double *e,
                           mt_arena *mem, mt_err *err);
/* Row of a sensor's direction among the channel terms. */
int mt_slope_channel(const mt_linear *lin, const mt_port *port);
/* A part of an output other than a joint's force: factor times the motion along row. */
typedef struct mt_slope_part {
    int row;
    mt_term_kind kind;
    mt_slope_factor factor;
    mt_force_part force; /* of a spring or damper; term NULL: neither */
} mt_slope_part;
/* part[MT_FORCE_PARTS]: the parts of an output. Returns their number. */
int mt_slope_parts(const mt_analysis *a, const mt_port *port, mt_slope_part *part);
/* Derivative of a part's factor with respect to input p. */
mt_slope_factor mt_slope_turn(const mt_analysis *a, int p, const mt_slope_part *part);
/* Derivative of a node with respect to input p; 0 where there is none. */
double mt_slope_node(const mt_analysis *a, int p, mt_node node);
/* Checks that the last solve had a gradient. Fails: MT_E_INTERNAL. */
mt_status mt_slope_admit(const mt_slope_problem *p, mt_err *err);

#endif
