/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_REQUIREMENT_H
#define PROBLEM_REQUIREMENT_H

#include <math.h>

#include "problem/workspace.h"

/* Largest number of modes beyond a limited one that a search includes. */
enum { MT_MODE_ORDER_MOST = 5 };

struct mt_forced_response_value;

/* True where d limits the frequency of a mode by its index. Frequencies ascend: a limit on one
 * holds for all beyond it. */
static inline bool mt_requirement_is_frequency(const mt_requirement *d)
{
    return d->quantity == MT_QUANTITY_FREQUENCY && d->mode > 0;
}
/* True where d limits what the frequencies of two modes by their indices make. */
static inline bool mt_requirement_is_pair(const mt_requirement *d)
{
    return d->quantity == MT_QUANTITY_FREQUENCIES && d->mode > 0 && d->of.mode > 0;
}
/* True where the last coordinate is that of the objective "vibration" and has been given a
 * value. */
static inline bool mt_forced_response_given(const mt_workspace *w)
{
    return w->c->forced_response && w->t[w->p->n] != 0.0;
}
/* True where d is about a mode, by index or name. */
static inline bool mt_requirement_is_modal(const mt_requirement *d)
{
    return d->view >= 0 && d->goal->response_limit == NULL && d->goal->static_limit == NULL &&
           !mt_goal_is_most(d->goal);
}
/* Values (and gradients, where out has arrays for them) of one requirement in its rows, after
 * its configuration has been solved. *value (may be NULL): the limited value (infinite for a
 * mode at infinity), or the norm of its residuals. */
mt_status mt_requirement_eval(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                              mt_nlp_values *out, double *value, mt_err *err);
/* The value at another position of the drive: another analysis of the mechanism, solved with
 * the shapes that the configuration needs. For a forced vibration with its details, otherwise
 * the value alone (infinite for a mode at infinity). Fails: MT_E_DOMAIN where there is no such
 * mode, as the goal's value. */
mt_status mt_requirement_find_peak(mt_workspace *w, const mt_requirement *d, mt_analysis *a,
                                   struct mt_forced_response_value *out, mt_err *err);
/* Divisor of a difference from the required value `asked`. */
static inline double mt_requirement_unit(const mt_requirement *d, double asked)
{
    const bool none = d->measure == MT_MEASURE_PART && !(fabs(asked) > 0.0);
    return none ? d->size : mt_measure_unit(d->measure, asked);
}
/* Excess of q over the nearest or most violated limit, by the kind's measure; positive:
 * violated. */
double mt_requirement_over(const mt_requirement *d, double q);
/* Weight of a requirement in the subproblem; NaN: a constraint. */
static inline double mt_requirement_weight(const mt_workspace *w, const mt_requirement *d)
{
    return w->c->weight[d->index];
}

#endif
