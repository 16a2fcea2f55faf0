/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_REQUIREMENT_H
#define PROBLEM_REQUIREMENT_H

#include "problem/workspace.h"

struct mt_forced_response_value;

/* True where it limits the frequency of a mode by its index. Those are sorted: what holds for
 * one holds for all beyond it. */
bool mt_requirement_is_frequency(const mt_requirement *d);
/* Whether the last coordinate is that of the objective "vibration", and given. */
bool mt_forced_response_given(const mt_workspace *w);
/* Whether it speaks of a mode, by index or name. */
bool mt_requirement_is_modal(const mt_requirement *d);
/* Values (and gradients, unless NULL where out holds none) of one requirement after its view
 * has been solved; rows as numbered. *value (may be NULL): the number that is held (infinite of
 * a mode at infinity), or the distance that its residuals amount to. */
mt_status mt_requirement_eval(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                              mt_nlp_values *out, double *value, mt_err *err);
/* The number at another analysis of its view's mechanism, another position of its drive, solved
 * with the shapes that the view asks for: of a forced vibration all that is known of it, of any
 * other goal the value alone (infinite of a mode at infinity). Fails: MT_E_DOMAIN where there
 * is no such mode, as the goal's value. */
mt_status mt_requirement_find_peak(mt_workspace *w, const mt_requirement *d, mt_analysis *a,
                                   struct mt_forced_response_value *out, mt_err *err);
/* What a difference from the number `asked` is divided by. */
double mt_requirement_unit(const mt_requirement *d, double asked);
/* What q exceeds the limit by that it is nearest to, or misses most, as the kind measures it:
 * above 0 it is missed. */
double mt_requirement_over(const mt_requirement *d, double q);
/* The weight that a requirement has in the case; NaN: it is a constraint. */
double mt_requirement_weight(const mt_workspace *w, const mt_requirement *d);

#endif
