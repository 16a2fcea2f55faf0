/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_FORCED_RESPONSE_SAMPLED_H
#define PROBLEM_FORCED_RESPONSE_SAMPLED_H

#include "response/response.h"
#include "vibration/respond.h"

/*
 * Forced vibration without a sum over poles, of the only output of an open problem for its only
 * input: adaptive curves (response/curve.h) and quadrature. Memory is r->mem. The largest value
 * has no bound: its excess is NaN.
 */
/* Largest |H| for lower <= w <= upper [rad/s], which may be equal, and d|H|/dw there. */
mt_status mt_sampled_find(mt_response *r, double lower, double upper, mt_sine_peak *out,
                          double *by_omega, mt_err *err);
mt_status mt_sampled_respond(mt_response *r, const mt_vibration *v, mt_vibration_response *out,
                             mt_err *err);
/* As mt_vibration_respond_nodes. */
mt_status mt_sampled_nodes(mt_response *r, const mt_vibration *v,
                           const mt_vibration_response *of, double by_rms, double by_sine,
                           mt_spectral_nodes *out, mt_err *err);

#endif
