/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MOTION_H
#define MECHANICS_MOTION_H

#include "mechanics/linear.h"
#include "mechanics/singular.h"

/*
 * The nonlinear equations of motion of a system at any position and velocity,
 *     M(g) v' = f(g, v) + A(g)^T lambda,   A(g) v' = b(g, v),
 * g the poses of all bodies, v[nq] the velocities of their centres and their angular velocities
 * in global axes. Springs, dampers, loads and masses are those of the linearised system, which
 * is the linearisation of these equations.
 */
typedef struct mt_motion {
    mt_linear *lin; /* not owned: after an update, at one design */
    int nq;
    int m;
    double *mass;  /* nq x nq, both triangles, column-major [kg, kg m^2] */
    double *force; /* [nq] f: springs, dampers, loads and velocity terms [N, N m] */
    double *a;     /* m x nq, column-major */
    double *b;     /* [m] -(dA/dt) v for constant targets; without the motion of the drive's */
    double *gap;   /* [m] violation of each equation [m, rad, cosine] */
    double *rate;  /* [m] A v */
    double *damping; /* [nq] C v: forces on the dampers */
    double swing;    /* Frobenius norm of dA/dt, rows of unit length, turns as arcs [1/s] */
    double potential;
    double kinetic; /* [J] */
    /* work */
    mt_lagrangian l;
    mt_pose *tangent; /* [bodies] poses with v as derivative */
    mt_pose *probe;   /* [bodies] */
    mt_cx *rows[2];   /* for the rows of any term */
    double *own;      /* [nq] */
} mt_motion;

/* All memory in mem; lin must outlive it. Fails: MT_E_MEMORY. */
mt_status mt_motion_init(mt_motion *o, mt_linear *lin, mt_arena *mem, mt_err *err);
/*
 * Evaluate at `at` (real poses, angles nearest to at->turn, the drive at at->drive) with
 * velocities v[nq]. No heap. O(bodies + joints + springs), and nq^2 for M; a bar or beam with
 * consistent mass costs twelve evaluations of its rows.
 */
void mt_motion_eval(mt_motion *o, const mt_placement *at, const double *v);
/* out[nq] += factor times the force of a ground that accelerates by 1 along a global axis, the
 * velocities being relative to it: what a translation of all bodies and of the ends of bars
 * that the ground holds makes of the masses. After an evaluation at `at`. */
void mt_motion_base(mt_motion *o, const mt_placement *at, int axis, double factor, double *out);
/* k, nq x nq := sum of k f f^T over the springs, f their directions at `at`, where it was
 * evaluated: the stiff part of the motion. The geometric stiffness of loads and preload is not
 * included. */
void mt_motion_stiffness(mt_motion *o, const mt_placement *at, double *k);
/* Update the whole turns of the angles in at->turn; each angle is less than half a turn from
 * its last value. */
void mt_motion_turns(const mt_motion *o, mt_placement *at);
/* mt_singular_nearness at `at`; e: elimination of all equations there. scratch is not mem. */
mt_status mt_motion_nearness(const mt_motion *o, const mt_placement *at,
                             const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                             mt_nearness *out, mt_err *err);

/* A scalar output: a sensor's channel, or the coordinate of a joint. */
typedef struct mt_gauge {
    int channel; /* of the system; -1: `joint` */
    int joint;   /* its coordinate */
} mt_gauge;

/* Motion of a gauge: its velocity is row . v, its acceleration row . v' + drift [m, rad per s,
 * s^2]. */
typedef struct mt_gauge_motion {
    /* of a joint, or of a sensor at a point, from the linearised position; otherwise NaN: only
     * the integral of its velocity is defined */
    double value;
    double drift;
    double *row;
} mt_gauge_motion;

/* After an evaluation at the same position. */
void mt_motion_gauge(mt_motion *o, const mt_placement *at, const double *v, mt_gauge gauge,
                     mt_gauge_motion *out);
/* True where a gauge has a value, not only a velocity. */
bool mt_motion_has_value(const mt_system *sys, mt_gauge gauge);

/*
 * The nonlinear equations of motion, M(q) qdd = Q(q) + A(q)^T lambda at rest, over all states
 * and at positions near the linearised one.
 */

/**
 * @param[in]  lin  after mt_linear_update; its scratch is used
 * @param[in]  dq   [nq] displacement from the linearised position: each body is moved by dx and
 *                  turned by exp(theta) [m, rad]; NULL: none
 * @param[out] m    nq x nq mass matrix, both triangles, column-major [kg, kg m^2]
 * @param[out] q    [nq] impressed forces of springs and loads, trimmed spring included;
 *                  no constraint forces [N, N m]
 * @param[out] a    constraint Jacobian, mt_linear_equations(lin) x nq, column-major
 * @param[out] c    violation of each of these constraints [m, rad, cosine]; NULL: not wanted
 *
 * A x = 0 holds for the velocities that the joints allow; at rest the right-hand side of A xdd
 * = b is zero. Fails: MT_E_MEMORY.
 */
mt_status mt_displaced_eval(mt_linear *lin, const double *dq, double *m, double *q, double *a,
                            double *c, mt_err *err);

#endif
