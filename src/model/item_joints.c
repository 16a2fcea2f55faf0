/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints: each has what its type needs (mt_joint_kind). */
#include <string.h>

#include "model/item.h"
#include "model/model.h"

#define NAME_OF(id, name) name,
static const char *const JOINT_NAMES[] = {MT_JOINT_LIST(NAME_OF)};

/*
 * Compliance. Lists have one entry for each of the joint's axes: a number, or "rigid".
 */
static bool are_yields(mt_reader *r, mt_items items)
{
    while (mt_items_next(&items)) {
        const mt_json_type type = mt_json_type_of(r->doc, items.at);
        if (type != MT_JSON_NUMBER && type != MT_JSON_STRING) {
            mt_diag_structure(r->diags, items.at,
                              "must be a number, an expression or \"rigid\"");
            return false;
        }
    }
    return true;
}

static void read_yields(mt_reader *r, const mt_key *key, mt_addr value, mt_num *x, bool turns)
{
    mt_model_reader *const mr = mt_model_reader_of(r);
    const bool two = mr->m->dimension == 2;
    const int wanted = !two ? 3 : turns ? 1 : 2;
    mt_items items = mt_reader_one_or_items(r, value);
    for (int k = 0; k < 3; k++) {
        x[k] = MT_ABSENT;
    }
    if (value == MT_NO_ADDR) {
        return;
    }
    if (!are_yields(r, items)) {
        return;
    }
    if (items.count != wanted) {
        const bool somewhere = items.count >= (turns ? 1 : 2) && items.count <= 3;
        void (*const say)(mt_diags *, mt_addr, const char *, ...) =
            somewhere ? mt_diag_error : mt_diag_structure;
        say(r->diags, value, "a compliance in %s dimensions needs %d here, not %d",
            two ? "two" : "three", wanted, items.count);
        return;
    }
    for (int k = two && turns ? 2 : 0; mt_items_next(&items); k++) {
        const char *const text = mt_json_type_of(r->doc, items.at) == MT_JSON_STRING
                                     ? mt_json_string(r->doc, items.at)
                                     : NULL;
        if (text == NULL || strcmp(text, "rigid") != 0) {
            x[k] = mt_read_num(mr, items.at, key->possible, NULL);
        }
    }
}

static void read_yield_along(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_yields(r, key, value, ((mt_compliance *)item)->translation, false);
}

static void read_yield_about(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_yields(r, key, value, ((mt_compliance *)item)->rotation, true);
}

static void read_damping_along(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_yields(r, key, value, ((mt_compliance *)item)->damping_translation, false);
}

static void read_damping_about(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_yields(r, key, value, ((mt_compliance *)item)->damping_rotation, true);
}

static void compliance_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    ((mt_compliance *)item)->addr = addr;
}

#define THIS mt_compliance
static const mt_key COMPLIANCE[] = {
    MT_M_PART("axes", false, axes, mt_axes, mt_axes_keys, NULL),
    MT_M_JUST("stiffness_n_per_m", LIST, false, POSITIVE,
              "Along the joint's axes [N/m], each a number or \"rigid\"; the last one is along "
              "the joint's axis, where it has one. Absent: rigid.",
              .examples = "[[3e7, 3e7, 1e7]]", .read = read_yield_along, .least = 2, .most = 3),
    MT_M_JUST("stiffness_n_m_per_rad", NUMBER_OR_LIST, false, POSITIVE,
              "About them [N m/rad]; in two dimensions about z. Absent: rigid.",
              .examples = "[[4e4, 4e4, \"rigid\"]]", .read = read_yield_about, .least = 3,
              .most = 3),
    MT_M_JUST("damping_n_s_per_m", LIST, false, NOT_NEGATIVE,
              "Viscous, beside the stiffness along the same axis [N s/m], \"rigid\" where that "
              "is. Absent: none.",
              .read = read_damping_along, .least = 2, .most = 3),
    MT_M_JUST("damping_n_m_s_per_rad", NUMBER_OR_LIST, false, NOT_NEGATIVE,
              "The same about them [N m s/rad].", .read = read_damping_about, .least = 3,
              .most = 3),
    MT_I_LOSS(
        "Loss factor of all its stiffnesses, or a list by direction: along the three axes, "
        "then about them. Absent: 0."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_compliance_keys = {
    MT_I_TABLE("compliance", COMPLIANCE, mt_compliance), .defaults = compliance_defaults,
    .says =
        "What a joint yields: its first body holds, by springs at the joint's point, a "
        "carrier without mass, on which the joint stands. What the joint holds yields where "
        "a stiffness is given; what it leaves free stays free. The axes are carried by the "
        "first body: the joint's `axis` is the last one (in two dimensions the second), and "
        "axes.x, across it, the first; a joint without `axis` has `axes` as a bushing has "
        "(absent: the drawing's)."};

static void read_compliance(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_joint *const j = item;
    j->compliance = NULL;
    if (value != MT_NO_ADDR) {
        j->compliance = mt_arena_alloc(r->mem, 1, sizeof *j->compliance);
    }
    if (j->compliance != NULL) {
        (void)mt_members_read(r, value, key->of, j->compliance);
    }
}

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
    {.name = "compliance",
     .type = MT_KEY_OBJECT,
     .read = read_compliance,
     .of = &mt_compliance_keys,
     .says = "A bearing that yields. Absent: rigid."},
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

static const char *const DIRECTIONS[2][6] = {
    {"along its first axis", "along its second axis", "", "", "", "about z"},
    {"along its first axis", "along its second axis", "along its third axis",
     "about its first axis", "about its second axis", "about its third axis"}};

/* Every stiffness is where the joint holds, every damping beside a stiffness; true where there
 * is any. */
static bool check_yields(mt_resolve *f, const mt_joint *j)
{
    const mt_compliance *const c = j->compliance;
    const unsigned holds = mt_joint_kind_of(j->type)->holds[f->m->dimension - 2];
    bool any = false;
    for (int k = 0; k < 6; k++) {
        const char *const where = DIRECTIONS[f->m->dimension - 2][k];
        const mt_num stiff = k < 3 ? c->translation[k] : c->rotation[k - 3];
        const mt_num damping = k < 3 ? c->damping_translation[k] : c->damping_rotation[k - 3];
        any = any || stiff != MT_ABSENT;
        if (stiff != MT_ABSENT && (holds >> k & 1U) == 0) {
            mt_diag_error(f->d, mt_resolve_addr(f->m, stiff),
                          "%s %s joint holds nothing %s that could yield: write \"rigid\"",
                          mt_joint_article(j->type), mt_joint_type_name(j->type), where);
        } else if (damping != MT_ABSENT && stiff == MT_ABSENT) {
            mt_diag_error(f->d, mt_resolve_addr(f->m, damping),
                          "joint \"%s\" is rigid %s: damping there does nothing", j->name.s,
                          where);
        }
    }
    return any;
}

/* The stiffnesses along and about the first two axes are written alike. */
static bool is_round(const mt_model *m, const mt_compliance *c)
{
    const mt_loss *const l = &c->loss;
    bool round = true;
    for (int k = 0; k < 2; k++) {
        const mt_num *const x = k == 0 ? c->translation : c->rotation;
        const mt_num *const d = k == 0 ? c->damping_translation : c->damping_rotation;
        const mt_num *const loss = l->n > 3 * k ? l->each + (ptrdiff_t)(3 * k) : NULL;
        const mt_position first = {.point = MT_ABSENT,
                                   .x = {x[0], d[0], loss == NULL ? MT_ABSENT : loss[0]}};
        const mt_position second = {.point = MT_ABSENT,
                                    .x = {x[1], d[1], loss == NULL ? MT_ABSENT : loss[1]}};
        round = round && mt_resolve_same_position(m, &first, &second);
    }
    return round;
}

static void check_compliance(mt_resolve *f, const mt_joint *j)
{
    const mt_compliance *const c = j->compliance;
    const mt_axes *const a = &c->axes;
    const mt_joint_kind *const kind = mt_joint_kind_of(j->type);
    const bool space = f->m->dimension == 3;
    if (kind->holds[f->m->dimension - 2] == 0) {
        mt_diag_error(f->d, c->addr, "%s %s joint has no \"compliance\"%s",
                      mt_joint_article(j->type), mt_joint_type_name(j->type),
                      j->type == MT_JOINT_DISTANCE ? ": a rod that yields is an axial spring"
                                                   : "");
        return;
    }
    if (!check_yields(f, j)) {
        mt_diag_error(f->d, c->addr,
                      "the compliance of joint \"%s\" needs a stiffness: \"stiffness_n_per_m\" "
                      "or \"stiffness_n_m_per_rad\"",
                      j->name.s);
    }
    if (!kind->axis[f->m->dimension - 2]) {
        mt_resolve_axes(f, j->name, "joint", a);
    } else if (a->given && (!space || !a->has_x || a->has_y || a->has_z || a->n_angles > 0)) {
        mt_diag_error(f->d, a->addr, "the compliance of joint \"%s\" %s", j->name.s,
                      space ? "needs \"x\" alone as \"axes\": the third is the joint's axis"
                            : "has no \"axes\": the second is the joint's axis");
    } else if (space && !a->given && !is_round(f->m, c)) {
        mt_diag_error(
            f->d, c->addr,
            "the compliance of joint \"%s\" is not the same along and about its first "
            "two axes: give \"axes\": {\"x\": ...}, which says where the first points",
            j->name.s);
    }
    if (mt_resolve_is_point_mass(f, &j->bodies[0])) {
        mt_diag_error(
            f->d, j->bodies[0].name.addr,
            "\"%s\" is a point mass, which does not turn and cannot carry the axes of "
            "a compliance",
            j->bodies[0].name.s);
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
    if (j->compliance != NULL) {
        check_compliance(f, j);
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
