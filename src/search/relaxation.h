/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_RELAXATION_H
#define SEARCH_RELAXATION_H

#include "problem/workspace.h"
#include "result/result.h"
#include "search/mode_placements.h"

/*
 * Relaxations where no design meets all goals: each single number of the study whose change
 * alone makes a design feasible, and the least such change. A move is a bound of a continuous
 * variable, an edge of a band (with its margin), or the target or limit of a goal. Each is
 * solved as
 *     minimise s  subject to
 *         all bounds and rows of the study, those of the moved number relaxed by s,
 * s being the logarithm of the move (relative to the limit where that has no logarithm), by
 * local searches from several starts; with bands in the nearest mode placements, for bounds and
 * for the rows that are active at the miss found there. A reported move
 * comes with a design, so it certainly suffices; that a smaller one does not is sampled, not
 * proven.
 *
 * The reported design is the one of least total change among those that meet the study's rows
 * with the number moved by the least s (plus 1e-7, less than the tolerance of rows),
 *     minimise 1/2 sum w_i (t_i - t_i(original))^2.
 *
 * Sizes that differ by less than MT_EQUAL_FOUND are equal. Ties of one number are ordered by
 * the total change of the design, then by the order of placements or combinations; ties of
 * several numbers by the order of the study: bounds, edges of bands, goals, each as listed,
 * lower before upper.
 */
typedef enum mt_move_kind { MT_MOVE_BOUND, MT_MOVE_EDGE, MT_MOVE_GOAL } mt_move_kind;

typedef struct mt_move {
    mt_move_kind kind;
    bool upper;      /* bound, edge: the upper one; goal: at_most */
    int variable;    /* bound */
    int avoidance;   /* edge */
    int band;        /* edge: index in the avoidance goal's list */
    int requirement; /* goal */
    bool target;     /* goal: an equality */
    bool found;
    double from;
    double to;
    double size;       /* |s|, which ranks moves */
    double change;     /* half of the squared total change of x */
    double *x;         /* [n] design of least change that meets everything after the move */
    bool least_change; /* of a point of a trade study: x is that, else any design that does */
    int order;         /* position in the order of the study */
} mt_move;

typedef struct mt_moves {
    int n; /* found, smallest first */
    mt_move *items;
    bool *useless; /* [by order] proven: no design within reach of the move meets the rest */
    int n_listed;
    long evals;
    int starts;
    bool short_of_budget; /* the study's budget is too small: none was tried */
    bool stopped;         /* interrupted: some moves were not tried */
} mt_moves;

/* Moves of a study that differs in one number. */
typedef struct mt_moves_known {
    const mt_moves *moves;
    const mt_vary *number;             /* that one */
    bool looser;                       /* every design of this study is one of that */
    const struct mt_moves_known *next; /* of a further study; NULL: there is none */
} mt_moves_known;

/* out: the moves in mem. Fails: MT_E_MEMORY. */
mt_status mt_moves_copy(const mt_moves *from, int n_variables, mt_arena *mem, mt_moves *out,
                        mt_err *err);

/**
 * Tries all moves.
 * @param[in]  workers     [n_workers] set to one subproblem without a placement and with all
 *   catalogues fixed; set to it again afterwards
 * @param[in]  search      result of the search (starts from its compromise, where it has one)
 *   and evaluations used of the study's budget
 * @param[in]  placements  its mode placements, or NULL
 * @param[in]  known       moves of studies that differ by little in one number, or NULL: where
 *   there are no bands, a move that it has, too, is searched from its design, and from other
 *   starts only where that search does not end at a local minimum; where that one number moves,
 *   both have the same designs, and nothing is searched
 * @param[out] out         lists in mem
 * Every reported move is confirmed by a new workspace at its design. Of a point of a trade
 * study, of which the least move is told, the others' designs may be any. Deterministic for any
 * number of workers. Cost: some 1000 evaluations for each move, at most a third of them for its
 * design. Fails: MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_relaxation_solve(mt_workspace *const *workers, int n_workers,
                              const mt_nlp_result *search,
                              const mt_mode_placement_result *placements,
                              const mt_moves_known *known, mt_arena *mem, mt_moves *out,
                              mt_err *err);

/* mt_relaxation_solve for a study with catalogues. Without continuous
 * variables all combinations are evaluated (short_of_budget where these are too many). */
mt_status mt_relaxation_catalogue(mt_workspace *const *workers, int n_workers,
                                  const mt_nlp_result *search, mt_arena *mem, mt_moves *out,
                                  mt_err *err);
/* The value of the move's number at which the rows of w, just evaluated into v, hold; NaN where
 * other rows do not hold. */
double mt_relaxation_value(const mt_workspace *w, const mt_move *m, const mt_nlp_values *v);
/* |s| of the move to `to`; NaN where it is none, is in the wrong direction, or exceeds
 * MT_RELAXATION_MOST. */
double mt_relaxation_size(const mt_problem *p, const mt_move *m, double to);
/* Merges found moves of `from` into `to`, which lists all, where they precede; n: variables. */
void mt_relaxation_merge(mt_moves *to, const mt_moves *from, int n);

#endif
