/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ABSOLUTE_H
#define MECHANICS_ABSOLUTE_H

#include "linalg/sparse.h"
#include "mechanics/position.h"

/*
 * A mechanism of any size and form, drawn at rest, in the coordinates of its bodies, those that
 * fixed joints hold together being one: K and M as sums of squares of sparse rows, one for each
 * spring and each part of a mass, and the rows of the Jacobian A of the constraints that are
 * left. All costs are O(bodies).
 */
typedef struct mt_absolute {
    const mt_system *sys;
    int n; /* coordinates */
    mt_squares k;
    mt_squares m;
    mt_rows a;
    double *unit; /* [n] 1, or 1/length_m of a turn [1, 1/m] */
    double mass_kg;
} mt_absolute;

enum { MT_ABSOLUTE_WHY = 200 };

/**
 * @param[in]  inputs  [n_inputs] of the system
 * @param[out] out     its arrays in mem
 * @param[out] why     the reason where *is false: driven, loaded, or not closed as drawn
 * Fails: MT_E_DOMAIN (a number has no value), MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_new(const mt_system *sys, const double *inputs, mt_arena *mem,
                          mt_absolute *out, bool *is, char why[MT_ABSOLUTE_WHY], mt_err *err);

#endif
