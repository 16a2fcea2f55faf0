/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_SOLUTION_POOL_H
#define NLP_SOLUTION_POOL_H

#include "nlp/local.h"

typedef struct mt_nlp_solution_pool {
    mt_nlp_local *at; /* [count], and room for those of mt_nlp_solution_pool_grow */
    int count;
    int starts;                   /* made so far */
    const mt_nlp_point *directed; /* where the undetermined directions were sought */
} mt_nlp_solution_pool;

/* Room for n ends more. */
void mt_nlp_solution_pool_grow(mt_nlp_engine *e, mt_nlp_solution_pool *all, int n);
/* Isolated roots, *once: those that one start only ended at; 0 where the problem has none, or a
 * curve of solutions. */
int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *once);
/*
 * True where the ends so far leave little hope of another one. Of n feasible ends in w places
 * the number of places is expected to be w (n - 1)/(n - w - 2), each a priori as likely as any
 * number of them (Boender and Rinnooy Kan, Math. Prog. 37, 1987, eq. 9): by less than half a
 * place more than w. One place takes eight of its ends, two take seventeen.
 */
bool mt_nlp_solution_pool_settled(mt_nlp_engine *e, const mt_nlp_solution_pool *all);
/* True where all starts so far lead to one feasible design. */
bool mt_nlp_solution_pool_agree(mt_nlp_engine *e, const mt_nlp_solution_pool *all);
/* Ends to polish next, chosen[all->count]: of those that are near each other one; ends that lie
 * at one that is polished are dropped. Returns how many. */
int mt_nlp_solution_pool_choose(mt_nlp_engine *e, mt_nlp_solution_pool *all,
                                const mt_nlp_result *directions, mt_nlp_local **chosen);
/* Whether Newton came to rest there. */
bool mt_nlp_came_to_rest(const mt_nlp_local *s);
/* Ends nearer than this are one; then, whether the problem asks for isolated roots. */
double mt_nlp_same_distance(const mt_nlp_engine *e);
bool mt_nlp_seeks_roots(const mt_nlp_engine *e);

#endif
