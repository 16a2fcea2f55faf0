/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LAGRANGIAN_H
#define MECHANICS_LAGRANGIAN_H

#include "mechanics/data.h"
#include "mechanics/element_forces.h"
#include "mechanics/layout.h"

/*
 * L = V + sum lambda_i c_i at given positions: gradient of V, constraints with their Jacobian,
 * Hessian of L, all in the left exponential chart at those positions. V is the physical energy
 * (springs, preloads, dead loads), or the anchor 1/2 sum |x - x0|^2 + 1/2 l^2 |R - R0|^2/2 that
 * pulls every body to its drawn position (l: of the joints' arms; |R - R0|_F^2/2 = 3 - tr(R0^T
 * R), about theta^2): closing a loop is minimising the anchor under the constraints. V = 0 is
 * for who wants the constraints alone.
 */
typedef enum mt_energy { MT_ENERGY_PHYSICAL, MT_ENERGY_ANCHOR, MT_ENERGY_NONE } mt_energy;

/* What is wanted of the Hessian: nothing, all of it, the geometric part alone (no k grad grad^T
 * of springs), or the rest of it (k grad grad^T alone; that of the trimmed spring is left out,
 * as in all of it). */
typedef enum mt_curvature {
    MT_CURVATURE_NONE,
    MT_CURVATURE_FULL,
    MT_CURVATURE_GEOMETRIC,
    MT_CURVATURE_ELASTIC
} mt_curvature;

/* The last step of Newton's method, too small to be taken: from the position, which is rounded,
 * to where the forces balance. There a spring of stiffness k and gradient g has k g . q more
 * force, and that is what it counts with. */
typedef struct mt_newton_residual {
    double *q;      /* [nq] */
    double *lambda; /* [m] */
    double trim;    /* of the trimmed spring's force */
} mt_newton_residual;

/* A row of the constraints' Jacobian: its entries that may be other than 0. */
typedef struct mt_sparse_row {
    int n;
    int dof[2 * MT_LOCAL];
    double a[2 * MT_LOCAL];
} mt_sparse_row;

typedef struct mt_lagrangian {
    /* in: derivatives with respect to the input that the data carries instead of values, in g,
     * c, a, h and trim */
    bool slope;
    double *g;          /* [nq] gradient of V (without lambda) */
    double *c;          /* [m] */
    double *a;          /* m x nq, column-major; NULL: not asked for */
    mt_sparse_row *row; /* [m] the same by rows; NULL: not asked for */
    double *h;          /* nq x nq, Hessian of V + lambda c */
    /* NULL, or h is sparse: a value for each entry of the layout's envelope, nothing in the
     * rows of equations */
    const mt_layout *layout;
    double *trim; /* [nq] gradient of the trimmed spring's measure (where the system has one) */
    /* sum over all loads and springs of |contribution to g|, largest entry; 0 where nothing
     * loads */
    double force_scale;
    /* what rounding of the positions may make of the stiffest spring's force, unit as
     * force_scale */
    double force_noise;
    /* nq x nq, or NULL where nobody asks: magnitudes of the terms whose sum the geometric part
     * of h is; rounding of the positions and of the multipliers counts by them */
    double *terms;
    /* [n_pieces], with terms: all forces at work */
    mt_piece *pieces;
    const double *left;  /* in, [nq]: the step that is left, or NULL */
    const mt_pose *rest; /* in, with terms: [bodies] where springs and joints are as drawn */
    int n_pieces;
    /* [bodies], with terms: sum of the magnitudes of all forces on a body, torques as forces at
     * the model length */
    double *push;
    double trim_force; /* force of the trimmed spring, in; its own stiffness acts in h only */
    double trim_force_derivative;
} mt_lagrangian;

/* m: how many constraints take part (the drive's is the last of them). lambda may be NULL (0).
 * h is filled as `curvature` says. */
void mt_lagrangian_eval(const mt_data *d, mt_energy energy, const mt_pose *drawn,
                        const mt_placement *at, int m, const mt_cx *lambda,
                        mt_curvature curvature, mt_lagrangian *out);
/* h += curvature of lambda c, for an evaluation that was made without lambda. */
void mt_lagrangian_curve(const mt_data *d, const mt_placement *at, int m, const mt_cx *lambda,
                         mt_lagrangian *out);
/* hessian: h will be asked for. Without, it has no memory and curvature is
 * MT_CURVATURE_NONE. */
mt_status mt_lagrangian_init(mt_lagrangian *l, const mt_system *sys, bool hessian,
                             mt_arena *mem, mt_err *err);
/* Without h, and with A by rows: O(constraints) of memory. */
mt_status mt_lagrangian_init_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                  mt_err *err);
/* out[nq] += A^T lambda, of the first m rows. */
void mt_lagrangian_pull(const mt_lagrangian *l, int m, const double *lambda, double *out);
/* Rows and a sparse Hessian; a shortage is the arena's. */
void mt_lagrangian_want_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem);
/* Have terms (and what comes with them) filled too, with the next evaluation. */
mt_status mt_lagrangian_want_terms(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                   mt_err *err);
/* Energy alone. */
double mt_energy_value(const mt_data *d, const mt_placement *at, double trim_force);

#endif
