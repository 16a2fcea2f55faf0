/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which corners of the tolerances are the worst, and which goals can be judged there. */
#include "tune/robust.h"

#include <math.h>
#include <stdlib.h>

#include "tune/enclosure.h"

static double tolerance_of(const mt_problem *p, int i)
{
    const double percent = p->study->variables[i].tolerance_percent;
    return MT_HAS(percent) ? percent / 100.0 : 0.0;
}

static bool any_tolerance(const mt_problem *p)
{
    for (int i = 0; i < p->n; i++) {
        if (tolerance_of(p, i) > 0.0) {
            return true;
        }
    }
    return false;
}

/* The bounds, wider by the tolerances. A bound of 0 stays where it is; bounds on both sides of 0 would turn the corners over. */
static mt_status widen(const mt_problem *p, double *lower, double *upper, mt_err *err)
{
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        const double tolerance = tolerance_of(p, i);
        if (tolerance > 0.0 && v->lower < 0.0 && v->upper > 0.0) {
            return mt_fail(err, MT_E_INPUT,
                           "/variables/%d/tolerance_percent: a percentage needs bounds on one "
                           "side of 0",
                           i);
        }
        lower[i] = v->lower - (tolerance * fabs(v->lower));
        upper[i] = v->upper + (tolerance * fabs(v->upper));
    }
    return MT_OK;
}

/* Factor of input i where it is low (side -1), high (1) or does not matter (0). */
static double factor_of(const mt_problem *p, int i, int side)
{
    const double sign = p->study->variables[i].upper > 0.0 ? 1.0 : -1.0;
    return 1.0 + (sign * (double)side * tolerance_of(p, i));
}

static mt_status make_corner(mt_problem *p, int view, const double *lower, const double *corner,
                             const double *upper, mt_corner *out, mt_err *err)
{
    bool matters = false;
    double *const factor = mt_arena_f64(&p->mem, (size_t)p->n, 1);
    if (factor == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n; i++) {
        const bool low = corner[i] == lower[i];
        const bool high = corner[i] == upper[i];
        factor[i] = factor_of(p, i, low == high ? 0 : low ? -1 : 1);
        matters = matters || factor[i] != 1.0;
    }
    out->factor = factor;
    if (!matters) {
        return MT_OK;
    }
    return mt_view_analyse(p, &p->views[view], p->original, &out->analysis, err);
}

static mt_status corners_of(mt_problem *p, mt_enclosure *e, int view, double *const *room,
                            mt_err *err)
{
    double *const lower = room[0];
    double *const upper = room[1];
    double *const soft = room[2];
    double *const stiff = room[3];
    char reason[MT_REASON_SIZE] = "";
    mt_corner *const out = p->robust->views[view];
    if (!mt_enclosure_corners(e, p->study->model, p->inputs, lower, upper, soft, stiff,
                              reason)) {
        return mt_fail(err, MT_E_INPUT,
                       "configuration \"%s\" has no worst corner of the tolerances: %s",
                       mt_analysis_configuration(p->views[view].analysis), reason);
    }
    MT_TRY(make_corner(p, view, lower, soft, upper, &out[MT_SOFT], err));
    return make_corner(p, view, lower, stiff, upper, &out[MT_STIFF], err);
}

/* Inputs without a tolerance are no obstacle: only over their bounds must the conditions hold. */
static mt_status init_view(mt_problem *p, int view, mt_err *err)
{
    double *room[4];
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    for (int k = 0; k < 4; k++) {
        room[k] = mt_arena_f64(&p->mem, (size_t)p->n, 1);
        if (room[k] == NULL) {
            return mt_fail_memory(err);
        }
    }
    MT_TRY(widen(p, room[0], room[1], err));
    MT_TRY(mt_enclosure_new(p->views[view].analysis, room[0], room[1], &e, reason, err));
    if (e == NULL) {
        return mt_fail(err, MT_E_INPUT,
                       "configuration \"%s\" has no worst corner of the tolerances: %s",
                       mt_analysis_configuration(p->views[view].analysis), reason);
    }
    for (int i = 0; i < p->n; i++) {
        if (!(tolerance_of(p, i) > 0.0)) {
            room[0][i] = p->study->variables[i].upper; /* one value: any of its bounds */
            room[1][i] = room[0][i];
        }
    }
    const mt_status rc = corners_of(p, e, view, room, err);
    mt_enclosure_delete(e);
    return rc;
}

static mt_status check_demand(const mt_demand *d, mt_err *err)
{
    if (d->row_res >= 0) {
        return MT_OK;
    }
    if (d->row_eq >= 0) {
        return mt_fail(
            err, MT_E_INPUT,
            "/goals/%d: an exact target cannot hold over \"tolerance_percent\": give "
            "a range (at_least_hz, at_most_hz)",
            d->goal_index);
    }
    if (d->goal->type != MT_GOAL_FREQUENCY) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: a MAC has no worst corner of the tolerances", d->goal_index);
    }
    return d->mode > 0 ? MT_OK
                       : mt_fail(err, MT_E_INPUT,
                                 "/goals/%d: with \"tolerance_percent\" a mode is meant by its "
                                 "index: the corners bound the frequencies in their order",
                                 d->goal_index);
}

static mt_status init_views(mt_problem *p, mt_err *err)
{
    int *const wanted = mt_arena_int(&p->mem, (size_t)p->n_views + 1);
    if (wanted == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n_demands; i++) {
        const mt_demand *const d = &p->demands[i];
        if (d->view >= 0) {
            MT_TRY(check_demand(d, err));
            wanted[d->view] = wanted[d->view] || d->row_res < 0;
        }
    }
    for (int i = 0; i < p->n_clears; i++) {
        wanted[p->clears[i].view] = 1;
    }
    for (int i = 0; i < p->n_views; i++) {
        if (wanted[i]) {
            MT_TRY(init_view(p, i, err));
        }
    }
    return MT_OK;
}

/* Signs of an expression's slopes over the bounds decide its corners. */
static mt_status init_limit(mt_problem *p, int demand, const double *dlo, const double *dhi,
                            mt_err *err)
{
    const mt_demand *const d = &p->demands[demand];
    double *factors[2];
    bool matters = false;
    for (int k = 0; k < 2; k++) {
        factors[k] = mt_arena_f64(&p->mem, (size_t)p->n, 1);
        if (factors[k] == NULL) {
            return mt_fail_memory(err);
        }
    }
    for (int i = 0; i < p->n; i++) {
        const double low = dlo[((ptrdiff_t)d->node * p->n) + i];
        const double high = dhi[((ptrdiff_t)d->node * p->n) + i];
        const bool none = !(tolerance_of(p, i) > 0.0) || (low == 0.0 && high == 0.0);
        const int sign = none ? 0 : low >= 0.0 ? 1 : -1;
        if (!none && !(low >= 0.0) && !(high <= 0.0)) {
            return mt_fail(err, MT_E_INPUT,
                           "/goals/%d: the expression is not shown to be monotone in \"%s\", "
                           "which has a tolerance",
                           d->goal_index, p->study->variables[i].parameter_name.s);
        }
        factors[0][i] = factor_of(p, i, -sign);
        factors[1][i] = factor_of(p, i, sign);
        matters = matters || sign != 0;
    }
    if (matters && d->row_res < 0 && d->row_eq >= 0) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: \"equals\" cannot hold over \"tolerance_percent\"",
                       d->goal_index);
    }
    for (int k = 0; k < 2 && matters && d->row_res < 0; k++) {
        p->robust->limits[k][demand] = factors[k];
    }
    return MT_OK;
}

static mt_status init_limits(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    double *const lower = mt_arena_f64(&p->mem, n, 1);
    double *const upper = mt_arena_f64(&p->mem, n, 1);
    double *const lo = mt_arena_f64(&p->mem, count, 1);
    double *const hi = mt_arena_f64(&p->mem, count, 1);
    double *const dlo = mt_arena_f64(&p->mem, count, n);
    double *const dhi = mt_arena_f64(&p->mem, count, n);
    if (lower == NULL || upper == NULL || lo == NULL || hi == NULL || dlo == NULL ||
        dhi == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(widen(p, lower, upper, err));
    mt_program_interval_gradient(&p->program, lower, upper, lo, hi, dlo, dhi);
    for (int i = 0; i < p->n_demands; i++) {
        if (p->demands[i].goal->type == MT_GOAL_LIMIT) {
            MT_TRY(init_limit(p, i, dlo, dhi, err));
        }
    }
    return MT_OK;
}

mt_status mt_robust_init(mt_problem *p, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    if (!any_tolerance(p)) {
        return MT_OK;
    }
    mt_robust *const r = mt_arena_alloc(&p->mem, 1, sizeof *r);
    if (r == NULL) {
        return mt_fail_memory(err);
    }
    *r = (mt_robust){
        .views = mt_arena_alloc(&p->mem, (size_t)p->n_views, sizeof *r->views),
        .limits = {mt_arena_alloc(&p->mem, (size_t)p->n_demands, sizeof(double *)),
                   mt_arena_alloc(&p->mem, (size_t)p->n_demands, sizeof(double *))},
        .x = mt_arena_f64(&p->mem, n, 1),
        .slope = mt_arena_f64(&p->mem, n, 1),
        .value = mt_arena_f64(&p->mem, count, 1),
        .grad = mt_arena_f64(&p->mem, count, n)
    };
    if (r->views == NULL || r->limits[0] == NULL || r->limits[1] == NULL || r->x == NULL ||
        r->slope == NULL || r->value == NULL || r->grad == NULL) {
        return mt_fail_memory(err);
    }
    r->n_views = p->n_views;
    p->robust = r;
    MT_TRY(init_views(p, err));
    return init_limits(p, err);
}

void mt_robust_free(mt_robust *r)
{
    for (int i = 0; r != NULL && i < r->n_views; i++) {
        mt_analysis_delete(r->views[i][MT_SOFT].analysis);
        mt_analysis_delete(r->views[i][MT_STIFF].analysis);
    }
}
