/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_LAGRANGIAN_H
#define MECHANICS_LAGRANGIAN_H

#include "mechanics/data.h"
#include "mechanics/system.h"

/* The forces at a position, one by one, and the rounding errors of their measures. */

/* One force and the curvature of its work: gradient and Hessian of its measure over the
 * freedoms dof (-1: none). */
typedef struct mt_piece {
    int dof[MT_LOCAL];
    double g[MT_LOCAL];
    double h[MT_RELATIVE_PAIRS]; /* of relative motions, as in mt_relative_jet */
    const mt_relative_list *filled;
    double force; /* Kg is the sum of force h */
    double size;  /* magnitude of the terms of the force, for its rounding */
    /* of a spring: derivative of its force by the measure of the piece at offset `partner` (0:
     * its own; half of the spring's stiffness where it couples two); otherwise 0 */
    double stiffness;
    int partner;
    int trim;      /* of a spring whose force is an unknown, whatever its stiffness; -1: none */
    int equation;  /* equation whose multiplier the force is; -1: none */
    double factor; /* coefficient of the measure in it */
    const mt_measure_def *def; /* the measure; NULL: of the load of a point */
    int spring;                /* whose force it is, with its measure number `side`; -1: none */
    int side;
    int load;       /* -1: none */
    double stretch; /* of a spring: the measure less its rest value */
    /* rounding error of the measure less its rest value, from rounded positions; both are
     * rounded alike where nothing has moved */
    double roundness;
} mt_piece;

/* Column of q for local freedom k (0..11) of a pair of bodies; -1: none. */
static inline int mt_local_dof(const mt_system *sys, const int body[2], int k)
{
    const int b = body[k / 6];
    return b == MT_GROUND ? -1 : sys->bodies[b].dof[k % 6];
}
/* Change of a measure with this jet along a motion of the states. */
double mt_jet_along(const mt_system *sys, const int body[2], const mt_jet *jet,
                    const double *motion);

/* What a motion of the states is to a piece, 0 where it has none. */
static inline void mt_piece_motion(const mt_piece *p, const double *way, double local[MT_LOCAL])
{
    for (int k = 0; k < MT_LOCAL; k++) {
        local[k] = p->dof[k] >= 0 ? way[p->dof[k]] : 0.0;
    }
}

/* The same as a relative motion. */
static inline void mt_piece_relative(const mt_piece *p, const double *way,
                                     double relative[MT_RELATIVE])
{
    double local[MT_LOCAL];
    mt_piece_motion(p, way, local);
    for (int k = 0; k < 3; k++) {
        relative[k] = local[6 + k] - local[k];
        relative[3 + k] = local[3 + k];
        relative[6 + k] = local[9 + k];
    }
}

/* out[MT_RELATIVE] = H x of such motions; h: packed, of which `filled` is not 0. */
static inline void mt_piece_product(const mt_relative_list *filled, const double *h,
                                    const double *x, double *out)
{
    for (int i = 0; i < MT_RELATIVE; i++) {
        out[i] = 0.0;
    }
    for (int ii = 0; ii < filled->n; ii++) {
        const int i = filled->at[ii];
        const double *const row = h + mt_relative_row(i);
        double sum = row[i] * x[i];
        for (int kk = 0; kk < ii; kk++) {
            const int k = filled->at[kk];
            sum += row[k] * x[k];
            out[k] += row[k] * x[i];
        }
        out[i] += sum;
    }
}

/* Entry of H for two local freedoms. */
static inline double mt_piece_entry(const mt_piece *p, int r, int c)
{
    return mt_relative_sign(r) * mt_relative_sign(c) * p->h[mt_relative_pair(r, c)];
}
/* g . way. */
double mt_piece_work(const mt_piece *p, const double *way);
/* out[MT_LOCAL] = H phi, of which what belongs to no state is for nobody; returns
 * phi^T H phi. */
double mt_piece_bend(const mt_piece *p, const double *phi, double *out);
/* to[nq] += c local. */
void mt_piece_add(const mt_piece *p, double c, const double *local, double *to);

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
 * or the rest (k grad grad^T alone; those of trimmed springs are left out, as in all of
 * it). */
typedef enum mt_curvature {
    MT_CURVATURE_NONE,
    MT_CURVATURE_FULL,
    MT_CURVATURE_GEOMETRIC,
    MT_CURVATURE_ELASTIC
} mt_curvature;

/* Forces of the trimmed springs, in the order of their drives. */
typedef struct mt_trim_forces {
    double of[MT_DRIVES_MOST]; /* [sys->n_trims] */
} mt_trim_forces;

/* Newton's last step, too small to be taken: from the rounded position to the balance of
 * forces. A spring of stiffness k and gradient g has k g . q more force there, which is the
 * force used. */
typedef struct mt_newton_residual {
    double *q;      /* [nq] */
    double *lambda; /* [m] */
    mt_trim_forces trim;
} mt_newton_residual;

/* A row of the constraints' Jacobian: its possibly nonzero entries. */
typedef struct mt_sparse_row {
    int n;
    int dof[2 * MT_LOCAL];
    double a[2 * MT_LOCAL];
} mt_sparse_row;

/* The jets of all measures of springs and constraints at one position, each computed once,
 * however often an energy is evaluated there, of any design with the same geometry. */
typedef struct mt_jets {
    int n;                /* of springs' measures, two each, and terms of constraints */
    mt_pose *pose;        /* [bodies] where they are known; NULL: none are kept */
    double *turn;         /* [measures] */
    bool *known;          /* [n] */
    mt_relative_jet *jet; /* [n] */
    /* the numbers that they are of */
    mt_cx (*vec)[3]; /* [vecs] */
    double *beam;    /* [measures x MT_BEAM_NUMBERS], of beams */
} mt_jets;

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
    double *trim; /* nq x n_trims, gradients of the trimmed springs' measures */
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
    const double *left; /* in, [nq]: the remaining step, or NULL */
    /* in: [bodies] reference poses of springs and joints; NULL: not known. Needed with terms */
    const mt_pose *rest;
    mt_jets *jets; /* in, out: of values; NULL: every jet is computed */
    int n_pieces;
    /* [bodies], with terms: sum of the magnitudes of all forces on a body, torques divided by
     * the model length */
    double *push;
    mt_trim_forces trim_force; /* in; their own stiffness acts in h only */
    mt_trim_forces trim_force_derivative;
} mt_lagrangian;

/* m: number of constraints included (those of drives are the last). lambda may be NULL (0). h
 * is filled as `curvature` says. */
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
/* Fill terms, pieces and push as well, from the next evaluation on. */
mt_status mt_lagrangian_want_terms(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                   mt_err *err);
/* Energy alone. forces: of trimmed springs, NULL: 0; jets: those that are known there serve;
 * NULL: none. */
double mt_energy_value(const mt_data *d, const mt_placement *at, const mt_trim_forces *forces,
                       const mt_jets *jets);

/* Visit one force: c times the gradient of a measure of these bodies is its contribution to the
 * gradient of the potential, c times the Hessian that to the geometric stiffness; noise:
 * rounding error of c. False ends the visits. */
typedef bool (*mt_force_visit)(void *context, const int body[2], double c, double noise,
                               const mt_jet *jet);

/* Visit every load, and every spring with a free length or preload, at the given poses; needs
 * the rest values. True where all were visited. O(loads + springs). */
bool mt_forces_each(const mt_data *d, const mt_pose *pose, mt_force_visit visit, void *context);
/* Visit every load and spring at an equilibrium: the forces are those after the motion left[nq]
 * from the rounded position to the balance, known to within open[nq]. */
bool mt_forces_at(const mt_data *d, const mt_placement *at, const double *left,
                  const double *open, mt_force_visit visit, void *context);

#endif
