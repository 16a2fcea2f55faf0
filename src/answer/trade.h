/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_TRADE_H
#define ANSWER_TRADE_H

#include "base/workers.h"
#include "problem/workspace.h"
#include "result/result.h"
#include "study/study.h"

/*
 * The trade study of a study: every point is the study with one or two numbers replaced,
 * answered and described like a study of its own (mt_study_solve), on `threads` workers, but
 * that its starts end when little is left to find (mt_search.settles). A second pass searches
 * every point from the best designs of its neighbours as well and keeps what is better: a curve
 * without gaps, and the same for any number of workers. Fills
 * result->trade; adds to its evaluations and warnings. Nothing where the study has no trade
 * part. Cost: that of the study times the number of points. An interrupt of the run
 * leaves points without an answer, which say so. scope: the place of its points; a part of the
 * work does its points and is interrupted. Fails: as mt_study_solve; the text names the point.
 */
mt_status mt_trade_solve(const mt_study *study, const mt_run *run, int threads,
                         const mt_task_path *task_path, mt_result *result, mt_err *err);

/* trade_study.c: the study of one point, values[n_vary] put in. It borrows all that is not
 * replaced; what is lives in mem. Fails: MT_E_MEMORY, MT_E_DOMAIN (a parameter without a
 * value). */
mt_status mt_trade_study(const mt_study *study, const double *values, mt_arena *mem,
                         mt_study *out, mt_err *err);
/* trade_front.c: points of out that no other one beats are marked, and every point shows the
 * objectives of the front that are none of the study's. best[n_points]: the best design of each
 * or NULL, of which out has a copy; baseline: the original one. Fails: MT_E_MEMORY. */
mt_status mt_trade_front(const mt_study *study, const mt_recommendation *const *best,
                         const mt_recommendation *baseline, mt_arena *mem, mt_trade_result *out,
                         mt_err *err);
/* trade_warm.c; *better: a local search from x[n_variables] finds a design of the point that w
 * is of (set to the whole of it, and again afterwards) that is better than best_x (NULL: any
 * that meets all goals), in `most` evaluations at most, about. */
mt_status mt_trade_improves(mt_workspace *w, const double *x, const double *best_x,
                            bool *better, long most, mt_err *err);

#endif
