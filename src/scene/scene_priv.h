/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_SCENE_PRIV_H
#define SCENE_SCENE_PRIV_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "model/values.h"
#include "scene/scene.h"

/* The range followed last at a design, reused where another configuration has the same one. */
typedef struct mt_scene_followed {
    mt_system *sys; /* owned, driven from outside; NULL: none */
    const mt_scene_view *view;
} mt_scene_followed;

/* A configuration at the previous design. */
typedef struct mt_scene_known {
    mt_analysis *by;                /* owned; NULL: none */
    const mt_scene_query *ask;      /* query of `by` */
    mt_numbers numbers;             /* all numbers of the model */
    const mt_scene_query *numbered; /* query that they were compiled for; NULL: not compiled */
} mt_scene_known;

typedef struct mt_scene_way mt_scene_way;

/* The shared state while one configuration of one design is drawn. */
typedef struct mt_scene_frame {
    const mt_model *model;
    int configuration;
    const mt_scene_query *ask;
    const mt_scene_extent *extent;
    const mt_system *sys;
    const double *number; /* [numbers of the model] */
    const double *value;  /* [nodes of the system's program] */
    const mt_pose *drawn; /* [bodies of the system] */
    const mt_pose *pose;
    int *body_of;    /* [model bodies] body of the system; MT_ABSENT */
    int *link_first; /* [model links] first body of the system; MT_ABSENT */
    int *link_of;    /* [bodies of the system] link; MT_ABSENT */
    int *joint_of;   /* [model joints] joint of the view; -1 (items.c) */
    int *spring_of;  /* [springs of the system] spring of the view; -1 (springs.c) */
    mt_arena *mem;   /* of the scene */
    mt_arena *work;
    mt_arena *kept; /* lives from design to design */
    mt_scene_view *view;
    mt_scene_known *known;
    mt_scene_followed *followed;
    mt_scene_way *way; /* for this configuration of this design */
} mt_scene_frame;

/* The system of the frame's configuration with a drive (NULL: none) at inputs
 * at[n_inputs of ask], and with a drive one more. */
static inline mt_system_def mt_scene_system(const mt_scene_frame *f,
                                            const mt_system_drive *drive, const double *at)
{
    return (mt_system_def){.model = f->model,
                           .configuration = f->configuration,
                           .drive = drive,
                           .n_inputs = f->ask->n_inputs,
                           .inputs = f->ask->inputs,
                           .at = at};
}

/* A range of a driven joint to follow after everything is positioned; it needs nothing of the
 * design's analysis. */
struct mt_scene_way {
    mt_scene_frame f;      /* sys, number, value and drawn are void */
    const mt_drive *drive; /* NULL: nothing to follow */
    double low;
    double high;
    double length; /* length of the mechanism, the scale of rounding of coordinates [m] */
};

/* The remaining capacity of a page. */
typedef struct mt_scene_room {
    double items;
    double poses;
    double work;
} mt_scene_room;

/* scene.c: approximate operations for the modes of a configuration of so many coordinates. */
double mt_scene_work(double coordinates);

/* frame.c: true where both queries have the same inputs; false where a is NULL. */
bool mt_scene_same_inputs(const mt_scene_query *a, const mt_scene_query *b);
/* Set the values of the design and the index maps; sys, ask, model, configuration, mem, work
 * and view are given. Fails: MT_E_DOMAIN, MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_scene_frame_new(mt_scene_frame *f, mt_err *err);
/* A position of the model in the reference position. */
void mt_scene_drawn(const mt_scene_frame *f, const mt_position *p, double out[3]);
/* The body of the system that an attachment names. */
int mt_scene_body_of(const mt_scene_frame *f, const mt_attach *a);
/* The end of a link's first `count` elements (half: and half of the next one) in the reference
 * position. */
void mt_scene_link_at(const mt_scene_frame *f, int link, int count, bool half, double out[3]);
/* The centre of a body of the system in the reference position; of the ground the origin. */
void mt_scene_centre(const mt_scene_frame *f, int body, double out[3]);
/* The position in the pose of a body's point, or the direction in the pose of a body's
 * direction, given in the reference position. */
void mt_scene_place(const mt_scene_frame *f, int body, const double drawn[3], double out[3]);
void mt_scene_turn(const mt_scene_frame *f, int body, const double drawn[3], double out[3]);
/* Set components that are rounding for a vector of this size to 0. */
void mt_scene_clean(double size, double x[3]);

/* bodies.c: bodies of the view, with their ellipsoids. Fails: MT_E_MEMORY,
 * MT_E_NO_CONVERGENCE. */
mt_status mt_scene_bodies(mt_scene_frame *f, mt_err *err);
/* items.c, springs.c: all other items at rest. */
mt_status mt_scene_items(mt_scene_frame *f, mt_err *err);
mt_status mt_scene_springs(mt_scene_frame *f, mt_err *err);
/* lines.c: the lines of bodies, points with names, and distances of joints. */
mt_status mt_scene_lines(mt_scene_frame *f, mt_err *err);

/* modes.c: of the first `shown` modes, with shapes phi over the states of the system. */
mt_status mt_scene_modes(mt_scene_frame *f, const mt_modes *modes, int shown, const double *phi,
                         mt_err *err);
/* energy.c: shares of one mode of eigenvalue lambda. spring[springs of the view],
 * body[bodies of the view]. */
typedef struct mt_scene_energy mt_scene_energy;
mt_status mt_scene_energy_new(const mt_scene_frame *f, mt_scene_energy **out, mt_err *err);
void mt_scene_energy_of(const mt_scene_energy *e, double lambda, const double *phi,
                        double *spring, double *body);

/* drive.c: plan the range of the driven joint, where there is one and capacity for it, in
 * f->way. */
mt_status mt_scene_plan(mt_scene_frame *f, mt_scene_room *left, mt_err *err);
/* Follow the planned range: way->f has a mem, a work and a followed of the caller's own. Fails:
 * MT_E_MEMORY, MT_E_INTERRUPTED, MT_E_INTERNAL. */
mt_status mt_scene_follow(mt_scene_way *way, mt_err *err);

#endif
