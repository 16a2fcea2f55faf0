/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_LINT_PRIV_H
#define MODEL_LINT_PRIV_H

#include "model/lint.h"
#include "model/possible.h"

/* What the files judge*.c share: one configuration, its numbers, and what is said of them. */
typedef struct mt_lint {
    const mt_model *model;
    int configuration;
    const double *value; /* [n_nums] */
    mt_warning_list *out;
} mt_lint;

/* Which item of the file a number belongs to. */
typedef struct mt_item {
    const char *what; /* "link" */
    const char *list; /* "links" */
    int index;        /* in that list */
    const char *name;
} mt_item;

/* Say where a doubt (NULL: out of memory) stands: the address of a number, and its pointer.
 * Returns it. */
mt_warning *mt_lint_addr(mt_lint *j, mt_warning *warning, mt_addr addr, const char *pointer);
/* The pointer of the drive in force, which a configuration may have taken over. */
const char *mt_lint_drive_pointer(const mt_lint *j, const char *member);
/* The damping in force (lint_damping.c). */
void mt_lint_damping(mt_lint *j);
/* What its own drive and damping drop of inherited ones (lint_inherited.c). */
void mt_lint_inherited(mt_lint *j);
/* What is said of a tensor xx yy zz xy xz yz (moments not negative) that no body has, and of
 * which moment; NULL: a body has it (lint_structure.c). */
const char *mt_lint_tensor(mt_lint *j, const double v[6], int *at);
/* What no mechanism is built like: unsymmetric matrices, lines between coincident points, axes
 * without direction (lint_structure.c). */
void mt_lint_structure(mt_lint *j);
/* Gravity that points up, bushings with two points, links that bend about one axis
 * (lint_meant.c). size: of the drawing [m]. */
void mt_lint_suspicious(mt_lint *j, double size);
/* Angles without a unit beyond a turn (lint_angles.c). */
void mt_lint_angles(mt_lint *j);
/* Numbers in other units than their members, as their reader found them. */
void mt_lint_units(mt_lint *j);
/* The coordinates of a position; false: they are not known (lint_geometry.c). */
bool mt_lint_position(const mt_lint *j, const mt_position *p, double x[3]);
/* Joints and springs off what they hold, pairs of points that are apart, sizes
 * (lint_geometry.c). */
void mt_lint_geometry(mt_lint *j);

#endif
