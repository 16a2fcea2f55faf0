/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_NLP_H
#define NLP_NLP_H

#include <stdbool.h>

#include "base/arena.h"
#include "nlp/steps.h"

/*
 * A smooth search problem in scaled variables t (ln of positive parameters, linear otherwise;
 * the caller maps):
 *
 *   minimise f(t)   (or 1/2 |r(t)|^2 where n_res > 0)
 *   subject to  eq_i(t) = 0 within eq_tol_i,  in_i(t) >= -in_tol_i,  lower <= t <= upper.
 *
 * This file and its .c know no mechanism: tests drive them with closed-form functions.
 */
typedef struct mt_nlp_values {
    /* objective; where n_res > 0: ignored, 1/2 |r|^2 is used. Smooth: the square of a change,
     * not its root */
    double f;
    double *df; /* [n] */
    /* [n_res] dimensionless: a change below 1e-6 counts as none where directions are judged */
    double *r;
    double *dr; /* n_res x n column-major */
    /* [n_eq] relative to the requirement (ln of a ratio), so that a compromise weighs them
     * fairly */
    double *eq;
    double *deq;   /* n_eq x n column-major */
    double *in;    /* [n_in] >= 0 feasible */
    double *din;   /* n_in x n column-major */
    double *next;  /* [n_next], see mt_nlp; NULL: they are not asked for */
    double *dnext; /* n_next x n column-major */
} mt_nlp_values;

/*
 * Evaluate at t, which is within the bounds. with_gradient false: only values are needed.
 * Called once per point. A status other than MT_OK, or a value that is not finite, means "no
 * value here" (the search steps back), except MT_E_INTERRUPTED, which ends it with what was
 * found (MT_STOP_USER), and MT_E_MEMORY and MT_E_INTERNAL, which mt_nlp_solve returns.
 */
typedef mt_status (*mt_nlp_eval)(void *context, const double *t, bool with_gradient,
                                 mt_nlp_values *out, mt_err *err);

typedef struct mt_nlp {
    int n;
    const double *lower; /* [n] finite; lower == upper: fixed, eliminated */
    const double *upper;
    const double *hint;   /* [n] another start beside origin and sequence; NULL: none */
    const double *origin; /* [n] the original design, clamped by the engine */
    /* [n] of the coordinates in the change from the origin; NULL: 1 each */
    const double *change_weight;
    int n_res;
    int n_eq;
    int n_in;
    const double *eq_tol; /* [n_eq] > 0 */
    const double *in_tol; /* [n_in] > 0 */
    /* rows that follow from those of `in`: next >= 0 wherever in[next_of] >= 0. They add
     * nothing to a violation, but where rows change places (modes that cross) they tell what
     * comes next: local solvers and KKT conditions know them; their multipliers count for
     * in[next_of] */
    int n_next;
    const int *next_of; /* [n_next] */
    mt_nlp_eval eval;
    void *context;
    int n_workers; /* starts run on so many threads; 0 or 1: the caller's own */
    /* [n_workers] a context for each, contexts[0] == context; NULL with one worker */
    void *const *contexts;
    /* the place of its local searches (base/workers.h), or NULL */
    struct mt_task_path *task_path;
} mt_nlp;

typedef struct mt_nlp_options {
    unsigned long seed; /* turns the sequence of starts; 0 and 1: as it is */
    /* local solves from the origin and Sobol points (reverse Halton beyond 40 variables); 0: 8
     * + 4 n, at most 64, and where roots are sought up to twelve times as many, until every
     * root was met twice */
    int starts;
    int skip; /* so many of them, the first ones, have been made before: fewer than starts */
    /* they end when those so far leave little hope of another end
     * (mt_nlp_solution_pool_settled) */
    bool settles;
    /* they end when the first ones, so many, all lead to one feasible design; 0: they do not */
    int agree;
    long max_evals;    /* over all starts, never exceeded; 0: 2000 * the first starts */
    int max_solutions; /* how many distinct ones to keep; 0: 16 */
    /* f is the change: it does not count when undetermined directions are sought (without
     * residuals) */
    bool least_change;
    /* ends that are infeasible are of no use: those far from feasible are given up, instead of
     * being brought to the least sum of squares */
    bool no_compromise;
    /* asked once, where none of the first starts ended at a feasible point: *none, where it is
     * proven that there is none. Then what is left to find is the compromise: squares are
     * minimised from the next ones, and others are made only where these do not end at one
     * place. NULL: nobody knows */
    mt_status (*prove_none)(void *context, bool *none, mt_err *err);
    void *prove_context;
} mt_nlp_options;
mt_nlp_options mt_nlp_options_default(void);

typedef enum mt_stop { MT_STOP_DONE, MT_STOP_MAX_EVALS, MT_STOP_USER } mt_stop;

typedef struct mt_nlp_solution {
    double *t;
    double f;         /* recomputed at t */
    double violation; /* max over constraints of |violation| / tolerance; <= 1 is feasible */
    /* sum of squares of eq and of the negative part of in: what a compromise minimises */
    double squares;
    bool feasible;
    /* it stands for a continuum of solutions that are as good (set by mt_search_join_continua
     * only) */
    bool continuum;
    /* Jacobian of the active constraints (or of r) rank deficient at t: a double root */
    bool singular;
    /* f and the constraints leave more directions free at t, to first and second order, than
     * the undetermined ones of one variable: others next to it may be as good (without
     * residuals) */
    bool flat;
    int n_loose; /* those directions, the undetermined ones among them; 0: not known */
    /* ||grad of the Lagrangian projected on the free variables|| relative; NaN for isolated
     * roots (no freedom left) */
    double kkt;
    int start;          /* which start found it first */
    int hits;           /* how many starts ended at it */
    int *bound;         /* [n] -1 at lower, +1 at upper, 0 free */
    double *mult_eq;    /* [n_eq] multipliers, NaN where undetermined */
    double *mult_in;    /* [n_in] */
    double *mult_bound; /* [n] */
} mt_nlp_solution;

typedef struct mt_nlp_result {
    /* only feasible ones, by f; else compromises, by squares, equal ones by f; what is equal in
     * both by the change from the origin, 1/2 sum w_j (t_j - origin_j)^2, then by the first
     * coordinate that differs, less first (equal: to MT_EQUAL_FOUND, merit.h) */
    int n_solutions;
    mt_nlp_solution *solutions;
    /* none is feasible: these minimise the sum of squares of the violations relative to the
     * requirements */
    bool compromise;
    bool impossible; /* nothing is feasible: options.prove_none said so */
    long boxes;      /* of the proof of that (set by mt_search_designs only) */
    long evals;
    int starts;
    int n_found; /* distinct ones, those beyond max_solutions among them */
    int n_once;  /* of them, met by one start only */
    /* where the equalities leave isolated roots: how many more are to be expected at least, by
     * what was met once and twice (Chao 1984); 0 when all were met twice; else NaN */
    double missing;
    mt_stop stop;
    mt_steps steps; /* on the way here */
    /* at the best solution: orthonormal directions of t-space along which crossing the whole
     * bounds changes every residual and constraint by less than its tolerance; of a space of
     * them a basis that follows from the space alone (unidentifiable_directions.c) */
    int n_unidentifiable;
    double *unidentifiable; /* n x n_unidentifiable */
    /* [n_unidentifiable] greatest change / tolerance found when crossing */
    double *unidentifiable_effect;
} mt_nlp_result;

/*
 * All distinct local solutions from several starts, ranked. Method: n_eq >= number of free
 * variables: roots by bounded least squares; else SLSQP (exact gradients) with an incumbent of
 * our own, then Newton on the KKT system to full accuracy; residuals under bounds alone: least
 * squares, then Newton. Feasibility and KKT are recomputed here, NLopt's return code decides
 * nothing. Solutions nearer than sqrt(tolerance) (within 0.001 to 0.01 in t) are one. No
 * feasible point: the compromise of least squares and, among equal ones, least f. Undetermined
 * directions are left at the origin. Results in mem. Deterministic for equal seed. Cost: some
 * 20 to 100 evaluations per start; O(n^3) of linear algebra each step. Fails: MT_E_USAGE
 * (sizes, bounds, tolerances), MT_E_MEMORY and MT_E_INTERNAL, and the callback's first status
 * where it had no value at any start. A spent budget and an interruption are outcomes:
 * out->stop, with the best so far (n_solutions may be 0).
 */
mt_status mt_nlp_solve(const mt_nlp *nlp, const mt_nlp_options *opt, mt_arena *mem,
                       mt_nlp_result *out, mt_err *err);

#endif
