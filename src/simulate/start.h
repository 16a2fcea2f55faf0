/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_START_H
#define SIMULATE_START_H

#include "simulate/simulate.h"

/* Where motions begin. All at rest unless rates are given. */

/* A joint, and where its coordinate is to be (from the reference position), or how fast. */
typedef struct mt_sim_joint {
    int joint; /* of the system; has a coordinate */
    double value;
} mt_sim_joint;

/* At the rest position. Fails: MT_E_MEMORY. */
mt_status mt_start_rest(mt_linear *lin, mt_arena *mem, mt_sim_start *out, mt_err *err);
/* Joints moved to their places over small steps, the rest of the mechanism following with the
 * least motion: from start (in: the rest position; out), or, where that is another assembly of
 * closed loops than the drawing, from the reference position (of a driven system, from where
 * the drive brings it). Fails: MT_E_ASSEMBLY (in the drawing's assembly they do not all get
 * there; the text says how far), MT_E_MEMORY. */
mt_status mt_start_joints(mt_linear *lin, int n, const mt_sim_joint *joints, mt_arena *mem,
                          mt_sim_start *start, mt_err *err);
/* Moved along dq[nq] (a shape times its amplitude), then closed by the least motion. Fails:
 * MT_E_ASSEMBLY, MT_E_MEMORY. */
mt_status mt_start_along(mt_linear *lin, const double *dq, mt_arena *mem, mt_sim_start *start,
                         mt_err *err);
/* Where `from`, another system of the same configuration whose drive alone is different, stands
 * at rest. Fails: MT_E_INTERNAL (it is not). */
mt_status mt_start_from(mt_linear *lin, const mt_linear *from, mt_sim_start *start,
                        mt_err *err);
/* Velocities with these rates of joints, of least kinetic energy; drive: the velocity of the
 * driven joint. Fails: MT_E_INPUT (the joints cannot have them at once), MT_E_MEMORY. */
mt_status mt_start_rates(mt_linear *lin, int n, const mt_sim_joint *rates, double drive,
                         mt_arena *mem, mt_sim_start *start, mt_err *err);

#endif
