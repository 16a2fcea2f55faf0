/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_TRADE_H
#define ANSWER_TRADE_H

#include "base/workers.h"
#include "problem/workspace.h"
#include "result/result.h"
#include "study/study.h"

/*
 * Trade study: every point is the study with one or two numbers replaced, answered and
 * described like a study of its own (mt_study_solve), on `threads` workers, except that its
 * starts end when little is left to find (mt_search.settles). A second pass also searches every
 * point from the best designs of its neighbours and keeps improvements, which gives a curve
 * without gaps. The result does not depend on the number of workers. Fills result->trade and
 * adds to its evaluations and warnings; no effect where the study has no trade part. Cost: that
 * of the study times the number of points. An interrupt leaves points without an answer, marked
 * as such. task_path: the path of its points; a run for a part of the work answers its own
 * points and is then interrupted. Fails: as mt_study_solve; the text names the point.
 */
mt_status mt_trade_solve(const mt_study *study, const mt_run *run, int threads,
                         const mt_task_path *task_path, mt_result *result, mt_err *err);

/* trade_study.c: the study of one point, with values[n_vary]. Unchanged parts are borrowed,
 * changed ones are in mem. Fails: MT_E_MEMORY, MT_E_DOMAIN (a parameter without a value). */
mt_status mt_trade_study(const mt_study *study, const double *values, mt_arena *mem,
                         mt_study *out, mt_err *err);
/* trade_front.c: marks the points of out that no other dominates, and adds to every point the
 * objectives of the front that the study does not have. best[n_points]: the best design of each
 * (copied in out) or NULL; baseline: the original. Fails: MT_E_MEMORY. */
mt_status mt_trade_front(const mt_study *study, const mt_recommendation *const *best,
                         const mt_recommendation *baseline, mt_arena *mem, mt_trade_result *out,
                         mt_err *err);
/* trade_warm.c; *better: a local search from x[n_variables], with about `most` evaluations at
 * most, finds a better design of w's point than best_x (NULL: any feasible one). w is set to
 * the whole subproblem, and to it again afterwards. */
mt_status mt_trade_improves(mt_workspace *w, const double *x, const double *best_x,
                            bool *better, long most, mt_err *err);

#endif
