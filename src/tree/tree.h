/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_H
#define TREE_TREE_H

#include "mechanics/position.h"

/*
 * A mechanism that is a tree, in equilibrium in its drawn position or where it has settled
 * under its loads, in coordinates of its edges. Every body has one parent body (or the
 * ground); joints, springs and shared masses connect a body to its parent only. With v the
 * motion of a body (dx, theta; absolute), X the rigid motion with the parent, and N the motions
 * that the joints of its edge allow,
 *     v_i = X_i v_before(i) + N_i (F_i y_i + R_i r_i):
 * R spans the motions without spring stiffness, and F scales the energy of the edge's springs
 * to |y_i|^2/2. Then
 *     K = diag(I, 0) + T^T K_g T in (y, r),    M = T^T M_bodies T,
 * where T is the recursion from the ground to the leaves and T^T the one back; neither is ever
 * stored. K_g is the geometric stiffness of loads, in blocks as M_bodies. Nothing cancels: in
 * global coordinates the stiffness of a chain of n links has a condition number that grows with
 * n^4; here each spring is an entry of its own.
 *
 * In the coordinates x, K is the identity: x = y without loads (r are then rigid-body motions);
 * with loads, K is eliminated body by body from the leaves, which gives v_i = X'_i v_before +
 * N'_i x_i. All costs are O(bodies). (Featherstone, Rigid Body Dynamics Algorithms, 2008, for
 * the recursions; elimination and count are his articulated-body inertia with K - tau M in
 * place of M.)
 */
typedef struct mt_tree {
    const mt_system *sys;
    const mt_state *settled_at; /* NULL: the drawn position */
    int n;                      /* bodies */
    int s;                      /* entries of v: (dx, dy, theta), or (dx, theta) in space */
    int n_x;                    /* coordinates */
    int n_rigid;                /* rigid-body motions besides x: all r without loads */
    int depth;                  /* bodies on the longest path to the ground */
    int *body;                  /* [n] body of the system, parents first */
    int *before;           /* [n] index of the parent in this order; -1: the ground, or none */
    int *place;            /* [bodies] index of a body of the system in this order */
    int *first_constraint; /* [n] of its edge; -1: none; then next_constraint[constraints] */
    int *next_constraint;
    int *first_spring; /* [n] of its edge, active ones; then next_spring[springs] */
    int *next_spring;
    bool *point;      /* [n] a point mass: no rotation */
    int *y_at;        /* [n + 1] */
    int *free_dof_at; /* [n + 1] */
    double *arm;      /* 3 x n, from the parent's centre to its own [m] */
    double *basis;  /* columns N F, then N R, of body i from s (y_at[i] + free_dof_at[i]) on */
    double *length; /* [n] of its edge: scales rotations to translations [m] */
    /* [n] greatest rotation of a column of its edge by rounding, relative to the column's size,
     * in roundings: 1 over the distance of its equations from dependent ones */
    double *condition;
    double *lost;   /* by y: the same for the energy of each coordinate, from cancellation */
    double *mass;   /* s x s of each body */
    double *shared; /* s x s: v_before^T shared v_i; NULL: no mass is shared */
    /* s x s of each body: geometric stiffness; NULL: nothing loads */
    double *geometric_stiffness;
    double *geometric_stiffness_shared; /* as shared */
    double *force;  /* [n] sum of |forces| on the body and its descendants [N] */
    double *pushed; /* s x n: gradient of the loads' potential for the same */
    double *held;   /* [constraints] multiplier of each equation */
    /* of where it has settled: the largest motion to where the forces balance [model lengths,
     * rad], and what is unbalanced there as a part of the forces */
    double astray;
    double unbalanced;
    double *transport; /* X', s x s of each body; NULL without loads */
    double *scaled;    /* N', as basis; NULL without loads */
    double *settled;   /* sum of |terms| of each body's stiffness, s x s; NULL without loads */
} mt_tree;

enum { MT_TREE_WHY = 200, MT_TREE_FREE_DOFS = 64 };

/**
 * @param[in]  inputs   [n_inputs] of the system
 * @param[in]  settled  its equilibrium there (MT_POSITION_SPARSE), must outlive out; NULL: the
 *                      drawn position
 * @param[out] out      in mem; NULL where the system is not such a tree
 * @param[out] moves    then: only because the position is not closed or not at rest
 * @param[out] why      then the reason: "joint \"a\" is part of a loop"
 * Fails: MT_E_DOMAIN (a number has no value), MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_tree_new(const mt_system *sys, const double *inputs, const mt_state *settled,
                      mt_arena *mem, mt_tree **out, bool *moves, char why[MT_TREE_WHY],
                      mt_err *err);

/* v[s n] := T (x, r); r may be NULL (0). */
void mt_tree_motion(const mt_tree *t, const double *x, const double *r, double *v);
/* x[n_x], r[n_rigid] (may be NULL) := T^T M_bodies v; f[s n] is work. */
void mt_tree_momentum(const mt_tree *t, const double *v, double *f, double *x, double *r);
/* Generalised forces of forces on the bodies: x, r := T^T f; f[s n] is overwritten. */
void mt_tree_gather(const mt_tree *t, double *f, double *x, double *r);
/* f[s n] := forces on the bodies from those on states, force[nq]. */
void mt_tree_push(const mt_tree *t, const double *force, double *f);
/* w[s n] := motion of each body relative to its parent: N (F y + R r). v from mt_tree_motion of
 * the same (x, r). */
void mt_tree_within(const mt_tree *t, const double *x, const double *r, const double *v,
                    double *w);
/* f[s n] := sum of (K_g - lambda M_bodies) v over each body and its descendants: the force that
 * its edge transmits. */
void mt_tree_transport(const mt_tree *t, double lambda, const double *v, double *f);
/* Rayleigh quotient of a motion, lambda = energy / mass; noise: its relative rounding error. */
typedef struct mt_tree_quotient {
    double lambda;
    double mass; /* v^T M_bodies v */
    double noise;
} mt_tree_quotient;
/* v from mt_tree_motion of (x, r), f from mt_tree_momentum of v; r may be NULL (0). */
void mt_tree_rate(const mt_tree *t, const double *x, const double *r, const double *v,
                  const double *f, mt_tree_quotient *q);
/* phi[nq] := v by states of the system. */
void mt_tree_states(const mt_tree *t, const double *v, double *phi);
/* Mass of all bodies [kg]. */
double mt_tree_mass(const mt_tree *t);
/* *below: number of eigenvalues of K - tau M below 0, by Sylvester's law, which is the number
 * of modes with lambda < tau, rigid-body modes included (tau > 0). *certain: no pivot is so
 * small that its sign may be due to rounding. Scratch s^2 n. Fails: MT_E_MEMORY. */
mt_status mt_tree_count(const mt_tree *t, double tau, mt_arena *scratch, int *below,
                        bool *certain, mt_err *err);

/* Modes of a tree, normalised to unit mass. */
typedef struct mt_tree_modes {
    int n;
    const double *x;      /* n_x x n */
    const double *r;      /* n_rigid x n: rigid-body part */
    const double *v;      /* s n x n, T (x, r) */
    const double *lambda; /* [n]; repeated ones: their mean */
    int n_pairs;
    const int (*pair)[2]; /* pairs of modes with the same lambda */
} mt_tree_modes;

/**
 * Derivatives of eigenvalues by every input: exact, O(bodies) for an input that all bodies
 * depend on.
 * @param[in]  inputs  [n_inputs] those that the tree was made with, in its drawn position
 * @param[out] slope   n_pairs x n_inputs, phi_a^T (K - lambda M)' phi_b in the freedoms:
 *   lambda' for a pair (a, a); for repeated modes the matrix whose eigenvalues are their
 *   directional derivatives
 * @param[out] why     "", or why there are none: "by parameter \"L\" the drawing comes to rest
 *   elsewhere"
 * Scratch is returned. Fails: MT_E_DOMAIN (a number has no derivative), MT_E_INTERRUPTED,
 * MT_E_NOT_SPD, MT_E_MEMORY.
 */
mt_status mt_tree_slopes(const mt_tree *t, const double *inputs, const mt_tree_modes *modes,
                         double *slope, char why[MT_TREE_WHY], mt_arena *scratch, mt_err *err);

/* For the sources of this room. */
enum { MT_TREE_MOTION = 6, MT_TREE_EDGE_ROWS = 64 };

/* Local freedom (0..5) of entry k of a body's motion. */
static inline int mt_tree_freedom(const mt_tree *t, int k)
{
    return t->s == MT_TREE_MOTION || k < 2 ? k : MT_TREE_MOTION - 1;
}
/* p += X_i^T f. */
void mt_tree_carry_back(const mt_tree *t, int i, const double *f, double *p);

/* Columns N F, then N R of body i; N' with loads. */
static inline const double *mt_tree_basis(const mt_tree *t, int i)
{
    return (t->scaled != NULL ? t->scaled : t->basis) +
           ((ptrdiff_t)t->s * (t->y_at[i] + t->free_dof_at[i]));
}

/* Coordinates x of body i: the first. */
static inline int mt_tree_first(const mt_tree *t, int i)
{
    return t->scaled != NULL ? t->y_at[i] + t->free_dof_at[i] : t->y_at[i];
}
/* The equations of an edge, rows of A, and the factor of A A^T scaled to a unit diagonal. */
typedef struct mt_tree_held {
    int c;
    double row[MT_TREE_MOTION * MT_TREE_MOTION];
    double gram[MT_TREE_MOTION * MT_TREE_MOTION];
    double scale[MT_TREE_MOTION];
} mt_tree_held;
/* Factor the equations, row: c x s, by row. Fails: MT_E_NOT_SPD (the equations are
 * dependent). */
mt_status mt_tree_hold(const mt_tree *t, int c, const double *row, mt_tree_held *h,
                       mt_err *err);
/* lambda[c]: least-squares solution of A^T lambda = -g. */
void mt_tree_multipliers(const mt_tree *t, const mt_tree_held *h, const double *g,
                         double *lambda);
/* After masses and loads: fill transport, scaled and settled; *positive: all pivots of K are
 * positive beyond rounding. Fails: MT_E_MEMORY. */
mt_status mt_tree_factor(mt_tree *t, mt_arena *scratch, bool *positive, mt_err *err);

#endif
