/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_PROBLEM_H
#define PROBLEM_PROBLEM_H

#include "analysis/tracking.h"
#include "nlp/nlp.h"
#include "problem/reference.h"
#include "study/bands.h"
#include "study/study.h"

/*
 * A study compiled for evaluation: variables as scaled coordinates t, one analysis per
 * configuration that a goal names, goals as a flat list of demands (one per goal and
 * configuration), the objectives. One problem, one worker.
 *
 * Coordinates: t = ln x where the lower bound and the original value are positive. A lower
 * bound of 0 keeps the logarithm down to a floor, a thousandth of the original,
 *     t = ln x                              x >= floor
 *     t = ln(floor) + (x - floor)/floor     x <  floor
 *         (continuous with its slope; dx/dt = max(x, floor))
 * Where the original is 0 or negative, the bounds reach below 0, or the study gives a scale, t
 * = x / scale. The change of a redesign is then
 *     sqrt(sum w_i (t_i - t_i(original))^2).
 *
 * Objectives in order: `stage` is the one that is minimised; the ones before it are held by one
 * inequality each,
 *     (limit_j - f_j) / unit_j >= 0,
 * but a misfit by one equality for each residual, r - r_held = 0: at an exact fit the slope of
 * |r|^2 vanishes and an inequality would hold nothing.
 *
 * Files: problem.c (life, coordinates, the face to the search), problem_demands.c (goals to
 * demands), problem_aims.c (expressions, objectives), problem_eval.c (one evaluation), demand.c
 * (value and gradient of one demand).
 */

/* A configuration that goals speak of. */
typedef struct mt_view {
    int configuration;
    mt_analysis *analysis; /* owned */
    int n_named; /* named modes of this configuration that exist at the original design */
    int *named;  /* [n_named] of the model */
    const double **shape; /* [n_named] weighed there (tracking.h) */
    mt_track *track;      /* [n_named] after mt_view_track */
    mt_analysis *scout;   /* owned; for designs on the way there, made when first needed */
    bool needs_vectors;   /* a goal needs shapes even where no gradient is asked for */
    bool tracked;         /* track belongs to the last solve */
    bool solved;          /* the last solve succeeded */
    /* NULL: as the configuration says; else at this position (family.h) */
    const struct mt_cut *cut;
} mt_view;

typedef struct mt_family mt_family; /* positions of one drive (family.h) */

/* What a demand limits: what is known of it over boxes of designs, and of modes in their order. */
typedef enum mt_quantity {
    MT_QUANTITY_FREQUENCY, /* of a mode */
    MT_QUANTITY_EXPRESSION,
    MT_QUANTITY_OTHER
} mt_quantity;

typedef struct mt_demand {
    const struct mt_goal_ops *ops; /* of its kind (goal.h), likewise the next two */
    mt_quantity quantity;
    mt_goal_measure measure;
    const mt_goal *goal;
    int goal_index;
    int view;                 /* -1: of no configuration, an expression */
    int mode;                 /* 1-based index; 0: by name */
    int named;                /* position in the view's list, where by name */
    mt_node node;             /* limit: node of the expressions' program */
    mt_reference_shape shape; /* shape, mac; frequency: without the shape */
    double equals; /* what is asked for, by the goal or its reference; NaN: limits only */
    double weight; /* the goal's, unless changed to see what it does; NaN: a constraint */
    bool ranged; /* a target that is a range over the tolerances of the variables (robust.h) */
    int row_eq;  /* its row in eq, -1 none */
    int row_in;  /* first row in in, -1 none */
    int n_in;    /* 2 where at_least and at_most are both given */
    int row_res; /* first residual, -1 none */
    int n_res;   /* residuals */
    double floor_hz;  /* of a frequency: below, its logarithm goes on as a tangent */
    double tolerance; /* relative */
} mt_demand;

/*
 * The bands that one configuration keeps clear of: all avoid goals that name it, united. A gap
 * assignment says how many vibration modes lie below each band; with one, the cluster of modes
 * on each side of each band is constrained (in = ln(lower / f), ln(f / upper)), which is smooth
 * where "no mode inside" is not. Without one, no rows.
 */
typedef struct mt_clear {
    int view;
    int goal_index; /* of the first goal */
    mt_bands bands;
    int cluster;
    int first;  /* bands first .. first + bands.n - 1 of an assignment */
    int row_in; /* first row; rows run over bands, below then above, nearest mode first */
    int n_rows;
    double tolerance;
} mt_clear;

/* An objective. */
typedef struct mt_aim {
    mt_objective_type type;
    const struct mt_objective_ops *ops; /* of its kind (objective.h) */
    const mt_objective *objective;      /* NULL: none */
    mt_node node;                       /* expression: in the problem's program */
    int n_mass;                         /* items counted by a mass */
    mt_node *mass;                      /* [n_mass] nodes in the first view's program */
    double limit;                       /* f at most this while it is held */
    double unit;                        /* what a violation of the limit is divided by */
} mt_aim;

typedef struct mt_problem {
    const mt_study *study;          /* must outlive the problem */
    mt_reference_cache *references; /* likewise */
    mt_arena mem;
    int n;            /* variables */
    int *inputs;      /* [n] parameters */
    double *original; /* [n] */
    double *lower_t;
    double *upper_t;
    double *origin_t; /* may lie outside the bounds, where the original design does */
    double *scale;    /* [n] NaN: logarithmic; else x = t * scale */
    double *floor;    /* [n] where the logarithm ends; 0: nowhere */
    int n_views;
    int n_demands;
    mt_view *views;
    mt_demand *demands;
    int n_clears;
    mt_clear *clears;
    int n_bands; /* of all clears: length of a gap assignment */
    int *below;  /* [n_bands] the assignment that is searched; NULL: none */
    int n_families;
    mt_family *families;
    /* [n_bands] the first of the bands that have the same number of modes below them
     * (family.h); but for cuts */
    int *tie;
    /* of a design that is described: the least between the positions of its drives; HUGE_VAL:
     * none */
    double motion_room;
    /* t has one more entry, the least clearance ln(...) that is made greatest */
    bool clearance;
    int n_t; /* n, or n + 1 */
    int n_eq;
    int n_in;   /* of the goals, their corners last; held objectives follow */
    int n_next; /* rows that follow from those of limits (problem_next.c) */
    struct mt_next *next;
    int *next_of; /* [n_next] */
    /* of them at corners of the tolerances, where these are samples (robust.h) */
    int n_corner_rows;
    int n_res;
    double *eq_tol;     /* [n_eq + n_res] */
    double *in_tol;     /* [n_in + n_aims] */
    double weights;     /* sum of the weights of the demands that are residuals */
    mt_program program; /* expressions: limits, objectives, published quantities */
    /* nodes of it that the search needs: those of published quantities follow */
    int n_searched;
    mt_node *published; /* [study->n_published] */
    double *value;      /* [program.count] */
    double *grad;       /* program.count rows of n, after an evaluation with gradient */
    int n_aims;         /* at least one */
    int stage;          /* of aims */
    mt_aim *aims;
    double *x;      /* [n] parameters of the last evaluation */
    double *t;      /* [n] its coordinates */
    double *r;      /* [n_res] residuals there */
    double *dr;     /* n_res x n */
    double *r_held; /* [n_res] what a held misfit keeps them at */
    double *work;   /* [n] */
    double *slope;  /* [n] of a demand */
    double *shape;  /* [max ns] */
    double *dshape; /* max ns x n */
    long evaluations;
    long proof_boxes; /* budget of a proof; 0: as certify.h has it */
    /* local solves of a search where the study does not say; 0: by the number of variables */
    int starts;
    struct mt_robust *robust; /* variables with a tolerance (robust.h); NULL: none */
    const double *hint; /* [n + 1] coordinates of one more design to start from; NULL: none */
    void (*progress)(void *context, const char *text); /* NULL, or called now and then */
    void *progress_context;
} mt_problem;

/*
 * Compile. Solves every view once at the original design; a configuration that is unstable
 * there is no failure, its goals are unmet. Fails: MT_E_INPUT with the goal's address in the
 * text (a mode that is not there, no common sensor; what this version does not search),
 * numerical failures at the original design (no equilibrium, ...), MT_E_MEMORY.
 */
mt_status mt_problem_new(const mt_study *study, mt_reference_cache *references,
                         mt_problem **out, mt_err *err);
/* The same with a gap assignment below[n_bands] (of the problem without one). */
mt_status mt_problem_new_in_gap(const mt_study *study, mt_reference_cache *references,
                                const int *below, mt_problem **out, mt_err *err);
/* The same with cuts[n_cuts] (family.h), behind all other rows of the bands. */
mt_status mt_problem_new_cut(const mt_study *study, mt_reference_cache *references,
                             const int *below, int n_cuts, const struct mt_cut *cuts,
                             mt_problem **out, mt_err *err);
void mt_problem_delete(mt_problem *p);
/* Compile and forget: can the study be asked? Fails as mt_problem_new. */
mt_status mt_problem_try(const mt_study *study, mt_err *err);
/* Parameter values x[n] of coordinates t[n]: a bound, a value of a catalogue, and the original
 * value come back to the last bit. */
void mt_problem_x(const mt_problem *p, const double *t, double *x);
/* The coordinate of value x of variable i. */
double mt_problem_t(const mt_problem *p, int i, double x);
/* Rows of `in` (of `eq`) and of its derivative in the present stage: goals, then held
 * objectives. */
int mt_problem_rows_in(const mt_problem *p);
int mt_problem_rows_eq(const mt_problem *p);
/* dx_i/dt_i at the value x of variable i. */
double mt_problem_stretch_at(const mt_problem *p, int i, double x);
/* dx_i/dt_i at the last evaluation. */
double mt_problem_stretch(const mt_problem *p, int i);
/* The present stage as a search problem (arrays belong to the problem). */
mt_nlp mt_problem_nlp(mt_problem *p);
/* The nlp's callback: context is the problem. Fails: MT_E_INTERRUPTED, and as its parts do. */
mt_status mt_problem_eval(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err);
/* The first half of an evaluation: parameters, expressions. The views follow with
 * mt_view_solve. */
mt_status mt_problem_place(mt_problem *p, const double *t, bool with_gradient, mt_err *err);
mt_status mt_view_solve(mt_problem *p, mt_view *view, bool with_gradient, mt_err *err);
/* Arrays of out for the present stage, in mem. */
mt_status mt_problem_values_init(const mt_problem *p, mt_arena *mem, mt_nlp_values *out,
                                 mt_err *err);

/* An analysis of a configuration at x[n], counted as the study counts (study->counted). *out is
 * the caller's. Fails as mt_analysis_new. */
mt_status mt_problem_analyse(const mt_problem *p, int configuration, const double *x,
                             mt_analysis **out, mt_err *err);
/* The same for the configuration of a view, with the view's count (cheaper). */
mt_status mt_view_analyse(const mt_problem *p, const mt_view *view, const double *x,
                          mt_analysis **out, mt_err *err);
/* View of a configuration, -1. */
int mt_problem_view(const mt_problem *p, int configuration);
/* The same, made where it is not there yet. */
mt_status mt_problem_add_view(mt_problem *p, int configuration, int *out, mt_err *err);
/* *pos: position of a mode (by index, or by place in the view's list of named ones where mode
 * is 0) in the view's modes; -1: there is none, or the configuration is unstable. */
mt_status mt_view_position(mt_problem *p, mt_view *view, int mode, int named, int *pos,
                           mt_err *err);
/* Vibration modes of a view: as many as any design of the study has. */
int mt_view_vibrations(const mt_view *view);
/* Where all named modes are at the last solve, which was at p->x (problem_track.c). */
mt_status mt_view_track(mt_problem *p, mt_view *view, mt_err *err);

/* problem_clear.c */
mt_status mt_clear_init(mt_problem *p, const int *below, int n_cuts, const struct mt_cut *cuts,
                        mt_err *err);
/* Fill the rows of all clears, after their views have been solved. */
mt_status mt_clear_eval(mt_problem *p, const double *t, bool with_gradient, mt_nlp_values *out,
                        mt_err *err);
/* How the modes of an analysis lie: below[bands.n] (may be NULL) modes below the middle of each
 * band; the largest relative way that a mode is inside a band with its margin (0: none is);
 * *worst (may be NULL) its position; NaN where the configuration is unstable. */
double mt_clear_violation(const mt_clear *c, const mt_modes *modes, int *below, int *worst);
/* Which mode and edge does row `row` (0: the first of the bands, behind those of the demands)
 * of a search with an assignment below[n_bands] hold? false: there is no such row. p: the
 * problem without an assignment. */
typedef struct mt_clear_row {
    int clear;
    int band; /* of its list */
    int mode; /* vibration index */
    bool above;
} mt_clear_row;
bool mt_clear_row_at(const mt_problem *p, const int *below, int row, mt_clear_row *out);
int mt_clear_row_count(const mt_problem *p, const int *below);
/* ln of the least ratio that any vibration mode keeps from a band with its margin (what the
 * objective "clearance" makes greatest), after its view has been solved; negative: a mode is
 * inside; NaN: unstable. */
double mt_clear_room(const mt_problem *p, const mt_clear *c);
/* The least of all clears; infinite without bands. */
double mt_clears_room(const mt_problem *p);
/* Least clearance of any vibration mode from any band without its margin, in percent of the
 * edge; *band, *pos (may be NULL) say where. */
double mt_clear_least_percent(const mt_clear *c, const mt_modes *modes, int *band, int *pos);

/* problem_demands.c: views, demands and their rows. */
mt_status mt_problem_init_demands(mt_problem *p, int n_cuts, mt_err *err);
/* Once all rows are counted: tolerances and work space. */
mt_status mt_problem_init_rows(mt_problem *p, mt_err *err);
/*
 * goal_frequency.c: rows in ln f. A spring that starts from 0 has f = 0 and df/dk infinite there, while
 * d(f^2)/dk is finite: below floor_hz, MT_FREQUENCY_FLOOR of what a mode is compared with, ln f
 * goes on as its tangent in f^2,
 *     ln f_0 + (f^2 / f_0^2 - 1) / 2,
 * which has a value and a slope at 0 Hz, the same sign, and the same derivative at f_0. No goal
 * is met down there, whatever its tolerance.
 */
#define MT_FREQUENCY_FLOOR 1e-3
/* A mode at 0 Hz is inside a band that begins there by this much, a factor of 1000 of its upper
 * edge: ln(1 / MT_FREQUENCY_FLOOR). */
#define MT_MOST_INSIDE 7.0
/* ln(f / edge_hz), so continued; of a mode at infinity MT_MOST_INSIDE, without a slope. */
double mt_frequency_ln_ratio(double hz, double edge_hz, double floor_hz);
/* The same of the mode at pos; -1: at infinity. */
double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz);
/* Its slope lambda'/(2 lambda) for all variables, chained to t: out[n]. A repeated mode: the
 * mean of its cluster, which is smooth where the single modes are not. */
mt_status mt_problem_dln_frequency(mt_problem *p, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err);
/* Values (and gradients, unless NULL where out holds none) of one demand after its view has
 * been solved; rows as numbered. *value (may be NULL): the number that is held (infinite of a
 * mode at infinity), or the distance that its residuals amount to. */
mt_status mt_demand_eval(mt_problem *p, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, double *value, mt_err *err);
/* Does it limit the frequency of a mode by its index? Those are sorted: what holds for one holds
 * for all beyond it. */
bool mt_demand_is_frequency(const mt_demand *d);
/* problem_next.c: a limit on a mode holds for all that lie beyond it; where modes cross, those
 * tell the search what comes next. After everything else of the problem. */
mt_status mt_next_init(mt_problem *p, mt_err *err);
/* Fill out->next (and out->dnext), unless NULL, after the views and corners have been
 * solved. */
mt_status mt_next_eval(mt_problem *p, bool with_gradient, mt_nlp_values *out, mt_err *err);
/* problem_aims.c: the program of expressions, and the objectives. After the demands. */
mt_status mt_problem_init_aims(mt_problem *p, mt_err *err);
/* f of objective k at the last evaluation, gradient[n_t] (may be NULL) likewise. */
double mt_aim_value(const mt_problem *p, int k, double *gradient);
/* A value f of objective k, a half square as its root: differences of these are told. */
double mt_aim_root(const mt_problem *p, int k, double f);
/* What results show of it. */
double mt_aim_shown(const mt_problem *p, int k, double f);
/* Hold objective k at f, as well as it can be told from f, from the next stage on; a misfit at
 * the residuals of the last evaluation. */
void mt_aim_hold(mt_problem *p, int k, double f);
/* The rows of the objectives that are held. */
void mt_aim_hold_rows(mt_problem *p, bool with_gradient, mt_nlp_values *out);

#endif
