/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_SOLVE_PRIV_H
#define ANSWER_SOLVE_PRIV_H

#include <limits.h>

#include "answer/solve.h"
#include "base/work_counters.h"
#include "base/workers.h"
#include "search/catalogue_search.h"
#include "search/mode_placements.h"

/*
 * The phases of an answer, in their order, under the names of what they write in a result.
 * Those that make ready bring what is known into its form, and go on unless they must end at
 * once. Last: what does the work (solve_phases.c).
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
 * A study, compiled, and the run of its own in which it is answered. The study is the caller's.
 * It may be answered again (one answer at a time), and stays where it is: the problem points
 * into it.
 */
typedef struct mt_question {
    const mt_study *study;
    mt_run run; /* with the next two in it */
    mt_interrupt interrupt;
    mt_work_counters spent; /* on all answers to it */
    mt_problem *p;          /* owned */
} mt_question;

/* Evaluations that are left to the question; LONG_MAX: the study sets no budget. */
long mt_question_left(const mt_question *q);
/* Zeroed before. run (NULL: none) is the whole of the question's own. Fails:
 * as mt_problem_new. mt_question_free follows, whatever comes back. */
mt_status mt_question_init(mt_question *q, const mt_study *study, const mt_run *run,
                           const mt_solve_options *opt, mt_err *err);
/* Accepts a zeroed one. */
void mt_question_free(mt_question *q);
/* mt_study_solve of what was compiled, in its place (NULL: nowhere). */
mt_status mt_question_answer(mt_question *q, const mt_solve_options *opt,
                             const mt_task_path *task_path,
                             const mt_incumbent_callback *incumbent, mt_result **out,
                             mt_err *err);

/* One answer to it. */
typedef struct mt_answer {
    mt_question *q;
    const mt_study *study; /* the question's, like the next two */
    const mt_problem *p;
    mt_interrupt *interrupt;
    /* where its work is noted: the question's, but of what is told early */
    mt_work_counters *spent;
    mt_result_mark mark; /* of the result: what is complete */
    int threads;
    const mt_incumbent_callback *incumbent; /* NULL: nobody asks */
    const mt_task_path *whole;              /* its place in the work, or NULL */
    mt_task_path task_path;                 /* that of the present phase */
    mt_subproblem asked;    /* the whole of it; with the caller's design to start from */
    mt_workspace **workers; /* [n_workers] owned, set to that */
    int n_workers;
    mt_result *result;
    mt_arena mem;
    mt_nlp_result found;
    const struct mt_at_position_price *at_position; /* of its designs (search.h) */
    mt_mode_placement_result placements; /* where there are bands: found is made from it */
    mt_catalogue_search_report discrete; /* where there are catalogues: what the search did */
    int stage;                           /* of found */
    mt_err why;                          /* no start of the search had a value */
    bool searched;                       /* there is something to search for */
    bool unsearched; /* and no need: the original is the answer (solve_original.c) */
    bool infeasible; /* proven, and no compromise is asked for */
    bool impossible; /* proven that no design meets all goals */
} mt_answer;

/* solve_phases.c: one phase each. */
#define MT_PHASE_DECLARE(id, name, makes_ready, work) mt_status work(mt_answer *a, mt_err *err);
MT_PHASE_LIST(MT_PHASE_DECLARE)
#undef MT_PHASE_DECLARE

/* solve_original.c: true where the original meets all goals, and nothing counts before the
 * change. After the baseline. */
bool mt_answer_original_is_best(const mt_answer *a);
/* Then it is what is found, without a search. */
mt_status mt_answer_take_original(mt_answer *a, mt_err *err);

/* Result.found of result.gaps. */
mt_status mt_answer_take_placements(mt_answer *a, mt_err *err);
/* What is known before a long proof, a mt_mode_placement_result, as the answer that an
 * interrupt would leave: for a->early. Of its designs the best. */
mt_status mt_answer_incumbent(void *answer, const mt_mode_placement_result *found, mt_err *err);

/* solve_status.c: warnings about the search, then status and its sentence. */
mt_status mt_answer_warn(const mt_answer *a, mt_err *err);
mt_status mt_answer_set_status(const mt_answer *a, mt_err *err);
/* After everything: where something was cut the status says so, and the result what. */
mt_status mt_answer_note_cuts(const mt_answer *a, mt_err *err);
/* What all of it has cost, but for the points of a trade study, which are told already. */
void mt_answer_note_work_counters(const mt_answer *a);

#endif
