/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_SEARCH_REPEATED_EIGENVALUES_H
#define SEARCH_SEARCH_REPEATED_EIGENVALUES_H

#include "problem/workspace.h"

/*
 * A row of the problem that is a limit on one mode of an analysis, sign ln(f / limit) >= 0: an
 * upper or a lower limit, an edge of a band (with the objective "clearance" it moves with z:
 * limit exp(sign z)), either of them at a tolerance corner, and either side of a target. Limits
 * on modes selected by name are excluded: other modes may pass them.
 */
typedef struct mt_repeated_eigenvalues_side {
    mt_analysis *analysis; /* of a configuration, or of a tolerance corner */
    /* [n] inputs at the corner / inputs of the design; NULL: the design itself */
    const double *factor;
    double limit_hz;
    double sign; /* +1 at least, -1 at most */
    bool moves;  /* the limit moves with z */
    int row;     /* row of the problem: equalities first, then inequalities */
    int pos;     /* position of the mode at the last evaluation */
} mt_repeated_eigenvalues_side;

/*
 * Limits on modes that (nearly) coincide. A single mode of a cluster has no derivative there,
 * the cluster has: with Y the modes of the cluster at a design t0, C = M Y there and Y(t), L(t)
 * the modes and eigenvalues at a design t nearby, the requirement that all of the cluster is at
 * or above the limit s (at or below: sign -1) is
 *
 *     B(t) = sign W^T (L - s) W / (2 s) positive semidefinite,   W = Y(t)^T C,
 *
 * a smooth function of t (Y W is the projection of Y(t0) on the invariant subspace, whatever
 * the basis), whose derivative where B = 0 is sign W^T Y^T (dK - s dM) Y W / (2 s). Where the
 * best design keeps the modes together, B = 0 (Overton 1992).
 *
 * A target on the lowest mode of a cluster keeps all of it at or above the target (one on the
 * highest: at or below it). That the mode itself is at the target excludes the interior of this
 * cone, not its boundary, and adds no condition of stationarity. A target on a mode in the
 * middle gives no condition at a design that keeps the mode there.
 */
typedef struct mt_repeated_eigenvalues_block {
    mt_repeated_eigenvalues_side side; /* limit on the mode that defines the cluster */
    /* a target on the lowest and on the highest of them: B = 0, its multiplier of any sign */
    bool both;
    int index;    /* vibration index of the lowest mode */
    int r;        /* modes */
    int row_most; /* the row that limits the defining mode; -1: several rows */
    double *c;    /* n x r, n the degrees of freedom of the analysis */
    double *b;    /* r x r, at the last mt_repeated_eigenvalues_eval */
    double *g;    /* n_t matrices r x r: dB/dt_j at that evaluation */
    int n_rows;   /* independent entries of B, at t0 */
    int *entry;   /* [n_rows] k + l r */
    int first;    /* its first equality */
} mt_repeated_eigenvalues_block;

typedef struct mt_repeated_eigenvalues {
    mt_workspace *ws;
    int n_blocks;
    mt_repeated_eigenvalues_block *blocks;
    /* [n_eq + n_in] rows of the problem, equalities first, replaced by the blocks */
    bool *replaced;
    int n_kept;           /* equalities of the problem that remain */
    int n_rows;           /* entries of all blocks, after these */
    double *eq_tol;       /* [n_kept + n_rows] */
    mt_nlp_values values; /* of the problem itself */
} mt_repeated_eigenvalues;

/*
 * Blocks at t: clusters of two or more modes within `near` (relative) of an upper or lower
 * limit on one of them. All in mem. Evaluates the problem at t with gradient; fails as
 * mt_workspace_eval.
 */
mt_status mt_repeated_eigenvalues_find(mt_workspace *ws, const double *t, double near,
                                       mt_arena *mem, mt_repeated_eigenvalues *out,
                                       mt_err *err);
/* The problem with B = 0 in place of the replaced rows; its context is m. */
mt_nlp mt_repeated_eigenvalues_nlp(mt_repeated_eigenvalues *m);

#endif
