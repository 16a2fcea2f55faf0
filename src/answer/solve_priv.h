/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_PRIV_H
#define ANSWER_SOLVE_PRIV_H

#include <limits.h>

#include "answer/solve.h"
#include "base/run.h"
#include "base/workers.h"
#include "search/catalogue_search.h"
#include "search/mode_placements.h"

/*
 * The phases of an answer in order: id, name of what it writes in a result, makes_ready (the
 * phase puts known results into their form, and continues until MT_STOP_REQUEST_END), and its
 * function (solve_phases.c).
 */
#define MT_PHASE_LIST(X)                                                          \
    X(MT_PHASE_BASELINE, "baseline", true, mt_answer_baseline)                    \
    X(MT_PHASE_SEARCH, "search", false, mt_answer_search)                         \
    X(MT_PHASE_RECOMMENDATIONS, "recommendations", true, mt_answer_recommend)     \
    X(MT_PHASE_WEIGHT_SENSITIVITY, "spread", false, mt_answer_weight_sensitivity) \
    X(MT_PHASE_CERTIFICATES, "certificates", false, mt_answer_certify)            \
    X(MT_PHASE_RELAXATIONS, "relaxations", false, mt_answer_relaxation)           \
    X(MT_PHASE_PUBLISHED, "published", true, mt_answer_publish)                   \
    X(MT_PHASE_TRADE, "trade", false, mt_answer_trade)
#define MT_PHASE_ENUM(id, name, makes_ready, work) id,
typedef enum mt_phase { MT_PHASE_LIST(MT_PHASE_ENUM) MT_PHASE_COUNT } mt_phase;
#undef MT_PHASE_ENUM

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
} mt_question;

/* Remaining evaluations; LONG_MAX: the study sets no budget. */
long mt_question_left(const mt_question *q);
/* *q zeroed before. run (NULL: none) contains the question's own run. Call mt_question_free in
 * any case. Fails: as mt_problem_new. */
mt_status mt_question_init(mt_question *q, const mt_study *study, const mt_run *run,
                           const mt_solve_options *opt, mt_err *err);
/* Accepts a zeroed question. */
void mt_question_free(mt_question *q);
/* mt_study_solve of the compiled study; task_path: its path (NULL: none). */
mt_status mt_question_answer(mt_question *q, const mt_solve_options *opt,
                             const mt_task_path *task_path,
                             const mt_incumbent_callback *incumbent, mt_result **out,
                             mt_err *err);

/* One answer to a question. */
typedef struct mt_answer {
    mt_question *q;
    const mt_study *study; /* the question's, like the next two */
    const mt_problem *p;
    mt_interrupt *interrupt;
    /* counters of its work: the question's, except for an early answer */
    mt_work_counters *spent;
    mt_result_mark mark; /* of the result: the complete part */
    int threads;
    const mt_incumbent_callback *incumbent; /* may be NULL */
    const mt_task_path *whole;              /* path of the whole answer, or NULL */
    mt_task_path task_path;                 /* path of the current phase */
    mt_subproblem asked;                    /* the whole subproblem, with the caller's start */
    mt_workspace **workers;                 /* [n_workers] owned, set to `asked` */
    int n_workers;
    mt_result *result;
    mt_arena mem;
    mt_nlp_result found;
    /* multipliers of limits between positions (search.h) */
    const struct mt_at_position_price *at_position;
    mt_mode_placement_result placements; /* where there are bands: source of `found` */
    mt_catalogue_search_report discrete; /* where there are catalogues: report of the search */
    int stage;                           /* stage of `found` */
    mt_err why;                          /* reason where no start of the search had a value */
    bool searched;                       /* there is something to search */
    bool unsearched; /* no search was needed: the original is the answer (solve_phases.c) */
    bool infeasible; /* proven infeasible, and no compromise is wanted */
    bool impossible; /* proven: no design meets all goals */
} mt_answer;

/* One phase each. */
#define MT_PHASE_DECLARE(id, name, makes_ready, work) mt_status work(mt_answer *a, mt_err *err);
MT_PHASE_LIST(MT_PHASE_DECLARE)
#undef MT_PHASE_DECLARE

/* solve_phases.c: true where the original meets all goals and no objective precedes the total
 * change. After the baseline. */
bool mt_answer_original_is_best(const mt_answer *a);

/* Sets a->found from a->placements. */
mt_status mt_answer_take_placements(mt_answer *a, mt_err *err);
/* Callback before a long proof: builds the answer that an interrupt would give now, with the
 * best of the designs found, and passes it to a->incumbent. */
mt_status mt_answer_incumbent(void *answer, const mt_mode_placement_result *found, mt_err *err);

/* solve_status.c: warnings about the search; status and its sentence. */
mt_status mt_answer_warn(const mt_answer *a, mt_err *err);
mt_status mt_answer_set_status(const mt_answer *a, mt_err *err);
/* After all phases: status and list of what an interrupt cut. */
mt_status mt_answer_note_cuts(const mt_answer *a, mt_err *err);
/* Total work, except for the points of a trade study, which have their own counters. */
void mt_answer_note_work_counters(const mt_answer *a);

#endif
