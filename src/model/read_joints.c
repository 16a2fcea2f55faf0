/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joints, springs and dampers. */
#include "model/read_priv.h"

#define JOINT_KEYS(X)                                           \
    X(JOINT_NAME, "name", TEXT, true)                           \
    X(JOINT_TYPE, "type", TEXT, true)                           \
    X(JOINT_BODIES, "bodies", LIST, false)                      \
    X(JOINT_AT, "at", TEXT_OR_LIST, false, POINT)               \
    X(JOINT_AXIS, "axis", LIST, false, AXIS)                    \
    X(JOINT_AXIS_B, "axis_b", LIST, false, AXIS)                \
    X(JOINT_LENGTH, "length_m", NUMBER, false, POSITIVE)        \
    X(JOINT_MASS, "mass_kg", NUMBER, false, NOT_NEGATIVE)       \
    X(JOINT_JOINTS, "joints", LIST, false)                      \
    X(JOINT_RATIO, "ratio", NUMBER, false, NONZERO)             \
    X(JOINT_RATIO_M, "ratio_m_per_rad", NUMBER, false, NONZERO) \
    X(JOINT_IN, "in", LIST, false)                              \
    X(JOINT_DESCRIPTION, "description", TEXT, false)            \
    X(JOINT_SOURCE, "source", TEXT, false)
enum { JOINT_KEYS(MT_READ_ENUM) JOINT_COUNT };
MT_READ_TABLE(mt_joint_keys, "joint", JOINT_KEYS);

#define SPRING_KEYS(X)                                                    \
    X(SPRING_NAME, "name", TEXT, true)                                    \
    X(SPRING_TYPE, "type", TEXT, true)                                    \
    X(SPRING_BODIES, "bodies", LIST, false)                               \
    X(SPRING_JOINT, "joint", TEXT, false)                                 \
    X(SPRING_AT, "at", TEXT_OR_LIST, false, POINT)                        \
    X(SPRING_FORCE, "stiffness_n_per_m", NUMBER_OR_LIST, false, ANY)      \
    X(SPRING_TORQUE, "stiffness_n_m_per_rad", NUMBER_OR_LIST, false, ANY) \
    X(SPRING_IN, "in", LIST, false)                                       \
    X(SPRING_DESCRIPTION, "description", TEXT, false)                     \
    X(SPRING_SOURCE, "source", TEXT, false)                               \
    X(SPRING_FREE_LENGTH, "free_length_m", NUMBER, false, NOT_NEGATIVE)   \
    X(SPRING_FREE_ANGLE, "free_angle_rad", NUMBER, false, ANY)            \
    X(SPRING_PRELOAD_N, "preload_n", NUMBER, false, ANY)                  \
    X(SPRING_PRELOAD_N_M, "preload_n_m", NUMBER, false, ANY)              \
    X(SPRING_YOUNG, "youngs_modulus_pa", NUMBER, false, MODULUS)          \
    X(SPRING_AREA, "area_m2", NUMBER, false, NOT_NEGATIVE)                \
    X(SPRING_DENSITY, "density_kg_per_m3", NUMBER, false, DENSITY)        \
    X(SPRING_LOSS, "loss_factor", NUMBER, false, LOSS)                    \
    X(SPRING_MATRIX, "stiffness_matrix", LIST, false, MATRIX)
enum { SPRING_KEYS(MT_READ_ENUM) SPRING_COUNT };
MT_READ_TABLE(mt_spring_keys, "spring", SPRING_KEYS);

/* The first ten of a spring's keys, in their order, so that one reader serves both. */
#define DAMPER_KEYS(X)                                                    \
    X(DAMPER_NAME, "name", TEXT, true)                                    \
    X(DAMPER_TYPE, "type", TEXT, true)                                    \
    X(DAMPER_BODIES, "bodies", LIST, false)                               \
    X(DAMPER_JOINT, "joint", TEXT, false)                                 \
    X(DAMPER_AT, "at", TEXT_OR_LIST, false, POINT)                        \
    X(DAMPER_FORCE, "damping_n_s_per_m", NUMBER_OR_LIST, false, ANY)      \
    X(DAMPER_TORQUE, "damping_n_m_s_per_rad", NUMBER_OR_LIST, false, ANY) \
    X(DAMPER_IN, "in", LIST, false)                                       \
    X(DAMPER_DESCRIPTION, "description", TEXT, false)                     \
    X(DAMPER_SOURCE, "source", TEXT, false)
enum { DAMPER_KEYS(MT_READ_ENUM) DAMPER_COUNT };
_Static_assert((int)DAMPER_COUNT == (int)SPRING_SOURCE + 1,
               "a damper's keys are a spring's first");
MT_READ_TABLE(mt_damper_keys, "damper", DAMPER_KEYS);

#define NAME_OF(id, name) name,
static const char *const JOINT_NAMES[] = {MT_JOINT_LIST(NAME_OF)};
static const char *const SPRING_NAMES[] = {MT_SPRING_LIST(NAME_OF)};

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
