/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_SADDLE_H
#define MECHANICS_SADDLE_H

#include "mechanics/lagrangian.h"

/*
 * Saddle-point systems of a stage,
 *     [ H  A^T ] [x]   [f]
 *     [ A   0  ] [y] = [b],
 * factored directly, sparse, in the order of the mechanism (system.h), without a basis of the
 * freedoms. With H = I in the elimination's coordinates (eliminate.h) they are least squares: b
 * = 0 gives y with A^T y ~ f, f = 0 gives the least x with A x = b. Rows of A are equilibrated,
 * rotations scaled by the model length, H by its largest entry, so that pivots and norms have
 * the same meaning in all units.
 */
typedef struct mt_saddle {
    const mt_system *sys;
    int m;
    double scale; /* largest entry of H in scaled coordinates [N/m]; 1 where H is 0 */
    double *d;    /* [places] scale of each row and column */
    mt_ldl f;
    bool whole; /* regular, and factored */
} mt_saddle;

/* LEAST_SQUARES: H = I. REGULAR: H = l->h, without pivots that may belong to a freedom without
 * stiffness. SOFT: all pivots above rounding; freedoms without stiffness are detected
 * elsewhere. */
typedef enum mt_saddle_kind {
    MT_SADDLE_LEAST_SQUARES,
    MT_SADDLE_REGULAR,
    MT_SADDLE_SOFT
} mt_saddle_kind;

/* The system with the first m rows of A = l->row. value: work for all entries of the layout's
 * envelope, overwritten; may be l->h where that is H. Results in mem. Fails: MT_E_MEMORY,
 * MT_E_DOMAIN. */
mt_status mt_saddle_factor(const mt_system *sys, int m, const mt_lagrangian *l,
                           mt_saddle_kind kind, double *value, mt_arena *mem, mt_saddle *out,
                           mt_err *err);
/* f [nq] or NULL (0), b [m] or NULL (0); x [nq] and y [m], each may be NULL. */
mt_status mt_saddle_solve(const mt_saddle *s, const double *f, const double *b, double *x,
                          double *y, mt_arena *scratch, mt_err *err);
/* True where all eigenvalues of H on the motions that A allows are above 0. */
bool mt_saddle_convex(const mt_saddle *s);

/*
 * The saddle-point system of a trimmed stage, by the factor of the one in which the drives are
 * held by their multipliers: the last equations stay, what holds them are forces tau along t (a
 * column for each of them),
 *     [ H   A_1^T  t ] [ x ]   [ f   ]
 *     [ A_1   0    0 ] [ y ] = [ b_1 ]
 *     [ a_d   0    0 ] [tau]   [ b_d ].
 */
typedef struct mt_border {
    mt_saddle s;         /* factored */
    int n;               /* trimmed springs */
    const double *along; /* nq x n, t; NULL: nothing is trimmed */
    double *x_along;     /* nq x n, m x n of S^-1 (t, 0) */
    double *y_along;
    double *x_drive; /* nq x n, m x n of S^-1 (0, e_d) */
    double *y_drive;
    double *pivot; /* n x n, x_drive . t */
} mt_border;

/* For the factored s, with t in `along`, which is kept. *sure: the inverse of the whole, in
 * scaled units, is below `most` as far as the border goes. Results in mem. Fails:
 * MT_E_MEMORY. */
mt_status mt_border_init(const mt_saddle *s, const double *along, double most, mt_arena *mem,
                         mt_border *out, bool *sure, mt_err *err);
/* f [nq], b [m]; x [nq], y [m], whose last n entries are 0, and tau [n]. */
mt_status mt_border_solve(const mt_border *border, const double *f, const double *b, double *x,
                          double *y, double *tau, mt_arena *scratch, mt_err *err);
/* The transposed system: t . x = pull [n], and multipliers for the drives' equations in y. */
mt_status mt_border_adjoint(const mt_border *border, const double *f, const double *b,
                            const double *pull, double *x, double *y, mt_arena *scratch,
                            mt_err *err);

#endif
