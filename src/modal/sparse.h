/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SPARSE_H
#define MODAL_SPARSE_H

#include <float.h>

#include "linalg/sparse.h"
#include "modal/lowest.h"

/*
 * K phi + A^T mu = lambda M phi, A phi = 0: a mechanism of any size and topology in coordinates
 * of its bodies. K and M are sums of squares of sparse rows; the rest of K (geometric
 * stiffness) is a matrix of its own.
 */
typedef struct mt_sparse_problem {
    int n;
    mt_squares k;
    const mt_lower *g;     /* additional part of K; NULL: none */
    const double *g_noise; /* bounds of the errors of its entries */
    mt_squares m;
    mt_rows a;          /* rows may be dependent */
    const int *part;    /* [n] see mt_factor_analyse: states of one body */
    const double *unit; /* [n] a state times this is a displacement: 1, or 1/length of a turn */
    int count;          /* vibration modes wanted, at least 1 */
    bool shapes;        /* x as accurately as possible, and the constraint forces */
    mt_status (*check)(void *context, mt_err *err); /* before each product: MT_OK to continue */
    void *context;
} mt_sparse_problem;

enum { MT_SPARSE_WHY = 200 };

/**
 * The lowest modes by Lanczos' method on (K + shift M)^-1 M, with constraints as stiff springs
 * in the factor (linalg/sparse.h) and their forces found by iteration; shift 0 where K allows
 * it. Rigid-body modes are those whose strains are rounding. The errors include the
 * cancellation in strains, as in a long slender chain.
 * @param[out] out       in mem; modes.n: freedoms
 * @param[out] mu        rows of A x modes.count, with shapes: K x + A^T mu = lambda M x of each
 *   vibration mode, in mem; otherwise NULL
 * @param[out] why       the reason where *answered is false: free or unstable without mass
 * Fails: as mt_modal_lowest and mt_factor_make, MT_E_MEMORY, as `check`.
 */
mt_status mt_modal_sparse(const mt_sparse_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          double **mu, bool *answered, char why[MT_SPARSE_WHY], mt_err *err);

/* K + shift M of such a problem, factored to solve for forces. */
typedef struct mt_sparse_solver mt_sparse_solver;

/**
 * Without shift where that can be; else, and where the problem is not held (has rigid-body
 * modes), with lambda, the lowest vibration mode's [rad^2/s^2].
 * @param[out] out  in mem; NULL where sixteen digits do not resolve its motions
 * What p points to outlives it. Fails: as mt_factor_make, MT_E_MEMORY, what `check` fails with.
 */
mt_status mt_sparse_solver_new(const mt_sparse_problem *p, bool held, double lambda,
                               mt_arena *mem, mt_sparse_solver **out, mt_err *err);
double mt_sparse_solver_shift(const mt_sparse_solver *o);
/* (K + shift M) x + A^T mu = f, A x = 0; *noise (may be NULL): a bound of what rounding made of
 * x, in the norm of K + shift M. Fails: what `check` fails with. */
mt_status mt_sparse_solver_solve(mt_sparse_solver *o, const double *f, double *x, double *noise,
                                 mt_err *err);
/* y := M x; y := (K + shift M) x. */
void mt_sparse_solver_mass(mt_sparse_solver *o, const double *x, double *y);
void mt_sparse_solver_stiffness(mt_sparse_solver *o, const double *x, double *y);

/**
 * Constraint forces that balance a load: mu[rows of A] with A^T mu = f[n], of least norm where
 * there are many, least-squares where there are none. Uses n, a, unit and check of p.
 * @param[out] open   [rows of A] about the rounding error of each
 * @param[out] found  false: double precision is not enough
 * Fails: as mt_factor_make, MT_E_MEMORY, as `check`.
 */
mt_status mt_modal_balance(const mt_sparse_problem *p, const double *f, double *mu,
                           double *open, bool *found, mt_err *err);

#endif
