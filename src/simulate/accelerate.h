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

#endif
