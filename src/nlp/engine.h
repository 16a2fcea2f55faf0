/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_ENGINE_H
#define NLP_ENGINE_H

#include <stdatomic.h>

#include "linalg/dense.h"
#include "nlp/nlp.h"

/*
 * The inside of the search engine. A point is a design with everything the callback said there;
 * an engine owns the problem, the budget and the scratch memory. Every array over variables has
 * all n of them; `held` marks those that must not move (fixed by their bounds, or frozen for a
 * while).
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
    bool isolated;    /* no design next to it is as near to the requirements (likewise) */
} mt_nlp_point;

typedef struct mt_nlp_engine {
    const mt_nlp *nlp;
    mt_nlp_options opt;
    int n;
    int n_free;     /* variables with lower < upper */
    double *origin; /* [n] clamped */
    bool *held;     /* [n] */
    /* what the constraints fall short of at a compromise ([n_eq], [n_in]): subtracted from
     * their values while its change is minimised; NULL otherwise */
    const double *eq_shift;
    const double *in_shift;
    double eq_tol;   /* largest tolerance of an equality, 0 without */
    double df_scale; /* largest gradient of the objective at a start */
    long evals;
    atomic_int *abort; /* set when one worker must end the search for all; may be NULL */
    bool open_starts;  /* the caller leaves their number to the search */
    bool impossible;   /* it is proven that nothing is feasible */
    bool ended;        /* budget spent, interrupted or fatal: no evaluation happens any more */
    mt_stop stop;
    mt_status fatal;   /* status that must be returned */
    mt_status refused; /* first "no value here" and its text */
    mt_err refused_err;
    mt_err *err;
    mt_steps *steps; /* what is evaluated is noted here; may be NULL */
    mt_arena scratch;
} mt_nlp_engine;

/* What a local method minimises: the objective under the constraints, the residuals r, or the
 * squares of the violations (both of the latter under the bounds only). */
typedef enum mt_nlp_stage { MT_NLP_OBJECTIVE, MT_NLP_RESIDUALS, MT_NLP_SQUARES } mt_nlp_stage;

mt_status mt_nlp_engine_init(mt_nlp_engine *e, const mt_nlp *nlp, const mt_nlp_options *opt,
                             mt_err *err);
void mt_nlp_engine_free(mt_nlp_engine *e);
/* True where all is well. A failure (memory, linear algebra) ends the search, and mt_nlp_solve
 * returns it. */
bool mt_nlp_ok(mt_nlp_engine *e, mt_status rc);
/* The same of all requests to mem: asked once, before what they were for is used. */
bool mt_nlp_has_room(mt_nlp_engine *e, mt_arena *mem);
/* A point in mem with room for everything. */
mt_nlp_point *mt_nlp_point_new(const mt_nlp_engine *e, mt_arena *mem);
void mt_nlp_point_copy(const mt_nlp_engine *e, mt_nlp_point *to, const mt_nlp_point *from);
void mt_nlp_point_swap(mt_nlp_point **a, mt_nlp_point **b);
/* Evaluate at t (clamped to the bounds; may be p->t). False: no finite value here, or the
 * search has ended (e->ended); p is then unusable. One call of the callback, no heap. */
bool mt_nlp_evaluate(mt_nlp_engine *e, const double *t, bool with_gradient, mt_nlp_point *p);
/* t within the bounds; what is on a bound or at the origin to rounding is put on it. */
double mt_nlp_clamp(const mt_nlp *nlp, int j, double t);
/* Feasible before infeasible; then by objective; infeasible ones by squares. */
bool mt_nlp_better(const mt_nlp_point *a, const mt_nlp_point *b);
bool mt_nlp_feasible(const mt_nlp_point *p);
/* Largest |a_j - b_j|. */
double mt_nlp_distance(const mt_nlp_engine *e, const mt_nlp_point *a, const mt_nlp_point *b);
/* Gradient of what `aim` minimises (squares and residuals with the factor 1/2), g[n]. */
void mt_nlp_gradient(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_stage stage,
                     double *g);

#endif
