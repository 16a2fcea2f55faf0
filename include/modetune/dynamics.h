/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Accelerations of constrained mechanical systems by the fundamental equation of Udwadia and
 * Kalaba. modetune itself linearises otherwise (it eliminates the constraints and stays
 * symmetric); this equation is the independent formulation that its tests compare with, and
 * serves users who integrate motions.
 */
#ifndef MODETUNE_DYNAMICS_H
#define MODETUNE_DYNAMICS_H

#include "modetune/export.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Accelerations under constraints,
 *     xdd = a + M^-1/2 (A M^-1/2)^+ (b - A a),   M a = Q,
 * with the Moore-Penrose inverse ^+. Constraints may be redundant; contradicting ones hold in
 * the least-squares sense.
 * @param[in]  n    number of coordinates
 * @param[in]  m    number of constraint equations A xdd = b, 0 allowed
 * @param[in]  mass n x n, column-major, symmetric positive definite, lower triangle read
 *   [kg, kg m^2]
 * @param[in]  q    [n] impressed generalised forces [N, N m]
 * @param[in]  a    m x n, column-major, constraint matrix; NULL with m 0
 * @param[in]  b    [m]; NULL with m 0
 * @param[out] xdd [n] accelerations [m/s^2, rad/s^2]
 * No aliasing, inputs unchanged. O(n^3 + n m^2), allocates. Source: Udwadia and Kalaba,
 * Analytical Dynamics: A New Approach, 1996, ch. 3; Eq. 1 of the paper. Fails: MT_E_NOT_SPD
 * (use mt_udwadia_phohomsiri), MT_E_DOMAIN (a number that is not finite), MT_E_NO_CONVERGENCE,
 * MT_E_MEMORY, MT_E_USAGE (n < 1 or m < 0).
 */
MT_API mt_status mt_udwadia_kalaba(int n, int m, const double *mass, const double *q,
                                   const double *a, const double *b, double *xdd, mt_err *err);

/**
 * The same for a singular mass matrix (massless bodies):
 *     xdd = [(I - A^+ A) M; A]^+ [Q; b],
 * unique where [M; A] has rank n. Arguments as of mt_udwadia_kalaba, mass positive
 * semidefinite. Source: Udwadia and Phohomsiri, Explicit equations of motion for constrained
 * mechanical systems with singular mass matrices, Proc. R. Soc. A 462 (2006) 2097-2117. Fails:
 * MT_E_SINGULAR (rank below n: the accelerations are not determined), else as
 * mt_udwadia_kalaba.
 */
MT_API mt_status mt_udwadia_phohomsiri(int n, int m, const double *mass, const double *q,
                                       const double *a, const double *b, double *xdd,
                                       mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
