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
/* The requirement's value with its details. */
mt_status mt_forced_response_find_peak(mt_workspace *w, const mt_requirement *d,
                                       mt_forced_response_value *out, mt_err *err);
/* Discards the responses of the last solve: the configuration was solved again, or is
 * deleted. */
void mt_forced_response_close(mt_configuration_work *view);

#endif
