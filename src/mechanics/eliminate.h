/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_ELIMINATE_H
#define MECHANICS_ELIMINATE_H

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

#endif
