/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_JOINT_H
#define MODEL_JOINT_H

#include "model/model.h"

/* What a joint's position along its freedom is called by: what `drive` moves, and loads,
 * torsion springs, gears and racks act on. About or along its axis. */
typedef enum mt_coordinate {
    MT_COORDINATE_NONE,
    MT_COORDINATE_ANGLE,
    MT_COORDINATE_DISPLACEMENT
} mt_coordinate;

/* What the joint closes of the way between two points, one on each body. */
typedef enum mt_closes {
    MT_CLOSES_NOTHING,
    MT_CLOSES_ALL,
    MT_CLOSES_ACROSS, /* the axis */
    MT_CLOSES_ALONG,  /* the axis */
    MT_CLOSES_LENGTH
} mt_closes;

/* What a type of joint is and needs; its equations are in mechanics/build_joints.c. */
typedef struct mt_joint_kind {
    bool in[2]; /* there is such a joint in two, in three dimensions */
    mt_coordinate coordinate;
    mt_closes closes;
    int least_at; /* points */
    int most_at;
    bool axis[2]; /* needed in two and in three dimensions */
    bool axis_b;  /* in three */
    /* [dimension - 2][body]: uses the body's orientation, which a point mass has not */
    bool turns[2][2];
    bool couples;        /* the coordinates of two joints, and has no bodies of its own */
    const char *article; /* before the name of the type; NULL: "a" */
} mt_joint_kind;

/* type: a type that there is (not MT_JOINT_TYPE_COUNT). */
const mt_joint_kind *mt_joint_kind_of(mt_joint_type type);
/* Whether its second body moves along the axis of the joint against the first. */
bool mt_joint_slides(mt_joint_type type);
const char *mt_joint_article(mt_joint_type type);

#endif
