/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_ACCELERATE_H
#define SIMULATE_ACCELERATE_H

#include "mechanics/eliminate.h"

/*
 * What Gauss's principle makes of masses M, forces f and equations A x = b: the x that
 * minimises
 *     1/2 x^T M x - f^T x   under   A x = b,
 * accelerations of a mechanism, or velocities (with f = 0 those of least kinetic energy). Its
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
 * @param[out] lambda  [m] M x = f + A^T lambda, a basic solution where rows depend on others;
 *                     NULL: not asked for
 * @param[out] rank    of A; may be NULL
 * Directions without mass and force stay as they are. Scratch comes from mem and goes back.
 * O(nq^2 m + n^3), n = nq - rank. Fails: MT_E_SINGULAR (a direction without mass is pushed),
 * MT_E_DOMAIN, MT_E_MEMORY.
 */
mt_status mt_gauss_solve(const mt_system *sys, const mt_gauss *g, double *x, double *lambda,
                         int *rank, mt_arena *mem, mt_err *err);

/*
 * Solutions one after the other of a motion, whose masses and equations change little from one
 * to the next: with the inverse of
 *     S [M -A^T; A 0] S,   S a scale of each unknown,
 * at an earlier position, what a solution leaves of the present equations is taken off again
 * until it is rounding, a fourth of the work of an elimination. Where that does not converge,
 * or the equations are not regular, mt_gauss_solve has the answer, and its position the next
 * inverse.
 */
typedef struct mt_gauss_near {
    int n; /* unknowns; 0: too many, every solution is by elimination */
    bool known;
    double *inverse; /* n x n */
    double *scale;   /* [n] */
    double *x;       /* [n] */
    double *rest;    /* [n] */
    double *step;    /* [n] */
    long served;     /* by this inverse */
    long wait;       /* eliminations until another one is made */
    long patience;   /* such a wait at least, where the last one did not serve */
} mt_gauss_near;

mt_status mt_gauss_near_init(mt_gauss_near *o, const mt_system *sys, int m, mt_arena *mem,
                             mt_err *err);
/* As mt_gauss_solve. O(nq^2) where the inverse serves. */
mt_status mt_gauss_solve_near(mt_gauss_near *o, const mt_system *sys, const mt_gauss *g,
                              double *x, double *lambda, mt_arena *mem, mt_err *err);

#endif
