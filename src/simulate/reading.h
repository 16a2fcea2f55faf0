/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_READING_H
#define SIMULATE_READING_H

#include "base/arena.h"

/* Frequencies and amplitudes of a motion in time. */

/* A local maximum or minimum of a scalar in time. */
typedef struct mt_turning {
    double t;
    double value;
    bool highest; /* a maximum; else a minimum */
} mt_turning;

typedef struct mt_turnings {
    mt_turning *at; /* [n] in order of time */
    int n;
    int room;
} mt_turnings;

/* The frequency and damping of a free motion, from its turning points. */
typedef struct mt_ring {
    int periods;      /* periods between the first and the last maximum; 0: none */
    double hz;        /* frequency of the mean period */
    double spread;    /* (longest - shortest period) / mean: 0 for a single frequency */
    double amplitude; /* half of the first swing */
    /* damping ratio from the decrease of the swings; NaN for fewer than two */
    double damping;
} mt_ring;
mt_ring mt_ring_read(const mt_turnings *t);

enum { MT_HARMONICS = 5 };

/* A steady motion: value = mean + sum_h amplitude_h sin(2 pi h hz t + phase_h). */
typedef struct mt_steady {
    int periods; /* whole periods at the end of the record that were used; 0: too short */
    double mean;
    double amplitude[MT_HARMONICS];
    double phase[MT_HARMONICS]; /* [rad] */
    /* largest difference of the record and the sum, relative to the largest amplitude */
    double residual;
} mt_steady;

/* The samples x[i * stride] at t[i]. */
typedef struct mt_samples {
    int n;
    int stride;
    const double *t; /* [s] */
    const double *x;
} mt_samples;

/* Fit a steady motion by least squares to the last whole periods of the samples, at most
 * `periods`. Fails: MT_E_MEMORY. */
mt_status mt_steady_read(const mt_samples *s, double hz, int periods, mt_arena *scratch,
                         mt_steady *out, mt_err *err);

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
