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
 * starts end when little is left to find (mt_search.settles). In grids of 64 points and more
 * without bands, budget and number of starts, lines are cut into stretches of up to five
 * points, which one worker answers in order: each but the first is searched from the design of
 * the one before, with fewer starts where these agree (mt_search.agree) and that one has one
 * design, its relaxations from that one's moves, and it has no design where that is proven of
 * the one before and it asks for more. A stretch is a function of the grid. A second pass also
 * searches every point from the best designs of its neighbours and keeps improvements, which
 * gives a curve without gaps. The result does not depend on the number of workers. Fills
 * result->trade and adds to its evaluations and warnings; no effect where the study has no
 * trade part. Cost: that of the study times the number of points. An interrupt leaves points
 * without an answer, marked as such. task_path: the path of its points; a run for a part of the
 * work answers its own points and is then interrupted. Fails: as mt_study_solve; the text names
 * the point.
 */
mt_status mt_trade_solve(const mt_study *study, const mt_run *run, int threads,
                         const mt_task_path *task_path, mt_result *result, mt_err *err);

#endif
