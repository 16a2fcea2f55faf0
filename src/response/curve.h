/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_CURVE_H
#define RESPONSE_CURVE_H

#include "base/run.h"
#include "response/transfer.h"

/*
 * A frequency response on an adaptive grid: the grid of the caller, points about every pole
 * within its width, and bisection until log |H| of every pair is linear between neighbouring
 * points to about 1 % of |H|. Peaks and antiresonances, found from the exact slope, are points
 * too.
 */
typedef struct mt_curve_options {
    double from; /* [rad/s] > 0 */
    double to;   /* > from */
    int points;  /* of the caller's grid, both ends included; at least 2 */
    bool log;    /* grid and interpolation over log w; else over w */
    bool grid;   /* no refinement: the grid alone, and the extremes visible on it */
    int n_poles;
    const double complex *poles; /* [n_poles] [rad/s] */
    mt_interrupt *interrupt;
} mt_curve_options;

/* A maximum or minimum of |H| of one pair; lists ascend in w. */
typedef struct mt_extreme {
    int pair;           /* output + n_out * input */
    bool peak;          /* else a minimum */
    bool infinite;      /* an undamped resonance: h has no value */
    bool antiresonance; /* a minimum at or near a zero of H, where the phase jumps */
    double w;
    double complex h;
    double error; /* |error of h| <= this */
} mt_extreme;

enum { MT_CURVE_MOST = 20000 };

typedef struct mt_curve {
    int n;
    double *w;         /* [n] strictly ascending [rad/s] */
    double complex *h; /* pairs x n, column-major; no value: infinite real part (mt_sample) */
    double *error;     /* pairs x n */
    int n_extremes;
    mt_extreme *extremes;
    bool complete; /* refined within MT_CURVE_MOST points */
} mt_curve;

/* Phase in degrees, in (-180, 180]; NaN for 0 and where there is no value. */
double mt_phase_deg(double complex h);
/* Frequency i of the caller's grid [rad/s]. */
double mt_curve_grid(const mt_curve_options *opt, int i);
/* Results in mem. Fails: as mt_transfer_at, MT_E_INTERRUPTED. */
mt_status mt_curve_trace(const mt_transfer *t, const mt_curve_options *opt, mt_arena *mem,
                         mt_curve *out, mt_err *err);

/* Points of one pair (of `pairs`) with which a plot, log-log in magnitude and linear in phase,
 * is within about 2 % of |H|: the ends, all extremes, the points beside an undamped resonance,
 * then up to `most` in total. Points that are infinite or 0 are excluded. kept[*n], ascending,
 * in mem. */
mt_status mt_curve_thin(const mt_curve *c, int pair, int pairs, int most, mt_arena *mem, int *n,
                        int **kept, mt_err *err);

#endif
