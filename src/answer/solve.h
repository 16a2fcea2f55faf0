/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_H
#define ANSWER_SOLVE_H

#include "base/run.h"
#include "base/workers.h"
#include "problem/problem.h"
#include "search/relaxation.h"
#include "study/study.h"

/* Called before a proof that may take long, with the answer so far (status "interrupted"),
 * which the caller may keep in case the run is killed. */
typedef struct mt_incumbent_callback {
    mt_status (*tell)(void *context, mt_result *so_far, mt_err *err);
    void *context;
} mt_incumbent_callback;

/*
 * mt_study_solve within a run (NULL: none). run->tasks: the path of its tasks; their store
 * holds what earlier runs of the same study completed and receives what this one completes. The
 * result does not depend on the store's content. Where the store selects a part of the work
 * (parts > 0) there is no answer: the tasks are in the store, and *out has what is known
 * without them. incumbent may be NULL. Fails also: as incumbent->tell.
 */
mt_status mt_study_solve_with(const mt_study *study, const mt_solve_options *opt,
                              const mt_run *run, const mt_incumbent_callback *incumbent,
                              mt_result **out, mt_err *err);

/* What is known of a study from those that differ from it in one number, by little. */
typedef struct mt_neighbour {
    bool alone;      /* the first one's starts found one design, or none */
    bool impossible; /* no design meets all goals: proven of one that asks for less */
    const mt_moves_known *known; /* their relaxations */
} mt_neighbour;

/*
 * A compiled study and its own run. The study is the caller's. It may be answered repeatedly,
 * one answer at a time, and must not move: the problem points into it.
 */
typedef struct mt_question {
    const mt_study *study;
    mt_run run; /* refers to the next two */
    mt_interrupt interrupt;
    mt_work_counters spent; /* of all answers to it */
    mt_problem *p;          /* owned */
    /* NULL: none is used; its best design is the caller's start (mt_solve_options) */
    const mt_neighbour *neighbour;
    mt_moves *moves; /* gets those of the relaxations, in moves_mem; NULL: they are not kept */
    mt_arena *moves_mem;
} mt_question;

/* Remaining evaluations; LONG_MAX: the study sets no budget. */
long mt_question_left(const mt_question *q);
/* *q zeroed before. run (NULL: none) contains the question's own run. Call mt_question_free in
 * any case. Fails: as mt_problem_new. */
mt_status mt_question_init(mt_question *q, const mt_study *study, const mt_run *run,
                           const mt_solve_options *opt, mt_err *err);
/* What follows counts as its search, and an interrupt cuts it as one. */
void mt_question_enter_search(mt_question *q);
/* Accepts a zeroed question. */
void mt_question_free(mt_question *q);
/* mt_study_solve of the compiled study; task_path: its path (NULL: none). */
mt_status mt_question_answer(mt_question *q, const mt_solve_options *opt,
                             const mt_task_path *task_path,
                             const mt_incumbent_callback *incumbent, mt_result **out,
                             mt_err *err);

#endif
