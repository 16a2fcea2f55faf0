/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named modes of a view: told directly from the original shapes, else along the straight line
 * of designs in t from the original one (tracking.h). */
#include <math.h>

#include "problem/workspace.h"

/* A walk has at most so many of its shortest steps, however far the design is. */
static const double MOST_STEPS = 128.0;

typedef struct way {
    const mt_workspace *w;
    mt_configuration_work *view;
    double *t;  /* [n_t] work */
    double *x;  /* [n] */
    double *to; /* [n] the present design */
} way;

static mt_status solve_at(void *context, double s, mt_analysis **out, mt_err *err)
{
    const way *const w = context;
    const mt_problem *const p = w->w->p;
    const double *const origin_t = p->whole.origin_t;
    const mt_analysis_options opt = {.vectors = true, .accuracy = MT_MODAL_ACCURACY};
    for (int i = 0; i < p->n; i++) {
        w->t[i] = origin_t[i] + (s * (w->to[i] - origin_t[i]));
    }
    mt_subproblem_x(w->w->c, w->t, w->x);
    if (w->view->scout == NULL) {
        MT_TRY(mt_configuration_analyse(w->view->of, p->original, &w->view->scout, err));
    }
    *out = w->view->scout;
    return mt_analysis_solve(w->view->scout, w->x, &opt, err);
}

static mt_status track_modes(const mt_workspace *ws, mt_configuration_work *view, mt_arena *mem,
                             mt_err *err)
{
    const mt_problem *const p = ws->p;
    way w = {.w = ws,
             .view = view,
             .t = mt_arena_f64(mem, (size_t)p->n + 1, 1),
             .x = mt_arena_f64(mem, (size_t)p->n, 1),
             .to = mt_arena_f64(mem, (size_t)p->n, 1)};
    double far = 0.0;
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n; i++) {
        w.to[i] = mt_problem_t(p, i, ws->x[i]);
        far = fmax(far, fabs(w.to[i] - p->whole.origin_t[i]));
    }
    const mt_track_way path = {
        .solve = solve_at,
        .context = &w,
        .resolution = far > 0.0 ? fmax(MT_TRACK_RESOLUTION / far, 1.0 / MOST_STEPS) : 1.0};
    return mt_track_follow(&path, view->of->n_named, view->of->shape, view->analysis, mem,
                           view->track, err);
}

mt_status mt_configuration_track(mt_workspace *w, mt_configuration_work *view, mt_err *err)
{
    if (view->tracked) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&w->mem);
    const mt_status rc = track_modes(w, view, &w->mem, err);
    mt_arena_rewind(&w->mem, mark);
    view->tracked = rc == MT_OK;
    return rc;
}
