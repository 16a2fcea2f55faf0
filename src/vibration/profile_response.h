/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_PROFILE_RESPONSE_H
#define VIBRATION_PROFILE_RESPONSE_H

#include "environment/vibration.h"
#include "response/response.h"
#include "vibration/sine.h"
#include "vibration/spectral.h"

/* The vibration that a profile causes through a response H to the acceleration of its base. */
typedef struct mt_vibration_response {
    mt_forced_end end; /* the worst of all parts; numbers without a finite value are NaN */
    int pole;          /* index of the responsible pole; else -1 */
    double rms;        /* of the random parts together [unit of H times m/s^2] */
    double rms_bound;  /* bound of |error of rms| */
    int n_tones;
    /* [n_tones] peaks of H; the tone's level times its peak is its amplitude */
    mt_sine_peak *tones;
    double sine; /* peaks of all tones combined by the profile's rule */
    double peak; /* sigma rms + sine */
} mt_vibration_response;

/* Lists in mem. Fails: as mt_spectral_init. */
mt_status mt_vibration_respond(const mt_vibration *v, const mt_pole_sum *h, mt_arena *mem,
                               mt_vibration_response *out, mt_err *err);
/* Amplitude of the response to tone i. */
double mt_vibration_respond_tone(const mt_vibration *v, const mt_vibration_response *r, int i);
/* Density of the response to all random parts at a frequency [Hz]. */
double mt_vibration_respond_psd(const mt_vibration *v, const mt_spectral *h, double hz);

/**
 * The derivative of the combined peak: d peak = Re [sum_k (by_s_k ds_k + by_residue_k dr_k) +
 * sum_j by_d_j dd_j], conjugates on their own (as mt_spectral_slopes). By the rule "largest"
 * only the largest tone counts, the first of equal ones.
 * @param[in]  r  of the same profile and response, finite
 * @param[out] by_s, by_residue  h->n
 * @param[out] by_d              3
 */
mt_status mt_vibration_respond_slopes(const mt_vibration *v, const mt_pole_sum *h,
                                      const mt_vibration_response *r, mt_arena *mem,
                                      double complex *by_s, double complex *by_residue,
                                      double complex *by_d, mt_err *err);

/* Nodes of by_sine d sine = Re sum_i weight_i dH(w_i), one for each tone. In mem. */
mt_status mt_vibration_respond_tone_nodes(const mt_vibration *v, const mt_vibration_response *r,
                                          double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                          mt_err *err);
/* Nodes of by_rms d rms + by_sine d sine = Re sum_i weight_i dH(w_i) (as
 * mt_spectral_slope_nodes). In mem. */
mt_status mt_vibration_respond_nodes(const mt_vibration *v, const mt_pole_sum *h,
                                     const mt_vibration_response *r, double by_rms,
                                     double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                     mt_err *err);

/* The absolute acceleration of one mass on a spring and a dashpot per acceleration of their
 * base; natural frequency [Hz], damping ratio between 0 and 1. */
mt_pole_sum mt_vibration_respond_one_mass(double hz, double damping_ratio, double complex s[2],
                                          double complex residue[2]);

/*
 * The response of each output of a mechanism whose ground accelerates as a profile says, for
 * each input on its own:
 *   - By the sum over poles of the response, where there is one, as above, with proven bounds.
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
