/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "base/arena.h"
#include "model/model.h"

/*
 * What there is to see of a mechanism: of one or several designs, in each configuration, where
 * everything stands, how it moves in its lowest modes, and where a driven joint takes it.
 * Ground coordinates, SI units. Bodies are those of mechanics/system.h behind the ground, which
 * is body 0: a link is its rigid elements, or its nodes. What cannot be computed says why in
 * words; what it stands in is then as complete as it can be.
 */

/* Vibration modes of a configuration at most, and as many rigid-body and unstable ones; and the
 * positions of a driven joint. */
enum { MT_SCENE_MODES = 12, MT_SCENE_POSITIONS = 21 };
/* What a page can show: items (bodies, and four joints, springs, sensors or the like as one) of
 * one configuration; those of all configurations and designs; and bodies times the positions of
 * their drives. What exceeds this is left out, and says so. */
enum { MT_SCENE_ITEMS = 3000, MT_SCENE_ALL_ITEMS = 9000, MT_SCENE_POSES = 40000 };
/* What is shown of the ranges of driven joints. */
typedef enum mt_scene_travel {
    MT_TRAVEL_NONE,
    MT_TRAVEL_POSES, /* where everything stands at each position */
    MT_TRAVEL_MODES  /* and the frequencies of the lowest modes there */
} mt_scene_travel;

/* What looking may cost in all, in operations: about a minute where somebody asks to see a
 * mechanism, a few seconds where it goes along with an answer. Beyond it drives are not
 * followed, and of large mechanisms without a short way to their lowest modes no modes are
 * sought. */
#define MT_SCENE_WORK       2e11
#define MT_SCENE_WORK_ALONG 1e10

typedef enum mt_scene_kind { MT_SCENE_GROUND, MT_SCENE_BODY, MT_SCENE_LINK } mt_scene_kind;

/* Uniform, of the same mass and inertia as its body (a disc in two dimensions), about its mass
 * centre. */
typedef struct mt_scene_ellipsoid {
    double radii[3];   /* descending [m] */
    double axes[3][3]; /* unit vectors */
} mt_scene_ellipsoid;

typedef struct mt_scene_body {
    const char *name;
    mt_scene_kind kind;
    double mass;                   /* of a bar or a beam's element each end has half [kg] */
    double at[3];                  /* mass centre */
    double rotation[9];            /* from the drawing, column-major */
    mt_scene_ellipsoid *ellipsoid; /* NULL: a link, or nothing resists its rotation */
} mt_scene_body;

typedef struct mt_scene_point {
    const char *name;
    int body; /* that holds it */
    double at[3];
} mt_scene_point;

/* What a body is drawn as: from its mass centre, or along a link, to what it holds. */
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
    bool rod;         /* from one end to the other: a distance joint is drawn so */
    bool has_axis;
    double axis[3];
    /* of its point to what is drawn of the body that is farther: 0 where it lies on a link, or
     * not far beyond the ellipsoid of a body */
    double distance;
    int far; /* that body; MT_ABSENT where the distance is 0 */
} mt_scene_joint;

/* Or a damper, or what is elastic of a link. */
typedef struct mt_scene_spring {
    const char *name;
    const char *type; /* as in the model; "link" */
    int body[2];
    double end[2][3];
    bool has_axis;
    double axis[3];
    double stiffness; /* NaN: it is not one number */
} mt_scene_spring;

/* One direction that a sensor reads, or a load's force. */
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
    /* 6 x bodies: translation of the mass centre and rotation vector, scaled so that the
     * largest displacement of all that is drawn is 1 */
    double *motion;
    double *spring_share; /* [springs] of the potential energy, loads counted by magnitude */
    double *body_share;   /* [bodies] of the kinetic energy */
} mt_scene_mode;

typedef struct mt_scene_position {
    double at;    /* from the reference position [rad, m] */
    double *pose; /* 12 x bodies: mass centre, rotation (row by row) from the pose of
                        the configuration; NULL: there is none */
    int n_hz;
    double *hz;      /* [n_hz] lowest vibration modes; none where they were not asked for */
    const char *why; /* NULL: all went well */
} mt_scene_position;

typedef struct mt_scene_drive {
    const char *joint;
    bool angle;
    double at; /* where the configuration holds it; NaN: it does not */
    int n_positions;
    mt_scene_position *positions; /* ascending */
    const char *why;              /* there are none; NULL */
} mt_scene_drive;

/* One configuration at one design. */
typedef struct mt_scene_view {
    const char *name;
    const char *error;     /* why there are no modes; NULL */
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
    int n_bodies;          /* 0: not even a drawing */
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
    /* what the model gives its number in, value / factor; NULL, NaN: in the unit */
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

/* A joint that lies off what it holds, in a list of all of them. */
typedef struct mt_scene_off {
    const char *configuration;
    const char *body; /* NULL where the distance is 0 */
    const mt_scene_joint *joint;
    int order; /* as configurations and joints stand */
} mt_scene_off;

typedef struct mt_scene {
    mt_arena mem;
    mt_arena *found; /* [n_designs] what was found along ranges of drives */
    const char *name;
    int dimension;
    double size;      /* diagonal of the box around all that is drawn [m] */
    bool has_gravity; /* of any configuration */
    double gravity[3];
    int n_designs;
    mt_scene_design *designs;
    int n_joints;
    mt_scene_off *joints; /* of the first design, the farthest first */
} mt_scene;

/* The name of a mode of a design. */
typedef struct mt_scene_name {
    int configuration;
    int index;
    const char *name;
} mt_scene_name;

/* A design to look at: parameters with other values than in the file. */
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

/* What to show of all designs. */
typedef struct mt_scene_extent {
    int n_configurations;
    const int *configurations; /* [n_configurations] */
    double work;               /* what it may cost */
    int threads; /* that share it out, which makes no difference to what there is to see; 0: 1
                  */
    /* [joints of the model]: of the range of each, in all configurations that have it; NULL:
     * of all of them, with modes */
    const mt_scene_travel *travel;
} mt_scene_extent;

/**
 * @param[out] out             the caller's (mt_scene_delete); its texts are copies
 * What fails in one configuration is said there. Fails: MT_E_MEMORY, MT_E_INTERRUPTED,
 * MT_E_INTERNAL.
 */
mt_status mt_scene_new(const mt_model *model, int n_designs, const mt_scene_query *designs,
                       const mt_scene_extent *extent, mt_scene **out, mt_err *err);
/* Accepts NULL. */
void mt_scene_delete(mt_scene *scene);

#endif
