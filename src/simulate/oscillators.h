/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_OSCILLATORS_H
#define SIMULATE_OSCILLATORS_H

#include "mechanics/affine.h"
#include "simulate/simulate.h"

/*
 * A mechanism of linear equations (mechanics/affine.h) in modal coordinates,
 *     q = phi e,   e'' + C e' + diag(lambda) e = sum_i b_i u_i(t),
 * phi^T M phi = 1, u_i the inputs.
 */
typedef struct mt_oscillators {
    mt_linear *lin;
    const mt_system *sys;
    const mt_sim_options *opt;
    mt_affine affine;
    mt_motion motion; /* the whole equations, for mt_oscillators_check */
    mt_placement at;
    int nq;
    int n;
    const double *lambda; /* [n] [1/s^2] */
    const double *y;      /* n x n: the freedoms are y e */
    double *phi;          /* nq x n */
    double *damping;      /* n x n: C; 0 without dampers */
    double *input;        /* n x inputs: b_i */
    double *gauge;        /* gauges x n: derivative of a gauge's value by e */
    double *still;        /* [gauges] its value at rest */
    double *length;       /* lengths x n: derivative of distances by e */
    double *noise;        /* [n] forces along e from rounding of positions */
    double *work[3];      /* [nq] */
    double *row;          /* [nq] */
} mt_oscillators;

/* *linear false: the equations are not linear, or not known to be; *out is then invalid. Fails:
 * MT_E_MEMORY, MT_E_DOMAIN. */
mt_status mt_oscillators_make(mt_linear *lin, const mt_sim_options *opt, mt_arena *mem,
                              mt_oscillators *out, bool *linear, mt_err *err);
/* e[n] and its rate at a start; *linear false: the start is not a state of this linear
 * motion. */
mt_status mt_oscillators_start(mt_oscillators *o, const mt_sim_start *start, double *e,
                               double *rate, bool *linear);
/* The position at e, and its velocities v[nq]. */
void mt_oscillators_position(mt_oscillators *o, const double *e, const double *rate,
                             mt_placement *at, double *v);

/* The largest deviations so far of states of the linear motion from the equations of
 * mechanics/motion.h. */
typedef struct mt_oscillators_fit {
    double residual;  /* largest of phi^T (M q'' - f) */
    double excess;    /* the same less the part from rounding of positions */
    double size;      /* largest of the terms whose difference it is */
    double gap_m;     /* largest gap of a joint */
    bool independent; /* the rank of the joints is that at rest */
} mt_oscillators_fit;
/* Update *fit with the deviation at a state with accelerations `second` and inputs
 * u[inputs]. */
mt_status mt_oscillators_check(mt_oscillators *o, const double *e, const double *rate,
                               const double *second, const double *u, mt_arena *scratch,
                               mt_oscillators_fit *fit, mt_err *err);
/* True where the deviation is rounding. */
bool mt_oscillators_fits(const mt_oscillators_fit *fit);

#endif
