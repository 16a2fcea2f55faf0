/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_BUILD_H
#define MECHANICS_BUILD_H

#include "base/sorted.h"
#include "mechanics/system.h"

/* Shared by system.c and the files build*.c while a system is made. A shortage is kept in the
 * arena of the system, which is checked at the end. */
typedef struct mt_builder {
    mt_system *sys;
    const mt_model *model;
    mt_node zero;
    mt_node one;
    int *body_of;          /* [model bodies] state body or -1 (absent in this configuration) */
    int *link_first;       /* [model links] first state body of the link or -1 */
    mt_node (*link_at)[3]; /* [model links] position of `from` */
    int *joint_at;         /* [model joints] the system's joint or -1 */
    int *hinge_at;         /* [model links] the system's joint of its first hinge or -1 */
    int axis_vec[3];       /* vectors of the global axes */
    mt_sorted vec_order;   /* of the system's vectors */
    const mt_system_drive *drive; /* [n_drives] of the caller */
    int n_drives;
    mt_err *err;
} mt_builder;

/* Room for one more entry in list `name` of the system; NULL notes that memory is out. */
#define MT_BUILD_GROW(b, name)                                                               \
    mt_arena_grow(&(b)->sys->mem, (b)->sys->name, (b)->sys->n_##name, &(b)->sys->cap_##name, \
                  sizeof *(b)->sys->name)

mt_node mt_build_num(mt_builder *b, mt_num num); /* MT_ABSENT gives MT_NO_NODE */
mt_node mt_build_num_or(mt_builder *b, mt_num num, mt_node otherwise);
void mt_build_coordinates(mt_builder *b, const mt_num x[3], mt_node out[3]);
void mt_build_position(mt_builder *b, const mt_position *p, mt_node out[3]);
int mt_build_vec(mt_builder *b, mt_vec_kind kind, const mt_node node[3], const char *what);
int mt_build_perp(mt_builder *b, int axis, int which); /* which: 1, 2 */
/* kind: CROSS or ACROSS. */
int mt_build_cross(mt_builder *b, mt_vec_kind kind, int first, int second);
/* Vector from the centre of the body (or the ground's origin) to the position. */
int mt_build_arm(mt_builder *b, int body, const mt_node at[3], const char *what);
mt_measure_def mt_measure_def_default(mt_measure_kind kind, int body_a, int body_b);
int mt_build_measure(mt_builder *b, const mt_measure_def *def);
void mt_build_constraint(mt_builder *b, int measure, mt_node target, bool drawn);
void mt_build_load(mt_builder *b, const mt_load_def *def);
const char *mt_build_name(mt_builder *b, const char *fmt, ...) MT_PRINTF(2, 3);
/* State body of an attachment, MT_GROUND for the ground; false where it is absent in this
 * configuration. */
bool mt_build_attach(mt_builder *b, const mt_attach *a, int *body);
/* Coordinate of a joint, or of a hinge of a link, given by its indices in the model (MT_ABSENT:
 * the other one); -1: absent in this configuration, or without a coordinate. */
int mt_build_find_coordinate(const mt_builder *b, int joint, int link, int hinge, bool angle);
/* ANGLE measure about a UNIT axis vector. In two dimensions axis is the global z. */
int mt_build_angle(mt_builder *b, int body_a, int body_b, int axis);

/* build_parts.c */
mt_status mt_build_bodies(mt_builder *b);
mt_status mt_build_links(mt_builder *b);
/* Position of node `node` of a link. */
void mt_build_link_node(mt_builder *b, int link, int node, mt_node out[3]);
mt_status mt_build_joints(mt_builder *b);
mt_status mt_build_springs(mt_builder *b);

#endif
