/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ABSOLUTE_H
#define MECHANICS_ABSOLUTE_H

#include "linalg/sparse.h"
#include "mechanics/position.h"

/*
 * A mechanism of any size and topology, in its drawn position or in equilibrium under
 * loads, in the coordinates of its bodies; bodies held together by fixed joints count as one. K
 * and M are sums of squares of sparse rows, one for each spring and each part of a mass; A
 * holds the Jacobian rows of the remaining constraints. All costs are O(bodies).
 */
typedef struct mt_absolute {
    const mt_system *sys;
    const mt_state *settled; /* NULL: the drawn position */
    int n;                   /* coordinates */
    mt_squares k;
    mt_squares m;
    mt_rows a;
    int *part;    /* [n] index of the group of bodies, counted from 0 */
    double *unit; /* [n] 1, or 1/length_m for a rotation [1, 1/m] */
    int *with;    /* [bodies] first body of its group, or MT_GROUND */
    int *place;   /* [nq] coordinate of a state; -1: it moves with another body's */
    double *arm;  /* 3 x bodies, from the centre of that first body [m] */
    double mass_kg;
} mt_absolute;

enum { MT_ABSOLUTE_WHY = 200 };

/**
 * @param[in]  inputs   [n_inputs] of the system
 * @param[in]  settled  equilibrium position at these inputs, must outlive out; NULL: the
 *                      drawn position
 * @param[out] out      its arrays in mem
 * @param[out] why      the reason where *is is false: driven, or not closed as drawn
 * Fails: MT_E_DOMAIN (a number has no value), MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_new(const mt_system *sys, const double *inputs, const mt_state *settled,
                          mt_arena *mem, mt_absolute *out, bool *is, char why[MT_ABSOLUTE_WHY],
                          mt_err *err);

/* All numbers at these inputs, and the position; arrays in mem. Fails: MT_E_DOMAIN,
 * MT_E_MEMORY. */
mt_status mt_absolute_stand(const mt_system *sys, const mt_state *settled, const double *inputs,
                            mt_data *data, mt_placement *at, mt_arena *mem, mt_err *err);
/* phi[nq] := x[n] by states. */
void mt_absolute_shape(const mt_absolute *o, const double *x, double *phi);
/* The transpose: f[n] := the coordinates' generalised forces of force[nq] on all states. */
void mt_absolute_push(const mt_absolute *o, const double *force, double *f);
/* The system's channels in the drawn or equilibrium position for n shapes, phi nq x n:
 * value n_channels x n. Scratch is returned. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_absolute_sense(const mt_system *sys, const mt_state *settled, const double *inputs,
                            int n, const double *phi, double *value, mt_arena *scratch,
                            mt_err *err);

/* f[n] := forces of loads and springs at the position, which the constraints balance. Scratch
 * is returned. Fails: MT_E_DOMAIN, MT_E_MEMORY. */
mt_status mt_absolute_forces(const mt_absolute *o, const double *inputs, double *f,
                             mt_arena *scratch, mt_err *err);

/* Geometric stiffness, lower triangle, and bounds of the errors of its entries. */
typedef struct mt_absolute_load {
    double *mu;   /* [rows of a] constraint forces with A^T mu = f */
    double *open; /* [rows of a] bounds of their errors */
    mt_lower g;
    double *noise; /* [entries of g] */
} mt_absolute_load;

/**
 * Geometric stiffness of the loads and of the constraint forces. O(bodies log bodies).
 * @param[out] out  mu and open given; the other arrays in mem
 * @param[out] why  the body where *at_rest is false: f - A^T mu is more than rounding,
 *                  including that of the positions in the springs' forces
 * Fails: MT_E_DOMAIN, MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_load_new(const mt_absolute *o, const double *inputs, mt_arena *mem,
                               mt_absolute_load *out, bool *at_rest, char why[MT_ABSOLUTE_WHY],
                               mt_err *err);

/* Modes, normalised to unit mass. */
typedef struct mt_absolute_modes {
    int n;
    const double *x;      /* n x n of the modes */
    const double *mu;     /* rows of a x n: K x + A^T mu = lambda M x */
    const double *lambda; /* [n] above 0; repeated ones: their mean */
    int n_pairs;
    const int (*pair)[2]; /* pairs of modes with the same lambda */
    bool dependent;       /* rows of a are dependent */
} mt_absolute_modes;

/**
 * Derivatives of eigenvalues by every input: exact; an input costs O(bodies) where it moves the
 * drawing, otherwise the number of terms that depend on it.
 * @param[in]  inputs  [n_inputs] those that o was made with
 * @param[out] slope   n_pairs x n_inputs, as mt_tree_slopes
 * @param[out] why     "", or why there are none: loaded, a joint opens, or dependent equations
 *   may become independent
 * Scratch is returned. Fails: MT_E_DOMAIN, MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_absolute_slopes(const mt_absolute *o, const double *inputs,
                             const mt_absolute_modes *modes, double *slope,
                             char why[MT_ABSOLUTE_WHY], mt_arena *scratch, mt_err *err);

#endif
