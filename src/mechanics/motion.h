/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MOTION_H
#define MECHANICS_MOTION_H

#include "mechanics/linear.h"
#include "mechanics/singular.h"

/*
 * The equations of motion of a system at any position and any velocity,
 *     M(g) v' = f(g, v) + A(g)^T lambda,   A(g) v' = b(g, v),
 * g the poses of all bodies, v[nq] their velocities: of the centres, and angular ones, in
 * global axes. Springs, dampers, loads and masses are those of the linearised system, which is
 * what this one becomes next to its position.
 */
typedef struct mt_motion {
    mt_linear *lin; /* not owned: after an update, at one design */
    int nq;
    int m;
    double *mass;    /* nq x nq, both triangles, column-major [kg, kg m^2] */
    double *force;   /* [nq] f: springs, dampers, loads and velocity terms [N, N m] */
    double *a;       /* m x nq, column-major */
    double *b;       /* [m] -(dA/dt) v, the joints standing still; the drive's lacks its own */
    double *gap;     /* [m] what is left of each equation [m, rad, cosine] */
    double *rate;    /* [m] A v */
    double *damping; /* [nq] C v: what dampers push against */
    double potential;
    double kinetic; /* [J] */
    /* work */
    mt_lagrangian l;
    mt_pose *tangent; /* [bodies] with v as their derivative */
    mt_pose *probe;   /* [bodies] */
    mt_cx *rows[2];   /* room for any term */
    double *own;      /* [nq] */
} mt_motion;

/* All memory in mem; lin must outlive it. Fails: MT_E_MEMORY. */
mt_status mt_motion_init(mt_motion *o, mt_linear *lin, mt_arena *mem, mt_err *err);
/*
 * Evaluate at `at` (its poses real, angles read next to at->turn, the drive held at at->drive)
 * with velocities v[nq]. No heap. O(bodies + joints + springs) but for M, nq^2; a bar or beam
 * with consistent mass costs twelve evaluations of its rows.
 */
void mt_motion_eval(mt_motion *o, const mt_placement *at, const double *v);
/* k, nq x nq: sum of k f f^T over the springs, f their directions at `at`, where it was
 * evaluated: what makes a motion stiff. What turns with positions (loads, preload) is not in
 * it. */
void mt_motion_stiffness(mt_motion *o, const mt_placement *at, double *k);
/* Note in at->turn where the angles stand, which are less than half a turn from where they
 * were. */
void mt_motion_turns(const mt_motion *o, mt_placement *at);
/* mt_singular_nearness at `at`; e: elimination of all equations there. scratch is not mem. */
mt_status mt_motion_nearness(const mt_motion *o, const mt_placement *at,
                             const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                             mt_nearness *out, mt_err *err);

/* One scalar that is looked at: a sensor's channel, or the coordinate of a joint. */
typedef struct mt_gauge {
    int channel; /* of the system; -1: */
    int joint;   /* its coordinate */
} mt_gauge;

/* How a gauge moves: along row[nq], row . v its velocity and row . v' + drift its acceleration
 * [m, rad per s, s^2]. */
typedef struct mt_gauge_motion {
    double value; /* of a joint, or of a sensor at a point: from the linearised position; else
                     NaN: the integral of its velocity is all there is */
    double drift;
    double *row;
} mt_gauge_motion;

/* After an evaluation at the same place. */
void mt_motion_gauge(mt_motion *o, const mt_placement *at, const double *v, mt_gauge gauge,
                     mt_gauge_motion *out);
/* Whether a gauge has a value of its own. */
bool mt_motion_has_value(const mt_system *sys, mt_gauge gauge);

#endif
