/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_SEARCH_H
#define SEARCH_MODE_PLACEMENTS_SEARCH_H

#include "base/workers.h"
#include "problem/tolerance_cut.h"
#include "search/mode_placements.h"
#include "search/search.h"

/* Result of the search of one candidate, in its own memory. */
typedef struct mt_mode_placement_slot {
    mt_arena mem;
    mt_nlp_result found;
    int n_t;
    mt_mode_placement_solution held; /* limits active at the best solution between positions */
    /* [n_stages] of the best solution; NULL without one or with a single objective */
    double *stages;
    mt_status rc;
    long evals; /* of all rounds */
    long begun; /* evaluations before the last round, whose steps count */
    int starts;
    int n_cuts;
    mt_cut *cuts; /* owned during the search */
    mt_at_position_cuts at_position;
    mt_tolerance_cuts corners;
    bool carried; /* searched before the proof, or left out */
} mt_mode_placement_slot;

/* Searches of candidates, one task each. */
typedef struct mt_mode_placement_job {
    mt_workspace *const *workers;
    const mt_subproblem *c; /* without a placement */
    const mt_problem *p;
    const mt_mode_placement_candidates *candidates;
    mt_mode_placement_slot *slots;
    mt_nlp_options options;
    const int *hint_below; /* [n_bands] placement of c->hint; NULL: none */
    int from;              /* candidate of the first task */
    int most;              /* number of candidates that the budget allows */
    /* number searched, from the first, where candidates come best first */
    int searched;
    bool few; /* options have fewer starts than the study allows: add one for a hint */
} mt_mode_placement_job;

/* Search candidate job->from + k (a task of mt_tasks). A candidate
 * without any value is no failure: it has no solution. */
mt_status mt_mode_placement_search_candidate(void *context, int worker, int k,
                                             mt_task_path *own, mt_err *err);
/* True where its best design meets all goals. */
bool mt_mode_placement_is_met(const mt_mode_placement_slot *s);

/* True where candidate k was not searched. */
static inline bool mt_mode_placement_is_left_out(const mt_mode_placement_job *job, int k)
{
    return k >= job->searched || job->slots[k].carried;
}

#endif
