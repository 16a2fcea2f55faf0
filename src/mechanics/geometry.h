/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_GEOMETRY_H
#define MECHANICS_GEOMETRY_H

#include "mechanics/linear.h"

typedef struct mt_linear_tangent mt_linear_tangent;

/*
 * Results of the stages geometry and tangent at one design. Configurations of one shape
 * (mt_system_same_shape) at the same design compute them once: linearised systems that share
 * use one object, and a system that moves to another design leaves it to the others. There are
 * as many objects as systems, so a free one always exists.
 */
typedef struct mt_geometry {
    mt_arena mem;
    int users;              /* systems that use it */
    const mt_linear *maker; /* whose factors may point into its system */
    bool made;              /* valid for the inputs `at` */
    bool sloped;            /* derivatives are valid as well */
    mt_state position;
    mt_elimination e; /* without z, which belongs to the reduction */
    double *a;
    double *rows[MT_TERM_KINDS];
    mt_rows full[MT_TERM_KINDS];
    mt_arena_mark before_tangent;
    mt_linear_tangent *tangent;
    double at[]; /* [n_inputs] */
} mt_geometry;

typedef struct mt_geometries {
    int n;
    mt_linear **systems;
    int n_all; /* geometries, at least n */
    mt_geometry **all;
} mt_geometries;

/* Create one for a system that shares with none. Fails: MT_E_MEMORY. */
mt_status mt_geometry_open(mt_linear *lin, mt_err *err);
/* lin, which shares with none yet, shares with `with` from now on. Fails: MT_E_MEMORY. */
mt_status mt_geometry_join(mt_linear *lin, mt_linear *with, mt_err *err);
/* Remove the system; the geometry it made is no longer used. */
void mt_geometry_leave(mt_linear *lin);
/* Use an empty geometry that no other system uses. */
void mt_geometry_renew(mt_linear *lin);
/* Mark it as valid for these inputs. */
void mt_geometry_made(mt_linear *lin, const double *inputs);
/* Use a geometry that another system made with the same bits of the inputs of `moves`. False:
 * none. */
bool mt_geometry_take(mt_linear *lin, const uint64_t *moves, const double *inputs);

/*
 * *same: two configurations of one model are the same mechanism except for the position of one
 * driven joint. Bodies, joints, springs, inertias and loads are the same, number by number as
 * expressions of the same inputs; both drive the same joint and hold it the
 * same way, or one of them has no drive and no loads, and a trimmed spring holds the other: it
 * then is that mechanism in its reference position. False for two configurations without a
 * drive. Fails: MT_E_MEMORY.
 */
mt_status mt_system_same_drive(const mt_system *a, const mt_system *b, bool *same, mt_err *err);

/*
 * *same: two configurations of one model have the same geometry at every design, and rows of K,
 * C, M and the sensors in the same positions. As mt_system_same_drive, but coefficients of
 * springs, dampers and inertias, preload and free lengths may differ; without drive and loads.
 * Fails: MT_E_MEMORY.
 */
mt_status mt_system_same_shape(const mt_system *a, const mt_system *b, bool *same, mt_err *err);

#endif
