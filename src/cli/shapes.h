/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SHAPES_H
#define CLI_SHAPES_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"

/* Shapes of modes at the sensors, or, without sensors, as motions of the bodies. */
typedef struct mt_shapes {
    bool sensors;
    int n;             /* channels; 0: none */
    const char **name; /* [n] "c1.y", "crank.rz" */
    bool *turns;       /* [n] it is an angle */
    double *value;     /* n x modes, mass-normalised */
    double length_m;   /* length at which an angle is compared with a displacement */
    double *largest;   /* [modes] largest displacement of a body or at a sensor */
} mt_shapes;

/* A component of column i as shown in a table of a few digits: 0 where it is negligible
 * relative to the largest of its mode. */
double mt_shapes_shown(const mt_shapes *shapes, int k, int i);

/* Shapes of the first `modes` positions, in mem. Components within rounding of the largest are
 * 0. */
mt_status mt_shapes_of(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out, mt_err *err);
mt_status mt_shapes_of_lowest(mt_lowest *l, int modes, mt_arena *mem, mt_shapes *out,
                              mt_err *err);
/* Shapes at given channels of the given positions: value ns x n. */
mt_status mt_shapes_at(mt_analysis *a, int ns, const int *channels, int n, const int *positions,
                       double *value, mt_err *err);

#endif
