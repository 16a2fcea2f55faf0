/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_RESPONSE_H
#define RESPONSE_RESPONSE_H

#include "analysis/lowest.h"
#include "response/curve.h"
#include "response/poles.h"
#include "response/problem.h"
#include "response/slopes.h"
#include "response/state_space.h"

/*
 * The forced response of one configuration: from ports by name to curves, poles and
 * derivatives. Valid from a solve of its analysis with all modes and vectors to the next solve.
 */
typedef struct mt_response_request {
    int n_in;
    const char *const *inputs;
    int n_out; /* 0: all sensors' displacements */
    const char *const *outputs;
    bool direct; /* factor D(s) at every frequency; else use modes */
    int modes;   /* modes kept, the others statically; 0: all */
} mt_response_request;

typedef struct mt_response {
    /* not owned; NULL for a large mechanism (large.h), which has no derivatives */
    mt_analysis *a;
    const mt_system *sys;
    const mt_modes *modes; /* of a large mechanism: the wanted ones only */
    int shapes;            /* of a large mechanism: coordinates besides its modes */
    mt_arena mem;
    mt_port_set ports;
    mt_forced f;
    mt_response_ways ways;
    mt_basis basis;
    mt_transfer direct;
    const mt_transfer *chosen; /* &basis.t or &direct */
    int n_poles;
    double complex *poles;
    int growing; /* the pole that grows by itself; -1: none, a steady response exists */
} mt_response;

/* *out zeroed before; call mt_response_free in any case. Fails: MT_E_USAGE (a port; neither
 * sensors nor outputs), as mt_response_problem, mt_basis_make, mt_response_pole_list. */
mt_status mt_response_open(mt_analysis *a, const mt_response_request *request, mt_response *out,
                           mt_err *err);
enum { MT_LARGE_WHY = 200 };
/**
 * mt_response_open for a large mechanism, from its lowest modes and enough further shapes for
 * the accuracy of all modes. Valid after mt_lowest_new with shapes until its deletion; the
 * errors include what is left out. For frequencies up to `to` [rad/s]; the modes must reach far
 * above it.
 * @param[out] why  the reason where *is is false
 * Fails: as mt_response_open, MT_E_INTERRUPTED, MT_E_DOMAIN.
 */
mt_status mt_response_open_large(mt_lowest *l, const mt_response_request *request, double to,
                                 mt_response *out, bool *is, char why[MT_LARGE_WHY],
                                 mt_err *err);
/* Succeeds where a steady response exists. Fails: MT_E_EQUILIBRIUM, naming the pole that
 * grows. */
mt_status mt_response_admit(const mt_response *r, mt_err *err);
/* Accepts a zeroed response. */
void mt_response_free(mt_response *r);
/* Traces the curve with opt; its poles and interrupt are set here. Results in r->mem. */
mt_status mt_response_curve(mt_response *r, const mt_curve_options *opt, mt_curve *out,
                            mt_err *err);
/* State space of the lowest `modes` modes (0: of those up to `to` [rad/s]), in r->mem; an error
 * names the port. Fails: as mt_state_space_make. */
mt_status mt_response_state_space(mt_response *r, int modes, double to, mt_state_space *out,
                                  mt_err *err);
/* Pole sums out[n_out x n_in], in r->mem; fails as mt_response_poles. */
mt_status mt_response_sums(mt_response *r, mt_pole_sum *out, mt_err *err);
/**
 * Gradient over all inputs p of the analysis of a weighted sum over frequencies of one
 * response,
 *     slope[p] = Re sum_i weight_i dH_oi(w_i) / dp.
 * @param[in]  out, in     output o and input i
 * @param[in]  w, weight   [n]
 * @param[out] slope       [n_inputs]; NaN as mt_response_slopes_at
 * Equal to the sum over mt_response_slopes_at, for little more than the cost of the solutions
 * at all frequencies (slopes_weighted.h). Fails: as mt_response_slopes, MT_E_INTERRUPTED.
 */
mt_status mt_response_weighted_slopes(mt_response *r, int out, int in, int n, const double *w,
                                      const double complex *weight, double *slope, mt_err *err);
/* dh at w [rad/s], as mt_response_slopes. */
mt_status mt_response_slopes_at(mt_response *r, double w, double complex *dh, mt_err *err);

#endif
