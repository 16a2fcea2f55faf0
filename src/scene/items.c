/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints, sensors and loads where they stand in the pose. */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "model/joint.h"

static bool make_unit(double x[3])
{
    const double length = hypot(hypot(x[0], x[1]), x[2]);
    for (int k = 0; k < 3; k++) {
        x[k] = length > 0.0 ? x[k] / length : 0.0;
    }
    return length > 0.0 && isfinite(length);
}

/* Its axis, carried by its first body; in two dimensions what turns does so about z. */
static void joint_axis(const mt_scene_frame *f, const mt_joint *joint, mt_scene_joint *out)
{
    const bool turns = mt_joint_kind_of(joint->type)->coordinate == MT_COORDINATE_ANGLE;
    double drawn[3] = {0.0, 0.0, 1.0};
    for (int k = 0; k < 3 && joint->has_axis; k++) {
        drawn[k] = joint->axis[k] == MT_ABSENT ? 0.0 : f->number[joint->axis[k]];
    }
    const bool known = joint->has_axis || (f->sys->dimension == 2 && turns);
    if (known && make_unit(drawn)) {
        mt_scene_turn(f, out->body[0] - 1, drawn, out->axis);
        out->has_axis = true;
    }
}

static void joint_of_bodies(const mt_scene_frame *f, const mt_joint *joint, mt_scene_joint *out)
{
    for (int side = 0; side < 2; side++) {
        const int body = mt_scene_body_of(f, &joint->bodies[side]);
        double drawn[3];
        out->body[side] = body + 1;
        if (joint->n_at > 0) {
            mt_scene_drawn(f, &joint->at[joint->n_at == 2 ? side : 0], drawn);
        } else {
            mt_scene_centre(f, body, drawn);
        }
        mt_scene_place(f, body, drawn, out->end[side]);
    }
    /* without a point it is where the body is that moves: the ground's centre is none */
    if (joint->n_at == 0) {
        for (int side = 0; side < 2; side++) {
            if (out->body[side] == 0) {
                memcpy(out->end[side], out->end[1 - side], sizeof out->end[side]);
            }
        }
    }
    memcpy(out->at, out->end[1], sizeof out->at);
    joint_axis(f, joint, out);
}

/* Joint of the view that stands in the model under this index; NULL: none. */
static const mt_scene_joint *find_view_joint(const mt_scene_view *v, const int *joint_of,
                                             int index)
{
    return joint_of[index] >= 0 ? &v->joints[joint_of[index]] : NULL;
}

/* A gear or rack: between the two joints whose coordinates it couples. */
static void joint_of_joints(const mt_scene_view *v, const int *joint_of, const mt_joint *joint,
                            mt_scene_joint *out)
{
    for (int side = 0; side < 2; side++) {
        const mt_scene_joint *const one = find_view_joint(v, joint_of, joint->gear_joint[side]);
        if (one != NULL) {
            out->body[side] = one->body[1];
            memcpy(out->end[side], one->at, sizeof one->at);
        }
    }
    for (int k = 0; k < 3; k++) {
        out->at[k] = 0.5 * (out->end[0][k] + out->end[1][k]);
    }
}

static mt_status joints(mt_scene_frame *f, mt_err *err)
{
    const mt_model *const m = f->model;
    mt_scene_view *const v = f->view;
    int *const joint_of = mt_arena_int(f->work, (size_t)m->n_joints);
    f->joint_of = joint_of;
    v->joints = mt_arena_alloc(f->mem, (size_t)m->n_joints, sizeof *v->joints);
    MT_TRY(mt_arena_check(f->work, err));
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0; i < m->n_joints; i++) {
        joint_of[i] = mt_model_present(&m->joints[i].in, f->configuration) ? v->n_joints++ : -1;
    }
    for (int pass = 0; pass < 2; pass++) { /* gears stand between others */
        for (int i = 0; i < m->n_joints; i++) {
            const mt_joint *const joint = &m->joints[i];
            const bool couples = mt_joint_kind_of(joint->type)->couples;
            if (joint_of[i] < 0 || couples != (pass == 1)) {
                continue;
            }
            mt_scene_joint *const out = &v->joints[joint_of[i]];
            out->name = mt_arena_strdup(f->mem, joint->name.s);
            out->type = mt_joint_type_name(joint->type);
            out->far = MT_ABSENT;
            out->rod = joint->type == MT_JOINT_DISTANCE;
            if (couples) {
                joint_of_joints(v, joint_of, joint, out);
            } else {
                joint_of_bodies(f, joint, out);
            }
        }
    }
    return mt_arena_check(f->mem, err);
}

/* Where a channel of a sensor reads: on a body, or between two nodes of a beam. */
static void channel_at(const mt_scene_frame *f, const mt_channel_def *c, mt_scene_arrow *out)
{
    double centre[2][3];
    mt_scene_centre(f, c->body[0], centre[0]);
    out->body = c->body[0] + 1;
    if (c->kind == MT_CHANNEL_POINT || c->kind == MT_CHANNEL_ROTATION) {
        for (int k = 0; k < 3 && c->point >= 0; k++) {
            const mt_node arm = f->sys->vecs[c->point].node[k];
            centre[0][k] += arm == MT_NO_NODE ? 0.0 : f->value[arm];
        }
        mt_scene_place(f, c->body[0], centre[0], out->at);
        return;
    }
    const double part = c->fraction == MT_NO_NODE ? 0.0 : f->value[c->fraction];
    double end[2][3];
    mt_scene_centre(f, c->body[1], centre[1]);
    for (int side = 0; side < 2; side++) {
        mt_scene_place(f, c->body[side], centre[side], end[side]);
    }
    for (int k = 0; k < 3; k++) {
        out->at[k] = end[0][k] + (part * (end[1][k] - end[0][k]));
    }
    out->body = c->body[part > 0.5 ? 1 : 0] + 1;
}

static mt_status sensors(mt_scene_frame *f, mt_err *err)
{
    mt_scene_view *const v = f->view;
    v->sensors = mt_arena_alloc(f->mem, (size_t)f->sys->n_channels, sizeof *v->sensors);
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0; i < f->sys->n_channels; i++) {
        const mt_channel_def *const c = &f->sys->channels[i];
        mt_scene_arrow *const out = &v->sensors[v->n_sensors++];
        out->name = mt_arena_strdup(f->mem, c->name);
        out->axis[c->axis] = 1.0;
        channel_at(f, c, out);
    }
    return mt_arena_check(f->mem, err);
}

/* A load with a force along global directions. */
static void load_at(const mt_scene_frame *f, const mt_load *load, mt_scene_arrow *out)
{
    const int body = mt_scene_body_of(f, &load->on);
    const mt_attach_kind kind = load->on.kind;
    double drawn[3];
    out->body = body + 1;
    if (load->at.given) {
        mt_scene_drawn(f, &load->at, drawn);
    } else if (kind == MT_ATTACH_LINK_START || kind == MT_ATTACH_LINK_END) {
        const mt_link *const l = &f->model->links[load->on.index];
        mt_scene_drawn(f, kind == MT_ATTACH_LINK_START ? &l->from : &l->to, drawn);
    } else if (kind == MT_ATTACH_LINK_NODE) {
        mt_scene_link_at(f, load->on.index, load->on.element, false, drawn);
    } else {
        mt_scene_centre(f, body, drawn);
    }
    mt_scene_place(f, body, drawn, out->at);
}

static mt_status loads(mt_scene_frame *f, mt_err *err)
{
    const mt_model *const m = f->model;
    mt_scene_view *const v = f->view;
    v->loads = mt_arena_alloc(f->mem, (size_t)m->n_loads, sizeof *v->loads);
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0; i < m->n_loads; i++) {
        const mt_load *const load = &m->loads[i];
        if (load->on.name.s == NULL || !load->has_force || load->one_number ||
            !mt_model_present(&load->in, f->configuration)) {
            continue;
        }
        mt_scene_arrow *const out = &v->loads[v->n_loads++];
        out->name = mt_arena_strdup(f->mem, load->name.s);
        for (int k = 0; k < 3; k++) {
            out->axis[k] = load->force[k] == MT_ABSENT ? 0.0 : f->number[load->force[k]];
        }
        load_at(f, load, out);
    }
    return mt_arena_check(f->mem, err);
}

mt_status mt_scene_items(mt_scene_frame *f, mt_err *err)
{
    MT_TRY(joints(f, err));
    MT_TRY(sensors(f, err));
    return loads(f, err);
}
