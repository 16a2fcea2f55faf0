/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_MODE_ORDER_H
#define PROBLEM_MODE_ORDER_H

#include "problem/workspace.h"

/* How many modes beyond one that is limited a search looks at. */
enum { MT_MODE_ORDER_MOST = 5 };
/* A limit on a mode holds for all that lie beyond it; where modes cross, those
 * tell the search what comes next. After all other rows of the case. */
mt_status mt_mode_order_init(mt_subproblem *c, mt_arena *mem, mt_err *err);
/* Fill out->next (and out->dnext), unless NULL, after the views and corners have been
 * solved. */
mt_status mt_mode_order_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                             mt_err *err);

#endif
