/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_POSED_H
#define PROBLEM_POSED_H

#include "problem/family.h"

/* Limits at more positions of a drive than a study names: of each cut a
 * view and its demand, whose rows in `in` follow all others, so that those keep their numbers.
 * For mt_case_lay_out, after the bands; cuts of these are left out. Fails: MT_E_MEMORY. */
mt_status mt_posed_lay_out(mt_case *c, int n_cuts, const mt_cut *cuts, mt_arena *mem,
                           mt_err *err);
/* Their rows, after an evaluation's views. Fails: as mt_demand_eval. */
mt_status mt_posed_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err);

#endif
