/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ELIMINATE_H
#define MECHANICS_ELIMINATE_H

#include "base/arena.h"
#include "linalg/dense.h"
#include "mechanics/system.h"

/*
 * Elimination of the constraints A dq = b by pivoted QR of A^T, rows of A equilibrated,
 * rotations scaled by the model length l (a rotation counts as the arc at distance l), so that
 * one relative tolerance decides the rank whatever the units of the model: A_s = D_r A D_c,
 * A_s^T P = Q R.
 *   Z = D_c Q(:, rank+1..)  spans the freedoms:  A Z = 0;  n = nq - rank.
 */
typedef struct mt_elimination {
    int m;
    int nq;
    int n;
    mt_qr qr;   /* of A_s^T, nq x m */
    double *dr; /* [m] */
    double *dc; /* [nq] 1, or 1/l on rotations */
    double *z;  /* nq x n */
} mt_elimination;

/* a: m x nq column-major. Results in mem. */
mt_status mt_eliminate(const mt_system *sys, int m, const double *a, mt_arena *mem,
                       mt_elimination *out, mt_err *err);
/* Parts of mt_eliminate: all but z; the orthonormal basis into e->z (nq x n, allocated). */
mt_status mt_eliminate_factor(const mt_system *sys, int m, const double *a, mt_arena *mem,
                              mt_elimination *out, mt_err *err);
mt_status mt_eliminate_basis(mt_elimination *e, mt_arena *scratch, mt_err *err);
/* v = A^+ b (least norm in scaled coordinates; b in the range of A). */
mt_status mt_eliminate_particular(const mt_elimination *e, const double *b, double *v,
                                  mt_arena *scratch, mt_err *err);
/* lambda: A^T lambda ~ g (basic solution where constraints are redundant). */
mt_status mt_eliminate_multipliers(const mt_elimination *e, const double *g, double *lambda,
                                   mt_arena *scratch, mt_err *err);
/* out = Z^T g; out = Z y. */
void mt_eliminate_project(const mt_elimination *e, const double *g, double *out);
void mt_eliminate_expand(const mt_elimination *e, const double *y, double *out);
/* Left null vector k of A (k < m - rank): a combination of equations that vanishes, w[m], in
 * equilibrated rows, largest entry 1. */
mt_status mt_eliminate_left_null(const mt_elimination *e, int k, double *w, mt_arena *scratch,
                                 mt_err *err);
/* The same with only the first `rank` pivoted equations as independent: the combination is then
 * as small as the rest of R. */
mt_status mt_eliminate_left_vector(const mt_elimination *e, int rank, int k, double *w,
                                   mt_arena *scratch, mt_err *err);

/* Results of an elimination in names of the model. */

/* Joints with dependent equations, each once, in the order of their equations. */
typedef struct mt_joint_names {
    int n;
    const char *const *name; /* [n] of the system */
    const char *text;        /* for messages: "a", "b" (in quotes) */
} mt_joint_names;

/* Joints with an entry in the combination w[m] of the first m equations. In mem. Fails:
 * MT_E_MEMORY. */
mt_status mt_name_joints(const mt_system *sys, int m, const double *w, mt_arena *mem,
                         mt_joint_names *out, mt_err *err);
/* The bodies and directions that dominate the motion Z y: "bob" (along x), "rod" (rotation).
 * y[e->n], text[size]. */
void mt_name_motion(const mt_system *sys, const mt_elimination *e, const double *y, char *text,
                    size_t size);

/*
 * Dependent coordinates d as functions of the free ones f, by independent equations [A_d A_f]
 * dq = 0:
 *     dq_d = -X dq_f,   X = A_d^-1 A_f,
 * with error bounds for entries known to E,
 *     dX = |A_d^-1| (E_d |X| + E_f),
 * which grow as the mechanism transmits its errors, not with the sizes of all steps (Higham,
 * Accuracy and Stability of Numerical Algorithms, 7.2).
 */
typedef struct mt_follow {
    int rank;
    int nq;
    const double *g;     /* rank x nq, row-major: A */
    const double *e;     /* as g: E */
    const bool *follows; /* [nq] true for coordinates in d */
    double *x;           /* out: rank rows of n = nq - rank, X; rows and columns in ascending
                            order of their coordinates */
    double *dx;          /* out: as x, bounds */
} mt_follow;

/* x and dx in mem; *holds false: errors of A as large as E may make A_d singular, and there are
 * none. O(rank^3 + rank^2 n). */
mt_status mt_follow_find(mt_follow *f, mt_arena *mem, bool *holds, mt_err *err);

/*
 * Replace the orthonormal basis of an elimination by one local to the bodies, with one column
 * for each coordinate chosen as free. a: m x nq as in mt_eliminate; mass[nq]: diagonal of the
 * mass matrix [kg; kg m^2]; extent: the largest coordinate [m], for the rounding of arms. e->z
 * keeps size and span; error: nq x n, bounds of its entries' errors; scratch from mem is
 * returned. Where the equations leave only rounding to choose from, the orthonormal basis is
 * kept. O(rank^2 nq) at most; chains cost O(rank nq).
 */
mt_status mt_eliminate_local(const double *a, const double *mass, double extent, mt_arena *mem,
                             mt_elimination *e, double *error, mt_err *err);

#endif
