/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_RELAXATION_H
#define SEARCH_RELAXATION_H

#include "problem/workspace.h"
#include "result/result.h"
#include "search/mode_placements.h"

/*
 * Where no design meets all goals: which single number of the question, moved by how little and
 * everything else as it is, would let one exist. A move is a bound of a continuous variable, an
 * edge of a band (with its margin), or the target or limit of a goal. For each of them
 *     minimise s  subject to
 *         all bounds and rows of the study, those of the moved number relaxed by s,
 * s being the logarithm of the move (its part of the limit, where that has no logarithm), by
 * local searches from several starts; with bands in the gap assignments that come nearest, for
 * bounds and for what the miss that the search found there presses against (relaxation_near.c).
 * What is found is a design, so a move that is reported suffices for certain; that a smaller
 * one would not is sampled.
 *     Many designs may do with the same move, so the design that is reported answers another
 * question: of all that meet the study's rows with the number moved by the least s (and 1e-7
 * more, less than rows are kept to) that of least change,
 *     minimise 1/2 sum w_i (t_i - t_i(original))^2.
 *     Ties are not left to rounding: sizes that differ by less than MT_EQUAL_FOUND are equal.
 * Of equal moves of one number the design of less change counts, then the first in the order of
 * assignments or combinations; equal moves of several numbers are listed in the order of the
 * question: bounds, edges of bands, goals, each as the study lists them, lower before upper.
 */
typedef enum mt_move_kind { MT_MOVE_BOUND, MT_MOVE_EDGE, MT_MOVE_GOAL } mt_move_kind;

typedef struct mt_move {
    mt_move_kind kind;
    bool upper;      /* bound, edge: the upper one; goal: at_most */
    int variable;    /* bound */
    int avoidance;   /* edge */
    int band;        /* edge: of the clear's list */
    int requirement; /* goal */
    bool target;     /* goal: an equality */
    bool found;
    double from;
    double to;
    double size;   /* |s|: by which moves are ranked */
    double change; /* f of x */
    double *x;     /* [n] the design of least change that meets everything after the move */
    int order;     /* its place in the question */
} mt_move;

typedef struct mt_moves {
    int n; /* found, least first */
    mt_move *items;
    long evals;
    int starts;
    bool short_of_budget; /* the study's budget leaves too little: none was tried */
    bool stopped;         /* interrupted: not all moves were tried */
} mt_moves;

/**
 * @param[in] workers [n_workers] set to one case without an assignment, in which no catalogue
 *   is open; set to it again
 *                      afterwards
 * @param[in]  search  what the search found (a compromise to start from, where it has one) and
 *                     spent of the study's budget
 * @param[in]  gaps    the same with the gap assignments, or NULL
 * @param[out] out lists in mem Every move reported has been confirmed by a new workspace at its
 *   design. Deterministic for any number of workers. Cost: some 1000 evaluations for each move,
 *   of which a third at most is for its design.
 *   Fails: MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_relaxation_solve(mt_workspace *const *workers, int n_workers,
                              const mt_nlp_result *search,
                              const mt_mode_placement_result *placements, mt_arena *mem,
                              mt_moves *out, mt_err *err);

/* relaxation_near.c: what misses one gap assignment by the least, as far as that is known. */
typedef struct mt_near_miss {
    const int *below;
    const double *t;
    bool *presses; /* [moves] against its number: else its move changes nothing there */
} mt_near_miss;

typedef struct mt_near_misses {
    int n_bands;
    int n;
    mt_near_miss *items;
} mt_near_misses;

/* w: set to a case without an assignment. gaps may be NULL: then there are none. One evaluation
 * each. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_relaxation_misses(mt_workspace *w, const mt_mode_placement_result *placements,
                               const mt_moves *moves, mt_arena *mem, mt_near_misses *out,
                               mt_err *err);
/* NULL: none is known in this assignment. */
const mt_near_miss *mt_relaxation_miss(const mt_near_misses *misses, const int *below);

/* relaxation_discrete.c: the same for a study with catalogues. Without continuous variables all
 * combinations are looked at (short_of_budget where those are too many). */
mt_status mt_relaxation_discrete(mt_workspace *const *workers, int n_workers,
                                 const mt_nlp_result *search, mt_arena *mem, mt_moves *out,
                                 mt_err *err);

/* relaxation_moves.c: all moves that the study offers, none tried yet. Fails: MT_E_MEMORY. */
mt_status mt_relaxation_moves(const mt_subproblem *c, mt_arena *mem, mt_moves *out,
                              mt_err *err);
/* The case in which the move's bound is moved away, and the objective is the change; w is set
 * to it. Nothing is laid out, and false in *useful, where there is no room to move. */
mt_status mt_relaxation_subproblem(const mt_subproblem *from, const mt_move *m, mt_workspace *w,
                                   mt_arena *mem, mt_subproblem *out, bool *useful,
                                   mt_err *err);
/* The value that the move's number must have for the rows of w, just evaluated into v, to hold;
 * NaN where other rows do not. */
double mt_relaxation_value(const mt_workspace *w, const mt_move *m, const mt_nlp_values *v);
/* A move by more than a factor of ten (ln 10), or than 2.3 times the limit itself where it has
 * no logarithm, is no help. */
static const double MT_RELAXATION_MOST = 2.302585092994046;
/* By how much that is a move, |s|; NaN where it is none, is in the wrong direction, or is too
 * far to be of help. */
double mt_relaxation_size(const mt_problem *p, const mt_move *m, double to);
/* True where a move of this size, with a design of this change, is less than what was found for
 * m: by its size or, where sizes are equal, by its change. */
bool mt_relaxation_is_less(const mt_move *m, double size, double change);
/* Into m, what is less: the move to `to` with the design x[n]. */
void mt_relaxation_keep(mt_move *m, double size, double change, double to, const double *x,
                        int n);
/* Found moves of `from` into `to`, which lists all, where they are less; n: variables. */
void mt_relaxation_merge(mt_moves *to, const mt_moves *from, int n);
/* Found ones only, least first, equal ones in the order of the question. */
void mt_relaxation_rank(mt_moves *moves);
/* Whether this row of `in` (of the equalities, where eq) is the move's. */
bool mt_relaxation_is_row(const mt_subproblem *c, const mt_move *m, bool eq, int row);

#endif
