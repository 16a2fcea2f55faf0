/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_EQUILIBRIUM_SLOPES_H
#define MECHANICS_EQUILIBRIUM_SLOPES_H

#include "mechanics/linear_priv.h"

/*
 * slope[p] += for all inputs of lin->forced, what a mode's eigenvalue lambda changes by beyond
 * the coefficients of K and M: by sections, by forces, and by the equilibrium that follows
 * them. phi [nq] the shape, phi^T M phi = 1; mu [lin->m] the forces of its joints, A^T mu = (K
 * - lambda M) phi. One system of the equilibrium is solved for each mode, however many inputs
 * there are. Fails: MT_E_MEMORY.
 */
mt_status mt_equilibrium_slopes(mt_linear *lin, double lambda, const double *phi,
                                const double *mu, double *slope, mt_err *err);

#endif
