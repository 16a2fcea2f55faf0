/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_GOAL_H
#define PROBLEM_GOAL_H

#include "problem/workspace.h"

struct mt_forced_response_value;

/*
 * The operations of a kind of goal, one file for each kind (goal_<kind>.c); what files may say
 * of it stands in study/goal_kinds.h. Most are a number q with a slope, held against an
 * interval: rows, residuals, violations, relaxations, proofs and sentences follow from q and
 * the measure of the kind,
 *     ratio        row = ln(q / limit)             slope d ln q / dt (infinite: w->beyond)
 *     part         row = (q - limit) / |limit|     slope dq / dt (divided by 1 where it is 0)
 *     difference   row = q - limit                 slope dq / dt
 */
typedef struct mt_goal_ops {
    mt_quantity quantity;
    bool needs_vectors; /* all shapes, even where no gradient is asked for */
    /* Look up what the goal is compared with, once view and mode are known, and set n_res of
     * a goal that is no number. NULL: nothing. */
    mt_status (*compile)(mt_problem *p, mt_requirement *d, mt_err *err);
    /* q of the mode at pos after its view has been solved (a mode at infinity: -1, of a
     * frequency only; a goal without a mode: -1), and its slope[n] unless NULL. */
    mt_status (*value)(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                       double *slope, mt_err *err);
    /* Of one with d->n_parts: part k of it, of which q is the largest. */
    mt_status (*part)(mt_workspace *w, const mt_requirement *d, int k, double *q, double *slope,
                      mt_err *err);
    /* Of a forced vibration: all that is known of q (forced_response.h). NULL: it is none. */
    mt_status (*look)(mt_workspace *w, const mt_requirement *d,
                      struct mt_forced_response_value *out, mt_err *err);
    /* Of a goal that is no number: residuals from w->r[d->row_res] on, and their slopes. */
    mt_status (*residuals)(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err);
    /* What sentences say is held, of the mode or expression called `what`; NULL: just that. */
    const char *(*subject)(const mt_requirement *d, const char *what, mt_arena *mem);
    const char *number; /* of a mode: "damping ratio"; NULL: it is of no mode alone */
    const char *equals; /* between this and the number that is asked for: "at" */
} mt_goal_ops;

#define MT_GOAL_OPS(id, name, ...) extern const mt_goal_ops mt_goal_##name;
MT_GOAL_LIST(MT_GOAL_OPS)
#undef MT_GOAL_OPS
const mt_goal_ops *mt_goal_ops_of(mt_goal_type type);

/* Shape of the mode at pos at the requirement's sensors, into w->shape (and w->dshape), and its
 * norm. Fails: MT_E_DOMAIN where the mode does not move there. (goal_shape.c) */
mt_status mt_goal_sense(mt_workspace *w, const mt_requirement *d, int pos, bool with_gradient,
                        double *norm, mt_err *err);
/* Look up the reference's shape. (goal_shape.c) */
mt_status mt_goal_compile_shape(mt_problem *p, mt_requirement *d, mt_err *err);
/* The mode of the reference that the requirement names, by default that of its own index. */
int mt_goal_reference_mode(const mt_problem *p, const mt_requirement *d);

#endif
