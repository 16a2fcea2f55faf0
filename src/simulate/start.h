/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_START_H
#define SIMULATE_START_H

#include "simulate/simulate.h"

/* Starts of motions, at rest unless rates are given. */

/* A joint with the required value of its coordinate (from the reference position) or of its
 * rate. */
typedef struct mt_sim_joint {
    int joint; /* of the system; has a coordinate */
    double value;
} mt_sim_joint;

/* Start at the rest position. Fails: MT_E_MEMORY. */
mt_status mt_start_rest(mt_linear *lin, mt_arena *mem, mt_sim_start *out, mt_err *err);
/* Move joints to their values in small steps; the rest of the mechanism follows with the least
 * motion. Begins at `start` (in: the rest position; out), or, where that ends in another
 * assembly of closed loops than the reference position, at the reference position (of a driven
 * system, at the positions of its drives). Fails: MT_E_ASSEMBLY (not all values are reached in
 * the reference assembly; the text says how far), MT_E_MEMORY. */
mt_status mt_start_joints(mt_linear *lin, int n, const mt_sim_joint *joints, mt_arena *mem,
                          mt_sim_start *start, mt_err *err);
/* Move the start along dq[nq] (a shape times its amplitude), then close the joints by the least
 * motion. Fails: MT_E_ASSEMBLY, MT_E_MEMORY. */
mt_status mt_start_along(mt_linear *lin, const double *dq, mt_arena *mem, mt_sim_start *start,
                         mt_err *err);
/* Start at the rest position of `from`, another system of the same configuration that differs
 * in its drives only. Fails: MT_E_INTERNAL (it differs otherwise). */
mt_status mt_start_from(mt_linear *lin, const mt_linear *from, mt_sim_start *start,
                        mt_err *err);
/* Set velocities of least kinetic energy with these rates of joints; drive: [sys->n_drives] the
 * velocities of the driven joints, where locks hold them; NULL: at rest. Fails: MT_E_INPUT (the
 * joints cannot have these rates at once), MT_E_MEMORY. */
mt_status mt_start_rates(mt_linear *lin, int n, const mt_sim_joint *rates, const double *drive,
                         mt_arena *mem, mt_sim_start *start, mt_err *err);

#endif
