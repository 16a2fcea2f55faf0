/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Workspaces: made, set to a subproblem, deleted. */

#include "problem/workspace.h"

#include <stdlib.h>
#include <string.h>

#include "problem/configuration.h"
#include "problem/forced_response.h"
#include "problem/tolerance.h"

static void close_view(mt_configuration_work *view)
{
    for (int i = 0; i < view->n_corners; i++) {
        mt_analysis_delete(view->corners[i]);
    }
    mt_forced_response_close(view);
    mt_analysis_delete(view->scout);
    mt_analysis_delete(view->analysis);
    *view = (mt_configuration_work){.of = NULL};
}

void mt_workspace_delete(mt_workspace *w)
{
    if (w != NULL) {
        for (int i = 0; i < w->n_views; i++) {
            close_view(&w->views[i]);
        }
        for (int i = 0; w->driven != NULL && i < w->p->n_families; i++) {
            mt_analysis_delete(w->driven[i]);
        }
        mt_arena_free(&w->mem);
        free(w);
    }
}

static mt_status allocate_workspace_arrays(mt_workspace *w, mt_err *err)
{
    const mt_problem *const p = w->p;
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    const size_t n_res = (size_t)p->whole.rows.res.n;
    size_t ns = 1; /* rows of slopes: of a shape, or of anything else */
    for (int i = 0; i < p->n_requirements; i++) {
        const size_t own = (size_t)p->requirements[i].shape.ns;
        ns = own > ns ? own : ns;
    }
    w->driven = mt_arena_alloc(&w->mem, (size_t)p->n_families, sizeof(mt_analysis *));
    w->value = mt_arena_f64(&w->mem, count, 1);
    w->grad = mt_arena_f64(&w->mem, count, n);
    w->x = mt_arena_f64(&w->mem, n, 1);
    w->t = mt_arena_f64(&w->mem, n + 1, 1);
    w->r = mt_arena_f64(&w->mem, n_res, 1);
    w->dr = mt_arena_f64(&w->mem, n_res, n);
    w->work = mt_arena_f64(&w->mem, n + 1, 1);
    w->slope = mt_arena_f64(&w->mem, n, 1);
    w->shape = mt_arena_f64(&w->mem, ns, 1);
    w->dshape = mt_arena_f64(&w->mem, ns, n);
    const bool bad = w->driven == NULL || w->value == NULL || w->grad == NULL || w->x == NULL ||
                     w->t == NULL || w->r == NULL || w->dr == NULL || w->work == NULL ||
                     w->slope == NULL || w->shape == NULL || w->dshape == NULL;
    return bad ? mt_fail_memory(err) : mt_tolerance_work_init(w, err);
}

mt_status mt_workspace_new(const mt_problem *p, mt_workspace **out, mt_err *err)
{
    *out = NULL;
    mt_workspace *const w = calloc(1, sizeof *w);
    if (w == NULL) {
        return mt_fail_memory(err);
    }
    w->p = p;
    w->accuracy = MT_MODAL_ACCURACY;
    mt_status rc = mt_arena_init(&w->mem, 0, err);
    rc = rc == MT_OK ? allocate_workspace_arrays(w, err) : rc;
    rc = rc == MT_OK ? mt_workspace_use(w, &p->whole, err) : rc;
    if (rc != MT_OK) {
        mt_workspace_delete(w);
        return rc;
    }
    *out = w;
    return MT_OK;
}

/* Grows the list to n configurations, keeping existing ones. */
static mt_status make_room(mt_workspace *w, int n, mt_err *err)
{
    if (n <= w->n_views) {
        return MT_OK;
    }
    mt_configuration_work *const views = mt_arena_alloc(&w->mem, (size_t)n, sizeof *views);
    MT_TRY(mt_arena_check(&w->mem, err));
    if (w->n_views > 0) {
        memcpy(views, w->views, (size_t)w->n_views * sizeof *views);
    }
    w->views = views;
    w->n_views = n;
    return MT_OK;
}

/* Configurations with the same geometry share it. */
static mt_status share_view(mt_workspace *w, const mt_configuration_work *view, mt_err *err)
{
    bool shared = false;
    for (int i = 0; i < w->n_views && !shared; i++) {
        const mt_analysis *const other = w->views[i].analysis;
        if (other != NULL && other != view->analysis) {
            MT_TRY(mt_linear_share(view->analysis->lin, other->lin, &shared, err));
        }
    }
    return MT_OK;
}

/* Makes the configuration's analysis where missing. */
static mt_status open_view(mt_workspace *w, mt_configuration_work *view,
                           const mt_configuration_problem *of, mt_err *err)
{
    view->of = of;
    if (view->analysis != NULL) {
        return MT_OK;
    }
    view->track = mt_arena_alloc(&w->mem, (size_t)of->n_named, sizeof *view->track);
    MT_TRY(mt_arena_check(&w->mem, err));
    MT_TRY(mt_configuration_analyse(of, w->p->original, &view->analysis, err));
    view->ask = of->ask;
    view->solved = true;
    return share_view(w, view, err);
}

static mt_status open_corners(mt_workspace *w, mt_configuration_work *view, int n, mt_err *err)
{
    if (n <= view->n_corners) {
        return MT_OK;
    }
    mt_analysis **const corners = mt_arena_alloc(&w->mem, (size_t)n, sizeof(mt_analysis *));
    MT_TRY(mt_arena_check(&w->mem, err));
    for (int i = 0; i < view->n_corners; i++) {
        corners[i] = view->corners[i];
    }
    view->corners = corners;
    for (; view->n_corners < n; view->n_corners++) {
        MT_TRY(
            mt_configuration_analyse(view->of, w->p->original, &corners[view->n_corners], err));
    }
    return MT_OK;
}

mt_status mt_workspace_use(mt_workspace *w, const mt_subproblem *c, mt_err *err)
{
    MT_TRY(make_room(w, c->n_views, err));
    for (int i = 0; i < c->n_views; i++) {
        MT_TRY(open_view(w, &w->views[i], &c->views[i], err));
        MT_TRY(open_corners(w, &w->views[i],
                            c->tolerance_box != NULL ? c->tolerance_box->views[i].n : 0, err));
    }
    w->c = c;
    return MT_OK;
}

void mt_workspace_back(mt_workspace *w, const mt_subproblem *c)
{
    for (int i = 0; i < c->n_views; i++) {
        w->views[i].of = &c->views[i];
    }
    for (int i = c->n_views; i < w->n_views; i++) {
        close_view(&w->views[i]);
    }
    w->c = c;
}
