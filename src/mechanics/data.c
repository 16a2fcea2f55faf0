/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions of bodies, and the numbers of one design. */
#include "mechanics/data.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "linalg/dense.h"

/* Positions. */

static const mt_pose GROUND = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};

mt_pose mt_pose_ground(void)
{
    return GROUND;
}

const mt_pose *mt_pose_of(const mt_pose *poses, int body)
{
    return body == MT_GROUND ? &GROUND : &poses[body];
}

void mt_cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = (a[1] * b[2]) - (a[2] * b[1]);
    out[1] = (a[2] * b[0]) - (a[0] * b[2]);
    out[2] = (a[0] * b[1]) - (a[1] * b[0]);
}

void mt_turn3(const double theta[3], int count, const double *v, double *out)
{
    const double angle =
        sqrt((theta[0] * theta[0]) + (theta[1] * theta[1]) + (theta[2] * theta[2]));
    const double half = 0.5 * angle;
    /* sin(a)/a and (1 - cos(a))/a^2 = 1/2 (sin(a/2)/(a/2))^2, both without cancellation */
    const double s1 = angle > 0.0 ? sin(angle) / angle : 1.0;
    const double sh = half > 0.0 ? sin(half) / half : 1.0;
    const double s2 = 0.5 * sh * sh;
    for (int c = 0; c < count; c++, v += 3, out += 3) {
        double w[3];
        double z[3];
        mt_cross3(theta, v, w);
        mt_cross3(theta, w, z);
        for (int i = 0; i < 3; i++) {
            out[i] = v[i] + (s1 * w[i]) + (s2 * z[i]);
        }
    }
}

void mt_pose_move(mt_pose *pose, const double *dx, const double *theta)
{
    double r[9];
    double turned[9];
    for (int i = 0; i < 9; i++) {
        r[i] = creal(pose->r[i]);
    }
    mt_turn3(theta, 3, r, turned);
    for (int i = 0; i < 9; i++) {
        pose->r[i] = turned[i];
    }
    for (int i = 0; i < 3; i++) {
        pose->x[i] = creal(pose->x[i]) + dx[i];
    }
}

void mt_pose_tangent(mt_pose *pose, const double *dx, const double *theta)
{
    for (int i = 0; i < 3; i++) {
        pose->x[i] = cx_make(creal(pose->x[i]), dx[i]);
    }
    for (int c = 0; c < 3; c++) {
        mt_cx *const col = pose->r + (ptrdiff_t)(3 * c);
        const double v[3] = {creal(col[0]), creal(col[1]), creal(col[2])};
        col[0] = cx_make(v[0], (theta[1] * v[2]) - (theta[2] * v[1]));
        col[1] = cx_make(v[1], (theta[2] * v[0]) - (theta[0] * v[2]));
        col[2] = cx_make(v[2], (theta[0] * v[1]) - (theta[1] * v[0]));
    }
}

void mt_pose_motion(const mt_system *sys, int body, const double *dq, double out[6])
{
    for (int k = 0; k < 6; k++) {
        const int dof = sys->bodies[body].dof[k];
        out[k] = dof >= 0 ? dq[dof] : 0.0;
    }
}

void mt_poses_move(const mt_system *sys, mt_pose *poses, const double *dq)
{
    for (int i = 0; i < sys->n_bodies; i++) {
        double own[6];
        mt_pose_motion(sys, i, dq, own);
        mt_pose_move(&poses[i], own, own + 3);
    }
}

void mt_poses_tangent(const mt_system *sys, const mt_pose *poses, const double *dq,
                      mt_pose *out)
{
    for (int i = 0; i < sys->n_bodies; i++) {
        double own[6];
        out[i] = poses[i];
        mt_pose_motion(sys, i, dq, own);
        mt_pose_tangent(&out[i], own, own + 3);
    }
}

double mt_poses_distance(const mt_system *sys, const mt_pose *a, const mt_pose *b)
{
    double most = 0.0;
    for (int i = 0; i < sys->n_bodies; i++) {
        for (int k = 0; k < 9; k++) {
            const double x = k < 3 ? fabs(creal(a[i].x[k] - b[i].x[k])) / sys->length_m : 0.0;
            const double d = fmax(x, fabs(creal(a[i].r[k] - b[i].r[k])));
            most = !(d <= most) ? d : most; /* NaN is kept */
        }
    }
    return most;
}

void mt_poses_increment(const mt_system *sys, const mt_pose *from, const mt_pose *to,
                        double *way)
{
    for (int b = 0; b < sys->n_bodies; b++) {
        double r[3][3]; /* R1 R0^T */
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                r[i][k] = 0.0;
                for (int j = 0; j < 3; j++) {
                    r[i][k] += creal(to[b].r[i + (3 * j)]) * creal(from[b].r[k + (3 * j)]);
                }
            }
        }
        double turn[3] = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
        const double sine = mt_norm2(3, turn);
        const double angle = atan2(sine, r[0][0] + r[1][1] + r[2][2] - 1.0);
        for (int k = 0; k < 3; k++) {
            const int *const dof = sys->bodies[b].dof;
            if (dof[k] >= 0) {
                way[dof[k]] = creal(to[b].x[k]) - creal(from[b].x[k]);
            }
            if (dof[3 + k] >= 0) {
                way[dof[3 + k]] = sine > 0.0 ? angle / sine * turn[k] : 0.0;
            }
        }
    }
}

mt_status mt_placement_init(mt_placement *place, const mt_system *sys, mt_arena *mem,
                            mt_err *err)
{
    *place = (mt_placement){.drive = {0.0}};
    place->pose = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *place->pose);
    place->turn = mt_arena_f64(mem, (size_t)sys->n_measures, 1);
    return mt_arena_check(mem, err);
}

void mt_placement_copy(const mt_system *sys, const mt_placement *from, mt_placement *to)
{
    memcpy(to->pose, from->pose, (size_t)sys->n_bodies * sizeof *to->pose);
    memcpy(to->turn, from->turn, (size_t)sys->n_measures * sizeof *to->turn);
    memcpy(to->drive, from->drive, (size_t)sys->n_drives * sizeof *to->drive);
}

/* Numbers. */

mt_status mt_data_init(mt_data *d, const mt_system *sys, mt_arena *mem, mt_err *err)
{
    *d = (mt_data){.sys = sys, .input = -1};
    d->vec = mt_arena_alloc(mem, (size_t)sys->n_vecs, sizeof *d->vec);
    d->rest = mt_arena_alloc(mem, (size_t)sys->n_springs, sizeof *d->rest);
    d->target = mt_arena_alloc(mem, (size_t)sys->n_constraints, sizeof *d->target);
    return mt_arena_check(mem, err);
}

mt_cx mt_data_scalar(const mt_data *d, mt_node node, double otherwise)
{
    if (node == MT_NO_NODE) {
        return otherwise;
    }
    if (d->input < 0) {
        return d->value[node];
    }
    return cx_make(d->value[node], d->grad[((ptrdiff_t)node * d->sys->n_inputs) + d->input]);
}

void mt_data_vec(mt_data *d, int i)
{
    const mt_vec_def *const def = &d->sys->vecs[i];
    mt_cx *const v = d->vec[i];
    mt_cx e[3] = {0.0, 0.0, 0.0};
    switch (def->kind) {
    case MT_VEC_NODES:
    case MT_VEC_UNIT:
        for (int k = 0; k < 3; k++) {
            v[k] = mt_data_scalar(d, def->node[k], 0.0);
        }
        if (def->kind == MT_VEC_UNIT) {
            cx_unit3(v);
        }
        return;
    case MT_VEC_PERP1:
    case MT_VEC_PERP2:
        e[def->helper] = 1.0;
        cx_cross3(d->vec[def->axis], e, v);
        cx_unit3(v);
        if (def->kind == MT_VEC_PERP2) {
            cx_cross3(d->vec[def->axis], v, v);
        }
        return;
    case MT_VEC_CROSS:
    case MT_VEC_ACROSS:
        cx_cross3(d->vec[def->axis], d->vec[def->helper], v);
        cx_unit3(v);
        return;
    }
}

void mt_data_vecs(mt_data *d)
{
    for (int i = 0; i < d->sys->n_vecs; i++) {
        mt_data_vec(d, i);
    }
}

static const mt_cx *vec_or_null(const mt_data *d, int i)
{
    return i < 0 ? NULL : d->vec[i];
}

mt_measure_data mt_data_measure(const mt_data *d, const mt_measure_def *def)
{
    mt_measure_data m = {
        .kind = def->kind,
        .component = def->component,
        .point = {vec_or_null(d, def->point[0]), vec_or_null(d, def->point[1])},
        .dir = {vec_or_null(d, def->dir[0]), vec_or_null(d, def->dir[1]),
                vec_or_null(d, def->dir[2])},
        .held = {def->body[0] == MT_GROUND, def->body[1] == MT_GROUND},
        .plane = d->sys->dimension == 2,
    };
    if (def->kind == MT_MEASURE_BEAM) {
        m.beam.length = mt_data_scalar(d, def->beam[MT_BEAM_LENGTH], 1.0);
        m.beam.polar = mt_data_scalar(d, def->beam[MT_BEAM_POLAR], 0.0);
        m.beam.shape[0] = mt_data_scalar(d, def->beam[MT_BEAM_SHAPE_2], 1.0);
        m.beam.shape[1] = mt_data_scalar(d, def->beam[MT_BEAM_SHAPE_3], 1.0);
        m.beam.plane = d->sys->dimension == 2;
    }
    return m;
}

static mt_measure_data measure_at(const mt_data *d, const mt_measure_def *def,
                                  const mt_placement *at)
{
    mt_measure_data m = mt_data_measure(d, def);
    m.near = at->turn[def - d->sys->measures];
    return m;
}

mt_cx mt_data_value(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                    mt_beam_parts *kept)
{
    const mt_measure_data m = measure_at(d, def, at);
    return mt_measure_value(&m, mt_pose_of(at->pose, def->body[0]),
                            mt_pose_of(at->pose, def->body[1]), kept);
}

void mt_data_eval(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                  bool second, mt_beam_parts *kept, mt_jet *out)
{
    const mt_measure_data m = measure_at(d, def, at);
    mt_measure_eval(&m, mt_pose_of(at->pose, def->body[0]), mt_pose_of(at->pose, def->body[1]),
                    second, kept, out);
}

void mt_data_relative(const mt_data *d, const mt_measure_def *def, const mt_placement *at,
                      bool second, mt_beam_parts *kept, mt_relative_jet *out)
{
    const mt_measure_data m = measure_at(d, def, at);
    mt_measure_relative(&m, mt_pose_of(at->pose, def->body[0]),
                        mt_pose_of(at->pose, def->body[1]), second, kept, out);
}

void mt_data_turns(const mt_data *d, mt_placement *at)
{
    for (int i = 0; i < d->sys->n_measures; i++) {
        const mt_measure_def *const def = &d->sys->measures[i];
        if (def->kind == MT_MEASURE_ANGLE) {
            at->turn[i] = creal(mt_data_value(d, def, at, NULL));
        }
    }
}

mt_cx mt_data_target(const mt_data *d, int i, const mt_placement *at)
{
    const mt_system *const sys = d->sys;
    const int drive = i - (sys->n_constraints - sys->n_drives);
    return d->target[i] -
           (drive >= 0
                ? creal(mt_data_scalar(d, sys->drives[drive].position, 0.0)) - at->drive[drive]
                : 0.0);
}

void mt_data_drawn(const mt_data *d, mt_pose *poses)
{
    for (int i = 0; i < d->sys->n_bodies; i++) {
        poses[i] = mt_pose_ground();
        for (int k = 0; k < 3; k++) {
            poses[i].x[k] = d->vec[d->sys->bodies[i].centre][k];
        }
    }
}

static mt_cx drawn_value(const mt_data *d, const mt_measure_def *def)
{
    mt_pose pose[2] = {mt_pose_ground(), mt_pose_ground()};
    const mt_measure_data m = mt_data_measure(d, def);
    for (int side = 0; side < 2; side++) {
        for (int k = 0; k < 3 && def->body[side] != MT_GROUND; k++) {
            pose[side].x[k] = d->vec[d->sys->bodies[def->body[side]].centre][k];
        }
    }
    return mt_measure_value(&m, &pose[0], &pose[1], NULL);
}

void mt_data_targets(mt_data *d)
{
    for (int i = 0; i < d->sys->n_constraints; i++) {
        const mt_constraint_def *const c = &d->sys->constraints[i];
        d->target[i] = mt_data_scalar(d, c->target, 0.0);
        for (int t = 0; t < c->terms && c->drawn; t++) {
            const mt_cx v = drawn_value(d, &d->sys->measures[c->measure[t]]);
            d->target[i] += cx_mul(mt_data_scalar(d, c->coefficient[t], 1.0), v);
        }
    }
}

void mt_data_rest(mt_data *d, const mt_pose *reference)
{
    const mt_system *const sys = d->sys;
    mt_beam_parts parts;
    parts.dir = NULL;
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        for (int side = 0; side < 2; side++) {
            const mt_measure_def *const def = &sys->measures[s->measure[side]];
            const mt_measure_data m = mt_data_measure(d, def);
            d->rest[i][side] =
                side == 1 && s->measure[0] == s->measure[1] ? d->rest[i][0]
                : s->free != MT_NO_NODE
                    ? mt_data_scalar(d, s->free, 0.0)
                    : mt_measure_value(&m, mt_pose_of(reference, def->body[0]),
                                       mt_pose_of(reference, def->body[1]), &parts);
        }
    }
    for (int i = 0; i < sys->n_drives; i++) {
        const mt_drive_def *const drive = &sys->drives[i];
        const mt_measure_def *const def =
            &sys->measures[sys->constraints[drive->constraint].measure[0]];
        const mt_measure_data m = mt_data_measure(d, def);
        const mt_cx at = mt_measure_value(&m, mt_pose_of(reference, def->body[0]),
                                          mt_pose_of(reference, def->body[1]), NULL);
        d->target[drive->constraint] = at + mt_data_scalar(d, drive->position, 0.0);
    }
}
