/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_FORCED_RESPONSE_H
#define PROBLEM_FORCED_RESPONSE_H

#include "problem/workspace.h"
#include "response/response.h"
#include "vibration/respond.h"

/* Below this part of what is asked for ln q goes on as a tangent (goal_frequency.h): a response
 * that is 0 has a value. */
#define MT_FORCED_RESPONSE_FLOOR 1e-9

/* What shakes, and what is looked at, as ports are called. */
typedef struct mt_forced_response_pair {
    const char *input;
    const char *output;
} mt_forced_response_pair;

/*
 * Forced vibration of a view from one port to another, made once for each solve of it, when a
 * goal first asks. The response is a sum over poles, and its largest value over a band is
 * proven by branch and bound (vibration/sine.h). Where there is no sum of simple poles
 * (mt_response_poles), a curve that follows its shape is traced instead (response/curve.h):
 * sampled.
 */
typedef struct mt_forced_response {
    bool open;   /* of the last solve */
    bool summed; /* sum, frf; else responses are sampled */
    mt_response r;
    mt_pole_sum sum;
    mt_frf frf;
} mt_forced_response;

/* |H|, the largest over a range. */
typedef struct mt_forced_response_peak {
    mt_sine_peak at;
    double by_omega; /* d|H|/dw there */
    bool proven;
} mt_forced_response_peak;

/* What a goal finds at a design. */
typedef struct mt_forced_response_value {
    mt_forced_end end; /* numbers are NaN where it is not MT_FORCED_FINITE */
    bool finite;
    const char *end_name;
    double value;
    double error; /* of it, at most; NaN: not known */
    double omega; /* where |H| is the largest [rad/s]; NaN: not known */
    bool at_edge; /* of the range that it was looked for in */
    double lower_hz;
    double upper_hz;
    bool proven; /* no frequency has more; else sampled */
} mt_forced_response_value;

/* The ports as a mechanism has them; at: where a file says them. Fails: MT_E_INPUT, which
 * begins with that, MT_E_MEMORY. */
mt_status mt_forced_response_ports_at(const mt_system *sys, const mt_response_limit *s,
                                      const char *at, mt_arena *mem, mt_port *in, mt_port *out,
                                      mt_err *err);
/* Those of the requirement, of its view's mechanism. */
mt_status mt_forced_response_ports(mt_problem *p, const mt_requirement *d, mt_port *in,
                                   mt_port *out, mt_err *err);
/* Look up the requirement's ports in its view, and try them there. Fails: MT_E_INPUT, which
 * begins with the address, MT_E_MEMORY. */
mt_status mt_forced_response_compile(mt_problem *p, mt_requirement *d, mt_err *err);
/* The largest response of the requirement's ports from lower to upper [rad/s], which may be
 * equal. Fails: as mt_response_open. */
mt_status mt_forced_response_find(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, mt_forced_response_peak *out, mt_err *err);
/* What the requirement's profile does, lists until the next solve; *proven: as
 * mt_forced_response_peak. */
mt_status mt_forced_response_respond(mt_workspace *w, const mt_requirement *d,
                                     mt_vibration_response *out, bool *proven, mt_err *err);
/* by_rms d rms + by_sine d sine of it as nodes. */
mt_status mt_forced_response_nodes(mt_workspace *w, const mt_requirement *d,
                                   const mt_vibration_response *r, double by_rms,
                                   double by_sine, mt_spectral_nodes *out, mt_err *err);
/* out[p->n] = d/dt of Re sum_i weight_i H(w_i), times `factor`. After a solve with gradient. */
mt_status mt_forced_response_slope(mt_workspace *w, const mt_requirement *d,
                                   const mt_spectral_nodes *nodes, double factor, double *out,
                                   mt_err *err);
/*
 * No number is finite where nothing damps a resonance that is shaken. A search is led away from
 * that by the way that the undamped poles have to go: w->beyond is the least ln of a pole's
 * distance from an end of [lower, upper], added to what any finite number is off by, and slope
 * (unless NULL) its slope, with that of the damping that a variable would bring.
 */
mt_status mt_forced_response_lead(mt_workspace *w, const mt_requirement *d, double lower,
                                  double upper, double *slope, mt_err *err);
/* The requirement's number, with all that is known of it. */
mt_status mt_forced_response_find_peak(mt_workspace *w, const mt_requirement *d,
                                       mt_forced_response_value *out, mt_err *err);
/* The same of another analysis of the view's mechanism, solved with all shapes: another
 * position of its drive. */
mt_status mt_forced_response_find_peak_at(mt_workspace *w, const mt_requirement *d,
                                          mt_analysis *a, mt_forced_response_value *out,
                                          mt_err *err);
/* slope of q to that of ln q as rows take it (MT_MEASURE_RATIO), in place. */
void mt_forced_response_to_ln(const mt_workspace *w, const mt_requirement *d, double q,
                              double *slope);
/* The view has been solved anew, or goes. */
void mt_forced_response_close(mt_configuration_work *view);

#endif
