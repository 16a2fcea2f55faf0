/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_NLP_PRIV_H
#define NLP_NLP_PRIV_H

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
    bool ended;        /* budget spent, interrupted or fatal: no evaluation happens any more */
    mt_stop stop;
    mt_status fatal;   /* status that must be returned */
    mt_status refused; /* first "no value here" and its text */
    mt_err refused_err;
    mt_err *err;
    mt_arena scratch;
} mt_nlp_engine;

/* What a local method minimises: the objective under the constraints, the residuals r, or the
 * squares of the violations (both of the latter under the bounds only). */
typedef enum mt_nlp_aim { MT_NLP_OBJECTIVE, MT_NLP_RESIDUALS, MT_NLP_SQUARES } mt_nlp_aim;

/* One local search, and where it ended. */
typedef struct mt_nlp_local {
    mt_nlp_point *p;    /* the start, then the best it met */
    mt_nlp_point *last; /* where SLSQP came to rest */
    mt_nlp_aim aim;     /* what Newton has to do: nothing for a root (squares) */
    int n_rows;
    int *rows;     /* [n_rows] the equalities that are independent */
    bool begun;    /* the start has values */
    bool restored; /* SLSQP had no feasible end, and the least squares of the violations is p */
    bool curve;    /* solutions form a curve here: no isolated root */
    bool polished; /* nothing is left to be done */
    double *from;  /* [n] where the approach ended */
    double kkt;    /* relative KKT residual there */
    int start;     /* which start found it first */
    int hits;      /* how many starts ended here */
    bool merged;   /* another root was merged into it */
} mt_nlp_local;

typedef struct mt_nlp_ends {
    mt_nlp_local *at; /* [count], and room for those of mt_nlp_ends_grow */
    int count;
    int starts;                   /* made so far */
    const mt_nlp_point *directed; /* where the undetermined directions were sought */
} mt_nlp_ends;

/* Constraints that hold a point in place, and their multipliers: on the free variables
 * aim's gradient = sum lambda_i grad c_i, c_i an equality or an active inequality. */
typedef struct mt_nlp_active {
    int n_free;
    int *free; /* [n_free] variables neither held nor at an active bound */
    int *side; /* [n] -1 lower, +1 upper bound active, 0 not (held variables: 0) */
    int k;
    /* [k] i < n_eq: equality i, else inequality i - n_eq, the `next` ones behind the others */
    int *row;
    double *scale;  /* [k] norm of the row on the free variables (1 for a zero row) */
    double *lambda; /* [k] */
    double *z;      /* [n] aim's gradient minus sum lambda_i grad c_i, all variables */
    double *c;      /* [k] values */
    mt_qr qr;       /* of the n_free x k matrix of scaled gradients */
    double kkt;     /* |z on the free variables|, relative */
} mt_nlp_active;

/* nlp_eval.c */
mt_status mt_nlp_engine_init(mt_nlp_engine *e, const mt_nlp *nlp, const mt_nlp_options *opt,
                             mt_err *err);
void mt_nlp_engine_free(mt_nlp_engine *e);
/* End the search with a failure that mt_nlp_solve returns (memory, linear algebra). */
void mt_nlp_end(mt_nlp_engine *e, mt_status rc);
/* m x n doubles in mem, zeroed; NULL where memory is out (the engine is ended then). */
double *mt_nlp_f64(mt_nlp_engine *e, mt_arena *mem, size_t m, size_t n);
/* A point in mem with room for everything; NULL where memory is out (the engine is ended
 * then). */
mt_nlp_point *mt_nlp_point_new(mt_nlp_engine *e, mt_arena *mem);
void mt_nlp_point_copy(const mt_nlp_engine *e, mt_nlp_point *to, const mt_nlp_point *from);
void mt_nlp_point_swap(mt_nlp_point **a, mt_nlp_point **b);
/* Evaluate at t (clamped to the bounds; may be p->t). False: no finite value here, or the
 * search has ended (e->ended); p is then unusable. One call of the callback, no heap. */
bool mt_nlp_evaluate(mt_nlp_engine *e, const double *t, bool with_gradient, mt_nlp_point *p);
/* t within the bounds; what is on a bound or at the origin to rounding is put on it. */
double mt_nlp_clamp(const mt_nlp_engine *e, int j, double t);
/* Feasible before infeasible; then by objective; infeasible ones by squares. */
bool mt_nlp_better(const mt_nlp_point *a, const mt_nlp_point *b);
bool mt_nlp_feasible(const mt_nlp_point *p);
/* Largest |a_j - b_j|. */
double mt_nlp_distance(const mt_nlp_engine *e, const mt_nlp_point *a, const mt_nlp_point *b);
/* Gradient of what `aim` minimises (squares and residuals with the factor 1/2), g[n]. */
void mt_nlp_gradient(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_aim aim, double *g);

/* nlp_local.c: room for a search in mem; false: out of memory. */
bool mt_nlp_local_init(mt_nlp_engine *e, mt_arena *mem, mt_nlp_local *s);
/* From p, which has values, to about where it leads; then all the way, off saddles, never for
 * the worse. */
void mt_nlp_local_approach(mt_nlp_engine *e, mt_nlp_local *s);
void mt_nlp_local_finish(mt_nlp_engine *e, mt_nlp_local *s);
/* Both for the objective under the constraints, the equalities being rows[n_rows]. */
void mt_nlp_minimise(mt_nlp_engine *e, mt_nlp_local *s);
/* Is it worth Newton's method before a restoration? */
bool mt_nlp_nearly_feasible(const mt_nlp_point *p);
/* The point of it that counts. */
const mt_nlp_point *mt_nlp_local_stand(const mt_nlp_local *s);

/* nlp_ends.c: room for n ends more; false: out of memory. */
bool mt_nlp_ends_grow(mt_nlp_engine *e, mt_nlp_ends *all, int n);
/* Isolated roots, *once: those that one start only ended at; 0 where the problem has none, or a
 * curve of solutions. */
int mt_nlp_roots(mt_nlp_engine *e, const mt_nlp_ends *all, int *once);
/* Ends to polish next, chosen[all->count]: of those that are near each other one; ends that lie
 * at one that is polished are dropped. Returns how many. */
int mt_nlp_ends_choose(mt_nlp_engine *e, mt_nlp_ends *all, const mt_nlp_result *directions,
                       mt_nlp_local **chosen);
/* Did Newton come to rest there? */
bool mt_nlp_came_to_rest(const mt_nlp_local *s);
/* Ends nearer than this are one; does the problem ask for isolated roots? */
double mt_nlp_same_distance(const mt_nlp_engine *e);
bool mt_nlp_seeks_roots(const mt_nlp_engine *e);

/* nlp_judge.c: the ends as a ranked result in mem. */
void mt_nlp_judge(mt_nlp_engine *e, mt_nlp_ends *all, mt_arena *mem, mt_nlp_result *out);

/* nlp_starts.c: start k (0: the origin) of `starts`; t column-major n x starts in mem, NULL
 * where memory is out. */
double *mt_nlp_starts(const mt_nlp_engine *e, int starts, mt_arena *mem);

/* nlp_lsq.c: bounded Levenberg-Marquardt from *p on residuals or violations; *p is where it
 * ends. */
void mt_nlp_least_squares(mt_nlp_engine *e, mt_nlp_aim aim, mt_nlp_point *p);

/* nlp_slsqp.c: one local search from p; the equalities are only those in rows[n_rows]. last:
 * where it ended; p: the best point it met by mt_nlp_better. */
void mt_nlp_slsqp(mt_nlp_engine *e, int n_rows, const int *rows, mt_nlp_point *p,
                  mt_nlp_point *last);

/* nlp_kkt.c */
bool mt_nlp_active_set(mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_aim aim, mt_arena *mem,
                       mt_nlp_active *a);
/* Derivative of constraint row i (as in mt_nlp_active.row) with respect to variable j. */
double mt_nlp_row_slope(const mt_nlp_engine *e, const mt_nlp_point *p, int i, int j);
/* Its value, and its tolerance. */
double mt_nlp_row_value(const mt_nlp_engine *e, const mt_nlp_point *p, int i);
double mt_nlp_row_tol(const mt_nlp_engine *e, int i);
/* Singularity of the active constraints at p. free_direction: there are further feasible points
 * along a weak direction (a curve of solutions); rows/n_rows: independent equalities. */
typedef struct mt_nlp_weakness {
    bool singular;
    bool curve;
    int n_rows;
    int *rows; /* [n_eq] ascending */
} mt_nlp_weakness;
bool mt_nlp_weakness_at(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                        mt_nlp_weakness *w);
/* Fill the record of a solution from a point (copies; no evaluation). */
bool mt_nlp_report(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                   mt_nlp_solution *out);

/* nlp_polish.c: Newton on the KKT conditions from p. p is replaced where the result is better.
 * saddle (may be NULL): [n] a direction of negative curvature, all zero where there is none. */
void mt_nlp_polish(mt_nlp_engine *e, mt_nlp_aim aim, mt_nlp_point *p, double *saddle);

/* nlp_undetermined.c */
bool mt_nlp_undetermined(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                         mt_nlp_result *out);
/* Forget those along which p, the solution that they are told of, has no room. */
void mt_nlp_drop_roomless(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out);
/* Put p back to the origin along the undetermined directions, where that costs nothing. */
void mt_nlp_pull_back(mt_nlp_engine *e, const mt_nlp_result *undetermined, mt_nlp_point *p);

#endif
