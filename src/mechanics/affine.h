/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_AFFINE_H
#define MECHANICS_AFFINE_H

#include "mechanics/motion.h"

/*
 * Mechanisms whose equations of motion are linear at any amplitude: bodies slide along fixed
 * lines and turn about fixed axes,
 *     x_b = x_b0 + X_b y,   R_b = exp(axis_b (w_b . y)^) R_b0,   y the freedoms,
 * and every measure of a joint, spring, damper or load is an affine function of y (masses in a
 * row, discs on shafts, gears between them). Then T = 1/2 y'^T M y' and V = 1/2 y^T K y + const
 * with the M and K of the linearisation, for any y.
 */

/* A distance |d0| + slope . y; valid while it is above 0. */
typedef struct mt_affine_length {
    double rest_m;
    const double *slope; /* [n] */
} mt_affine_length;

/* Motion of a body with y. */
typedef struct mt_affine_body {
    bool moves;
    bool turns;
    double axis[3]; /* unit, global; where it turns */
    double *rate;   /* [n] w_b */
} mt_affine_body;

typedef struct mt_affine {
    bool linear;
    int n; /* freedoms */
    int nq;
    const double *z;      /* nq x n: velocities of all states from y' */
    const double *slope;  /* n x measures: slope of each measure by y; 0: not affine */
    mt_affine_body *body; /* [bodies] */
    int n_lengths;
    mt_affine_length *length; /* [n_lengths] */
} mt_affine;

/* Of a system at its linearised position. `linear` is set only where it follows from the kinds
 * of measures and from the motions of bodies: no position is tried. O(n (bodies + measures)).
 * Fails: MT_E_MEMORY. */
mt_status mt_affine_make(mt_linear *lin, mt_arena *mem, mt_affine *out, mt_err *err);
/* True where a gauge's value is an affine function of y, and a force at it is constant. */
bool mt_affine_gauge(const mt_linear *lin, const mt_affine *a, mt_gauge gauge);
/* at := the position at y[n], computed in one step, without accumulated rounding. work[nq]. */
void mt_affine_position(const mt_linear *lin, const mt_affine *a, const double *y, double *work,
                        mt_placement *at);

#endif
