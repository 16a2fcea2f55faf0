/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_NEWTON_DESCENT_H
#define MECHANICS_NEWTON_DESCENT_H

#include "mechanics/newton_step.h"

/* Energy descent along the constraints, as far as rounding of the energy allows. */
mt_status mt_newton_descend(mt_newton_work *w, mt_placement *at, mt_arena *mem, mt_err *err);
/* Move from a stationary point along w->step, or against it, to a lower energy; *lower: found
 * one. */
mt_status mt_newton_leave_saddle(mt_newton_work *w, mt_placement *at, bool *lower,
                                 mt_arena *mem, mt_err *err);

#endif
