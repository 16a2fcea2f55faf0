/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The ratio of a joint is the derivative of its coordinate with respect to a drive's position
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

static mt_status sweep_point_init(mt_sweep_point *point, const mt_sweep *sweep,
                                  const double *drive, mt_arena *mem, mt_err *err)
{
    const size_t drives = (size_t)sweep->n_drives;
    const size_t joints = (size_t)sweep->n_joints;
    *point = (mt_sweep_point){.residual = nan(""), .gap_m = nan("")};
    point->drive = mt_arena_f64(mem, drives, 1);
    point->hold = mt_arena_f64(mem, drives, 1);
    point->coordinate = mt_arena_f64(mem, joints, 1);
    point->ratio = mt_arena_f64(mem, joints, drives);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(point->drive, drive, drives * sizeof *drive);
    for (size_t i = 0; i < drives; i++) {
        point->hold[i] = nan("");
    }
    for (size_t i = 0; i < joints; i++) {
        point->coordinate[i] = nan("");
    }
    for (size_t i = 0; i < joints * drives; i++) {
        point->ratio[i] = nan("");
    }
    return MT_OK;
}

typedef struct sweeper {
    mt_linear *lin;
    double *inputs;
    int others; /* inputs that are no positions */
    const mt_sweep_visitor *visitor;
    mt_arena *mem;
    mt_sweep *out;
} sweeper;

/* The system's drive whose position is the caller's `drive`. */
static const mt_drive_def *drive_of(const sweeper *s, int drive)
{
    const mt_system *const sys = s->lin->sys;
    int at = 0;
    while (sys->drives[at].input != s->others + drive) {
        at++;
    }
    return &sys->drives[at];
}

/* Ratios of all joints to one drive, and what holds it. */
static mt_status respond_to_drive(const sweeper *s, int drive, mt_sweep_point *point,
                                  mt_err *err)
{
    mt_linear *const lin = s->lin;
    const mt_system *const sys = lin->sys;
    mt_state *const p = &lin->position;
    const mt_drive_def *const d = drive_of(s, drive);
    lin->dual.input = d->input;
    MT_TRY(mt_position_tangent(p, &lin->dual, &lin->scratch, err));
    for (int j = 0; j < sys->n_joints; j++) {
        const int measure = sys->joints[j].coordinate;
        if (measure >= 0) {
            point->ratio[j + ((ptrdiff_t)drive * sys->n_joints)] =
                mt_drive_rate(&lin->data, measure, p->at.pose, p->d_pose);
        }
    }
    /* grad V + lambda grad s = 0: what holds the joint balances -dV/ds */
    point->hold[drive] = d->spring >= 0
                             ? p->equilibrium.trim_force.of[mt_system_trim_of(sys, d->spring)]
                             : -p->equilibrium.lambda[d->constraint];
    return MT_OK;
}

static mt_status solve_point(const sweeper *s, int i, mt_err *err)
{
    mt_sweep_point *const point = &s->out->points[i];
    mt_linear *const lin = s->lin;
    const mt_system *const sys = lin->sys;
    mt_state *const p = &lin->position;
    memcpy(s->inputs + s->others, point->drive,
           (size_t)s->out->n_drives * sizeof *point->drive);
    MT_TRY(s->visitor != NULL ? s->visitor->visit(s->visitor->context, i, s->inputs, err)
                              : mt_linear_update(lin, s->inputs, true, err));
    s->out->n_reached++;
    if (s->visitor != NULL && s->visitor->alone) {
        return MT_OK;
    }
    for (int d = 0; d < s->out->n_drives; d++) {
        MT_TRY(respond_to_drive(s, d, point, err));
    }
    for (int j = 0; j < sys->n_joints; j++) {
        const int measure = sys->joints[j].coordinate;
        if (measure >= 0) {
            point->coordinate[j] = value_at(&lin->data, measure, &p->at) -
                                   value_at(&lin->data, measure, &p->reference);
        }
    }
    point->residual = p->equilibrium.residual;
    point->gap_m = p->gap_m;
    mt_nearness *const near = mt_arena_alloc(s->mem, 1, sizeof *near);
    MT_TRY(mt_arena_check(s->mem, err));
    point->near = near;
    return mt_linear_nearness(lin, s->mem, near, err);
}

/* `joint "a" at 0.5 rad`, of all drives. */
static const char *where_driven(const sweeper *s, const mt_sweep_point *point)
{
    const mt_system *const sys = s->lin->sys;
    const char *text = "";
    for (int d = 0; d < s->out->n_drives; d++) {
        const mt_system_joint *const joint = &sys->joints[drive_of(s, d)->joint];
        text = mt_arena_printf(s->mem, "%s%sjoint \"%s\" at %.6g %s", text, d > 0 ? ", " : "",
                               joint->name, point->drive[d], joint->angle ? "rad" : "m");
    }
    return text;
}

/* A stretch of the points, and where it begins. */
typedef struct stretch {
    int first;
    int end; /* behind the last */
    int nearest;
} stretch;

/* Points first, first + step, ... up to the end of the line; where one cannot be reached the
 * ones behind it cannot either. */
static mt_status solve_points_outward(const sweeper *s, const stretch *line, int first,
                                      int step, mt_err *err)
{
    const char *limit = NULL;
    for (int i = first; i >= line->first && i < line->end; i += step) {
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
            (void)mt_err_in(&why, point->status, "%s", where_driven(s, point));
        }
        point->why = mt_arena_strdup(s->mem, why.text);
        MT_TRY(mt_arena_check(s->mem, err));
        limit = point->status == MT_E_ASSEMBLY ? point->why : NULL;
    }
    return MT_OK;
}

/* Distance of a point from the reference position, to compare. */
static double distance_of(const sweeper *s, const double *drive)
{
    const mt_system *const sys = s->lin->sys;
    if (s->out->n_drives == 1) {
        return fabs(drive[0]);
    }
    double most = 0.0;
    for (int d = 0; d < s->out->n_drives; d++) {
        const double unit = sys->joints[drive_of(s, d)->joint].angle ? 1.0 : sys->length_m;
        most = fmax(most, fabs(drive[d]) / unit);
    }
    return most;
}

static mt_status sweep_line(const sweeper *s, const stretch *line, mt_err *err)
{
    mt_linear_follow(s->lin, true);
    mt_status rc = solve_points_outward(s, line, line->nearest, 1, err);
    mt_linear_follow(s->lin, true); /* and from the reference position the other way */
    if (rc == MT_OK && line->nearest > line->first) {
        rc = solve_points_outward(s, line, line->nearest - 1, -1, err);
    }
    mt_linear_follow(s->lin, false);
    return rc;
}

mt_status mt_sweep_run(mt_linear *lin, const double *inputs, const mt_sweep_plan *plan,
                       const mt_sweep_visitor *visitor, mt_arena *mem, mt_sweep *out,
                       mt_err *err)
{
    const int drives = plan->n_drives > 0 ? plan->n_drives : 1;
    const int others = lin->sys->n_inputs - drives;
    const sweeper s = {
        lin, mt_arena_f64(mem, (size_t)lin->sys->n_inputs, 1), others, visitor, mem, out};
    *out = (mt_sweep){.n_joints = lin->sys->n_joints, .n_drives = drives, .n_points = plan->n};
    out->points = mt_arena_alloc(mem, (size_t)plan->n, sizeof *out->points);
    MT_TRY(mt_arena_check(mem, err));
    if (others > 0) {
        memcpy(s.inputs, inputs, (size_t)others * sizeof *inputs);
    }
    for (int i = 0; i < plan->n; i++) {
        MT_TRY(sweep_point_init(&out->points[i], out, plan->positions + ((ptrdiff_t)i * drives),
                                mem, err));
    }
    const int line = plan->line > 0 ? plan->line : plan->n;
    for (int first = 0; first < plan->n; first += line) {
        stretch one = {.first = first, .end = first + line, .nearest = first};
        for (int i = first; i < one.end; i++) {
            const double least = distance_of(&s, out->points[one.nearest].drive);
            one.nearest = distance_of(&s, out->points[i].drive) < least ? i : one.nearest;
        }
        MT_TRY(sweep_line(&s, &one, err));
    }
    return MT_OK;
}
