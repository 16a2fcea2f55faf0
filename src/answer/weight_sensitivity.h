/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_WEIGHT_SENSITIVITY_H
#define ANSWER_WEIGHT_SENSITIVITY_H

#include "describe/describe.h"

/*
 * Change of the best design when the weight of one goal at a time is multiplied or divided by
 * the study's factor, which it must have, and the misfit, its first objective, is minimised
 * again from the best design. Evaluations are added to *evaluations. Cost: one local search for
 * each weighted goal and side, distributed over the workers, which are all set to one
 * subproblem.
 */
mt_status mt_weight_sensitivity_solve(mt_workspace *const *workers, int n_workers,
                                      const mt_nlp_solution *best, mt_arena *mem, long most,
                                      long *evaluations, mt_result *result, mt_err *err);

#endif
