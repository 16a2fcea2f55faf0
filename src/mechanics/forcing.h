/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_FORCING_H
#define MECHANICS_FORCING_H

#include "mechanics/linear.h"
#include "mechanics/products.h"

/*
 * Forces and their transmission through the joints of a linearised system, over all its states
 * q (nq). The equations of motion with the forces lambda of the joints' equations are
 *     M q'' + C q' + K q + A^T lambda = f,    A q = 0.
 * After an update.
 */

/*
 * Force of a joint along a global axis, of the first body on the second, as a function of f and
 * q. Its coefficients t in the equations are A v for a motion v, so that
 *     force = v . (M q'' + C q' + K q - f) - geometric . q
 * for any lambda; the second term is the static force of a loaded joint that turns with its
 * bodies.
 */
typedef struct mt_joint_force {
    const double *v;         /* [nq] */
    const double *t;         /* [m] coefficients of the equations */
    const double *geometric; /* [nq]; NULL: no static force */
} mt_joint_force;

/* Results in mem. *unique false: the joint is redundant along this axis, and its force is not
 * determined. Fails: MT_E_USAGE (a coupling of joints, which has no bodies), MT_E_MEMORY. */
mt_status mt_linear_joint_force(mt_linear *lin, int joint, int axis, mt_arena *mem,
                                mt_joint_force *out, bool *unique, mt_err *err);
/* r[nq] := translation of every body by 1 along a global axis. */
void mt_linear_shift(const mt_linear *lin, int axis, double *r);
/*
 * Force on the states of a ground that accelerates by 1 along a global axis, the states being
 * relative to it: f[nq] += -(M r + M_g r_g), r the translation of all bodies, M_g what masses
 * between a body and the ground (bars) have there. reduced[n] += Z^T of it (NULL: not wanted);
 * what the joints block is no more than rounding there, and left out.
 */
void mt_linear_base_force(const mt_linear *lin, int axis, double *f, double *reduced);
/* e . (its derivative by input p), after an update with gradients. */
double mt_linear_base_slope(const mt_linear *lin, int p, int axis, const double *e);
/* out[n] := Z^T w. */
void mt_linear_project(const mt_linear *lin, const double *w, double *out);
/* Row i of a term's rows over the states, times phi (nq). */
double mt_linear_row_dot(const mt_linear *lin, mt_term_kind kind, int row, const double *phi);
/* out[nq] += factor times the row. */
void mt_linear_row_add(const mt_linear *lin, mt_term_kind kind, int row, double factor,
                       double *out);

/* Derivatives by input p, after an update with gradients. */
/* Of the row at fixed phi: its own motion. */
double mt_linear_row_dot_slope(const mt_linear *lin, int p, mt_term_kind kind, int row,
                               const double *phi);
/* out[m] = (dA/dp) phi. */
void mt_linear_jacobian_slope(const mt_linear *lin, int p, const double *phi, double *out);
/* Sum of lambda (m x nq) times dA/dp over all entries. */
double mt_linear_jacobian_contract(const mt_linear *lin, int p, const double *lambda);
/* lambda[m]: least-squares solution of A^T lambda = w. */
mt_status mt_linear_multipliers(mt_linear *lin, const double *w, double *lambda, mt_err *err);
/* out[nq] := derivative of the joint's `geometric`; 0 without loads. */
mt_status mt_linear_joint_geometric_slope(mt_linear *lin, int p, int joint, int axis,
                                          double *out, mt_err *err);
/* Sum over the joint's equations of lambda times the derivative of t. */
double mt_linear_joint_slope(const mt_linear *lin, int p, int joint, int axis,
                             const double *lambda);

/*
 * Directions of a mechanism at the position of the last update: for each distance between two
 * points (axial springs, dampers, bars) its unit vector and the logarithm of its length, for
 * each body the axes of its frame, for each joint angle its whole turns. Apart from positions
 * of points, K, C and M depend on these alone: a spring whose ends pass each other closely
 * turns by half a turn while its stiffness comes and goes.
 */
int mt_directions_count(const mt_system *sys);
/* out[mt_directions_count]. */
void mt_directions_read(const mt_linear *lin, double *out);
/* Largest difference of any of them between two positions, as an angle [rad]. */
double mt_directions_turn(const mt_system *sys, const double *a, const double *b);

#endif
