/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies, springs and joints as measures and nodes of one program. */
#include "mechanics/build.h"

#include <stdarg.h>
#include <string.h>

#include "base/format.h"
#include "model/model.h"

/* Numbers, vectors, bodies, measures. */

/* Room for one more entry in list `name` of the system; NULL notes that memory is out. */
#define GROW(b, name)                                                                        \
    mt_arena_grow(&(b)->sys->mem, (b)->sys->name, (b)->sys->n_##name, &(b)->sys->cap_##name, \
                  sizeof *(b)->sys->name)

mt_node mt_build_num_or(mt_builder *b, mt_num num, mt_node otherwise)
{
    if (num == MT_ABSENT) {
        return otherwise;
    }
    const mt_number *const number = &b->model->nums[num];
    return mt_program_expr(&b->sys->program, &number->expr, b->sys->parameters, number->addr);
}

mt_node mt_build_num(mt_builder *b, mt_num num)
{
    return mt_build_num_or(b, num, MT_NO_NODE);
}

void mt_build_coordinates(mt_builder *b, const mt_num x[3], mt_node out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = mt_build_num_or(b, x[i], b->zero);
    }
}

void mt_build_position(mt_builder *b, const mt_position *p, mt_node out[3])
{
    mt_build_coordinates(b, p->point >= 0 ? b->model->points[p->point].x : p->x, out);
}

const char *mt_build_name(mt_builder *b, const char *fmt, ...)
{
    char text[256];
    va_list args;
    va_start(args, fmt);
    (void)mt_vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const char *const s = mt_arena_strdup(&b->sys->mem, text);
    return s == NULL ? "" : s;
}

static int compare_vecs(const void *context, const void *key, int i)
{
    const mt_builder *const b = context;
    const mt_vec_def *const x = key;
    const mt_vec_def *const y = &b->sys->vecs[i];
    const int of_x[] = {(int)x->kind, x->node[0], x->node[1], x->node[2], x->axis, x->helper};
    const int of_y[] = {(int)y->kind, y->node[0], y->node[1], y->node[2], y->axis, y->helper};
    for (int k = 0; k < MT_COUNT(of_x); k++) {
        if (of_x[k] != of_y[k]) {
            return of_x[k] < of_y[k] ? -1 : 1;
        }
    }
    return 0;
}

/* Index of the vector, added where there is no equal one. */
static int add_vec(mt_builder *b, const mt_vec_def *def)
{
    mt_system *const sys = b->sys;
    const int known = mt_sorted_find(&b->vec_order, compare_vecs, b, def);
    if (known >= 0) {
        return known;
    }
    mt_vec_def *const grown = GROW(b, vecs);
    if (grown == NULL) {
        return 0;
    }
    sys->vecs = grown;
    if (!mt_sorted_add(&b->vec_order, &sys->mem, compare_vecs, b, def)) {
        return 0;
    }
    sys->vecs[sys->n_vecs] = *def;
    return sys->n_vecs++;
}

int mt_build_vec(mt_builder *b, mt_vec_kind kind, const mt_node node[3], const char *what)
{
    const mt_vec_def def = {.kind = kind,
                            .node = {node[0], node[1], node[2]},
                            .axis = -1,
                            .helper = -1,
                            .what = what};
    return add_vec(b, &def);
}

int mt_build_perp(mt_builder *b, int axis, int which)
{
    const mt_vec_def def = {.kind = which == 1 ? MT_VEC_PERP1 : MT_VEC_PERP2,
                            .node = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE},
                            .axis = axis,
                            .helper = -1,
                            .what = b->sys->vecs != NULL ? b->sys->vecs[axis].what : NULL};
    return add_vec(b, &def);
}

int mt_build_cross(mt_builder *b, int first, int second)
{
    const mt_vec_def def = {.kind = MT_VEC_CROSS,
                            .node = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE},
                            .axis = first,
                            .helper = second,
                            .what = b->sys->vecs != NULL ? b->sys->vecs[first].what : NULL};
    return add_vec(b, &def);
}

mt_node mt_build_length(mt_builder *b, const mt_node from[3], const mt_node to[3])
{
    mt_program *const p = &b->sys->program;
    const mt_node dx = mt_program_sub(p, to[0], from[0]);
    const mt_node dy = mt_program_sub(p, to[1], from[1]);
    const mt_node plane = mt_program_binary(p, MT_OP_HYPOT, dx, dy, MT_NO_ADDR);
    if (b->sys->dimension == 2) {
        return plane;
    }
    return mt_program_binary(p, MT_OP_HYPOT, plane, mt_program_sub(p, to[2], from[2]),
                             MT_NO_ADDR);
}

int mt_build_arm(mt_builder *b, int body, const mt_node at[3], const char *what)
{
    mt_node arm[3];
    for (int i = 0; i < 3; i++) {
        arm[i] = at[i];
        if (body != MT_GROUND) {
            const mt_vec_def *const centre = &b->sys->vecs[b->sys->bodies[body].centre];
            arm[i] = mt_program_sub(&b->sys->program, at[i], centre->node[i]);
        }
    }
    return mt_build_vec(b, MT_VEC_NODES, arm, what);
}

int mt_build_body(mt_builder *b, const char *name, const mt_node centre[3], bool point_mass)
{
    mt_system *const sys = b->sys;
    mt_state_body *const grown = GROW(b, bodies);
    if (grown == NULL) {
        return 0;
    }
    sys->bodies = grown;
    mt_state_body *const body = &sys->bodies[sys->n_bodies];
    body->name = name;
    body->centre = mt_build_vec(b, MT_VEC_NODES, centre, name);
    for (int i = 0; i < 6; i++) {
        const bool planar_out = sys->dimension == 2 && (i == 2 || i == 3 || i == 4);
        const bool free = !planar_out && !(point_mass && i >= 3);
        body->dof[i] = free ? sys->nq++ : -1;
    }
    return sys->n_bodies++;
}

mt_measure_def mt_measure_def_default(mt_measure_kind kind, int body_a, int body_b)
{
    mt_measure_def def = {
        .kind = kind,
        .component = 0,
        .body = {body_a, body_b},
        .point = {-1, -1},
        .dir = {-1, -1, -1},
    };
    for (int i = 0; i < MT_BEAM_NUMBERS; i++) {
        def.beam[i] = MT_NO_NODE;
    }
    return def;
}

int mt_build_measure(mt_builder *b, const mt_measure_def *def)
{
    mt_system *const sys = b->sys;
    mt_measure_def *const grown = GROW(b, measures);
    if (grown == NULL) {
        return 0;
    }
    sys->measures = grown;
    sys->measures[sys->n_measures] = *def;
    return sys->n_measures++;
}

int mt_build_angle(mt_builder *b, int body_a, int body_b, int axis)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_ANGLE, body_a, body_b);
    def.dir[0] = mt_build_perp(b, axis, 1);
    def.dir[1] = mt_build_perp(b, axis, 2);
    return mt_build_measure(b, &def);
}

void mt_build_constraint(mt_builder *b, int measure, mt_node target, bool drawn)
{
    mt_system *const sys = b->sys;
    mt_constraint_def *const grown = GROW(b, constraints);
    if (grown == NULL) {
        return;
    }
    sys->constraints = grown;
    const mt_constraint_def def = {.terms = 1,
                                   .measure = {measure, -1},
                                   .coefficient = {MT_NO_NODE, MT_NO_NODE},
                                   .target = target,
                                   .drawn = drawn,
                                   .joint = sys->n_joints - 1};
    sys->constraints[sys->n_constraints++] = def;
}

void mt_build_inertia(mt_builder *b, const mt_inertia_def *def)
{
    mt_system *const sys = b->sys;
    if (def->coefficient == MT_NO_NODE) {
        return; /* out of memory */
    }
    const mt_program_node *const node = &sys->program.nodes[def->coefficient];
    if (node->op == MT_OP_CONST && node->value == 0.0) {
        return; /* massless: nothing to add */
    }
    mt_inertia_def *const grown = GROW(b, inertias);
    if (grown == NULL) {
        return;
    }
    sys->inertias = grown;
    sys->inertias[sys->n_inertias++] = *def;
}

void mt_build_load(mt_builder *b, const mt_load_def *def)
{
    mt_system *const sys = b->sys;
    mt_load_def *const grown = GROW(b, loads);
    if (grown == NULL) {
        return;
    }
    sys->loads = grown;
    sys->loads[sys->n_loads++] = *def;
    sys->loaded = true;
}

void mt_build_gravity_at(mt_builder *b, int body, int point, mt_node mass)
{
    mt_system *const sys = b->sys;
    const mt_configuration *const c = &b->model->configurations[sys->configuration];
    bool any = false;
    mt_load_def load = {.measure = -1, .body = body, .point = point, .size = MT_NO_NODE};
    for (int i = 0; i < 3; i++) {
        const mt_node g =
            mt_build_num_or(b, c->has_gravity ? c->gravity[i] : MT_ABSENT, b->zero);
        load.force[i] = mt_program_mul(&sys->program, mass, g);
        any = any || load.force[i] != b->zero;
    }
    if (any) {
        mt_build_load(b, &load);
    }
}

int mt_build_item(mt_builder *b, const char *name, mt_node mass)
{
    mt_system *const sys = b->sys;
    mt_item_def *const grown = GROW(b, items);
    if (grown == NULL) {
        return 0;
    }
    sys->items = grown;
    sys->items[sys->n_items] = (mt_item_def){name, mass};
    return sys->n_items++;
}

bool mt_build_attach(mt_builder *b, const mt_attach *a, int *body)
{
    switch (a->kind) {
    case MT_ATTACH_GROUND:
        *body = MT_GROUND;
        return true;
    case MT_ATTACH_BODY:
        *body = b->body_of[a->index];
        return *body >= 0;
    case MT_ATTACH_LINK_START:
    case MT_ATTACH_LINK_END:
    case MT_ATTACH_LINK_ELEMENT:
    case MT_ATTACH_LINK_NODE:
        *body = b->link_first[a->index] + a->part;
        return b->link_first[a->index] >= 0;
    }
    return false;
}

mt_status mt_build_bodies(mt_builder *b)
{
    for (int i = 0; i < b->model->n_bodies; i++) {
        const mt_body *const body = &b->model->bodies[i];
        mt_node centre[3];
        b->body_of[i] = -1;
        if (!mt_model_present(&body->in, b->sys->configuration)) {
            continue;
        }
        mt_build_position(b, &body->centre, centre);
        const int at = mt_build_body(b, body->name.s, centre, body->point_mass);
        const mt_node mass = mt_build_num_or(b, body->mass, b->zero);
        b->body_of[i] = at;
        const int item = mt_build_item(b, body->name.s, mass);
        mt_inertia_def def = {.kind = MT_INERTIA_TRANSLATION,
                              .coefficient = mass,
                              .body = {at, at},
                              .point = {-1, -1},
                              .dir = {-1, -1, -1},
                              .shape = {MT_NO_NODE, MT_NO_NODE},
                              .item = item};
        mt_build_inertia(b, &def);
        mt_build_gravity_at(b, at, -1, mass);
        if (body->point_mass) {
            continue;
        }
        static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
        def.kind = MT_INERTIA_ROTATION;
        for (int k = 0; k < (b->sys->dimension == 2 ? 1 : 6); k++) {
            const int *const axes = b->sys->dimension == 2 ? AXES[2] : AXES[k];
            def.coefficient = mt_build_num_or(b, body->inertia[k], b->zero);
            def.dir[0] = b->axis_vec[axes[0]];
            def.dir[1] = b->axis_vec[axes[1]];
            /* J_ab and J_ba; the tensor's off-diagonal entry as it stands in the matrix */
            if (axes[0] != axes[1]) {
                def.coefficient = mt_program_mul(
                    &b->sys->program, mt_program_const(&b->sys->program, 2.0), def.coefficient);
            }
            mt_build_inertia(b, &def);
        }
    }
    return MT_OK;
}

/* Springs, dampers and bars as energies of measures. */

typedef struct ends {
    int body[2];
    int arm[2];
    mt_node at[2][3];
} ends;

static void append_spring_def(mt_builder *b, const mt_spring_def *def)
{
    mt_system *const sys = b->sys;
    mt_spring_def *const springs = mt_arena_grow(&sys->mem, sys->springs, sys->n_springs,
                                                 &sys->cap_springs, sizeof *springs);
    if (springs == NULL) {
        return;
    }
    sys->springs = springs;
    sys->springs[sys->n_springs++] = *def;
    sys->loaded = sys->loaded ||
                  (!def->damper && (def->free != MT_NO_NODE || def->preload != MT_NO_NODE));
}

static mt_status spring_ends(mt_builder *b, const mt_spring *spring, ends *e)
{
    const char *const what = mt_build_name(b, "end of spring \"%s\"", spring->name.s);
    for (int side = 0; side < 2; side++) {
        if (!mt_build_attach(b, &spring->bodies[side], &e->body[side])) {
            return mt_fail(b->err, MT_E_INPUT,
                           "spring \"%s\" holds a body that is not in configuration \"%s\"",
                           spring->name.s,
                           b->model->configurations[b->sys->configuration].name.s);
        }
        e->arm[side] = -1;
        if (spring->n_at > 0) {
            mt_build_position(b, &spring->at[spring->n_at == 2 ? side : 0], e->at[side]);
            e->arm[side] = mt_build_arm(b, e->body[side], e->at[side], what);
        } else if (spring->bodies[side].kind == MT_ATTACH_LINK_NODE) {
            mt_build_link_node(b, spring->bodies[side].index, spring->bodies[side].element,
                               e->at[side]);
            e->arm[side] = mt_build_arm(b, e->body[side], e->at[side], what);
        } else {
            for (int i = 0; i < 3; i++) {
                e->at[side][i] =
                    e->body[side] == MT_GROUND
                        ? b->zero
                        : b->sys->vecs[b->sys->bodies[e->body[side]].centre].node[i];
            }
        }
    }
    if (e->body[0] == e->body[1]) {
        return mt_fail(b->err, MT_E_INPUT, "spring \"%s\" connects a body with itself",
                       spring->name.s);
    }
    return MT_OK;
}

static mt_spring_def spring_default(mt_builder *b, const mt_spring *spring, int measure,
                                    mt_node stiffness)
{
    const mt_spring_def def = {.name = spring->name.s,
                               .measure = {measure, measure},
                               .stiffness = stiffness,
                               .free = MT_NO_NODE,
                               .preload = MT_NO_NODE,
                               .loss = mt_build_loss(b, spring->loss_factor),
                               .damper = spring->damper,
                               .item = b->sys->n_items - 1};
    return def;
}

static int axial_measure(mt_builder *b, const ends *e)
{
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_DISTANCE, e->body[0], e->body[1]);
    def.point[0] = e->arm[0];
    def.point[1] = e->arm[1];
    return mt_build_measure(b, &def);
}

int mt_build_find_coordinate(const mt_builder *b, int joint, int link, int hinge, bool angle)
{
    const int first = joint != MT_ABSENT ? b->joint_at[joint] : b->hinge_at[link];
    const int at = first < 0 || joint != MT_ABSENT ? first : first + hinge;
    return at >= 0 && b->sys->joints[at].angle == angle ? b->sys->joints[at].coordinate : -1;
}

mt_node mt_build_loss(mt_builder *b, mt_num loss_factor)
{
    const mt_node loss = mt_build_num(b, loss_factor);
    return loss == b->zero ? MT_NO_NODE : loss;
}

/* The displacement of a joint along its axis: its coordinate, or beside the angle of a
 * cylindrical one what its first equation measures across the axis (on_line of build.c),
 * along it. -1: it is not in this configuration. */
static int slide_measure(mt_builder *b, const mt_spring *spring)
{
    const mt_system *const sys = b->sys;
    const int at = b->joint_at[spring->joint];
    if (at < 0 || !sys->joints[at].angle) {
        return mt_build_find_coordinate(b, spring->joint, MT_ABSENT, MT_ABSENT, false);
    }
    if (mt_arena_failed(&sys->mem)) {
        return -1;
    }
    mt_measure_def def = sys->measures[sys->constraints[sys->joints[at].first].measure[0]];
    def.dir[0] = sys->vecs[def.dir[0]].axis;
    return mt_build_measure(b, &def);
}

static mt_status no_coordinate(mt_builder *b, const mt_spring *spring, const char *what)
{
    return mt_fail(b->err, MT_E_INPUT,
                   "spring \"%s\": joint \"%s\" is not in configuration \"%s\" or has no %s",
                   spring->name.s, spring->joint_name.s,
                   b->model->configurations[b->sys->configuration].name.s, what);
}

static mt_status build_torsion(mt_builder *b, const mt_spring *spring)
{
    int measure = -1;
    if (spring->joint != MT_ABSENT || spring->joint_link != MT_ABSENT) {
        measure = mt_build_find_coordinate(b, spring->joint, spring->joint_link,
                                           spring->joint_hinge, true);
        if (measure < 0) {
            return no_coordinate(b, spring, "angle");
        }
    } else {
        ends e = {.body = {0}};
        MT_TRY(spring_ends(b, spring, &e));
        measure = mt_build_angle(b, e.body[0], e.body[1], b->axis_vec[2]);
    }
    mt_spring_def def =
        spring_default(b, spring, measure, mt_build_num_or(b, spring->stiffness, b->zero));
    def.free = mt_build_num(b, spring->free_angle);
    def.preload = mt_build_num(b, spring->preload);
    append_spring_def(b, &def);
    return MT_OK;
}

static mt_status build_axial(mt_builder *b, const mt_spring *spring)
{
    int measure = -1;
    if (spring->joint != MT_ABSENT) {
        measure = slide_measure(b, spring);
        if (measure < 0) {
            return no_coordinate(b, spring, "displacement");
        }
    } else {
        ends e = {.body = {0}};
        MT_TRY(spring_ends(b, spring, &e));
        measure = axial_measure(b, &e);
    }
    mt_spring_def def =
        spring_default(b, spring, measure, mt_build_num_or(b, spring->stiffness, b->zero));
    def.free = mt_build_num(b, spring->free_length);
    def.preload = mt_build_num(b, spring->preload);
    append_spring_def(b, &def);
    return MT_OK;
}

/* A uniform thin rod between two points: its velocity is linear along it, so the consistent
 * mass m/6 [2 I, I; I, 2 I] is exact, elastic or rigid, and so is half its weight at each
 * end. */
static void build_rod(mt_builder *b, const int body[2], const int arm[2], mt_node mass,
                      int item)
{
    mt_program *const p = &b->sys->program;
    const mt_inertia_def inertia = {.kind = MT_INERTIA_BAR,
                                    .coefficient = mass,
                                    .body = {body[0], body[1]},
                                    .point = {arm[0], arm[1]},
                                    .dir = {-1, -1, -1},
                                    .shape = {MT_NO_NODE, MT_NO_NODE},
                                    .item = item};
    mt_build_inertia(b, &inertia);
    for (int side = 0; side < 2; side++) {
        if (body[side] != MT_GROUND) {
            mt_build_gravity_at(b, body[side], arm[side],
                                mt_program_mul(p, mt_program_const(p, 0.5), mass));
        }
    }
}

/* Bar: EA/L along its line, consistent mass rho A L / 6 [2 I, I; I, 2 I]; L is its length as
 * drawn. */
static mt_status build_bar(mt_builder *b, const mt_spring *spring)
{
    mt_program *const p = &b->sys->program;
    ends e = {.body = {0}};
    MT_TRY(spring_ends(b, spring, &e));
    const mt_node length = mt_build_length(b, e.at[0], e.at[1]);
    const mt_node area = mt_build_num_or(b, spring->area, b->zero);
    const mt_node ea =
        mt_program_mul(p, mt_build_num_or(b, spring->youngs_modulus, b->zero), area);
    const mt_node mass = mt_program_mul(
        p, mt_program_mul(p, mt_build_num_or(b, spring->density, b->zero), area), length);
    const int item = mt_build_item(b, spring->name.s, mass);
    mt_spring_def def =
        spring_default(b, spring, axial_measure(b, &e), mt_program_div(p, ea, length));
    def.preload = mt_build_num(b, spring->preload);
    append_spring_def(b, &def);
    build_rod(b, e.body, e.arm, mass, item);
    return MT_OK;
}

/* Bushing between the two points, in global axes of the drawn position carried by bodies[0]:
 * displacement (3) and rotation vector (3). */
static mt_status build_bushing(mt_builder *b, const mt_spring *spring)
{
    ends e = {.body = {0}};
    int measure[6];
    MT_TRY(spring_ends(b, spring, &e));
    for (int k = 0; k < 6; k++) {
        const bool turns = k >= 3;
        mt_measure_def def = mt_measure_def_default(
            turns ? MT_MEASURE_ROTATION : MT_MEASURE_PLANE, e.body[0], e.body[1]);
        def.point[0] = e.arm[0];
        def.point[1] = e.arm[1];
        for (int i = 0; i < 3; i++) {
            def.dir[i] = b->axis_vec[turns ? i : k];
        }
        def.component = k % 3;
        measure[k] = mt_build_measure(b, &def);
        const mt_num *const diagonals = turns ? spring->rotation : spring->translation;
        const mt_num diagonal = diagonals[k % 3];
        if (spring->matrix == NULL && diagonal != MT_ABSENT) {
            const mt_spring_def one =
                spring_default(b, spring, measure[k], mt_build_num(b, diagonal));
            append_spring_def(b, &one);
        }
    }
    for (int i = 0; i < 6 && spring->matrix != NULL; i++) {
        for (int j = 0; j <= i; j++) {
            mt_node k = mt_build_num(b, spring->matrix[(6 * i) + j]);
            if (k == b->zero) {
                continue;
            }
            if (i != j) { /* k_ij and k_ji */
                k = mt_program_mul(&b->sys->program, mt_program_const(&b->sys->program, 2.0),
                                   k);
            }
            mt_spring_def one = spring_default(b, spring, measure[i], k);
            one.measure[1] = measure[j];
            append_spring_def(b, &one);
        }
    }
    return MT_OK;
}

mt_status mt_build_springs(mt_builder *b)
{
    for (int i = 0; i < b->model->n_springs; i++) {
        const mt_spring *const spring = &b->model->springs[i];
        mt_status rc = MT_OK;
        if (!mt_model_present(&spring->in, b->sys->configuration)) {
            continue;
        }
        switch (spring->type) {
        case MT_SPRING_TORSION:
            rc = build_torsion(b, spring);
            break;
        case MT_SPRING_AXIAL:
            rc = build_axial(b, spring);
            break;
        case MT_SPRING_BAR:
            rc = build_bar(b, spring);
            break;
        case MT_SPRING_BUSHING:
            rc = build_bushing(b, spring);
            break;
        case MT_SPRING_TYPE_COUNT:
            break;
        }
        MT_TRY(rc);
    }
    return MT_OK;
}

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
        build_rod(b, body, arm, mass, mt_build_item(b, joint->name.s, mass));
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
