/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_FORCED_RESPONSE_H
#define PROBLEM_FORCED_RESPONSE_H

#include "problem/workspace.h"
#include "response/response.h"
#include "vibration/profile_response.h"

/* Below this fraction of the limit, ln q is continued by its tangent (frequency.h), so
 * that a response of 0 has a value. */
#define MT_FORCED_RESPONSE_FLOOR 1e-9

/* Names of the ports: input and output. */
typedef struct mt_forced_response_pair {
    const char *input;
    const char *output;
} mt_forced_response_pair;

/*
 * Forced vibration of a configuration from one port to another, computed once per solve on
 * first use. The response is a sum over poles, and its largest value over a band is proven by
 * branch and bound (vibration/sine.h). Where no sum of simple poles exists (mt_response_poles),
 * an adaptive curve is traced instead (response/curve.h): sampled.
 */
typedef struct mt_forced_response {
    bool open;   /* computed for the last solve */
    bool summed; /* sum and frf are set; else responses are sampled */
    mt_response r;
    mt_pole_sum sum;
    mt_frf frf;
} mt_forced_response;

/* Largest |H| over a range. */
typedef struct mt_forced_response_peak {
    mt_sine_peak at;
    double by_omega; /* d|H|/dw at that frequency */
    bool proven;
} mt_forced_response_peak;

/* Value of a forced-vibration goal at a design. */
typedef struct mt_forced_response_value {
    mt_forced_end end; /* numbers are NaN unless MT_FORCED_FINITE */
    bool finite;
    const char *end_name;
    double value;
    double error; /* bound of the value's error; NaN: not known */
    double omega; /* frequency of the largest |H| [rad/s]; NaN: not known */
    bool at_edge; /* omega is an end of the searched range */
    double lower_hz;
    double upper_hz;
    bool proven; /* no frequency has a larger value; else sampled */
} mt_forced_response_value;

/* Finds the ports in a mechanism; at: address in the file, which begins the text of MT_E_INPUT.
 * Fails: MT_E_INPUT, MT_E_MEMORY. */
mt_status mt_forced_response_ports_at(const mt_system *sys, const mt_response_limit *s,
                                      const char *at, mt_arena *mem, mt_port *in, mt_port *out,
                                      mt_err *err);
/* Ports of the requirement in its configuration's mechanism. */
mt_status mt_forced_response_ports(mt_problem *p, const mt_requirement *d, mt_port *in,
                                   mt_port *out, mt_err *err);
/* Finds the requirement's ports in its configuration and checks them with a trial evaluation.
 * Fails: MT_E_INPUT, whose text begins with the address, MT_E_MEMORY. */
mt_status mt_forced_response_compile(mt_problem *p, mt_requirement *d, mt_err *err);
/* Largest response of the requirement's ports for lower <= w <= upper [rad/s], which may be
 * equal. Fails: as mt_response_open. */
mt_status mt_forced_response_find(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, mt_forced_response_peak *out, mt_err *err);
/* Response to the requirement's profile; lists valid until the next solve; *proven: as
 * mt_forced_response_peak. */
mt_status mt_forced_response_respond(mt_workspace *w, const mt_requirement *d,
                                     mt_vibration_response *out, bool *proven, mt_err *err);
/* out: by_rms d(rms) + by_sine d(sine) of that response as weighted frequencies. */
mt_status mt_forced_response_nodes(mt_workspace *w, const mt_requirement *d,
                                   const mt_vibration_response *r, double by_rms,
                                   double by_sine, mt_spectral_nodes *out, mt_err *err);
/* out[p->n] = d/dt of Re sum_i weight_i H(w_i), times `factor`. After a solve with gradient. */
mt_status mt_forced_response_slope(mt_workspace *w, const mt_requirement *d,
                                   const mt_spectral_nodes *nodes, double factor, double *out,
                                   mt_err *err);
/*
 * Guides a search away from designs with an undamped resonance that is excited, whose value is
 * infinite. Sets w->beyond, the excess over a finite value: a constant plus the least ln(w /
 * lower) or ln(upper / w) of the undamped poles in [lower, upper], and slope (unless NULL), its
 * derivative plus the effect of the damping that a variable would add.
 */
mt_status mt_forced_response_lead(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, double *slope, mt_err *err);
/* The requirement's value with its details. */
mt_status mt_forced_response_find_peak(mt_workspace *w, const mt_requirement *d,
                                       mt_forced_response_value *out, mt_err *err);
/* The same at another position of the drive: another analysis of the mechanism, solved with all
 * shapes. */
mt_status mt_forced_response_find_peak_at(mt_workspace *w, const mt_requirement *d,
                                          mt_analysis *a, mt_forced_response_value *out,
                                          mt_err *err);
/* Converts the slope of q to that of ln q as in rows (MT_MEASURE_RATIO), in place. */
void mt_forced_response_to_ln(const mt_workspace *w, const mt_requirement *d, double q,
                              double *slope);
/* Discards the responses of the last solve: the configuration was solved again, or is
 * deleted. */
void mt_forced_response_close(mt_configuration_work *view);

#endif
