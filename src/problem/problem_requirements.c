/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From goals to requirements: one per goal and configuration, each with a view, a mode, a
 * reference and its rows. */
#include <math.h>

#include "analysis/count.h"
#include "base/progress.h"
#include "problem/drive_positions.h"
#include "problem/goal.h"
#include "problem/mode_order.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

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

static const char *instability(const mt_configuration_problem *view)
{
    const mt_modes *const modes = &view->original->modes;
    return modes->n_unstable > 0    ? " (it is unstable there)"
           : modes->n_undecided > 0 ? " (rounding hides whether it is stable there)"
                                    : "";
}

/* Finds a mode by name: its index in the configuration's list. */
static mt_status resolve_name(const mt_problem *p, const mt_configuration_problem *view,
                              mt_requirement *d, mt_err *err)
{
    const mt_model *const model = p->study->model;
    const mt_named_mode *const wanted = &model->modes[d->goal->mode.named];
    for (int i = 0; i < view->n_named; i++) {
        if (view->named[i] == d->goal->mode.named) {
            d->named = i;
            return MT_OK;
        }
    }
    if (wanted->configuration != view->configuration) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: mode \"%s\" is named in configuration \"%s\", not in \"%s\"",
                       d->goal_index, wanted->name.s,
                       model->configurations[wanted->configuration].name.s,
                       mt_analysis_configuration(view->original));
    }
    return mt_fail(err, MT_E_INPUT,
                   "/goals/%d: mode \"%s\" is vibration mode %d of configuration \"%s\", "
                   "which has none at the original design%s",
                   d->goal_index, wanted->name.s, wanted->index,
                   mt_analysis_configuration(view->original), instability(view));
}

/* A mode index must exist at some design; where the original design is unstable no mode has an
 * index, and enough degrees of freedom suffice. */
static mt_status resolve_index(const mt_configuration_problem *view, const mt_requirement *d,
                               mt_err *err)
{
    const int most = mt_configuration_vibrations(view);
    if (d->mode <= most) {
        return MT_OK;
    }
    return mt_fail(err, MT_E_INPUT,
                   "/goals/%d: configuration \"%s\" has no vibration mode %d (it has %d)",
                   d->goal_index, mt_analysis_configuration(view->original), d->mode, most);
}

static void set_role(mt_problem *p, mt_requirement *d)
{
    const mt_goal *const g = d->goal;
    const int parts = d->n_parts > 0 ? d->n_parts : 1;
    const int limits = (MT_HAS(g->at_least) ? 1 : 0) + (MT_HAS(g->at_most) ? 1 : 0);
    d->tolerance = mt_goal_tolerance(g);
    if (MT_HAS(g->weight)) {
        d->role = MT_ROLE_RESIDUAL;
        d->n_rows = d->ops->value == NULL ? d->n_rows : 1;
        p->weights += g->weight;
    } else if (mt_study_is_scale(p->study, g)) {
        d->role = MT_ROLE_VIBRATION;
        d->n_rows = parts;
    } else if (mt_tolerance_is_range(p, d)) {
        d->role = MT_ROLE_RANGE;
    } else if (MT_HAS(d->equals)) {
        d->role = MT_ROLE_TARGET;
        d->n_rows = 1;
    } else {
        d->role = MT_ROLE_LIMIT;
        d->n_rows = d->n_parts > 0 ? parts : limits;
    }
}

static mt_status add_requirement(mt_problem *p, int goal_index, int configuration, mt_err *err)
{
    const mt_goal *const g = &p->study->goals[goal_index];
    mt_requirement *const d = &p->requirements[p->n_requirements];
    *d = (mt_requirement){.index = p->n_requirements,
                          .ops = mt_goal_ops_of(g->type),
                          .quantity = mt_goal_ops_of(g->type)->quantity,
                          .measure = mt_goal_kind_of(g->type)->measure,
                          .goal = g,
                          .goal_index = goal_index,
                          .view = -1,
                          .mode = g->mode.index,
                          .named = -1,
                          .node = MT_NO_NODE,
                          .equals = g->equals,
                          .size = 1.0};
    if (configuration != MT_ABSENT) {
        MT_TRY(mt_err_in(err, mt_problem_add_configuration(p, configuration, &d->view, err),
                         "/goals/%d", goal_index));
        const mt_configuration_problem *const view = &p->views[d->view];
        if (mt_requirement_is_modal(d)) {
            MT_TRY(d->mode > 0 ? resolve_index(view, d, err) : resolve_name(p, view, d, err));
        }
    }
    if (d->ops->compile != NULL) {
        const mt_status rc = d->ops->compile(p, d, err);
        const bool placed = rc != MT_OK && err->text[0] == '/'; /* at a member of the goal */
        MT_TRY(placed ? rc : mt_err_in(err, rc, "/goals/%d", goal_index));
    }
    set_role(p, d);
    p->n_requirements++;
    return MT_OK;
}

/* All modes where bands apply, since any may be in one, but only the shapes that rows use
 * (mt_configuration_solve adds those of the bands); all shapes where shapes are compared or
 * tracked: shares of a shape and its derivatives are sums over all modes. */
static void ask_view(const mt_problem *p, int index)
{
    mt_configuration_problem *const view = &p->views[index];
    bool all = false;
    int first = 0;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->view == index) {
            const bool shapes = d->ops->needs_vectors || d->named >= 0;
            view->ask.vectors = view->ask.vectors || shapes;
            first = d->mode > first ? d->mode : first;
        }
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        all = all || p->avoidances[i].view == index;
    }
    const int part = first > 0 && !view->ask.vectors ? first + MT_MODE_ORDER_MOST : 0;
    view->ask.shapes = (mt_modal_part){.first = part};
    view->ask.modes = (mt_modal_part){.first = all ? 0 : part};
}

void mt_problem_query(mt_problem *p)
{
    for (int i = 0; i < p->n_views; i++) {
        ask_view(p, i);
    }
}

/* Requirements and configurations of goal i. */
static mt_status add_goal(mt_problem *p, int i, mt_err *err)
{
    const mt_goal *const g = &p->study->goals[i];
    if (g->n_configurations == 0) {
        MT_TRY(add_requirement(p, i, MT_ABSENT, err));
    }
    for (int k = 0; k < g->n_configurations; k++) {
        int view = -1;
        MT_TRY(g->avoid != NULL
                   ? mt_problem_add_configuration(p, g->configurations[k], &view, err)
                   : add_requirement(p, i, g->configurations[k], err));
    }
    return MT_OK;
}

mt_status mt_problem_init_requirements(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    size_t most = 0;
    for (int i = 0; i < s->n_goals; i++) {
        most += (size_t)s->goals[i].n_configurations + 1;
    }
    p->requirements = mt_arena_alloc(&p->mem, most, sizeof *p->requirements);
    p->views = mt_arena_alloc(&p->mem, (size_t)s->model->n_configurations, sizeof *p->views);
    MT_TRY(mt_arena_check(&p->mem, err));
    mt_progress *const progress = p->run->progress;
    const bool told = mt_progress_begin(progress, "goals", s->n_goals);
    mt_status rc = MT_OK;
    for (int i = 0; i < s->n_goals && rc == MT_OK; i++) {
        rc = add_goal(p, i, err);
        mt_progress_done(progress, told);
    }
    mt_progress_end(progress, told);
    return rc;
}
