/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/constraint.h"

#include <math.h>

#include "mechanics/lagrangian.h"

double mt_constraint_turns(const mt_data *d, int i, double value)
{
    const double turn = 6.283185307179586477;
    const mt_constraint_def *const c = &d->sys->constraints[i];
    const bool angle = d->sys->measures[c->measure[0]].kind == MT_MEASURE_ANGLE;
    return angle ? turn * round(value / turn) : 0.0;
}

void mt_constraint_values(const mt_data *d, const mt_placement *at, int m, double *c)
{
    const mt_system *const sys = d->sys;
    for (int i = 0; i < m; i++) {
        const mt_constraint_def *const def = &sys->constraints[i];
        c[i] = -creal(mt_data_target(d, i, at));
        for (int t = 0; t < def->terms; t++) {
            const mt_measure_def *const measure = &sys->measures[def->measure[t]];
            c[i] += creal(mt_data_scalar(d, def->coefficient[t], 1.0)) *
                    creal(mt_data_value(d, measure, at, NULL));
        }
        c[i] -= mt_constraint_turns(d, i, c[i]);
    }
}

double mt_constraint_curve(const mt_data *d, const mt_pose *poses, int i, int t,
                           const double *phi, const double *scale, double b[MT_LOCAL])
{
    const mt_system *const sys = d->sys;
    const mt_constraint_def *const c = &sys->constraints[i];
    const mt_measure_def *const def = &sys->measures[c->measure[t]];
    const mt_measure_data measure = mt_data_measure(d, def);
    const double factor = creal(mt_data_scalar(d, c->coefficient[t], 1.0));
    double squares = 0.0;
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(poses, def->body[0]), mt_pose_of(poses, def->body[1]),
                    true, NULL, &jet);
    for (int r = 0; r < MT_LOCAL; r++) {
        const int row = mt_local_dof(sys, def->body, r);
        b[r] = 0.0;
        for (int k = 0; k < MT_LOCAL && row >= 0; k++) {
            const int dof = mt_local_dof(sys, def->body, k);
            if (dof >= 0) {
                const double h = factor * creal(jet.h[r + (MT_LOCAL * k)]);
                b[r] += h * phi[dof];
                squares += scale[row] * h * scale[dof] * scale[row] * h * scale[dof];
            }
        }
    }
    return sqrt(squares);
}
