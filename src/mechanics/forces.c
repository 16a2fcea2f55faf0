/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/forces.h"

/* A measure with the force c; that of a spring from how far it is stretched. */
static bool visit_measure(const mt_data *d, const mt_pose *pose, const mt_measure_def *def,
                          const mt_spring_def *spring, double c, mt_force_visit visit,
                          void *context)
{
    const mt_measure_data measure = mt_data_measure(d, def);
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(pose, def->body[0]), mt_pose_of(pose, def->body[1]),
                    true, &jet);
    if (spring != NULL && spring->free != MT_NO_NODE) {
        c += d->value[spring->stiffness] * (creal(jet.value) - d->value[spring->free]);
    }
    return c == 0.0 || visit(context, def->body, c, &jet);
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
    return visit(context, body, -1.0, &jet);
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
