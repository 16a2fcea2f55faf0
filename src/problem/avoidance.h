/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_AVOIDANCE_H
#define PROBLEM_AVOIDANCE_H

#include "problem/drive_positions.h"

/*
 * Bands to be avoided in a configuration: the union over all goals "avoid" that name it.
 */
/* Collects the bands of each configuration. After the requirements. */
mt_status mt_avoidances_compile(mt_problem *p, mt_err *err);
/* mt_bands_find (frequency.h) of its bands; NaN where the configuration is unstable. */
double mt_avoidance_find_modes(const mt_avoidance *c, const mt_modes *modes, int *below);
/* The rows of the bands, in their order, of a search with the mode placement below[n_bands]:
 *     mt_avoidance_rows rows = {.c = c, .below = below};
 *     while (mt_avoidance_next_row(&rows, &row)) { ... }
 */
typedef struct mt_avoidance_rows {
    const mt_subproblem *c;
    const int *below;
    int avoidance; /* the next row's */
    int band;
    int row; /* of this band */
} mt_avoidance_rows;
/* The next row; false after the last. */
bool mt_avoidance_next_row(mt_avoidance_rows *rows, mt_row *out);
/* Adds to the shapes requested of a configuration (empty: those of its rows alone) those of the
 * modes that rows of its bands use, and of all modes up to the highest band, whose frequencies
 * are wanted to the last digit. */
void mt_avoidances_query(const mt_subproblem *c, int view, mt_modal_part *shapes);
/* Number of vibration modes of a solved configuration up to the first above its highest band; 0
 * without bands. */
int mt_avoidances_reach(const mt_workspace *w, int view);

/* Modes and shapes that an evaluation of the present subproblem needs of a configuration. */
mt_analysis_options mt_configuration_queries(const mt_workspace *w,
                                             const mt_configuration_work *view,
                                             bool with_gradient);

#endif
