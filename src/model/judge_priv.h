/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_JUDGE_PRIV_H
#define MODEL_JUDGE_PRIV_H

#include "model/judge.h"
#include "model/possible.h"

/* What the files judge*.c share: one configuration, its numbers, and what is said of them. */
typedef struct mt_judge {
    const mt_model *model;
    int configuration;
    const double *value; /* [n_nums] */
    mt_doubt_list *out;
} mt_judge;

/* Which item of the file a number belongs to. */
typedef struct mt_item {
    const char *what; /* "link" */
    const char *list; /* "links" */
    int index;        /* in that list */
    const char *name;
} mt_item;

/* Say where a doubt (NULL: out of memory) stands: the address of a number, and its pointer.
 * Returns it. */
mt_doubt *mt_judge_place(mt_judge *j, mt_doubt *doubt, mt_addr addr, const char *pointer);
/* The pointer of the drive in force, which a configuration may have taken over. */
const char *mt_judge_drive_pointer(const mt_judge *j, const char *member);
/* The damping in force (judge_damping.c). */
void mt_judge_damping(mt_judge *j);
/* What its own drive and damping drop of inherited ones (judge_inherited.c). */
void mt_judge_inherited(mt_judge *j);
/* What is said of a tensor xx yy zz xy xz yz (moments not negative) that no body has, and of
 * which moment; NULL: a body has it (judge_structure.c). */
const char *mt_judge_tensor(mt_judge *j, const double v[6], int *at);
/* What no mechanism is built like: unsymmetric matrices, lines between coincident points, axes
 * without direction (judge_structure.c). */
void mt_judge_structure(mt_judge *j);
/* Gravity that points up, bushings with two points, links that bend about one axis
 * (judge_meant.c). size: of the drawing [m]. */
void mt_judge_meant(mt_judge *j, double size);
/* Angles without a unit beyond a turn (judge_angles.c). */
void mt_judge_angles(mt_judge *j);
/* Numbers in other units than their members, as their reader found them. */
void mt_judge_units(mt_judge *j);
/* The coordinates of a position; false: they are not known (judge_geometry.c). */
bool mt_judge_position(const mt_judge *j, const mt_position *p, double x[3]);
/* Joints and springs off what they hold, pairs of points that are apart, sizes
 * (judge_geometry.c). */
void mt_judge_geometry(mt_judge *j);

#endif
