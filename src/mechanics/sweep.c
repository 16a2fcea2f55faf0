/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The ratio of a joint is the derivative of its coordinate with respect to the drive's position
 * s: with q' = dq/ds of the whole position analysis (implicit function theorem, position.h),
 * the coordinate's gradient times q'.
 */
#include "mechanics/sweep.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

#include "mechanics/linear.h"
#include "mechanics/position.h"

void mt_sweep_range(double from, double to, int steps, double *positions)
{
    for (int i = 0; i < steps; i++) {
        const double t = steps > 1 ? (double)i / (double)(steps - 1) : 0.0;
        positions[i] = ((1.0 - t) * from) + (t * to);
    }
}

static double value_at(const mt_data *data, int measure, const mt_placement *at)
{
    return creal(mt_data_value(data, &data->sys->measures[measure], at, NULL));
}

static mt_status sweep_point_init(mt_sweep_point *point, int n_joints, double drive,
                                  mt_arena *mem, mt_err *err)
{
    *point = (mt_sweep_point){
        .drive = drive, .hold = nan(""), .residual = nan(""), .gap_m = nan("")};
    point->coordinate = mt_arena_f64(mem, (size_t)n_joints, 1);
    point->ratio = mt_arena_f64(mem, (size_t)n_joints, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n_joints; i++) {
        point->coordinate[i] = nan("");
        point->ratio[i] = nan("");
    }
    return MT_OK;
}

typedef struct sweeper {
    mt_linear *lin;
    double *inputs;
    const mt_sweep_visitor *visitor;
    mt_arena *mem;
    mt_sweep *out;
} sweeper;

static mt_status solve_point(const sweeper *s, int i, mt_err *err)
{
    mt_sweep_point *const point = &s->out->points[i];
    mt_linear *const lin = s->lin;
    const mt_system *const sys = lin->sys;
    mt_state *const p = &lin->position;
    s->inputs[sys->n_inputs - 1] = point->drive;
    MT_TRY(s->visitor != NULL ? s->visitor->visit(s->visitor->context, i, s->inputs, err)
                              : mt_linear_update(lin, s->inputs, true, err));
    s->out->n_reached++;
    if (s->visitor != NULL && s->visitor->alone) {
        return MT_OK;
    }
    lin->dual.input = sys->n_inputs - 1;
    MT_TRY(mt_position_tangent(p, &lin->dual, &lin->scratch, err));
    for (int j = 0; j < sys->n_joints; j++) {
        const int measure = sys->joints[j].coordinate;
        if (measure >= 0) {
            point->coordinate[j] = value_at(&lin->data, measure, &p->at) -
                                   value_at(&lin->data, measure, &p->reference);
            point->ratio[j] = mt_drive_rate(&lin->data, measure, p->at.pose, p->d_pose);
        }
    }
    /* grad V + lambda grad s = 0: what holds the joint balances -dV/ds */
    point->hold =
        sys->trim ? p->equilibrium.trim_force : -p->equilibrium.lambda[sys->drive_constraint];
    point->residual = p->equilibrium.residual;
    point->gap_m = p->gap_m;
    mt_nearness *const near = mt_arena_alloc(s->mem, 1, sizeof *near);
    MT_TRY(mt_arena_check(s->mem, err));
    point->near = near;
    return mt_linear_nearness(lin, s->mem, near, err);
}

/* Points first, first + step, ... up to the end of the list; where one cannot be reached the
 * ones behind it cannot either. */
static mt_status solve_points_outward(const sweeper *s, int first, int step, mt_err *err)
{
    const char *limit = NULL;
    for (int i = first; i >= 0 && i < s->out->n_points; i += step) {
        mt_sweep_point *const point = &s->out->points[i];
        mt_err why = {.code = MT_OK};
        point->status = MT_E_ASSEMBLY;
        point->why = limit;
        if (limit != NULL) {
            continue;
        }
        point->status = solve_point(s, i, &why);
        if (point->status == MT_OK) {
            continue;
        }
        if (mt_is_final(point->status) || point->status == MT_E_INTERRUPTED) {
            return mt_fail(err, point->status, "%s", why.text);
        }
        if (point->status ==
            MT_E_DEAD_CENTRE) { /* of this point alone; the next ones go on from the last */
            const mt_system_joint *const joint = &s->lin->sys->joints[s->lin->sys->drive_joint];
            (void)mt_err_in(&why, point->status, "joint \"%s\" at %.6g %s", joint->name,
                            point->drive, joint->angle ? "rad" : "m");
        }
        point->why = mt_arena_strdup(s->mem, why.text);
        MT_TRY(mt_arena_check(s->mem, err));
        limit = point->status == MT_E_ASSEMBLY ? point->why : NULL;
    }
    return MT_OK;
}

mt_status mt_sweep_run(mt_linear *lin, const double *inputs, int n, const double *positions,
                       const mt_sweep_visitor *visitor, mt_arena *mem, mt_sweep *out,
                       mt_err *err)
{
    const size_t others = (size_t)lin->sys->n_inputs - 1;
    const sweeper s = {lin, mt_arena_f64(mem, others + 1, 1), visitor, mem, out};
    int nearest = 0;
    *out = (mt_sweep){.n_joints = lin->sys->n_joints, .n_points = n};
    out->points = mt_arena_alloc(mem, (size_t)n, sizeof *out->points);
    MT_TRY(mt_arena_check(mem, err));
    if (others > 0) {
        memcpy(s.inputs, inputs, others * sizeof *inputs);
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(sweep_point_init(&out->points[i], out->n_joints, positions[i], mem, err));
        nearest = fabs(positions[i]) < fabs(positions[nearest]) ? i : nearest;
    }
    if (n == 0) {
        return MT_OK;
    }
    mt_linear_follow(lin, true);
    mt_status rc = solve_points_outward(&s, nearest, 1, err);
    mt_linear_follow(lin, true); /* and from the reference position the other way */
    if (rc == MT_OK && nearest > 0) {
        rc = solve_points_outward(&s, nearest - 1, -1, err);
    }
    mt_linear_follow(lin, false);
    return rc;
}
