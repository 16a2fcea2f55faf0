/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREE_TREE_H
#define TREE_TREE_H

#include "mechanics/system.h"

/*
 * A mechanism that is a tree, drawn at rest, in coordinates of its edges. Every body has one
 * body (or the ground) before it; joints, springs and masses that two bodies share stand
 * between a body and the one before it. With v the motion of a body (dx, theta; absolute), X
 * the rigid motion along with the body before it, and N the motions that the joints of its edge
 * allow,
 *     v_i = X_i v_before(i) + N_i (F_i y_i + R_i r_i):
 * R spans what no spring of the edge resists, and F makes the energy of its springs |y_i|^2/2.
 * Then
 *     K = diag(I, 0) + T^T K_g T in (y, r),    M = T^T M_bodies T,
 * T being the recursion from the ground to the leaves and T^T the one back: neither is ever
 * written down. K_g is the geometric stiffness of loads, in blocks as M_bodies. Nothing
 * cancels: in coordinates of the ground the stiffness of a chain of n links has a condition
 * that grows with n^4, here each spring stands in an entry of its own.
 *
 * The coordinates x are those in which K is the identity: y where nothing loads (r are then
 * rigid-body motions); else K is eliminated body by body, from the leaves on, which makes
 * v_i = X'_i v_before + N'_i x_i. All costs are O(bodies).
 * (Featherstone, Rigid Body Dynamics Algorithms, 2008, for the recursions; elimination and
 * count are his articulated-body inertia with K - tau M in place of M.)
 */
typedef struct mt_tree {
    const mt_system *sys;
    int n;                 /* bodies */
    int s;                 /* entries of v: (dx, dy, theta), or (dx, theta) in space */
    int n_x;               /* coordinates */
    int n_rigid;           /* rigid-body motions beside them: all r, where nothing loads */
    int depth;             /* bodies on the longest way to the ground */
    int *body;             /* [n] of the system, each behind the one before it */
    int *before;           /* [n] place in this order; -1: the ground, or nothing */
    int *place;            /* [bodies] of the system: where in this order */
    int *first_constraint; /* [n] of its edge; -1: none; then next_constraint[constraints] */
    int *next_constraint;
    int *first_spring; /* [n] of those that act, likewise; next_spring[springs] */
    int *next_spring;
    bool *point;      /* [n] a point mass: does not turn */
    int *y_at;        /* [n + 1] */
    int *free_dof_at; /* [n + 1] */
    double *arm;      /* 3 x n, to the centre from that of the body before it [m] */
    double *basis;    /* N F, then N R, of body i from s (y_at[i] + free_dof_at[i]) on */
    double *length;   /* [n] of its edge: makes translations and rotations alike [m] */
    /* [n] what rounding may turn a column of its edge by, as a part of the column's size, in
     * roundings: 1 over how far its equations are from dependent ones */
    double *warning;
    double *lost;   /* by y: likewise of the energy of each, for what cancels in it */
    double *mass;   /* s x s of each body */
    double *shared; /* s x s: v_before^T shared v_i; NULL: no mass is shared */
    /* s x s of each body: geometric stiffness; NULL: nothing loads */
    double *geometric_stiffness;
    double *geometric_stiffness_shared; /* as shared */
    double *force;     /* [n] sum of the sizes of all forces there, and beyond [N] */
    double *pushed;    /* s x n: gradient of the loads' potential there, and beyond */
    double *held;      /* [constraints] what each equation holds of them */
    double *transport; /* X', s x s of each body, where something loads */
    double *scaled;    /* N', as basis */
    double *settled;   /* sizes of all that made the stiffness of each, s x s, likewise */
} mt_tree;

enum { MT_TREE_WHY = 200, MT_TREE_FREE_DOFS = 64 };

/**
 * @param[in]  inputs  [n_inputs] of the system
 * @param[out] out     in mem; NULL where the system is no such tree
 * @param[out] why     then the reason: "joint \"a\" is part of a loop"
 * Fails: MT_E_DOMAIN (a number has no value), MT_E_INTERRUPTED, MT_E_MEMORY.
 */
mt_status mt_tree_new(const mt_system *sys, const double *inputs, mt_arena *mem, mt_tree **out,
                      char why[MT_TREE_WHY], mt_err *err);

/* v[s n] := T (x, r); r may be NULL (0). */
void mt_tree_motion(const mt_tree *t, const double *x, const double *r, double *v);
/* x[n_x], r[n_rigid] (may be NULL) := T^T M_bodies v; f[s n] is work. */
void mt_tree_momentum(const mt_tree *t, const double *v, double *f, double *x, double *r);
/* The same of forces on the bodies: x, r := T^T f; f[s n] is overwritten. */
void mt_tree_gather(const mt_tree *t, double *f, double *x, double *r);
/* f[s n] := forces of the bodies, of those on states, force[nq]; v[s n] := the motion of all
 * bodies by 1 along a global axis. */
void mt_tree_push(const mt_tree *t, const double *force, double *f);
void mt_tree_shift(const mt_tree *t, int axis, double *v);
/* w[s n] := what each body does beyond moving along with the one before it: N (F y + R r). v
 * from mt_tree_motion of the same (x, r). */
void mt_tree_within(const mt_tree *t, const double *x, const double *r, const double *v,
                    double *w);
/* f[s n] := (K_g - lambda M_bodies) v of each body and all beyond it: what its edge carries. */
void mt_tree_transport(const mt_tree *t, double lambda, const double *v, double *f);
/* What a motion says of its mode: lambda = energy / mass, and the part of it that rounding may
 * have made. */
typedef struct mt_tree_quotient {
    double lambda;
    double mass; /* of the motion: v^T M_bodies v */
    double noise;
} mt_tree_quotient;
/* v from mt_tree_motion of (x, r), f from mt_tree_momentum of v; r may be NULL (0). */
void mt_tree_rate(const mt_tree *t, const double *x, const double *r, const double *v,
                  const double *f, mt_tree_quotient *q);
/* phi[nq] := v by states. */
void mt_tree_states(const mt_tree *t, const double *v, double *phi);
/* Mass of all bodies [kg]. */
double mt_tree_mass(const mt_tree *t);
/* How many eigenvalues of K - tau M are below 0, by Sylvester's law: *below counts
 * the modes with lambda < tau, rigid-body modes included (tau > 0). *certain: no pivot is so
 * small that rounding may have made its sign. Scratch s^2 n. Fails: MT_E_MEMORY. */
mt_status mt_tree_count(const mt_tree *t, double tau, mt_arena *scratch, int *below,
                        bool *certain, mt_err *err);

/* Modes of a tree, of unit mass. */
typedef struct mt_tree_modes {
    int n;
    const double *x;      /* n_x x n */
    const double *r;      /* n_rigid x n: what follows */
    const double *v;      /* s n x n, T (x, r) */
    const double *lambda; /* [n] of repeated ones their mean */
    int n_pairs;
    const int (*pair)[2]; /* modes of one lambda each */
} mt_tree_modes;

/**
 * Slopes of eigenvalues by every input: exact, O(bodies) for an input that touches everything.
 * @param[in]  inputs  [n_inputs] those that the tree was made with
 * @param[out] slope   n_pairs x n_inputs, phi_a^T (K - lambda M)' phi_b in coordinates of the
 *   freedoms: of a pair (a, a) lambda', of repeated modes the matrix whose eigenvalues are
 *   their directional derivatives
 * @param[out] why     "" or why there are none: "by parameter \"L\" the drawing comes to rest
 *   elsewhere"
 * Scratch is given back. Fails: MT_E_DOMAIN (a number has no derivative), MT_E_INTERRUPTED,
 * MT_E_NOT_SPD, MT_E_MEMORY.
 */
mt_status mt_tree_slopes(const mt_tree *t, const double *inputs, const mt_tree_modes *modes,
                         double *slope, char why[MT_TREE_WHY], mt_arena *scratch, mt_err *err);

#endif
