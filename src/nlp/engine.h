/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_ENGINE_H
#define NLP_ENGINE_H

#include <stdatomic.h>

#include "linalg/dense.h"
#include "nlp/nlp.h"

/*
 * The inside of the search engine. A point is a design with all values of the callback there;
 * an engine owns the problem, the budget and the scratch memory. Every array over variables has
 * all n of them; `held` marks those that must not move (fixed by their bounds, or frozen
 * temporarily).
 */
typedef struct mt_nlp_point {
    double *t;  /* [n] */
    double f;   /* objective, 1/2 |r|^2 where there are residuals */
    double *df; /* [n] its gradient */
    double *r;  /* values and Jacobians as in mt_nlp_values */
    double *dr;
    double *eq;
    double *deq;
    double *in;
    double *din;
    double *next;
    double *dnext;
    double violation; /* max |violation| / tolerance; <= 1 is feasible */
    double squares;   /* sum of squares of eq and of the negative part of in */
    double kkt;       /* last known relative KKT residual, infinity where unknown */
    int n_loose;      /* directions that nothing holds at a minimum (polish.c); 0: none known */
    bool isolated;    /* at a compromise: no neighbour has squares as small (polish.c) */
} mt_nlp_point;

typedef struct mt_nlp_engine {
    const mt_nlp *nlp;
    mt_nlp_options opt;
    int n;
    int n_free;     /* variables with lower < upper */
    double *origin; /* [n] clamped */
    bool *held;     /* [n] */
    /* [n_eq], [n_in] violations at a compromise (eq, and the negative part of in), subtracted
     * from the constraints while its objective is minimised; NULL otherwise */
    const double *eq_shift;
    const double *in_shift;
    double eq_tol;   /* largest tolerance of an equality, 0 without */
    double df_scale; /* largest gradient of the objective at a start */
    long evals;
    atomic_int *abort; /* set where one worker must end the search for all; may be NULL */
    bool open_starts;  /* the search chooses the number of starts */
    bool impossible;   /* no feasible point exists: proven */
    bool ended;        /* budget spent, interrupted or fatal: no further evaluation */
    mt_stop stop;
    mt_status fatal;   /* status that mt_nlp_solve returns */
    mt_status refused; /* first status of the callback that means "no value here" */
    mt_err refused_err;
    mt_err *err;
    mt_steps *steps; /* record of the evaluations; may be NULL */
    mt_arena scratch;
} mt_nlp_engine;

/* Objective of a local method: the objective under the constraints, the residuals r, or the
 * squares of the violations (the latter two under the bounds only). */
typedef enum mt_nlp_stage { MT_NLP_OBJECTIVE, MT_NLP_RESIDUALS, MT_NLP_SQUARES } mt_nlp_stage;

mt_status mt_nlp_engine_init(mt_nlp_engine *e, const mt_nlp *nlp, const mt_nlp_options *opt,
                             mt_err *err);
void mt_nlp_engine_free(mt_nlp_engine *e);
/* True where rc is MT_OK. A failure (memory, linear algebra) ends the search, and mt_nlp_solve
 * returns it. */
bool mt_nlp_ok(mt_nlp_engine *e, mt_status rc);
/* mt_nlp_ok of all requests to mem so far: one call before their results are used. */
bool mt_nlp_has_room(mt_nlp_engine *e, mt_arena *mem);
/* A point in mem with all arrays allocated. */
mt_nlp_point *mt_nlp_point_new(const mt_nlp_engine *e, mt_arena *mem);
void mt_nlp_point_copy(const mt_nlp_engine *e, mt_nlp_point *to, const mt_nlp_point *from);
void mt_nlp_point_swap(mt_nlp_point **a, mt_nlp_point **b);
/* Evaluate at t (clamped to the bounds; may be p->t). False: no finite value here, or the
 * search has ended (e->ended); p is then unusable. One call of the callback, no heap. */
bool mt_nlp_evaluate(mt_nlp_engine *e, const double *t, bool with_gradient, mt_nlp_point *p);
/* t clamped to the bounds; a value that differs from a bound or the origin by rounding is set
 * to it. */
double mt_nlp_clamp(const mt_nlp *nlp, int j, double t);
/* True where a ranks before b: feasible before infeasible, then by objective; infeasible ones
 * by squares. */
bool mt_nlp_better(const mt_nlp_point *a, const mt_nlp_point *b);
bool mt_nlp_feasible(const mt_nlp_point *p);
/* Largest |a_j - b_j|. */
double mt_nlp_distance(const mt_nlp_engine *e, const mt_nlp_point *a, const mt_nlp_point *b);
/* g[n]: gradient of the function that `stage` minimises (squares and residuals with the factor
 * 1/2). */
void mt_nlp_gradient(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                     double *g);

#endif
