/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_WORKSPACE_H
#define PROBLEM_WORKSPACE_H

#include "problem/problem.h"

/*
 * What one worker needs to evaluate designs of a problem: analyses, values of the last
 * evaluation, work space. It is set to one case at a time, and may be set to any case of its
 * problem; what it evaluates does not depend on what it evaluated before.
 */
typedef struct mt_configuration_work {
    const mt_configuration_problem *of;
    mt_analysis *analysis;   /* owned */
    mt_track *track;         /* [n_named] after mt_configuration_track */
    mt_analysis *scout;      /* owned; for designs on the way there, made when first needed */
    mt_analysis_options ask; /* as the view's, or more (describe asks for all) */
    bool all;                /* it asks for all modes (mt_configuration_query_all) */
    bool tracked;            /* track belongs to the last solve */
    bool solved;             /* the last solve succeeded */
    int n_forced_response;   /* pairs of ports */
    /* [n_forced_response] its forced vibrations (forced_response.h); NULL: none yet */
    struct mt_forced_response *forced_response;
    int n_corners;         /* analyses that there are */
    mt_analysis **corners; /* owned; for corners of the tolerances (tolerance.h) */
} mt_configuration_work;

typedef struct mt_workspace {
    const mt_problem *p;    /* must outlive the workspace */
    const mt_subproblem *c; /* what is evaluated; likewise */
    mt_arena mem;
    int n_views; /* at least those of the case */
    mt_configuration_work *views;
    /* [n_families] owned; of its `moving`, made when first needed (motion.h) */
    mt_analysis **driven;
    double *value;  /* [program.count] */
    double *grad;   /* program.count rows of n, after an evaluation with gradient */
    double *x;      /* [n] parameters of the last evaluation */
    double *t;      /* [n + 1] its coordinates */
    double *r;      /* [n_res] residuals there */
    double *dr;     /* n_res x n */
    double *work;   /* [n + 1] */
    double *slope;  /* [n] of a requirement */
    double *shape;  /* [max ns] */
    double *dshape; /* max ns x n */
    /* where variables have tolerances (tolerance.h); else NULL */
    struct mt_tolerance_work *tolerance_box;
    double beyond; /* of a goal whose number is infinite: how far that is from finite (ln) */
    double worst; /* largest ln(value / limit) of requirements with row_soft; -infinite: none */
    double accuracy; /* of the modes (mt_modal_options); MT_MODAL_ACCURACY unless set */
    long evaluations;
    void (*progress)(void *context, const char *text); /* NULL, or called now and then */
    void *progress_context;
    /* the place of its searches (base/workers.h); NULL: nowhere */
    struct mt_task_path *task_path;
} mt_workspace;

/* Set to p->whole, its views solved at the original design. Fails as mt_analysis_new,
 * MT_E_MEMORY. */
mt_status mt_workspace_new(const mt_problem *p, mt_workspace **out, mt_err *err);
/* Accepts NULL. */
void mt_workspace_delete(mt_workspace *w);
/* Set to a case, for which analyses are made where there are none yet (of cuts, of corners).
 * Fails likewise; then it is set to the case that it was set to. */
mt_status mt_workspace_use(mt_workspace *w, const mt_subproblem *c, mt_err *err);
/* Back to a case that it was set to before, for which everything is there; analyses of the cuts
 * that it has not go, so that the cuts may go too. */
void mt_workspace_back(mt_workspace *w, const mt_subproblem *c);
/* dx_i/dt_i at the last evaluation. */
double mt_workspace_dx_dt(const mt_workspace *w, int i);
/* A design that was judged over tolerances and positions of a drive, where they are asked for,
 * meets all goals with the value f of the first objective: word of it to who watches. */
void mt_workspace_judged(const mt_workspace *w, double f);
/* The present stage of the case as a search problem (arrays belong to the case), for
 * mt_workspace_solve. */
mt_nlp mt_workspace_nlp(mt_workspace *w);
/* The nlp's callback: context is the workspace. Fails: MT_E_INTERRUPTED, and as its parts
 * do. */
mt_status mt_workspace_eval(void *context, const double *t, bool with_gradient,
                            mt_nlp_values *out, mt_err *err);
/* The same for who counts his evaluations himself, or has mt_workspace_solve do it. */
mt_status mt_workspace_eval_uncounted(void *context, const double *t, bool with_gradient,
                                      mt_nlp_values *out, mt_err *err);
/* n designs were evaluated with w in its case, with all modal solutions that this takes. */
void mt_workspace_note_designs(const mt_workspace *w, long n);
/* mt_nlp_solve of an nlp whose callback does not count; its evaluations are
 * (base/work_counters.h). */
mt_status mt_workspace_solve(const mt_workspace *w, const mt_nlp *nlp,
                             const mt_nlp_options *opt, mt_arena *mem, mt_nlp_result *out,
                             mt_err *err);
/* The first half of an evaluation: parameters, expressions. The views follow with
 * mt_configuration_solve. */
mt_status mt_workspace_place(mt_workspace *w, const double *t, bool with_gradient, mt_err *err);
mt_status mt_configuration_solve(mt_workspace *w, mt_configuration_work *view,
                                 bool with_gradient, mt_err *err);
/* What an evaluation asks of the view's modes at the present case. */
mt_analysis_options mt_configuration_queries(const mt_workspace *w,
                                             const mt_configuration_work *view,
                                             bool with_gradient);
/* From now on it asks for all modes and, where it asks for shapes, for all of them. */
void mt_configuration_query_all(mt_configuration_work *view);
/* *pos: position of a mode (by index, or by place in the view's list of named ones where mode
 * is 0) in the view's modes; -1: there is none, or the configuration is unstable. */
mt_status mt_configuration_position(mt_workspace *w, mt_configuration_work *view, int mode,
                                    int named, int *pos, mt_err *err);
/* Where all named modes are at the last solve, which was at w->x (workspace_track.c). */
mt_status mt_configuration_track(mt_workspace *w, mt_configuration_work *view, mt_err *err);

#endif
