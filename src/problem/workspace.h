/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_WORKSPACE_H
#define PROBLEM_WORKSPACE_H

#include "problem/problem.h"

/*
 * The data with which one worker evaluates designs of a problem: analyses, values of the last
 * evaluation, work arrays. It is set to one subproblem at a time, any of its problem; results
 * do not depend on earlier evaluations.
 */
typedef struct mt_configuration_work {
    const mt_configuration_problem *of;
    mt_analysis *analysis; /* owned */
    mt_track *track;       /* [n_named] after mt_configuration_track */
    /* owned; for designs between the original and w->x, made on first use */
    mt_analysis *scout;
    mt_analysis_options ask; /* the configuration's, or more (describe needs all) */
    bool all;                /* all modes are requested */
    bool tracked;            /* track belongs to the last solve */
    bool solved;             /* the last solve succeeded */
    int n_forced_response;   /* number of port pairs */
    /* [n_forced_response] forced vibrations (forced_response.h); NULL: none yet */
    struct mt_forced_response *forced_response;
    int n_corners;         /* number of existing analyses */
    mt_analysis **corners; /* owned; for tolerance corners (tolerance.h) */
} mt_configuration_work;

typedef struct mt_workspace {
    const mt_problem *p;    /* must outlive the workspace */
    const mt_subproblem *c; /* the subproblem; must outlive its use here */
    mt_arena mem;
    int n_views; /* at least those of the subproblem */
    mt_configuration_work *views;
    /* [n_families] owned; analyses of each drive's `moving`, made on first use
     * (search/drive_path.h) */
    mt_analysis **driven;
    double *value;  /* [program.count] */
    double *grad;   /* program.count rows of n, after an evaluation with gradient */
    double *x;      /* [n] parameters of the last evaluation */
    double *t;      /* [n + 1] its coordinates */
    double *r;      /* [n_res] residuals at the last evaluation */
    double *dr;     /* n_res x n */
    double *work;   /* [n + 1] */
    double *slope;  /* [n] slope of a requirement */
    double *shape;  /* [max ns] */
    double *dshape; /* max ns x n */
    /* where variables have tolerances (tolerance.h); else NULL */
    struct mt_tolerance_work *tolerance_box;
    double beyond; /* of a goal whose value is infinite: excess over a finite value (ln) */
    double worst;  /* largest ln(value / limit) of goals in "vibration"; -infinite: none */
    /* accuracy of the modes (mt_modal_options); MT_MODAL_ACCURACY by default */
    double accuracy;
    long evaluations;
    void (*progress)(void *context, const char *text); /* NULL, or called from time to time */
    void *progress_context;
    /* path of its searches (base/workers.h); NULL: none */
    struct mt_task_path *task_path;
} mt_workspace;

/* A workspace set to p->whole, with its configurations solved at the original design. Fails: as
 * mt_analysis_new, MT_E_MEMORY. */
mt_status mt_workspace_new(const mt_problem *p, mt_workspace **out, mt_err *err);
/* Accepts NULL. */
void mt_workspace_delete(mt_workspace *w);
/* Sets w to a subproblem and makes missing analyses (of cuts, of corners). Fails: as
 * mt_workspace_new; w then stays set to the previous subproblem. */
mt_status mt_workspace_use(mt_workspace *w, const mt_subproblem *c, mt_err *err);
/* Sets w back to an earlier subproblem, for which all analyses exist; deletes analyses of cuts
 * that it does not have, so that the cuts may be deleted. */
void mt_workspace_back(mt_workspace *w, const mt_subproblem *c);
/* dx_i/dt_i at the last evaluation. */
static inline double mt_workspace_dx_dt(const mt_workspace *w, int i)
{
    return mt_problem_dx_dt_at(w->p, i, w->x[i]);
}

#endif
