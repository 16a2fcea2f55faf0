/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_AVOID_H
#define PROBLEM_GOAL_AVOID_H

#include "problem/drive_positions.h"

/*
 * Bands that modes keep clear of: those of all goals "avoid" that name a configuration, united.
 */
/* The bands of each view. After the requirements. */
mt_status mt_avoidances_compile(mt_problem *p, mt_err *err);
/* Views, bands and assignment of a case (mt_subproblem_lay_out), and its rows of
 * `in` behind those of the requirements. */
mt_status mt_avoidance_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                               const mt_cut *cuts, mt_arena *mem, mt_err *err);
/* Fill the rows of all bands, after their views have been solved. */
mt_status mt_avoidance_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err);
/* mt_bands_find (mode_band_pairs.h) of its bands; NaN where the configuration is unstable. */
double mt_avoidance_find_modes(const mt_avoidance *c, const mt_modes *modes, int *below);
/* The mode and the edge that row `row` (0: the first of the bands, behind those of the
 * requirements) of a search with an assignment below[n_bands] holds; false: there is no such
 * row. */
typedef struct mt_avoidance_row {
    int avoidance;
    int band; /* of its list */
    int mode; /* vibration index */
    bool above;
} mt_avoidance_row;
bool mt_avoidance_row_at(const mt_subproblem *c, const int *below, int row,
                         mt_avoidance_row *out);
int mt_avoidance_row_count(const mt_subproblem *c, const int *below);
/* mt_avoidance_find_modes after the view has been solved, with tolerances over them: what the
 * objective "clearance" makes greatest. */
double mt_avoidance_margin(const mt_workspace *w, const mt_avoidance *c);
/* The least of all clears; infinite without bands, NaN where one of them has none. */
double mt_avoidances_margin(const mt_workspace *w);
/* Add to the shapes that are asked of a view (nothing else: those of its rows alone) those of
 * the modes that rows of its bands look at, and of all up to the highest band: there a
 * frequency counts to its last digit. */
void mt_avoidances_query(const mt_subproblem *c, int view, mt_modal_part *shapes);
/* Vibration modes of a view, which has been solved, up to the first above its highest band; 0
 * without bands. */
int mt_avoidances_reach(const mt_workspace *w, int view);

#endif
