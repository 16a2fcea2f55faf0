/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_SUBPROBLEM_H
#define PROBLEM_SUBPROBLEM_H

#include "analysis/analysis.h"
#include "nlp/nlp.h"
#include "study/study.h"

/*
 * What of a problem is asked: within which bounds, with which gap assignment, for which
 * objective with which others held. A case is small, made in the caller's memory from another
 * one, and not changed while anyone evaluates it; what it does not change it shares with the
 * case that it was made from, which has to outlive it.
 *
 * Objectives in order: `stage` is the one that is minimised; the ones before it are held by one
 * inequality each,
 *     (limit_j - f_j) / unit_j >= 0,
 * but a misfit by one equality for each residual, r - r_held = 0: at an exact fit the slope of
 * |r|^2 vanishes and an inequality would hold nothing.
 *
 * Rows: those of the requirements as the problem numbers them, in `in` followed by those of the
 * bands (goal_avoid.c), of corners of the tolerances (tolerance.h), of objectives that are
 * held.
 */
struct mt_problem;
struct mt_workspace;
struct mt_cut;
struct mt_requirement;

/* An objective that is held. */
typedef struct mt_held {
    double limit; /* f at most this */
    double unit;  /* what a violation is divided by */
} mt_held;

typedef struct mt_subproblem {
    const struct mt_problem *p;
    double *lower; /* [n] parameter values */
    double *upper;
    double *lower_t; /* [n + 1] coordinates; room for one more */
    double *upper_t;
    double *origin_t; /* [n + 1] may lie outside the bounds, where the original design does */
    const double *change_weight; /* [n + 1] of the coordinates in a change; 0: has none */
    const struct mt_objective_stage *aims; /* [n_aims] */
    mt_held *held;        /* [n_aims] those before the stage; NULL at stage 0 */
    double *r_held;       /* [n_res] what a held misfit keeps the residuals at */
    const double *weight; /* [n_requirements] NaN: a constraint */
    const int *below;     /* [n_bands] the gap assignment; NULL: none */
    /* [n_views] the problem's, then those of cuts */
    const struct mt_configuration_problem *views;
    const struct mt_avoidance *avoidances; /* [n_avoidances] likewise */
    const int *tie;                        /* [n_bands] */
    double *eq_tol;                        /* [n_eq + n_res] */
    double *in_tol;                        /* [n_in + n_aims] */
    /* variables with a tolerance (tolerance.h); NULL: none */
    struct mt_problem_tolerance_box *tolerance_box;
    /* [n_at_position] limits at cuts (at_position.h), whose rows are the last before held
     * objectives */
    const struct mt_requirement *at_position;
    int n_at_position;
    /* [n_next] rows that follow from those of limits (mode_order.h), and from which */
    const struct mt_mode_order *next;
    const int *next_of;
    const double *hint; /* [n + 1] coordinates of one more design to start from; NULL: none */
    mt_search search;   /* the study's; a part of its budget */
    double proof_work;  /* multiplications of each proof (prove/certify.h), about; 0: none */
    /* local solves of a search where the study does not say; 0: by the number of variables */
    int starts;
    bool best_alone; /* nobody asks for other designs than the best one that is found */
    bool as_found;   /* of equal designs any one does: the nearest of them is not sought */
    int n_t;         /* n, or n + 1 */
    int n_aims;
    int stage; /* of aims */
    int n_views;
    int n_avoidances;
    int n_bands;
    int first_band_row; /* in `in` */
    int n_in;           /* held objectives follow */
    /* the last of them, at corners of the tolerances where these are samples */
    int n_corner_rows;
    int n_next;
    /* t has one more entry, the least clearance ln(...) that is made greatest */
    bool clearance;
    /* t has one more entry, MT_FORCED_RESPONSE_SHIFT + the largest ln(value / limit) of the
     * goals that the objective "vibration" is made of; 0: not given, it is looked up */
    bool forced_response;
    int first_soft_row; /* of these, in `in` */
} mt_subproblem;

#define MT_FORCED_RESPONSE_SHIFT 50.0

/* out: as `from`, with bounds of its own. Fails: MT_E_MEMORY. */
mt_status mt_subproblem_copy(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                             mt_err *err);
/* Bounds of variable i, as parameter values. mt_subproblem_lay_out follows. */
void mt_subproblem_bound(mt_subproblem *c, int i, double lower, double upper);
/*
 * Rows of c within its bounds with a gap assignment below[n_bands of the problem] (NULL: none),
 * and cuts[n_cuts] of it (drive_positions.h), which outlive it: of bands, where there is an
 * assignment, behind all others, and of limits. w: set to this case afterwards; NULL while the
 * problem is compiled. Fails: MT_E_INPUT where a goal cannot be judged over tolerances,
 * MT_E_MEMORY, numerical failures.
 */
mt_status mt_subproblem_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                                const struct mt_cut *cuts, struct mt_workspace *w,
                                mt_arena *mem, mt_err *err);
/* The case of `from` in a gap: mt_subproblem_copy and mt_subproblem_lay_out. */
mt_status mt_subproblem_in_placement(const mt_subproblem *from, const int *below, int n_cuts,
                                     const struct mt_cut *cuts, struct mt_workspace *w,
                                     mt_arena *mem, mt_subproblem *out, mt_err *err);
/* The same case for later stages: with room for objectives that are held
 * (mt_objective_stage_hold). Fails: MT_E_MEMORY. */
mt_status mt_subproblem_for_stages(const mt_subproblem *from, mt_arena *mem, mt_subproblem *out,
                                   mt_err *err);
/* Parameter values x[n] of coordinates t[n]: a bound, a value of a catalogue, and the original
 * value come back to the last bit. */
void mt_subproblem_x(const mt_subproblem *c, const double *t, double *x);
/* The change of the design t[n], 1/2 sum w_i (t_i - t_i(original))^2: what decides among
 * designs that are as good. */
double mt_subproblem_change(const mt_subproblem *c, const double *t);
/* Modal solutions that one evaluation takes: each configuration, and each corner of the
 * tolerances that is held there. */
long mt_subproblem_solutions(const mt_subproblem *c);
/*
 * Where the budget is one of modal solutions it is counted in evaluations that take
 * search.solutions_each of them. What n modal solutions are counted as; what evaluations of
 * this case are, which may take more; and how many of this case the counted ones `evals` come
 * to, at least 1. Where the budget is not one: 0, evals and evals.
 */
long mt_subproblem_worth(const mt_subproblem *c, long n);
long mt_subproblem_counted(const mt_subproblem *c, long evals);
long mt_subproblem_afford(const mt_subproblem *c, long evals);
/* Rows of `in` (of `eq`) and of its derivative in the present stage: goals, then held
 * objectives. */
int mt_subproblem_rows_in(const mt_subproblem *c);
int mt_subproblem_rows_eq(const mt_subproblem *c);
/* Residuals of the present stage. */
int mt_subproblem_rows_res(const mt_subproblem *c);
/* Arrays of out for the present stage, in mem. */
mt_status mt_subproblem_values_init(const mt_subproblem *c, mt_arena *mem, mt_nlp_values *out,
                                    mt_err *err);

#endif
