/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LANCZOS_H
#define LINALG_LANCZOS_H

#include "base/arena.h"

/*
 * The largest eigenvalues of an operator A of which only products with vectors are known,
 * self-adjoint and positive semidefinite in the inner product x^T M y (M positive semidefinite,
 * A x = 0 where M x = 0): Lanczos' method with full reorthogonalisation and thick restarts (Wu
 * and Simon, SIAM J. Matrix Anal. Appl. 22, 2000), in the complement of locked vectors. Blocks
 * take fewer products of more columns, which pays where several columns cost little more than
 * one. A repeated eigenvalue may be found only as many times as a block has columns: a caller
 * that counts the eigenvalues by other means calls again with the found vectors locked.
 */
typedef struct mt_lanczos {
    int n;
    int wanted;
    int block; /* greatest number of columns per product with A; 0: one */
    int seed;  /* of the start vectors: the same seed gives the same bytes */
    /* Y := A X, n x count, at most `block`; a failure ends the iteration */
    mt_status (*apply)(void *context, int count, const double *x, double *y, mt_err *err);
    /* y := M x; NULL: M is the identity */
    void (*metric)(void *context, const double *x, double *y);
    void *context;
    int n_locked;
    const double *locked; /* n x n_locked, M-orthonormal */
} mt_lanczos;

/**
 * @param[out] x      n x wanted, M-orthonormal columns, by descending eigenvalues
 * @param[out] found  number of columns; < wanted where A has no more nonzero eigenvalues
 * An eigenvalue is found when the residual ||A x - theta x|| in the norm of M is below 1e-9
 * theta, and below 64 eps times the largest one (or below 4 eps times that): the error of its
 * Rayleigh quotient is then the square of that, over the gap. Scratch n (2 wanted + 25 block)
 * from mem. Fails: MT_E_NO_CONVERGENCE, as apply, MT_E_MEMORY.
 */
mt_status mt_lanczos_largest(const mt_lanczos *problem, mt_arena *mem, double *x, int *found,
                             mt_err *err);

#endif
