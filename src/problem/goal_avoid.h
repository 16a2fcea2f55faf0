/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_AVOID_H
#define PROBLEM_GOAL_AVOID_H

#include "problem/drive_positions.h"

/*
 * Bands to be avoided in a configuration: the union over all goals "avoid" that name it.
 */
/* Collects the bands of each configuration. After the requirements. */
mt_status mt_avoidances_compile(mt_problem *p, mt_err *err);
/* mt_bands_find (mode_band_pairs.h) of its bands; NaN where the configuration is unstable. */
double mt_avoidance_find_modes(const mt_avoidance *c, const mt_modes *modes, int *below);
/* Row `row` of the bands (0: their first) of a search with the mode placement
 * below[n_bands]; false: no such row. */
bool mt_avoidance_row_at(const mt_subproblem *c, const int *below, int row, mt_row *out);
/* mt_avoidance_find_modes after the configuration has been solved, over the tolerances where
 * there are any: the value that the objective "clearance" maximises. */
double mt_avoidance_margin(const mt_workspace *w, const mt_avoidance *c);
/* The least over all avoidance goals; infinite without bands, NaN where a configuration is
 * unstable. */
double mt_avoidances_margin(const mt_workspace *w);
/* Adds to the shapes requested of a configuration (empty: those of its rows alone) those of the
 * modes that rows of its bands use, and of all modes up to the highest band, whose frequencies
 * are wanted to the last digit. */
void mt_avoidances_query(const mt_subproblem *c, int view, mt_modal_part *shapes);
/* Number of vibration modes of a solved configuration up to the first above its highest band; 0
 * without bands. */
int mt_avoidances_reach(const mt_workspace *w, int view);

#endif
