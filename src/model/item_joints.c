/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints: each has what its type needs (mt_joint_kind). */
#include "model/item.h"
#include "model/model.h"

#define NAME_OF(id, name) name,
static const char *const JOINT_NAMES[] = {MT_JOINT_LIST(NAME_OF)};

/* A joint that could not be read is of no type. */
static void joint_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_joint *const j = item;
    (void)which;
    j->type = mt_object_wrong(r, o) ? MT_JOINT_TYPE_COUNT : j->type;
}

#define THIS mt_joint
static const mt_key JOINT[] = {
    MT_I_NAME("joint"),
    MT_M_CHOICE(
        "type", true, type, mt_joint_type, "type", JOINT_NAMES,
        "Two dimensions: fixed, revolute, prismatic, pin-in-slot, distance, orientation (the "
        "bodies turn together, translations are free), gear, rack. Three: all but pin-in-slot; "
        "point-on-plane keeps a point of the second body on a plane of the first."),
    MT_I_TWO("bodies", bodies,
             "The two bodies or parts that it connects: its coordinate is how far the second "
             "stands against the first, about the axis (right-handed; in two dimensions "
             "counter-clockwise) or along it. Each \"ground\", a body, or a part of a link: "
             "\"L.start\", \"L.end\", the rigid element \"L.3\", or the node \"L.node3\" (of "
             "beam elements, or where rigid elements meet; \"L.node0\" is the start).",
             .examples = "[[\"ground\", \"beam.start\"]]"),
    MT_I_AT,
    MT_I_VECTOR("axis", axis, has_axis, AXIS,
                "Direction: of turning, of sliding, or the normal of a plane; fixed to the "
                "first body."),
    MT_I_VECTOR("axis_b", axis_b, has_axis_b, AXIS,
                "Universal joint: the second axis, fixed to the second body."),
    MT_I_NUM("length_m", false, length, POSITIVE,
             "Distance joint: its length [m]. Absent: as drawn."),
    MT_I_NUM("mass_kg", false, mass, NOT_NEGATIVE,
             "Distance joint: mass of a uniform thin rod between its points, with a ball joint "
             "at each end [kg]. Absent: a rod without mass."),
    MT_I_TWO("joints", gear_joints,
             "Gear: the two revolute joints that it couples. Rack: a revolute joint (the "
             "pinion), then a prismatic one, a slot or a line."),
    MT_I_NUM("ratio", false, ratio, NONZERO,
             "Gear: angle of the second joint divided by that of the first [1], each of its "
             "second body against its first, about its own axis; not 0; negative for wheels "
             "that mesh outside: minus the teeth of the first by those of the second."),
    MT_I_NUM("ratio_m_per_rad", false, ratio_m_per_rad, NONZERO,
             "Rack: displacement of the second joint divided by the angle of the first "
             "[m/rad]: the pitch radius, with a sign; not 0."),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_joint_keys = {MT_I_TABLE("joint", JOINT, mt_joint),
                                    .finish = joint_finish,
                                    .says = "A joint between two bodies."};

static void check_point_mass(mt_resolve *f, const mt_joint *j, int side)
{
    const mt_attach *const a = &j->bodies[side];
    if (!mt_resolve_is_point_mass(f, a)) {
        return;
    }
    const mt_body *const body = &f->m->bodies[a->index];
    if (mt_joint_kind_of(j->type)->turns[f->m->dimension - 2][side]) {
        mt_diag_error(
            f->d, a->name.addr,
            "%s %s joint needs the orientation of \"%s\", which is a point mass: give "
            "it \"inertia_kg_m2\"%s",
            mt_joint_article(j->type), mt_joint_type_name(j->type), body->name.s,
            j->type == MT_JOINT_ORIENTATION ? ""
            : f->m->dimension == 2          ? " or use a revolute joint"
                                            : " or use a spherical joint");
        return;
    }
    const int at = j->n_at == 2 ? side : 0;
    if (j->n_at > 0 && !mt_resolve_same_position(f->m, &j->at[at], &body->centre)) {
        mt_diag_error(f->d, j->at[at].addr,
                      "\"%s\" is a point mass and can be held at its centre only: use the same "
                      "point for both",
                      body->name.s);
    }
}

/* A gear couples two angles, a rack an angle and a displacement. */
static void check_coupled(mt_resolve *f, const mt_joint *j, int side)
{
    const mt_joint *const other = &f->m->joints[j->gear_joint[side]];
    const bool slides = j->type == MT_JOINT_RACK && side == 1;
    if (other->type == MT_JOINT_TYPE_COUNT) {
        return;
    }
    if (mt_joint_kind_of(other->type)->coordinate !=
        (slides ? MT_COORDINATE_DISPLACEMENT : MT_COORDINATE_ANGLE)) {
        mt_diag_error(f->d, j->gear_joints[side].addr, "%s; \"%s\" is %s",
                      j->type == MT_JOINT_GEAR
                          ? "a gear couples revolute joints"
                          : "a rack couples a revolute joint, then one that slides",
                      other->name.s, mt_joint_type_name(other->type));
        return;
    }
    for (int k = 0; k < 2 && !slides; k++) {
        if (mt_resolve_is_point_mass(f, &other->bodies[k])) {
            mt_diag_error(f->d, j->gear_joints[side].addr,
                          "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                          other->bodies[k].name.s, other->name.s);
        }
    }
}

static void check_gear(mt_resolve *f, mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    const bool rack = j->type == MT_JOINT_RACK;
    const mt_names *const table = &f->m->tables->joints;
    for (int side = 0; side < 2; side++) {
        j->gear_joint[side] = mt_resolve_find(f, j->gear_joints[side], table, "joint");
        if (j->gear_joint[side] != MT_ABSENT) {
            const mt_joint *const other = &f->m->joints[j->gear_joint[side]];
            check_coupled(f, j, side);
            mt_resolve_needs(f, j->name, "joint", &j->in, &other->in, "joint", other->name.s);
        }
    }
    if (j->gear_joint[0] != MT_ABSENT && j->gear_joint[0] == j->gear_joint[1]) {
        mt_diag_error(f->d, j->gear_joints[1].addr,
                      "%s \"%s\" couples joint \"%s\" with itself", type, j->name.s,
                      j->gear_joints[1].s);
    }
    if (j->gear_joints[0].s == NULL || j->gear_joints[1].s == NULL ||
        (rack ? j->ratio_m_per_rad : j->ratio) == MT_ABSENT) {
        mt_diag_error(f->d, j->name.addr, "%s \"%s\" needs \"joints\" (two of them) and \"%s\"",
                      type, j->name.s, rack ? "ratio_m_per_rad" : "ratio");
    }
    if (j->bodies[0].name.s != NULL) {
        mt_diag_error(f->d, j->bodies[0].name.addr,
                      "a %s has no \"bodies\": its joints name them", type);
    }
}

static void check_at(mt_resolve *f, const mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    if (j->n_at >= mt_joint_kind_of(j->type)->least_at &&
        j->n_at <= mt_joint_kind_of(j->type)->most_at) {
        return;
    }
    if (mt_joint_kind_of(j->type)->most_at == 0) {
        mt_diag_error(f->d, j->at[0].addr, "%s %s joint has no \"at\"",
                      mt_joint_article(j->type), type);
    } else {
        mt_diag_error(f->d, j->n_at > 0 ? j->at[0].addr : j->name.addr,
                      "a %s joint needs \"at\": %s", type,
                      mt_joint_kind_of(j->type)->least_at == 2
                          ? "a pair of points, one on each body"
                          : "a point, or the point on each body");
    }
}

static void check_members(mt_resolve *f, const mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    const int dimension = f->m->dimension;
    check_at(f, j);
    const bool axis = mt_joint_kind_of(j->type)->axis[dimension - 2];
    if (axis != j->has_axis) {
        mt_diag_error(f->d, j->has_axis ? mt_resolve_addr(f->m, j->axis[0]) : j->name.addr,
                      "%s %s joint in %s dimensions %s \"axis\"", mt_joint_article(j->type),
                      type, dimension == 2 ? "two" : "three", axis ? "needs" : "has no");
    }
    if (mt_joint_kind_of(j->type)->axis_b != j->has_axis_b) {
        mt_diag_error(f->d, j->has_axis_b ? mt_resolve_addr(f->m, j->axis_b[0]) : j->name.addr,
                      "%s %s joint %s \"axis_b\"", mt_joint_article(j->type), type,
                      j->has_axis_b ? "has no" : "needs");
    }
    if (j->length != MT_ABSENT && j->type != MT_JOINT_DISTANCE) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, j->length), "%s %s joint has no \"length_m\"",
                      mt_joint_article(j->type), type);
    }
    if (j->mass != MT_ABSENT && j->type != MT_JOINT_DISTANCE) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, j->mass),
                      "%s %s joint has no \"mass_kg\": a distance, which may be a rod, has",
                      mt_joint_article(j->type), type);
    }
    if (!mt_joint_kind_of(j->type)->couples &&
        (j->gear_joints[0].s != NULL || j->ratio != MT_ABSENT)) {
        mt_diag_error(f->d, j->name.addr,
                      "%s %s joint has no \"joints\" and \"ratio\": a gear has",
                      mt_joint_article(j->type), type);
    }
    if (j->ratio_m_per_rad != MT_ABSENT && j->type != MT_JOINT_RACK) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, j->ratio_m_per_rad),
                      "%s %s joint has no \"ratio_m_per_rad\": a rack has",
                      mt_joint_article(j->type), type);
    }
    if (j->ratio != MT_ABSENT && j->type == MT_JOINT_RACK) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, j->ratio),
                      "a rack has no \"ratio\": its \"ratio_m_per_rad\" is the pitch radius");
    }
}

static void check_bodies(mt_resolve *f, const mt_joint *j)
{
    const mt_attach *const a = &j->bodies[0];
    const mt_attach *const b = &j->bodies[1];
    if (a->name.s == NULL || b->name.s == NULL) {
        mt_diag_error(f->d, j->name.addr, "joint \"%s\" needs \"bodies\": two of them",
                      j->name.s);
        return;
    }
    if (mt_resolve_same_attach(a, b)) {
        mt_diag_error(f->d, b->name.addr, "joint \"%s\" holds \"%s\" to itself", j->name.s,
                      a->name.s);
    }
    for (int side = 0; side < 2; side++) {
        mt_resolve_needs_attach(f, j->name, "joint", &j->in, &j->bodies[side]);
        check_point_mass(f, j, side);
    }
}

static void check_joint(mt_resolve *f, mt_joint *j)
{
    if (!mt_joint_kind_of(j->type)->in[f->m->dimension - 2]) {
        mt_diag_error(f->d, j->name.addr, "there is no %s joint in %s dimensions",
                      mt_joint_type_name(j->type), f->m->dimension == 2 ? "two" : "three");
        return;
    }
    check_members(f, j);
    if (mt_joint_kind_of(j->type)->couples) {
        check_gear(f, j);
    } else {
        check_bodies(f, j);
    }
}

void mt_resolve_joints(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_joints; i++) {
        mt_joint *const j = &f->m->joints[i];
        j->gear_joint[0] = MT_ABSENT;
        j->gear_joint[1] = MT_ABSENT;
        for (int side = 0; side < 2; side++) {
            mt_resolve_attach(f, &j->bodies[side]);
        }
        for (int k = 0; k < j->n_at; k++) {
            mt_resolve_position(f, &j->at[k]);
        }
        if (j->type != MT_JOINT_TYPE_COUNT && f->m->dimension != 0) {
            check_joint(f, j);
        }
    }
}
