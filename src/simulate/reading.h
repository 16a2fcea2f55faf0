/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_READING_H
#define SIMULATE_READING_H

#include "base/arena.h"

/* What frequencies and amplitudes a motion in time has. */

/* Where a scalar turns back. */
typedef struct mt_turning {
    double t;
    double value;
    bool highest; /* else lowest */
} mt_turning;

typedef struct mt_turnings {
    mt_turning *at; /* [n] in order of time */
    int n;
    int room;
} mt_turnings;

/* Read from the turnings of a free motion. */
typedef struct mt_ring {
    int periods;      /* between the first highest and the last one; 0: there are none */
    double hz;        /* of the mean period */
    double spread;    /* (longest - shortest period) / mean: 0 of a motion of one frequency */
    double amplitude; /* half of the first swing */
    /* share of critical damping by which the swings become less; NaN where there are fewer than
     * two */
    double damping;
} mt_ring;
mt_ring mt_ring_read(const mt_turnings *t);

enum { MT_HARMONICS = 5 };

/* A steady motion: value = mean + sum_h amplitude_h sin(2 pi h hz t + phase_h). */
typedef struct mt_steady {
    int periods; /* whole ones at the end of the record that it was read from; 0: too short */
    double mean;
    double amplitude[MT_HARMONICS];
    double phase[MT_HARMONICS]; /* [rad] */
    double residual;            /* largest difference of the record and the sum, of the largest
                                   amplitude */
} mt_steady;

/* Samples x[i * stride] at t[i]. */
typedef struct mt_samples {
    int n;
    int stride;
    const double *t; /* [s] */
    const double *x;
} mt_samples;

/* Least squares over the last whole periods of the samples, at most `periods`. Fails:
 * MT_E_MEMORY. */
mt_status mt_steady_read(const mt_samples *s, double hz, int periods, mt_arena *scratch,
                         mt_steady *out, mt_err *err);

#endif
