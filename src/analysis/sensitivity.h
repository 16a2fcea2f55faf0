/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_SENSITIVITY_H
#define ANALYSIS_SENSITIVITY_H

#include "analysis/analysis.h"
#include "mechanics/independence.h"

/**
 * Derivatives of the frequencies of vibration modes by input p, after a solve with gradient.
 * @param[in]  position  [n] of the first n flexible modes, ascending
 * @param[out] hz_per_unit [n] Hz per unit of the input. Repeated modes have no derivatives:
 *   directional values (eigenvalues of Y^T (dK - lambda dM) Y over the
 *   cluster), ascending. NaN where there is none: at 0 Hz, and by mt_linear_independence
 * @param[out] why  the joints that cause it; names are in mem
 * Scratch from mem. Fails: as mt_linear_products and mt_linear_independence, MT_E_MEMORY.
 */
mt_status mt_analysis_sensitivity(mt_analysis *a, int p, int n, const int *position,
                                  mt_arena *mem, double *hz_per_unit, mt_independence *why,
                                  mt_err *err);

#endif
