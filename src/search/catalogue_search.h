/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_CATALOGUE_SEARCH_H
#define SEARCH_CATALOGUE_SEARCH_H

#include "nlp/merit.h"
#include "problem/workspace.h"
#include "result/result.h"

/*
 * Search with catalogues. A combination is one value, or one row of values, from every
 * catalogue; remaining variables are searched continuously for each combination (an ordinary
 * search, over mode placements where there are bands).
 *
 * Few combinations are enumerated, best first, until no other can be among the designs asked
 * for. Beyond
 * MT_CATALOGUE_SEARCH_MOST combinations (MT_CATALOGUE_SEARCH_MOST_MIXED where continuous
 * variables remain) the search is a heuristic: the relaxed problem (every catalogue as the
 * interval that it spans), roundings of its designs, then steps to neighbouring values while
 * these improve. Where continuous variables remain, branch and bound follows
 * (catalogue_search_prove.c): it excludes combinations, many at once, or searches them, until
 * none is left or its budget is spent (not for objectives that boxes do not bound). What
 * remains open is left to a proof where the modes can be enclosed (catalogue_search_prove.c):
 * which mode placements some combination has, that no combination meets all goals, that none is
 * better than the best found.
 */
enum { MT_CATALOGUE_SEARCH_MOST = 200000, MT_CATALOGUE_SEARCH_MOST_MIXED = 400 };

typedef struct mt_catalogue_search_report {
    bool mixed;    /* continuous variables remain */
    bool all;      /* every combination was evaluated, or shown not to rank */
    bool branched; /* branch and bound ran (catalogue_search_prove.c) */
    /* a drive has several positions: only combinations that might rank were followed between
     * them */
    bool driven;
    int judged;
    double combinations; /* total number */
    double open;         /* of these, neither excluded nor searched */
    /* largest share of the best objective by which an open combination may improve it, by
     * bounds of the objective alone; NaN: not known */
    double open_within;
    int excluded; /* of an enumeration: combinations that certificates exclude */
    /* of an enumeration: no combination that was not judged has a design that meets all goals
     * and a first objective, as results show it, below this, which is not below those asked
     * for; HUGE_VAL: none of them meets all goals */
    double beyond;
    bool by_change; /* that objective is the change */
    int followed;   /* feasible combinations followed */
    bool broken;    /* none of those followed keeps its limits between the positions */
    int feasible;   /* of those evaluated: combinations with a design that meets all goals */
    /* branch and bound with proofs alone (catalogue_search_prove.c) */
    bool asked;        /* it ran */
    bool settled;      /* every mode placement but n_kinds is proven infeasible */
    bool complete;     /* the proof covers every goal */
    bool cut;          /* its budget ended before a better one was excluded */
    int n_kinds;       /* mode placements that some combination has */
    double n_possible; /* number of monotone mode placements; 1 without bands */
    /* proven: no design improves the best objective by more than this share; NaN: not proven */
    double best_within;
    long boxes;
    const char *reason; /* why there is no proof, or NULL */
} mt_catalogue_search_report;

/* One combination and its evaluation. */
typedef struct mt_combination {
    int *pick;          /* [n_listed] row of each choice */
    double *t;          /* [n + 1] the design; coordinates of catalogues are those of pick */
    double *f;          /* [n_stages] objectives there */
    const double *from; /* [n + 1] a design t to start from; NULL: none */
    double change;      /* half of the squared change due to pick alone */
    double least;       /* lower bound of the first objective (catalogue_search.c) */
    mt_missed missed;
    double kkt;
    bool judged;
    bool feasible;
    bool singular;
    bool flat; /* one of several equally good designs, as the search left it */
    /* evaluated between the positions of its drives and over its tolerances */
    bool followed;
    /* it misses a limit only between the positions; counts as feasible where all others do
     * too */
    bool broken;
    long evals;
    int starts;
    mt_stop stop;
} mt_combination;

/* State of the search, shared by its files. */
typedef struct mt_catalogue_search {
    mt_workspace *const *workers; /* [n_workers] */
    int n_workers;
    const mt_problem *p;
    const mt_subproblem *c; /* the relaxed problem: every catalogue an interval */
    mt_arena *mem;
    int n_listed;            /* choices from catalogues */
    const mt_choice *choice; /* [n_listed] */
    int n_set;               /* variables that they set */
    bool mixed;
    mt_nlp_values *values; /* [n_workers] where not mixed */
    int n_broken;          /* combinations */
    /* where mixed: corners of the tolerances that the first combination searched needed; none
     * where it has no design, or needs none */
    struct mt_tolerance_cuts *cuts;
    bool has_cuts; /* it was searched */
    long evals;
    int starts;
    mt_stop stop;
    mt_steps steps; /* improvements over the combinations */
} mt_catalogue_search;

bool mt_study_has_catalogues(const mt_study *study);
/*
 * Search over all combinations; workers[n_workers] as for mt_search_designs. Designs by the
 * objectives in order (equal to 12 digits: in the order of the combinations), each combination
 * once; without a feasible one, by the squares of the violations. out->solutions belong to
 * stage 0. Deterministic for any number of workers. Results in mem. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, MT_E_INPUT.
 */
mt_status mt_catalogue_search_solve(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, mt_catalogue_search_report *report,
                                    mt_err *err);

/* Evaluate list[n], on workers, with at most `budget` evaluations
 * for each where mixed (0: no limit). Adds to the search's counters. */
mt_status mt_catalogue_search_verify(mt_catalogue_search *d, int n, mt_combination *list,
                                     long budget, mt_err *err);
/* Evaluate a feasible combination over the range of motion (drive_path.h)
 * and over its tolerances (problem/tolerance_cut.h), once; no effect where mixed (its own
 * search includes this). It may become infeasible. */
mt_status mt_catalogue_search_follow(mt_catalogue_search *d, mt_combination *c, mt_err *err);
/* True where a ranks before b: feasible ones first, by the objectives; infeasible ones by
 * squares. */
bool mt_catalogue_search_before(const mt_catalogue_search *d, const mt_combination *a,
                                const mt_combination *b);
/* Allocates n combinations in the search's memory. */
mt_status mt_catalogue_search_alloc(const mt_catalogue_search *d, int n, mt_combination **out,
                                    mt_err *err);
/* The whole subproblem with the bounds of its catalogues fixed at the values x[n], laid out; w
 * is set to it. Fails: as mt_subproblem_lay_out. */
mt_status mt_catalogue_search_close(const mt_subproblem *whole, const double *x,
                                    mt_workspace *w, mt_arena *mem, mt_subproblem *out,
                                    mt_err *err);
/* Sets the coordinates and the unavoidable change of c from its pick. */
void mt_catalogue_search_set(const mt_catalogue_search *d, mt_combination *c);
/* catalogue_search_prove.c: results of branch and bound with proofs, into the report;
 * combinations that it finds are appended to (*all)[*n], evaluated. */
mt_status mt_catalogue_search_prove(mt_catalogue_search *d, mt_combination ***all, int *n,
                                    mt_catalogue_search_report *report, mt_err *err);
/* catalogue_search_prove.c: search or exclude all combinations within the budget, where
 * continuous variables remain, after the heuristic. Combinations searched are appended to
 * (*all)[*n], those evaluated so far. Sets branched, open and all of the report. Cost: at most
 * 1000 searches, and proofs up to their budget. */
mt_status mt_catalogue_search_branch(mt_catalogue_search *d, mt_combination ***all, int *n,
                                     mt_catalogue_search_report *report, mt_err *err);
/* The heuristic (catalogue_search_near.c). (*list)[*n]: the combinations evaluated. */
mt_status mt_catalogue_search_near(mt_catalogue_search *d, mt_combination ***list, int *n,
                                   mt_err *err);

#endif
