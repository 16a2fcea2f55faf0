/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/forces.h"

#include <float.h>
#include <math.h>

#include "mechanics/element_forces.h"

/* Of a correction that is known by its size alone. */
static const double TWICE = 2.0;
/* Roundings of a force. */
static const double ULPS = 8.0;

/* A measure with the force c; that of a spring from how far it is stretched. */
static bool visit_measure(const mt_data *d, const mt_pose *pose, const mt_measure_def *def,
                          const mt_spring_def *spring, double c, mt_force_visit visit,
                          void *context)
{
    const mt_measure_data measure = mt_data_measure(d, def);
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(pose, def->body[0]), mt_pose_of(pose, def->body[1]),
                    true, NULL, &jet);
    if (spring != NULL && spring->free != MT_NO_NODE) {
        c += d->value[spring->stiffness] * (creal(jet.value) - d->value[spring->free]);
    }
    return c == 0.0 || visit(context, def->body, c, 0.0, &jet);
}

/* A force on a point. */
static bool visit_point(const mt_data *d, const mt_pose *pose, const mt_load_def *load,
                        mt_force_visit visit, void *context)
{
    const int body[2] = {load->body, MT_GROUND};
    mt_cx f[3];
    mt_jet jet;
    for (int k = 0; k < 3; k++) {
        f[k] = mt_data_scalar(d, load->force[k], 0.0);
    }
    mt_measure_point(load->point < 0 ? NULL : d->vec[load->point], f,
                     mt_pose_of(pose, load->body), true, &jet);
    return visit(context, body, -1.0, 0.0, &jet);
}

bool mt_forces_each(const mt_data *d, const mt_pose *pose, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    bool more = true;
    for (int i = 0; i < sys->n_loads && more; i++) {
        const mt_load_def *const load = &sys->loads[i];
        more = load->measure < 0 ? visit_point(d, pose, load, visit, context)
                                 : visit_measure(d, pose, &sys->measures[load->measure], NULL,
                                                 -d->value[load->size], visit, context);
    }
    for (int i = 0; i < sys->n_springs && more; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && (s->free != MT_NO_NODE || s->preload != MT_NO_NODE)) {
            const double preload = s->preload == MT_NO_NODE ? 0.0 : d->value[s->preload];
            more = visit_measure(d, pose, &sys->measures[s->measure[0]], s, preload, visit,
                                 context);
        }
    }
    return more;
}

/* V = 1/2 k d_a d_b + p d_a, of two measures that are the same or not. */
static bool visit_spring(const mt_data *d, const mt_placement *at, const double *left,
                         const double *open, int i, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    const mt_spring_def *const s = &sys->springs[i];
    const bool coupling = s->measure[0] != s->measure[1];
    const double k = coupling ? 0.5 * d->value[s->stiffness] : d->value[s->stiffness];
    const double preload = s->preload == MT_NO_NODE ? 0.0 : d->value[s->preload];
    mt_jet jet[2];
    double stretch[2] = {0.0, 0.0};
    double noise[2] = {0.0, 0.0};
    bool more = true;
    for (int side = 0; side < (coupling ? 2 : 1); side++) {
        const mt_measure_def *const def = &sys->measures[s->measure[side]];
        mt_data_eval(d, def, at, true, NULL, &jet[side]);
        stretch[side] = creal(jet[side].value) - creal(d->rest[i][side]);
        stretch[side] += mt_jet_along(sys, def->body, &jet[side], left);
        noise[side] = TWICE * fabs(mt_jet_along(sys, def->body, &jet[side], open));
    }
    for (int side = 0; side < (coupling ? 2 : 1) && more; side++) {
        const int other = coupling ? 1 - side : 0;
        const double c = (k * stretch[other]) + (coupling ? 0.0 : preload);
        more = visit(context, sys->measures[s->measure[side]].body, c,
                     (fabs(k) * noise[other]) + (ULPS * DBL_EPSILON * fabs(c)), &jet[side]);
    }
    return more;
}

bool mt_forces_at(const mt_data *d, const mt_placement *at, const double *left,
                  const double *open, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    bool more = true;
    for (int i = 0; i < sys->n_loads && more; i++) {
        const mt_load_def *const load = &sys->loads[i];
        mt_jet jet;
        if (load->measure < 0) {
            more = visit_point(d, at->pose, load, visit, context);
        } else {
            const mt_measure_def *const def = &sys->measures[load->measure];
            mt_data_eval(d, def, at, true, NULL, &jet);
            more = visit(context, def->body, -d->value[load->size], 0.0, &jet);
        }
    }
    for (int i = 0; i < sys->n_springs && more; i++) {
        more = sys->springs[i].damper || visit_spring(d, at, left, open, i, visit, context);
    }
    return more;
}
