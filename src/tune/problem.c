/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* Default tolerance of a goal in percent (the format's documentation says so too). */
static const double DEFAULT_TOLERANCE_PERCENT = 1e-4;

void mt_problem_delete(mt_problem *p)
{
    if (p != NULL) {
        for (int i = 0; i < p->n_views; i++) {
            mt_analysis_delete(p->views[i].analysis);
        }
        mt_arena_free(&p->mem);
        free(p);
    }
}

void mt_problem_x(const mt_problem *p, const double *t, double *x)
{
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const double free_x = MT_HAS(p->scale[i]) ? t[i] * p->scale[i] : exp(t[i]);
        /* a bound in t is that bound in x, to the last bit; so is the original value */
        if (!(t[i] < p->upper_t[i])) {
            x[i] = v->upper;
        } else if (!(t[i] > p->lower_t[i])) {
            x[i] = v->lower;
        } else {
            x[i] = t[i] == p->origin_t[i] ? p->original[i] : free_x;
        }
    }
}

int mt_problem_view(const mt_problem *p, int configuration)
{
    for (int i = 0; i < p->n_views; i++) {
        if (p->views[i].configuration == configuration) {
            return i;
        }
    }
    return -1;
}

static mt_status init_variables(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    p->inputs = mt_arena_int(&p->mem, n);
    p->original = mt_arena_f64(&p->mem, n, 1);
    p->lower_t = mt_arena_f64(&p->mem, n, 1);
    p->upper_t = mt_arena_f64(&p->mem, n, 1);
    p->origin_t = mt_arena_f64(&p->mem, n, 1);
    p->scale = mt_arena_f64(&p->mem, n, 1);
    p->x = mt_arena_f64(&p->mem, n, 1);
    p->dlambda = mt_arena_f64(&p->mem, n, 1);
    if (p->inputs == NULL || p->original == NULL || p->lower_t == NULL || p->upper_t == NULL ||
        p->origin_t == NULL || p->scale == NULL || p->x == NULL || p->dlambda == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const bool positive = v->lower > 0.0 && v->original > 0.0;
        p->inputs[i] = v->parameter;
        p->original[i] = v->original;
        p->scale[i] = positive ? nan("") : (MT_HAS(v->scale) ? v->scale : v->upper - v->lower);
        p->lower_t[i] = positive ? log(v->lower) : v->lower / p->scale[i];
        p->upper_t[i] = positive ? log(v->upper) : v->upper / p->scale[i];
        p->origin_t[i] = positive ? log(v->original) : v->original / p->scale[i];
    }
    return MT_OK;
}

/* Shape of each named mode of the configuration at the original design, weighted with the mass. */
static mt_status name_modes(mt_problem *p, mt_view *view, mt_err *err)
{
    const mt_model *const model = p->study->model;
    mt_analysis *const a = view->analysis;
    const size_t nq = (size_t)a->sys->nq;
    const size_t n = (size_t)a->lin->n;
    view->named = mt_arena_alloc(&p->mem, (size_t)model->n_modes, sizeof *view->named);
    double *const my = mt_arena_f64(&p->mem, n, 1);
    if (view->named == NULL || my == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < model->n_modes; i++) {
        if (model->modes[i].configuration != view->configuration) {
            continue;
        }
        const int pos = mt_modal_flexible(&a->modes, model->modes[i].index);
        if (pos < 0) {
            return mt_fail(err, MT_E_INPUT,
                           "named mode \"%s\": configuration \"%s\" has no vibration mode %d "
                           "at the original design",
                           model->modes[i].name.s, mt_analysis_configuration(a),
                           model->modes[i].index);
        }
        mt_named_shape *const shape = &view->named[view->n_named++];
        shape->named = i;
        shape->w = mt_arena_f64(&p->mem, nq, 1);
        if (shape->w == NULL) {
            return mt_fail_memory(err);
        }
        /* M phi = sum of mass terms; reduced: w^T phi_new = (M phi)^T Z y with the full product kept, so that it holds when Z changes */
        MT_TRY(mt_linear_mass_product(a->lin, a->modes.y + ((ptrdiff_t)pos * (ptrdiff_t)n),
                                      shape->w, err));
    }
    return MT_OK;
}

static mt_status add_view(mt_problem *p, int configuration, int *out, mt_err *err)
{
    *out = mt_problem_view(p, configuration);
    if (*out >= 0) {
        return MT_OK;
    }
    mt_view *const view = &p->views[p->n_views];
    *view = (mt_view){.configuration = configuration};
    MT_TRY(mt_analysis_new(p->study->model, configuration, p->n, p->inputs, p->original,
                           &view->analysis, err));
    *out = p->n_views++;
    return name_modes(p, view, err);
}

static int find_named(const mt_view *view, int named)
{
    for (int i = 0; i < view->n_named; i++) {
        if (view->named[i].named == named) {
            return i;
        }
    }
    return -1;
}

/* The same mode as in the named mode's own configuration: its index there, where the goal speaks of another configuration. */
static mt_status resolve_mode(const mt_problem *p, const mt_goal *goal, const mt_view *view,
                              mt_demand *d, mt_err *err)
{
    d->mode = goal->mode.index;
    d->named = -1;
    if (d->mode > 0 || goal->mode.mode_name.s == NULL) {
        return MT_OK;
    }
    d->named = find_named(view, goal->mode.named);
    if (d->named < 0) {
        return mt_fail(
            err, MT_E_INPUT,
            "/goals/%d: mode \"%s\" is named in configuration \"%s\", not in \"%s\"",
            d->goal_index, goal->mode.mode_name.s,
            p->study->model
                ->configurations[p->study->model->modes[goal->mode.named].configuration]
                .name.s,
            mt_analysis_configuration(view->analysis));
    }
    return MT_OK;
}

/* What the goal is compared with: a shape, or a frequency, which is then the target. */
static mt_status resolve_reference(mt_problem *p, const mt_view *view, mt_demand *d,
                                   mt_err *err)
{
    const mt_goal *const g = d->goal;
    if (g->reference_name.s == NULL) {
        return MT_OK;
    }
    const int own = d->mode > 0 ? d->mode : p->study->model->modes[g->mode.named].index;
    const int mode = g->reference_mode > 0 ? g->reference_mode : own;
    if (g->type == MT_GOAL_FREQUENCY) {
        MT_TRY(mt_reference_frequency_init(p, g->reference, mode, &d->shape, err));
        d->target_hz = d->shape.frequency_hz;
        return MT_OK;
    }
    return mt_reference_shape_init(p, g->reference, mode, view->analysis->sys, &p->mem,
                                   &d->shape, err);
}

static void number_rows(mt_problem *p, mt_demand *d)
{
    const mt_goal *const g = d->goal;
    const double percent =
        MT_HAS(g->tolerance_percent) ? g->tolerance_percent : DEFAULT_TOLERANCE_PERCENT;
    d->tolerance = percent / 100.0;
    d->row_eq = -1;
    d->row_in = -1;
    d->row_res = -1;
    if (MT_HAS(g->weight)) {
        d->row_res = p->n_res;
        p->n_res += g->type == MT_GOAL_SHAPE ? d->shape.ns : 1;
        return;
    }
    if (MT_HAS(g->equals) || MT_HAS(d->target_hz)) {
        d->row_eq = p->n_eq++;
        return;
    }
    d->row_in = p->n_in;
    p->n_in += (MT_HAS(g->at_least) ? 1 : 0) + (MT_HAS(g->at_most) ? 1 : 0);
}

static mt_status add_demand(mt_problem *p, int goal_index, int configuration, mt_err *err)
{
    const mt_goal *const g = &p->study->goals[goal_index];
    mt_demand *const d = &p->demands[p->n_demands];
    *d = (mt_demand){.goal = g,
                     .goal_index = goal_index,
                     .view = -1,
                     .node = MT_NO_NODE,
                     .target_hz = g->target_hz};
    if (g->type != MT_GOAL_LIMIT) {
        MT_TRY(add_view(p, configuration, &d->view, err));
        mt_view *const view = &p->views[d->view];
        MT_TRY(resolve_mode(p, g, view, d, err));
        const int pos = mt_view_position(view, d->mode, d->named, err);
        if (pos < 0) {
            return mt_fail(err, MT_E_INPUT,
                           "/goals/%d: configuration \"%s\" has no vibration mode %d at the "
                           "original design%s",
                           goal_index, mt_analysis_configuration(view->analysis), d->mode,
                           view->analysis->modes.n_unstable > 0 ? " (it is unstable there)"
                                                                : "");
        }
        MT_TRY(mt_err_in(err, resolve_reference(p, view, d, err), "/goals/%d", goal_index));
        view->needs_vectors = view->needs_vectors || g->type == MT_GOAL_SHAPE ||
                              g->type == MT_GOAL_MAC || d->named >= 0;
    }
    number_rows(p, d);
    p->n_demands++;
    return MT_OK;
}

static mt_status init_demands(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    size_t most = 1;
    for (int i = 0; i < s->n_goals; i++) {
        most += (size_t)s->goals[i].n_configurations + 1;
    }
    p->demands = mt_arena_alloc(&p->mem, most, sizeof *p->demands);
    p->views =
        mt_arena_alloc(&p->mem, (size_t)s->model->n_configurations + 1, sizeof *p->views);
    if (p->demands == NULL || p->views == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < s->n_goals; i++) {
        if (s->goals[i].type == MT_GOAL_LIMIT) {
            MT_TRY(add_demand(p, i, -1, err));
        }
        for (int k = 0; k < s->goals[i].n_configurations && s->goals[i].type != MT_GOAL_LIMIT;
             k++) {
            MT_TRY(add_demand(p, i, s->goals[i].configurations[k], err));
        }
    }
    size_t ns = 1;
    p->eq_tol = mt_arena_f64(&p->mem, (size_t)p->n_eq, 1);
    p->in_tol = mt_arena_f64(&p->mem, (size_t)p->n_in, 1);
    if (p->eq_tol == NULL || p->in_tol == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n_demands; i++) {
        const mt_demand *const d = &p->demands[i];
        ns = (size_t)d->shape.ns > ns ? (size_t)d->shape.ns : ns;
        if (d->row_eq >= 0) {
            p->eq_tol[d->row_eq] = d->tolerance;
        }
        for (int k = 0; d->row_in >= 0 && k < (MT_HAS(d->goal->at_least) ? 1 : 0) +
                                                  (MT_HAS(d->goal->at_most) ? 1 : 0);
             k++) {
            p->in_tol[d->row_in + k] = d->tolerance;
        }
    }
    p->shape = mt_arena_f64(&p->mem, ns, 1);
    p->dshape = mt_arena_f64(&p->mem, ns, (size_t)p->n);
    return p->shape == NULL || p->dshape == NULL ? mt_fail_memory(err) : MT_OK;
}

/* Limits, the objective's expression and published quantities as one program of the variables. */
static mt_status init_expressions(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    const size_t n_parameters = (size_t)s->model->n_parameters;
    int *const is_input = mt_arena_int(&p->mem, n_parameters);
    mt_node *const nodes = mt_arena_alloc(&p->mem, n_parameters, sizeof *nodes);
    p->published = mt_arena_alloc(&p->mem, (size_t)s->n_published, sizeof *p->published);
    if (is_input == NULL || nodes == NULL || p->published == NULL) {
        return mt_fail_memory(err);
    }
    for (size_t i = 0; i < n_parameters; i++) {
        is_input[i] = -1;
    }
    for (int i = 0; i < p->n; i++) {
        is_input[p->inputs[i]] = i;
    }
    MT_TRY(mt_program_init(&p->program, p->n, &p->mem, err));
    MT_TRY(mt_emit_parameters(s->model, MT_ABSENT, is_input, &p->program, nodes, &p->mem, err));
    for (int i = 0; i < p->n_demands; i++) {
        if (p->demands[i].goal->type == MT_GOAL_LIMIT) {
            p->demands[i].node = mt_program_expr(&p->program, &p->demands[i].goal->expression,
                                                 nodes, p->demands[i].goal->addr);
        }
    }
    p->objective_node = MT_NO_NODE;
    if (p->objective == MT_OBJECTIVE_EXPRESSION) {
        p->objective_node = mt_program_expr(&p->program, &s->objectives[0].expression, nodes,
                                            s->objectives[0].addr);
    }
    for (int i = 0; i < s->n_published; i++) {
        const mt_published *const pub = &s->published[i];
        p->published[i] = MT_NO_NODE;
        if (pub->kind == MT_PUBLISHED_QUANTITY) {
            p->published[i] = mt_program_expr(&p->program, &pub->quantity, nodes, pub->addr);
        } else if (pub->kind == MT_PUBLISHED_PARAMETER) {
            p->published[i] = nodes[pub->parameter];
        }
    }
    MT_TRY(mt_program_finish(&p->program, err));
    p->value = mt_arena_f64(&p->mem, (size_t)p->program.count, 1);
    p->grad = mt_arena_f64(&p->mem, (size_t)p->program.count, (size_t)p->n);
    return p->value == NULL || p->grad == NULL ? mt_fail_memory(err) : MT_OK;
}

static bool counted(const mt_objective *o, const char *name)
{
    for (int i = 0; i < o->of.count; i++) {
        if (mt_text_matches(o->of.items[i].s, name)) {
            return true;
        }
    }
    return o->of.count == 0;
}

/* Items whose mass is to be least: of the first configuration that a goal names. */
static mt_status init_mass(mt_problem *p, mt_err *err)
{
    if (p->objective != MT_OBJECTIVE_MASS) {
        return MT_OK;
    }
    int view = 0;
    if (p->n_views == 0) {
        MT_TRY(add_view(p, 0, &view, err));
    }
    const mt_system *const sys = p->views[view].analysis->sys;
    p->mass = mt_arena_alloc(&p->mem, (size_t)sys->n_items, sizeof *p->mass);
    if (p->mass == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < sys->n_items; i++) {
        if (sys->items[i].mass != MT_NO_NODE &&
            counted(&p->study->objectives[0], sys->items[i].name)) {
            p->mass[p->n_mass++] = sys->items[i].mass;
        }
    }
    if (p->n_mass == 0) {
        return mt_fail(err, MT_E_INPUT,
                       "/objective/of: no body, link or bar of configuration \"%s\" matches",
                       mt_analysis_configuration(p->views[view].analysis));
    }
    return MT_OK;
}

mt_status mt_problem_new(const mt_study *study, mt_reference_cache *references,
                         mt_problem **out, mt_err *err)
{
    mt_problem *const p = calloc(1, sizeof *p);
    *out = NULL;
    if (p == NULL) {
        return mt_fail_memory(err);
    }
    p->study = study;
    p->references = references;
    p->n = study->n_variables;
    p->objective = study->n_objectives > 0
                       ? study->objectives[0].type
                       : (p->n > 0 ? MT_OBJECTIVE_CHANGE : MT_OBJECTIVE_NONE);
    mt_status rc = mt_arena_init(&p->mem, 0, err);
    rc = rc == MT_OK ? init_variables(p, err) : rc;
    rc = rc == MT_OK ? init_demands(p, err) : rc;
    rc = rc == MT_OK ? init_expressions(p, err) : rc;
    rc = rc == MT_OK ? init_mass(p, err) : rc;
    if (rc != MT_OK) {
        mt_problem_delete(p);
        return rc;
    }
    *out = p;
    return MT_OK;
}

mt_nlp mt_problem_nlp(mt_problem *p)
{
    const bool misfit = p->objective == MT_OBJECTIVE_MISFIT;
    const mt_nlp nlp = {.n = p->n,
                        .lower = p->lower_t,
                        .upper = p->upper_t,
                        .origin = p->origin_t,
                        .n_res = misfit ? p->n_res : 0,
                        .n_eq = p->n_eq,
                        .n_in = p->n_in,
                        .eq_tol = p->eq_tol,
                        .in_tol = p->in_tol,
                        .eval = mt_problem_eval,
                        .context = p};
    return nlp;
}
