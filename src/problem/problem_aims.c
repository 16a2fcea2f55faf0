/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Expressions and objectives. What an objective is worth at a design:
 *     change:      f = 1/2 sum w_i (t_i - t_i(original))^2,
 *         df/dt_i = w_i (t_i - t_i(original))
 *     mass:        f = sum of the masses of the items named
 *     expression:  f = the expression
 *     misfit:      f = 1/2 |r|^2,                              df/dt = dr^T r
 * The squares, not their roots: those have no derivative where the search is to end.
 */
#include <math.h>

#include "base/text.h"
#include "model/values.h"
#include "problem/problem.h"

/* An objective is held within this part of its value (of 1 kg or one unit of the expression
 * where it is below that). */
static const double HELD = 1e-6;
/* The same for the objectives that are half a square, of the root where it is below 1: a change
 * or a misfit of 1e-6 is none to an engineer. */
static const double HELD_ROOT = 1e-6;
/* A held objective may leave its limit by this part of what it was given above its optimum: the
 * optimum itself stays well inside. */
static const double HELD_TOLERANCE = 0.01;

/* Limits, objectives and published quantities as one program of the variables. */
static mt_status init_program(mt_problem *p, mt_err *err)
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
        mt_demand *const d = &p->demands[i];
        if (d->quantity == MT_QUANTITY_EXPRESSION) {
            d->node = mt_program_expr(&p->program, &d->goal->expression, nodes, d->goal->addr);
        }
    }
    for (int i = 0; i < p->n_aims; i++) {
        mt_aim *const a = &p->aims[i];
        if (a->type == MT_OBJECTIVE_EXPRESSION) {
            a->node = mt_program_expr(&p->program, &a->objective->expression, nodes,
                                      a->objective->addr);
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
static mt_status init_mass(mt_problem *p, mt_aim *a, mt_err *err)
{
    int view = 0;
    if (p->n_views == 0) {
        MT_TRY(mt_problem_add_view(p, 0, &view, err));
    }
    const mt_system *const sys = p->views[view].analysis->sys;
    a->mass = mt_arena_alloc(&p->mem, (size_t)sys->n_items, sizeof *a->mass);
    if (a->mass == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < sys->n_items; i++) {
        if (sys->items[i].mass != MT_NO_NODE && counted(a->objective, sys->items[i].name)) {
            a->mass[a->n_mass++] = sys->items[i].mass;
        }
    }
    if (a->n_mass == 0) {
        return mt_fail(err, MT_E_INPUT,
                       "objective \"mass\": nothing that is meant is part of configuration "
                       "\"%s\", the first that a goal names",
                       mt_analysis_configuration(p->views[view].analysis));
    }
    return MT_OK;
}

mt_status mt_problem_init_aims(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    p->n_aims = s->n_objectives > 0 ? s->n_objectives : 1;
    p->aims = mt_arena_alloc(&p->mem, (size_t)p->n_aims, sizeof *p->aims);
    if (p->aims == NULL) {
        return mt_fail_memory(err);
    }
    p->aims[0] = (mt_aim){.type = MT_OBJECTIVE_NONE, .node = MT_NO_NODE};
    for (int i = 0; i < s->n_objectives; i++) {
        p->aims[i] = (mt_aim){
            .type = s->objectives[i].type, .objective = &s->objectives[i], .node = MT_NO_NODE};
        if (p->aims[i].type == MT_OBJECTIVE_MASS) {
            MT_TRY(init_mass(p, &p->aims[i], err));
        }
    }
    return init_program(p, err);
}

static double change_value(const mt_problem *p, double *gradient)
{
    double f = 0.0;
    for (int i = 0; i < p->n; i++) {
        const double w = p->study->variables[i].weight;
        const double d = p->t[i] - p->origin_t[i];
        f += 0.5 * w * d * d;
        if (gradient != NULL) {
            gradient[i] = w * d;
        }
    }
    return f;
}

static double mass_value(const mt_problem *p, const mt_aim *a, double *gradient)
{
    const mt_linear *const lin = p->views[0].analysis->lin;
    double f = 0.0;
    for (int k = 0; k < a->n_mass; k++) {
        f += lin->value[a->mass[k]];
        for (int i = 0; i < p->n && gradient != NULL; i++) {
            gradient[i] +=
                mt_problem_stretch(p, i) * lin->grad[((ptrdiff_t)a->mass[k] * p->n) + i];
        }
    }
    return f;
}

static double expression_value(const mt_problem *p, const mt_aim *a, double *gradient)
{
    for (int i = 0; i < p->n && gradient != NULL; i++) {
        gradient[i] = mt_problem_stretch(p, i) * p->grad[((ptrdiff_t)a->node * p->n) + i];
    }
    return p->value[a->node];
}

static double misfit_value(const mt_problem *p, double *gradient)
{
    for (int i = 0; i < p->n && gradient != NULL; i++) {
        gradient[i] = mt_dot(p->n_res, p->dr + ((ptrdiff_t)i * p->n_res), p->r);
    }
    return 0.5 * mt_dot(p->n_res, p->r, p->r);
}

double mt_aim_value(const mt_problem *p, int k, double *gradient)
{
    const mt_aim *const a = &p->aims[k];
    for (int i = 0; i < p->n_t && gradient != NULL; i++) {
        gradient[i] = 0.0;
    }
    switch (a->type) {
    case MT_OBJECTIVE_CHANGE:
        return change_value(p, gradient);
    case MT_OBJECTIVE_MASS:
        return mass_value(p, a, gradient);
    case MT_OBJECTIVE_EXPRESSION:
        return expression_value(p, a, gradient);
    case MT_OBJECTIVE_MISFIT:
        return misfit_value(p, gradient);
    case MT_OBJECTIVE_CLEARANCE:
        if (p->clearance && gradient != NULL) {
            gradient[p->n] = -1.0;
        }
        return p->clearance ? -p->t[p->n] : 0.0;
    case MT_OBJECTIVE_NONE:
        break;
    }
    return 0.0;
}

/* Row of `in` that holds objective k: a misfit among those before it has none. */
static int held_row(const mt_problem *p, int k)
{
    int row = p->n_in;
    for (int i = 0; i < k; i++) {
        row += p->aims[i].type == MT_OBJECTIVE_MISFIT ? 0 : 1;
    }
    return row;
}

void mt_aim_hold(mt_problem *p, int k, double f)
{
    mt_aim *const a = &p->aims[k];
    const double root = sqrt(2.0 * fmax(f, 0.0));
    if (a->type == MT_OBJECTIVE_MISFIT) {
        for (int i = 0; i < p->n_res; i++) {
            p->r_held[i] = p->r[i];
            p->eq_tol[p->n_eq + i] = HELD_ROOT * fmax(root, 1.0);
        }
        return;
    }
    if (a->type == MT_OBJECTIVE_CHANGE) {
        const double most = root + (HELD_ROOT * fmax(root, 1.0));
        a->limit = 0.5 * most * most;
        a->unit = a->limit;
    } else {
        a->unit = fmax(fabs(f), 1.0);
        a->limit = f + (HELD * a->unit);
    }
    p->in_tol[held_row(p, k)] = HELD_TOLERANCE * (a->limit - f) / a->unit;
}

/* r - r_held = 0 */
static void hold_misfit(const mt_problem *p, bool with_gradient, mt_nlp_values *out)
{
    const ptrdiff_t rows = mt_problem_rows_eq(p);
    for (int i = 0; i < p->n_res; i++) {
        const ptrdiff_t row = p->n_eq + i;
        out->eq[row] = p->r[i] - p->r_held[i];
        for (int j = 0; j < p->n_t && with_gradient; j++) {
            out->deq[row + (j * rows)] = j < p->n ? p->dr[i + ((ptrdiff_t)j * p->n_res)] : 0.0;
        }
    }
}

void mt_aim_hold_rows(mt_problem *p, bool with_gradient, mt_nlp_values *out)
{
    const ptrdiff_t rows = mt_problem_rows_in(p);
    for (int k = 0; k < p->stage; k++) {
        const mt_aim *const a = &p->aims[k];
        if (a->type == MT_OBJECTIVE_MISFIT) {
            hold_misfit(p, with_gradient, out);
            continue;
        }
        const ptrdiff_t row = held_row(p, k);
        out->in[row] =
            (a->limit - mt_aim_value(p, k, with_gradient ? p->work : NULL)) / a->unit;
        for (int j = 0; j < p->n_t && with_gradient; j++) {
            out->din[row + (j * rows)] = -p->work[j] / a->unit;
        }
    }
}
