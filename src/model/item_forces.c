/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What acts on bodies and joints: springs, dampers and dead loads. A moment of constant
 * direction in space does the work m . dtheta, which is no differential where a body turns
 * about several axes: turned by a quarter about z, then about x, it does other work than the
 * other way round. Its stiffness would be the skew matrix [m]x/2, and frequencies would not
 * exist as real numbers (Ziegler, Principles of Structural Stability, 1968). So in three
 * dimensions a moment acts on the coordinate of a joint; a pair of forces states any other,
 * with the potential that it has.
 */
#include <string.h>

#include "model/item.h"
#include "model/model.h"

#define NAME_OF(id, name) name,
static const char *const SPRING_NAMES[] = {MT_SPRING_LIST(NAME_OF)};

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
    mt_num *const nums[] = {&s->stiffness,      &s->free_length, &s->free_angle, &s->preload,
                            &s->youngs_modulus, &s->area,        &s->density,    &s->loss.all};
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
#define TWO_BODIES                                                                        \
    MT_I_TWO("bodies", bodies,                                                            \
             "The two bodies or parts that it connects, each \"ground\", a body, or a "   \
             "part of a link: \"L.start\", \"L.end\", the rigid element \"L.3\", or the " \
             "node \"L.node3\" (of beam elements, or where rigid elements meet; "         \
             "\"L.node0\" is the start).",                                                \
             .examples = "[[\"ground\", \"beam.start\"]]")

#define THIS mt_spring
static const mt_key SPRING[] = {
    MT_I_NAME("spring"),
    MT_M_CHOICE(
        "type", true, type, mt_spring_type, "type", SPRING_NAMES,
        "torsion: about a joint or between two bodies; axial: along the line between "
        "two points; bar: an axial spring made of material, with mass; bushing: in all "
        "directions, along axes (absent: the drawing's) that the first body carries; its "
        "forces act at the point of the second body."),
    TWO_BODIES,
    MT_M_REF("joint", false, joint_name,
             "Torsion: the joint (or hinge of a link, \"L.h3\") whose angle it acts on. Axial: "
             "the joint that slides along whose axis it acts."),
    MT_I_AT,
    MT_I_AXES,
    MT_M_JUST("stiffness_n_per_m", NUMBER_OR_LIST, false, ANY,
              "Axial: stiffness [N/m]. Bushing: a list along its axes. A negative one is "
              "allowed: a spring over its dead centre, a magnet.",
              .read = read_along, .least = 1, .most = 3),
    MT_M_JUST("stiffness_n_m_per_rad", NUMBER_OR_LIST, false, ANY,
              "Torsion: stiffness [N m/rad]. Bushing: about z, or a list about its axes. A "
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
    MT_I_LOSS(
        "Structural damping: the spring is k (1 + i loss_factor) in steady vibrations; not "
        "negative. Of a bushing also a list by direction: along its three axes, then about "
        "them (two dimensions: along x, along y, about z). Absent: 0."),
    MT_M_JUST(
        "stiffness_matrix", LIST, false, MATRIX,
        "Bushing, three dimensions: 6 rows of 6, symmetric (to six digits; anything else has "
        "no energy and is an error); x, y, z [N/m], rotations [N m/rad], in between [N/rad]; "
        "about the point at which the bushing acts, that of the second body (absent: its "
        "centre), along its axes, for displacements and rotations of the second body against "
        "the first.",
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
    MT_I_AXES,
    MT_M_JUST("damping_n_s_per_m", NUMBER_OR_LIST, false, ANY,
              "Axial: coefficient [N s/m]. Bushing: a list along its axes.", .read = read_along,
              .least = 1, .most = 3),
    MT_M_JUST("damping_n_m_s_per_rad", NUMBER_OR_LIST, false, ANY,
              "Torsion: coefficient [N m s/rad]. Bushing: about z, or a list about its axes.",
              .read = read_about, .least = 1, .most = 3),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_damper_keys = {MT_I_TABLE("damper", DAMPER, mt_spring),
                                     .defaults = damper_defaults, .finish = spring_finish,
                                     .says = "A viscous damper."};

/* Members that a type needs (N), may have (M), or has not ( ). */
typedef enum need { NONE, MAY, NEEDS } need;

/* "beam.h3": hinge 3 of link "beam", *link and its 0-based *hinge; an unknown hinge is an error
 * and leaves both MT_ABSENT. False where the name does not have this form. */
static bool resolve_hinge(mt_resolve *f, mt_name name, int *at, int *number)
{
    const char *const dot = strchr(name.s, '.');
    bool found = false;
    if (dot == NULL || dot[1] != 'h') {
        return false;
    }
    const int i = mt_names_find(&f->m->tables->bodies, name.s, (size_t)(dot - name.s), &found);
    if (!found || i >= 0) {
        return false;
    }
    const mt_link *const link = &f->m->links[-1 - i];
    int hinge = 0;
    const char *c = dot + 2;
    for (; *c >= '0' && *c <= '9' && hinge < MT_MAX_ELEMENTS; c++) {
        hinge = 10 * hinge + (*c - '0');
    }
    const int hinges = link->kind == MT_LINK_BEAM ? 0 : link->elements - 1;
    if (*c != '\0' || dot[2] == '0' || hinge < 1 || hinge > hinges) {
        mt_diag_error(f->d, name.addr, "\"%s\": link \"%s\" has %d hinges", name.s,
                      link->name.s, hinges < 0 ? 0 : hinges);
        return true;
    }
    *at = -1 - i;
    *number = hinge - 1;
    return true;
}

/* True where the second body can move along the joint's axis relative to the first. */
static bool slides(mt_joint_type type)
{
    return type == MT_JOINT_CYLINDRICAL ||
           mt_joint_kind_of(type)->coordinate == MT_COORDINATE_DISPLACEMENT;
}

/* True where the joint has the coordinate that the spring acts on: an angle, or a displacement.
 * Also true for a type that could not be read. */
static bool has_freedom(const mt_joint *joint, bool torsion)
{
    if (joint->type == MT_JOINT_TYPE_COUNT) {
        return true;
    }
    return torsion ? mt_joint_kind_of(joint->type)->coordinate == MT_COORDINATE_ANGLE
                   : slides(joint->type);
}

static void check_joint(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool torsion = s->type == MT_SPRING_TORSION;
    if (s->joint != MT_ABSENT) {
        const mt_joint *const joint = &f->m->joints[s->joint];
        const bool acts = has_freedom(joint, torsion);
        if (!acts) {
            mt_diag_error(f->d, s->joint_name.addr, "%s %s acts on the %s; \"%s\" is %s",
                          torsion ? "a torsion" : "an axial", what,
                          torsion ? "angle of a revolute joint"
                                  : "displacement of a joint that slides",
                          joint->name.s, mt_joint_type_name(joint->type));
        }
        mt_resolve_needs(f, s->name, what, &s->in, &joint->in, "joint", joint->name.s);
        for (int side = 0; side < 2 && acts && torsion; side++) {
            if (mt_resolve_is_point_mass(f, &joint->bodies[side])) {
                mt_diag_error(f->d, s->joint_name.addr,
                              "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                              joint->bodies[side].name.s, joint->name.s);
            }
        }
    } else if (s->joint_link != MT_ABSENT) {
        mt_resolve_needs(f, s->name, what, &s->in, &f->m->links[s->joint_link].in, "link",
                         f->m->links[s->joint_link].name.s);
        if (!torsion) {
            mt_diag_error(f->d, s->joint_name.addr,
                          "an axial %s acts on the displacement of a joint that slides; \"%s\" "
                          "is a hinge",
                          what, s->joint_name.s);
        }
    }
}

static void check_torsion(mt_resolve *f, const mt_spring *s)
{
    const bool bodies = s->bodies[0].name.s != NULL;
    const bool joint = s->joint_name.s != NULL;
    if (bodies == joint || (bodies && f->m->dimension == 3)) {
        mt_diag_error(f->d, s->name.addr, "a torsion %s needs %s",
                      s->damper ? "damper" : "spring",
                      f->m->dimension == 3
                          ? "\"joint\", not \"bodies\": in three dimensions it acts about the "
                            "axis of a revolute joint; without one, a bushing holds two bodies"
                          : "either \"joint\" or \"bodies\"");
    }
    check_joint(f, s);
}

/* Between two points, or along the axis of a joint, which has points of its own and no length
 * that could be free. */
static void check_axial(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool joint = s->joint_name.s != NULL;
    if ((s->bodies[0].name.s != NULL) == joint) {
        mt_diag_error(f->d, s->name.addr, "an axial %s needs either \"bodies\" or \"joint\"",
                      what);
    }
    if (joint && s->n_at > 0) {
        mt_diag_error(f->d, s->at[0].addr,
                      "%s \"%s\" acts along joint \"%s\" and has no \"at\"", what, s->name.s,
                      s->joint_name.s);
    }
    if (joint && s->free_length != MT_ABSENT) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->free_length),
                      "spring \"%s\" acts along joint \"%s\" and has no free length: give its "
                      "\"preload_n\"",
                      s->name.s, s->joint_name.s);
    }
    check_joint(f, s);
}

static void check_bodies(mt_resolve *f, const mt_spring *s)
{
    const char *const what = s->damper ? "damper" : "spring";
    const bool turns = s->type == MT_SPRING_TORSION || s->type == MT_SPRING_BUSHING;
    for (int side = 0; side < 2; side++) {
        const mt_attach *const a = &s->bodies[side];
        if (a->name.s == NULL) {
            continue;
        }
        mt_resolve_needs_attach(f, s->name, what, &s->in, a);
        if (!mt_resolve_is_point_mass(f, a)) {
            continue;
        }
        const mt_body *const body = &f->m->bodies[a->index];
        const int at = s->n_at == 2 ? side : 0;
        if (turns && (s->type == MT_SPRING_TORSION || side == 0)) {
            mt_diag_error(f->d, a->name.addr, "\"%s\" is a point mass, which does not turn",
                          body->name.s);
        } else if (s->n_at > 0 && !mt_resolve_same_position(f->m, &s->at[at], &body->centre)) {
            mt_diag_error(f->d, s->at[at].addr,
                          "\"%s\" is a point mass and can be held at its centre only: use the "
                          "same point for both",
                          body->name.s);
        }
    }
    const mt_attach *const a = &s->bodies[0];
    const mt_attach *const b = &s->bodies[1];
    if (mt_resolve_same_attach(a, b)) {
        mt_diag_error(f->d, b->name.addr, "%s \"%s\" holds \"%s\" to itself", what, s->name.s,
                      a->name.s);
    }
}

/* What a type of spring holds, by mt_spring_type; a damper can only have what its file format
 * has. */
typedef struct rule {
    need bodies;
    need joint;
    need at;
    need coefficient; /* one number, N/m or N m/rad */
    need material;    /* Young's modulus, area */
    need density;
    need free_length;
    need free_angle;
    need preload;
    need lists; /* per direction, N/m and N m/rad */
    need matrix;
    need axes;
} rule;

static const rule RULES[] = {
    [MT_SPRING_TORSION] =
        {.bodies = MAY, .joint = MAY, .coefficient = NEEDS, .free_angle = MAY, .preload = MAY},
    [MT_SPRING_AXIAL] = {.bodies = MAY,
                         .joint = MAY,
                         .at = MAY,
                         .coefficient = NEEDS,
                         .free_length = MAY,
                         .preload = MAY},
    [MT_SPRING_BAR] =
        {.bodies = NEEDS, .at = MAY, .material = NEEDS, .density = MAY, .preload = MAY},
    [MT_SPRING_BUSHING] =
        {.bodies = NEEDS, .at = MAY, .lists = NEEDS, .matrix = MAY, .axes = MAY},
};

static void check_members(mt_resolve *f, const mt_spring *s)
{
    const rule *const r = &RULES[s->type];
    const char *const what = s->damper ? "damper" : "spring";
    const bool torsion = s->type == MT_SPRING_TORSION;
    const char *const force = s->damper ? "damping_n_s_per_m" : "stiffness_n_per_m";
    const char *const torque = s->damper ? "damping_n_m_s_per_rad" : "stiffness_n_m_per_rad";
    const struct {
        bool given;
        need wanted;
        const char *member;
    } members[] = {
        {s->bodies[0].name.s != NULL, r->bodies, "bodies"},
        {s->joint_name.s != NULL, r->joint, "joint"},
        {s->n_at > 0, r->at, "at"},
        {s->stiffness != MT_ABSENT, r->coefficient, torsion ? torque : force},
        {s->youngs_modulus != MT_ABSENT, r->material, "youngs_modulus_pa"},
        {s->area != MT_ABSENT, r->material, "area_m2"},
        {s->density != MT_ABSENT, r->density, "density_kg_per_m3"},
        {s->free_length != MT_ABSENT, r->free_length, "free_length_m"},
        {s->free_angle != MT_ABSENT, r->free_angle, "free_angle_rad"},
        {s->preload != MT_ABSENT, r->preload, torsion ? "preload_n_m" : "preload_n"},
        {s->matrix != NULL, r->matrix, "stiffness_matrix"},
        {s->axes.given, r->axes, "axes"},
        {s->translation[0] != MT_ABSENT, s->matrix == NULL ? r->lists : MAY, force},
        {s->rotation[2] != MT_ABSENT, s->matrix == NULL ? r->lists : MAY, torque},
    };
    for (int i = 0; i < MT_COUNT(members); i++) {
        const bool given = members[i].given;
        if (members[i].wanted == (given ? NONE : NEEDS)) {
            mt_diag_error(f->d, s->name.addr, "%s \"%s\": %s %s %s %s \"%s\"", what, s->name.s,
                          s->type == MT_SPRING_AXIAL ? "an" : "a", mt_spring_type_name(s->type),
                          what, given ? "has no" : "needs", members[i].member);
        }
    }
}

/* Checks that involve several members. */
static void check_together(mt_resolve *f, const mt_spring *s)
{
    const bool lists = s->translation[0] != MT_ABSENT || s->rotation[2] != MT_ABSENT;
    const bool free_given = s->free_length != MT_ABSENT || s->free_angle != MT_ABSENT;
    if (s->matrix != NULL && lists) {
        mt_diag_error(f->d, s->name.addr,
                      "spring \"%s\": give \"stiffness_matrix\" or the two lists, not both",
                      s->name.s);
    }
    if (s->matrix != NULL && f->m->dimension == 2) {
        mt_diag_error(f->d, s->name.addr,
                      "spring \"%s\": \"stiffness_matrix\" is for three dimensions", s->name.s);
    }
    if (s->loss.n > 0 && (s->type != MT_SPRING_BUSHING || s->matrix != NULL)) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->loss.each[0]),
                      "spring \"%s\": \"loss_factor\" must be one number: only a bushing "
                      "without \"stiffness_matrix\" has one for each direction",
                      s->name.s);
    }
    if (free_given && s->preload != MT_ABSENT) {
        mt_diag_error(
            f->d, mt_resolve_addr(f->m, s->preload),
            "spring \"%s\": a preload follows from the free length or angle; give one of them",
            s->name.s);
    }
    if (s->n_at == 1 && s->joint_name.s == NULL &&
        (s->type == MT_SPRING_AXIAL || s->type == MT_SPRING_BAR)) {
        mt_diag_error(f->d, s->at[0].addr,
                      "\"at\" of %s \"%s\" must be a pair: the point on each body",
                      s->damper ? "damper" : "spring", s->name.s);
    }
}

static void resolve_springs(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_springs; i++) {
        mt_spring *const s = &f->m->springs[i];
        s->joint = MT_ABSENT;
        s->joint_link = MT_ABSENT;
        s->joint_hinge = MT_ABSENT;
        for (int side = 0; side < 2; side++) {
            mt_resolve_attach(f, &s->bodies[side]);
        }
        for (int k = 0; k < s->n_at; k++) {
            mt_resolve_position(f, &s->at[k]);
        }
        if (s->joint_name.s != NULL &&
            !resolve_hinge(f, s->joint_name, &s->joint_link, &s->joint_hinge)) {
            s->joint = mt_resolve_find(f, s->joint_name, &f->m->tables->joints, "joint");
        }
        if (s->type == MT_SPRING_TYPE_COUNT || f->m->dimension == 0) {
            continue; /* could not be read */
        }
        check_members(f, s);
        mt_resolve_axes(f, s->name, s->damper ? "damper" : "spring", &s->axes);
        check_together(f, s);
        check_bodies(f, s);
        if (s->type == MT_SPRING_TORSION) {
            check_torsion(f, s);
        } else if (s->type == MT_SPRING_AXIAL) {
            check_axial(f, s);
        }
    }
}

/* Dead loads. */

static bool is_list(const mt_reader *r, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(r->doc, value) == MT_JSON_ARRAY;
}

/* A vector, or one number. */
static void read_force(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_load *const l = item;
    l->one_number = value != MT_NO_ADDR && !is_list(r, value);
    mt_item_vector(r, key, l->one_number ? MT_NO_ADDR : value, item);
    if (l->one_number) {
        int n = 0;
        const mt_num *const force = mt_read_nums(mt_model_reader_of(r), key, value, &n);
        l->has_force = force != NULL;
        l->force[0] = force == NULL ? MT_ABSENT : force[0];
    }
}

static void read_moment(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_load *const l = item;
    int n = 0;
    const mt_num *const moment = mt_read_nums(mt_model_reader_of(r), key, value, &n);
    l->moment_vector = is_list(r, value);
    l->has_moment = moment != NULL;
    l->moment = moment == NULL ? MT_ABSENT : moment[0];
}

static void load_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    ((mt_load *)item)->addr = addr;
}

static void load_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    (void)which;
    ((mt_load *)item)->unread = mt_object_wrong(r, o);
}

#define THIS mt_load
static const mt_key LOAD[] = {
    MT_I_NAME("load"),
    MT_M_REF("on", false, on.name,
             "What it acts on: a body, or a part of a link: \"L.start\", \"L.end\", the rigid "
             "element \"L.3\", or the node \"L.node3\" (of beam elements, or where rigid "
             "elements meet; \"L.node0\" is the start)."),
    MT_M_REF("joint", false, joint_name,
             "Instead of on: the joint (or hinge of a link, \"L.h3\") whose coordinate it acts "
             "along or about: on the second body, with the reaction on the first."),
    MT_I_POSITION("at", false, at,
                  "Point of application, in the reference position [m]. Absent: the centre of "
                  "the body or element, the end of the link."),
    MT_M_JUST("force_n", NUMBER_OR_LIST, false, ANY,
              "Force along x, y (and z) [N], whatever the body does; on a joint that slides: "
              "one number, above 0 along the axis on the second body, against it on the first.",
              .examples = "[[0, -50]]",
              .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"$ref\": "
                        "\"#/definitions/vector\"}]",
              .read = read_force, .at = MT_M_PLACE(mt_vector, force),
              .other = MT_M_PLACE(bool, has_force)),
    MT_M_JUST(
        "moment_n_m", NUMBER_OR_LIST, false, ANY,
        "Moment [N m]: on a body in two dimensions, above 0 counter-clockwise; on a joint that "
        "turns, above 0 it turns the second body about the axis, and the first the other way. "
        "A moment of constant direction in space has no potential and is refused.",
        .read = read_moment, .least = 1, .most = 3),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_load_keys = {MT_I_TABLE("load", LOAD, mt_load), .defaults = load_defaults,
                                   .finish = load_finish,
                                   .says = "A dead load on a body, or on a joint."};

static void check_loaded_joint(mt_resolve *f, const mt_load *l)
{
    if (l->joint_link != MT_ABSENT) {
        const mt_link *const link = &f->m->links[l->joint_link];
        mt_resolve_needs(f, l->name, "load", &l->in, &link->in, "link", link->name.s);
    }
    if (l->joint != MT_ABSENT) {
        const mt_joint *const joint = &f->m->joints[l->joint];
        mt_resolve_needs(f, l->name, "load", &l->in, &joint->in, "joint", joint->name.s);
    }
    const bool known =
        l->joint_link != MT_ABSENT ||
        (l->joint != MT_ABSENT && f->m->joints[l->joint].type != MT_JOINT_TYPE_COUNT);
    if (!known) {
        return;
    }
    const mt_joint *const joint = l->joint == MT_ABSENT ? NULL : &f->m->joints[l->joint];
    /* a link's hinge turns */
    const mt_coordinate coordinate =
        joint == NULL ? MT_COORDINATE_ANGLE : mt_joint_kind_of(joint->type)->coordinate;
    if (coordinate == MT_COORDINATE_NONE) {
        mt_diag_error(f->d, l->joint_name.addr, "\"%s\" is %s, which has no coordinate to load",
                      joint->name.s, mt_joint_type_name(joint->type));
        return;
    }
    if (coordinate == MT_COORDINATE_ANGLE ? l->has_force || !l->has_moment
                                          : l->has_moment || !l->has_force) {
        mt_diag_error(f->d, l->joint_name.addr, "joint \"%s\" %s: its load is \"%s\"",
                      l->joint_name.s, coordinate == MT_COORDINATE_ANGLE ? "turns" : "slides",
                      coordinate == MT_COORDINATE_ANGLE ? "moment_n_m" : "force_n");
    }
    for (int side = 0; side < 2 && joint != NULL && coordinate == MT_COORDINATE_ANGLE; side++) {
        if (mt_resolve_is_point_mass(f, &joint->bodies[side])) {
            mt_diag_error(f->d, l->joint_name.addr,
                          "\"%s\" of joint \"%s\" is a point mass, which does not turn",
                          joint->bodies[side].name.s, joint->name.s);
        }
    }
    if (l->has_force && !l->one_number) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "force_n"),
                      "must be one number: the force acts along joint \"%s\"", l->joint_name.s);
    }
    if (l->moment_vector) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "moment_n_m"),
                      "must be one number: the moment acts about joint \"%s\"",
                      l->joint_name.s);
    }
    if (l->at.given) {
        mt_diag_error(f->d, l->at.addr, "a load on a joint has no \"at\"");
    }
}

static void check_body(mt_resolve *f, const mt_load *l)
{
    mt_resolve_needs_attach(f, l->name, "load", &l->in, &l->on);
    const bool point_mass = mt_resolve_is_point_mass(f, &l->on);
    if (l->has_force && l->one_number) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "force_n"),
                      "must be a list: the force along %s",
                      f->m->dimension == 2 ? "x and y" : "x, y and z");
    }
    if (l->has_moment && (f->m->dimension == 3 || l->moment_vector)) {
        mt_diag_error(f->d, mt_diag_member(f->d, l->addr, "moment_n_m"), "%s",
                      f->m->dimension == 2
                          ? "must be one number: the moment about z"
                          : "a moment of constant direction in space has no potential: put it "
                            "on a joint that turns, or give the forces that make it");
    } else if (l->has_moment && point_mass) {
        mt_diag_error(f->d, l->on.name.addr, "\"%s\" is a point mass, which does not turn",
                      l->on.name.s);
    }
    if (point_mass && l->at.given &&
        !mt_resolve_same_position(f->m, &l->at, &f->m->bodies[l->on.index].centre)) {
        mt_diag_error(f->d, l->at.addr,
                      "\"%s\" is a point mass and can be held at its centre only: use the same "
                      "point for both",
                      l->on.name.s);
    }
}

static void check_load(mt_resolve *f, const mt_load *l)
{
    const bool joint = l->joint_name.s != NULL;
    if ((l->on.name.s != NULL) == joint) {
        mt_diag_error(f->d, l->name.addr, "load \"%s\" needs either \"on\" or \"joint\"",
                      l->name.s);
        return;
    }
    if (!l->has_force && !l->has_moment) {
        mt_diag_error(f->d, l->name.addr,
                      "load \"%s\" has neither \"force_n\" nor \"moment_n_m\"", l->name.s);
        return;
    }
    if (joint) {
        check_loaded_joint(f, l);
    } else if (l->on.kind == MT_ATTACH_GROUND) {
        mt_diag_error(f->d, l->on.name.addr, "a load on the ground moves nothing");
    } else {
        check_body(f, l);
    }
}

static void resolve_loads(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_loads; i++) {
        mt_load *const l = &f->m->loads[i];
        const int before = f->d->errors;
        l->joint = MT_ABSENT;
        l->joint_link = MT_ABSENT;
        l->joint_hinge = MT_ABSENT;
        mt_resolve_attach(f, &l->on);
        mt_resolve_position(f, &l->at);
        if (l->joint_name.s != NULL &&
            !resolve_hinge(f, l->joint_name, &l->joint_link, &l->joint_hinge)) {
            l->joint = mt_resolve_find(f, l->joint_name, &f->m->tables->joints, "joint");
        }
        if (f->m->dimension != 0 && !l->unread && f->d->errors == before) {
            check_load(f, l);
        }
    }
}

void mt_resolve_forces(mt_resolve *f)
{
    resolve_springs(f);
    resolve_loads(f);
}
