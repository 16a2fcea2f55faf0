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

#endif
