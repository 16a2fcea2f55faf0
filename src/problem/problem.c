/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A study compiled: variables, configurations, requirements, the program of expressions, the
 * objectives. */

#include "problem/problem.h"

#include <math.h>
#include <stdlib.h>

#include "base/run.h"
#include "model/values.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/drive_positions.h"
#include "problem/evaluate.h"
#include "problem/forced_response.h"
#include "problem/goals.h"
#include "problem/objective.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "prove/certify.h"

/* Values of a parameter below this part of the original are next to nothing: there t is linear
 * in x, so that 0 itself is within reach (t = ln(floor) - 1). It is no smaller because the
 * slope of a goal over t falls with it, and a search must still feel that slope to arrive at
 * 0. */
static const double FLOOR_PART = 1e-3;

/* The measure of one variable's change. */
static void init_measure(mt_problem *p, int i)
{
    const mt_variable *const v = &p->study->variables[i];
    /* of the whole catalogue, also where the bounds have been closed on one of its values */
    const double least = v->n_catalogue > 0 ? v->catalogue[0] : v->lower;
    const bool logarithmic = !MT_HAS(v->scale) && least >= 0.0 && v->original > 0.0;
    const double linear = MT_HAS(v->scale) ? v->scale : v->range;
    p->scale[i] = logarithmic ? nan("") : linear;
    p->floor[i] = logarithmic && !(least > 0.0) ? FLOOR_PART * v->original : 0.0;
}

const double *mt_choice_row(const mt_choice *choice, int row)
{
    return choice->value + ((ptrdiff_t)row * choice->n);
}

int mt_choice_find(const mt_choice *choice, const double *x)
{
    for (int i = 0; i < choice->n_rows; i++) {
        const double *const row = mt_choice_row(choice, i);
        bool same = true;
        for (int k = 0; k < choice->n && same; k++) {
            same = row[k] == x[choice->first + k];
        }
        if (same) {
            return i;
        }
    }
    return MT_ABSENT;
}

static void list_choices(mt_problem *p)
{
    for (int i = 0; i < p->n;) {
        const mt_variable *const v = &p->study->variables[i];
        const int n = v->rows == NULL ? 1 : v->rows->n;
        if (v->n_catalogue > 0) {
            p->choices[p->n_choices++] =
                v->rows == NULL ? (mt_choice){i, 1, v->n_catalogue, v->catalogue, NULL}
                                : (mt_choice){i, n, v->rows->n_rows, v->rows->value, v->rows};
        }
        i += n;
    }
}

static mt_status init_variables(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    p->choices = mt_arena_alloc(&p->mem, n, sizeof *p->choices);
    p->inputs = mt_arena_int(&p->mem, n);
    p->original = mt_arena_f64(&p->mem, n, 1);
    p->scale = mt_arena_f64(&p->mem, n, 1);
    p->floor = mt_arena_f64(&p->mem, n, 1);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        p->inputs[i] = v->parameter;
        p->original[i] = v->original;
        init_measure(p, i);
    }
    list_choices(p);
    return MT_OK;
}

static mt_status init_references(mt_problem *p, mt_err *err)
{
    p->references = mt_arena_alloc(&p->mem, 1, sizeof *p->references);
    MT_TRY(mt_arena_check(&p->mem, err));
    return mt_reference_cache_init(p->references, p->study, p->run, &p->mem, err);
}

/* A profile says how the ground accelerates. */
static mt_status check_forced_response(const mt_study_response *r, const mt_port *in, int index,
                                       mt_err *err)
{
    const bool accelerates = in->kind == MT_PORT_BASE && in->motion == 2;
    return accelerates || r->response_limit.profile_name.s == NULL
               ? MT_OK
               : mt_fail(err, MT_E_INPUT,
                         "/responses/%d/input: \"%s\" is not an acceleration of the ground, as "
                         "a profile is: write \"base.x\", \"base.y\" or \"base.z\"",
                         index, r->response_limit.input.s);
}

static mt_status check_response_ports(const mt_problem *p, int index, mt_arena *mem,
                                      mt_err *err)
{
    const mt_study_response *const r = &p->study->responses[index];
    mt_port in = {.name = NULL};
    mt_port out;
    mt_system *sys = NULL;
    const char *const at = mt_arena_printf(mem, "/responses/%d", index);
    MT_TRY(mt_arena_check(mem, err));
    const mt_system_def def = mt_problem_system(p, r->configuration, p->original);
    mt_status rc = mt_system_new_of(&def, &sys, err);
    rc = rc == MT_OK
             ? mt_forced_response_ports_at(sys, &r->response_limit, at, mem, &in, &out, err)
             : rc;
    rc = rc == MT_OK ? check_forced_response(r, &in, index, err) : rc;
    mt_system_delete(sys);
    return rc;
}

/* Checks the ports of responses. Fails: MT_E_INPUT, naming the unknown port. */
static mt_status check_responses(const mt_problem *p, mt_err *err)
{
    mt_arena mem;
    mt_status rc = mt_arena_init(&mem, 0, err);
    const int n = p->study->examined ? 0 : p->study->n_responses;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        rc = check_response_ports(p, i, &mem, err);
    }
    mt_arena_free(&mem);
    return rc;
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
                              const mt_requirement *d, mt_requirement_mode *mode, mt_err *err)
{
    const mt_model *const model = p->study->model;
    const mt_named_mode *const wanted = &model->modes[mode->asked->named];
    for (int i = 0; i < view->n_named; i++) {
        if (view->named[i] == mode->asked->named) {
            mode->named = i;
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
                               int mode, mt_err *err)
{
    const int most = mt_configuration_vibrations(view);
    if (mode <= most) {
        return MT_OK;
    }
    return mt_fail(err, MT_E_INPUT,
                   "/goals/%d: configuration \"%s\" has no vibration mode %d (it has %d)",
                   d->goal_index, mt_analysis_configuration(view->original), mode, most);
}

/* A mode of a requirement in its configuration. */
static mt_status resolve_mode(const mt_problem *p, const mt_requirement *d,
                              mt_requirement_mode *mode, mt_err *err)
{
    const mt_configuration_problem *const view = &p->views[mode->view];
    return mode->mode > 0 ? resolve_index(view, d, mode->mode, err)
                          : resolve_name(p, view, d, mode, err);
}

/* The modes of a requirement: that of its goal and what it is compared with, or the k-th of
 * several with the one before. */
static mt_status resolve_modes(mt_problem *p, mt_requirement *d, int k, mt_err *err)
{
    const mt_goal *const g = d->goal;
    const bool listed = g->n_modes > 0;
    const mt_mode_ref *const of = listed ? &g->modes[k] : &g->of.mode;
    d->asked = listed ? &g->modes[k + 1] : &g->mode;
    mt_requirement_mode own = {d->asked, d->view, d->asked->index, -1};
    MT_TRY(resolve_mode(p, d, &own, err));
    d->mode = own.mode;
    d->named = own.named;
    d->of = (mt_requirement_mode){of, -1, of->index, -1};
    if (d->quantity != MT_QUANTITY_FREQUENCIES) {
        return MT_OK;
    }
    d->of.view = d->view;
    if (g->of.configuration != MT_ABSENT) {
        MT_TRY(mt_err_in(err,
                         mt_problem_add_configuration(p, g->of.configuration, &d->of.view, err),
                         "/goals/%d", d->goal_index));
    }
    return resolve_mode(p, d, &d->of, err);
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

static mt_status add_requirement(mt_problem *p, int goal_index, int configuration, int k,
                                 mt_err *err)
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
                          .asked = &g->mode,
                          .named = -1,
                          .of = {.view = -1, .named = -1},
                          .direction = k,
                          .node = MT_NO_NODE,
                          .equals = g->equals,
                          .size = 1.0};
    if (configuration != MT_ABSENT) {
        MT_TRY(mt_err_in(err, mt_problem_add_configuration(p, configuration, &d->view, err),
                         "/goals/%d", goal_index));
        MT_TRY(mt_requirement_is_modal(d) ? resolve_modes(p, d, k, err) : MT_OK);
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
        if (d->of.view == index) {
            view->ask.vectors = view->ask.vectors || d->of.named >= 0;
            first = d->of.mode > first ? d->of.mode : first;
        }
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        all = all || p->avoidances[i].view == index;
    }
    const int part = first > 0 && !view->ask.vectors ? first + MT_MODE_ORDER_MOST : 0;
    view->ask.shapes = (mt_modal_part){.first = part};
    view->ask.modes = (mt_modal_part){.first = all ? 0 : part};
}

/* Sets what each configuration is asked for; after requirements and bands. */
static void ask_views(mt_problem *p)
{
    for (int i = 0; i < p->n_views; i++) {
        ask_view(p, i);
    }
}

/* Number of requirements of a goal in each configuration: of neighbours of a list of modes, of
 * directions. */
static int n_each_of(const mt_goal *g)
{
    return g->n_modes > 1 ? g->n_modes - 1 : mt_goal_directions(g);
}

/* Requirements and configurations of goal i. */
static mt_status add_goal(mt_problem *p, int i, mt_err *err)
{
    const mt_goal *const g = &p->study->goals[i];
    if (g->n_configurations == 0) {
        MT_TRY(add_requirement(p, i, MT_ABSENT, 0, err));
    }
    const int n_each = n_each_of(g);
    for (int k = 0; k < g->n_configurations; k++) {
        int view = -1;
        MT_TRY(g->avoid != NULL
                   ? mt_problem_add_configuration(p, g->configurations[k], &view, err)
                   : MT_OK);
        for (int m = 0; m < n_each && g->avoid == NULL; m++) {
            MT_TRY(add_requirement(p, i, g->configurations[k], m, err));
        }
    }
    return MT_OK;
}

static mt_status init_requirements(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    size_t most = 0;
    for (int i = 0; i < s->n_goals; i++) {
        most += ((size_t)s->goals[i].n_configurations * (size_t)n_each_of(&s->goals[i])) + 1;
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

/* Change of a node with the variables, each by 1 in t, at the original design; its own value
 * where it does not change, and 1 where that is 0 too. The result has the node's unit alone. */
static double size_of(const mt_problem *p, mt_node node, const double *value,
                      const double *grad)
{
    double square = 0.0;
    for (int i = 0; i < p->n; i++) {
        const double slope =
            grad[((ptrdiff_t)node * p->n) + i] * mt_problem_dx_dt_at(p, i, p->original[i]);
        square += slope * slope;
    }
    const double moved = sqrt(square);
    const double own = fabs(value[node]);
    return moved > 0.0 && isfinite(moved) ? moved : own > 0.0 && isfinite(own) ? own : 1.0;
}

static double size_of_mass(const mt_problem *p, const mt_objective_stage *a)
{
    double sum = 0.0;
    for (int k = 0; k < a->n_mass; k++) {
        sum += mt_linear_value(p->views[0].original->lin, a->mass[k]);
    }
    return sum > 0.0 ? sum : 1.0;
}

/* A power of two rounds nothing. */
static double next_power(double size)
{
    return ldexp(1.0, ilogb(size));
}

/* Sizes that make the search independent of units. A value that does not exist at the original
 * design leaves 1. */
static mt_status set_sizes(mt_problem *p, mt_err *err)
{
    const size_t count = (size_t)p->program.count;
    const mt_arena_mark mark = mt_arena_get_mark(&p->mem);
    double *const value = mt_arena_f64(&p->mem, count, 1);
    double *const grad = mt_arena_f64(&p->mem, count, (size_t)p->n);
    mt_err own = {.code = MT_OK};
    MT_TRY(mt_arena_check(&p->mem, err));
    const bool known =
        mt_program_gradient(&p->program, p->original, value, grad, NULL, &own) == MT_OK;
    for (int i = 0; i < p->n_requirements && known; i++) {
        mt_requirement *const d = &p->requirements[i];
        d->size = d->node != MT_NO_NODE ? size_of(p, d->node, value, grad) : d->size;
    }
    for (int i = 0; i < p->n_stages; i++) {
        mt_objective_stage *const a = &p->stages[i];
        const double size = a->n_mass > 0                    ? size_of_mass(p, a)
                            : known && a->node != MT_NO_NODE ? size_of(p, a->node, value, grad)
                                                             : 1.0;
        a->size = next_power(size);
    }
    mt_arena_rewind(&p->mem, mark);
    return MT_OK;
}

/* The program of expressions (limits, objectives, published quantities) and the objectives;
 * after the requirements. */
static mt_status init_program(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    const size_t n_parameters = (size_t)s->model->n_parameters;
    int *const is_input = mt_arena_int(&p->mem, n_parameters);
    mt_node *const nodes = mt_arena_alloc(&p->mem, n_parameters, sizeof *nodes);
    p->published = mt_arena_alloc(&p->mem, (size_t)s->n_published, sizeof *p->published);
    p->n_stages = s->n_objectives > 0 ? s->n_objectives : 1;
    p->stages = mt_arena_alloc(&p->mem, (size_t)p->n_stages, sizeof *p->stages);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n_stages; i++) {
        const mt_objective *const o = s->n_objectives > 0 ? &s->objectives[i] : NULL;
        const mt_objective_type type = o != NULL ? o->type : MT_OBJECTIVE_NONE;
        p->stages[i] = (mt_objective_stage){
            .type = type, .ops = mt_objective_ops_of(type), .objective = o, .node = MT_NO_NODE};
    }
    for (size_t i = 0; i < n_parameters; i++) {
        is_input[i] = -1;
    }
    for (int i = 0; i < p->n; i++) {
        is_input[p->inputs[i]] = i;
    }
    MT_TRY(mt_program_init(&p->program, p->n, &p->mem, err));
    MT_TRY(mt_emit_parameters(s->model, MT_ABSENT, is_input, &p->program, nodes, &p->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        mt_requirement *const d = &p->requirements[i];
        if (d->quantity == MT_QUANTITY_EXPRESSION) {
            d->node = mt_program_expr(&p->program, &d->goal->expression, nodes, d->goal->addr);
        }
    }
    for (int i = 0; i < p->n_stages; i++) {
        mt_objective_stage *const a = &p->stages[i];
        if (a->ops->compile != NULL) {
            MT_TRY(a->ops->compile(p, a, nodes, err));
        }
    }
    p->n_searched = p->program.count;
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
    return set_sizes(p, err);
}

void mt_problem_delete(mt_problem *p)
{
    if (p != NULL) {
        for (int i = 0; i < p->n_views; i++) {
            mt_analysis_delete(p->views[i].original);
        }
        mt_families_free(p);
        if (p->references != NULL) {
            mt_reference_cache_free(p->references);
        }
        mt_arena_free(&p->mem);
        free(p);
    }
}

static double proof_work(const mt_search *s)
{
    return MT_HAS(s->proof_s) ? s->proof_s * MT_CERTIFY_WORK_PER_S : MT_CERTIFY_WORK;
}

/* The whole study as a subproblem. */
static mt_status init_whole(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n + 1;
    mt_subproblem *const c = &p->whole;
    double *const weight = mt_arena_f64(&p->mem, (size_t)p->n_requirements, 1);
    double *const change_weight = mt_arena_f64(&p->mem, n, 1);
    *c = (mt_subproblem){.p = p,
                         .lower = mt_arena_f64(&p->mem, n, 1),
                         .upper = mt_arena_f64(&p->mem, n, 1),
                         .lower_t = mt_arena_f64(&p->mem, n, 1),
                         .upper_t = mt_arena_f64(&p->mem, n, 1),
                         .origin_t = mt_arena_f64(&p->mem, n, 1),
                         .change_weight = change_weight,
                         .n_stages = p->n_stages,
                         .stages = p->stages,
                         .weight = weight,
                         .search = p->study->search,
                         .proof_work = proof_work(&p->study->search)};
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        mt_subproblem_bound(c, i, v->lower, v->upper);
        c->origin_t[i] = mt_problem_t(p, i, v->original);
        change_weight[i] = v->weight;
    }
    for (int i = 0; i < p->n_requirements; i++) {
        weight[i] = p->requirements[i].goal->weight;
    }
    return mt_subproblem_lay_out(c, NULL, 0, NULL, NULL, &p->mem, err);
}

mt_status mt_problem_new(const mt_study *study, const mt_run *run, mt_problem **out,
                         mt_err *err)
{
    *out = NULL;
    mt_problem *const p = calloc(1, sizeof *p);
    if (p == NULL) {
        return mt_fail_memory(err);
    }
    p->study = study;
    p->run = mt_run_or_none(run);
    p->n = study->n_variables;
    mt_status rc = mt_arena_init(&p->mem, 0, err);
    rc = rc == MT_OK ? init_references(p, err) : rc;
    rc = rc == MT_OK ? init_variables(p, err) : rc;
    rc = rc == MT_OK ? check_responses(p, err) : rc;
    rc = rc == MT_OK ? init_requirements(p, err) : rc;
    rc = rc == MT_OK ? mt_avoidances_compile(p, err) : rc;
    if (rc == MT_OK) {
        ask_views(p);
    }
    rc = rc == MT_OK ? init_program(p, err) : rc;
    rc = rc == MT_OK ? init_whole(p, err) : rc;
    if (rc != MT_OK) {
        mt_problem_delete(p);
        return rc;
    }
    *out = p;
    return MT_OK;
}

mt_status mt_problem_try(const mt_study *study, mt_err *err)
{
    mt_problem *p = NULL;
    const mt_status rc = mt_problem_new(study, NULL, &p, err);
    mt_problem_delete(p);
    return rc;
}
