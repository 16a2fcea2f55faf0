/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_SLOPES_WEIGHTED_H
#define RESPONSE_SLOPES_WEIGHTED_H

#include "response/slopes.h"

/* A weighted sum over frequencies of one response. */
typedef struct mt_slope_weights {
    int out;
    int in;
    int n;
    const double *w;              /* [n], > 0 [rad/s] */
    const double complex *weight; /* [n] */
} mt_slope_weights;

/**
 * slope[n_inputs] = Re sum_i weight_i dH_{out, in}(w_i)/d(input), equal to the weighted sum of
 * mt_response_slopes, with one contraction of the derivatives for all frequencies.
 * O(frequencies n^2) (n^3 where damping couples modes), and once O(n^3 + entries of the terms
 * n_inputs). Fails as mt_response_slopes, MT_E_INTERRUPTED.
 */
mt_status mt_response_slopes_weighted(const mt_slope_problem *p, const mt_slope_weights *q,
                                      double *slope, mt_arena *scratch, mt_err *err);

#endif
