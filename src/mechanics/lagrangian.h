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
 * pulls every body to its drawn position (l: of the joints' arms; |R - R0|_F^2/2 = 3 -
 * tr(R0^T R), about theta^2): closing a loop minimises the anchor under the constraints. V = 0
 * gives the constraints alone.
 */
typedef enum mt_energy { MT_ENERGY_PHYSICAL, MT_ENERGY_ANCHOR, MT_ENERGY_NONE } mt_energy;

/* Part of the Hessian: none, all, the geometric part alone (without k grad grad^T of springs),
 * or the rest (k grad grad^T alone; that of the trimmed spring is left out, as in all of
 * it). */
typedef enum mt_curvature {
    MT_CURVATURE_NONE,
    MT_CURVATURE_FULL,
    MT_CURVATURE_GEOMETRIC,
    MT_CURVATURE_ELASTIC
} mt_curvature;

/* Newton's last step, too small to be taken: from the rounded position to the balance of
 * forces. A spring of stiffness k and gradient g has k g . q more force there, which is the
 * force used. */
typedef struct mt_newton_residual {
    double *q;      /* [nq] */
    double *lambda; /* [m] */
    double trim;    /* of the trimmed spring's force */
} mt_newton_residual;

/* A row of the constraints' Jacobian: its possibly nonzero entries. */
typedef struct mt_sparse_row {
    int n;
    int dof[2 * MT_LOCAL];
    double a[2 * MT_LOCAL];
} mt_sparse_row;

typedef struct mt_lagrangian {
    /* in: g, c, a, h and trim are derivatives by the data's input instead of values */
    bool slope;
    double *g;          /* [nq] gradient of V (without lambda) */
    double *c;          /* [m] */
    double *a;          /* m x nq, column-major; NULL: not wanted */
    mt_sparse_row *row; /* [m] rows of a; NULL: not wanted */
    double *h;          /* nq x nq, Hessian of V + lambda c */
    /* not NULL: h is sparse, with a value for each entry of the layout's envelope, 0 in the
     * rows of equations */
    const mt_layout *layout;
    double *trim; /* [nq] gradient of the trimmed spring's measure (where the system has one) */
    /* largest entry of the sum over all loads and springs of |contribution to g|; 0 without
     * loads */
    double force_scale;
    /* rounding error of the stiffest spring's force from rounded positions, unit as
     * force_scale */
    double force_noise;
    /* nq x nq, or NULL: not wanted; sums of magnitudes of the terms of the geometric part of h,
     * which scale the rounding of the positions and of the multipliers */
    double *terms;
    /* [n_pieces], with terms: all forces */
    mt_piece *pieces;
    const double *left;  /* in, [nq]: the remaining step, or NULL */
    const mt_pose *rest; /* in, with terms: [bodies] reference poses of springs and joints */
    int n_pieces;
    /* [bodies], with terms: sum of the magnitudes of all forces on a body, torques divided by
     * the model length */
    double *push;
    double trim_force; /* force of the trimmed spring, in; its own stiffness acts in h only */
    double trim_force_derivative;
} mt_lagrangian;

/* m: number of constraints included (the drive's is the last). lambda may be NULL (0). h is
 * filled as `curvature` says. */
void mt_lagrangian_eval(const mt_data *d, mt_energy energy, const mt_pose *drawn,
                        const mt_placement *at, int m, const mt_cx *lambda,
                        mt_curvature curvature, mt_lagrangian *out);
/* h += curvature of lambda c, after an evaluation without lambda. */
void mt_lagrangian_curve(const mt_data *d, const mt_placement *at, int m, const mt_cx *lambda,
                         mt_lagrangian *out);
/* hessian: h is wanted. Without, it has no memory and curvature must be MT_CURVATURE_NONE. */
mt_status mt_lagrangian_init(mt_lagrangian *l, const mt_system *sys, bool hessian,
                             mt_arena *mem, mt_err *err);
/* Without h, and with A by rows: O(constraints) of memory. */
mt_status mt_lagrangian_init_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                  mt_err *err);
/* out[nq] += A^T lambda, of the first m rows. */
void mt_lagrangian_pull(const mt_lagrangian *l, int m, const double *lambda, double *out);
/* Switch to rows and a sparse Hessian; a shortage is the arena's. */
void mt_lagrangian_want_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem);
/* Fill terms, pieces and push as well, from the next evaluation on. */
mt_status mt_lagrangian_want_terms(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                   mt_err *err);
/* Energy alone. */
double mt_energy_value(const mt_data *d, const mt_placement *at, double trim_force);

#endif
