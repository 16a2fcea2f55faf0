/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_CURVE_H
#define RESPONSE_CURVE_H

#include "base/interrupt.h"
#include "response/transfer.h"

/*
 * A response between two frequencies, at as many of them as its shape needs: the grid that is
 * asked for, points about every pole as wide as it is, and halves of intervals until |H| of
 * every pair between two points is what a straight line in log |H| says, to about 1 %; and its
 * peaks and antiresonances, which are points too, found from the exact slope.
 */
typedef struct mt_curve_options {
    double from; /* [rad/s] > 0 */
    double to;   /* > from */
    int points;  /* of the grid, both ends included; at least 2 */
    bool log;    /* the grid, and the lines between, over log w */
    bool grid;   /* the grid alone, and extremes that it shows */
    int n_poles;
    const double complex *poles; /* [n_poles] [rad/s] */
    mt_interrupt *interrupt;
} mt_curve_options;

/* A maximum or minimum of |H| of one pair; by ascending w. */
typedef struct mt_extreme {
    int pair;           /* output + n_out input */
    bool peak;          /* else a minimum */
    bool infinite;      /* a peak that is an undamped resonance: no value */
    bool antiresonance; /* a minimum next to a zero of H, where its phase turns over */
    double w;
    double complex h;
    double error; /* |error of h| <= this */
} mt_extreme;

enum { MT_CURVE_MOST = 20000 };

typedef struct mt_curve {
    int n;
    double *w;         /* [n] ascending, no two alike */
    double complex *h; /* pairs x n, column-major; infinite real part: mt_sample */
    double *error;     /* pairs x n */
    int n_extremes;
    mt_extreme *extremes;
    bool complete; /* MT_CURVE_MOST points did */
} mt_curve;

/* Degrees in (-180, 180]; NaN of 0 and where there is no value. */
double mt_phase_deg(double complex h);
/* Frequency i of the grid [rad/s]. */
double mt_curve_grid(const mt_curve_options *opt, int i);
/* Results in mem. Fails: as mt_transfer_at, MT_E_INTERRUPTED. */
mt_status mt_curve_trace(const mt_transfer *t, const mt_curve_options *opt, mt_arena *mem,
                         mt_curve *out, mt_err *err);

/* Which points of one pair (of `pairs`) a picture needs that is log-log in magnitude and
 * straight in phase in between, to about 2 % of |H|: the ends, all extremes and what there is
 * beside a resonance without a value, then at most so many. Of points that are finite and not
 * 0. kept[*n], ascending, in mem. */
mt_status mt_curve_thin(const mt_curve *c, int pair, int pairs, int most, mt_arena *mem, int *n,
                        int **kept, mt_err *err);

#endif
