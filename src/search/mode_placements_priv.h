/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_PRIV_H
#define SEARCH_MODE_PLACEMENTS_PRIV_H

#include "base/workers.h"
#include "problem/tolerance_cut.h"
#include "search/mode_placements.h"
#include "search/search.h"

/* What the search of one candidate left behind, in its own memory. */
typedef struct mt_mode_placement_slot {
    mt_arena mem;
    mt_nlp_result found;
    int n_t;
    mt_mode_placement_solution held; /* what holds the best solution between positions */
    double *aims; /* [n_aims] of the best solution, where there is one and several objectives */
    mt_status rc;
    long evals; /* of all rounds */
    long begun; /* of those before the last one, whose steps count */
    int starts;
    int n_cuts;
    mt_cut *cuts; /* owned while it is searched */
    mt_at_position_cuts at_position;
    mt_tolerance_cuts corners;
    bool carried; /* searched before the proof */
} mt_mode_placement_slot;

/* Searches of candidates, each a task. */
typedef struct mt_mode_placement_job {
    mt_workspace *const *workers;
    const mt_subproblem *c; /* without an assignment */
    const mt_problem *p;
    const mt_mode_placement_candidates *candidates;
    mt_mode_placement_slot *slots;
    mt_nlp_options options;
    const int *hint_below; /* [n_bands] assignment of c->hint; NULL: none */
    int from;              /* the candidate of the first task */
    int most;              /* so many candidates are searched: the budget has no more */
    int searched;          /* the first ones, where candidates come best first */
    bool few; /* the options have fewer starts than the study allows: one more for a hint */
} mt_mode_placement_job;

/* mode_placements_search.c: search candidate job->from + k (a task of mt_tasks). One without a
 * value anywhere is no failure of the study: it has no solution. */
mt_status mt_mode_placement_search_candidate(void *context, int worker, int k,
                                             mt_task_path *own, mt_err *err);
/* Its best design meets all goals. */
bool mt_mode_placement_is_met(const mt_mode_placement_slot *s);

/*
 * mode_placements_best.c: search the candidates, which come in the order of their least
 * changes, while one of them may still be among the `asked` best designs: each from one start
 * first, those that may be listed from more. job->searched of them; *last: the change (its
 * objective) that a design has to stay below to be listed, HUGE_VAL where the list has room.
 * Slots are the job's. Fails: as the searches.
 */
mt_status mt_mode_placement_search_best(mt_mode_placement_job *job, int n_workers, int asked,
                                        mt_arena *mem, double *last, mt_err *err);
/* Those of its candidates that were not met, but have a design in known (the first
 * known->n_proven rows), once more, from there. */
mt_status mt_mode_placement_search_known(mt_mode_placement_job *job, int n_workers,
                                         const mt_mode_placement_candidates *known,
                                         mt_arena *mem, mt_err *err);

#endif
