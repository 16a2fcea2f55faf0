/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_SOLUTION_POOL_H
#define NLP_SOLUTION_POOL_H

#include "nlp/engine.h"
#include "nlp/local.h"

typedef struct mt_nlp_solution_pool {
    mt_nlp_local *at; /* [count], with the capacity of mt_nlp_solution_pool_grow */
    int count;
    int starts;                   /* made so far */
    const mt_nlp_point *directed; /* where the unidentifiable directions were computed */
} mt_nlp_solution_pool;

/* Add capacity for n more ends. */
void mt_nlp_solution_pool_grow(mt_nlp_engine *e, mt_nlp_solution_pool *all, int n);
/* Number of isolated roots; *once: those that one start only ended at. 0 where the problem has
 * none, or a curve of solutions. */
int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *once);
/*
 * True where a further end is unlikely. From n feasible ends in w places the expected number of
 * places is w (n - 1)/(n - w - 2), with a uniform prior of that number (Boender and Rinnooy
 * Kan, Math. Prog. 37, 1987, eq. 9); true where this is less than w + 1/2. One place needs
 * eight ends, two need seventeen.
 */
bool mt_nlp_solution_pool_settled(mt_nlp_engine *e, const mt_nlp_solution_pool *all);
/* True where all starts so far lead to one feasible design. */
bool mt_nlp_solution_pool_agree(mt_nlp_engine *e, const mt_nlp_solution_pool *all);
/* Ends to polish next, chosen[all->count], one of each neighbourhood; ends at one that is
 * already polished are dropped. Returns their number. */
int mt_nlp_solution_pool_choose(mt_nlp_engine *e, mt_nlp_solution_pool *all,
                                const mt_nlp_result *directions, mt_nlp_local **chosen);
/* True where Newton's method converged there. */
bool mt_nlp_came_to_rest(const mt_nlp_local *s);

bool mt_nlp_unidentifiable(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                           mt_nlp_result *out);

/* Ranks, merges and verifies the ends: *out in mem (nlp.h). */
void mt_nlp_verify_kkt(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_arena *mem,
                       mt_nlp_result *out);

#endif
