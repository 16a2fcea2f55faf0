/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_MODE_ORDER_H
#define PROBLEM_MODE_ORDER_H

#include "problem/workspace.h"

/* Largest number of modes beyond a limited one that a search includes. */
enum { MT_MODE_ORDER_MOST = 5 };
/* Rows of the modes beyond limited ones: a limit on a mode by its index holds for all beyond
 * it, and where modes cross, these rows tell the search which comes next. Call after all other
 * rows of the subproblem. */
mt_status mt_mode_order_init(mt_subproblem *c, mt_arena *mem, mt_err *err);
/* Fills out->next (and out->dnext), unless NULL, after configurations and tolerance corners
 * have been solved. */
mt_status mt_mode_order_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                             mt_err *err);

#endif
