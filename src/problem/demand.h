/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_DEMAND_H
#define PROBLEM_DEMAND_H

#include "problem/workspace.h"

/* Does it limit the frequency of a mode by its index? Those are sorted: what holds for one
 * holds for all beyond it. */
bool mt_demand_is_frequency(const mt_demand *d);
/* Is the last coordinate that of the objective "vibration", and given? */
bool mt_shaken_given(const mt_workspace *w);
/* Does it speak of a mode, by index or name? */
bool mt_demand_is_modal(const mt_demand *d);
/* Values (and gradients, unless NULL where out holds none) of one demand after its view has
 * been solved; rows as numbered. *value (may be NULL): the number that is held (infinite of a
 * mode at infinity), or the distance that its residuals amount to. */
mt_status mt_demand_eval(mt_workspace *w, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, double *value, mt_err *err);
/* The weight that a demand has in the case; NaN: it is a constraint. */
double mt_demand_weight(const mt_workspace *w, const mt_demand *d);

#endif
