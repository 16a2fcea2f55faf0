/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_SYSTEM_H
#define MECHANICS_SYSTEM_H

#include "base/run.h"
#include "expr/program.h"
#include "linalg/ldl.h"
#include "mechanics/measure.h"
#include "model/model.h"

/*
 * One configuration of a model, flattened: links are elements, joints are equations, springs
 * are energies of measures, every number is a node of one program. A system is immutable once
 * made and may be shared by threads; mutable data is in mt_linear (linear.h).
 *
 * States q: increments of each body, (dx, dy, dtheta) in two dimensions, (dx, dy, dz, theta_x,
 * theta_y, theta_z) in three, translations alone for a point mass.
 */

/* A 3-vector of the geometry, in the drawn position. */
typedef enum mt_vec_kind {
    MT_VEC_NODES, /* components are the nodes */
    MT_VEC_UNIT,  /* the same, normalised */
    MT_VEC_PERP1, /* unit, perpendicular to vector `axis`: axis x e_helper, normalised */
    MT_VEC_PERP2, /* axis x PERP1 */
    MT_VEC_CROSS, /* vector axis x vector helper, perpendicular, normalised */
    MT_VEC_ACROSS /* the same of any two that are not parallel */
} mt_vec_kind;

typedef struct mt_vec_def {
    mt_vec_kind kind;
    mt_node node[3];
    int axis;         /* PERP, CROSS, ACROSS: a UNIT vector */
    int helper;       /* PERP: global axis least along the axis at the original design */
    const char *what; /* for messages: "axis of joint \"pivot\"" */
} mt_vec_def;

/* Numbers of a beam element's strains (measure.h: mt_beam_numbers). MT_NO_NODE: polar 0, shape
 * 1. */
typedef enum mt_beam_number {
    MT_BEAM_LENGTH,
    MT_BEAM_POLAR,
    MT_BEAM_SHAPE_2,
    MT_BEAM_SHAPE_3,
    MT_BEAM_NUMBERS
} mt_beam_number;

typedef struct mt_measure_def {
    mt_measure_kind kind;
    int component;
    int body[2];  /* index of a state body; MT_GROUND */
    int point[2]; /* vectors; -1: the centre */
    int dir[3];
    mt_node beam[MT_BEAM_NUMBERS]; /* BEAM; else MT_NO_NODE */
} mt_measure_def;

typedef struct mt_state_body {
    const char *name; /* "crank", "beam.3", "fe.node0" */
    int centre;       /* vector: drawn position of the centre */
    int dof[6];       /* column of q for x y z rx ry rz; -1: none */
} mt_state_body;

typedef struct mt_constraint_def {
    int terms; /* 1, or 2 for a gear or rack */
    int measure[2];
    mt_node coefficient[2]; /* gear, rack; else MT_NO_NODE (1) */
    mt_node target;         /* MT_NO_NODE: the drawn value where `drawn`, otherwise 0 */
    bool drawn;
    int joint; /* of the system's joints */
} mt_constraint_def;

typedef struct mt_system_joint {
    const char *name;
    mt_joint_type type;
    int first; /* constraints first .. first + count - 1 */
    int count;
    /* measure of its coordinate (angle or displacement from the reference position); -1:
     * none */
    int coordinate;
    bool angle;
    int body[2];
    int model_joint; /* MT_ABSENT for hinges of links */
    int link;        /* hinge of this link, MT_ABSENT */
    int hinge;
} mt_system_joint;

/* V = 1/2 k d_a d_b (+ preload d_a), d = measure - rest value; the rest value is that of the
 * reference position or `free`. a == b except for couplings of a bushing. */
typedef struct mt_spring_def {
    const char *name;
    int measure[2];
    mt_node stiffness;
    mt_node free;    /* MT_NO_NODE: unstressed in the reference position */
    mt_node preload; /* MT_NO_NODE: 0 */
    mt_node loss;    /* loss factor; MT_NO_NODE: 0 */
    bool damper;     /* no energy; `stiffness` is a damping coefficient */
    int item;        /* springs of one item of the model are consecutive */
} mt_spring_def;

typedef enum mt_inertia_kind {
    MT_INERTIA_TRANSLATION, /* m |v|^2 of a centre */
    MT_INERTIA_ROTATION,    /* J_ab (omega . dir0)(omega . dir1) */
    MT_INERTIA_BAR,         /* bar with consistent mass between two points */
    MT_INERTIA_BEAM,        /* consistent mass of a beam element between two node bodies */
    MT_INERTIA_BEAM_TWIST,  /* its polar moment of inertia about its axis, 3-D */
    MT_INERTIA_BEAM_ROTARY  /* rotary inertia of its sections in one plane of bending */
} mt_inertia_kind;

typedef struct mt_inertia_def {
    mt_inertia_kind kind;
    mt_node coefficient; /* kg, kg m^2, or kg (TWIST, ROTARY: kg m^2) of the whole element */
    int body[2];
    int point[2];
    int dir[3];       /* BEAM: triad; ROTATION: dir[0], dir[1], unit vectors of the body */
    mt_node shape[2]; /* BEAM: 1/(1 + Phi) for bending about e2, e3; MT_NO_NODE: 1 */
    int bending;      /* BEAM_ROTARY: 0 about e2, 1 about e3 */
    int item;
} mt_inertia_def;

typedef struct mt_load_def { /* V = -F . x of a point of a body, or V = -size * measure */
    const char *name;        /* NULL: gravity */
    int measure;             /* -1: a force */
    int body;
    int point;
    mt_node force[3];
    mt_node size; /* of a measure */
} mt_load_def;

typedef enum mt_channel_kind {
    MT_CHANNEL_POINT,
    MT_CHANNEL_ROTATION,
    MT_CHANNEL_BEAM_POINT,
    MT_CHANNEL_BEAM_ROTATION
} mt_channel_kind;

static inline bool mt_channel_turns(mt_channel_kind kind)
{
    return kind == MT_CHANNEL_ROTATION || kind == MT_CHANNEL_BEAM_ROTATION;
}
/* One scalar output of a sensor: a displacement or rotation along a global axis, per unit of
 * q. */
typedef struct mt_channel_def {
    const char *name; /* "c1.y" */
    mt_channel_kind kind;
    int axis; /* global 0..2 */
    int body[2];
    int point;        /* POINT */
    int dir[3];       /* BEAM: triad */
    mt_node shape[2]; /* BEAM, as mt_inertia_def */
    mt_node fraction; /* BEAM: 0..1 within the element */
} mt_channel_def;

typedef struct mt_item_def { /* what `mass` counts: bodies, links, bars */
    const char *name;
    mt_node mass; /* MT_NO_NODE: none */
} mt_item_def;

/* A driven joint. */
typedef struct mt_drive_def {
    mt_node position; /* of the joint's coordinate, from the reference position */
    int joint;        /* of the system's joints */
    int constraint;
    int spring; /* of the system's springs: trimmed to hold it; -1: locked */
    int input;  /* that its position is, of a caller's drive that is not fixed; -1: none */
} mt_drive_def;

/* Damping in addition to dampers and loss factors (model.h: mt_damping), as nodes; MT_NO_NODE:
 * none. */
typedef struct mt_damping_def {
    mt_node mass;      /* 1/s */
    mt_node stiffness; /* s */
    bool modal;        /* a ratio is given: C takes all modes (analysis/damping.h) */
    mt_node ratio;
    int n_ratios;
    mt_node *ratios; /* [n_ratios] */
    int n_named;     /* named modes of this configuration */
    int *named;      /* [n_named] of the model's */
    mt_node *named_ratios;
} mt_damping_def;

typedef struct mt_layout mt_layout;

typedef struct mt_system {
    mt_arena mem;
    const mt_model *model; /* not owned; must outlive the system, like the run */
    const mt_run *run;     /* never NULL */
    int configuration;
    int dimension;
    int n_inputs;
    int *inputs; /* parameter of each input; MT_ABSENT for the position of a caller's drive */
    mt_node *parameters; /* [model parameters] node of each parameter in this configuration */
    mt_program program;
    int nq; /* states */
    /* model length at the original design; scales rotations */
    double length_m;
    MT_LIST_OF(mt_vec_def, vecs);
    MT_LIST_OF(mt_measure_def, measures);
    MT_LIST_OF(mt_state_body, bodies);
    MT_LIST_OF(mt_constraint_def, constraints); /* those of `drives` last, in their order */
    MT_LIST_OF(mt_system_joint, joints);
    MT_LIST_OF(mt_spring_def, springs);
    MT_LIST_OF(mt_inertia_def, inertias);
    MT_LIST_OF(mt_load_def, loads);
    MT_LIST_OF(mt_channel_def, channels);
    MT_LIST_OF(mt_item_def, items);
    mt_damping_def damping;
    bool loaded; /* gravity, preload or free length present: the equilibrium must be found */
    bool driven;
    /* driven joints: locked ones first, then those that springs hold, for which the linearised
     * system has no constraint */
    int n_drives;
    int n_trims; /* held by springs: the last of them */
    mt_drive_def drives[MT_DRIVES_MOST];
    /* inputs, as bit sets of the program: those of vectors and targets; those and the sections
     * of beams; those and the positions of sensors; those of the equilibrium in addition */
    uint64_t *places;
    uint64_t *frame;
    uint64_t *shape;
    uint64_t *forces;
    bool geometry_fixed; /* `shape` is empty */
    /* the joints are closed in the drawn position for all inputs: each has one point and no
     * length */
    bool drawn_closed;
    const mt_layout *layout; /* of states and equations */
} mt_system;

/*
 * Flatten configuration `configuration` of the model. inputs: parameters that the caller will
 * vary (an override of the configuration takes precedence over an input, an input over the
 * parameter's own definition); at[n_inputs]: their values at the original design, where
 * discrete choices (helper axes, model length) are made. Fails: MT_E_INPUT (a point mass held
 * away from its centre, beam section incomplete, ...), MT_E_DOMAIN, MT_E_MEMORY.
 */
mt_status mt_system_new(const mt_model *model, int configuration, int n_inputs,
                        const int *inputs, const double *at, mt_system **out, mt_err *err);
/* A joint driven from outside. It takes the place of the configuration's own drive of that
 * joint, and the other drives of the configuration stay; where it has no drive of that joint
 * all of its drives are released. */
typedef struct mt_system_drive {
    const char *joint;  /* a joint with a coordinate, or a link's hinge ("beam.h3") */
    const char *spring; /* trimmed to hold it; NULL: locked */
    bool fixed;         /* the joint is fixed at `position`, which is then not an input */
    double position;    /* where fixed [rad or m from the reference position] */
} mt_system_drive;
/* What a system is made of. Nothing is owned; model and run must outlive the system. */
typedef struct mt_system_def {
    const mt_model *model;
    const mt_run *run; /* checked and updated by all work on the system; NULL: none */
    int configuration;
    const mt_system_drive *drive; /* [n_drives]; NULL: none but the configuration's own */
    int n_drives;                 /* 0 with a drive: 1 */
    int n_inputs;
    const int *inputs; /* [n_inputs] indices of parameters */
    const double *at;  /* [n_inputs], and one more for each drive that is not fixed */
} mt_system_def;
/* mt_system_new within a run. The positions of drives [rad or m from the reference position]
 * are additional, last inputs, in their order: at[n_inputs + n_drives], and the system has as
 * many inputs; a fixed drive adds none. Fails as mt_system_new; MT_E_INPUT: no such joint or
 * spring, or one twice. */
mt_status mt_system_new_of(const mt_system_def *def, mt_system **out, mt_err *err);
void mt_system_delete(mt_system *sys);

/* Index among the drives of a joint, and among the trimmed springs, of a spring; -1: none. */
int mt_system_drive_of(const mt_system *sys, int joint);
int mt_system_trim_of(const mt_system *sys, int spring);
int mt_system_find_channel(const mt_system *sys, const char *name);
int mt_system_find_joint(const mt_system *sys, const char *name);

/*
 * Order of states and equations along the mechanism, in which
 *     [H A^T; A 0],    H the Hessian of the Lagrangian, A the Jacobian of the constraints,
 * has its entries near the diagonal: bodies breadth first from one end of the mechanism along
 * joints and springs; each equation after the last of its bodies.
 */
struct mt_layout {
    int *state;    /* [nq] row of a state */
    int *equation; /* [n_constraints] row of an equation */
    mt_envelope envelope;
    double work; /* multiplications of a factorisation */
};

#endif
