/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints, springs and dampers. */
#include "model/read_priv.h"

#include <string.h>

#define NAME_OF(id, name) name,
static const char *const JOINT_NAMES[] = {MT_JOINT_LIST(NAME_OF)};
static const char *const SPRING_NAMES[] = {MT_SPRING_LIST(NAME_OF)};

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
    MT_I_TWO("bodies", mt_item_bodies, bodies,
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
    MT_I_TWO("joints", mt_item_names, gear_joints,
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

static void refuse_member(mt_reader *r, const mt_key *key, mt_addr value, const mt_spring *s)
{
    if (value != MT_NO_ADDR && s->type != MT_SPRING_TYPE_COUNT) {
        mt_diag_error(r->diags, value, "%s %s %s has no \"%s\"",
                      s->type == MT_SPRING_AXIAL ? "an" : "a", mt_spring_type_name(s->type),
                      s->damper ? "damper" : "spring", key->name);
    }
}

/* A bushing's coefficients: as many as it has freedoms of that kind, put at x[first...]. */
static void set_bushing(mt_model_reader *mr, mt_addr value, int n, const mt_num *nums,
                        bool turns, mt_spring *s)
{
    const bool two = mr->m->dimension == 2;
    const int wanted = !two ? 3 : turns ? 1 : 2;
    mt_num *const x = turns ? s->rotation : s->translation;
    if (n != wanted) {
        mt_diag_error(mr->r.diags, value, "a bushing in %s dimensions needs %d here, not %d",
                      two ? "two" : "three", wanted, n);
        return;
    }
    for (int k = 0; k < n; k++) {
        x[(two && turns ? 2 : 0) + k] = nums[k];
    }
}

/* Stiffness or damping, in N/m, or where it turns in N m/rad: a bushing has both, the others
 * one number of one of them, a bar none. */
static void read_coefficient(mt_reader *r, const mt_key *key, mt_addr value, mt_spring *s,
                             bool turns)
{
    int n = 0;
    const mt_num *const nums = mt_read_nums(mt_model_reader_of(r), key, value, &n);
    const bool own = (s->type == MT_SPRING_TORSION || s->type == MT_SPRING_AXIAL) &&
                     turns == (s->type == MT_SPRING_TORSION);
    if (s->type == MT_SPRING_TYPE_COUNT || value == MT_NO_ADDR) {
        return;
    }
    if (s->type == MT_SPRING_BUSHING && nums != NULL) {
        set_bushing(mt_model_reader_of(r), value, n, nums, turns, s);
    } else if (s->type != MT_SPRING_BUSHING && !own) {
        refuse_member(r, key, value, s);
    } else if (own && mt_json_type_of(r->doc, value) == MT_JSON_ARRAY) {
        mt_diag_error(r->diags, value, "must be one number: only a bushing has several");
    } else if (own && nums != NULL) {
        s->stiffness = nums[0];
    }
}

static void read_along(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_coefficient(r, key, value, item, false);
}

static void read_about(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_coefficient(r, key, value, item, true);
}

/* A force, or where it turns a torque, in one place. */
static void read_preload(mt_reader *r, const mt_key *key, mt_addr value, mt_spring *s,
                         bool turns)
{
    const mt_num num = mt_read_num(mt_model_reader_of(r), value, key->possible, NULL);
    if (turns == (s->type == MT_SPRING_TORSION)) {
        s->preload = num;
    } else {
        refuse_member(r, key, value, s);
    }
}

static void read_tension(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_preload(r, key, value, item, false);
}

static void read_torque(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_preload(r, key, value, item, true);
}

/* The list of six rows of six numbers. */
static void read_matrix(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    enum { ORDER = 6 };
    mt_spring *const s = item;
    if (value == MT_NO_ADDR) {
        return;
    }
    s->matrix = mt_arena_alloc(r->mem, (size_t)ORDER * ORDER, sizeof *s->matrix);
    mt_items rows = mt_reader_items(r, value);
    if (rows.count != ORDER) {
        mt_diag_structure(r->diags, value, "must have %d rows, not %d", ORDER, rows.count);
        return;
    }
    for (int i = 0; s->matrix != NULL && mt_items_next(&rows); i++) {
        int n = 0;
        const mt_num *const nums = mt_read_nums(mt_model_reader_of(r), key, rows.at, &n);
        for (int k = 0; k < n; k++) {
            s->matrix[ORDER * i + k] = nums[k];
        }
    }
}

/* What a damper's table has not is absent, too. */
static void spring_defaults(void *item, mt_addr addr, int which)
{
    mt_spring *const s = item;
    (void)addr;
    (void)which;
    s->type = MT_SPRING_TYPE_COUNT;
    s->joint = MT_ABSENT;
    s->joint_link = MT_ABSENT;
    s->joint_hinge = MT_ABSENT;
    for (int k = 0; k < 3; k++) {
        s->translation[k] = MT_ABSENT;
        s->rotation[k] = MT_ABSENT;
    }
    mt_num *const nums[] = {&s->stiffness, &s->free_length,    &s->free_angle,
                            &s->preload,   &s->youngs_modulus, &s->area,
                            &s->density,   &s->loss_factor};
    for (int k = 0; k < MT_COUNT(nums); k++) {
        *nums[k] = MT_ABSENT;
    }
}

static void damper_defaults(void *item, mt_addr addr, int which)
{
    spring_defaults(item, addr, which);
    ((mt_spring *)item)->damper = true;
}

/* A spring that could not be read is of no type. */
static void spring_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_spring *const s = item;
    (void)which;
    s->type = mt_object_wrong(r, o) ? MT_SPRING_TYPE_COUNT : s->type;
}

/* What is said of the bodies of a spring and of a damper. */
#define TWO_BODIES                                                                           \
    MT_I_TWO(                                                                                \
        "bodies", mt_item_bodies, bodies,                                                    \
        "The two bodies or parts that it connects, each \"ground\", a body, or a part of a " \
        "link: \"L.start\", \"L.end\", the rigid element \"L.3\", or the node \"L.node3\" "  \
        "(of beam "                                                                          \
        "elements, or where rigid elements meet; \"L.node0\" is the start).",                \
        .examples = "[[\"ground\", \"beam.start\"]]")

#define THIS mt_spring
static const mt_key SPRING[] = {
    MT_I_NAME("spring"),
    MT_M_CHOICE("type", true, type, mt_spring_type, "type", SPRING_NAMES,
                "torsion: about a joint or between two bodies; axial: along the line between "
                "two points; bar: an axial spring made of material, with mass; bushing: in all "
                "directions, along axes of the drawing that the first body carries; its forces "
                "act at the point of the second body."),
    TWO_BODIES,
    MT_M_REF("joint", false, joint_name,
             "Torsion: the joint (or hinge of a link, \"L.h3\") whose angle it acts on. Axial: "
             "the joint that slides along whose axis it acts."),
    MT_I_AT,
    MT_M_JUST("stiffness_n_per_m", NUMBER_OR_LIST, false, ANY,
              "Axial: stiffness [N/m]. Bushing: a list along x, y (and z). A negative one is "
              "allowed: a spring over its dead centre, a magnet.",
              .read = read_along, .least = 1, .most = 3),
    MT_M_JUST("stiffness_n_m_per_rad", NUMBER_OR_LIST, false, ANY,
              "Torsion: stiffness [N m/rad]. Bushing: about z, or a list about x, y, z. A "
              "negative one is allowed.",
              .read = read_about, .least = 1, .most = 3),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
    MT_I_NUM("free_length_m", false, free_length, NOT_NEGATIVE,
             "Axial: length without force [m]."),
    MT_I_NUM("free_angle_rad", false, free_angle, ANY,
             "Torsion: where the spring has no torque [rad]: how far the second body is turned "
             "there against the first, about the joint's axis (in two dimensions "
             "counter-clockwise), from the reference position."),
    MT_M_JUST(
        "preload_n", NUMBER, false, ANY,
        "Axial, bar: tension in the reference position [N]: above 0 it draws the two points "
        "together; along a joint: the force that draws its second body back against the axis.",
        .read = read_tension),
    MT_M_JUST("preload_n_m", NUMBER, false, ANY,
              "Torsion: torque in the reference position [N m]: above 0 it turns the second "
              "body back, against the joint's axis (in two dimensions clockwise), and the "
              "first the other way.",
              .read = read_torque),
    MT_I_NUM("youngs_modulus_pa", false, youngs_modulus, MODULUS, "Bar: Young's modulus [Pa]."),
    MT_I_NUM("area_m2", false, area, NOT_NEGATIVE, "Bar: area [m^2]."),
    MT_I_NUM("density_kg_per_m3", false, density, DENSITY,
             "Bar: density [kg/m^3]. Absent: without mass."),
    MT_I_NUM("loss_factor", false, loss_factor, LOSS,
             "Structural damping: the spring is k (1 + i loss_factor) in steady vibrations; "
             "not negative. Absent: 0."),
    MT_M_JUST(
        "stiffness_matrix", LIST, false, MATRIX,
        "Bushing, three dimensions: 6 rows of 6, symmetric (to six digits; anything else has "
        "no energy and is an error); x, y, z [N/m], rotations [N m/rad], in between [N/rad]; "
        "about the point at which the bushing acts, that of the second body (absent: its "
        "centre), for displacements and rotations of the second body against the first.",
        .schema = "\"type\": \"array\", \"minItems\": 6, \"maxItems\": 6, \"items\": "
                  "{\"type\": \"array\", \"minItems\": 6, \"maxItems\": 6, \"items\": "
                  "{\"$ref\": \"#/definitions/number\"}}",
        .read = read_matrix, .least = 6, .most = 6),
};
const mt_key_table mt_spring_keys = {MT_I_TABLE("spring", SPRING, mt_spring),
                                     .defaults = spring_defaults, .finish = spring_finish,
                                     .says = "A spring."};

static const char *const DAMPER_NAMES[] = {"torsion", "axial", "bushing"};

static void read_damper_type(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    static const mt_spring_type types[] = {MT_SPRING_TORSION, MT_SPRING_AXIAL,
                                           MT_SPRING_BUSHING};
    const int which = mt_reader_choice(r, value, "type", key->choices, key->n_choices);
    if (which != MT_ABSENT) {
        ((mt_spring *)item)->type = types[which];
    }
}

static const mt_key DAMPER[] = {
    MT_I_NAME("damper"),
    MT_M_JUST("type", TEXT, true, NONE, "As for springs.", .read = read_damper_type,
              .choices = DAMPER_NAMES, .n_choices = MT_COUNT(DAMPER_NAMES)),
    TWO_BODIES,
    MT_M_REF("joint", false, joint_name,
             "Torsion: the joint (or hinge of a link, \"L.h3\") whose rate it acts on. Axial: "
             "the joint that slides along whose axis it acts."),
    MT_I_AT,
    MT_M_JUST("damping_n_s_per_m", NUMBER_OR_LIST, false, ANY,
              "Axial: coefficient [N s/m]. Bushing: a list along x, y (and z).",
              .read = read_along, .least = 1, .most = 3),
    MT_M_JUST("damping_n_m_s_per_rad", NUMBER_OR_LIST, false, ANY,
              "Torsion: coefficient [N m s/rad]. Bushing: about z, or a list about x, y, z.",
              .read = read_about, .least = 1, .most = 3),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_damper_keys = {MT_I_TABLE("damper", DAMPER, mt_spring),
                                     .defaults = damper_defaults, .finish = spring_finish,
                                     .says = "A viscous damper."};

/* Springs, then dampers, into one list. */
void mt_read_springs(mt_reader *r, const mt_key *key, mt_addr list, void *item)
{
    mt_model *const m = item;
    mt_items items = mt_reader_items(r, list);
    mt_items all = {.count = m->n_springs + items.count};
    mt_spring *const springs = mt_reader_room(r, &all, sizeof *springs);
    if (springs == NULL) {
        return;
    }
    if (m->n_springs > 0) {
        memcpy(springs, m->springs, (size_t)m->n_springs * sizeof *springs);
    }
    m->springs = springs;
    while (mt_items_next(&items)) {
        (void)mt_members_read(r, items.at, key->of, &springs[m->n_springs++]);
    }
}
