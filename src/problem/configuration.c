/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configurations of a problem: their analyses, modes by index and by name. */

#include "problem/configuration.h"

#include <math.h>

#include "analysis/count.h"
#include "base/run.h"
#include "problem/problem.h"
#include "problem/workspace.h"

mt_system_def mt_problem_system(const mt_problem *p, int configuration, const double *x)
{
    return (mt_system_def){.model = p->study->model,
                           .run = p->run,
                           .configuration = configuration,
                           .n_inputs = p->n,
                           .inputs = p->inputs,
                           .at = x};
}

void mt_problem_note_modal(const mt_problem *p, long n)
{
    mt_work_counters_note(p->run->work, MT_WORK_MODAL, n);
    mt_progress_solved(p->run->progress, n);
}

int mt_problem_configuration(const mt_problem *p, int configuration)
{
    for (int i = 0; i < p->n_views; i++) {
        if (p->views[i].configuration == configuration) {
            return i;
        }
    }
    return -1;
}

/* Solve again where the count has changed since. */
static mt_status solve_counted(mt_analysis *a, int counted, const double *x, mt_err *err)
{
    const mt_analysis_options opt = mt_analysis_options_default();
    return a->n_rigid == counted
               ? MT_OK
               : mt_err_in(err, mt_analysis_solve(a, x, &opt, err), "configuration \"%s\"",
                           mt_analysis_configuration(a));
}

mt_status mt_problem_analyse(const mt_problem *p, int configuration, const double *x,
                             mt_analysis **out, mt_err *err)
{
    mt_analysis *a = NULL;
    *out = NULL;
    const mt_system_def def = mt_problem_system(p, configuration, x);
    MT_TRY(mt_analysis_new_of(&def, 0, &a, err));
    mt_status rc = mt_analysis_count(a, &p->study->counted, NULL, 0.0, err);
    rc = rc == MT_OK ? solve_counted(a, a->n_null, x, err) : rc;
    if (rc != MT_OK) {
        mt_analysis_delete(a);
        return rc;
    }
    *out = a;
    return MT_OK;
}

/* Sets the configuration's mode count; *out is a, which is deleted on failure. */
static mt_status count_as(const mt_configuration_problem *view, mt_analysis *a, const double *x,
                          mt_analysis **out, mt_err *err)
{
    a->n_rigid = view->n_rigid;
    a->n_most = view->n_most;
    const mt_status rc = solve_counted(a, a->n_null, x, err);
    if (rc != MT_OK) {
        mt_analysis_delete(a);
        return rc;
    }
    *out = a;
    return MT_OK;
}

mt_status mt_configuration_analyse(const mt_configuration_problem *view, const double *x,
                                   mt_analysis **out, mt_err *err)
{
    mt_analysis *a = NULL;
    *out = NULL;
    MT_TRY(mt_analysis_new_like(view->original, x, &a, err));
    return count_as(view, a, x, out, err);
}

mt_status mt_configuration_drive(const mt_problem *p, const mt_configuration_problem *view,
                                 const mt_system_drive *drive, const double *at,
                                 mt_analysis **out, mt_err *err)
{
    mt_analysis *a = NULL;
    *out = NULL;
    mt_system_def def = mt_problem_system(p, view->configuration, at);
    def.drive = drive;
    MT_TRY(mt_analysis_new_of(&def, 0, &a, err));
    return count_as(view, a, at, out, err);
}

/* Shape of each named mode of the configuration that exists at the original design. The model
 * names a mode by its index at its own design, where vibrations of 0 Hz, which only the study
 * counts, have no index. */
static mt_status name_modes(mt_problem *p, mt_configuration_problem *view, mt_err *err)
{
    const mt_model *const model = p->study->model;
    mt_analysis *const a = view->original;
    const size_t most = (size_t)model->n_modes;
    view->named = mt_arena_int(&p->mem, most);
    view->shape = mt_arena_alloc(&p->mem, most, sizeof *view->shape);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < model->n_modes; i++) {
        const int pos = mt_analysis_named(a, model->modes[i].index);
        if (model->modes[i].configuration != view->configuration || pos < 0) {
            continue;
        }
        double *const w = mt_arena_f64(&p->mem, (size_t)a->sys->nq, 1);
        MT_TRY(mt_arena_check(&p->mem, err));
        MT_TRY(mt_track_weigh(a, pos, w, err));
        view->named[view->n_named] = i;
        view->shape[view->n_named++] = w;
    }
    return MT_OK;
}

mt_status mt_problem_add_configuration(mt_problem *p, int configuration, int *out, mt_err *err)
{
    *out = mt_problem_configuration(p, configuration);
    if (*out >= 0) {
        return MT_OK;
    }
    mt_configuration_problem *const view = &p->views[p->n_views];
    *view = (mt_configuration_problem){.configuration = configuration};
    MT_TRY(mt_problem_analyse(p, configuration, p->original, &view->original, err));
    view->n_rigid = view->original->n_rigid;
    view->n_most = view->original->n_most;
    *out = p->n_views++;
    return name_modes(p, view, err);
}

int mt_configuration_vibrations(const mt_configuration_problem *view)
{
    return view->n_most - view->n_rigid;
}

const char *mt_configuration_name(const mt_problem *p, const mt_configuration_problem *view)
{
    return p->study->model->configurations[view->configuration].name.s;
}

void mt_configuration_query_all(mt_configuration_work *view)
{
    view->all = true;
    view->ask.modes = (mt_modal_part){.first = 0};
    view->ask.shapes = view->ask.modes;
}

/* Named modes: told directly from the original shapes, else along the straight line of designs
 * in t from the original one (analysis/tracking.h). A walk has at most so many of its shortest
 * steps, however far the design is. */
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

mt_status mt_configuration_position(mt_workspace *w, mt_configuration_work *view, int mode,
                                    int named, int *pos, mt_err *err)
{
    *pos = -1;
    if (!view->solved || (mode == 0 && named < 0)) { /* or a goal that is of no mode */
        return MT_OK;
    }
    if (mode > 0) {
        *pos = mt_modal_flexible(&view->analysis->modes, mode);
        return MT_OK;
    }
    MT_TRY(mt_configuration_track(w, view, err));
    *pos = view->track[named].pos;
    return MT_OK;
}
