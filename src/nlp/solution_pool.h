/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_SOLUTION_POOL_H
#define NLP_SOLUTION_POOL_H

#include "nlp/engine.h"
#include "nlp/local.h"

typedef struct mt_nlp_solution_pool {
    mt_nlp_local *at; /* [count], with the capacity that nlp.c gives it */
    int count;
    int starts;                   /* made so far */
    const mt_nlp_point *directed; /* where the unidentifiable directions were computed */
} mt_nlp_solution_pool;

/* Number of isolated roots; *once: those that one start only ended at. 0 where the problem has
 * none, or a curve of solutions. */
int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_solution_pool *all, int *once);
/* True where Newton's method converged there. */
bool mt_nlp_came_to_rest(const mt_nlp_local *s);

bool mt_nlp_unidentifiable(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                           mt_nlp_result *out);

/* Ranks, merges and verifies the ends: *out in mem (nlp.h). */
void mt_nlp_verify_kkt(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_arena *mem,
                       mt_nlp_result *out);

#endif
