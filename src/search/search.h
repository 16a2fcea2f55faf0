/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_SEARCH_H
#define SEARCH_SEARCH_H

#include "problem/workspace.h"

struct mt_tolerance_cuts;
struct mt_cut;

/*
 * Search a problem for designs: the first objective from many starts (mt_nlp_solve); then, for
 * every design found, the next objective from there with the earlier ones held
 * (mt_objectives_hold), and so on; where that leaves a continuum, the least total change
 * (mt_search_nearest). Identical designs are reported once, in the order of the objectives. A
 * compromise, a spent budget or an interruption ends the list: see out->stop; *stage is the
 * objective that the solutions' f belongs to. Unidentifiable directions are those at the best
 * design. workers[n_workers]: set to one subproblem in its first stage, and to it again
 * afterwards. Results in mem; deterministic for any number of workers. Where no start has any
 * value there are no solutions, *why has the reason, and the call succeeds. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, MT_E_USAGE.
 */
mt_status mt_search_designs(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                            mt_nlp_result *out, int *stage, mt_err *why, mt_err *err);

/* A limit that is active at a design between the positions of a drive. */
typedef struct mt_at_position_price {
    const struct mt_at_position_price *next;
    const double *t; /* of that solution */
    int requirement;
    double position;   /* [rad, m] */
    double multiplier; /* of its row */
} mt_at_position_price;

/*
 * search_tolerances.c: mt_search_designs, and every design is verified over its tolerances
 * where the subproblem samples tolerance corners (problem/tolerance_cut.h). A violated corner
 * is added, and the search continues from the design within its budget, part of which is
 * reserved for verification; designs left unverified are infeasible. Without a budget a search
 * begins with the nominal design and the subproblem's cuts_known alone, where other corners
 * come as cuts; cuts_found receives the cuts of what was found, in mem. Limits on values are
 * verified in the same way between the positions of a drive that their goals name. Designs that
 * still violate a limit are dropped where another meets everything. *prices (NULL: not wanted):
 * multipliers of limits between positions, of all designs, in mem.
 */
mt_status mt_search_over_tolerances(mt_workspace *const *workers, int n_workers, mt_arena *mem,
                                    mt_nlp_result *out, int *stage,
                                    const mt_at_position_price **prices, mt_err *why,
                                    mt_err *err);
/* Verify one design in the subproblem of w. *again: new cuts were added, search again; without
 * them, or where `last`, a design that violates a limit becomes infeasible. */
mt_status mt_search_verify(mt_workspace *w, bool last, mt_arena *mem,
                           struct mt_tolerance_cuts *cuts, mt_nlp_solution *s, bool *again,
                           mt_err *err);
/* search_tolerances.c: limits between the positions of a drive, added by verification. */
typedef struct mt_at_position_cuts {
    int n;
    struct mt_cut *items; /* owned */
    /* of the last design verified */
    int added;
    bool holds; /* every limit holds at all sampled positions */
    long evals;
} mt_at_position_cuts;
/* True where the subproblem has limits between positions. */
bool mt_search_has_positions(const mt_subproblem *c);
/* Verify the design at t and add the positions where it violates a limit, except where `last`.
 * Fails: as an evaluation, as mt_drive_path_limit. */
mt_status mt_search_verify_positions(mt_workspace *w, const double *t, bool last, mt_arena *mem,
                                     mt_at_position_cuts *cuts, mt_err *err);
void mt_at_position_cuts_free(mt_at_position_cuts *cuts);
/* All stages of one search of ws's subproblem from the design `from` alone.
 * out->solutions[0] is its result, if any. */
mt_status mt_search_from(mt_workspace *ws, const double *from, mt_arena *mem,
                         mt_nlp_result *out, int *stage, mt_err *err);
/* Rank designs by the objectives in their order, identical ones once; their f becomes that of
 * `stage`. */
mt_status mt_search_rank(mt_workspace *ws, int stage, mt_arena *mem, mt_nlp_result *out,
                         mt_err *err);

/* True where designs a[n] and b[n] are one, by the rule of the search. */
bool mt_search_same(int n, const double *a, const double *b);
/* mt_is_nearer (nlp/merit.h) from the original of the subproblem. */
bool mt_search_nearer(const mt_subproblem *c, const double *s, const double *t);

/*
 * search_nearest.c: of equally good designs the one of least total change. A flat solution
 * (mt_nlp_solution) is where its search happened to end; from there
 *
 *     minimise the total change   with all objectives held (mt_objectives_hold),
 *
 * then again with the last objective held more closely, so that every printed digit of its
 * value stays. Solutions stay unchanged where they are not flat, where no such design is found,
 * and where the total change or a misfit is among the objectives. out->evals may grow to `most`
 * (0: no limit). f (NULL with one objective): n_stages objectives of each solution, updated;
 * limit: the values at which those before the last are held, in the same layout. With one
 * objective the solutions are ranked afterwards, and identical ones are joined. Fails:
 * MT_E_MEMORY, MT_E_INTERNAL, MT_E_USAGE.
 */
mt_status mt_search_nearest(mt_workspace *ws, long most, double *f, const double *limit,
                            mt_arena *mem, mt_nlp_result *out, mt_err *err);

/* search_repeated_eigenvalues.c: improve ends where modes repeat, test whether they are optima,
 * rank them, and drop duplicates and those not shown to be optimal that rank behind a better
 * design. In the present stage; solutions and their multipliers in place. out->evals may grow
 * to `most` (0: some thousands more). Fails: MT_E_MEMORY, MT_E_INTERNAL, MT_E_USAGE. */
mt_status mt_search_repeated_eigenvalues(mt_workspace *ws, long most, mt_arena *mem,
                                         mt_nlp_result *out, mt_err *err);

#endif
