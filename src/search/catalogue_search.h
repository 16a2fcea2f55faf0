/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_CATALOGUE_SEARCH_H
#define SEARCH_CATALOGUE_SEARCH_H

#include "nlp/merit.h"
#include "problem/workspace.h"
#include "result/result.h"

/*
 * Search with catalogues. A combination is one value from every catalogue; the other variables,
 * where there are any, are searched continuously for each combination (a search like any other,
 * over gap assignments where there are bands).
 *
 * Few combinations are enumerated, all of them, in the order of the change that they cannot do
 * without; with the objective "change" the enumeration ends where no later one can rank among
 * those that are kept. Beyond MT_CATALOGUE_SEARCH_MOST combinations
 * (MT_CATALOGUE_SEARCH_MOST_MIXED where continuous variables remain) the search is a heuristic:
 * the relaxed problem (every catalogue as the interval that it spans), roundings of its
 * designs, then steps to neighbouring values while these help. Where continuous variables
 * remain branch and bound follows (catalogue_search_branch.c): combinations are excluded, many
 * at once, or searched, until none is left or its effort is spent (not for objectives that
 * boxes do not bound). What neither settles, a proof does where the modes can be enclosed
 * (catalogue_search_prove.c): which gap assignments some combination has, that none meets all
 * goals, that none is better than the best found.
 */
enum { MT_CATALOGUE_SEARCH_MOST = 200000, MT_CATALOGUE_SEARCH_MOST_MIXED = 400 };

typedef struct mt_catalogue_search_report {
    bool mixed;    /* continuous variables remain */
    bool all;      /* every combination was judged, or shown not to rank */
    bool branched; /* by branch and bound (catalogue_search_branch.c) */
    /* several positions of one drive: only combinations that might rank were followed between
     * them */
    bool driven;
    int judged;
    double combinations; /* how many there are */
    double open;         /* of these it has neither excluded nor searched */
    /* by what share of the best one's objective one of these may be less, at most, by bounds of
     * the objective alone; NaN: not known */
    double open_within;
    int followed; /* of the feasible ones */
    bool broken;  /* none of these keeps its limits between the positions */
    int feasible; /* of those judged: combinations with a design that meets all goals */
    /* branch and bound with proofs alone (catalogue_search_prove.c) */
    bool asked;        /* it was tried */
    bool settled;      /* every gap assignment but n_kinds is proven impossible */
    bool complete;     /* no goal was left out of the question */
    bool cut;          /* its budget ended before it was known whether one is better */
    int n_kinds;       /* assignments that a combination has */
    double n_possible; /* monotone assignments there are; 1 without bands */
    /* proven: no design's objective is less by more than this share of the best one's; NaN: not
     * proven */
    double best_within;
    long boxes;
    const char *reason; /* why there is no proof; NULL */
} mt_catalogue_search_report;

/* One combination judged. */
typedef struct mt_combination {
    int *pick; /* [n_listed] index in each catalogue */
    double *t; /* [n + 1] the design; its coordinates of catalogues are those of pick */
    double *f; /* [n_aims] objectives there */
    const double *from; /* [n + 1] a design t to start from; NULL: none */
    double least;       /* half of the squared change that pick alone makes */
    mt_missed missed;
    double kkt;
    bool judged;
    bool feasible;
    bool singular;
    bool flat; /* one of equal designs, as the search found it */
    /* from position to position of its drives and over its tolerances, and judged by that */
    bool followed;
    bool broken; /* it misses a limit between the positions alone: feasible, where all do */
    long evals;
    int starts;
    mt_stop stop;
} mt_combination;

/* A search under way: what its files share. */
typedef struct mt_catalogue_search {
    mt_workspace *const *workers; /* [n_workers] */
    int n_workers;
    const mt_problem *p;
    const mt_subproblem *c; /* the relaxed problem: every catalogue an interval */
    mt_arena *mem;
    int n_listed;
    int *variable; /* [n_listed] */
    bool mixed;
    mt_nlp_values *values; /* [n_workers] where not mixed */
    int n_broken;          /* combinations */
    long evals;
    int starts;
    mt_stop stop;
    mt_steps steps; /* from combination to combination */
} mt_catalogue_search;

bool mt_study_has_catalogues(const mt_study *study);
/*
 * workers[n_workers] as for mt_search_designs. Designs by the objectives in order (equal to 12
 * digits: in the order of the combinations), each combination once; else, where none is
 * feasible, by the squares of the violations. out->solutions belong to stage 0. Deterministic
 * for any number of workers. Results in mem. Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_INPUT.
 */
mt_status mt_catalogue_search_solve(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, mt_catalogue_search_report *report,
                                    mt_err *err);

/* catalogue_search_judge.c: judge list[n], on workers; at most budget evaluations for each
 * where it is mixed (0: no limit). Adds to the search's counters. */
mt_status mt_catalogue_search_verify(mt_catalogue_search *d, int n, mt_combination *list,
                                     long budget, mt_err *err);
/* catalogue_search_judge.c: of best[n] those with equal designs beside them are searched once
 * more, and become the nearest to the original of these. Of each combination any one served
 * until here: to seek the nearest takes longer than to find one. Where it is mixed. */
mt_status mt_catalogue_search_settle(mt_catalogue_search *d, int n, mt_combination *const *best,
                                     mt_err *err);
/* catalogue_search_undetermined.c: directions that the goals do not settle at the best
 * combination, into out: single catalogues any of whose values does, and those of the
 * continuous variables with the catalogues as they are. Searches that combination once more
 * where it is mixed. */
mt_status mt_catalogue_search_unidentifiable(mt_catalogue_search *d, const mt_combination *best,
                                             mt_nlp_result *out, mt_err *err);
/* catalogue_search_judge.c: search the continuous variables of c once more, for those
 * directions (nothing of c is changed); memory of out->undetermined is mem's. */
mt_status mt_catalogue_search_directions(mt_catalogue_search *d, const mt_combination *c,
                                         mt_arena *mem, mt_nlp_result *out, mt_err *err);
/* Judge a feasible combination over the range of motion (motion.h, drive_path_limit.h) and over
 * its tolerances (problem/tolerance_cut.h), once; nothing where it is mixed (its own search has
 * done so). It may be feasible no more. */
mt_status mt_catalogue_search_follow(mt_catalogue_search *d, mt_combination *c, mt_err *err);
/* Evaluations that this takes at most, of one combination; 0: nothing, or there is no limit. */
long mt_catalogue_search_verdict(const mt_catalogue_search *d);
/* True where a is ahead of b. Feasible ones first, by the objectives; the others by squares. */
bool mt_catalogue_search_before(const mt_catalogue_search *d, const mt_combination *a,
                                const mt_combination *b);
/* Room for n combinations. */
mt_status mt_catalogue_search_alloc(const mt_catalogue_search *d, int n, mt_combination **out,
                                    mt_err *err);
/* The whole case with the bounds of its catalogues closed on the values x[n], laid out. w: set
 * to it. Fails as mt_subproblem_lay_out. */
mt_status mt_catalogue_search_close(const mt_subproblem *whole, const double *x,
                                    mt_workspace *w, mt_arena *mem, mt_subproblem *out,
                                    mt_err *err);
/* Coordinates and unavoidable change of c from its pick. */
void mt_catalogue_search_set(const mt_catalogue_search *d, mt_combination *c);
/* catalogue_search_prove.c: what branch and bound can settle, into the report; combinations
 * that it finds join (*all)[*n], judged. */
mt_status mt_catalogue_search_prove(mt_catalogue_search *d, mt_combination ***all, int *n,
                                    mt_catalogue_search_report *report, mt_err *err);
/* catalogue_search_branch.c: search or exclude all combinations, as far as the effort goes:
 * beside continuous variables, after the heuristic. (*all)[*n] are the combinations judged so
 * far; those that are searched join them. Into the report: branched, open, all. Cost: at most
 * 1000 searches, and certificates up to the budget of a proof. */
mt_status mt_catalogue_search_branch(mt_catalogue_search *d, mt_combination ***all, int *n,
                                     mt_catalogue_search_report *report, mt_err *err);
/* The heuristic (catalogue_search_near.c). (*list)[*n]: the combinations that it evaluated. */
mt_status mt_catalogue_search_near(mt_catalogue_search *d, mt_combination ***list, int *n,
                                   mt_err *err);

#endif
