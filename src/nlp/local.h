/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_LOCAL_H
#define NLP_LOCAL_H

#include "base/serializer.h"
#include "nlp/engine.h"

/* One local search, and where it ended. */
typedef struct mt_nlp_local {
    mt_nlp_point *p;    /* the start, then the best it met */
    mt_nlp_point *last; /* where SLSQP came to rest */
    mt_nlp_stage stage; /* what Newton has to do: nothing for a root (squares) */
    int n_rows;
    int *rows;     /* [n_rows] the equalities that are independent */
    bool begun;    /* the start has values */
    bool restored; /* SLSQP had no feasible end, and the least squares of the violations is p */
    bool abandoned; /* it is far from feasible, and compromises are of no use */
    bool curve;     /* solutions form a curve here: no isolated root */
    bool polished;  /* nothing is left to be done */
    double *from;   /* [n] where the approach ended */
    double kkt;     /* relative KKT residual there */
    int start;      /* which start found it first */
    int hits;       /* how many starts ended here */
    bool merged;    /* another root was merged into it */
} mt_nlp_local;

/* A search with its room in mem. */
mt_nlp_local mt_nlp_local_new(const mt_nlp_engine *e, mt_arena *mem);
/* From p, which has values, to about where it leads; then all the way, off saddles, never for
 * the worse. */
void mt_nlp_local_approach(mt_nlp_engine *e, mt_nlp_local *s);
void mt_nlp_local_finish(mt_nlp_engine *e, mt_nlp_local *s);
/* Both for the objective under the constraints, the equalities being rows[n_rows]. */
void mt_nlp_minimise(mt_nlp_engine *e, mt_nlp_local *s);
/* local_serialize.c: where it stands, on tape. Values and slopes are made anew at the designs
 * that are read, and the record is taken only where they are those that it was written with.
 * False: it is not, and s is as it was. */
bool mt_nlp_local_serialize(mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer);
/* Whether it is worth Newton's method before a restoration. */
bool mt_nlp_nearly_feasible(const mt_nlp_point *p);
/* The point of it that counts. */
const mt_nlp_point *mt_nlp_local_stand(const mt_nlp_local *s);

#endif
