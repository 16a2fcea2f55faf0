/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_WORKSPACE_H
#define PROBLEM_WORKSPACE_H

#include "problem/problem.h"

/*
 * What one worker needs to evaluate designs of a problem: analyses, values of the last
 * evaluation, work space. It is set to one case at a time, and may be set to any case of its
 * problem; what it evaluates does not depend on what it evaluated before.
 */
typedef struct mt_view_work {
    const mt_view *of;
    mt_analysis *analysis; /* owned */
    mt_track *track;       /* [n_named] after mt_view_track */
    mt_analysis *scout;    /* owned; for designs on the way there, made when first needed */
    bool needs_vectors;    /* shapes are needed even where no gradient is asked for */
    bool tracked;          /* track belongs to the last solve */
    bool solved;           /* the last solve succeeded */
    int family;            /* of a cut: where the analysis is */
    double position;
    int n_corners;         /* analyses that there are */
    mt_analysis **corners; /* owned; for corners of the tolerances (robust.h) */
} mt_view_work;

typedef struct mt_workspace {
    const mt_problem *p; /* must outlive the workspace */
    const mt_case *c;    /* what is evaluated; likewise */
    mt_arena mem;
    int n_views; /* at least those of the case */
    mt_view_work *views;
    /* [n_families] owned; with the position as last input; made when first needed (motion.h) */
    mt_analysis **driven;
    double *value;  /* [program.count] */
    double *grad;   /* program.count rows of n, after an evaluation with gradient */
    double *x;      /* [n] parameters of the last evaluation */
    double *t;      /* [n + 1] its coordinates */
    double *r;      /* [n_res] residuals there */
    double *dr;     /* n_res x n */
    double *work;   /* [n + 1] */
    double *slope;  /* [n] of a demand */
    double *shape;  /* [max ns] */
    double *dshape; /* max ns x n */
    struct mt_robust_work *robust; /* where variables have tolerances (robust.h); else NULL */
    long evaluations;
    /* of a design that is described: the least between the positions of its drives; HUGE_VAL:
     * none */
    double motion_room;
    void (*progress)(void *context, const char *text); /* NULL, or called now and then */
    void *progress_context;
} mt_workspace;

/* Set to p->whole, its views solved at the original design. Fails as mt_analysis_new,
 * MT_E_MEMORY. */
mt_status mt_workspace_new(const mt_problem *p, mt_workspace **out, mt_err *err);
/* Accepts NULL. */
void mt_workspace_delete(mt_workspace *w);
/* Set to a case, for which analyses are made where there are none yet (of cuts, of corners).
 * Fails likewise; then it is set to the case that it was set to. */
mt_status mt_workspace_use(mt_workspace *w, const mt_case *c, mt_err *err);
/* Back to a case that it was set to before, for which everything is there. */
void mt_workspace_back(mt_workspace *w, const mt_case *c);
/* dx_i/dt_i at the last evaluation. */
double mt_workspace_stretch(const mt_workspace *w, int i);
/* The present stage of the case as a search problem (arrays belong to the case). */
mt_nlp mt_workspace_nlp(mt_workspace *w);
/* The nlp's callback: context is the workspace. Fails: MT_E_INTERRUPTED, and as its parts
 * do. */
mt_status mt_workspace_eval(void *context, const double *t, bool with_gradient,
                            mt_nlp_values *out, mt_err *err);
/* The first half of an evaluation: parameters, expressions. The views follow with
 * mt_view_solve. */
mt_status mt_workspace_place(mt_workspace *w, const double *t, bool with_gradient, mt_err *err);
mt_status mt_view_solve(mt_workspace *w, mt_view_work *view, bool with_gradient, mt_err *err);
/* *pos: position of a mode (by index, or by place in the view's list of named ones where mode
 * is 0) in the view's modes; -1: there is none, or the configuration is unstable. */
mt_status mt_view_position(mt_workspace *w, mt_view_work *view, int mode, int named, int *pos,
                           mt_err *err);
/* Where all named modes are at the last solve, which was at w->x (problem_track.c). */
mt_status mt_view_track(mt_workspace *w, mt_view_work *view, mt_err *err);

/* problem_clear.c: fill the rows of all bands, after their views have been solved. */
mt_status mt_clear_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err);
/* ln of the least ratio that a mode anywhere between low and high keeps from a band with its
 * margin; negative: it can be inside. */
double mt_band_room(const mt_band *band, double low_hz, double high_hz);
/* The least of that for any vibration mode of an analysis and any band; NaN where the
 * configuration is unstable. below[bands.n] (may be NULL): modes below the middle of each. */
double mt_clear_look(const mt_clear *c, const mt_modes *modes, int *below);
/* Which mode and edge does row `row` (0: the first of the bands, behind those of the demands)
 * of a search with an assignment below[n_bands] hold? false: there is no such row. */
typedef struct mt_clear_row {
    int clear;
    int band; /* of its list */
    int mode; /* vibration index */
    bool above;
} mt_clear_row;
bool mt_clear_row_at(const mt_case *c, const int *below, int row, mt_clear_row *out);
int mt_clear_row_count(const mt_case *c, const int *below);
/* mt_clear_look after the view has been solved, with tolerances over them: what the objective
 * "clearance" makes greatest. */
double mt_clear_room(const mt_workspace *w, const mt_clear *c);
/* The least of all clears; infinite without bands. */
double mt_clears_room(const mt_workspace *w);

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
mt_status mt_problem_dln_frequency(mt_workspace *w, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err);
/* Values (and gradients, unless NULL where out holds none) of one demand after its view has
 * been solved; rows as numbered. *value (may be NULL): the number that is held (infinite of a
 * mode at infinity), or the distance that its residuals amount to. (demand.c) */
mt_status mt_demand_eval(mt_workspace *w, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, double *value, mt_err *err);
/* The weight that a demand has in the case; NaN: it is a constraint. */
double mt_demand_weight(const mt_workspace *w, const mt_demand *d);
/* problem_next.c: a limit on a mode holds for all that lie beyond it; where modes cross, those
 * tell the search what comes next. After all other rows of the case. */
mt_status mt_next_init(mt_case *c, mt_arena *mem, mt_err *err);
/* Fill out->next (and out->dnext), unless NULL, after the views and corners have been
 * solved. */
mt_status mt_next_eval(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err);
/* problem_aims.c: f of objective k at the last evaluation, gradient[n_t] (may be NULL)
 * likewise. */
double mt_aim_value(const mt_workspace *w, int k, double *gradient);
/* A value f of an objective, a half square as its root: differences of these are told. */
double mt_aim_root(const mt_aim *a, double f);
/* What results show of it. */
double mt_aim_shown(const mt_aim *a, double f);
/* Hold objective k of c (mt_case_for_stages) at f, as well as it can be told from f, from the
 * next stage on; a misfit at the residuals of w's last evaluation. */
void mt_aim_hold(mt_case *c, const mt_workspace *w, int k, double f);
/* The rows of the objectives that are held. */
void mt_aim_hold_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out);

#endif
