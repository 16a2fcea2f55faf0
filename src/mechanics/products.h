/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_PRODUCTS_H
#define MECHANICS_PRODUCTS_H

#include "mechanics/eliminate.h"
#include "mechanics/linear.h"

/* After an update with gradients, before mt_linear_states_slope, mt_linear_between_slope,
 * mt_linear_contract_slope and the slopes of forcing.h: derivatives of the position, which
 * slopes of eigenvalues do without, are computed where they have not been. */
mt_status mt_linear_complete(mt_linear *lin, mt_err *err);

/* Products of K, M and sensors with shapes y in the freedoms (n x cols, column-major), and
 * their derivatives. */

/* dky = (dK_r/dp) y and dmy = (dM_r/dp) y for input p, including geometry, constraints and
 * equilibrium; n x cols. After an update with gradients. */
mt_status mt_linear_products(mt_linear *lin, int p, int cols, const double *y, double *dky,
                             double *dmy, mt_err *err);
/* dcy = (dC_r/dp) y of the dampers and dhy = (dH_r/dp) y of the loss factors, n x cols, in the
 * same moving coordinates: derivatives of s^2 M + s C + K + i H are consistent. */
mt_status mt_linear_damping_products(mt_linear *lin, int p, int cols, const double *y,
                                     double *dcy, double *dhy, mt_err *err);
/* slope[n_inputs] = y^T (dK_r/dp - lambda dM_r/dp) y for every input p and an eigenpair K_r y =
 * lambda M_r y. O(entries of the terms that depend on an input); cheaper than the products. */
mt_status mt_linear_slopes(mt_linear *lin, double lambda, const double *y, double *slope,
                           mt_err *err);
/* K with its geometric part; H of the loss factors, without the geometric part; C of the
 * dampers; M. */
typedef enum mt_linear_matrix {
    MT_MATRIX_STIFFNESS,
    MT_MATRIX_LOSS,
    MT_MATRIX_DAMPERS,
    MT_MATRIX_MASS
} mt_linear_matrix;
/* out[nq] += scale times one of them over the states times phi (nq). */
void mt_linear_states_product(const mt_linear *lin, mt_linear_matrix matrix, double scale,
                              const double *phi, double *out);
/* out[nq] += its derivative by input p, over the states, times phi, after an update with
 * gradients. */
void mt_linear_states_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                            const double *phi, double *out);
/* a^T (that derivative) b. */
double mt_linear_between_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                               const double *a, const double *b);
/* The same for a sum of products: g = sum a b^T (nq x nq). O(entries of the terms) for any
 * number of them. */
double mt_linear_contract_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                                const double *g);
/* w[nq] += (K - lambda M) phi over the states, without the geometric part of K. */
void mt_linear_rows_product(const mt_linear *lin, double lambda, const double *phi, double *w);
/* Values of channels channel[ns] for shapes y (n x cols): s ns x cols. */
mt_status mt_linear_sense(mt_linear *lin, int ns, const int *channel, int cols, const double *y,
                          double *s, mt_err *err);
/* Their derivative by input p, given dy = dy/dp (n x cols): ds ns x cols. */
mt_status mt_linear_sense_derivative(mt_linear *lin, int p, int ns, const int *channel,
                                     int cols, const double *y, const double *dy, double *ds,
                                     mt_err *err);
/* w = M Z y over all states, nq: mass-weighted shape, for correlation with shapes at other
 * designs. */
mt_status mt_linear_mass_product(mt_linear *lin, const double *y, double *w, mt_err *err);

/*
 * Equations of joints that are redundant here need not be so at other values of input p. With w
 * a left null vector of A, a dot the derivative by p and the motion that it causes,
 *     w^T c. != 0         the joints do not stay closed: the position has no derivative
 *     w^T A. Z y != 0     the motion y, free here, is blocked at any other value of p: the
 *                         number of freedoms changes, and the mode y has no derivative.
 */
typedef struct mt_independence {
    bool opens;            /* w^T c. != 0 */
    bool blocks;           /* w^T A. Z y != 0 for some motion y */
    mt_joint_names joints; /* joints of these equations */
} mt_independence;
/* After an update with gradients; names in mem. Costs nothing where no equation is redundant or
 * p moves nothing. */
mt_status mt_linear_independence(mt_linear *lin, int p, mt_arena *mem, mt_independence *out,
                                 mt_err *err);
/* blocked[cols]: true for blocked motions y (n x cols). */
mt_status mt_linear_blocked(mt_linear *lin, int p, int cols, const double *y, bool *blocked,
                            mt_err *err);

#endif
