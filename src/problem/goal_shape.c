/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "shape": residuals of the unit shape at the sensors against that of a reference,
 *     r = sqrt(w) (sign u - s_ref),   u = s / |s|,   sign = sign(s . s_ref)
 *     dr = sqrt(w) sign (ds - u (u . ds)) / |s|
 */
#include <math.h>

#include "problem/goal.h"
#include "problem/requirement.h"

int mt_goal_reference_mode(const mt_problem *p, const mt_requirement *d)
{
    const mt_goal *const g = d->goal;
    const int own = d->mode > 0 ? d->mode : p->study->model->modes[g->mode.named].index;
    return g->reference_mode > 0 ? g->reference_mode : own;
}

static mt_status compile_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    MT_TRY(mt_goal_compile_shape(p, d, err));
    d->n_rows = d->shape.ns;
    return MT_OK;
}

mt_status mt_goal_compile_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_system *const sys = p->views[d->view].original->sys;
    return d->goal->reference_name.s == NULL
               ? MT_OK
               : mt_reference_shape_init(p->references, d->goal->reference,
                                         mt_goal_reference_mode(p, d), sys, d->goal->length,
                                         &p->mem, &d->shape, err);
}

mt_status mt_goal_sense(mt_workspace *w, const mt_requirement *d, int pos, bool with_gradient,
                        double *norm, mt_err *err)
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

static mt_status residuals(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err)
{
    const int ns = d->shape.ns;
    const double weight = sqrt(mt_requirement_weight(w, d));
    double *const u = w->shape;
    double norm = 0.0;
    MT_TRY(mt_goal_sense(w, d, pos, with_gradient, &norm, err));
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
