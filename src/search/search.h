/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_SEARCH_H
#define SEARCH_SEARCH_H

#include "problem/workspace.h"

struct mt_tolerance_cuts;
struct mt_cut;

/*
 * Search a problem for designs. The first objective from many starts (mt_nlp_solve); then, for
 * every design found, the next objective from there with the ones before it held
 * (mt_objective_stage_hold), and so on through the list; where that leaves a continuum, the
 * change (mt_search_nearest). Designs that have become one are reported once, in the order of
 * the objectives. A compromise, a spent budget or an interruption ends the list: out->stop
 * tells, and *stage is the objective that the solutions' f belongs to. Undetermined directions
 * are those at the best design. workers[n_workers], set to one case, in its first stage: the
 * result is the same for any number of them. Results in mem; the workers are set to that case
 * again. Deterministic. That no start has any value is no failure: then there are no solutions
 * and *why tells what was wrong. Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_USAGE.
 */
mt_status mt_search_designs(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                            mt_nlp_result *out, int *stage, mt_err *why, mt_err *err);

/* A limit between the positions of a drive that holds a design. */
typedef struct mt_at_position_price {
    const struct mt_at_position_price *next;
    const double *t; /* of the solution that it holds */
    int requirement;
    double position;   /* [rad, m] */
    double multiplier; /* of its row */
} mt_at_position_price;

/*
 * search_tolerances.c: the same, and every design is held over its tolerances where the corners
 * of the case are samples (problem/tolerance_cut.h): what is worse within them becomes one more
 * corner, and the search goes on from there, within its budget, a part of which is kept for
 * these judgements; what it has none left for is not feasible. Limits of numbers are held
 * likewise between the positions of a drive that their goals name. A design that misses
 * something even so is none where another one meets everything. *prices (NULL: not wanted):
 * what limits between positions cost, of all designs, in mem.
 */
mt_status mt_search_over_tolerances(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, int *stage,
                                    const mt_at_position_price **prices, mt_err *why,
                                    mt_err *err);
/* Judge one design, in the case that w is set to: *again, where there are new cuts to go on
 * with; without them, or the last time, a design that misses something is not feasible. */
mt_status mt_search_verify(mt_workspace *w, bool last, mt_arena *mem,
                           struct mt_tolerance_cuts *cuts, mt_nlp_solution *s, bool *again,
                           mt_err *err);
/* search_positions.c: limits between the positions of a drive. Grown by who judges. */
typedef struct mt_at_position_cuts {
    int n;
    struct mt_cut *items; /* owned */
    /* of the last design judged */
    int added;
    bool holds; /* every limit, at all positions that were looked at */
    long evals;
} mt_at_position_cuts;
/* Whether there is anything to judge so. */
bool mt_search_has_positions(const mt_subproblem *c);
/* Judge the design at t, and add the positions where it misses a limit, but the last time.
 * Fails: as an evaluation, as mt_drive_path_limit. */
mt_status mt_search_verify_positions(mt_workspace *w, const double *t, bool last, mt_arena *mem,
                                     mt_at_position_cuts *cuts, mt_err *err);
/* *out: first[n] and then cuts, whose memory stays theirs, for mt_subproblem_lay_out. Fails:
 * MT_E_MEMORY. */
mt_status mt_at_position_cuts_used(const mt_at_position_cuts *cuts, int n,
                                   const struct mt_cut *first, mt_arena *mem,
                                   struct mt_cut **out, mt_err *err);
void mt_at_position_cuts_free(mt_at_position_cuts *cuts);
/* search.c: the stages of one search of the case that ws is set to, from the design at `from`
 * alone. out->solutions[0] is what became of it, where there is any. */
mt_status mt_search_from(mt_workspace *ws, const double *from, mt_arena *mem,
                         mt_nlp_result *out, int *stage, mt_err *err);
/* Rank designs by the objectives in their order, those that have become one once; `stage` is
 * what their f becomes. */
mt_status mt_search_rank(mt_workspace *ws, int stage, mt_arena *mem, mt_nlp_result *out,
                         mt_err *err);

/* Whether designs at a[n] and b[n] are one, as in the search itself. */
bool mt_search_same(int n, const double *a, const double *b);
/* search_continuum.c: mt_is_nearer (nlp/merit.h) from the original of the case. */
bool mt_search_nearer(const mt_subproblem *c, const double *s, const double *t);

/*
 * search_nearest.c: of designs that are as good the one of least change. A solution that is
 * flat (mt_nlp_solution) stands where its search ended, which rounding decides; the rule is
 *
 *     minimise the change   with all objectives held (mt_objective_stage_hold),
 *
 * from there, then with the last one held closely, so that it keeps its value in every digit
 * that is told. Solutions that are not flat stay as they are, those for which no such design is
 * found, and all where the change or a misfit is among the objectives. out->evals may grow to
 * `most` (0: no limit). f (NULL with one objective): n_aims objectives of each solution, kept
 * up; limit: likewise what those before the last are held at. With one objective the solutions
 * are ranked afterwards, and what has become one counts once. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, MT_E_USAGE.
 */
mt_status mt_search_nearest(mt_workspace *ws, long most, double *f, const double *limit,
                            mt_arena *mem, mt_nlp_result *out, mt_err *err);

/* search_repeated_eigenvalues.c: improve ends where modes repeat, judge whether they are
 * optima, rank, and drop what is one and what is not shown to be optimal behind a better
 * design. In the present stage; solutions and their multipliers in place. out->evals may grow
 * to `most` (0: some thousands more). Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_USAGE. */
mt_status mt_search_repeated_eigenvalues(mt_workspace *ws, long most, mt_arena *mem,
                                         mt_nlp_result *out, mt_err *err);

/* search_continuum.c: of solutions between which all designs are feasible and have their
 * objectives, one is kept (solution->continuum); n_found and n_once likewise. At most 3
 * evaluations for each pair with equal objectives. In place; compromises stay as they are.
 * Fails: MT_E_MEMORY. */
mt_status mt_search_join_continua(mt_workspace *ws, mt_arena *mem, mt_nlp_result *out,
                                  mt_err *err);

#endif
