/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_ITEMS_H
#define SCENE_ITEMS_H

#include "analysis/analysis.h"
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
    int *joint_of;   /* [model joints] joint of the view; -1 */
    int *spring_of;  /* [springs of the system] spring of the view; -1 */
    mt_arena *mem;   /* of the scene */
    mt_arena *work;
    mt_arena *kept; /* lives from design to design */
    mt_scene_view *view;
    mt_scene_known *known;
    mt_scene_followed *followed;
    mt_scene_way *way; /* for this configuration of this design */
} mt_scene_frame;

/* A range of a driven joint to follow after everything is positioned; it needs nothing of the
 * design's analysis. */
struct mt_scene_way {
    mt_scene_frame f;      /* sys, number, value and drawn are void */
    const mt_drive *drive; /* NULL: nothing to follow */
    double low;
    double high;
    double length; /* length of the mechanism, the scale of rounding of coordinates [m] */
};

/* Set components that are rounding for a vector of this size to 0. */
void mt_scene_clean(double size, double x[3]);

/* Bodies of the view, with their ellipsoids. Fails: MT_E_MEMORY,
 * MT_E_NO_CONVERGENCE. */
mt_status mt_scene_bodies(mt_scene_frame *f, mt_err *err);
/* All other items at rest. */
mt_status mt_scene_items(mt_scene_frame *f, mt_err *err);
mt_status mt_scene_springs(mt_scene_frame *f, mt_err *err);
/* The lines of bodies, points with names, and distances of joints. */
mt_status mt_scene_lines(mt_scene_frame *f, mt_err *err);

/* Distances of points in space. */

double mt_distance_points(const double a[3], const double b[3]);
/* Distance of x from the segment from a to b; nearest (may be NULL): its nearest point. */
double mt_distance_segment(const double a[3], const double b[3], const double x[3],
                           double nearest[3]);
/* Distance of x, in the ellipsoid's axes from its centre, from the solid ellipsoid with these
 * radii, some of which may be 0: a disc, a rod, a point. 0 inside. */
double mt_distance_ellipsoid(const double radii[3], const double x[3]);

#endif
