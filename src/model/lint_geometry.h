/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_LINT_GEOMETRY_H
#define MODEL_LINT_GEOMETRY_H

#include "model/lint.h"

/* What lint.c and lint_geometry.c share: one configuration, its numbers, and its warnings. */
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
/* The pointer of a drive in force, which a configuration may have inherited. */
const char *mt_lint_drive_pointer(const mt_lint *j, const mt_drive *d, const char *member);
/* Unsymmetric matrices, lines between coincident points, axes without direction. */
void mt_lint_structure(mt_lint *j);
/* Joints and springs away from the bodies that they hold, joints with points apart, sizes,
 * gravity that points up, bushings with two points, links that bend about one axis. */
void mt_lint_geometry(mt_lint *j);

#endif
