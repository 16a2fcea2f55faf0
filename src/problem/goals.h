/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOALS_H
#define PROBLEM_GOALS_H

#include "problem/workspace.h"

struct mt_forced_response_value;

/*
 * The operations of a kind of goal (goals.c, goal_<kind>.c); its description in files is in
 * study/goals.h. Most kinds are a value q with a slope, limited to an interval; rows,
 * residuals, violations, relaxations, proofs and sentences follow from q and the kind's
 * measure,
 *     ratio        row = ln(q / limit)           slope d ln q / dt (infinite q: w->beyond)
 *     part         row = (q - limit) / |limit|   slope dq / dt (divided by 1 where limit is 0)
 *     difference   row = q - limit               slope dq / dt
 */
typedef struct mt_goal_ops {
    mt_quantity quantity;
    bool needs_vectors; /* needs all shapes, even without a gradient */
    /* Find the reference of the goal, once configuration and mode are known, and set n_res of a
     * goal without a single value. NULL: nothing to do. */
    mt_status (*compile)(mt_problem *p, mt_requirement *d, mt_err *err);
    /* q of the mode at pos after its configuration has been solved (pos -1: a mode at infinity,
     * for a frequency only, or a goal without a mode), and its slope[n] unless NULL. */
    mt_status (*value)(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                       double *slope, mt_err *err);
    /* Of a goal with d->n_parts: part k, of which q is the largest. */
    mt_status (*part)(mt_workspace *w, const mt_requirement *d, int k, double *q, double *slope,
                      mt_err *err);
    /* Of a forced vibration: q with its details (forced_response.h). NULL: another kind. */
    mt_status (*look)(mt_workspace *w, const mt_requirement *d,
                      struct mt_forced_response_value *out, mt_err *err);
    /* Of a goal without a single value: residuals from w->r[mt_requirement_row] on, and their
     * slopes. */
    mt_status (*residuals)(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err);
    /* Subject of sentences about the goal, for the mode or expression `what`; NULL: `what`
     * itself. */
    const char *(*subject)(const mt_requirement *d, const char *what, mt_arena *mem);
    /* name of a mode's value, such as "damping ratio"; NULL: not a value of a single mode */
    const char *number;
    const char *equals; /* between that name and the required value: "at" */
} mt_goal_ops;

#define MT_GOAL_OPS(id, name, ...) extern const mt_goal_ops mt_goal_##name;
MT_GOAL_LIST(MT_GOAL_OPS)
#undef MT_GOAL_OPS
const mt_goal_ops *mt_goal_ops_of(mt_goal_type type);

#endif
