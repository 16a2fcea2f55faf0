/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_AT_POSITION_H
#define PROBLEM_AT_POSITION_H

#include "problem/drive_positions.h"

/* Limits at positions of a drive that the study does not name: each cut that has one adds a
 * configuration and its requirement to those of the subproblem. Called by mt_subproblem_lay_out
 * after the bands; cuts of bands are ignored here. Fails: MT_E_MEMORY. */
mt_status mt_at_position_add(mt_subproblem *c, int n_cuts, const mt_cut *cuts, mt_arena *mem,
                             mt_err *err);

#endif
