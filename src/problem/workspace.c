/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One evaluation: parameters, expressions, the modes of every view, every requirement, the
 * objective and those that are held. */
#include "problem/workspace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/work_counters.h"
#include "nlp/merit.h"
#include "problem/drive_positions.h"
#include "problem/forced_response.h"
#include "problem/goal_avoid.h"
#include "problem/objective.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "problem/tolerance_cut.h"

/* Evaluations between two lines of progress: a tenth of a second or so for a small
 * mechanism. */
enum { PROGRESS_EVERY = 500, PROGRESS_TEXT = 80 };

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

double mt_workspace_dx_dt(const mt_workspace *w, int i)
{
    return mt_problem_dx_dt_at(w->p, i, w->x[i]);
}

mt_nlp mt_workspace_nlp(mt_workspace *w)
{
    const mt_subproblem *const c = w->c;
    const mt_nlp nlp = {.n = c->n_t,
                        .lower = c->lower_t,
                        .upper = c->upper_t,
                        .hint = c->hint,
                        .origin = c->origin_t,
                        .change_weight = c->change_weight,
                        .n_res = mt_subproblem_rows_res(c),
                        .n_eq = c->rows.eq.n,
                        .n_in = c->rows.in.n,
                        .eq_tol = c->rows.eq.tol,
                        .in_tol = c->rows.in.tol,
                        .n_next = c->rows.next.n,
                        .next_of = c->rows.next_of,
                        .eval = mt_workspace_eval_uncounted,
                        .context = w,
                        .task_path = w->task_path};
    return nlp;
}

mt_status mt_workspace_place(mt_workspace *w, const double *t, bool with_gradient, mt_err *err)
{
    const mt_problem *const p = w->p;
    memmove(w->t, t, (size_t)w->c->n_t * sizeof *t);
    w->worst = -HUGE_VAL;
    mt_subproblem_x(w->c, t, w->x);
    if (!with_gradient) {
        return mt_program_eval(&p->program, w->x, w->value, NULL, err);
    }
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    const mt_status rc = mt_program_gradient(&p->program, w->x, w->value, w->grad, &bad, &own);
    /* a published quantity may have no slope, as a change has none at the original design:
     * nobody needs it */
    return rc == MT_OK || (rc == MT_E_DOMAIN && bad >= p->n_searched)
               ? MT_OK
               : mt_fail(err, rc, "%s", own.text);
}

mt_analysis_options mt_configuration_queries(const mt_workspace *w,
                                             const mt_configuration_work *view,
                                             bool with_gradient)
{
    mt_analysis_options opt = view->ask;
    opt.gradient = with_gradient;
    opt.accuracy = w->accuracy;
    if (!view->all && !opt.vectors) {
        mt_avoidances_query(w->c, (int)(view - w->views), &opt.shapes);
    }
    return opt;
}

void mt_configuration_query_all(mt_configuration_work *view)
{
    view->all = true;
    view->ask.modes = (mt_modal_part){.first = 0};
    view->ask.shapes = view->ask.modes;
}

mt_status mt_configuration_solve(mt_workspace *w, mt_configuration_work *view,
                                 bool with_gradient, mt_err *err)
{
    const mt_analysis_options opt = mt_configuration_queries(w, view, with_gradient);
    view->tracked = false;
    view->solved = false;
    mt_forced_response_close(view);
    MT_TRY(mt_err_in(err, mt_analysis_solve(view->analysis, w->x, &opt, err),
                     "configuration \"%s\"", mt_analysis_configuration(view->analysis)));
    view->solved = true;
    return MT_OK;
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

static void say_progress(const mt_workspace *w)
{
    if (w->progress != NULL && w->evaluations % PROGRESS_EVERY == 0) {
        char text[PROGRESS_TEXT];
        (void)mt_snprintf(text, sizeof text, "searching: more than %ld designs evaluated",
                          w->evaluations);
        w->progress(w->progress_context, text);
    }
}

/* True where a feasible value is verified later over tolerances or positions of a drive, and
 * may still fail. */
static bool judged_later(const mt_workspace *w)
{
    return mt_drive_positions_any(w->p) || mt_tolerance_is_sampled(w->c);
}

/* True where progress of feasible designs is reported and the value can be. */
static bool is_wanted(const mt_workspace *w)
{
    const mt_subproblem *const c = w->c;
    return mt_progress_seeks(w->p->run->progress) && c->n_stages > 0 &&
           c->stages[0].ops->value != NULL;
}

static void report_found(const mt_workspace *w, double f)
{
    const mt_objective_stage *const objective_stage = &w->c->stages[0];
    mt_progress_found(w->p->run->progress, mt_objective_kind_of(objective_stage->type)->name, f,
                      mt_objective_stage_shown(objective_stage, f));
}

void mt_workspace_judged(const mt_workspace *w, double f)
{
    if (is_wanted(w) && judged_later(w)) {
        report_found(w, f);
    }
}

static void say_found(const mt_workspace *w, const mt_nlp_values *v)
{
    const mt_subproblem *const c = w->c;
    mt_progress_evaluated(w->p->run->progress);
    mt_progress_solved(w->p->run->progress, mt_subproblem_solutions(c));
    if (!is_wanted(w) || judged_later(w)) {
        return;
    }
    const mt_missed missed = mt_subproblem_missed(c, v);
    if (mt_is_met(missed.violation, 1.0)) {
        report_found(w, mt_objective_stage_value(w, 0, NULL));
    }
}

void mt_workspace_note_designs(const mt_workspace *w, long n)
{
    mt_work_counters *const spent = w->p->run->work;
    mt_work_counters_note(spent, MT_WORK_DESIGNS, n);
    mt_work_counters_note(spent, MT_WORK_MODAL, n * mt_subproblem_solutions(w->c));
}

mt_status mt_workspace_eval(void *context, const double *t, bool with_gradient,
                            mt_nlp_values *out, mt_err *err)
{
    const mt_workspace *const w = context;
    mt_workspace_note_designs(w, 1);
    return mt_workspace_eval_uncounted(context, t, with_gradient, out, err);
}

mt_status mt_workspace_solve(const mt_workspace *w, const mt_nlp *nlp,
                             const mt_nlp_options *opt, mt_arena *mem, mt_nlp_result *out,
                             mt_err *err)
{
    const mt_status rc = mt_nlp_solve(nlp, opt, mem, out, err);
    mt_workspace_note_designs(w, out->evals);
    return rc;
}

mt_status mt_workspace_eval_uncounted(void *context, const double *t, bool with_gradient,
                                      mt_nlp_values *out, mt_err *err)
{
    mt_workspace *const w = context;
    const mt_problem *const p = w->p;
    MT_TRY(mt_interrupt_check(p->run->interrupt, err));
    w->evaluations++;
    say_progress(w);
    MT_TRY(mt_workspace_place(w, t, with_gradient, err));
    for (int i = 0; i < w->c->n_views; i++) {
        MT_TRY(mt_configuration_solve(w, &w->views[i], with_gradient, err));
    }
    MT_TRY(mt_tolerance_solve(w, with_gradient, err));
    MT_TRY(mt_subproblem_eval_rows(w, with_gradient, out, err));
    if (mt_subproblem_rows_res(w->c) > 0) {
        const size_t n_res = (size_t)w->c->rows.res.n;
        memcpy(out->r, w->r, n_res * sizeof *w->r);
        if (with_gradient) {
            memcpy(out->dr, w->dr, n_res * (size_t)p->n * sizeof *w->dr);
        }
    }
    out->f = mt_objective_stage_value(w, w->c->stage, with_gradient ? out->df : NULL);
    say_found(w, out);
    return MT_OK;
}
