/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_RESPONSE_H
#define RESPONSE_RESPONSE_H

#include "analysis/lowest_forced.h"
#include "response/curve.h"
#include "response/poles.h"
#include "response/problem.h"
#include "response/slopes.h"

/*
 * The forced response of one configuration, after a solve of its analysis with all modes and
 * vectors, and until the next one: from ports by name to curves, poles and derivatives.
 */
typedef struct mt_response_request {
    int n_in;
    const char *const *inputs;
    int n_out; /* 0: all sensors' displacements */
    const char *const *outputs;
    bool direct; /* D(s) factored at every frequency; else by modes */
    int modes;   /* so many, the others statically; 0: all */
} mt_response_request;

typedef struct mt_response {
    mt_analysis *a; /* not owned; NULL: of a large one (large.h), without derivatives */
    const mt_system *sys;
    const mt_modes *modes; /* those of a large one that are wanted, the others left out */
    int shapes;            /* of a large one: beside its modes */
    mt_arena mem;
    mt_port_set ports;
    mt_forced f;
    mt_response_ways ways;
    mt_basis basis;
    mt_transfer direct;
    const mt_transfer *chosen; /* &basis.t or &direct */
    int n_poles;
    double complex *poles;
    int growing; /* the pole that grows by itself; -1: none, the response is stationary */
} mt_response;

/* Zeroed before; mt_response_free in any case. Fails: MT_E_USAGE (a port, no sensors and no
 * outputs), as mt_response_problem, mt_basis_make, mt_response_pole_list. */
mt_status mt_response_open(mt_analysis *a, const mt_response_request *request, mt_response *out,
                           mt_err *err);
enum { MT_LARGE_WHY = 200 };
/**
 * The same of a large mechanism by its lowest modes (and so many shapes of what is left that
 * it is as good as all of them), after mt_lowest_new with shapes, and until that is deleted;
 * the errors hold what is left out. Up to `to` [rad/s], far above which the modes have to go.
 * @param[out] why  the reason where *is false
 * Fails as mt_response_open, MT_E_INTERRUPTED, MT_E_DOMAIN.
 */
mt_status mt_response_open_large(mt_lowest *l, const mt_response_request *request, double to,
                                 mt_response *out, bool *is, char why[MT_LARGE_WHY],
                                 mt_err *err);
/* Succeeds where there is a stationary response. Fails: MT_E_EQUILIBRIUM, with the pole that
 * grows. */
mt_status mt_response_admit(const mt_response *r, mt_err *err);
/* Accepts a zeroed one. */
void mt_response_free(mt_response *r);
/* opt->poles and opt->interrupt are filled in here. Results in r->mem. */
mt_status mt_response_curve(mt_response *r, const mt_curve_options *opt, mt_curve *out,
                            mt_err *err);
/* Sums over poles out[n_out x n_in], in r->mem; fails as mt_response_poles. */
mt_status mt_response_sums(mt_response *r, mt_pole_sum *out, mt_err *err);
/**
 * The slope over all inputs of the analysis of a sum over frequencies of one response,
 *     slope[p] = Re sum_i weight_i dH_oi(w_i) / dp.
 * @param[in]  out, in     which output and input
 * @param[in]  w, weight   [n]
 * @param[out] slope       [n_inputs]; NaN as there
 * What the loop over mt_response_slopes_at gives, for hardly more than the solutions at all
 * frequencies (slopes_weighted.h). Fails as mt_response_slopes, MT_E_INTERRUPTED.
 */
mt_status mt_response_weighted_slopes(mt_response *r, int out, int in, int n, const double *w,
                                      const double complex *weight, double *slope, mt_err *err);
/* dh as mt_response_slopes. */
mt_status mt_response_slopes_at(mt_response *r, double w, double complex *dh, mt_err *err);

#endif
