/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_LINT_PRIV_H
#define MODEL_LINT_PRIV_H

#include "base/possible.h"
#include "model/lint.h"

/* Shared by the files lint*.c: one configuration, its numbers, and its warnings. */
typedef struct mt_lint {
    const mt_model *model;
    int configuration;
    const double *value; /* [n_nums] */
    mt_warning_list *out;
} mt_lint;

/* The item of the file that a number belongs to. */
typedef struct mt_item {
    const char *what; /* "link" */
    const char *list; /* "links" */
    int index;        /* in that list */
    const char *name;
} mt_item;

/* Set the location of a warning (NULL: out of memory): address and pointer of a number. Returns
 * the warning. */
mt_warning *mt_lint_addr(mt_lint *j, mt_warning *warning, mt_addr addr, const char *pointer);
/* The pointer of the drive in force, which a configuration may have inherited. */
const char *mt_lint_drive_pointer(const mt_lint *j, const char *member);
/* The damping in force (lint_damping.c). */
void mt_lint_damping(mt_lint *j);
/* Inherited settings that its own drive and damping drop (lint_inherited.c). */
void mt_lint_inherited(mt_lint *j);
/* Reason why no body has the tensor xx yy zz xy xz yz (moments not negative), and the index *at
 * of the moment in question; NULL: a body can have it (lint_structure.c). */
const char *mt_lint_tensor(mt_lint *j, const double v[6], int *at);
/* Unsymmetric matrices, lines between coincident points, axes without direction
 * (lint_structure.c). */
void mt_lint_structure(mt_lint *j);
/* Gravity that points up, bushings with two points, links that bend about one axis
 * (lint_meant.c). size: of the drawing [m]. */
void mt_lint_suspicious(mt_lint *j, double size);
/* Angles without a unit beyond a turn (lint_angles.c). */
void mt_lint_angles(mt_lint *j);
/* Numbers in other units than their members, as found by the reader. */
void mt_lint_units(mt_lint *j);
/* The coordinates of a position; false: not known (lint_geometry.c). */
bool mt_lint_position(const mt_lint *j, const mt_position *p, double x[3]);
/* Joints and springs away from the bodies that they hold, joints with points apart, sizes
 * (lint_geometry.c). */
void mt_lint_geometry(mt_lint *j);

#endif
