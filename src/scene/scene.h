/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "base/arena.h"
#include "model/model.h"

/*
 * The drawing of a mechanism at one or several designs: in each configuration the position of
 * every item, its motion in the lowest modes, and its positions along the range of a driven
 * joint. Ground coordinates, SI units. Body 0 is the ground, the bodies of mechanics/system.h
 * follow: a link is its rigid elements, or its nodes. A part that cannot be computed has its
 * reason in words; the rest is complete.
 */

/* The most vibration modes of a configuration, also the most rigid-body and unstable ones; and
 * the number of positions of a driven joint. */
enum { MT_SCENE_MODES = 12, MT_SCENE_POSITIONS = 21 };
/* The content shown along the ranges of driven joints. */
typedef enum mt_scene_travel {
    MT_TRAVEL_NONE,
    MT_TRAVEL_POSES, /* the position of every item at each position of the drive */
    MT_TRAVEL_MODES  /* and the frequencies of the lowest modes there */
} mt_scene_travel;

/* Budgets of a scene in operations: about a minute where a mechanism is shown on request, a few
 * seconds with an answer. Beyond them drives are not followed, and modes of large mechanisms
 * without a fast method for the lowest ones are left out. */
#define MT_SCENE_WORK       2e11
#define MT_SCENE_WORK_ALONG 1e10

typedef enum mt_scene_kind { MT_SCENE_GROUND, MT_SCENE_BODY, MT_SCENE_LINK } mt_scene_kind;

/* The uniform ellipsoid of the same mass and inertia as its body (a disc in two dimensions),
 * about its mass centre. */
typedef struct mt_scene_ellipsoid {
    double radii[3];   /* descending [m] */
    double axes[3][3]; /* unit vectors */
} mt_scene_ellipsoid;

typedef struct mt_scene_body {
    const char *name;
    mt_scene_kind kind;
    double mass;                   /* [kg]; a bar or a beam's element gives half to each end */
    double at[3];                  /* mass centre */
    double rotation[9];            /* from the reference position, column-major */
    mt_scene_ellipsoid *ellipsoid; /* NULL: a link, or nothing resists its rotation */
} mt_scene_body;

typedef struct mt_scene_point {
    const char *name;
    int body; /* the body that it belongs to */
    double at[3];
} mt_scene_point;

/* A line of a body's drawing: from its mass centre, or along a link, to an item attached to
 * it. */
typedef struct mt_scene_line {
    int body;
    double from[3];
    double to[3];
} mt_scene_line;

typedef struct mt_scene_joint {
    const char *name;
    const char *type;
    int body[2];
    double end[2][3]; /* its point on each body */
    double at[3];     /* the second of these */
    bool rod;         /* drawn as a rod from one end to the other: a distance joint */
    bool has_axis;
    double axis[3];
    /* distance of its point from the drawing of the more distant body; 0 where it lies on a
     * link or not far beyond a body's ellipsoid */
    double distance;
    int far; /* the more distant body; MT_ABSENT where the distance is 0 */
} mt_scene_joint;

/* A spring, a damper, or the elasticity of a link. */
typedef struct mt_scene_spring {
    const char *name;
    const char *type; /* as in the model; "link" */
    int body[2];
    double end[2][3];
    bool has_axis;
    double axis[3];
    double stiffness; /* NaN: not a single number */
} mt_scene_spring;

/* A direction of a sensor, or the force of a load. */
typedef struct mt_scene_arrow {
    const char *name;
    int body;
    double at[3];
    double axis[3]; /* unit vector; of a load in N */
} mt_scene_arrow;

typedef struct mt_scene_mode {
    int index;        /* of a vibration, from 1; 0: none */
    double hz;        /* NaN: unstable or undecided */
    const char *name; /* NULL: none */
    const char *note; /* NULL; "rigid-body", "unstable", "undecided" */
    /* 6 x bodies: translation of the mass centre and rotation vector, scaled to a largest
     * displacement of 1 in the drawing */
    double *motion;
    double *spring_share; /* [springs] of the potential energy, loads counted by magnitude */
    double *body_share;   /* [bodies] of the kinetic energy */
} mt_scene_mode;

typedef struct mt_scene_position {
    double at;    /* from the reference position [rad, m] */
    double *pose; /* 12 x bodies: mass centre, rotation (row by row) from the pose of
                        the configuration; NULL: there is none */
    int n_hz;
    double *hz;      /* [n_hz] lowest vibration modes; none where not requested */
    const char *why; /* reason of a failure; NULL: none */
} mt_scene_position;

typedef struct mt_scene_drive {
    const char *joint;
    bool angle;
    double at; /* position at which the configuration holds it; NaN: it does not */
    int n_positions;
    mt_scene_position *positions; /* ascending */
    const char *why;              /* reason for no positions; NULL */
} mt_scene_drive;

/* One configuration at one design. */
typedef struct mt_scene_view {
    const char *name;
    const char *error;     /* reason for no modes; NULL */
    mt_scene_body *bodies; /* the ground first */
    mt_scene_point *points;
    mt_scene_line *lines;
    mt_scene_joint *joints;
    mt_scene_spring *springs;
    mt_scene_spring *dampers;
    mt_scene_arrow *sensors;
    mt_scene_arrow *loads;
    mt_scene_mode *modes;
    mt_scene_drive *drive; /* NULL: none */
    int n_bodies;          /* 0: no drawing */
    int n_points;
    int n_lines;
    int n_joints;
    int n_springs;
    int n_dampers;
    int n_sensors;
    int n_loads;
    int n_modes;
} mt_scene_view;

typedef struct mt_scene_parameter {
    const char *name;
    const char *unit; /* NULL: none given */
    /* unit of its number in the model, and its size in `unit`: shown value = value / factor;
     * NULL, NaN: `unit` itself */
    const char *display_unit;
    double display_factor;
    double value;
} mt_scene_parameter;

typedef struct mt_scene_design {
    const char *label;
    int rank; /* 0: the original one */
    int n_parameters;
    mt_scene_parameter *parameters;
    int n_views;
    mt_scene_view *views;
} mt_scene_design;

/* A joint that lies at a distance from its bodies, in the list of all joints. */
typedef struct mt_scene_off {
    const char *configuration;
    const char *body; /* NULL where the distance is 0 */
    const mt_scene_joint *joint;
    int order; /* index in the order of configurations and joints */
} mt_scene_off;

typedef struct mt_scene {
    mt_arena mem;
    mt_arena *found; /* [n_designs] results along ranges of drives */
    const char *name;
    int dimension;
    double size;      /* diagonal of the box around all that is drawn [m] */
    bool has_gravity; /* of any configuration */
    double gravity[3];
    int n_designs;
    mt_scene_design *designs;
    int n_joints;
    mt_scene_off *joints; /* of the first design, the largest distance first */
} mt_scene;

/* The name of a mode of a design. */
typedef struct mt_scene_name {
    int configuration;
    int index;
    const char *name;
} mt_scene_name;

/* A design to draw: parameters with values other than in the file. */
typedef struct mt_scene_query {
    const char *label;
    int rank;
    int n_inputs;
    const int *inputs; /* parameters */
    const double *at;
    int n_names;
    const mt_scene_name *names;
    int n_shown; /* parameters to list; -1: all that are plain numbers */
    const int *shown;
} mt_scene_query;

/* The content to show of all designs. */
typedef struct mt_scene_extent {
    int n_configurations;
    const int *configurations; /* [n_configurations] */
    double work;               /* budget in operations */
    int threads;               /* worker threads; the result does not depend on them; 0: 1 */
    /* [joints of the model] content along the range of each, in all configurations that have
     * it; NULL: all, with modes */
    const mt_scene_travel *travel;
} mt_scene_extent;

/**
 * @param[out] out             the caller's (mt_scene_delete); its texts are copies
 * A failure in one configuration is reported in it. Fails: MT_E_MEMORY, MT_E_INTERRUPTED,
 * MT_E_INTERNAL.
 */
mt_status mt_scene_new(const mt_model *model, int n_designs, const mt_scene_query *designs,
                       const mt_scene_extent *extent, mt_scene **out, mt_err *err);
/* Accepts NULL. */
void mt_scene_delete(mt_scene *scene);

#endif
