/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_LOCAL_H
#define NLP_LOCAL_H

#include "nlp/engine.h"

/* One local search and its end. */
typedef struct mt_nlp_local {
    mt_nlp_point *p;    /* the start, then the best point met */
    mt_nlp_point *last; /* where SLSQP stopped */
    mt_nlp_stage stage; /* what Newton minimises; squares: a root, no Newton step */
    int n_rows;
    int *rows;      /* [n_rows] independent equalities */
    bool begun;     /* the start has values */
    bool restored;  /* SLSQP ended infeasible; p minimises the squares of the violations */
    bool abandoned; /* far from feasible, and compromises are not wanted */
    bool curve;     /* solutions form a curve here: no isolated root */
    bool polished;  /* finished */
    double *from;   /* [n] end of the approach */
    double kkt;     /* relative KKT residual at `from` */
    int start;      /* the start that found it first */
    int hits;       /* number of starts that ended here */
    bool merged;    /* another root was merged into it */
} mt_nlp_local;

/* A local search with its arrays in mem. */
mt_nlp_local mt_nlp_local_new(const mt_nlp_engine *e, mt_arena *mem);
/* First-order approach from p, which has values, to within about 1e-5 of a local solution; then
 * full accuracy by Newton, leaving saddles. Neither makes p worse. */
void mt_nlp_local_approach(mt_nlp_engine *e, mt_nlp_local *s);
void mt_nlp_local_finish(mt_nlp_engine *e, mt_nlp_local *s);
/* Both, for the objective under the constraints, with rows[n_rows] as the equalities. */
void mt_nlp_minimise(mt_nlp_engine *e, mt_nlp_local *s);
/* True where p is near enough to feasible for Newton's method before a restoration. */
bool mt_nlp_nearly_feasible(const mt_nlp_point *p);
/* The point that represents the search: `last` where it is unfinished and nearly feasible, else
 * p. */
const mt_nlp_point *mt_nlp_local_stand(const mt_nlp_local *s);

#endif
