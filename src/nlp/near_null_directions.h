/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_NEAR_NULL_DIRECTIONS_H
#define NLP_NEAR_NULL_DIRECTIONS_H

#include "nlp/engine.h"

/* Singularity of the active constraints at p. curve: further feasible points lie along a weak
 * direction (a curve of solutions); rows: independent equalities. */
typedef struct mt_nlp_near_null_directions {
    bool singular;
    bool curve;
    int n_rows;
    int *rows; /* [n_eq] ascending */
} mt_nlp_near_null_directions;
bool mt_nlp_near_null_directions_at(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                                    mt_nlp_near_null_directions *w);

#endif
