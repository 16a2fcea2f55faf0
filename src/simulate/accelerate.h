/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_ACCELERATE_H
#define SIMULATE_ACCELERATE_H

#include "mechanics/eliminate.h"

/*
 * The solution of Gauss's principle for masses M, forces f and equations A x = b: the x that
 * minimises
 *     1/2 x^T M x - f^T x   under   A x = b,
 * the accelerations of a mechanism, or (with f = 0) the velocities of least kinetic energy. Its
 * solution is the equation of Udwadia and Kalaba,
 *     x = M^-1 f + M^-1/2 (A M^-1/2)^+ (b - A M^-1 f),
 * and where M is singular that of Udwadia and Phohomsiri (modetune/dynamics.h); A may have more
 * rows than rank.
 */
typedef struct mt_gauss {
    int m;
    const double *mass; /* nq x nq, both triangles */
    const double *force;
    const double *a; /* m x nq, column-major */
    const double *b; /* [m] */
} mt_gauss;

/**
 * @param[out] x       [nq]
 * @param[out] lambda [m] M x = f + A^T lambda, a basic solution where rows depend on others;
 *                     NULL: not requested
 * @param[out] rank    of A; may be NULL
 * x is 0 along directions without mass and force. Scratch memory in mem is released. O(nq^2 m +
 * n^3), n = nq - rank. Fails: MT_E_SINGULAR (a force along a direction without mass),
 * MT_E_DOMAIN, MT_E_MEMORY.
 */
mt_status mt_gauss_solve(const mt_system *sys, const mt_gauss *g, double *x, double *lambda,
                         int *rank, mt_arena *mem, mt_err *err);

/*
 * Successive solutions along a motion, whose masses and equations change little between them:
 * with the inverse of
 *     S [M -A^T; A 0] S,   S a scale of each unknown,
 * at an earlier position, the residual of the present equations is reduced by iterative
 * refinement until it is rounding, for a fourth of the work of an elimination. Where that does
 * not converge, or the equations are singular, mt_gauss_solve gives the answer, and its
 * position the next inverse.
 */
typedef struct mt_gauss_near {
    int n; /* unknowns; 0: too many, every solution by elimination */
    bool known;
    double *inverse; /* n x n */
    double *scale;   /* [n] */
    double *x;       /* [n] */
    double *rest;    /* [n] */
    double *step;    /* [n] */
    long served;     /* solutions by this inverse */
    long wait;       /* eliminations until the next inverse */
    long patience;   /* least wait after an inverse that did not converge */
} mt_gauss_near;

mt_status mt_gauss_near_init(mt_gauss_near *o, const mt_system *sys, int m, mt_arena *mem,
                             mt_err *err);
/* As mt_gauss_solve. O(nq^2) where the inverse serves. */
mt_status mt_gauss_solve_near(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              double *x, double *lambda, mt_arena *mem, mt_err *err);

#endif
