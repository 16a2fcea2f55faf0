/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_H
#define RESPONSE_SLOPES_H

#include "response/basis.h"
#include "response/problem.h"

/* Ports of a problem and the basis of all modes that solves it. */
typedef struct mt_slope_problem {
    mt_analysis *a; /* its last solve had a gradient */
    const mt_basis *basis;
    const mt_port_set *ports;
    const mt_response_ways *ways;
} mt_slope_problem;

/**
 * Exact derivatives of all responses with respect to all inputs of the analysis, at w [rad/s].
 * @param[out] dh  n_out x n_in x n_inputs, column-major [unit of H per unit of the input]; NaN
 *   where no derivative exists: at an undamped resonance, and where joints that are redundant
 *   at this value only would block a motion or come apart at neighbouring values
 * O(n^3 + pairs n_inputs entries of the terms). Fails: MT_E_INTERNAL (no gradient),
 * MT_E_MEMORY.
 */
mt_status mt_response_slopes(const mt_slope_problem *p, double w, double complex *dh,
                             mt_arena *scratch, mt_err *err);

#endif
