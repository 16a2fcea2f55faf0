/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_TONES_H
#define SIMULATE_TONES_H

#include "base/arena.h"

/*
 * A free motion as a sum of decaying tones,
 *     x(t) = mean + sum_k amplitude_k exp(-zeta_k w_k t) cos(2 pi hz_k t + phase_k),
 * w_k = 2 pi hz_k/sqrt(1 - zeta_k^2): identified from evenly spaced samples by the matrix
 * pencil method.
 */
typedef struct mt_tone {
    double hz;        /* damped frequency */
    double damping;   /* zeta */
    double amplitude; /* at the first sample */
    double phase;     /* [rad] at the first sample */
} mt_tone;

enum { MT_TONES_MOST = 12 };

typedef struct mt_tones {
    int n; /* strongest first; only those above 1e-3 of the strongest; 0: no vibration */
    mt_tone tone[MT_TONES_MOST];
    /* largest difference between the record and the sum of all identified exponentials,
     * relative to the largest |x - mean| */
    double residual;
} mt_tones;

/**
 * Samples x[i * stride], i < n, every dt_s seconds; tones above half the sampling rate are
 * aliased, and two tones are separated where the record is longer than their beat period. At
 * most the first 2000 samples are used. Fails: MT_E_MEMORY, MT_E_NO_CONVERGENCE. Source: Hua
 * and Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38 (1990) 814-824.
 */
mt_status mt_tones_read(int n, double dt_s, const double *x, int stride, mt_arena *scratch,
                        mt_tones *out, mt_err *err);

#endif
