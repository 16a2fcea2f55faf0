/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Joints as equations of measures. With P on body a, Q on body b (the joint's point as drawn on
 * each), a the joint's axis and b, c = a x b perpendicular to it:
 *   point      (Q - P) = 0 along all axes                    parallel   b_a.a_b = c_a.a_b = 0
 *   on line    b_a . (Q - P) = c_a . (Q - P) = 0             no twist   b_a . c_b = 0
 * revolute = point + parallel; cylindrical = on line + parallel; prismatic = cylindrical + no
 * twist; spherical = point; universal = point + a_a . a'_b as drawn; planar = a_a . (Q - P) = 0
 * + parallel; fixed = point + no rotation; distance |Q - P| = length; on plane a_a . (Q - P) =
 * 0; orientation = no rotation. A gear or rack couples the coordinates of two joints: s_1 -
 * ratio s_0 as drawn. In two dimensions what lies out of the plane is left out.
 */
#include "mechanics/build.h"
#include "model/joint.h"

static void plane(mt_builder *b, const int body[2], const int arm[2], int dir)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_PLANE, body[0], body[1]);
    def.point[0] = arm[0];
    def.point[1] = arm[1];
    def.dir[0] = dir;
    mt_build_constraint(b, mt_build_measure(b, &def), MT_NO_NODE, false);
}

static void dot(mt_builder *b, const int body[2], int u, int v, bool as_drawn)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_DOT, body[0], body[1]);
    def.dir[0] = u;
    def.dir[1] = v;
    mt_build_constraint(b, mt_build_measure(b, &def), MT_NO_NODE, as_drawn);
}

static void coincide(mt_builder *b, const int body[2], const int arm[2])
{
    for (int i = 0; i < b->sys->dimension; i++) {
        plane(b, body, arm, b->axis_vec[i]);
    }
}

static void parallel(mt_builder *b, const int body[2], int axis)
{
    dot(b, body, mt_build_perp(b, axis, 1), axis, false);
    dot(b, body, mt_build_perp(b, axis, 2), axis, false);
}

static void no_rotation(mt_builder *b, const int body[2])
{
    dot(b, body, b->axis_vec[0], b->axis_vec[1], false);
    if (b->sys->dimension == 3) {
        dot(b, body, b->axis_vec[1], b->axis_vec[2], false);
        dot(b, body, b->axis_vec[2], b->axis_vec[0], false);
    }
}

static void on_line(mt_builder *b, const int body[2], const int arm[2], int axis)
{
    plane(b, body, arm, mt_build_perp(b, axis, 1));
    if (b->sys->dimension == 3) {
        plane(b, body, arm, mt_build_perp(b, axis, 2));
    }
}

static void distance(mt_builder *b, const int body[2], const int arm[2], mt_node length)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_DISTANCE, body[0], body[1]);
    def.point[0] = arm[0];
    def.point[1] = arm[1];
    mt_build_constraint(b, mt_build_measure(b, &def), length, length == MT_NO_NODE);
}

void mt_build_joint_equations(mt_builder *b, mt_joint_type type, const int body[2],
                              const int arm[2], const int axis[2], mt_node length)
{
    const bool spatial = b->sys->dimension == 3;
    switch (type) {
    case MT_JOINT_FIXED:
        coincide(b, body, arm);
        no_rotation(b, body);
        break;
    case MT_JOINT_REVOLUTE:
        coincide(b, body, arm);
        if (spatial) {
            parallel(b, body, axis[0]);
        }
        break;
    case MT_JOINT_PRISMATIC:
        on_line(b, body, arm, axis[0]);
        if (spatial) {
            parallel(b, body, axis[0]);
            dot(b, body, mt_build_perp(b, axis[0], 1), mt_build_perp(b, axis[0], 2), false);
        } else {
            no_rotation(b, body);
        }
        break;
    case MT_JOINT_PIN_IN_SLOT:
    case MT_JOINT_POINT_ON_LINE:
        on_line(b, body, arm, axis[0]);
        break;
    case MT_JOINT_DISTANCE:
        distance(b, body, arm, length);
        break;
    case MT_JOINT_CYLINDRICAL:
        on_line(b, body, arm, axis[0]);
        parallel(b, body, axis[0]);
        break;
    case MT_JOINT_SPHERICAL:
        coincide(b, body, arm);
        break;
    case MT_JOINT_UNIVERSAL:
        coincide(b, body, arm);
        dot(b, body, axis[0], axis[1], true);
        break;
    case MT_JOINT_PLANAR:
        plane(b, body, arm, axis[0]);
        parallel(b, body, axis[0]);
        break;
    case MT_JOINT_POINT_ON_PLANE:
        plane(b, body, arm, axis[0]);
        break;
    case MT_JOINT_ORIENTATION:
        no_rotation(b, body);
        break;
    case MT_JOINT_GEAR:
    case MT_JOINT_RACK:
    case MT_JOINT_TYPE_COUNT:
        break;
    }
}

/* The joint's coordinate from the reference position: an angle about its axis or a displacement
 * along it; -1: none. */
static int coordinate_of(mt_builder *b, mt_coordinate coordinate, const int body[2],
                         const int arm[2], int axis)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_PLANE, body[0], body[1]);
    switch (coordinate) {
    case MT_COORDINATE_ANGLE:
        return mt_build_angle(b, body[0], body[1], axis);
    case MT_COORDINATE_DISPLACEMENT:
        def.point[0] = arm[0];
        def.point[1] = arm[1];
        def.dir[0] = axis;
        return mt_build_measure(b, &def);
    case MT_COORDINATE_NONE:
        break;
    }
    return -1;
}

static mt_system_joint *new_joint(mt_builder *b, const mt_joint *joint, const int body[2])
{
    mt_system *const sys = b->sys;
    mt_system_joint *const joints =
        mt_arena_grow(&sys->mem, sys->joints, sys->n_joints, &sys->cap_joints, sizeof *joints);
    if (joints == NULL) {
        return NULL;
    }
    sys->joints = joints;
    sys->joints[sys->n_joints] =
        (mt_system_joint){.name = joint->name.s,
                          .type = joint->type,
                          .first = sys->n_constraints,
                          .coordinate = -1,
                          .body = {body[0], body[1]},
                          .model_joint = (int)(joint - b->model->joints),
                          .link = MT_ABSENT,
                          .hinge = -1};
    b->joint_at[joint - b->model->joints] = sys->n_joints;
    return &sys->joints[sys->n_joints++];
}

static mt_status build_gear(mt_builder *b, const mt_joint *joint)
{
    mt_system *const sys = b->sys;
    const int first = b->joint_at[joint->gear_joint[0]];
    const int second = b->joint_at[joint->gear_joint[1]];
    if (first < 0 || second < 0 || sys->joints[first].coordinate < 0 ||
        sys->joints[second].coordinate < 0) {
        return mt_fail(b->err, MT_E_INPUT,
                       "joint \"%s\": its two joints must be present in configuration \"%s\" "
                       "and have a coordinate",
                       joint->name.s, b->model->configurations[sys->configuration].name.s);
    }
    mt_system_joint *const made = new_joint(
        b, joint, (const int[2]){sys->joints[first].body[1], sys->joints[second].body[1]});
    if (made == NULL) {
        return MT_OK; /* the arena remembers */
    }
    mt_build_constraint(b, sys->joints[second].coordinate, MT_NO_NODE, true);
    if (sys->n_constraints > made->first) {
        mt_constraint_def *const c = &sys->constraints[made->first];
        c->terms = 2;
        c->measure[1] = sys->joints[first].coordinate;
        c->coefficient[0] = b->one;
        const mt_num ratio =
            joint->type == MT_JOINT_RACK ? joint->ratio_m_per_rad : joint->ratio;
        c->coefficient[1] = mt_program_unary(&sys->program, MT_OP_NEG,
                                             mt_build_num_or(b, ratio, b->one), MT_NO_ADDR);
        made->count = 1;
    }
    return MT_OK;
}

/* The points of the joint on both bodies; without `at` the centres. */
static void joint_arms(mt_builder *b, const mt_joint *joint, const int body[2], int arm[2])
{
    const char *const what = mt_build_name(b, "point of joint \"%s\"", joint->name.s);
    for (int side = 0; side < 2; side++) {
        mt_node at[3];
        if (joint->n_at == 0) {
            arm[side] = -1;
            continue;
        }
        mt_build_position(b, &joint->at[joint->n_at == 2 ? side : 0], at);
        arm[side] = mt_build_arm(b, body[side], at, what);
    }
}

static mt_status build_joint(mt_builder *b, const mt_joint *joint)
{
    const mt_joint_kind *const kind = mt_joint_kind_of(joint->type);
    int body[2];
    int arm[2];
    int axis[2] = {b->axis_vec[2], -1};
    if (!mt_build_attach(b, &joint->bodies[0], &body[0]) ||
        !mt_build_attach(b, &joint->bodies[1], &body[1])) {
        return mt_fail(b->err, MT_E_INPUT,
                       "joint \"%s\" holds a body that is not in configuration \"%s\"",
                       joint->name.s, b->model->configurations[b->sys->configuration].name.s);
    }
    if (body[0] == body[1]) {
        return mt_fail(b->err, MT_E_INPUT, "joint \"%s\" connects a body with itself",
                       joint->name.s);
    }
    joint_arms(b, joint, body, arm);
    const bool closed = joint->n_at == 1 || kind->most_at == 0;
    if (!closed || joint->length != MT_ABSENT) {
        b->sys->drawn_closed = false;
    }
    if (joint->has_axis) {
        mt_node node[3];
        mt_build_coordinates(b, joint->axis, node);
        axis[0] = mt_build_vec(b, MT_VEC_UNIT, node,
                               mt_build_name(b, "axis of joint \"%s\"", joint->name.s));
    }
    if (joint->has_axis_b) {
        mt_node node[3];
        mt_build_coordinates(b, joint->axis_b, node);
        axis[1] = mt_build_vec(b, MT_VEC_UNIT, node,
                               mt_build_name(b, "axis_b of joint \"%s\"", joint->name.s));
    }
    mt_system_joint *const made = new_joint(b, joint, body);
    if (made == NULL) {
        return MT_OK;
    }
    mt_build_joint_equations(b, joint->type, body, arm, axis, mt_build_num(b, joint->length));
    if (joint->mass != MT_ABSENT) {
        const mt_node mass = mt_build_num(b, joint->mass);
        mt_build_rod(b, body, arm, mass, mt_build_item(b, joint->name.s, mass));
    }
    made->count = b->sys->n_constraints - made->first;
    made->coordinate = coordinate_of(b, kind->coordinate, body, arm, axis[0]);
    made->angle = kind->coordinate == MT_COORDINATE_ANGLE;
    return MT_OK;
}

mt_status mt_build_joints(mt_builder *b)
{
    for (int pass = 0; pass < 2; pass++) { /* gears need the joints that they couple */
        for (int i = 0; i < b->model->n_joints; i++) {
            const mt_joint *const joint = &b->model->joints[i];
            if (mt_joint_kind_of(joint->type)->couples != (pass == 1) ||
                !mt_model_present(&joint->in, b->sys->configuration)) {
                continue;
            }
            MT_TRY(pass == 1 ? build_gear(b, joint) : build_joint(b, joint));
        }
    }
    return MT_OK;
}
