/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_TANGENT_H
#define MECHANICS_NEWTON_TANGENT_H

#include "mechanics/newton.h"

/* Derivative with respect to data->input of a stage that was solved: d[nq] (in: the motion so
 * far, out: of the solution); sets d_lambda and d_trim_force for the physical energy. No effect
 * where the stage did not run. */
mt_status mt_newton_tangent(const mt_newton_problem *problem, const mt_placement *at,
                            mt_stage *stage, double *d, mt_arena *scratch, mt_err *err);

#endif
