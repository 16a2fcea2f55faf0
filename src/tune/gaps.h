/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_GAPS_H
#define TUNE_GAPS_H

#include "tune/problem.h"

/*
 * Search over gap assignments: every qualitatively different way to keep clear of the bands is a search of its own. Candidates come from a proof where one is possible (branch and bound
 * over the bounds: what it excludes is proven infeasible), else from samples; each is searched by the bound formulation from several starts, on workers. Results are ranked by the objective and
 * do not depend on the number of workers.
 */
typedef struct mt_gap_solution {
    const mt_nlp_solution
        *found;       /* its t has problem->n_t entries; the first n are the design */
    const int *below; /* [n_bands] its assignment */
} mt_gap_solution;

typedef struct mt_gap_result {
    int n_solutions; /* feasible ones by objective; else compromises by violation */
    mt_gap_solution *solutions;
    bool compromise;
    int n_candidates;   /* assignments that were searched */
    int n_feasible;     /* of them with a design that meets all goals */
    double n_possible;  /* all monotone assignments there are */
    bool proven;        /* every assignment that was not searched is proven infeasible */
    const char *reason; /* why not, where not proven */
    long boxes;         /* of the proof */
    long evals;
    int starts;
    mt_stop stop;
} mt_gap_result;

/* p: the problem without an assignment. Results in mem. */
mt_status mt_gaps_solve(mt_problem *p, int workers, mt_arena *mem, mt_gap_result *out,
                        mt_err *err);

/* gap_candidates.c: the assignments worth searching, n x n_bands, lexicographically sorted, with sample designs t (n x p->n; NULL entries: none). */
typedef struct mt_gap_candidates {
    int n;
    int *below;
    double possible;
    bool proven;
    const char *reason;
    long boxes;
    long evals;
} mt_gap_candidates;
mt_status mt_gap_candidates_find(mt_problem *p, mt_arena *mem, mt_gap_candidates *out,
                                 mt_err *err);

#endif
