/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_EQUILIBRIUM_ROUNDING_H
#define MECHANICS_EQUILIBRIUM_ROUNDING_H

#include "mechanics/linear.h"

/*
 * Error of the eigenvalue of a shape phi from rounding of the balancing forces; phi has mass 1,
 * and its joint forces mu satisfy A^T mu = (K - lambda M) phi. The eigenvalue depends on the
 * position through the rows of springs and joints, and on the forces: with the gradient g_t and
 * the Hessian H_t of a measure,
 *     d lambda = sum_t [2 k_t (g_t . phi) - 2 mu_t] phi^T H_t dq + sum_t e_t df_t,
 *         e_t = phi^T H_t phi.
 * Position and forces are those of an equilibrium: where rounding n_t of a measure makes f_t =
 * k_t (d_t + n_t), they change by dq, df_t = k_t (n_t + g_t . dq) and the joints' dlambda, such
 * that the forces balance again. By the adjoint (x, y) of those equations (newton_tangent.h)
 * for
 *     pull = sum_t [2 k_t (g_t . phi) - 2 mu_t] H_t phi + sum of springs e_t k_t g_t,
 *     across = e of the joints,
 * this is
 *     |d lambda| <= sum of springs |e_t - g_t . x| (k_t n_t + eps |f_t|)
 *                   + sum of joints |y_i| n_i + sum of bodies eps |forces| |x|,
 * the last for the sum of forces on each body. Stiff springs count as far as they can move
 * something: a spring of stiffness k with a lever r short against the size l of its bodies
 * holds them to eps l / r, and so its lever, on which r^2 k depends.
 */
typedef struct mt_equilibrium_rounding mt_equilibrium_rounding;

/* *out is NULL without loads. In the scratch of lin. */
mt_status mt_equilibrium_rounding_new(mt_linear *lin, mt_equilibrium_rounding **out,
                                      mt_err *err);
/* The bound above [rad^2/s^2 kg m^2, as phi is normalised]; phi [nq]. O(nq) where the
 * equilibrium was found sparse, otherwise O(nq^2). */
mt_status mt_equilibrium_rounding_of(mt_equilibrium_rounding *r, double lambda,
                                     const double *phi, double *noise, mt_err *err);

#endif
