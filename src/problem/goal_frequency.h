/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_FREQUENCY_H
#define PROBLEM_GOAL_FREQUENCY_H

#include "problem/workspace.h"

/*
 * Rows in ln f. A spring of stiffness 0 gives f = 0 and df/dk infinite, while d(f^2)/dk is
 * finite: below floor_hz, MT_FREQUENCY_FLOOR of the frequency compared with, ln f is continued
 * by its tangent in f^2,
 *     ln f_0 + (f^2 / f_0^2 - 1) / 2,
 * with a finite value and slope at 0 Hz, the same sign, and the same derivative at f_0. No goal
 * is met below floor_hz, whatever its tolerance.
 */
#define MT_FREQUENCY_FLOOR 1e-3
/* Log depth of a mode at 0 Hz in a band that begins there, a factor of 1000 of its upper edge:
 * ln(1 / MT_FREQUENCY_FLOOR). */
#define MT_MOST_INSIDE 7.0
/* ln(f / edge_hz), continued as above; of a mode at infinity MT_MOST_INSIDE, without a
 * slope. */
double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz);
/* The same for the mode at pos; -1: at infinity. */
double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz);
/* out[n]: its slope lambda'/(2 lambda) with respect to all coordinates t. Of a repeated mode:
 * the mean of its cluster, which is smooth where single modes are not. */
mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err);

#endif
