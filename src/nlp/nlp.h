/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_NLP_H
#define NLP_NLP_H

#include <stdbool.h>

#include "base/arena.h"
#include "nlp/merit.h"

/*
 * A smooth search problem in scaled variables t (ln of positive parameters, linear otherwise;
 * the caller maps):
 *
 *     minimise f(t)   (or 1/2 |r(t)|^2 where n_res > 0)
 *     subject to  eq_i(t) = 0 within eq_tol_i,  in_i(t) >= -in_tol_i,  lower <= t <= upper.
 *
 * This room knows no mechanism: tests drive it with closed-form functions.
 */
typedef struct mt_nlp_values {
    /* objective; ignored where n_res > 0. Must be smooth: the square of a change, not its
     * root */
    double f;
    double *df; /* [n] */
    /* [n_res] dimensionless: a change below 1e-6 counts as 0 in finding unidentifiable
     * directions */
    double *r;
    double *dr; /* n_res x n column-major */
    /* [n_eq] relative to the requirement (ln of a ratio), so that a compromise weighs rows
     * equally */
    double *eq;
    double *deq;   /* n_eq x n column-major */
    double *in;    /* [n_in] >= 0 feasible */
    double *din;   /* n_in x n column-major */
    double *next;  /* [n_next], see mt_nlp; NULL: not wanted */
    double *dnext; /* n_next x n column-major */
} mt_nlp_values;

/*
 * Evaluates at t, which is within the bounds. with_gradient false: values only. Called once per
 * point. A status other than MT_OK, or a value that is not finite, means "no value here" (the
 * search steps back), except MT_E_INTERRUPTED, which ends the search with what was found
 * (MT_STOP_USER), and MT_E_MEMORY and MT_E_INTERNAL, which mt_nlp_solve returns.
 */
typedef mt_status (*mt_nlp_eval)(void *context, const double *t, bool with_gradient,
                                 mt_nlp_values *out, mt_err *err);

typedef struct mt_nlp {
    int n;
    const double *lower; /* [n] finite; lower == upper: fixed, eliminated */
    const double *upper;
    const double *hint;   /* [n] a further start; NULL: none */
    const double *origin; /* [n] the original design, clamped by the engine */
    /* [n] weights of the coordinates in the total change; NULL: 1 each */
    const double *change_weight;
    int n_res;
    int n_eq;
    int n_in;
    const double *eq_tol; /* [n_eq] > 0 */
    const double *in_tol; /* [n_in] > 0 */
    /* rows implied by `in`: next >= 0 wherever in[next_of] >= 0. They add nothing to a
     * violation; where rows swap (modes that cross) they are the next ones, which local solvers
     * and KKT conditions include; their multipliers are added to those of in[next_of] */
    int n_next;
    const int *next_of; /* [n_next] */
    mt_nlp_eval eval;
    void *context;
    int n_workers; /* threads for the starts; 0 or 1: the caller's own */
    /* [n_workers] one context per thread, contexts[0] == context; NULL with one thread */
    void *const *contexts;
    /* path of its local searches in the checkpoint (base/workers.h), or NULL */
    struct mt_task_path *task_path;
} mt_nlp;

typedef struct mt_nlp_options {
    unsigned long seed; /* shifts the sequence of starts; 0 and 1: no shift */
    /* number of local solves, from the origin and Sobol points (reverse Halton beyond 40
     * variables); 0: 8 + 4 n, at most 64, and where roots are sought up to twelve times as
     * many, until every root was met twice */
    int starts;
    int skip; /* number of first starts already made by the caller; less than starts */
    /* starts end when no further solution is expected (is_settled in nlp.c) */
    bool settles;
    /* starts end when the first `agree` of them all reach one feasible design; 0: never */
    int agree;
    bool any_best;     /* ... or, at several designs, one value of f to five digits */
    long max_evals;    /* over all starts, never exceeded; 0: 2000 * the first starts */
    int max_solutions; /* number of distinct solutions kept; 0: 16 */
    /* f is half of the squared total change: unidentifiable directions are sought without it
     * (where n_res is 0) */
    bool least_change;
    /* infeasible ends are not wanted: those far from feasible are abandoned instead of being
     * brought to the least sum of squares */
    bool no_compromise;
    /* called at most once, where none of the first starts ended feasible; *none: no feasible
     * point exists, proven. Then the search looks for the compromise only: it minimises squares
     * from the next starts, and makes more only where these end at different points. NULL: no
     * such proof */
    mt_status (*prove_none)(void *context, bool *none, mt_err *err);
    bool none; /* that is known already: prove_none is not called */
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
    /* one of a continuum of equally good solutions (set by mt_search_join_continua only) */
    bool continuum;
    /* the Jacobian of the active constraints (or of r) is rank deficient at t: a double root */
    bool singular;
    /* n_loose exceeds the unidentifiable directions of one variable: neighbours may be as good
     * (where n_res is 0) */
    bool flat;
    /* directions that f and the constraints leave free at t, to first and second order,
     * unidentifiable ones included; 0: not known */
    int n_loose;
    /* relative norm of the Lagrangian's gradient projected on the free variables; NaN for
     * isolated roots (no freedom left) */
    double kkt;
    int start;          /* the start that found it first */
    int hits;           /* number of starts that ended at it */
    int *bound;         /* [n] -1 at lower, +1 at upper, 0 free */
    double *mult_eq;    /* [n_eq] multipliers, NaN where undetermined */
    double *mult_in;    /* [n_in] */
    double *mult_bound; /* [n] */
} mt_nlp_solution;

typedef struct mt_nlp_result {
    /* feasible ones only, by f; or else compromises, by squares, equal ones by f. Ties in both
     * are ordered by the total change, sqrt(sum w_j (t_j - origin_j)^2), then by the first
     * coordinate that differs, smaller first (equal: to MT_EQUAL_FOUND, merit.h) */
    int n_solutions;
    mt_nlp_solution *solutions;
    /* none is feasible: the solutions minimise the sum of squares of the violations relative to
     * the requirements */
    bool compromise;
    bool impossible; /* no feasible point exists, by options.prove_none */
    long boxes;      /* of that proof (set by mt_search_designs only) */
    long evals;
    int starts;
    int n_found; /* distinct solutions, including those beyond max_solutions */
    int n_once;  /* of these, met by one start only */
    /* where the equalities leave isolated roots: lower bound of the expected number of further
     * ones, from those met once and twice (Chao 1984); 0 where all were met twice; NaN
     * elsewhere */
    double missing;
    mt_stop stop;
    mt_steps steps; /* improvements in order */
    /* at the best solution: orthonormal directions in t along which crossing the whole bounds
     * changes every residual and constraint by less than its tolerance; the basis depends on
     * their space alone (solution_pool.c) */
    int n_unidentifiable;
    double *unidentifiable; /* n x n_unidentifiable */
    /* [n_unidentifiable] greatest change / tolerance found when crossing */
    double *unidentifiable_effect;
} mt_nlp_result;

/*
 * All distinct local solutions from several starts, ranked. Method: n_eq >= number of free
 * variables: roots by bounded least squares; otherwise SLSQP (exact gradients) with our own
 * record of the best point, then Newton on the KKT system to full accuracy; residuals under
 * bounds alone: least squares, then Newton. Feasibility and KKT residuals are recomputed;
 * NLopt's return code is not used for them. Solutions nearer than sqrt(tolerance) (within 0.001
 * to 0.01 in t) are one. Without a feasible point: the compromise of least squares and, among
 * equal ones, least f. Unidentifiable directions stay at the origin. Results in mem.
 * Deterministic for equal seed. Cost: some 20 to 100 evaluations per start; O(n^3) of linear
 * algebra each step. Fails: MT_E_USAGE (sizes, bounds, tolerances), MT_E_MEMORY and
 * MT_E_INTERNAL, and the callback's first status where it had no value at any start. A spent
 * budget and an interruption are outcomes: out->stop, with the best so far (n_solutions may be
 * 0).
 */
mt_status mt_nlp_solve(const mt_nlp *nlp, const mt_nlp_options *opt, mt_arena *mem,
                       mt_nlp_result *out, mt_err *err);

/*
 * Starting points of `starts` local searches: t, column-major n x starts, in mem. Start 0 is
 * the origin clamped to the bounds, the next the hint where given; the others fill the bounds
 * evenly for any number of starts. seed 0 and 1: the sequence without a shift. NULL: out of
 * memory.
 */
double *mt_nlp_starts(const mt_nlp *nlp, unsigned long seed, int starts, mt_arena *mem);

/* Versions of the search libraries, for `run` of a result. */
/* Writes the version, such as "2.7.1". */
void mt_nlopt_version(char text[16]);
/* A static text. */
const char *mt_gsl_version(void);

#endif
