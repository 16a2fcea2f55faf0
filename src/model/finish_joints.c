/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints: what each type needs, by a table. */
#include "model/finish.h"

/* By mt_joint_type: is there such a joint in two, in three dimensions? */
#define IN_DIMENSIONS(id, name, in2, in3, coordinate) {in2, in3},
static const bool IN_DIMENSION[][2] = {MT_JOINT_LIST(IN_DIMENSIONS)};
#undef IN_DIMENSIONS

/* What a type needs beside its two bodies, by mt_joint_type. */
static const struct {
    int least_at;
    int most_at;
    bool axis[2]; /* needed in two and in three dimensions */
    bool axis_b;  /* in three */
    /* [dimension - 2][body]: uses the body's orientation, which a point mass has not */
    bool turns[2][2];
} RULES[] = {
    [MT_JOINT_FIXED] = {0, 2, {false, false}, false, {{true, true}, {true, true}}},
    [MT_JOINT_REVOLUTE] = {1, 2, {false, true}, false, {{false, false}, {true, true}}},
    [MT_JOINT_PRISMATIC] = {1, 2, {true, true}, false, {{true, true}, {true, true}}},
    [MT_JOINT_PIN_IN_SLOT] = {1, 2, {true, true}, false, {{true, false}, {true, false}}},
    [MT_JOINT_DISTANCE] = {2, 2, {false, false}, false, {{false, false}, {false, false}}},
    [MT_JOINT_CYLINDRICAL] = {1, 2, {false, true}, false, {{true, true}, {true, true}}},
    [MT_JOINT_SPHERICAL] = {1, 2, {false, false}, false, {{false, false}, {false, false}}},
    [MT_JOINT_UNIVERSAL] = {1, 2, {false, true}, true, {{true, true}, {true, true}}},
    [MT_JOINT_PLANAR] = {1, 2, {false, true}, false, {{true, true}, {true, true}}},
    [MT_JOINT_POINT_ON_LINE] = {1, 2, {false, true}, false, {{true, false}, {true, false}}},
    [MT_JOINT_POINT_ON_PLANE] = {1, 2, {false, true}, false, {{true, false}, {true, false}}},
    [MT_JOINT_ORIENTATION] = {0, 0, {false, false}, false, {{true, true}, {true, true}}},
    [MT_JOINT_GEAR] = {0, 0, {false, false}, false, {{false, false}, {false, false}}},
    [MT_JOINT_RACK] = {0, 0, {false, false}, false, {{false, false}, {false, false}}},
};

/* "a" or "an" before the name of the type. */
static const char *article(mt_joint_type type)
{
    return type == MT_JOINT_ORIENTATION ? "an" : "a";
}

static void check_point_mass(mt_finish *f, const mt_joint *j, int side)
{
    const mt_attach *const a = &j->bodies[side];
    if (!mt_finish_is_point_mass(f, a)) {
        return;
    }
    const mt_body *const body = &f->m->bodies[a->index];
    if (RULES[j->type].turns[f->m->dimension - 2][side]) {
        mt_diag_error(
            f->d, a->name.addr,
            "%s %s joint needs the orientation of \"%s\", which is a point mass: give "
            "it \"inertia_kg_m2\"%s",
            article(j->type), mt_joint_type_name(j->type), body->name.s,
            j->type == MT_JOINT_ORIENTATION ? ""
            : f->m->dimension == 2          ? " or use a revolute joint"
                                            : " or use a spherical joint");
        return;
    }
    const int at = j->n_at == 2 ? side : 0;
    if (j->n_at > 0 && !mt_finish_same_position(f->m, &j->at[at], &body->centre)) {
        mt_diag_error(f->d, j->at[at].addr,
                      "\"%s\" is a point mass and can be held at its centre only: use the same "
                      "point for both",
                      body->name.s);
    }
}

/* By mt_joint_type: 'a' angle, 'd' displacement, '-' none. */
#define COORDINATE_OF(id, name, in2, in3, coordinate) coordinate,
static const char COORDINATE[] = {MT_JOINT_LIST(COORDINATE_OF)};
#undef COORDINATE_OF

static bool is_geared(mt_joint_type type)
{
    return type == MT_JOINT_GEAR || type == MT_JOINT_RACK;
}

/* A gear couples two angles, a rack an angle and a displacement. */
static void check_coupled(mt_finish *f, const mt_joint *j, int side)
{
    const mt_joint *const other = &f->m->joints[j->gear_joint[side]];
    const bool slides = j->type == MT_JOINT_RACK && side == 1;
    if (other->type == MT_JOINT_TYPE_COUNT) {
        return;
    }
    if (COORDINATE[other->type] != (slides ? 'd' : 'a')) {
        mt_diag_error(f->d, j->gear_joints[side].addr, "%s; \"%s\" is %s",
                      j->type == MT_JOINT_GEAR
                          ? "a gear couples revolute joints"
                          : "a rack couples a revolute joint, then one that slides",
                      other->name.s, mt_joint_type_name(other->type));
        return;
    }
    for (int k = 0; k < 2 && !slides; k++) {
        if (mt_finish_is_point_mass(f, &other->bodies[k])) {
            mt_diag_error(f->d, j->gear_joints[side].addr,
                          "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                          other->bodies[k].name.s, other->name.s);
        }
    }
}

static void check_gear(mt_finish *f, mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    const bool rack = j->type == MT_JOINT_RACK;
    const mt_names *const table = &f->m->tables->joints;
    for (int side = 0; side < 2; side++) {
        j->gear_joint[side] = mt_finish_find(f, j->gear_joints[side], table, "joint");
        if (j->gear_joint[side] != MT_ABSENT) {
            const mt_joint *const other = &f->m->joints[j->gear_joint[side]];
            check_coupled(f, j, side);
            mt_finish_needs(f, j->name, "joint", &j->in, &other->in, "joint", other->name.s);
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

static void check_at(mt_finish *f, const mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    if (j->n_at >= RULES[j->type].least_at && j->n_at <= RULES[j->type].most_at) {
        return;
    }
    if (RULES[j->type].most_at == 0) {
        mt_diag_error(f->d, j->at[0].addr, "%s %s joint has no \"at\"", article(j->type), type);
    } else {
        mt_diag_error(f->d, j->n_at > 0 ? j->at[0].addr : j->name.addr,
                      "a %s joint needs \"at\": %s", type,
                      RULES[j->type].least_at == 2 ? "a pair of points, one on each body"
                                                   : "a point, or the point on each body");
    }
}

static void check_members(mt_finish *f, const mt_joint *j)
{
    const char *const type = mt_joint_type_name(j->type);
    const int dimension = f->m->dimension;
    check_at(f, j);
    const bool axis = RULES[j->type].axis[dimension - 2];
    if (axis != j->has_axis) {
        mt_diag_error(f->d, j->has_axis ? mt_finish_addr(f->m, j->axis[0]) : j->name.addr,
                      "%s %s joint in %s dimensions %s \"axis\"", article(j->type), type,
                      dimension == 2 ? "two" : "three", axis ? "needs" : "has no");
    }
    if (RULES[j->type].axis_b != j->has_axis_b) {
        mt_diag_error(f->d, j->has_axis_b ? mt_finish_addr(f->m, j->axis_b[0]) : j->name.addr,
                      "%s %s joint %s \"axis_b\"", article(j->type), type,
                      j->has_axis_b ? "has no" : "needs");
    }
    if (j->length != MT_ABSENT && j->type != MT_JOINT_DISTANCE) {
        mt_diag_error(f->d, mt_finish_addr(f->m, j->length), "%s %s joint has no \"length_m\"",
                      article(j->type), type);
    }
    if (j->mass != MT_ABSENT && j->type != MT_JOINT_DISTANCE) {
        mt_diag_error(f->d, mt_finish_addr(f->m, j->mass),
                      "%s %s joint has no \"mass_kg\": a distance, which may be a rod, has",
                      article(j->type), type);
    }
    if (!is_geared(j->type) && (j->gear_joints[0].s != NULL || j->ratio != MT_ABSENT)) {
        mt_diag_error(f->d, j->name.addr,
                      "%s %s joint has no \"joints\" and \"ratio\": a gear has",
                      article(j->type), type);
    }
    if (j->ratio_m_per_rad != MT_ABSENT && j->type != MT_JOINT_RACK) {
        mt_diag_error(f->d, mt_finish_addr(f->m, j->ratio_m_per_rad),
                      "%s %s joint has no \"ratio_m_per_rad\": a rack has", article(j->type),
                      type);
    }
    if (j->ratio != MT_ABSENT && j->type == MT_JOINT_RACK) {
        mt_diag_error(f->d, mt_finish_addr(f->m, j->ratio),
                      "a rack has no \"ratio\": its \"ratio_m_per_rad\" is the pitch radius");
    }
}

static void check_bodies(mt_finish *f, const mt_joint *j)
{
    const mt_attach *const a = &j->bodies[0];
    const mt_attach *const b = &j->bodies[1];
    if (a->name.s == NULL || b->name.s == NULL) {
        mt_diag_error(f->d, j->name.addr, "joint \"%s\" needs \"bodies\": two of them",
                      j->name.s);
        return;
    }
    if (mt_finish_same_attach(a, b)) {
        mt_diag_error(f->d, b->name.addr, "joint \"%s\" holds \"%s\" to itself", j->name.s,
                      a->name.s);
    }
    for (int side = 0; side < 2; side++) {
        mt_finish_needs_attach(f, j->name, "joint", &j->in, &j->bodies[side]);
        check_point_mass(f, j, side);
    }
}

static void check_joint(mt_finish *f, mt_joint *j)
{
    if (!IN_DIMENSION[j->type][f->m->dimension - 2]) {
        mt_diag_error(f->d, j->name.addr, "there is no %s joint in %s dimensions",
                      mt_joint_type_name(j->type), f->m->dimension == 2 ? "two" : "three");
        return;
    }
    check_members(f, j);
    if (is_geared(j->type)) {
        check_gear(f, j);
    } else {
        check_bodies(f, j);
    }
}

void mt_finish_joints(mt_finish *f)
{
    for (int i = 0; i < f->m->n_joints; i++) {
        mt_joint *const j = &f->m->joints[i];
        j->gear_joint[0] = MT_ABSENT;
        j->gear_joint[1] = MT_ABSENT;
        for (int side = 0; side < 2; side++) {
            mt_finish_attach(f, &j->bodies[side]);
        }
        for (int k = 0; k < j->n_at; k++) {
            mt_finish_position(f, &j->at[k]);
        }
        if (j->type != MT_JOINT_TYPE_COUNT && f->m->dimension != 0) {
            check_joint(f, j);
        }
    }
}
