/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_SUBPROBLEM_H
#define PROBLEM_SUBPROBLEM_H

#include "analysis/analysis.h"
#include "nlp/merit.h"
#include "problem/rows.h"
#include "study/study.h"

/*
 * A part of a problem to be solved: bounds, mode placement, the objective to minimise and those
 * held. A subproblem is small, made in the caller's memory from another one, and not changed
 * while it is evaluated; unchanged parts are shared with that other one, which must outlive it.
 *
 * Objectives in order: `stage` is minimised; each earlier one is held by an inequality,
 *     (limit_j - f_j) / unit_j >= 0,
 * but a misfit by one equality for each residual, r - r_held = 0: at an exact fit the slope of
 * |r|^2 vanishes, and an inequality would have no effect.

 */
struct mt_problem;
struct mt_requirement;

/* A held objective. */
typedef struct mt_held {
    double limit; /* upper limit of f */
    double unit;  /* divisor of a violation */
} mt_held;

typedef struct mt_subproblem {
    const struct mt_problem *p;
    double *lower; /* [n] parameter values */
    double *upper;
    double *lower_t; /* [n + 1] coordinates */
    double *upper_t;
    double *origin_t; /* [n + 1] outside the bounds where the original design is */
    /* [n + 1] weights of the coordinates in the total change; 0: not counted */
    const double *change_weight;
    const struct mt_objective_stage *stages; /* [n_stages] */
    mt_held *held;        /* [n_stages] those before `stage`; NULL at stage 0 */
    double *r_held;       /* [n_res] residuals at which a misfit is held */
    const double *weight; /* [n_requirements] NaN: a constraint */
    const int *below;     /* [n_bands] the mode placement; NULL: none */
    /* [n_views] configurations: the problem's, then those of cuts */
    const struct mt_configuration_problem *views;
    /* [n_avoidances] the problem's, then those of cuts */
    const struct mt_avoidance *avoidances;
    const int *tie;    /* [n_bands] */
    mt_row_table rows; /* of the present stage */
    /* variables with a tolerance (tolerance.h); NULL: none */
    struct mt_problem_tolerance_box *tolerance_box;
    /* [n_requirements] the problem's, then those at cuts (drive_positions.h) */
    const struct mt_requirement *requirements;
    const double *hint; /* [n + 1] a further start; NULL: none */
    mt_search search;   /* the study's, with a part of its budget */
    /* approximate multiplications of each proof (prove/certify.h); 0: no proofs */
    double proof_work;
    /* local solves of a search where the study sets no number; 0: by the number of variables */
    int starts;
    /* sampled corners of the tolerances that a search of the same question with other bounds
     * needed, and where to put those that this one needs; NULL: none, nowhere */
    const struct mt_tolerance_cuts *cuts_known;
    struct mt_tolerance_cuts *cuts_found;
    bool best_alone; /* only the best design is wanted */
    bool as_found;   /* any of equally good designs will do: the nearest is not searched */
    int n_t;         /* n, or n + 1 */
    int n_stages;
    int stage; /* index in stages */
    int n_views;
    int n_avoidances;
    int n_bands;
    int n_requirements;
    /* t has a further entry, the least clearance ln(...), which is maximised */
    bool clearance;
    /* t has a further entry, MT_FORCED_RESPONSE_SHIFT + the largest ln(value / limit) of the
     * goals in the objective "vibration"; 0: not given, computed from the goals */
    bool forced_response;
} mt_subproblem;

#define MT_FORCED_RESPONSE_SHIFT 50.0

/* out: a copy of `from` with its own bounds. Fails: MT_E_MEMORY. */
mt_status mt_subproblem_copy(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                             mt_err *err);
/* Coordinate of value x of variable i. */
double mt_problem_t(const struct mt_problem *p, int i, double x);
/* Sets the bounds of variable i, as parameter values. Call mt_subproblem_lay_out afterwards. */
void mt_subproblem_bound(mt_subproblem *c, int i, double lower, double upper);
/* `from` with memory for held objectives (mt_objectives_hold), for later stages. Fails:
 * MT_E_MEMORY. */
mt_status mt_subproblem_for_stages(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                                   mt_err *err);
/* Parameter values x[n] of coordinates t[n]; bounds, catalogue values and original values are
 * reproduced exactly. */
void mt_subproblem_x(const mt_subproblem *c, const double *t, double *x);
/* Half of the squared total change of the design t[n], 1/2 sum w_i (t_i - t_i(original))^2;
 * breaks ties of designs. */
double mt_subproblem_change(const mt_subproblem *c, const double *t);
/* Modal solutions per evaluation: one for each configuration and each tolerance corner in
 * it. */
long mt_subproblem_solutions(const mt_subproblem *c);
/*
 * Budget in modal solutions, counted in evaluations of search.solutions_each of them.
 * mt_subproblem_worth: evaluations that n modal solutions count as; mt_subproblem_counted:
 * those that `evals` evaluations of this subproblem count as; mt_subproblem_afford: evaluations
 * of this subproblem, at least 1, for `evals` counted ones. Without such a budget: 0, evals and
 * evals.
 */
long mt_subproblem_worth(const mt_subproblem *c, long n);
long mt_subproblem_counted(const mt_subproblem *c, long evals);
long mt_subproblem_afford(const mt_subproblem *c, long evals);
/* Number of residuals of the present stage. */
int mt_subproblem_rows_res(const mt_subproblem *c);
/* Violations of the rows of the present stage. */
mt_missed mt_subproblem_missed(const mt_subproblem *c, const mt_nlp_values *v);
/* Allocates the arrays of out for the present stage in mem. */
mt_status mt_subproblem_values_init(const mt_subproblem *c, mt_arena *mem, mt_nlp_values *out,
                                    mt_err *err);

/* A row of this kind about nothing: indices -1, numbers NaN. */
mt_row mt_row_init(mt_row_kind kind, mt_row_sense sense);
/* Appends a row. Fails: MT_E_MEMORY. */
mt_status mt_rows_append(mt_row_block *block, const mt_row *row, mt_arena *mem, mt_err *err);
/* Makes the arrays that the search problem reads, with room for `more` further rows. Fails:
 * MT_E_MEMORY. */
mt_status mt_rows_finish(mt_row_block *block, int more, mt_arena *mem, mt_err *err);

#endif
