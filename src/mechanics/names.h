/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NAMES_H
#define MECHANICS_NAMES_H

#include "mechanics/eliminate.h"

/* Results of an elimination in names of the model. */

/* Joints with dependent equations, each once, in the order of their equations. */
typedef struct mt_joint_names {
    int n;
    const char *const *name; /* [n] of the system */
    const char *text;        /* for messages: "a", "b" (in quotes) */
} mt_joint_names;

/* Joints with an entry in the combination w[m] of the first m equations. In mem. Fails:
 * MT_E_MEMORY. */
mt_status mt_name_joints(const mt_system *sys, int m, const double *w, mt_arena *mem,
                         mt_joint_names *out, mt_err *err);
/* The bodies and directions that dominate the motion Z y: "bob" (along x), "rod" (rotation).
 * y[e->n], text[size]. */
void mt_name_motion(const mt_system *sys, const mt_elimination *e, const double *y, char *text,
                    size_t size);

#endif
