/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_TANGENT_H
#define MECHANICS_NEWTON_TANGENT_H

#include "mechanics/newton.h"

/* Derivative of a solved stage by data->input: d[nq] (in: the motion of earlier stages, out: of
 * the solution); sets d_lambda and d_trim_force for the physical energy. No effect where the
 * stage did not run. */
mt_status mt_newton_tangent(const mt_newton_problem *problem, const mt_placement *at,
                            mt_stage *stage, double *d, mt_arena *scratch, mt_err *err);
/*
 * Adjoint: with x and y from the transposed equations of such a stage,
 *     H x + A^T y = pull,  A x = across,  t . x = pull_trim
 * (the last with a trimmed spring, where x has no equation of the drive's row), additional
 * forces f and gaps c change pull . q + across . lambda + pull_trim tau by -(x . f + y . c).
 * pull [nq], across [m], x [nq], y [m].
 */
mt_status mt_newton_adjoint(const mt_stage *stage, const double *pull, const double *across,
                            double pull_trim, double *x, double *y, mt_arena *scratch,
                            mt_err *err);

#endif
