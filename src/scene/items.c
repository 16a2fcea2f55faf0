/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands in a scene: where points of bodies are, bodies, joints, springs and lines. */
#include "scene/items.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "analysis/lowest.h"
#include "linalg/dense.h"
#include "mechanics/data.h"
#include "model/model.h"
#include "model/values.h"

/* Where what is drawn stands: x + R (p - c) for a point p of a body with its centre drawn at
 * c. */

/* Coordinates below this part of their vector, or of the model's length, are rounding. */
static const double ROUNDING = 1e-13;

/* A position of the model in the reference position. */
static void scene_drawn(const mt_scene_frame *f, const mt_position *p, double out[3])
{
    const mt_num *const x = p->point >= 0 ? f->model->points[p->point].x : p->x;
    for (int k = 0; k < 3; k++) {
        out[k] = x[k] == MT_ABSENT ? 0.0 : f->number[x[k]];
    }
}

/* The body of the system that an attachment names. */
static int scene_body_of(const mt_scene_frame *f, const mt_attach *a)
{
    switch (a->kind) {
    case MT_ATTACH_GROUND:
        break;
    case MT_ATTACH_BODY:
        return f->body_of[a->index];
    case MT_ATTACH_LINK_START:
    case MT_ATTACH_LINK_END:
    case MT_ATTACH_LINK_ELEMENT:
    case MT_ATTACH_LINK_NODE:
        return f->link_first[a->index] + a->part;
    }
    return MT_GROUND;
}

/* Length of element i in parts of the link. */
static double element_part(const mt_scene_frame *f, const mt_link *l, int i, double whole)
{
    if (l->n_element_length == 0 || !(whole > 0.0)) {
        return 1.0 / (double)l->elements;
    }
    return f->number[l->element_length[l->n_element_length == 1 ? 0 : i]] / whole;
}

/* The end of a link's first `count` elements (half: and half of the next one) in the reference
 * position. */
static void scene_link_at(const mt_scene_frame *f, int link, int count, bool half,
                          double out[3])
{
    const mt_link *const l = &f->model->links[link];
    double from[3];
    double to[3];
    scene_drawn(f, &l->from, from);
    scene_drawn(f, &l->to, to);
    const double whole = hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
    double part = l->n_element_length == 0 ? (double)count / (double)l->elements : 0.0;
    for (int i = 0; i < count && l->n_element_length > 0; i++) {
        part += element_part(f, l, i, whole);
    }
    part += half ? 0.5 * element_part(f, l, count, whole) : 0.0;
    for (int k = 0; k < 3; k++) {
        out[k] = from[k] + (part * (to[k] - from[k]));
    }
}

/* The centre of a body of the system in the reference position; of the ground the origin. */
static void scene_centre(const mt_scene_frame *f, int body, double out[3])
{
    const mt_pose *const p = mt_pose_of(f->drawn, body);
    for (int k = 0; k < 3; k++) {
        out[k] = creal(p->x[k]);
    }
}

void mt_scene_clean(double size, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = fabs(x[k]) > ROUNDING * size ? x[k] : 0.0;
    }
}

static void scene_turn(const mt_scene_frame *f, int body, const double drawn[3], double out[3])
{
    const mt_pose *const p = mt_pose_of(f->pose, body);
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            out[i] += creal(p->r[i + (3 * k)]) * drawn[k];
        }
    }
    mt_scene_clean(hypot(hypot(drawn[0], drawn[1]), drawn[2]), out);
}

/* The position in the pose of a body's point, or the direction in the pose of a body's
 * direction, given in the reference position. */
static void scene_place(const mt_scene_frame *f, int body, const double drawn[3], double out[3])
{
    const mt_pose *const p = mt_pose_of(f->pose, body);
    double arm[3];
    double turned[3];
    scene_centre(f, body, arm);
    for (int k = 0; k < 3; k++) {
        arm[k] = drawn[k] - arm[k];
    }
    scene_turn(f, body, arm, turned);
    for (int k = 0; k < 3; k++) {
        out[k] = creal(p->x[k]) + turned[k];
    }
    mt_scene_clean(f->sys->length_m, out);
}

/*
 * Bodies with their ellipsoids of inertia. A uniform ellipsoid of mass m with radii a, b, c has
 *     J_a = m (b^2 + c^2)/5, ...      whence      a^2 = 5 (J_b + J_c - J_a)/(2 m);
 * a uniform disc J = m r^2/2. Inertias that no body has (J_a > J_b + J_c, as where a gear
 * multiplies one) have no extent along that axis.
 */

/* Parts of the largest moment below which a difference of moments is their rounding. */
static const double BODY_ROUNDING = 1e-14;

/* Mass of every body of the view; bars and beams share theirs out to both ends. */
static void add_masses(const mt_scene_frame *f, mt_scene_body *bodies)
{
    for (int i = 0; i < f->sys->n_inertias; i++) {
        const mt_inertia_def *const d = &f->sys->inertias[i];
        const double m = f->value[d->coefficient];
        if (d->kind == MT_INERTIA_TRANSLATION) {
            bodies[d->body[0] + 1].mass += m;
        }
        for (int side = 0; side < 2; side++) {
            if ((d->kind == MT_INERTIA_BAR || d->kind == MT_INERTIA_BEAM) &&
                d->body[side] != MT_GROUND) {
                bodies[d->body[side] + 1].mass += 0.5 * m;
            }
        }
    }
}

static double number_or_zero(const mt_scene_frame *f, mt_num num)
{
    return num == MT_ABSENT ? 0.0 : f->number[num];
}

/* In two dimensions. */
static void disc(double mass, double inertia, mt_scene_ellipsoid *out)
{
    const double r = sqrt(2.0 * inertia / mass);
    *out = (mt_scene_ellipsoid){.radii = {r, r, 0.0},
                                .axes = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
}

/* Of tensor j (lower triangle, column-major), as drawn. Principal moments ascend, so radii
 * descend. */
static mt_status solid(double mass, double j[9], mt_arena *work, mt_scene_ellipsoid *out,
                       mt_err *err)
{
    double w[3];
    MT_TRY(mt_eig_sym(3, j, w, true, work, err));
    for (int i = 0; i < 3; i++) {
        const double square = 2.5 * (w[(i + 1) % 3] + w[(i + 2) % 3] - w[i]) / mass;
        const double least = BODY_ROUNDING * 2.5 * w[2] / mass;
        out->radii[i] = square > least ? sqrt(square) : 0.0;
        for (int k = 0; k < 3; k++) {
            out->axes[i][k] = j[k + (3 * i)];
        }
    }
    return MT_OK;
}

/* j := the tensor (xx yy zz xy xz yz along the body's axes) along the drawing's. */
static void drawn_tensor(const mt_scene_frame *f, const mt_axes *axes, const double v[6],
                         double j[9])
{
    const double own[3][3] = {{v[0], v[3], v[4]}, {v[3], v[1], v[5]}, {v[4], v[5], v[2]}};
    double e[3][3];
    (void)mt_axes_of(axes, f->number, e);
    for (int k = 0; k < 9; k++) {
        j[k] = 0.0;
        for (int i = 0; i < 9; i++) {
            j[k] += e[i / 3][k % 3] * own[i / 3][i % 3] * e[i % 3][k / 3];
        }
    }
}

static mt_status ellipsoid(const mt_scene_frame *f, const mt_body *b, mt_scene_body *out,
                           mt_err *err)
{
    double inertia[6];
    double most = 0.0;
    const bool plane = f->sys->dimension == 2;
    for (int k = 0; k < 6; k++) {
        inertia[k] = plane && k > 0 ? 0.0 : number_or_zero(f, b->inertia[k]);
        most = fmax(most, k < 3 ? inertia[k] : 0.0);
    }
    if (b->point_mass || !(out->mass > 0.0) || !(most > 0.0)) {
        return MT_OK;
    }
    mt_scene_ellipsoid e;
    if (plane) {
        disc(out->mass, inertia[0], &e);
    } else {
        double j[9];
        drawn_tensor(f, &b->axes, inertia, j);
        MT_TRY(solid(out->mass, j, f->work, &e, err));
    }
    bool finite = isfinite(out->mass) != 0;
    for (int i = 0; i < 3; i++) {
        const double drawn[3] = {e.axes[i][0], e.axes[i][1], e.axes[i][2]};
        scene_turn(f, f->body_of[b - f->model->bodies], drawn, e.axes[i]);
        finite = finite && isfinite(e.radii[i]);
    }
    if (finite) {
        out->ellipsoid = mt_arena_alloc(f->mem, 1, sizeof *out->ellipsoid);
        MT_TRY(mt_arena_check(f->mem, err));
        *out->ellipsoid = e;
    }
    return MT_OK;
}

mt_status mt_scene_bodies(mt_scene_frame *f, mt_err *err)
{
    const mt_system *const sys = f->sys;
    mt_scene_view *const v = f->view;
    const int n = sys->n_bodies + 1;
    mt_scene_body *const bodies = mt_arena_alloc(f->mem, (size_t)n, sizeof *bodies);
    MT_TRY(mt_arena_check(f->mem, err));
    for (int i = 0; i < n; i++) {
        mt_scene_body *const b = &bodies[i];
        const mt_pose *const p = mt_pose_of(f->pose, i - 1);
        b->kind = i == 0                           ? MT_SCENE_GROUND
                  : f->link_of[i - 1] == MT_ABSENT ? MT_SCENE_BODY
                                                   : MT_SCENE_LINK;
        b->name = mt_arena_strdup(f->mem, i == 0 ? "ground" : sys->bodies[i - 1].name);
        for (int k = 0; k < 9; k++) {
            b->rotation[k] = creal(p->r[k]);
        }
        for (int k = 0; k < 3; k++) {
            b->at[k] = creal(p->x[k]);
        }
        mt_scene_clean(sys->length_m, b->at);
    }
    add_masses(f, bodies);
    for (int i = 0; i < f->model->n_bodies; i++) {
        if (f->body_of[i] != MT_ABSENT) {
            MT_TRY(ellipsoid(f, &f->model->bodies[i], &bodies[f->body_of[i] + 1], err));
        }
    }
    v->bodies = bodies;
    v->n_bodies = n;
    return mt_arena_check(f->mem, err);
}

/* Joints, sensors and loads where they stand in the pose. */

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
        scene_turn(f, out->body[0] - 1, drawn, out->axis);
        out->has_axis = true;
    }
}

static void joint_of_bodies(const mt_scene_frame *f, const mt_joint *joint, mt_scene_joint *out)
{
    for (int side = 0; side < 2; side++) {
        const int body = scene_body_of(f, &joint->bodies[side]);
        double drawn[3];
        out->body[side] = body + 1;
        if (joint->n_at > 0) {
            scene_drawn(f, &joint->at[joint->n_at == 2 ? side : 0], drawn);
        } else {
            scene_centre(f, body, drawn);
        }
        scene_place(f, body, drawn, out->end[side]);
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
    scene_centre(f, c->body[0], centre[0]);
    out->body = c->body[0] + 1;
    if (c->kind == MT_CHANNEL_POINT || c->kind == MT_CHANNEL_ROTATION) {
        for (int k = 0; k < 3 && c->point >= 0; k++) {
            const mt_node arm = f->sys->vecs[c->point].node[k];
            centre[0][k] += arm == MT_NO_NODE ? 0.0 : f->value[arm];
        }
        scene_place(f, c->body[0], centre[0], out->at);
        return;
    }
    const double part = c->fraction == MT_NO_NODE ? 0.0 : f->value[c->fraction];
    double end[2][3];
    scene_centre(f, c->body[1], centre[1]);
    for (int side = 0; side < 2; side++) {
        scene_place(f, c->body[side], centre[side], end[side]);
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
    const int body = scene_body_of(f, &load->on);
    const mt_attach_kind kind = load->on.kind;
    double drawn[3];
    out->body = body + 1;
    if (load->at.given) {
        scene_drawn(f, &load->at, drawn);
    } else if (kind == MT_ATTACH_LINK_START || kind == MT_ATTACH_LINK_END) {
        const mt_link *const l = &f->model->links[load->on.index];
        scene_drawn(f, kind == MT_ATTACH_LINK_START ? &l->from : &l->to, drawn);
    } else if (kind == MT_ATTACH_LINK_NODE) {
        scene_link_at(f, load->on.index, load->on.element, false, drawn);
    } else {
        scene_centre(f, body, drawn);
    }
    scene_place(f, body, drawn, out->at);
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

/* Springs, dampers, and links as what is elastic, in the order of the system:
 * links, then springs of the model. */

static mt_scene_spring spring_default(mt_arena *mem, const char *name, const char *type)
{
    return (mt_scene_spring){
        .name = mt_arena_strdup(mem, name), .type = type, .stiffness = nan("")};
}

/* A spring between two bodies: at its points, or at their centres. */
static void between_bodies(const mt_scene_frame *f, const mt_spring *s, mt_scene_spring *out)
{
    for (int side = 0; side < 2; side++) {
        const mt_attach *const a = &s->bodies[side];
        const int body = scene_body_of(f, a);
        double drawn[3];
        out->body[side] = body + 1;
        if (s->n_at > 0) {
            scene_drawn(f, &s->at[s->n_at == 2 ? side : 0], drawn);
        } else if (a->kind == MT_ATTACH_LINK_NODE) {
            scene_link_at(f, a->index, a->element, false, drawn);
        } else {
            scene_centre(f, body, drawn);
        }
        scene_place(f, body, drawn, out->end[side]);
    }
    /* between turns a spring without points is where the body is that moves */
    for (int side = 0; side < 2 && s->n_at == 0 && s->type == MT_SPRING_TORSION; side++) {
        if (out->body[side] == 0) {
            memcpy(out->end[side], out->end[1 - side], sizeof out->end[side]);
        }
    }
}

/* On a joint of the model. */
static void on_joint(const mt_scene_frame *f, int joint, mt_scene_spring *out)
{
    const mt_scene_joint *const j = &f->view->joints[f->joint_of[joint]];
    memcpy(out->body, j->body, sizeof out->body);
    memcpy(out->end, j->end, sizeof out->end);
    memcpy(out->axis, j->axis, sizeof out->axis);
    out->has_axis = j->has_axis;
}

/* On a hinge of a link, between its elements hinge and hinge + 1 (from 0). */
static void on_hinge(const mt_scene_frame *f, int link, int hinge, mt_scene_spring *out)
{
    double drawn[3];
    scene_link_at(f, link, hinge + 1, false, drawn);
    for (int side = 0; side < 2; side++) {
        const int body = f->link_first[link] + hinge + side;
        out->body[side] = body + 1;
        scene_place(f, body, drawn, out->end[side]);
    }
}

/* Springs of the system from `first` on that are those of this spring of the model: they stand
 * in its order (mechanics/build_parts.c), each with its very name. They become `index` of the
 * view. Returns how many. */
static int assign_view_spring(mt_scene_frame *f, int first, const char *name, int index)
{
    int n = 0;
    for (; first + n < f->sys->n_springs && f->sys->springs[first + n].name == name; n++) {
        f->spring_of[first + n] = index;
    }
    return n;
}

/* Those of a link, which stand before all others (mechanics/build_parts.c). */
static int springs_of_link(const mt_scene_frame *f, const mt_link *l)
{
    enum { STRAINS_2D = 3, STRAINS_3D = 6 };
    if (l->kind == MT_LINK_LUMPED) {
        return l->elements - 1;
    }
    return l->elements * (f->sys->dimension == 2 ? STRAINS_2D : STRAINS_3D);
}

static void fill_view_spring(const mt_scene_frame *f, const mt_spring *s, mt_scene_spring *out)
{
    *out = spring_default(f->mem, s->name.s, mt_spring_type_name(s->type));
    if (s->joint != MT_ABSENT) {
        on_joint(f, s->joint, out);
    } else if (s->joint_link != MT_ABSENT) {
        on_hinge(f, s->joint_link, s->joint_hinge, out);
    } else {
        between_bodies(f, s, out);
    }
    if (s->type == MT_SPRING_TORSION && f->sys->dimension == 2 && !out->has_axis) {
        out->axis[2] = 1.0;
        out->has_axis = true;
    }
}

static void fill_link(const mt_scene_frame *f, int i, mt_scene_spring *out)
{
    const mt_link *const l = &f->model->links[i];
    const int last = f->link_first[i] + l->elements - (l->kind == MT_LINK_BEAM ? 0 : 1);
    double drawn[3];
    *out = spring_default(f->mem, l->name.s, "link");
    out->body[0] = f->link_first[i] + 1;
    out->body[1] = last + 1;
    scene_drawn(f, &l->from, drawn);
    scene_place(f, f->link_first[i], drawn, out->end[0]);
    scene_drawn(f, &l->to, drawn);
    scene_place(f, last, drawn, out->end[1]);
}

mt_status mt_scene_springs(mt_scene_frame *f, mt_err *err)
{
    const mt_model *const m = f->model;
    mt_scene_view *const v = f->view;
    const size_t most = (size_t)m->n_springs + (size_t)m->n_links;
    int at = 0;
    v->springs = mt_arena_alloc(f->mem, most, sizeof *v->springs);
    v->dampers = mt_arena_alloc(f->mem, (size_t)m->n_springs, sizeof *v->dampers);
    f->spring_of = mt_arena_int(f->work, (size_t)f->sys->n_springs);
    MT_TRY(mt_arena_check(f->mem, err));
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 0; i < m->n_links; i++) {
        const int n = f->link_first[i] == MT_ABSENT ? 0 : springs_of_link(f, &m->links[i]);
        for (int k = 0; k < n; k++) {
            f->spring_of[at++] = v->n_springs;
        }
        if (f->link_first[i] != MT_ABSENT) {
            fill_link(f, i, &v->springs[v->n_springs++]);
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        if (!mt_model_present(&s->in, f->configuration)) {
            continue;
        }
        mt_scene_spring *const out =
            s->damper ? &v->dampers[v->n_dampers++] : &v->springs[v->n_springs++];
        const int n = assign_view_spring(f, at, s->name.s, s->damper ? -1 : v->n_springs - 1);
        fill_view_spring(f, s, out);
        out->stiffness = n == 1 ? f->value[f->sys->springs[at].stiffness] : nan("");
        at += n;
    }
    for (; at < f->sys->n_springs; at++) { /* of joints that yield */
        f->spring_of[at] = -1;
    }
    return mt_arena_check(f->mem, err);
}

/*
 * The point q of the solid |q_i / a_i|^2 <= 1 next to x outside satisfies, with a multiplier
 * t >= 0,
 *     q_i = a_i^2 x_i / (a_i^2 + t),   F(t) = sum_i (a_i x_i / (a_i^2 + t))^2 = 1,
 * of which each term falls with t and is 0 where a_i is: F is below 1 at t = |(a_i x_i)|, and
 * where it is below 1 at t -> 0 already, only the directions without extent are outside.
 */

/* Halvings of the interval of t: to the last bit of a double. */
enum { HALVINGS = 200 };

double mt_distance_points(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

double mt_distance_segment(const double a[3], const double b[3], const double x[3],
                           double nearest[3])
{
    double dd = 0.0;
    double dx = 0.0;
    double at[3];
    for (int k = 0; k < 3; k++) {
        dd += (b[k] - a[k]) * (b[k] - a[k]);
        dx += (b[k] - a[k]) * (x[k] - a[k]);
    }
    const double part = dd > 0.0 ? fmin(fmax(dx / dd, 0.0), 1.0) : 0.0;
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + (part * (b[k] - a[k]));
        if (nearest != NULL) {
            nearest[k] = at[k];
        }
    }
    return mt_distance_points(at, x);
}

/* F(t); radii without extent have no part in it. */
static double level(const double radii[3], const double x[3], double t)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double whole = (radii[i] * radii[i]) + t;
        const double part = radii[i] > 0.0 ? radii[i] * x[i] / whole : 0.0;
        sum += part * part;
    }
    return sum;
}

double mt_distance_ellipsoid(const double radii[3], const double x[3])
{
    const double weighted[3] = {radii[0] * x[0], radii[1] * x[1], radii[2] * x[2]};
    double low = 0.0;
    double high = hypot(hypot(weighted[0], weighted[1]), weighted[2]);
    double q[3];
    if (level(radii, x, 0.0) <= 1.0) {
        high = 0.0;
    }
    for (int i = 0; i < HALVINGS && high > 0.0; i++) {
        const double middle = low + (0.5 * (high - low));
        if (level(radii, x, middle) > 1.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    for (int i = 0; i < 3; i++) {
        const double square = radii[i] * radii[i];
        q[i] = radii[i] > 0.0 ? square * x[i] / (square + high) : 0.0;
    }
    return mt_distance_points(q, x);
}

/*
 * What bodies are drawn as: lines from the mass centre of a body to all that it holds, a link
 * along itself, and from there to what it holds beside it. Points with names stand where a body
 * holds them. The distance of a joint is that of its point to what is drawn of its body without
 * it: to the link's own line; or, from where the joint is farther outside the body's ellipsoid
 * than half of that one's greatest radius, to the ellipsoid and to the lines that lead
 * elsewhere. Of a body without an ellipsoid nobody knows the extent: there a joint is far off
 * where it is farther than all else in the drawing is wide.
 */

/* Places nearer than this part of what their coordinates are the difference of are one. */
static const double SAME = 1e-9;
/* So many greatest radii outside its ellipsoid is far from a body. */
static const double FAR_RADII = 0.5;
/* Lines of one body, and points that are compared for being the same. */
enum { MOST_LINES = 200 };
/* What is kept of a distance. */
enum { DISTANCE_BITS = 30 };

/* A place that a body holds. */
typedef struct hold {
    int body;  /* of the view */
    int joint; /* of the view; -1: of something else */
    int point; /* with a name, of the model; -1 */
    int next;  /* of the same body; -1 */
    double at[3];
} hold;

typedef struct holds {
    mt_scene_frame *f;
    int n;
    int capacity;
    hold *items;
    int *first; /* [bodies of the view] */
    int *last;
    double low[3]; /* box around bodies and places */
    double high[3];
} holds;

static void include_in_hold_box(holds *h, const double x[3])
{
    for (int k = 0; k < 3; k++) {
        h->low[k] = fmin(h->low[k], x[k]);
        h->high[k] = fmax(h->high[k], x[k]);
    }
}

static void add_hold(holds *h, int body, int joint, int point, const double at[3])
{
    hold *const grown = mt_arena_grow(h->f->work, h->items, h->n, &h->capacity, sizeof *grown);
    if (grown == NULL) {
        return;
    }
    h->items = grown;
    h->items[h->n] = (hold){body, joint, point, -1, {at[0], at[1], at[2]}};
    if (h->first[body] < 0) {
        h->first[body] = h->n;
    } else {
        h->items[h->last[body]].next = h->n;
    }
    h->last[body] = h->n++;
    include_in_hold_box(h, at);
}

/* A position of the model on a body of the system. */
static void add_position(holds *h, int body, int joint, const mt_position *p)
{
    double drawn[3];
    double at[3];
    scene_drawn(h->f, p, drawn);
    scene_place(h->f, body, drawn, at);
    add_hold(h, body + 1, joint, p->point, at);
}

static void add_pairs(holds *h)
{
    const mt_model *const m = h->f->model;
    int joint = 0;
    for (int i = 0; i < m->n_joints; i++) {
        const mt_joint *const j = &m->joints[i];
        if (!mt_model_present(&j->in, h->f->configuration)) {
            continue;
        }
        for (int side = 0; side < 2 && j->n_at > 0; side++) {
            add_position(h, scene_body_of(h->f, &j->bodies[side]), joint,
                         &j->at[j->n_at == 2 ? side : 0]);
        }
        joint++;
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const bool there = mt_model_present(&s->in, h->f->configuration) && s->n_at > 0;
        for (int side = 0; side < 2 && there; side++) {
            add_position(h, scene_body_of(h->f, &s->bodies[side]), -1,
                         &s->at[s->n_at == 2 ? side : 0]);
        }
    }
}

static void add_others(holds *h)
{
    const mt_scene_frame *const f = h->f;
    const mt_model *const m = f->model;
    for (int i = 0; i < m->n_bodies; i++) {
        if (f->body_of[i] != MT_ABSENT) {
            add_position(h, f->body_of[i], -1, &m->bodies[i].centre);
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        const mt_link *const l = &m->links[i];
        if (f->link_first[i] != MT_ABSENT) {
            const int last = f->link_first[i] + l->elements - (l->kind == MT_LINK_BEAM ? 0 : 1);
            add_position(h, f->link_first[i], -1, &l->from);
            add_position(h, last, -1, &l->to);
        }
    }
    for (int i = 0; i < m->n_sensors; i++) {
        const mt_sensor *const s = &m->sensors[i];
        if (s->on_kind == MT_ATTACH_BODY && s->at.given && f->body_of[s->on] != MT_ABSENT) {
            add_position(h, f->body_of[s->on], -1, &s->at);
        }
    }
    for (int i = 0; i < m->n_loads; i++) {
        const mt_load *const o = &m->loads[i];
        if (o->on.name.s != NULL && o->at.given && mt_model_present(&o->in, f->configuration)) {
            add_position(h, scene_body_of(f, &o->on), -1, &o->at);
        }
    }
}

/* Own line of a link's element or node of the view, in the pose. */
static void link_line(const mt_scene_frame *f, int body, double from[3], double to[3])
{
    const int b = body - 1;
    const int link = f->link_of[b];
    const int k = b - f->link_first[link];
    const mt_link *const l = &f->model->links[link];
    double drawn[2][3];
    if (l->kind == MT_LINK_BEAM) { /* half of the elements beside a node */
        scene_link_at(f, link, k > 0 ? k - 1 : 0, k > 0, drawn[0]);
        scene_link_at(f, link, k, k < l->elements, drawn[1]);
    } else {
        scene_link_at(f, link, k, false, drawn[0]);
        scene_link_at(f, link, k + 1, false, drawn[1]);
    }
    scene_place(f, b, drawn[0], from);
    scene_place(f, b, drawn[1], to);
}

static double hold_box_size(const holds *h)
{
    return mt_distance_points(h->low, h->high);
}

static void add_view_line(mt_scene_view *v, int *capacity, mt_arena *mem,
                          const mt_scene_line *line)
{
    mt_scene_line *const grown =
        mt_arena_grow(mem, v->lines, v->n_lines, capacity, sizeof *grown);
    if (grown != NULL) {
        v->lines = grown;
        v->lines[v->n_lines++] = *line;
    }
}

/* True where there is a line of the body to this place already. They begin at `first`. */
static bool has_line(const mt_scene_view *v, int first, const double to[3], double same)
{
    bool has = false;
    for (int i = first; i < v->n_lines && !has; i++) {
        has = mt_distance_points(v->lines[i].to, to) <= same;
    }
    return has;
}

static void lines_of(const holds *h, int body, int *capacity)
{
    mt_scene_view *const v = h->f->view;
    const bool link = v->bodies[body].kind == MT_SCENE_LINK;
    const double same = SAME * hold_box_size(h);
    const int first = v->n_lines;
    mt_scene_line own = {.body = body};
    if (link) {
        link_line(h->f, body, own.from, own.to);
        add_view_line(v, capacity, h->f->mem, &own);
    }
    for (int i = h->first[body]; i >= 0 && v->n_lines - first < MOST_LINES;
         i = h->items[i].next) {
        mt_scene_line line = {.body = body};
        double off = mt_distance_points(v->bodies[body].at, h->items[i].at);
        memcpy(line.from, v->bodies[body].at, sizeof line.from);
        memcpy(line.to, h->items[i].at, sizeof line.to);
        if (link) {
            off = mt_distance_segment(own.from, own.to, line.to, line.from);
        }
        if (off > same && !has_line(v, first, line.to, same)) {
            add_view_line(v, capacity, h->f->mem, &line);
        }
    }
}

/* Distance to the lines from the centre of a body to its other items, without this joint. */
static double distance_to_lines(const holds *h, int body, int joint, const double at[3])
{
    const double *const centre = h->f->view->bodies[body].at;
    double least = mt_distance_points(centre, at);
    int seen = 0;
    for (int i = h->first[body]; i >= 0 && seen < MOST_LINES; i = h->items[i].next, seen++) {
        if (h->items[i].joint != joint) {
            least = fmin(least, mt_distance_segment(centre, h->items[i].at, at, NULL));
        }
    }
    return least;
}

/* Size of the drawing without one joint. */
static double rest_of(const holds *h, int joint)
{
    const mt_scene_view *const v = h->f->view;
    holds rest = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                  .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (int i = 1; i < v->n_bodies; i++) {
        include_in_hold_box(&rest, v->bodies[i].at);
    }
    for (int i = 0; i < h->n; i++) {
        if (h->items[i].joint != joint) {
            include_in_hold_box(&rest, h->items[i].at);
        }
    }
    return hold_box_size(&rest);
}

static double distance_to_body(const holds *h, int body, int joint, const double at[3])
{
    const mt_scene_body *const b = &h->f->view->bodies[body];
    const mt_scene_ellipsoid *const e = b->ellipsoid;
    const double lines = distance_to_lines(h, body, joint, at);
    if (e == NULL) {
        return lines > rest_of(h, joint) ? lines : 0.0;
    }
    double x[3];
    for (int i = 0; i < 3; i++) {
        x[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            x[i] += e->axes[i][k] * (at[k] - b->at[k]);
        }
    }
    const double outside = mt_distance_ellipsoid(e->radii, x);
    const double greatest = fmax(fmax(e->radii[0], e->radii[1]), e->radii[2]);
    return outside > FAR_RADII * greatest ? fmin(outside, lines) : 0.0;
}

static void note_joint_distance(const holds *h, const hold *it)
{
    mt_scene_view *const v = h->f->view;
    mt_scene_joint *const joint = &v->joints[it->joint];
    double off = 0.0;
    switch (v->bodies[it->body].kind) {
    case MT_SCENE_GROUND:
        return;
    case MT_SCENE_LINK: {
        double from[3];
        double to[3];
        link_line(h->f, it->body, from, to);
        off = mt_distance_segment(from, to, it->at, NULL);
        break;
    }
    case MT_SCENE_BODY:
        off = distance_to_body(h, it->body, it->joint, it->at);
        break;
    }
    /* rounded, so that configurations of one shape have one distance */
    const double step = ldexp(1.0, ilogb(fmax(off, DBL_MIN)) - DISTANCE_BITS);
    off = step * rint(off / step);
    if (off > SAME * hold_box_size(h) && off > joint->distance) {
        joint->distance = off;
        joint->far = it->body;
    }
}

/* Each point with a name once where its bodies agree about its place. */
static void name_points(const holds *h)
{
    mt_scene_view *const v = h->f->view;
    const mt_model *const m = h->f->model;
    int *const seen = mt_arena_int(h->f->work, (size_t)m->n_points);
    int capacity = 0;
    if (mt_arena_failed(h->f->work)) {
        return;
    }
    for (int pass = 0; pass < 2; pass++) { /* bodies before the ground, which stands still */
        for (int i = 0; i < h->n; i++) {
            const hold *const it = &h->items[i];
            if (it->point < 0 || (it->body == 0) != (pass == 1)) {
                continue;
            }
            const int last = seen[it->point];
            if (last > 0 && (mt_distance_points(v->points[last - 1].at, it->at) <=
                                 SAME * hold_box_size(h) ||
                             v->points[last - 1].body == it->body)) {
                continue;
            }
            mt_scene_point *const grown =
                mt_arena_grow(h->f->mem, v->points, v->n_points, &capacity, sizeof *grown);
            if (grown == NULL) {
                return;
            }
            v->points = grown;
            mt_scene_point *const p = &v->points[v->n_points++];
            p->name = mt_arena_strdup(h->f->mem, m->points[it->point].name.s);
            p->body = it->body;
            memcpy(p->at, it->at, sizeof p->at);
            seen[it->point] = v->n_points;
        }
    }
}

mt_status mt_scene_lines(mt_scene_frame *f, mt_err *err)
{
    mt_scene_view *const v = f->view;
    holds h = {.f = f,
               .first = mt_arena_int(f->work, (size_t)v->n_bodies),
               .last = mt_arena_int(f->work, (size_t)v->n_bodies),
               .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
               .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    int capacity = 0;
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 0; i < v->n_bodies; i++) {
        h.first[i] = -1;
        if (i > 0) {
            include_in_hold_box(&h, v->bodies[i].at);
        }
    }
    add_pairs(&h);
    add_others(&h);
    MT_TRY(mt_arena_check(f->work, err));
    for (int i = 1; i < v->n_bodies; i++) {
        lines_of(&h, i, &capacity);
    }
    for (int i = 0; i < h.n; i++) {
        if (h.items[i].joint >= 0) {
            note_joint_distance(&h, &h.items[i]);
        }
    }
    name_points(&h);
    MT_TRY(mt_arena_check(f->work, err));
    return mt_arena_check(f->mem, err);
}
