/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_DISPLACED_H
#define MECHANICS_DISPLACED_H

#include "mechanics/linear.h"

/*
 * The nonlinear equations of motion, M(q) qdd = Q(q) + A(q)^T lambda at rest, over all states
 * and at positions near the linearised one.
 */

/**
 * @param[in]  lin  after mt_linear_update; its scratch is used
 * @param[in]  dq   [nq] displacement from the linearised position: each body is moved by dx and
 *                  turned by exp(theta) [m, rad]; NULL: none
 * @param[out] m    nq x nq mass matrix, both triangles, column-major [kg, kg m^2]
 * @param[out] q    [nq] impressed forces of springs and loads, trimmed spring included;
 *                  no constraint forces [N, N m]
 * @param[out] a    constraint Jacobian, mt_linear_equations(lin) x nq, column-major
 * @param[out] c    violation of each of these constraints [m, rad, cosine]; NULL: not wanted
 *
 * A x = 0 holds for the velocities that the joints allow; at rest the right-hand side of A xdd
 * = b is zero. Fails: MT_E_MEMORY.
 */
mt_status mt_displaced_eval(mt_linear *lin, const double *dq, double *m, double *q, double *a,
                            double *c, mt_err *err);

#endif
