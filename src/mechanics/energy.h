/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ENERGY_H
#define MECHANICS_ENERGY_H

#include "mechanics/linear.h"

/*
 * Energies of shapes, summed term by term over the rows as they are before the constraints are
 * eliminated, phi = Z y:
 *     y^T K y = sum_t c_t (f_t . phi)^2 + phi^T Kg phi,
 *         y^T M y = sum_t m_t sum_i (f_ti . phi)^2.
 * Where a spring hardly takes part in a mode, its elongation f . phi is small before it is
 * squared: no stiff spring costs the soft ones their digits, as it does where both are entries
 * of one matrix.
 *
 * Noise. An entry of phi is known to p eps (|phi_j| + what is typical of phi), w_j below,
 * whence
 *     p eps (sum_t 2 c_t |f_t . phi| |f_t| . w + 2 |phi|^T (terms of |Kg|) w):
 * terms count with their magnitudes, before they cancel. Positions satisfy the constraints to
 * eps; by the least pivot kept of their Jacobian, positions and shapes are known to eps / kept.
 *     What any solution with K_r and M_r has wrong, however exact, is what their rows Z^T f
 * have: by bounds dz of the basis and df of the rows (reduce.h) an elongation f . phi is open
 * by
 *     D = |f| . (dz |y|) + df . |phi|,   an energy by c (2 |f . phi| D + D^2),
 * which counts where constraints almost depend on each other, or a spring acts almost across
 * the motion that is left.
 *     At an equilibrium Newton's last step q is too small to be taken, as positions are
 * rounded, but not too small for a stiff spring: forces are those at its end, by k g . q
 * (springs) and lambda' = -(A^T)^+ (r + H q) (joints, r what is unbalanced) others than at the
 * position. What rounding leaves open of place and forces is in equilibrium_rounding.h.
 *     A spring is strained where its energy is more than 16 nq eps c (|f| . w)^2, the
 * rounding of its own terms.
 */
typedef struct mt_energies {
    double *stiffness;       /* [cols] */
    double *mass;            /* [cols] */
    double *stiffness_noise; /* [cols] */
    double *mass_noise;      /* [cols] */
    double *given_noise; /* [cols] the part of stiffness_noise and lambda mass_noise that is in
                                K_r and M_r as they are given */
    bool *strained;      /* [cols] by any spring */
} mt_energies;

/* y n x cols. O(cols (rows + entries of Kg + nq n)). Fails MT_E_MEMORY. */
mt_status mt_linear_energies(mt_linear *lin, int cols, const double *y, const mt_energies *out,
                             mt_err *err);

#endif
