/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_JOINT_H
#define MODEL_JOINT_H

#include "model/model.h"

/* The coordinate of a joint about or along its axis: moved by `drive`, and acted on by loads,
 * torsion springs, gears and racks. */
typedef enum mt_coordinate {
    MT_COORDINATE_NONE,
    MT_COORDINATE_ANGLE,
    MT_COORDINATE_DISPLACEMENT
} mt_coordinate;

/* The part of the vector between two points, one on each body, that the joint makes zero. */
typedef enum mt_closes {
    MT_CLOSES_NOTHING,
    MT_CLOSES_ALL,
    MT_CLOSES_ACROSS, /* the axis */
    MT_CLOSES_ALONG,  /* the axis */
    MT_CLOSES_LENGTH
} mt_closes;

/* Properties of a type of joint; its equations are in mechanics/build.c. */
typedef struct mt_joint_kind {
    bool in[2]; /* exists in two, in three dimensions */
    mt_coordinate coordinate;
    mt_closes closes;
    int least_at; /* number of points */
    int most_at;
    bool axis[2]; /* needed in two and in three dimensions */
    bool axis_b;  /* axis_b needed in three dimensions */
    /* [dimension - 2][body]: uses the body's orientation, which a point mass does not have */
    bool turns[2][2];
    bool couples;        /* couples the coordinates of two joints and has no bodies */
    const char *article; /* before the name of the type; NULL: "a" */
} mt_joint_kind;

/* type: not MT_JOINT_TYPE_COUNT. */
const mt_joint_kind *mt_joint_kind_of(mt_joint_type type);
/* True where the second body can move along the joint's axis relative to the first. */
bool mt_joint_slides(mt_joint_type type);
const char *mt_joint_article(mt_joint_type type);

#endif
