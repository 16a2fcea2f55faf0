/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ABSOLUTE_H
#define MECHANICS_ABSOLUTE_H

#include "linalg/factor.h"
#include "linalg/sparse.h"
#include "mechanics/position.h"

/*
 * A mechanism of any size and form, as drawn or where it has settled, in the coordinates of its
 * bodies, those that fixed joints hold together being one: K and M as sums of squares of sparse
 * rows, one for each spring and each part of a mass, and the rows of the Jacobian A of the
 * constraints that are left. All costs are O(bodies).
 */
typedef struct mt_absolute {
    const mt_system *sys;
    const mt_state *settled; /* NULL: as drawn */
    int n;                   /* coordinates */
    mt_squares k;
    mt_squares m;
    mt_rows a;
    int *part;    /* [n] which of the bodies that are left, counted from 0 */
    double *unit; /* [n] 1, or 1/length_m of a turn [1, 1/m] */
    int *with;    /* [bodies] body that it moves with, itself, or MT_GROUND */
    int *place;   /* [nq] coordinate of a state; -1: it moves with another body's */
    double *arm;  /* 3 x bodies, from the centre of that other body [m] */
    double mass_kg;
} mt_absolute;

enum { MT_ABSOLUTE_WHY = 200 };

/**
 * @param[in]  inputs   [n_inputs] of the system
 * @param[in]  settled  where it stands at these inputs, outlives out; NULL: as drawn
 * @param[out] out      its arrays in mem
 * @param[out] why      the reason where *is false: driven, or not closed as drawn
 * Fails: MT_E_DOMAIN (a number has no value), MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_new(const mt_system *sys, const double *inputs, const mt_state *settled,
                          mt_arena *mem, mt_absolute *out, bool *is, char why[MT_ABSOLUTE_WHY],
                          mt_err *err);

/* All numbers at these inputs, and the place; arrays in mem. Fails: MT_E_DOMAIN,
 * MT_E_MEMORY. */
mt_status mt_absolute_stand(const mt_system *sys, const mt_state *settled, const double *inputs,
                            mt_data *data, mt_placement *at, mt_arena *mem, mt_err *err);

/* Whether these bodies (n, or MT_GROUND) move together. */
bool mt_absolute_together(const mt_absolute *o, const int *body, int n);
/* Whether constraint i of the system holds bodies that do: then it is none of the rows of a. */
bool mt_absolute_holds_already(const mt_absolute *o, int i);
/* phi[nq] := x[n] by states. */
void mt_absolute_shape(const mt_absolute *o, const double *x, double *phi);
/* The reverse: f[n] := what forces on all states, force[nq], are by coordinates. */
void mt_absolute_push(const mt_absolute *o, const double *force, double *f);
/* f[n] := M times the motion of all bodies by 1 along a global axis, of those that are fixed to
 * the ground, too. Scratch is given back. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_absolute_shift(const mt_absolute *o, const double *inputs, int axis, double *f,
                            mt_arena *scratch, mt_err *err);
/* The system's channels, as drawn or where it has settled, for n such shapes, phi nq x n: value
 * n_channels x n. Scratch is given back. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_absolute_sense(const mt_system *sys, const mt_state *settled, const double *inputs,
                            int n, const double *phi, double *value, mt_arena *scratch,
                            mt_err *err);

/* f[n] := the forces of loads and springs that the constraints have to hold, where it stands.
 * Scratch is given back. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_absolute_forces(const mt_absolute *o, const double *inputs, double *f,
                             mt_arena *scratch, mt_err *err);

/* Geometric stiffness, lower triangle, and bounds of the errors of its entries. */
typedef struct mt_absolute_load {
    double *mu;   /* [rows of a] forces with A^T mu = f */
    double *open; /* [rows of a] what is open of each */
    mt_lower g;
    double *noise; /* [entries of g] */
} mt_absolute_load;

/**
 * That of the loads and of the constraints that hold them. O(bodies log bodies).
 * @param[out] out  mu and open given; the other arrays in mem
 * @param[out] why  the body where *at_rest is false: f - A^T mu is more than rounding, of
 *                  what the positions leave of the springs' forces, too
 * Fails: MT_E_DOMAIN, MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_load_new(const mt_absolute *o, const double *inputs, mt_arena *mem,
                               mt_absolute_load *out, bool *at_rest, char why[MT_ABSOLUTE_WHY],
                               mt_err *err);

/* Modes, of unit mass. */
typedef struct mt_absolute_modes {
    int n;
    const double *x;      /* n x n of the modes */
    const double *mu;     /* rows of a x n: K x + A^T mu = lambda M x */
    const double *lambda; /* [n] above 0, of repeated ones their mean */
    int n_pairs;
    const int (*pair)[2]; /* modes of one lambda each */
    bool dependent;       /* rows of a depend on each other */
} mt_absolute_modes;

/**
 * Slopes of eigenvalues by every input: exact; an input costs O(bodies) where it moves what is
 * drawn, else what it touches.
 * @param[in]  inputs  [n_inputs] those that o was made with
 * @param[out] slope   n_pairs x n_inputs, as mt_tree_slopes
 * @param[out] why     "" or why there are none: loaded, a joint opens, or equations that follow
 *   from others may cease to
 * Scratch is given back. Fails: MT_E_DOMAIN, MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_slopes(const mt_absolute *o, const double *inputs,
                             const mt_absolute_modes *modes, double *slope,
                             char why[MT_ABSOLUTE_WHY], mt_arena *scratch, mt_err *err);

#endif
