/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One demand. Frequencies enter as logarithms, so that a violation is a relative error:
 *     target:   eq = ln(f / f_target),             d eq / dt = lambda' / (2 lambda) dx/dt
 *     limits:   in = ln(f / f_least), ln(f_most / f)
 *     shape:    r  = sqrt(w) (sign u - s_ref),     u = s / |s|, sign = sign(s . s_ref)
 *     mac:      in = mac - at_least, at_most - mac
 *     limit:    in = (g - at_least) / |at_least|, ..., eq = (g - equals) / |equals|
 *         (divided by 1 where the number is 0)
 */
#include <math.h>
#include <string.h>

#include "problem/problem.h"
#include "prove/enclosure.h"

/* No floor lies lower: the square of an angular frequency would leave the range of a double. */
static const double LEAST_FLOOR_HZ = 1e-150;

double mt_problem_ln_ratio(const mt_modes *modes, int pos, double edge_hz, double floor_hz)
{
    if (pos < 0) {
        return MT_MOST_INSIDE;
    }
    const double hz = mt_modal_hz(modes, pos);
    const double floor = fmax(floor_hz, LEAST_FLOOR_HZ);
    const double part = hz / floor;
    return part < 1.0 ? log(floor / edge_hz) + (0.5 * ((part * part) - 1.0))
                      : log(hz / edge_hz);
}

mt_status mt_problem_dln_frequency(mt_problem *p, mt_analysis *a, int pos, double floor_hz,
                                   double *out, mt_err *err)
{
    int size = 1;
    int vibrating = 0;
    const mt_modes *const modes = &a->modes;
    memset(out, 0, (size_t)p->n * sizeof *out);
    if (pos < 0) {
        return MT_OK;
    }
    const int first = mt_modal_cluster(modes, pos, &size);
    const double lambda =
        fmax(modes->lambda[pos], mt_enclosure_lambda(fmax(floor_hz, LEAST_FLOOR_HZ)));
    for (int k = first; k < first + size; k++) {
        MT_TRY(mt_analysis_dlambda_raw(a, k, p->work, err));
        mt_axpy(p->n, 1.0, p->work, out);
        /* vibrations of 0 Hz share their cluster with rigid-body modes, which have no slope and
         * add nothing to the sum */
        vibrating += modes->kind[k] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    for (int i = 0; i < p->n && vibrating > 0; i++) {
        out[i] *= mt_problem_stretch(p, i) / (2.0 * lambda * (double)vibrating);
    }
    return MT_OK;
}

static void put(const mt_problem *p, double *matrix, int rows, int row, double factor,
                const double *gradient)
{
    const int n = p->n;
    if (gradient != NULL && p->n_t > n && matrix != p->dr) {
        /* the clearance enters no goal but the bands */
        matrix[row + ((ptrdiff_t)n * rows)] = 0.0;
    }
    for (int i = 0; i < n && gradient != NULL; i++) {
        matrix[row + ((ptrdiff_t)i * rows)] = factor * gradient[i];
    }
}

/* A scalar quantity q against its demand; values relative, slopes per unit of dq. */
typedef struct scalar {
    double to_target; /* eq, or the residual before its weight */
    double above;     /* in, at_least */
    double below;     /* in, at_most */
    double target_slope;
    double above_slope;
    double below_slope;
} scalar;

/* gradient: dq/dt, NULL where none is wanted. */
static void store_scalar(mt_problem *p, const mt_demand *d, const scalar *v,
                         const double *gradient, mt_nlp_values *out)
{
    const mt_goal *const g = d->goal;
    if (d->row_res >= 0) {
        const double w = sqrt(d->weight);
        p->r[d->row_res] = w * v->to_target;
        put(p, p->dr, p->n_res, d->row_res, w * v->target_slope, gradient);
        return;
    }
    if (d->row_eq >= 0) {
        out->eq[d->row_eq] = v->to_target;
        put(p, out->deq, mt_problem_rows_eq(p), d->row_eq, v->target_slope, gradient);
        return;
    }
    const int rows = mt_problem_rows_in(p);
    int row = d->row_in;
    if (MT_HAS(g->at_least)) {
        out->in[row] = v->above;
        put(p, out->din, rows, row++, v->above_slope, gradient);
    }
    if (MT_HAS(g->at_most)) {
        out->in[row] = v->below;
        put(p, out->din, rows, row, v->below_slope, gradient);
    }
}

static mt_status frequency_demand(mt_problem *p, const mt_demand *d, int pos,
                                  bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    mt_analysis *const a = p->views[d->view].analysis;
    const mt_goal *const g = d->goal;
    const double edge = fmin(fmin(d->equals, g->at_least), g->at_most); /* of those given */
    const double floor = MT_FREQUENCY_FLOOR * edge;
    double *const gradient = with_gradient ? p->dshape : NULL; /* n numbers of it */
    if (pos >= 0 && !(mt_modal_hz(&a->modes, pos) >= 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": the mode has no frequency",
                       mt_analysis_configuration(a));
    }
    if (with_gradient) {
        MT_TRY(mt_problem_dln_frequency(p, a, pos, floor, gradient, err));
    }
    const scalar v = {.to_target = mt_problem_ln_ratio(&a->modes, pos, d->equals, floor),
                      .above = mt_problem_ln_ratio(&a->modes, pos, g->at_least, floor),
                      .below = -mt_problem_ln_ratio(&a->modes, pos, g->at_most, floor),
                      .target_slope = 1.0,
                      .above_slope = 1.0,
                      .below_slope = -1.0};
    store_scalar(p, d, &v, gradient, out);
    return MT_OK;
}

/* Shape at the demand's channels into shape (and dshape); it must move there. */
static mt_status sense(mt_problem *p, const mt_demand *d, int pos, bool with_gradient,
                       double *norm, mt_err *err)
{
    mt_analysis *const a = p->views[d->view].analysis;
    MT_TRY(mt_analysis_shape(a, pos, d->shape.ns, d->shape.channel, p->shape,
                             with_gradient ? p->dshape : NULL, err));
    *norm = mt_norm2(d->shape.ns, p->shape);
    if (!(*norm > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\": the mode does not move at the sensors of "
                       "reference \"%s\"",
                       mt_analysis_configuration(a), d->shape.reference);
    }
    return MT_OK;
}

/* dr = sqrt(w) sign (ds - u (u . ds)) / |s|. */
static mt_status shape_demand(mt_problem *p, const mt_demand *d, int pos, bool with_gradient,
                              mt_err *err)
{
    const int ns = d->shape.ns;
    const double w = sqrt(d->weight);
    double *const u = p->shape;
    double norm = 0.0;
    MT_TRY(sense(p, d, pos, with_gradient, &norm, err));
    const double sign = mt_dot(ns, u, d->shape.shape) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < ns; i++) {
        u[i] /= norm;
        p->r[d->row_res + i] = w * ((sign * u[i]) - d->shape.shape[i]);
    }
    for (int k = 0; k < p->n && with_gradient; k++) {
        const double *const ds = p->dshape + ((ptrdiff_t)k * ns);
        const double along = mt_dot(ns, u, ds);
        const double factor = w * sign * mt_problem_stretch(p, k) / norm;
        for (int i = 0; i < ns; i++) {
            p->dr[d->row_res + i + ((ptrdiff_t)k * p->n_res)] =
                factor * (ds[i] - (along * u[i]));
        }
    }
    return MT_OK;
}

static mt_status mac_demand(mt_problem *p, const mt_demand *d, int pos, bool with_gradient,
                            mt_nlp_values *out, mt_err *err)
{
    const int ns = d->shape.ns;
    double norm = 0.0;
    double mac = 0.0;
    MT_TRY(sense(p, d, pos, with_gradient, &norm, err));
    mt_mac_matrix(ns, 1, p->shape, 1, d->shape.shape, &mac);
    for (int k = 0; k < p->n && with_gradient; k++) {
        const double *const ds = p->dshape + ((ptrdiff_t)k * ns);
        p->work[k] =
            mt_problem_stretch(p, k) * mt_mac_derivative(ns, p->shape, ds, d->shape.shape);
    }
    const scalar v = {.to_target = nan(""),
                      .above = mac - d->goal->at_least,
                      .below = d->goal->at_most - mac,
                      .above_slope = 1.0,
                      .below_slope = -1.0};
    store_scalar(p, d, &v, with_gradient ? p->work : NULL, out);
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
    const scalar v = {.to_target = (value - d->equals) / unit_of(d->equals),
                      .above = (value - g->at_least) / unit_of(g->at_least),
                      .below = (g->at_most - value) / unit_of(g->at_most),
                      .target_slope = 1.0 / unit_of(d->equals),
                      .above_slope = 1.0 / unit_of(g->at_least),
                      .below_slope = -1.0 / unit_of(g->at_most)};
    for (int k = 0; k < p->n && with_gradient; k++) {
        p->work[k] = mt_problem_stretch(p, k) * p->grad[((ptrdiff_t)d->node * p->n) + k];
    }
    store_scalar(p, d, &v, with_gradient ? p->work : NULL, out);
}

static mt_status no_mode(const mt_problem *p, const mt_demand *d, mt_err *err)
{
    const mt_analysis *const a = p->views[d->view].analysis;
    const char *const why =
        a->modes.n_unstable > 0 ? "is unstable, so that its modes have no index"
        : a->modes.n_undecided > 0
            ? "has a mode of which rounding hides whether it is stable, so that its modes have "
              "no index"
            : "has no such vibration mode here";
    return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" %s", mt_analysis_configuration(a),
                   why);
}

mt_status mt_demand_eval(mt_problem *p, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, mt_err *err)
{
    int pos = -1;
    if (d->goal->type == MT_GOAL_LIMIT) {
        limit_demand(p, d, with_gradient, out);
        return MT_OK;
    }
    MT_TRY(mt_view_position(p, &p->views[d->view], d->mode, d->named, &pos, err));
    const mt_view *const view = &p->views[d->view];
    const bool infinite = d->goal->type == MT_GOAL_FREQUENCY && view->solved &&
                          mt_analysis_is_infinite(view->analysis, d->mode);
    if (pos < 0 && !infinite) {
        return no_mode(p, d, err);
    }
    switch (d->goal->type) {
    case MT_GOAL_FREQUENCY:
        return frequency_demand(p, d, pos, with_gradient, out, err);
    case MT_GOAL_SHAPE:
        return shape_demand(p, d, pos, with_gradient, err);
    case MT_GOAL_MAC:
        return mac_demand(p, d, pos, with_gradient, out, err);
    case MT_GOAL_LIMIT:
    case MT_GOAL_AVOID:
    case MT_GOAL_TYPE_COUNT:
        break;
    }
    return mt_fail(err, MT_E_INTERNAL, "goal %d has no evaluation", d->goal_index);
}
