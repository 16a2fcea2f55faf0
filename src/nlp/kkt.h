/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_KKT_H
#define NLP_KKT_H

#include "nlp/engine.h"

/* Active constraints of a point and their multipliers: on the free variables, gradient of the
 * stage's function = sum lambda_i grad c_i, c_i an equality or an active inequality. */
typedef struct mt_nlp_active {
    int n_free;
    int *free; /* [n_free] variables neither held nor at an active bound */
    int *side; /* [n] -1 lower, +1 upper bound active, 0 not (held variables: 0) */
    int k;
    /* [k] i < n_eq: equality i; else inequality i - n_eq, the `next` rows after the others */
    int *row;
    double *scale;  /* [k] norm of the row on the free variables (1 for a zero row) */
    double *lambda; /* [k] */
    double *z;      /* [n] gradient minus sum lambda_i grad c_i, all variables */
    double *c;      /* [k] values */
    mt_qr qr;       /* of the n_free x k matrix of scaled gradients */
    double kkt;     /* |z on the free variables|, relative */
} mt_nlp_active;

bool mt_nlp_active_set(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                       mt_arena *mem, mt_nlp_active *a);
/* Derivative of constraint row i (as in mt_nlp_active.row) with respect to variable j. */
double mt_nlp_row_slope(const mt_nlp_engine *e, const mt_nlp_point *p, int i, int j);
/* Value and tolerance of constraint row i. */
double mt_nlp_row_value(const mt_nlp_engine *e, const mt_nlp_point *p, int i);
double mt_nlp_row_tol(const mt_nlp_engine *e, int i);

#endif
