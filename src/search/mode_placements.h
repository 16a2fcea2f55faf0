/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_H
#define SEARCH_MODE_PLACEMENTS_H

#include "problem/workspace.h"
#include "result/result.h"
#include "search/proof.h"

/*
 * Search over gap assignments: every qualitatively different way to keep clear of the bands is
 * a search of its own. What a short proof or a few samples meet is searched before anything
 * long begins, so that an interrupt finds a design. All candidates come from a proof where one
 * is possible (branch and bound over the bounds: what it excludes is proven infeasible), else
 * from samples; each is searched once, by the bound formulation from several starts, on
 * workers. Results are ranked by the objective and do not depend on the number of workers.
 */
/* A mode that holds a design at a position between the named ones, where bands are kept. */
typedef struct mt_mode_placement_held {
    int drive_positions;
    double position; /* [rad, m] */
    int mode;        /* vibration index */
    bool above;
    const char *band;
    double multiplier; /* of its row */
} mt_mode_placement_held;

typedef struct mt_mode_placement_solution {
    /* its t has problem->n_t entries; the first n are the design */
    const mt_nlp_solution *found;
    const int *below; /* [n_bands] its assignment */
    const mt_mode_placement_held *held;
    int n_held;
    const double *aims; /* [n_aims] its objectives, while they are ranked */
    int n_aims;
    int candidate;
} mt_mode_placement_solution;

typedef struct mt_mode_placement_result {
    int n_solutions; /* feasible ones by objective; else compromises by violation */
    mt_mode_placement_solution *solutions;
    bool compromise;
    /* assignments that may have a design; 0: proven that none has, the solutions are the
     * nearest misses */
    int n_candidates;
    int n_searched; /* of all */
    int n_feasible; /* of them with a design that meets all goals */
    /* candidates came best first, until the designs that are asked for were known. No design
     * of one that was not searched has a first objective below `rest`, which is proven
     * (HUGE_VAL: none has a design), and, where it is `bounded`, below those that are listed */
    double rest;
    bool ended;
    bool bounded;
    double n_possible; /* all monotone assignments there are */
    /* a configuration is a driven position: what lies between the positions is not searched */
    bool driven;
    /* some are positions of one drive: designs were followed between them (motion.h) */
    bool motion;
    bool tolerances;    /* variables have some, which the proof leaves out */
    bool proven;        /* every assignment that was not searched is proven infeasible */
    const char *reason; /* why not, where not proven */
    /* directions that the goals do not settle at the best solution (mt_nlp_result) */
    int n_unidentifiable;
    double *unidentifiable; /* n x n_unidentifiable */
    double *unidentifiable_effect;
    long boxes; /* of the proof */
    long evals;
    int starts;
    int stage; /* the objective that the solutions' f belongs to */
    mt_steps steps;
    mt_stop stop;
} mt_mode_placement_result;

/* Is called before a long proof or many samples, with what was found before them, if that meets
 * all goals; what it finds is of that moment. */
typedef struct mt_mode_placement_incumbent {
    mt_status (*tell)(void *context, const mt_mode_placement_result *found, mt_err *err);
    void *context;
} mt_mode_placement_incumbent;
/* workers[n_workers], set to one case without an assignment, and set to it again afterwards.
 * early may be NULL. Results in mem. Fails also: as early->tell. */
mt_status mt_mode_placements_solve(mt_workspace *const *workers, int n_workers,
                                   const mt_mode_placement_incumbent *incumbent, mt_arena *mem,
                                   mt_mode_placement_result *out, mt_err *err);

/* mode_placements_copy.c: a copy in mem of a solution of assignment below[n_bands]: its
 * search's memory goes. Fails: MT_E_MEMORY. */
mt_status mt_mode_placement_copy(const mt_subproblem *c, const int *below,
                                 const mt_nlp_solution *from, mt_arena *mem,
                                 const mt_nlp_solution **out, mt_err *err);

/* Likewise of what holds it. */
mt_status mt_mode_placement_copy_held(mt_arena *mem, mt_mode_placement_solution *s,
                                      mt_err *err);
/* What holds a solution of case c at the cuts that it has beside those of its problem, in mem:
 * rows with a price. Fails: MT_E_MEMORY. */
mt_status mt_mode_placement_hold(const mt_subproblem *c, const struct mt_cut *cuts,
                                 const mt_nlp_solution *s, mt_arena *mem,
                                 mt_mode_placement_solution *out, mt_err *err);

/* mode_placements_rank.c: the best first. Stable: what is equal keeps the order of the
 * assignments. */
void mt_mode_placement_rank(const mt_subproblem *c, mt_mode_placement_result *r);

/* mode_placements_clearance.c: one more thing is missed at a design. */
void mt_mode_placement_refuse(mt_nlp_solution *best, double short_of, double tolerance);
/* Where the case makes the least clearance most: designs that a search met on its way, and
 * those that it ended at, miss what it is less than 0. */
void mt_mode_placement_refuse_step(const mt_subproblem *c, mt_step *s);
void mt_mode_placement_verify_clearance(const mt_subproblem *c, mt_nlp_result *found);

/* mode_placements_budget.c: what a budget of evaluations has for candidates, of which `left`
 * are left. A search of fewer than so many is not begun. */
enum { MT_GAP_SEARCH_LEAST = 10 };
/* To judge one design, with its objectives, at most. */
long mt_mode_placement_verdict(const mt_subproblem *c);
/* How many of n candidates are searched: one in any case; all, where there is no budget. */
int mt_mode_placement_affordable(const mt_subproblem *c, int n, long left);
/* How often each of n may be evaluated; 0: as often as it takes. */
long mt_mode_placement_share(const mt_subproblem *c, int n, long left);

enum { MT_GAP_SAMPLES_NEAR = 512 };
/* mode_placements_candidates.c: the assignments worth searching, n rows of n_bands. */
typedef struct mt_mode_placement_candidates {
    int n;
    int *below;
    double *at; /* n rows of p->n: a design t to start from, NaN: none; NULL: none at all */
    /* [n] no design with it has less of the first objective (mode_placements_bounds.h); NULL:
     * not known */
    double *least;
    int n_proven; /* the first ones: a design that has them is known */
    double possible;
    bool proven; /* all assignments that are not listed are proven infeasible */
    bool all;    /* likewise, but which of those listed can be met is open */
    const char *reason;
    long boxes;
    double undecided; /* share of the bounds that the proof left open */
    long evals;
} mt_mode_placement_candidates;
/* Monotone assignments of m bands to n modes, C(n + m, m), over all configurations; positions
 * of one drive have one between them. */
double mt_mode_placement_count_possible(const mt_problem *p);
/* Assignment below[n_bands] of the design at t[n], and its worst violation; NaN where it cannot
 * be evaluated. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_mode_placement_assignment(mt_workspace *w, const double *t, int *below,
                                       double *violation, mt_err *err);
/*
 * What to search before a proof: where a little of its work settles the question, that is `all`
 * (proven) and there is no first; else `first` are the assignments that it met, or the one that
 * a few samples come nearest to. A quarter of that work where candidates come best_first.
 * proof: of w's case.
 */
mt_status mt_mode_placement_candidates_first(mt_workspace *w, mt_proof *proof, bool best_first,
                                             mt_arena *mem, mt_mode_placement_candidates *all,
                                             mt_mode_placement_candidates *first, mt_err *err);
/* When the designs that are asked for are known: what a little more work settles, where that
 * promises to. */
mt_status mt_mode_placement_candidates_settle(mt_workspace *w, mt_proof *proof, mt_arena *mem,
                                              mt_mode_placement_candidates *all, mt_err *err);
/* The designs that `met` has for rows of c become those that their searches start from. */
void mt_mode_placement_candidates_start(const mt_mode_placement_candidates *met,
                                        const mt_problem *p, mt_mode_placement_candidates *c);
/* With all the work that the case allows; spent: evaluations so far. */
mt_status mt_mode_placement_candidates_find(mt_workspace *w, mt_proof *proof, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err);
/* The (at most) `most` assignments that samples over the bounds come nearest to. */
mt_status mt_mode_placement_candidates_near(mt_workspace *w, int most, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err);

#endif
