/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ENERGY_H
#define MECHANICS_ENERGY_H

#include "mechanics/linear.h"

/*
 * Energies of shapes, summed term by term over the rows before the constraints are eliminated,
 * phi = Z y:
 *     y^T K y = sum_t c_t (f_t . phi)^2 + phi^T Kg phi,
 *         y^T M y = sum_t m_t sum_i (f_ti . phi)^2.
 * Where a spring hardly takes part in a mode, its elongation f . phi is small before it is
 * squared: no stiff spring costs the soft ones their digits, as it does where both are entries
 * of one matrix.
 *
 * Noise. An entry of phi is known to p eps (|phi_j| + a typical entry of phi), w_j below, hence
 *     p eps (sum_t 2 c_t |f_t . phi| |f_t| . w + 2 |phi|^T (terms of |Kg|) w):
 * terms count with their magnitudes, before they cancel. Positions satisfy the constraints to
 * eps; by the least pivot kept of their Jacobian, positions and shapes are known to eps / kept.
 *
 * Errors of the reduced rows Z^T f are in every solution with K_r and M_r: by bounds dz of the
 * basis and df of the rows (linear.h) an elongation f . phi is known to
 *     D = |f| . (dz |y|) + df . |phi|,   an energy to c (2 |f . phi| D + D^2),
 * which matters where constraints are almost dependent, or a spring acts almost across the
 * remaining motion.
 *
 * At an equilibrium, Newton's last step q is below the rounding of positions and is not taken,
 * but it changes the force of a stiff spring: forces are those at its end, which differ by k g
 * . q (springs) and lambda' = -(A^T)^+ (r + H q) (joints, r the unbalanced force) from those at
 * the position. For the rounding of equilibrium position and forces see below.
 *
 * A spring is strained where its energy is more than 16 nq eps c (|f| . w)^2, the rounding of
 * its own terms.
 */
typedef struct mt_energies {
    double *stiffness;       /* [cols] */
    double *mass;            /* [cols] */
    double *stiffness_noise; /* [cols] */
    double *mass_noise;      /* [cols] */
    /* [cols] the part of stiffness_noise and lambda mass_noise that is already in the entries
     * of K_r and M_r */
    double *given_noise;
    bool *strained; /* [cols] by any spring */
} mt_energies;

/* y n x cols. O(cols (rows + entries of Kg + nq n)). Fails MT_E_MEMORY. */
mt_status mt_linear_energies(mt_linear *lin, int cols, const double *y, const mt_energies *out,
                             mt_err *err);

#endif
