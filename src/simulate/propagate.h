/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_PROPAGATE_H
#define SIMULATE_PROPAGATE_H

#include "simulate/simulate.h"

/*
 * The motion of a mechanism whose equations are linear, without integration: states and inputs
 * are one linear system z' = A z, and each step is a product with exp(A h)
 * (linalg/exponential.h).
 *
 * Inputs that are polynomials and sines, piece by piece, are states. Other
 * smooth inputs are replaced in each step by a polynomial, fitted as well as rounding allows.
 */

/**
 * @param room capacity of the result's lists in samples
 * @param done false: the equations or inputs are not of this kind, or the computed motion does
 *              not satisfy the full equations; the result is then invalid
 * Fails: MT_E_MEMORY; MT_E_DOMAIN (an input has no value).
 */
mt_status mt_propagate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                       int room, mt_arena *mem, mt_sim_result *out, bool *done, mt_err *err);

#endif
