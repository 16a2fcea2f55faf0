/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints, springs and dampers. */
#include "model/read_priv.h"

#define NAME_OF(id, name) name,
static const char *const JOINT_NAMES[] = {MT_JOINT_LIST(NAME_OF)};
static const char *const SPRING_NAMES[] = {MT_SPRING_LIST(NAME_OF)};

/* What is said of the bodies of a spring and of a damper. */
#define TWO_BODIES                                                                             \
    "The two bodies or parts that it connects, each \"ground\", a body, or a part of a link: " \
    "\"L.start\", \"L.end\", the rigid element \"L.3\", or the node \"L.node3\" (of beam "     \
    "elements, or where rigid elements meet; \"L.node0\" is the start).",                      \
        .examples = "[[\"ground\", \"beam.start\"]]",                                          \
        .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "         \
                  "{\"type\": \"string\"}"

#define JOINT_KEYS(X)                                                                          \
    X(JOINT_NAME, "name", TEXT, true, NONE,                                                    \
      "Name of the joint: a letter or _, then letters, digits, _, + and -.",                   \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(JOINT_TYPE, "type", TEXT, true, NONE,                                                    \
      "Two dimensions: fixed, revolute, prismatic, pin-in-slot, distance, orientation (the "   \
      "bodies turn together, translations are free), gear, rack. Three: all but pin-in-slot; " \
      "point-on-plane keeps a point of the second body on a plane of the first.",              \
      .choices = JOINT_NAMES, .n_choices = MT_COUNT(JOINT_NAMES))                              \
    X(JOINT_BODIES, "bodies", LIST, false, NONE,                                               \
      "The two bodies or parts that it connects: its coordinate is how far the second stands " \
      "against the first, about the axis (right-handed; in two dimensions counter-clockwise) " \
      "or along it. Each \"ground\", a body, or a part of a link: \"L.start\", \"L.end\", "    \
      "the rigid element \"L.3\", or the node \"L.node3\" (of beam elements, or where rigid "  \
      "elements meet; \"L.node0\" is the start).",                                             \
      .examples = "[[\"ground\", \"beam.start\"]]",                                            \
      .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "           \
                "{\"type\": \"string\"}")                                                      \
    X(JOINT_AT, "at", TEXT_OR_LIST, false, POINT, NULL,                                        \
      .schema = "\"$ref\": \"#/definitions/at\"")                                              \
    X(JOINT_AXIS, "axis", LIST, false, AXIS,                                                   \
      "Direction: of turning, of sliding, or the normal of a plane; fixed to the first body.", \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/vector\"}]")                           \
    X(JOINT_AXIS_B, "axis_b", LIST, false, AXIS,                                               \
      "Universal joint: the second axis, fixed to the second body.",                           \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/vector\"}]")                           \
    X(JOINT_LENGTH, "length_m", NUMBER, false, POSITIVE,                                       \
      "Distance joint: its length [m]. Absent: as drawn.")                                     \
    X(JOINT_MASS, "mass_kg", NUMBER, false, NOT_NEGATIVE,                                      \
      "Distance joint: mass of a uniform thin rod between its points, with a ball joint at "   \
      "each end [kg]. Absent: a rod without mass.")                                            \
    X(JOINT_JOINTS, "joints", LIST, false, NONE,                                               \
      "Gear: the two revolute joints that it couples. Rack: a revolute joint (the pinion), "   \
      "then a prismatic one, a slot or a line.",                                               \
      .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "           \
                "{\"type\": \"string\"}")                                                      \
    X(JOINT_RATIO, "ratio", NUMBER, false, NONZERO,                                            \
      "Gear: angle of the second joint divided by that of the first [1], each of its second "  \
      "body against its first, about its own axis; not 0; negative for wheels that mesh "      \
      "outside: minus the teeth of the first by those of the second.")                         \
    X(JOINT_RATIO_M, "ratio_m_per_rad", NUMBER, false, NONZERO,                                \
      "Rack: displacement of the second joint divided by the angle of the first [m/rad]: the " \
      "pitch radius, with a sign; not 0.")                                                     \
    X(JOINT_IN, "in", LIST, false, NONE,                                                       \
      "Names of the configurations that contain this item; absent: all of them. "              \
      "Configurations that are `like` one of them contain it as well.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                      \
    X(JOINT_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")            \
    X(JOINT_SOURCE, "source", TEXT, false, NONE,                                               \
      "Where it comes from: a table, a page, a test report.")
enum { JOINT_KEYS(MT_READ_ENUM) JOINT_COUNT };
MT_READ_TABLE(mt_joint_keys, "joint", JOINT_KEYS, .says = "A joint between two bodies.");

#define SPRING_KEYS(X)                                                                         \
    X(SPRING_NAME, "name", TEXT, true, NONE,                                                   \
      "Name of the spring: a letter or _, then letters, digits, _, + and -.",                  \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(SPRING_TYPE, "type", TEXT, true, NONE,                                                   \
      "torsion: about a joint or between two bodies; axial: along the line between two "       \
      "points; bar: an axial spring made of material, with mass; bushing: in all directions, " \
      "along axes of the drawing that the first body carries; its forces act at the point of " \
      "the second body.",                                                                      \
      .choices = SPRING_NAMES, .n_choices = MT_COUNT(SPRING_NAMES))                            \
    X(SPRING_BODIES, "bodies", LIST, false, NONE, TWO_BODIES)                                  \
    X(SPRING_JOINT, "joint", TEXT, false, NONE,                                                \
      "Torsion: the joint (or hinge of a link, \"L.h3\") whose angle it acts on. Axial: the "  \
      "joint that slides along whose axis it acts.")                                           \
    X(SPRING_AT, "at", TEXT_OR_LIST, false, POINT, NULL,                                       \
      .schema = "\"$ref\": \"#/definitions/at\"")                                              \
    X(SPRING_FORCE, "stiffness_n_per_m", NUMBER_OR_LIST, false, ANY,                           \
      "Axial: stiffness [N/m]. Bushing: a list along x, y (and z). A negative one is "         \
      "allowed: a spring over its dead centre, a magnet.",                                     \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 3, \"items\": {\"$ref\": "                     \
                "\"#/definitions/number\"}}]")                                                 \
    X(SPRING_TORQUE, "stiffness_n_m_per_rad", NUMBER_OR_LIST, false, ANY,                      \
      "Torsion: stiffness [N m/rad]. Bushing: about z, or a list about x, y, z. A negative "   \
      "one is allowed.",                                                                       \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 1, \"maxItems\": 3, \"items\": {\"$ref\": "                     \
                "\"#/definitions/number\"}}]")                                                 \
    X(SPRING_IN, "in", LIST, false, NONE,                                                      \
      "Names of the configurations that contain this item; absent: all of them. "              \
      "Configurations that are `like` one of them contain it as well.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                      \
    X(SPRING_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")           \
    X(SPRING_SOURCE, "source", TEXT, false, NONE,                                              \
      "Where it comes from: a table, a page, a test report.")                                  \
    X(SPRING_FREE_LENGTH, "free_length_m", NUMBER, false, NOT_NEGATIVE,                        \
      "Axial: length without force [m].")                                                      \
    X(SPRING_FREE_ANGLE, "free_angle_rad", NUMBER, false, ANY,                                 \
      "Torsion: where the spring has no torque [rad]: how far the second body is turned "      \
      "there against the first, about the joint's axis (in two dimensions "                    \
      "counter-clockwise), from the reference position.")                                      \
    X(SPRING_PRELOAD_N, "preload_n", NUMBER, false, ANY,                                       \
      "Axial, bar: tension in the reference position [N]: above 0 it draws the two points "    \
      "together; along a joint: the force that draws its second body back against the axis.")  \
    X(SPRING_PRELOAD_N_M, "preload_n_m", NUMBER, false, ANY,                                   \
      "Torsion: torque in the reference position [N m]: above 0 it turns the second body "     \
      "back, against the joint's axis (in two dimensions clockwise), and the first the other " \
      "way.")                                                                                  \
    X(SPRING_YOUNG, "youngs_modulus_pa", NUMBER, false, MODULUS, "Bar: Young's modulus [Pa].") \
    X(SPRING_AREA, "area_m2", NUMBER, false, NOT_NEGATIVE, "Bar: area [m^2].")                 \
    X(SPRING_DENSITY, "density_kg_per_m3", NUMBER, false, DENSITY,                             \
      "Bar: density [kg/m^3]. Absent: without mass.")                                          \
    X(SPRING_LOSS, "loss_factor", NUMBER, false, LOSS,                                         \
      "Structural damping: the spring is k (1 + i loss_factor) in steady vibrations; not "     \
      "negative. Absent: 0.")                                                                  \
    X(SPRING_MATRIX, "stiffness_matrix", LIST, false, MATRIX,                                  \
      "Bushing, three dimensions: 6 rows of 6, symmetric (to six digits; anything else has "   \
      "no energy and is an error); x, y, z [N/m], rotations [N m/rad], in between [N/rad]; "   \
      "about the point at which the bushing acts, that of the second body (absent: its "       \
      "centre), for displacements and rotations of the second body against the first.",        \
      .schema = "\"type\": \"array\", \"minItems\": 6, \"maxItems\": 6, \"items\": "           \
                "{\"type\": \"array\", \"minItems\": 6, \"maxItems\": 6, \"items\": "          \
                "{\"$ref\": \"#/definitions/number\"}}")
enum { SPRING_KEYS(MT_READ_ENUM) SPRING_COUNT };
MT_READ_TABLE(mt_spring_keys, "spring", SPRING_KEYS, .says = "A spring.");

/* The first ten of a spring's keys, in their order, so that one reader serves both. */
#define DAMPER_KEYS(X)                                                                       \
    X(DAMPER_NAME, "name", TEXT, true, NONE,                                                 \
      "Name of the damper: a letter or _, then letters, digits, _, + and -.",                \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                               \
    X(DAMPER_TYPE, "type", TEXT, true, NONE, "As for springs.",                              \
      .schema = "\"type\": \"string\", \"enum\": [\"torsion\", \"axial\", \"bushing\"]")     \
    X(DAMPER_BODIES, "bodies", LIST, false, NONE, TWO_BODIES)                                \
    X(DAMPER_JOINT, "joint", TEXT, false, NONE,                                              \
      "Torsion: the joint (or hinge of a link, \"L.h3\") whose rate it acts on. Axial: the " \
      "joint that slides along whose axis it acts.")                                         \
    X(DAMPER_AT, "at", TEXT_OR_LIST, false, POINT, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/at\"")                                            \
    X(DAMPER_FORCE, "damping_n_s_per_m", NUMBER_OR_LIST, false, ANY,                         \
      "Axial: coefficient [N s/m]. Bushing: a list along x, y (and z).",                     \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "   \
                "\"minItems\": 1, \"maxItems\": 3, \"items\": {\"$ref\": "                   \
                "\"#/definitions/number\"}}]")                                               \
    X(DAMPER_TORQUE, "damping_n_m_s_per_rad", NUMBER_OR_LIST, false, ANY,                    \
      "Torsion: coefficient [N m s/rad]. Bushing: about z, or a list about x, y, z.",        \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "   \
                "\"minItems\": 1, \"maxItems\": 3, \"items\": {\"$ref\": "                   \
                "\"#/definitions/number\"}}]")                                               \
    X(DAMPER_IN, "in", LIST, false, NONE,                                                    \
      "Names of the configurations that contain this item; absent: all of them. "            \
      "Configurations that are `like` one of them contain it as well.",                      \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                    \
    X(DAMPER_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")         \
    X(DAMPER_SOURCE, "source", TEXT, false, NONE,                                            \
      "Where it comes from: a table, a page, a test report.")
enum { DAMPER_KEYS(MT_READ_ENUM) DAMPER_COUNT };
_Static_assert((int)DAMPER_COUNT == (int)SPRING_SOURCE + 1,
               "a damper's keys are a spring's first");
MT_READ_TABLE(mt_damper_keys, "damper", DAMPER_KEYS, .says = "A viscous damper.");

static void read_joint(mt_model_reader *mr, mt_addr value, mt_joint *j)
{
    const int before = mr->r.diags->errors;
    mt_addr at[JOINT_COUNT];
    mt_attach coupled[2];
    (void)mt_reader_object(&mr->r, value, &mt_joint_keys, at);
    *j = (mt_joint){.gear_joint = {MT_ABSENT, MT_ABSENT}};
    j->name = mt_reader_name(&mr->r, at[JOINT_NAME]);
    j->type = (mt_joint_type)mt_reader_choice(&mr->r, at[JOINT_TYPE], "type", JOINT_NAMES,
                                              MT_COUNT(JOINT_NAMES));
    mt_read_bodies(mr, at[JOINT_BODIES], j->bodies);
    j->n_at = mt_read_at(mr, at[JOINT_AT], j->at);
    j->has_axis = mt_read_vector(mr, at[JOINT_AXIS], j->axis);
    j->has_axis_b = mt_read_vector(mr, at[JOINT_AXIS_B], j->axis_b);
    j->length = mt_read_num(mr, at[JOINT_LENGTH]);
    j->mass = mt_read_num(mr, at[JOINT_MASS]);
    mt_read_bodies(mr, at[JOINT_JOINTS], coupled); /* two names as well */
    for (int side = 0; side < 2; side++) {
        j->gear_joints[side] = coupled[side].name;
    }
    j->ratio = mt_read_num(mr, at[JOINT_RATIO]);
    j->ratio_m_per_rad = mt_read_num(mr, at[JOINT_RATIO_M]);
    j->in = mt_read_presence(mr, at[JOINT_IN]);
    if (mr->r.diags->errors > before) {
        j->type = MT_JOINT_TYPE_COUNT;
    }
}

void mt_read_joints(mt_model_reader *mr, mt_addr list)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, list);
    m->joints = mt_reader_room(&mr->r, &i, sizeof *m->joints);
    while (mt_items_next(&i)) {
        read_joint(mr, i.at, &m->joints[m->n_joints++]);
    }
}

static void report_missing_member(mt_model_reader *mr, mt_addr value, const mt_spring *s,
                                  const char *member)
{
    if (value != MT_NO_ADDR) {
        mt_diag_error(mr->r.diags, value, "%s %s %s has no \"%s\"",
                      s->type == MT_SPRING_AXIAL ? "an" : "a", mt_spring_type_name(s->type),
                      s->damper ? "damper" : "spring", member);
    }
}

/* What stands in a stiffness member: one number, or a list of up to three. */
typedef struct row {
    mt_addr addr;
    mt_num *nums;
    int n;
} row;

static row read_row(mt_model_reader *mr, mt_addr value)
{
    row r = {.addr = value};
    r.nums = mt_read_nums(mr, value, true, 1, 3, &r.n);
    return r;
}

/* A bushing's coefficients: as many as it has freedoms of that kind, put at x[first...]. */
static void set_row(mt_model_reader *mr, const row *r, int wanted, int first, mt_num x[3])
{
    if (r->nums == NULL) {
        return;
    }
    if (r->n != wanted) {
        mt_diag_error(mr->r.diags, r->addr, "a bushing in %s dimensions needs %d here, not %d",
                      mr->m->dimension == 2 ? "two" : "three", wanted, r->n);
        return;
    }
    for (int k = 0; k < r->n; k++) {
        x[first + k] = r->nums[k];
    }
}

/* Stiffness or damping, in N/m and in N m/rad: a bushing has both, the others one number of one
 * of them, a bar none. */
static void read_coefficients(mt_model_reader *mr, const mt_addr *at, mt_spring *s)
{
    const mt_key *const keys = s->damper ? mt_damper_keys.keys : mt_spring_keys.keys;
    const bool two = mr->m->dimension == 2;
    const bool torsion = s->type == MT_SPRING_TORSION;
    const row rows[] = {read_row(mr, at[SPRING_FORCE]), read_row(mr, at[SPRING_TORQUE])};
    if (s->type == MT_SPRING_TYPE_COUNT) {
        return;
    }
    if (s->type == MT_SPRING_BUSHING) {
        set_row(mr, &rows[0], two ? 2 : 3, 0, s->translation);
        set_row(mr, &rows[1], two ? 1 : 3, two ? 2 : 0, s->rotation);
        return;
    }
    const row *const own = &rows[torsion ? 1 : 0];
    const int other = torsion ? SPRING_FORCE : SPRING_TORQUE;
    report_missing_member(mr, at[other], s, keys[other].name);
    if (s->type == MT_SPRING_BAR) {
        report_missing_member(mr, own->addr, s, keys[SPRING_FORCE].name);
    } else if (own->addr != MT_NO_ADDR &&
               mt_json_type_of(mr->r.doc, own->addr) == MT_JSON_ARRAY) {
        mt_diag_error(mr->r.diags, own->addr, "must be one number: only a bushing has several");
    } else if (own->nums != NULL) {
        s->stiffness = own->nums[0];
    }
}

/* The list of six rows of six numbers. */
static mt_num *read_matrix(mt_model_reader *mr, mt_addr value)
{
    enum { ORDER = 6 };
    if (value == MT_NO_ADDR) {
        return NULL;
    }
    mt_num *const matrix = mt_arena_alloc(&mr->m->mem, (size_t)ORDER * ORDER, sizeof *matrix);
    if (matrix == NULL) {
        return NULL;
    }
    mt_items rows = mt_reader_items(&mr->r, value);
    if (rows.count != ORDER) {
        mt_diag_structure(mr->r.diags, value, "must have %d rows, not %d", ORDER, rows.count);
        return matrix;
    }
    for (int i = 0; mt_items_next(&rows); i++) {
        int n = 0;
        const mt_num *const nums = mt_read_nums(mr, rows.at, false, ORDER, ORDER, &n);
        for (int k = 0; k < n; k++) {
            matrix[ORDER * i + k] = nums[k];
        }
    }
    return matrix;
}

static mt_spring spring_default(bool damper)
{
    mt_spring s = {.damper = damper,
                   .joint_name = {NULL, MT_NO_ADDR},
                   .joint = MT_ABSENT,
                   .joint_link = MT_ABSENT,
                   .joint_hinge = MT_ABSENT,
                   .stiffness = MT_ABSENT,
                   .preload = MT_ABSENT,
                   .loss_factor = MT_ABSENT};
    for (int k = 0; k < 3; k++) {
        s.translation[k] = MT_ABSENT;
        s.rotation[k] = MT_ABSENT;
    }
    return s;
}

static void read_preload(mt_model_reader *mr, const mt_addr *at, mt_spring *s)
{
    const bool torsion = s->type == MT_SPRING_TORSION;
    const mt_num force = mt_read_num(mr, at[SPRING_PRELOAD_N]);
    const mt_num torque = mt_read_num(mr, at[SPRING_PRELOAD_N_M]);
    s->preload = torsion ? torque : force;
    if (s->type != MT_SPRING_TYPE_COUNT) {
        report_missing_member(mr, at[torsion ? SPRING_PRELOAD_N : SPRING_PRELOAD_N_M], s,
                              torsion ? "preload_n" : "preload_n_m");
    }
}

static void read_spring(mt_model_reader *mr, mt_addr value, bool damper, mt_spring *s)
{
    static const mt_spring_type damper_types[] = {MT_SPRING_TORSION, MT_SPRING_AXIAL,
                                                  MT_SPRING_BUSHING};
    static const char *const damper_names[] = {"torsion", "axial", "bushing"};
    const int before = mr->r.diags->errors;
    mt_addr at[SPRING_COUNT];
    for (int i = 0; i < SPRING_COUNT; i++) {
        at[i] = MT_NO_ADDR;
    }
    (void)mt_reader_object(&mr->r, value, damper ? &mt_damper_keys : &mt_spring_keys, at);
    *s = spring_default(damper);
    s->name = mt_reader_name(&mr->r, at[SPRING_NAME]);
    int type =
        mt_reader_choice(&mr->r, at[SPRING_TYPE], "type", damper ? damper_names : SPRING_NAMES,
                         damper ? MT_COUNT(damper_names) : MT_COUNT(SPRING_NAMES));
    type = damper && type != MT_ABSENT ? (int)damper_types[type] : type;
    s->type = type == MT_ABSENT ? MT_SPRING_TYPE_COUNT : (mt_spring_type)type;
    mt_read_bodies(mr, at[SPRING_BODIES], s->bodies);
    s->joint_name = mt_reader_ref(&mr->r, at[SPRING_JOINT]);
    s->n_at = mt_read_at(mr, at[SPRING_AT], s->at);
    read_coefficients(mr, at, s);
    read_preload(mr, at, s);
    s->free_length = mt_read_num(mr, at[SPRING_FREE_LENGTH]);
    s->free_angle = mt_read_num(mr, at[SPRING_FREE_ANGLE]);
    s->youngs_modulus = mt_read_num(mr, at[SPRING_YOUNG]);
    s->area = mt_read_num(mr, at[SPRING_AREA]);
    s->density = mt_read_num(mr, at[SPRING_DENSITY]);
    s->loss_factor = mt_read_num(mr, at[SPRING_LOSS]);
    s->matrix = read_matrix(mr, at[SPRING_MATRIX]);
    s->in = mt_read_presence(mr, at[SPRING_IN]);
    if (mr->r.diags->errors > before) {
        s->type = MT_SPRING_TYPE_COUNT;
    }
}

void mt_read_springs(mt_model_reader *mr, mt_addr springs, mt_addr dampers)
{
    mt_model *const m = mr->m;
    mt_items walk[] = {mt_reader_items(&mr->r, springs), mt_reader_items(&mr->r, dampers)};
    mt_items both = {.count = walk[0].count + walk[1].count};
    m->springs = mt_reader_room(&mr->r, &both, sizeof *m->springs);
    for (int k = 0; k < 2 && m->springs != NULL; k++) {
        while (mt_items_next(&walk[k])) {
            read_spring(mr, walk[k].at, k == 1, &m->springs[m->n_springs++]);
        }
    }
}
