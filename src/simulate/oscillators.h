/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_OSCILLATORS_H
#define SIMULATE_OSCILLATORS_H

#include "mechanics/affine.h"
#include "simulate/simulate.h"

/*
 * A mechanism whose equations are linear (mechanics/affine.h), in the coordinates of its modes,
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
    const double *y;      /* n x n: of the freedoms, y e */
    double *phi;          /* nq x n */
    double *damping;      /* n x n: C; 0 where nothing damps */
    double *input;        /* n x inputs: b_i */
    double *gauge;        /* gauges x n: a gauge's value with e */
    double *still;        /* [gauges] its value at rest */
    double *length;       /* lengths x n: distances with e */
    double *noise;        /* [n] what rounding of positions makes of forces along e */
    double *work[3];      /* [nq] */
    double *row;          /* [nq] */
} mt_oscillators;

/* *linear false: the equations are not linear, or nothing here shows that they are; what is in
 * *out is void then. Fails: MT_E_MEMORY, MT_E_DOMAIN. */
mt_status mt_oscillators_make(mt_linear *lin, const mt_sim_options *opt, mt_arena *mem,
                              mt_oscillators *out, bool *linear, mt_err *err);
/* e[n] and its velocity of a start; *linear false: it is no start of this linear motion. */
mt_status mt_oscillators_start(mt_oscillators *o, const mt_sim_start *start, double *e,
                               double *rate, bool *linear);
/* The position at e, velocities into v[nq]. */
void mt_oscillators_position(mt_oscillators *o, const double *e, const double *rate,
                             mt_placement *at, double *v);

/* How states of the linear motion fit the equations of mechanics/motion.h, the worst so far. */
typedef struct mt_oscillators_fit {
    double residual;  /* largest of phi^T (M q'' - f) */
    double excess;    /* the same less what rounding of positions leaves */
    double size;      /* largest of the terms that it is the difference of */
    double gap_m;     /* largest gap of a joint */
    bool independent; /* joints are as independent as at rest */
} mt_oscillators_fit;
/* At a state with accelerations `second` and inputs u[inputs]: *fit becomes the worse of itself
 * and this. */
mt_status mt_oscillators_check(mt_oscillators *o, const double *e, const double *rate,
                               const double *second, const double *u, mt_arena *scratch,
                               mt_oscillators_fit *fit, mt_err *err);
/* Whether what is left is rounding. */
bool mt_oscillators_fits(const mt_oscillators_fit *fit);

#endif
