/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_BASE_MOTION_H
#define MECHANICS_BASE_MOTION_H

#include "mechanics/position.h"

/*
 * What a moving ground does to a mechanism. With r the rigid motion of the ground and of
 * everything with it, by 1 along a global axis or by 1 rad about one, the motion relative to
 * the ground is driven by -M r times the ground's acceleration, and a mode phi by its
 * participation factor,
 *     Gamma = phi^T M r / (phi^T M phi),   effective modal mass  Gamma^2 (phi^T M phi)
 * (Clough and Penzien, Dynamics of Structures, sec. 12-8; ECSS-E-HB-32-26A, sec. 5.4). Over all
 * modes effective masses sum up to
 *     r^T M Z (Z^T M Z)^-1 Z^T M r,   Z: what the joints allow relative to the ground,
 * which is r^T M r of all that moves where r is such a motion, and less where the ground holds
 * part of it: a guided mass has no mode across its guide, a bar none for its held end.
 */
enum { MT_BASE_MOTIONS = 6 };
typedef struct mt_base_motion {
    int n;                     /* directions: 6; in the plane 3 */
    int axis[MT_BASE_MOTIONS]; /* [n] 0..2: along x y z; 3..5: about */
    double about_m[3];
    /* [n] r^T M r of all that the ground does not hold by fixed joints [kg, kg m^2] */
    double total[MT_BASE_MOTIONS];
    double *momentum; /* nq x n: M r, with the parts of the held ends of bars */
} mt_base_motion;

/**
 * @param[in]  settled  position at these inputs, NULL: the drawn one
 * @param[in]  inputs   [n_inputs] of the system
 * @param[in]  about    that rotations are about [m], global
 * @param[out] out      in mem
 * O(bodies). Fails: MT_E_DOMAIN (a number has no value), MT_E_MEMORY.
 */
mt_status mt_base_motion_new(const mt_system *sys, const mt_state *settled,
                             const double *inputs, const double about[3], mt_arena *mem,
                             mt_base_motion *out, mt_err *err);
/* gamma[n] of a mode of unit modal mass, phi[nq]; what is rounding of the total is 0. */
void mt_base_motion_participation(const mt_base_motion *b, int nq, const double *phi,
                                  double *gamma);
/* "x", "rz". */
const char *mt_base_motion_name(int axis);

#endif
