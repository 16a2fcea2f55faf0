/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_RESPOND_H
#define VIBRATION_RESPOND_H

#include "study/vibration.h"
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
/* Set `sine` and `peak` from the RMS and the tones. */
void mt_vibration_respond_combine(const mt_vibration *v, mt_vibration_response *r);
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

#endif
