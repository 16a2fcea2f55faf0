/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Goals of one mode, and of an expression. With q of a kind:
 *
 * "frequency": the frequency of a mode [Hz], its rows in ln q,
 *     d ln q / dt = lambda' / (2 lambda) dx/dt
 * "damping": the damping ratio of a complex mode, zeta = -sigma/|s| of s = sigma + i omega,
 *     dzeta = omega (sigma domega - omega dsigma) / |s|^3
 *   An index counts the oscillating motions by |s|; a name means the one that has most of the
 *   undamped mode in its shape.
 * "limit": an expression of parameters; q = its value.
 * "shape": residuals of the unit shape at the sensors against that of a reference,
 *     r = sqrt(w) (sign u - s_ref),   u = s / |s|,   sign = sign(s . s_ref)
 *     dr = sqrt(w) sign (ds - u (u . ds)) / |s|
 * "mac": MAC of the mode's shape at the sensors with that of a reference.
 */

#include "problem/goals.h"

#include <math.h>

#include "analysis/damping.h"
#include "analysis/tracking.h"
#include "problem/frequency.h"
#include "problem/requirement.h"
#include "prove/box.h"

/* Index of the reference's mode that the requirement names; by default its own index. */
static int reference_mode(const mt_problem *p, const mt_requirement *d)
{
    const mt_goal *const g = d->goal;
    const int own = d->mode > 0 ? d->mode : p->study->model->modes[g->mode.named].index;
    return g->reference_mode > 0 ? g->reference_mode : own;
}

/* Finds the reference's shape. */
static mt_status compile_reference_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_system *const sys = p->views[d->view].original->sys;
    return d->goal->reference_name.s == NULL
               ? MT_OK
               : mt_reference_shape_init(p->references, d->goal->reference,
                                         reference_mode(p, d), sys, d->goal->length, &p->mem,
                                         &d->shape, err);
}

/* Shape of the mode at pos at the requirement's sensors, in w->shape (and w->dshape), and its
 * norm. Fails: MT_E_DOMAIN where the mode does not move there. */
static mt_status sense_shape(mt_workspace *w, const mt_requirement *d, int pos,
                             bool with_gradient, double *norm, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    MT_TRY(mt_analysis_shape(a, pos, d->shape.ns, d->shape.channel, w->shape,
                             with_gradient ? w->dshape : NULL, err));
    mt_reference_scale(&d->shape, 1, w->shape);
    mt_reference_scale(&d->shape, with_gradient ? w->p->n : 0, w->dshape);
    *norm = mt_norm2(d->shape.ns, w->shape);
    if (!(*norm > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\": the mode does not move at the sensors of "
                       "reference \"%s\"",
                       mt_analysis_configuration(a), d->shape.reference);
    }
    return MT_OK;
}

/* The same of a named mode: in a cluster by the vector of its own. */
static mt_status dln_named(mt_workspace *w, const mt_requirement *d, int pos, double *out,
                           mt_err *err)
{
    const mt_configuration_work *const view = &w->views[d->view];
    mt_analysis *const a = view->analysis;
    int size = 1;
    const double lambda = pos < 0 ? 0.0 : a->modes.lambda[pos];
    bool own = pos >= 0 && d->named >= 0 && lambda > mt_enclosure_lambda(d->floor_hz);
    if (own) {
        (void)mt_modal_cluster(&a->modes, pos, &size);
        own = size > 1;
    }
    if (own) {
        MT_TRY(mt_track_dlambda(a, view->of->shape[d->named], pos, out, &own, err));
    }
    for (int i = 0; i < w->p->n && own; i++) {
        out[i] *= mt_workspace_dx_dt(w, i) / (2.0 * lambda);
    }
    return own ? MT_OK : mt_problem_dln_frequency(w, a, pos, d->floor_hz, out, err);
}

/* The reference's frequency is the target. */
static mt_status compile_frequency(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_goal *const g = d->goal;
    if (g->reference_name.s != NULL) {
        MT_TRY(mt_reference_frequency_init(p->references, g->reference, reference_mode(p, d),
                                           &d->shape, err));
        d->equals = d->shape.frequency_hz;
    }
    d->floor_hz = MT_FREQUENCY_FLOOR * fmin(fmin(d->equals, g->at_least), g->at_most);
    return MT_OK;
}

static mt_status evaluate_frequency(mt_workspace *w, const mt_requirement *d, int pos,
                                    double *q, double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    *q = pos < 0 ? HUGE_VAL : mt_modal_hz(&a->modes, pos);
    if (!(*q >= 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": the mode has no frequency",
                       mt_analysis_configuration(a));
    }
    return slope == NULL ? MT_OK : dln_named(w, d, pos, slope, err);
}

const mt_goal_ops mt_goal_frequency = {.quantity = MT_QUANTITY_FREQUENCY,
                                       .compile = compile_frequency,
                                       .value = evaluate_frequency,
                                       .number = "frequency",
                                       .equals = "at"};

static mt_status find_damped_mode(mt_workspace *w, const mt_requirement *d, int pos, int *at,
                                  mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *at = mt_damped_oscillating(damped, d->mode > 0 ? d->mode : 1);
    if (d->mode == 0 && *at >= 0) {
        MT_TRY(mt_analysis_damped_of(a, pos, at, err));
    }
    return *at >= 0 ? MT_OK
                    : mt_fail(err, MT_E_DOMAIN,
                              "configuration \"%s\" has no such motion that oscillates: it is "
                              "overdamped, or another is unstable",
                              mt_analysis_configuration(a));
}

static mt_status evaluate_damping(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                  double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    bool repeated = false;
    int at = -1;
    MT_TRY(find_damped_mode(w, d, pos, &at, err));
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *q = mt_damped_ratio(damped, at);
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_analysis_dpole(a, at, slope, w->work, &repeated, err));
    if (repeated) {
        return mt_fail(err, MT_E_SINGULAR,
                       "configuration \"%s\": two motions have one root, which has no slope",
                       mt_analysis_configuration(a));
    }
    const double re = damped->re[at];
    const double im = damped->im[at];
    const double size = hypot(re, im);
    for (int k = 0; k < w->p->n; k++) {
        const double turn = ((re / size) * w->work[k]) - ((im / size) * slope[k]);
        slope[k] = mt_workspace_dx_dt(w, k) * (im / size) * turn / size;
    }
    return MT_OK;
}

static const char *damping_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    (void)d;
    return mt_arena_printf(mem, "%s: damping ratio", what);
}

const mt_goal_ops mt_goal_damping = {.quantity = MT_QUANTITY_OTHER,
                                     .needs_vectors = true,
                                     .value = evaluate_damping,
                                     .subject = damping_subject,
                                     .number = "damping ratio",
                                     .equals = "at"};

static mt_status evaluate_limit(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                double *slope, mt_err *err)
{
    (void)pos;
    (void)err;
    *q = w->value[d->node];
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] = mt_workspace_dx_dt(w, k) * w->grad[((ptrdiff_t)d->node * w->p->n) + k];
    }
    return MT_OK;
}

const mt_goal_ops mt_goal_limit = {
    .quantity = MT_QUANTITY_EXPRESSION, .value = evaluate_limit, .equals = "equal to"};

static mt_status compile_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    MT_TRY(compile_reference_shape(p, d, err));
    d->n_rows = d->shape.ns;
    return MT_OK;
}

static mt_status residuals(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err)
{
    const int ns = d->shape.ns;
    const double weight = sqrt(mt_requirement_weight(w, d));
    double *const u = w->shape;
    double norm = 0.0;
    MT_TRY(sense_shape(w, d, pos, with_gradient, &norm, err));
    const double sign = mt_dot(ns, u, d->shape.shape) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < ns; i++) {
        u[i] /= norm;
        w->r[mt_requirement_row(w->c, d) + i] = weight * ((sign * u[i]) - d->shape.shape[i]);
    }
    for (int k = 0; k < w->p->n && with_gradient; k++) {
        const double *const ds = w->dshape + ((ptrdiff_t)k * ns);
        const double along = mt_dot(ns, u, ds);
        const double factor = weight * sign * mt_workspace_dx_dt(w, k) / norm;
        for (int i = 0; i < ns; i++) {
            w->dr[mt_requirement_row(w->c, d) + i + ((ptrdiff_t)k * w->c->rows.res.n)] =
                factor * (ds[i] - (along * u[i]));
        }
    }
    return MT_OK;
}

static const char *shape_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s shaped as mode %d of \"%s\"", what, d->shape.mode,
                           d->shape.reference);
}

const mt_goal_ops mt_goal_shape = {.quantity = MT_QUANTITY_OTHER,
                                   .needs_vectors = true,
                                   .compile = compile_shape,
                                   .residuals = residuals,
                                   .subject = shape_subject,
                                   .equals = "at"};

static mt_status evaluate_mac(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                              double *slope, mt_err *err)
{
    const int ns = d->shape.ns;
    double norm = 0.0;
    MT_TRY(sense_shape(w, d, pos, slope != NULL, &norm, err));
    mt_mac_matrix(ns, 1, w->shape, 1, d->shape.shape, q);
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        const double *const ds = w->dshape + ((ptrdiff_t)k * ns);
        slope[k] =
            mt_workspace_dx_dt(w, k) * mt_mac_derivative(ns, w->shape, ds, d->shape.shape);
    }
    return MT_OK;
}

static const char *mac_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s: MAC with mode %d of \"%s\"", what, d->shape.mode,
                           d->shape.reference);
}

const mt_goal_ops mt_goal_mac = {.quantity = MT_QUANTITY_OTHER,
                                 .needs_vectors = true,
                                 .compile = compile_reference_shape,
                                 .value = evaluate_mac,
                                 .subject = mac_subject,
                                 .number = "MAC",
                                 .equals = "at"};

#define OPS(id, name, ...) &mt_goal_##name,
static const mt_goal_ops *const OPERATIONS[] = {MT_GOAL_LIST(OPS)};

const mt_goal_ops *mt_goal_ops_of(mt_goal_type type)
{
    return OPERATIONS[type];
}
