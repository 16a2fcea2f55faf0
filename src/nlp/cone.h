/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_CONE_H
#define NLP_CONE_H

#include <stdbool.h>

#include "base/arena.h"

/*
 * Stationarity of a point where eigenvalues repeat. For minimise f under rows c_i (>= 0, or =
 * 0) and symmetric matrices B_b(t) that must stay positive semidefinite, all of them active at
 * t, stationarity is
 *
 *     grad f = sum_i x_i grad c_i + sum_b <U_b, dB_b>,   x_i >= 0 (free for an equality),
 *         U_b positive semidefinite.
 *
 * z, the residual of least norm, is 0 at a stationary point; otherwise -z lowers f and, to
 * first order, violates no constraint.
 */
typedef struct mt_cone_block {
    int r;           /* order */
    const double *g; /* n matrices r x r (symmetric): dB/dt_j at g + j r^2 */
    double *u;       /* r x r: [out] U */
} mt_cone_block;

typedef struct mt_cone {
    int n;
    const double *gradient; /* [n] of f */
    int n_rows;
    const double *rows;    /* n x n_rows: grad c_i */
    const bool *free_sign; /* [n_rows] */
    int n_blocks;
    const mt_cone_block *blocks;
    double *x;  /* [n_rows] [out] */
    double *z;  /* [n] [out] */
    double kkt; /* [out] |z| relative to the largest part of the balance */
} mt_cone;

/*
 * Computes the outputs. Method: non-negative least squares (Lawson and Hanson 1974); the U are
 * sums of atoms v v^T, and while some v^T (sum_j z_j dB_j) v is positive, the v of the largest
 * is added. Fails: MT_E_MEMORY, as linear algebra.
 */
mt_status mt_cone_residual(mt_cone *c, mt_arena *scratch, mt_err *err);

#endif
