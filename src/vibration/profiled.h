/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_PROFILED_H
#define VIBRATION_PROFILED_H

#include "response/response.h"
#include "vibration/respond.h"

/*
 * A mechanism whose ground accelerates as a profile says: what that does to each output of a
 * response, each input on its own.
 *   - By the sum over poles of the response, where there is one: respond.h, with proven bounds.
 *   - Where there is none (poles that are nearly double, a displacement that grows like 1/s^2),
 *     by quadrature over its values: the RMS by Gauss's rule on panels that are as narrow as
 *     the poles, every panel once more as two halves; tones by the extremes of its curve. An
 *     error is then an estimate, what halving has changed and what rounding may have, and the
 *     peaks of tones have no proof: their excess is NaN.
 */
typedef struct mt_profiled {
    const mt_vibration *v;
    const char *no_sums; /* why it is by quadrature; NULL: it is by poles */
    int n_pairs;
    mt_vibration_response *answers; /* [n_pairs] output + n_out input; `pole` is in `poles` */
    mt_spectral *of;                /* [n_pairs] by poles; NULL */
    int n_poles;
    const double complex *poles; /* [n_poles] [rad/s] */
} mt_profiled;

/* The ports that are meant where a request names none: the ground along the profile's axis, the
 * accelerations of all sensors. Names in mem. Fails: MT_E_USAGE (no such axis), MT_E_MEMORY. */
mt_status mt_profiled_ports(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err);
/* MT_E_USAGE where a port is no acceleration of the ground, of which profiles are. */
mt_status mt_profiled_input(const mt_port *port, mt_err *err);
/* Inputs are accelerations of the ground, or MT_E_USAGE. Results in r->mem. Fails also:
 * MT_E_NO_CONVERGENCE, MT_E_DOMAIN, MT_E_INTERRUPTED, MT_E_MEMORY. */
mt_status mt_profiled_find(mt_response *r, const mt_vibration *v, mt_profiled *out,
                           mt_err *err);
/* Density of a pair's response at a frequency [Hz], whose value there is h. */
double mt_profiled_psd(const mt_profiled *s, int pair, double hz, double complex h);

#endif
