/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_AT_POSITION_H
#define PROBLEM_AT_POSITION_H

#include "problem/drive_positions.h"

/* Limits at more positions of a drive than a study names: of each cut a
 * view and its requirement, whose rows in `in` follow all others, so that those keep their
 * numbers. For mt_subproblem_lay_out, after the bands; cuts of these are left out. Fails:
 * MT_E_MEMORY. */
mt_status mt_at_position_lay_out(mt_subproblem *c, int n_cuts, const mt_cut *cuts,
                                 mt_arena *mem, mt_err *err);
/* Their rows, after an evaluation's views. Fails: as mt_requirement_eval. */
mt_status mt_at_position_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                              mt_err *err);

#endif
