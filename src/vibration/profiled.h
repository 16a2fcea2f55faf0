/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_PROFILED_H
#define VIBRATION_PROFILED_H

#include "response/response.h"
#include "vibration/respond.h"

/*
 * The response of each output of a mechanism whose ground accelerates as a profile says, for
 * each input on its own:
 *   - By the sum over poles of the response, where there is one: respond.h, with proven bounds.
 *   - Where there is none (poles that are nearly double, a displacement that grows like 1/s^2),
 *     by quadrature over its values: the RMS by Gauss's rule on panels that are as narrow as
 *     the poles, every panel also as two halves; tones by the extremes of its curve. The error
 *     is then an estimate (the change by halving plus rounding), and the peaks of tones are not
 *     proven: their excess is NaN.
 */
typedef struct mt_profiled {
    const mt_vibration *v;
    const char *no_sums; /* reason for quadrature; NULL: by poles */
    int n_pairs;
    /* [n_pairs] at output + n_out input; `pole` indexes `poles` */
    mt_vibration_response *answers;
    mt_spectral *of; /* [n_pairs] by poles; NULL by quadrature */
    int n_poles;
    const double complex *poles; /* [n_poles] [rad/s] */
} mt_profiled;

/* The default ports of a request that names none: the ground along the profile's axis as input,
 * the accelerations of all sensors as outputs. Names in mem. Fails: MT_E_USAGE (no such axis),
 * MT_E_MEMORY. */
mt_status mt_profiled_ports(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err);
/* Fails with MT_E_USAGE where a port is not an acceleration of the ground, the only input of a
 * profile. */
mt_status mt_profiled_input(const mt_port *port, mt_err *err);
/* Find the responses of all pairs to the profile. Results in r->mem. Fails: MT_E_USAGE (an
 * input is not an acceleration of the ground), MT_E_NO_CONVERGENCE, MT_E_DOMAIN,
 * MT_E_INTERRUPTED, MT_E_MEMORY. */
mt_status mt_profiled_find(mt_response *r, const mt_vibration *v, mt_profiled *out,
                           mt_err *err);
/* Density of a pair's response at a frequency [Hz]; h is the pair's response there. */
double mt_profiled_psd(const mt_profiled *s, int pair, double hz, double complex h);

#endif
