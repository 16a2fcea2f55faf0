/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_FREQUENCY_H
#define PROBLEM_GOAL_FREQUENCY_H

#include "problem/workspace.h"

/*
 * Rows in ln f. A spring that starts from 0 has f = 0 and df/dk infinite there, while
 * d(f^2)/dk is finite: below floor_hz, MT_FREQUENCY_FLOOR of what a mode is compared with, ln f
 * goes on as its tangent in f^2,
 *     ln f_0 + (f^2 / f_0^2 - 1) / 2,
 * which has a value and a slope at 0 Hz, the same sign, and the same derivative at f_0. No goal
 * is met down there, whatever its tolerance.
 */
#define MT_FREQUENCY_FLOOR 1e-3
/* A mode at 0 Hz is inside a band that begins there by this much, a factor of 1000 of its upper
 * edge: ln(1 / MT_FREQUENCY_FLOOR). */
#define MT_MOST_INSIDE 7.0
/* ln(f / edge_hz), so continued; of a mode at infinity MT_MOST_INSIDE, without a slope. */
double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz);
/* The same of the mode at pos; -1: at infinity. */
double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz);
/* Its slope lambda'/(2 lambda) for all variables, chained to t: out[n]. A repeated mode: the
 * mean of its cluster, which is smooth where the single modes are not. */
mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err);

#endif
