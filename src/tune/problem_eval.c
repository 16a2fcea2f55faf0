/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One evaluation of a problem. Frequencies enter as logarithms, so that a violation is a relative error:
 *     target:   eq = ln(f / f_target),             d eq / dt = lambda' / (2 lambda) dx/dt
 *     limits:   in = ln(f / f_least), ln(f_most / f)
 *     shape:    r  = sqrt(w) (s / |s| - sign s_ref),  sign = sign(s . s_ref)
 *     mac:      in = mac - at_least
 *     limit:    in = (g - at_least) / scale, ...,  scale = |limit| or 1
 */
#include <math.h>
#include <string.h>

#include "tune/problem.h"

/* Largest correlation wins, one to one: rows are the named modes, columns the flexible modes of the present design. */
static mt_status assign_named(mt_view *view, int *pair, mt_err *err)
{
    mt_analysis *const a = view->analysis;
    const ptrdiff_t n = a->lin->n;
    const size_t nq = (size_t)a->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const score = mt_arena_f64(&a->mem, (size_t)view->n_named, (size_t)a->modes.count);
    double *const phi = mt_arena_f64(&a->mem, nq, 1);
    if (score == NULL || phi == NULL) {
        return mt_fail_memory(err);
    }
    for (int c = 0; c < a->modes.count; c++) {
        mt_linear_expand(a->lin, 1, a->modes.y + (c * n), phi);
        for (int r = 0; r < view->n_named; r++) {
            const double w = mt_dot((int)nq, view->named[r].w, phi);
            score[r + ((ptrdiff_t)c * view->n_named)] =
                a->modes.kind[c] == MT_MODE_FLEXIBLE ? w * w : -1.0;
        }
    }
    const mt_status rc = mt_assign(view->n_named, a->modes.count, score, pair, &a->mem, err);
    mt_arena_rewind(&a->mem, mark);
    return rc;
}

int mt_view_position(mt_view *view, int mode, int named, mt_err *err)
{
    mt_analysis *const a = view->analysis;
    if (mode > 0) {
        return mt_modal_flexible(&a->modes, mode);
    }
    if (a->modes.n_unstable > 0 || a->modes.y == NULL) {
        return -1;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    int *const pair = mt_arena_int(&a->mem, (size_t)view->n_named);
    int pos = -1;
    if (pair != NULL && assign_named(view, pair, err) == MT_OK) {
        pos = pair[named];
    }
    mt_arena_rewind(&a->mem, mark);
    return pos;
}

/* dx_i/dt_i. */
static double stretch(const mt_problem *p, int i)
{
    return MT_HAS(p->scale[i]) ? p->scale[i] : p->x[i];
}

/* lambda'/(2 lambda) for all variables, chained to t. A repeated mode: the mean of its cluster, which is smooth where the single modes are not. */
static mt_status dln_frequency(mt_problem *p, mt_analysis *a, int pos, double *out, mt_err *err)
{
    int size = 1;
    const int first = mt_modal_cluster(&a->modes, pos, &size);
    memset(out, 0, (size_t)p->n * sizeof *out);
    for (int k = first; k < first + size; k++) {
        MT_TRY(mt_analysis_dlambda_raw(a, k, p->dlambda, err));
        mt_axpy(p->n, 1.0 / (double)size, p->dlambda, out);
    }
    for (int i = 0; i < p->n; i++) {
        out[i] *= stretch(p, i) / (2.0 * a->modes.lambda[pos]);
    }
    return MT_OK;
}

static void put(double *matrix, int rows, int row, int n, double factor, const double *gradient)
{
    for (int i = 0; i < n; i++) {
        matrix[row + ((ptrdiff_t)i * rows)] = factor * gradient[i];
    }
}

/* A scalar relative quantity v (ln of a ratio, mac, scaled expression) against its demand. */
typedef struct scalar {
    double to_target; /* eq, or residual before the weight */
    double above;     /* in, at_least */
    double below;     /* in, at_most */
    double
        slope[2]; /* derivative of to_target/above per unit of gradient; of below (negative) */
} scalar;

static void store_scalar(const mt_problem *p, const mt_demand *d, const scalar *v,
                         const double *gradient, mt_nlp_values *out)
{
    const mt_goal *const g = d->goal;
    if (d->row_res >= 0) {
        const double w = sqrt(g->weight);
        out->r[d->row_res] = w * v->to_target;
        if (gradient != NULL) {
            put(out->dr, p->n_res, d->row_res, p->n, w * v->slope[0], gradient);
        }
        return;
    }
    if (d->row_eq >= 0) {
        out->eq[d->row_eq] = v->to_target;
        if (gradient != NULL) {
            put(out->deq, p->n_eq, d->row_eq, p->n, v->slope[0], gradient);
        }
        return;
    }
    int row = d->row_in;
    if (MT_HAS(g->at_least)) {
        out->in[row] = v->above;
        if (gradient != NULL) {
            put(out->din, p->n_in, row, p->n, v->slope[0], gradient);
        }
        row++;
    }
    if (MT_HAS(g->at_most)) {
        out->in[row] = v->below;
        if (gradient != NULL) {
            put(out->din, p->n_in, row, p->n, -v->slope[1], gradient);
        }
    }
}

static mt_status frequency_demand(mt_problem *p, const mt_demand *d, mt_analysis *a, int pos,
                                  bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    const double hz = mt_modal_hz(&a->modes, pos);
    double *const gradient = with_gradient ? p->dshape : NULL; /* n numbers of work */
    const scalar v = {
        .to_target = log(hz / d->target_hz),
        .above = log(hz / d->goal->at_least),
        .below = log(d->goal->at_most / hz),
        .slope = {1.0, 1.0}
    };
    if (!(hz > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "mode %d has no frequency", d->mode);
    }
    if (with_gradient) {
        MT_TRY(dln_frequency(p, a, pos, gradient, err));
    }
    store_scalar(p, d, &v, gradient, out);
    return MT_OK;
}

/* u = s/|s|; r = sqrt(w) (sign u - ref); dr = sqrt(w) sign (ds - u (u . ds))/|s|. */
static mt_status shape_demand(mt_problem *p, const mt_demand *d, mt_analysis *a, int pos,
                              bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    const int ns = d->shape.ns;
    MT_TRY(mt_analysis_shape(a, pos, ns, d->shape.channel, p->shape,
                             with_gradient ? p->dshape : NULL, err));
    const double norm = mt_norm2(ns, p->shape);
    if (!(norm > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "mode %d does not move at the sensors of reference \"%s\"", d->mode,
                       d->shape.reference);
    }
    const double w =
        (mt_dot(ns, p->shape, d->shape.shape) < 0.0 ? -1.0 : 1.0) * sqrt(d->goal->weight);
    for (int i = 0; i < ns; i++) {
        p->shape[i] /= norm;
        out->r[d->row_res + i] =
            (w * p->shape[i]) - (sqrt(d->goal->weight) * d->shape.shape[i]);
    }
    for (int k = 0; k < p->n && with_gradient; k++) {
        const double *const ds = p->dshape + ((ptrdiff_t)k * ns);
        const double along = mt_dot(ns, p->shape, ds);
        for (int i = 0; i < ns; i++) {
            out->dr[d->row_res + i + ((ptrdiff_t)k * p->n_res)] =
                w * stretch(p, k) * (ds[i] - (along * p->shape[i])) / norm;
        }
    }
    return MT_OK;
}

static mt_status mac_demand(mt_problem *p, const mt_demand *d, mt_analysis *a, int pos,
                            bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    const int ns = d->shape.ns;
    double mac = 0.0;
    MT_TRY(mt_analysis_shape(a, pos, ns, d->shape.channel, p->shape,
                             with_gradient ? p->dshape : NULL, err));
    mt_mac_matrix(ns, 1, p->shape, 1, d->shape.shape, &mac);
    for (int k = 0; k < p->n && with_gradient; k++) {
        p->dlambda[k] =
            stretch(p, k) *
            mt_mac_derivative(ns, p->shape, p->dshape + ((ptrdiff_t)k * ns), d->shape.shape);
    }
    const scalar v = {
        .to_target = mac - d->goal->at_least,
        .above = mac - d->goal->at_least,
        .below = d->goal->at_most - mac,
        .slope = {1.0, 1.0}
    };
    store_scalar(p, d, &v, with_gradient ? p->dlambda : NULL, out);
    return MT_OK;
}

static double unit_of(double limit)
{
    return fabs(limit) > 0.0 ? fabs(limit) : 1.0;
}

static void limit_demand(mt_problem *p, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out)
{
    const mt_goal *const g = d->goal;
    const double value = p->value[d->node];
    const double reference = MT_HAS(g->equals) ? g->equals : g->at_least;
    const scalar v = {
        .to_target = (value - g->equals) / unit_of(g->equals),
        .above = (value - g->at_least) / unit_of(g->at_least),
        .below = (g->at_most - value) / unit_of(g->at_most),
        .slope = {1.0 / unit_of(reference), 1.0 / unit_of(g->at_most)}
    };
    for (int k = 0; k < p->n && with_gradient; k++) {
        p->dlambda[k] = stretch(p, k) * p->grad[((ptrdiff_t)d->node * p->n) + k];
    }
    store_scalar(p, d, &v, with_gradient ? p->dlambda : NULL, out);
}

mt_status mt_demand_eval(mt_problem *p, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, mt_err *err)
{
    if (d->goal->type == MT_GOAL_LIMIT) {
        limit_demand(p, d, with_gradient, out);
        return MT_OK;
    }
    mt_view *const view = &p->views[d->view];
    const int pos = mt_view_position(view, d->mode, d->named, err);
    if (pos < 0) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no such vibration mode here",
                       mt_analysis_configuration(view->analysis));
    }
    switch (d->goal->type) {
    case MT_GOAL_FREQUENCY:
        return frequency_demand(p, d, view->analysis, pos, with_gradient, out, err);
    case MT_GOAL_SHAPE:
        return shape_demand(p, d, view->analysis, pos, with_gradient, out, err);
    case MT_GOAL_MAC:
        return mac_demand(p, d, view->analysis, pos, with_gradient, out, err);
    case MT_GOAL_LIMIT:
    case MT_GOAL_AVOID:
    case MT_GOAL_TYPE_COUNT:
        break;
    }
    return mt_fail(err, MT_E_INTERNAL, "goal %d has no evaluation", d->goal_index);
}

static void objective_value(mt_problem *p, const double *t, bool with_gradient,
                            mt_nlp_values *out)
{
    const mt_linear *const lin = p->n_views > 0 ? p->views[0].analysis->lin : NULL;
    out->f = 0.0;
    for (int i = 0; i < p->n && with_gradient; i++) {
        out->df[i] = 0.0;
    }
    if (p->objective == MT_OBJECTIVE_CHANGE) {
        for (int i = 0; i < p->n; i++) {
            const double w = p->study->variables[i].weight;
            const double d = t[i] - p->origin_t[i];
            out->f += 0.5 * w * d * d;
            if (with_gradient) {
                out->df[i] = w * d;
            }
        }
    } else if (p->objective == MT_OBJECTIVE_EXPRESSION) {
        out->f = p->value[p->objective_node];
        for (int i = 0; i < p->n && with_gradient; i++) {
            out->df[i] = stretch(p, i) * p->grad[((ptrdiff_t)p->objective_node * p->n) + i];
        }
    } else if (p->objective == MT_OBJECTIVE_MASS) {
        for (int k = 0; k < p->n_mass; k++) {
            out->f += lin->value[p->mass[k]];
            for (int i = 0; i < p->n && with_gradient; i++) {
                out->df[i] += stretch(p, i) * lin->grad[((ptrdiff_t)p->mass[k] * p->n) + i];
            }
        }
    }
}

mt_status mt_problem_eval(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    mt_problem *const p = context;
    if (p->stop != NULL && *p->stop != 0) {
        return mt_fail(err, MT_E_INTERRUPTED, "interrupted");
    }
    p->evaluations++;
    mt_problem_x(p, t, p->x);
    MT_TRY(with_gradient ? mt_program_gradient(&p->program, p->x, p->value, p->grad, NULL, err)
                         : mt_program_eval(&p->program, p->x, p->value, NULL, err));
    for (int i = 0; i < p->n_views; i++) {
        const mt_analysis_options opt = {.gradient = with_gradient,
                                         .vectors = with_gradient || p->views[i].needs_vectors,
                                         .accuracy = true,
                                         .check = false};
        MT_TRY(mt_analysis_solve(p->views[i].analysis, p->x, &opt, err));
    }
    for (int i = 0; i < p->n_demands; i++) {
        MT_TRY(mt_demand_eval(p, &p->demands[i], with_gradient, out, err));
    }
    objective_value(p, t, with_gradient, out);
    return MT_OK;
}
