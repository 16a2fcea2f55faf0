/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_GEOMETRY_H
#define MECHANICS_GEOMETRY_H

#include "mechanics/linear.h"

typedef struct mt_linear_tangent mt_linear_tangent;

/*
 * What the stages geometry and tangent of one design left. Configurations of one shape
 * (mt_system_same_shape) that stand at one design need it once: linearised systems that share
 * hold it together, and one that moves on leaves it as it is to those that have not. There
 * are as many as systems: for who leaves one that others stand on one is free.
 */
typedef struct mt_geometry {
    mt_arena mem;
    int users;              /* systems that stand on it */
    const mt_linear *maker; /* whose factors may point into its system */
    bool made;              /* all of this is there, of the inputs `at` */
    bool sloped;            /* and the derivatives */
    mt_state position;
    mt_elimination e; /* without z, which is of the reduction */
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
    int n_all; /* geometries, n at least */
    mt_geometry **all;
} mt_geometries;

/* One for a system by itself. Fails: MT_E_MEMORY. */
mt_status mt_geometry_open(mt_linear *lin, mt_err *err);
/* lin, by itself so far, shares with another system from now on. Fails: MT_E_MEMORY. */
mt_status mt_geometry_join(mt_linear *lin, mt_linear *with, mt_err *err);
/* The system goes; what it made is not used any more. */
void mt_geometry_leave(mt_linear *lin);
/* Stand on one that nobody else stands on, to be made: empty. */
void mt_geometry_renew(mt_linear *lin);
/* It is made, of these inputs. */
void mt_geometry_made(mt_linear *lin, const double *inputs);
/* Stand on one that another system made where the inputs of `moves` had the same bits. False:
 * there is none. */
bool mt_geometry_take(mt_linear *lin, const uint64_t *moves, const double *inputs);

#endif
