/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_MEASURE_H
#define MECHANICS_MEASURE_H

#include <stdbool.h>

#include "mechanics/cx.h"

/*
 * Scalar measures of the relative position of two bodies: every joint is a few equations
 * "measure = value", every spring an energy of measures. Each is returned with its exact
 * gradient and Hessian in the twelve local freedoms
 *     (dx_a, theta_a, dx_b, theta_b):  x -> x + dx,  R -> exp(theta^) R
 *         (displacements and rotation vector in global axes),
 * the left exponential chart at the present position. In the drawn position every body has
 * R = I, so a feature fixed to a body is given by its vector in that position.
 *
 * With u, v directions and P, Q points of bodies a, b (Haug, Computer Aided Kinematics and
 * Dynamics, 1989, ch. 9 uses the same primitives):
 *   PLANE     u_a . (Q_b - P_a)
 *   DOT       u_a . v_b
 *   DISTANCE  |Q_b - P_a|
 *   ANGLE     atan2(c_a . b_b, b_a . b_b): rotation of b relative to a about the axis b x c,
 *             plus the whole turns that bring it nearest to `near`
 *   ROTATION  component k of the rotation vector that takes the triad of a to that of b, in the
 *             triad of a
 *   BEAM      one of the generalised strains of a beam element
 */
typedef enum mt_measure_kind {
    MT_MEASURE_PLANE,
    MT_MEASURE_DOT,
    MT_MEASURE_DISTANCE,
    MT_MEASURE_ANGLE,
    MT_MEASURE_ROTATION,
    MT_MEASURE_BEAM
} mt_measure_kind;

/* Components of BEAM. In two dimensions only STRETCH, BEND_3 and SWAY_3. */
typedef enum mt_beam_strain {
    MT_BEAM_STRETCH, /* elongation [m] */
    MT_BEAM_TWIST,   /* twist [rad] */
    /* rotation of one end relative to the other about e2, e3 [rad]: symmetric bending */
    MT_BEAM_BEND_2,
    MT_BEAM_BEND_3,
    /* sum of the ends' rotations relative to the chord [rad]: antisymmetric bending */
    MT_BEAM_SWAY_2,
    MT_BEAM_SWAY_3,
    MT_BEAM_STRAINS
} mt_beam_strain;

/* Numbers of BEAM in addition to its triad. */
typedef struct mt_beam_numbers {
    mt_cx length;
    mt_cx polar;    /* (I2 + I3)/A [m^2]; 0 in two dimensions */
    mt_cx shape[2]; /* 1/(1 + Phi) for bending about e2, e3; 1 without shear */
    bool plane;     /* two dimensions */
} mt_beam_numbers;

enum { MT_LOCAL = 12 };

/* A body's position for the kernels; the ground is x = 0, R = I. */
typedef struct mt_pose {
    mt_cx x[3];
    mt_cx r[9]; /* column-major */
} mt_pose;

/* Vectors in the drawn position. */
typedef struct mt_measure_data {
    mt_measure_kind kind;
    int component;         /* ROTATION: 0, 1, 2; BEAM: mt_beam_strain */
    const mt_cx *point[2]; /* P - centre of a, Q - centre of b; NULL: the centre */
    /* PLANE: u; DOT: u (a), v (b); ANGLE: b, c; ROTATION, BEAM: triad e1 e2 e3; unit vectors */
    const mt_cx *dir[3];
    mt_beam_numbers beam;
    double near;  /* ANGLE: whole turns bring the value nearest to this [rad] */
    bool held[2]; /* a, b is the ground: the Hessian has no entries of its rotation */
    bool plane;   /* two dimensions: the Hessian is wanted in the plane only */
} mt_measure_data;

/* Part of a Hessian that is filled; PLANE: the entries of x, y and the rotation about z, a
 * quarter of all. */
typedef enum mt_second { MT_SECOND_NONE, MT_SECOND_PLANE, MT_SECOND_ALL } mt_second;

/* Value, gradient and (where wanted) Hessian of a scalar function of the twelve local
 * freedoms. */
typedef struct mt_jet {
    mt_cx value;
    mt_cx g[MT_LOCAL];
    mt_cx h[MT_LOCAL * MT_LOCAL]; /* full symmetric; 0 where it is not filled */
    mt_second second;
} mt_jet;

/*
 * The same for a function of d = x_b - x_a and the rotations of both bodies, as every measure
 * is: in the nine freedoms (dd, theta_a, theta_b), the Hessian by rows of its lower triangle.
 * dx_a is -dd, dx_b is dd.
 */
enum { MT_RELATIVE = 9, MT_RELATIVE_PAIRS = MT_RELATIVE * (MT_RELATIVE + 1) / 2 };
typedef struct mt_relative_jet {
    mt_cx value;
    mt_cx g[MT_RELATIVE];
    mt_cx h[MT_RELATIVE_PAIRS];
    mt_second second;
    unsigned span; /* bits of the freedoms that it depends on; all other entries are 0 */
    bool real;     /* nothing has a derivative: imaginary parts are 0 */
} mt_relative_jet;

/* The relative freedom of a local one; its sign. */
static inline int mt_relative_of(int local)
{
    return local < 6 ? local : (local < 9 ? local - 6 : local - 3);
}

static inline double mt_relative_sign(int local)
{
    return local < 3 ? -1.0 : 1.0;
}

/* Start of row r of the lower triangle. */
static inline int mt_relative_row(int r)
{
    return r * (r + 1) / 2;
}

/* Index of the entry of two local freedoms. */
static inline int mt_relative_pair(int r, int c)
{
    const int i = mt_relative_of(r);
    const int k = mt_relative_of(c);
    return i > k ? mt_relative_row(i) + k : mt_relative_row(k) + i;
}

/* Freedoms with a filled Hessian for a span, ascending. */
typedef struct mt_relative_list {
    int n;
    int at[MT_RELATIVE];
} mt_relative_list;
const mt_relative_list *mt_relative_filled(mt_second second, unsigned span);

/* Intermediate results shared by all strains of a beam element, kept between
 * evaluations. In the plane only phi[2], s[1] and length. Some 6 kB, of which only `dir` must
 * be initialised. */
typedef struct mt_beam_parts {
    const mt_cx *dir; /* of the element; NULL: empty */
    const mt_pose *pose[2];
    mt_relative_jet length;
    mt_relative_jet phi[3];
    mt_relative_jet s[2];
} mt_beam_parts;

/* Evaluate. No heap. A distance of zero has no direction: its gradient is NaN. kept: NULL, or
 * parts shared by measures that are evaluated one after the other with unchanged vectors and
 * poses. */
void mt_measure_eval(const mt_measure_data *m, const mt_pose *a, const mt_pose *b, bool second,
                     mt_beam_parts *kept, mt_jet *out);
/* The same by relative position. */
void mt_measure_relative(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                         bool second, mt_beam_parts *kept, mt_relative_jet *out);
/* Value only. */
mt_cx mt_measure_value(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                       mt_beam_parts *kept);
/* Jet of the work potential f . P of a point fixed to body a (local freedoms 0..5). */
void mt_measure_point(const mt_cx *s, const mt_cx *f, const mt_pose *a, bool second,
                      mt_jet *out);
/* The same by relative position, with the ground as b: dd is -dx_a. */
void mt_measure_relative_point(const mt_cx *s, const mt_cx *f, const mt_pose *a, bool second,
                               mt_relative_jet *out);

#endif
