/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_H
#define MECHANICS_NEWTON_H

#include "mechanics/position.h"

/* One stage of the position analysis: stationary point of an energy under the first m
 * constraints. */
typedef struct mt_newton_problem {
    mt_data *data;
    mt_energy energy;
    const mt_pose *drawn; /* anchor */
    int m;
    /* the last constraint (the drive) is held by the unknown force of the trimmed spring
     * instead of by its multiplier */
    bool trim;
} mt_newton_problem;

/* Largest |c| of the first m constraints (angles and cosines in model lengths) [m]. */
mt_status mt_newton_gap(const mt_newton_problem *problem, const mt_pose *poses, mt_arena *mem,
                        double *gap_m, mt_err *err);
/* Solve from poses (moved to the solution). Fills stage, and residual, iterations and
 * trim_force of `report`. */
mt_status mt_newton_solve(const mt_newton_problem *problem, mt_pose *poses, mt_arena *mem,
                          mt_state *report, mt_stage *stage, mt_err *err);
/* Derivative with respect to data->input: d (in: the motion so far, out: of the solution); sets
 * d_lambda and d_trim_force for the physical energy. No effect where the stage did not run. */
mt_status mt_newton_tangent(const mt_newton_problem *problem, const mt_pose *poses, mt_state *p,
                            const mt_stage *stage, double *d, mt_arena *scratch, mt_err *err);
/* Find the constraint furthest from closing and name its joint: MT_E_ASSEMBLY. */
mt_status mt_newton_open_loop(const mt_newton_problem *problem, const mt_pose *poses,
                              const mt_elimination *e, mt_arena *scratch, mt_err *err);

#endif
