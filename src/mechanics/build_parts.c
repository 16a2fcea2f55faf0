/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies, springs, joints and links, by the nodes and measures of build.c. */
#include "mechanics/build.h"
#include "model/model.h"

/*
 * Axes of an item's own as unit vectors e0 e1 e2 (model.h: mt_axes). From x and y: e2 = x x y,
 * e1 = e2 x e0; from x and z: e1 = z x x, e2 = e0 x e1; from angles the columns of Rz Ry Rx.
 */
static int unit_vec(mt_builder *b, const mt_num x[3], const char *what)
{
    mt_node node[3];
    mt_build_coordinates(b, x, node);
    return mt_build_vec(b, MT_VEC_UNIT, node, what);
}

static void turned_axes(mt_builder *b, const mt_axes *axes, const char *what, int e[3])
{
    mt_program *const p = &b->sys->program;
    mt_node s[3] = {b->zero, b->zero, b->zero};
    mt_node c[3] = {b->one, b->one, b->one};
    for (int k = 0; k < axes->n_angles; k++) {
        const mt_node angle = mt_build_num_or(b, axes->angles[k], b->zero);
        const int about = axes->n_angles == 1 ? 2 : k;
        s[about] = mt_program_unary(p, MT_OP_SIN, angle, MT_NO_ADDR);
        c[about] = mt_program_unary(p, MT_OP_COS, angle, MT_NO_ADDR);
    }
    const mt_node both = mt_program_mul(p, s[0], s[1]);
    const mt_node x[3] = {mt_program_mul(p, c[1], c[2]), mt_program_mul(p, c[1], s[2]),
                          mt_program_unary(p, MT_OP_NEG, s[1], MT_NO_ADDR)};
    const mt_node y[3] = {
        mt_program_sub(p, mt_program_mul(p, both, c[2]), mt_program_mul(p, c[0], s[2])),
        mt_program_add(p, mt_program_mul(p, both, s[2]), mt_program_mul(p, c[0], c[2])),
        mt_program_mul(p, s[0], c[1])};
    e[0] = mt_build_vec(b, MT_VEC_UNIT, x, what);
    e[1] = mt_build_vec(b, MT_VEC_UNIT, y, what);
    e[2] = mt_build_cross(b, MT_VEC_CROSS, e[0], e[1]);
}

static void build_axes(mt_builder *b, const mt_axes *axes, const char *of, const char *name,
                       int e[3])
{
    for (int k = 0; k < 3; k++) {
        e[k] = b->axis_vec[k];
    }
    if (!axes->given) {
        return;
    }
    const char *const what = mt_build_name(b, "axes of %s \"%s\"", of, name);
    if (axes->n_angles > 0) {
        turned_axes(b, axes, what, e);
        return;
    }
    e[0] = unit_vec(b, axes->x, what);
    if (axes->has_y) {
        e[2] = mt_build_cross(b, MT_VEC_ACROSS, e[0], unit_vec(b, axes->y, what));
        e[1] = mt_build_cross(b, MT_VEC_CROSS, e[2], e[0]);
    } else if (axes->has_z) {
        e[1] = mt_build_cross(b, MT_VEC_ACROSS, unit_vec(b, axes->z, what), e[0]);
        e[2] = mt_build_cross(b, MT_VEC_CROSS, e[0], e[1]);
    } else {
        e[1] = mt_build_cross(b, MT_VEC_CROSS, e[2], e[0]);
    }
}

/* Lengths and bodies. */

static mt_node build_length(mt_builder *b, const mt_node from[3], const mt_node to[3])
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

static int build_body(mt_builder *b, const char *name, const mt_node centre[3], bool point_mass)
{
    mt_system *const sys = b->sys;
    mt_state_body *const grown = MT_BUILD_GROW(b, bodies);
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

static void build_inertia(mt_builder *b, const mt_inertia_def *def)
{
    mt_system *const sys = b->sys;
    if (def->coefficient == MT_NO_NODE) {
        return; /* out of memory */
    }
    const mt_program_node *const node = &sys->program.nodes[def->coefficient];
    if (node->op == MT_OP_CONST && node->value == 0.0) {
        return; /* massless: nothing to add */
    }
    mt_inertia_def *const grown = MT_BUILD_GROW(b, inertias);
    if (grown == NULL) {
        return;
    }
    sys->inertias = grown;
    sys->inertias[sys->n_inertias++] = *def;
}

static void build_gravity_at(mt_builder *b, int body, int point, mt_node mass)
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

static int build_item(mt_builder *b, const char *name, mt_node mass)
{
    mt_system *const sys = b->sys;
    mt_item_def *const grown = MT_BUILD_GROW(b, items);
    if (grown == NULL) {
        return 0;
    }
    sys->items = grown;
    sys->items[sys->n_items] = (mt_item_def){name, mass};
    return sys->n_items++;
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
        const int at = build_body(b, body->name.s, centre, body->point_mass);
        const mt_node mass = mt_build_num_or(b, body->mass, b->zero);
        b->body_of[i] = at;
        const int item = build_item(b, body->name.s, mass);
        mt_inertia_def def = {.kind = MT_INERTIA_TRANSLATION,
                              .coefficient = mass,
                              .body = {at, at},
                              .point = {-1, -1},
                              .dir = {-1, -1, -1},
                              .shape = {MT_NO_NODE, MT_NO_NODE},
                              .item = item};
        build_inertia(b, &def);
        build_gravity_at(b, at, -1, mass);
        if (body->point_mass) {
            continue;
        }
        static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
        int e[3];
        build_axes(b, &body->axes, "body", body->name.s, e);
        def.kind = MT_INERTIA_ROTATION;
        for (int k = 0; k < (b->sys->dimension == 2 ? 1 : 6); k++) {
            const int *const axes = b->sys->dimension == 2 ? AXES[2] : AXES[k];
            def.coefficient = mt_build_num_or(b, body->inertia[k], b->zero);
            def.dir[0] = e[axes[0]];
            def.dir[1] = e[axes[1]];
            /* J_ab and J_ba; the tensor's off-diagonal entry as it stands in the matrix */
            if (axes[0] != axes[1]) {
                def.coefficient = mt_program_mul(
                    &b->sys->program, mt_program_const(&b->sys->program, 2.0), def.coefficient);
            }
            build_inertia(b, &def);
        }
    }
    return MT_OK;
}

/* Places on links. */

typedef struct link_geometry {
    mt_node from[3];
    mt_node to[3];
    mt_node span;
    int triad[3]; /* vectors e1 (along), e2, e3 (hinge axis) */
} link_geometry;

static mt_node listed(mt_builder *b, const mt_num *list, int n, int i, mt_node otherwise)
{
    return n == 0 ? otherwise : mt_build_num(b, list[n == 1 ? 0 : i]);
}

static mt_node times(mt_builder *b, double factor, mt_node a)
{
    return mt_program_mul(&b->sys->program, mt_program_const(&b->sys->program, factor), a);
}

/* from + s/span (to - from). */
static void point_along(mt_builder *b, const link_geometry *g, mt_node s, mt_node out[3])
{
    mt_program *const p = &b->sys->program;
    const mt_node fraction = mt_program_div(p, s, g->span);
    for (int i = 0; i < 3; i++) {
        const mt_node d = mt_program_sub(p, g->to[i], g->from[i]);
        out[i] = d == b->zero ? g->from[i]
                              : mt_program_add(p, g->from[i], mt_program_mul(p, fraction, d));
    }
}

void mt_build_link_node(mt_builder *b, int link, int node, mt_node out[3])
{
    mt_program *const p = &b->sys->program;
    const mt_link *const l = &b->model->links[link];
    link_geometry g;
    mt_build_position(b, &l->from, g.from);
    mt_build_position(b, &l->to, g.to);
    g.span = build_length(b, g.from, g.to);
    mt_node s = times(b, (double)node / (double)l->elements, g.span);
    if (l->n_element_length > 0) {
        s = b->zero;
        for (int i = 0; i < node; i++) {
            s = mt_program_add(
                p, s, listed(b, l->element_length, l->n_element_length, i, MT_NO_NODE));
        }
    }
    point_along(b, &g, s, out);
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

/* The node of a loss factor; MT_NO_NODE where it is absent or the constant 0. */
static mt_node build_loss(mt_builder *b, mt_num loss_factor)
{
    const mt_node loss = mt_build_num(b, loss_factor);
    return loss == b->zero ? MT_NO_NODE : loss;
}

/* The loss factor along (k < 3) or about an axis. */
static mt_num loss_along(const mt_builder *b, const mt_loss *loss, int k)
{
    const bool two = b->sys->dimension == 2;
    return loss->n == 0 ? loss->all : loss->each[two && k >= 3 ? 2 : k];
}

static mt_spring_def spring_default(mt_builder *b, const mt_spring *spring, int measure,
                                    mt_node stiffness)
{
    const mt_spring_def def = {.name = spring->name.s,
                               .measure = {measure, measure},
                               .stiffness = stiffness,
                               .free = MT_NO_NODE,
                               .preload = MT_NO_NODE,
                               .loss = build_loss(b, spring->loss.all),
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
    build_inertia(b, &inertia);
    for (int side = 0; side < 2; side++) {
        if (body[side] != MT_GROUND) {
            build_gravity_at(b, body[side], arm[side],
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
    const mt_node length = build_length(b, e.at[0], e.at[1]);
    const mt_node area = mt_build_num_or(b, spring->area, b->zero);
    const mt_node ea =
        mt_program_mul(p, mt_build_num_or(b, spring->youngs_modulus, b->zero), area);
    const mt_node mass = mt_program_mul(
        p, mt_program_mul(p, mt_build_num_or(b, spring->density, b->zero), area), length);
    const int item = build_item(b, spring->name.s, mass);
    mt_spring_def def =
        spring_default(b, spring, axial_measure(b, &e), mt_program_div(p, ea, length));
    def.preload = mt_build_num(b, spring->preload);
    append_spring_def(b, &def);
    build_rod(b, e.body, e.arm, mass, item);
    return MT_OK;
}

/* Measure of a bushing: displacement along (k < 3) or rotation vector about an axis of dir,
 * which the first body carries. */
static int bushing_measure(mt_builder *b, const int body[2], const int arm[2], const int dir[3],
                           int k)
{
    const bool turns = k >= 3;
    mt_measure_def def = mt_measure_def_default(turns ? MT_MEASURE_ROTATION : MT_MEASURE_PLANE,
                                                body[0], body[1]);
    def.point[0] = arm[0];
    def.point[1] = arm[1];
    for (int i = 0; i < 3; i++) {
        def.dir[i] = dir[turns ? i : k];
    }
    def.component = k % 3;
    return mt_build_measure(b, &def);
}

/* Bushing between the two points, along its axes as drawn, carried by bodies[0]: displacement
 * (3) and rotation vector (3). */
static mt_status build_bushing(mt_builder *b, const mt_spring *spring)
{
    ends e = {.body = {0}};
    int measure[6];
    int dir[3];
    MT_TRY(spring_ends(b, spring, &e));
    build_axes(b, &spring->axes, spring->damper ? "damper" : "spring", spring->name.s, dir);
    for (int k = 0; k < 6; k++) {
        const bool turns = k >= 3;
        measure[k] = bushing_measure(b, e.body, e.arm, dir, k);
        const mt_num *const diagonals = turns ? spring->rotation : spring->translation;
        const mt_num diagonal = diagonals[k % 3];
        if (spring->matrix == NULL && diagonal != MT_ABSENT) {
            mt_spring_def one =
                spring_default(b, spring, measure[k], mt_build_num(b, diagonal));
            one.loss = build_loss(b, loss_along(b, &spring->loss, k));
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

/* Equations of one joint between bodies at arms; for joints and hinges. */
static void build_joint_equations(mt_builder *b, mt_joint_type type, const int body[2],
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

/* The joint's axis; z where it has none. */
static int joint_axis(mt_builder *b, const mt_joint *joint)
{
    return joint->has_axis ? unit_vec(b, joint->axis,
                                      mt_build_name(b, "axis of joint \"%s\"", joint->name.s))
                           : b->axis_vec[2];
}

/*
 * A joint that yields: bodies[0] - springs, and equations where it is rigid - carrier - joint -
 * bodies[1]. The carrier has neither mass nor freedom but what springs leave it; the joint's
 * equations carry the bearing's force.
 */
static void yielding_axes(mt_builder *b, const mt_joint *joint, int axis, int dir[3])
{
    const mt_axes *const own = &joint->compliance->axes;
    const int last = b->sys->dimension - 1;
    if (!joint->has_axis) {
        build_axes(b, own, "joint", joint->name.s, dir);
        return;
    }
    dir[2] = b->axis_vec[2];
    dir[last] = axis;
    if (own->given) {
        const char *const what = mt_build_name(b, "axes of joint \"%s\"", joint->name.s);
        dir[1] = mt_build_cross(b, MT_VEC_ACROSS, axis, unit_vec(b, own->x, what));
        dir[0] = mt_build_cross(b, MT_VEC_CROSS, dir[1], axis);
        return;
    }
    dir[0] = mt_build_perp(b, axis, 1);
    if (last == 2) {
        dir[1] = mt_build_perp(b, axis, 2);
    }
}

/* Stiffness along (k < 3) or about an axis; MT_ABSENT: rigid. */
static mt_num yield_of(const mt_compliance *c, int k)
{
    return k < 3 ? c->translation[k] : c->rotation[k - 3];
}

/* The carrier, at the joint's point of bodies[0] or its centre. */
static int build_carrier(mt_builder *b, const mt_joint *joint, int first)
{
    mt_node at[3] = {b->zero, b->zero, b->zero};
    if (joint->n_at > 0) {
        mt_build_position(b, &joint->at[0], at);
    } else if (first != MT_GROUND && !mt_arena_failed(&b->sys->mem)) {
        const mt_vec_def *const centre = &b->sys->vecs[b->sys->bodies[first].centre];
        for (int k = 0; k < 3; k++) {
            at[k] = centre->node[k];
        }
    }
    return build_body(b, mt_build_name(b, "%s.bearing", joint->name.s), at, false);
}

/* What of the carrier is rigid, as equations of a joint of their own; `of`: the joint on it. */
static void build_seat(mt_builder *b, const mt_joint *joint, int of, const int first[2],
                       const int dir[3])
{
    mt_system *const sys = b->sys;
    mt_system_joint *const joints =
        mt_arena_grow(&sys->mem, sys->joints, sys->n_joints, &sys->cap_joints, sizeof *joints);
    if (joints == NULL) {
        return;
    }
    sys->joints = joints;
    const int carrier = joints[of].body[0];
    mt_system_joint seat = {.name = sys->bodies[carrier].name,
                            .type = MT_JOINT_ORIENTATION,
                            .first = sys->n_constraints,
                            .coordinate = -1,
                            .body = {first[0], carrier},
                            .model_joint = sys->joints[of].model_joint,
                            .link = MT_ABSENT,
                            .hinge = -1};
    sys->n_joints++;
    for (int k = 0; k < 6; k++) {
        if (sys->bodies[carrier].dof[k] >= 0 && yield_of(joint->compliance, k) == MT_ABSENT) {
            mt_build_constraint(
                b, bushing_measure(b, seat.body, (const int[2]){first[1], -1}, dir, k),
                MT_NO_NODE, false);
        }
    }
    seat.count = sys->n_constraints - seat.first;
    sys->joints[sys->n_joints - 1] = seat;
    sys->n_joints -= seat.count == 0 ? 1 : 0;
}

/* Springs and dampers of the carrier. */
static void build_bearing(mt_builder *b, const mt_joint *joint)
{
    mt_system *const sys = b->sys;
    const mt_compliance *const c = joint->compliance;
    const int of = b->joint_at[joint - b->model->joints];
    int body[2];
    int arm[2];
    int dir[3];
    if (of < 0 || mt_arena_failed(&sys->mem) ||
        !mt_build_attach(b, &joint->bodies[0], &body[0])) {
        return;
    }
    body[1] = sys->joints[of].body[0];
    joint_arms(b, joint, body, arm);
    yielding_axes(b, joint, joint_axis(b, joint), dir);
    for (int k = 0; k < 6; k++) {
        const mt_num damping = k < 3 ? c->damping_translation[k] : c->damping_rotation[k - 3];
        const int measure = yield_of(c, k) == MT_ABSENT
                                ? -1
                                : bushing_measure(b, body, (const int[2]){arm[0], -1}, dir, k);
        mt_spring_def def = {.name = sys->bodies[body[1]].name,
                             .measure = {measure, measure},
                             .stiffness = mt_build_num_or(b, yield_of(c, k), b->zero),
                             .free = MT_NO_NODE,
                             .preload = MT_NO_NODE,
                             .loss = build_loss(b, loss_along(b, &c->loss, k)),
                             .item = sys->n_items - 1};
        if (measure >= 0) {
            append_spring_def(b, &def);
        }
        def.damper = true;
        def.loss = MT_NO_NODE;
        def.stiffness = mt_build_num_or(b, damping, b->zero);
        if (measure >= 0 && def.stiffness != b->zero) {
            append_spring_def(b, &def);
        }
    }
}

static mt_status build_joint(mt_builder *b, const mt_joint *joint)
{
    const mt_joint_kind *const kind = mt_joint_kind_of(joint->type);
    int body[2];
    int arm[2];
    int axis[2] = {joint_axis(b, joint), -1};
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
    if (joint->has_axis_b) {
        mt_node node[3];
        mt_build_coordinates(b, joint->axis_b, node);
        axis[1] = mt_build_vec(b, MT_VEC_UNIT, node,
                               mt_build_name(b, "axis_b of joint \"%s\"", joint->name.s));
    }
    const int first[2] = {body[0], arm[0]};
    if (joint->compliance != NULL) {
        body[0] = build_carrier(b, joint, body[0]);
        arm[0] = -1;
    }
    mt_system_joint *const made = new_joint(b, joint, body);
    if (made == NULL) {
        return MT_OK;
    }
    build_joint_equations(b, joint->type, body, arm, axis, mt_build_num(b, joint->length));
    if (joint->mass != MT_ABSENT) {
        const mt_node mass = mt_build_num(b, joint->mass);
        build_rod(b, body, arm, mass, build_item(b, joint->name.s, mass));
    }
    made->count = b->sys->n_constraints - made->first;
    made->coordinate = coordinate_of(b, kind->coordinate, body, arm, axis[0]);
    made->angle = kind->coordinate == MT_COORDINATE_ANGLE;
    if (joint->compliance != NULL) {
        int dir[3];
        yielding_axes(b, joint, axis[0], dir);
        build_seat(b, joint, b->joint_at[joint - b->model->joints], first, dir);
    }
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
    for (int i = 0; i < b->model->n_joints; i++) { /* after all others, which views count */
        if (b->model->joints[i].compliance != NULL) {
            build_bearing(b, &b->model->joints[i]);
        }
    }
    return MT_OK;
}

/*
 * Links. Lumped: n rigid elements of length l_i, hinged, with a torsional spring in each hinge
 * (paper, Fig. 4); default stiffness EI over the distance of the two element centres (EI/L_e
 * for equal elements).
 *
 * Beam element: the springs of its six generalised strains (measure.c), EA/l, GJ/l, EI/l
 * and 3 EI/(l (1 + Phi)); about the straight element that is the Euler-Bernoulli or Timoshenko
 * stiffness exactly, and its springs' forces make the consistent geometric stiffness.
 */

static mt_node power(mt_builder *b, mt_node a, int n)
{
    mt_node p = a;
    for (int i = 1; i < n; i++) {
        p = mt_program_mul(&b->sys->program, p, a);
    }
    return p;
}

typedef struct section_nodes {
    mt_node area;
    mt_node i3; /* second moment for bending about the hinge axis */
    mt_node i2; /* about the other axis */
    mt_node torsion;
} section_nodes;

/* Torsion constant of a rectangle a >= c: a c^3 (1/3 - 0.21 c/a (1 - c^4/(12 a^4))), within 0.5
 * % (Roark's Formulas for Stress and Strain, table 10.1). */
static mt_node rectangle_torsion(mt_builder *b, mt_node w, mt_node h)
{
    mt_program *const p = &b->sys->program;
    const mt_node a = mt_program_binary(p, MT_OP_MAX, w, h, MT_NO_ADDR);
    const mt_node c = mt_program_binary(p, MT_OP_MIN, w, h, MT_NO_ADDR);
    const mt_node ratio = mt_program_div(p, c, a);
    const mt_node tail = mt_program_sub(p, b->one, times(b, 1.0 / 12.0, power(b, ratio, 4)));
    const mt_node factor = mt_program_sub(p, mt_program_const(p, 1.0 / 3.0),
                                          times(b, 0.21, mt_program_mul(p, ratio, tail)));
    return mt_program_mul(p, mt_program_mul(p, a, power(b, c, 3)), factor);
}

/*
 * d^2 - i^2 and d^4 - i^4 by their factors (d - i)(d + i)(d^2 + i^2): nothing cancels in a thin
 * wall, and bounds over intervals stay positive. Where i is written as d - x, d - i is x.
 */
static void ring(mt_builder *b, mt_node d, mt_node inner, section_nodes *out)
{
    mt_program *const p = &b->sys->program;
    const double pi = 3.14159265358979323846;
    const mt_program_node *const n = inner == MT_NO_NODE ? NULL : &p->nodes[inner];
    const bool by_wall = n != NULL && n->op == MT_OP_SUB && n->a == d;
    const mt_node walls = by_wall ? n->b : mt_program_sub(p, d, inner);
    const mt_node ring2 = mt_program_mul(p, walls, mt_program_add(p, d, inner));
    const mt_node squares = mt_program_add(p, power(b, d, 2), power(b, inner, 2));
    out->area = times(b, pi / 4.0, ring2);
    out->i3 = times(b, pi / 64.0, mt_program_mul(p, ring2, squares));
    out->i2 = out->i3;
    out->torsion = times(b, 2.0, out->i3);
}

static section_nodes section_of(mt_builder *b, const mt_section *s)
{
    mt_program *const p = &b->sys->program;
    section_nodes out = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE, MT_NO_NODE};
    switch (s->shape) {
    case MT_SECTION_NONE:
        break;
    case MT_SECTION_RECTANGLE: {
        const mt_node w = mt_build_num(b, s->width);
        const mt_node h = mt_build_num(b, s->height);
        out.area = mt_program_mul(p, w, h);
        out.i3 = times(b, 1.0 / 12.0, mt_program_mul(p, w, power(b, h, 3)));
        out.i2 = times(b, 1.0 / 12.0, mt_program_mul(p, h, power(b, w, 3)));
        out.torsion = rectangle_torsion(b, w, h);
        break;
    }
    case MT_SECTION_CIRCLE:
    case MT_SECTION_TUBE: {
        const mt_node d = mt_build_num(b, s->diameter);
        const mt_node inner =
            s->shape == MT_SECTION_TUBE ? mt_build_num(b, s->inner_diameter) : b->zero;
        ring(b, d, inner, &out);
        break;
    }
    case MT_SECTION_GENERAL:
        out.area = mt_build_num(b, s->area);
        out.i3 = mt_build_num(b, s->second_moment);
        out.i2 = mt_build_num_or(b, s->second_moment_other, out.i3);
        out.torsion = mt_build_num(b, s->torsion_constant);
        break;
    }
    return out;
}

static void link_frame(mt_builder *b, const mt_link *link, link_geometry *g)
{
    mt_node along[3];
    mt_build_position(b, &link->from, g->from);
    mt_build_position(b, &link->to, g->to);
    g->span = build_length(b, g->from, g->to);
    for (int i = 0; i < 3; i++) {
        along[i] = mt_program_sub(&b->sys->program, g->to[i], g->from[i]);
    }
    g->triad[0] = mt_build_vec(b, MT_VEC_UNIT, along,
                               mt_build_name(b, "direction of link \"%s\"", link->name.s));
    if (b->sys->dimension == 3 && link->has_hinge_axis) {
        mt_node hinge[3];
        mt_build_coordinates(b, link->hinge_axis, hinge);
        const int axis = mt_build_vec(
            b, MT_VEC_UNIT, hinge, mt_build_name(b, "hinge axis of link \"%s\"", link->name.s));
        g->triad[1] = mt_build_cross(b, MT_VEC_CROSS, axis, g->triad[0]);
        g->triad[2] = axis; /* perpendicular to e1: checked when the system is settled */
        return;
    }
    g->triad[1] = mt_build_perp(b, g->triad[0], 1);
    g->triad[2] = mt_build_perp(b, g->triad[0], 2);
}

/* Density x quantity of the section x span. */
static mt_node by_density(mt_builder *b, const mt_link *link, const link_geometry *g,
                          mt_node quantity)
{
    mt_program *const p = &b->sys->program;
    return mt_program_mul(p, mt_program_mul(p, mt_build_num(b, link->density), quantity),
                          g->span);
}

/* Mass of the whole link: given, or by its density. */
static mt_node link_mass(mt_builder *b, const mt_link *link, const link_geometry *g,
                         const section_nodes *s)
{
    if (link->mass != MT_ABSENT) {
        return mt_build_num(b, link->mass);
    }
    if (link->density != MT_ABSENT && s->area != MT_NO_NODE) {
        return by_density(b, link, g, s->area);
    }
    return b->zero;
}

/* Moment of inertia of the whole beam's sections: mass x second moment / area. */
static mt_node link_rotary(mt_builder *b, const mt_link *link, const link_geometry *g,
                           const section_nodes *s, mt_node mass, mt_node second_moment)
{
    mt_program *const p = &b->sys->program;
    if (link->mass != MT_ABSENT || link->density == MT_ABSENT) {
        return mt_program_mul(p, mass, mt_program_div(p, second_moment, s->area));
    }
    return by_density(b, link, g, second_moment);
}

static mt_inertia_def inertia_default(mt_inertia_kind kind, int body_a, int body_b,
                                      mt_node coefficient, int item)
{
    const mt_inertia_def def = {.kind = kind,
                                .coefficient = coefficient,
                                .body = {body_a, body_b},
                                .point = {-1, -1},
                                .dir = {-1, -1, -1},
                                .shape = {MT_NO_NODE, MT_NO_NODE},
                                .item = item};
    return def;
}

static void element_inertias(mt_builder *b, const mt_link *link, const link_geometry *g, int i,
                             int body, const mt_node ml[2])
{
    mt_program *const p = &b->sys->program;
    const mt_node slender = times(b, 1.0 / 12.0, mt_program_mul(p, ml[0], power(b, ml[1], 2)));
    const mt_node about_hinge =
        listed(b, link->element_inertia, link->n_element_inertia, i, slender);
    const int item = b->sys->n_items - 1;
    mt_inertia_def def = inertia_default(MT_INERTIA_TRANSLATION, body, body, ml[0], item);
    build_inertia(b, &def);
    build_gravity_at(b, body, -1, ml[0]);
    def.kind = MT_INERTIA_ROTATION;
    for (int k = b->sys->dimension == 2 ? 2 : 0; k < 3; k++) {
        def.dir[0] = g->triad[k];
        def.dir[1] = g->triad[k];
        def.coefficient = about_hinge;
        if (k == 0) {
            const mt_node r = mt_build_num_or(b, link->radius_of_gyration, b->zero);
            def.coefficient = mt_program_mul(p, ml[0], power(b, r, 2));
        }
        build_inertia(b, &def);
    }
}

static void build_hinge(mt_builder *b, const mt_link *link, const link_geometry *g, int i,
                        const mt_node at[3], mt_node stiffness)
{
    mt_system *const sys = b->sys;
    if (mt_arena_failed(&sys->mem)) {
        return; /* the bodies beside it may be missing */
    }
    const int second = sys->n_bodies - 1;
    const int body[2] = {second - 1, second};
    const int arm[2] = {mt_build_arm(b, body[0], at, link->name.s),
                        mt_build_arm(b, body[1], at, link->name.s)};
    mt_system_joint *const joints =
        mt_arena_grow(&sys->mem, sys->joints, sys->n_joints, &sys->cap_joints, sizeof *joints);
    sys->joints = joints == NULL ? sys->joints : joints; /* what has grown has moved */
    mt_spring_def *const springs = mt_arena_grow(&sys->mem, sys->springs, sys->n_springs,
                                                 &sys->cap_springs, sizeof *springs);
    if (joints == NULL || springs == NULL) {
        return;
    }
    sys->springs = springs;
    b->hinge_at[link - b->model->links] = sys->n_joints - (i - 1);
    mt_system_joint *const joint = &sys->joints[sys->n_joints++];
    *joint = (mt_system_joint){.name = mt_build_name(b, "%s.h%d", link->name.s, i),
                               .type = MT_JOINT_REVOLUTE,
                               .first = sys->n_constraints,
                               .angle = true,
                               .body = {body[0], body[1]},
                               .model_joint = MT_ABSENT,
                               .link = (int)(link - b->model->links),
                               .hinge = i - 1};
    const int axis[2] = {sys->dimension == 2 ? b->axis_vec[2] : g->triad[2], -1};
    build_joint_equations(b, MT_JOINT_REVOLUTE, body, arm, axis, MT_NO_NODE);
    joint->count = sys->n_constraints - joint->first;
    joint->coordinate = mt_build_angle(b, body[0], body[1], axis[0]);
    sys->springs[sys->n_springs++] =
        (mt_spring_def){.name = mt_build_name(b, "%s.k%d", link->name.s, i),
                        .measure = {joint->coordinate, joint->coordinate},
                        .stiffness = stiffness,
                        .free = MT_NO_NODE,
                        .preload = MT_NO_NODE,
                        .loss = build_loss(b, link->loss_factor),
                        .item = sys->n_items - 1};
}

static void build_lumped(mt_builder *b, const mt_link *link, const link_geometry *g,
                         const section_nodes *s)
{
    mt_program *const p = &b->sys->program;
    const mt_node count = mt_program_const(p, (double)link->elements);
    const mt_node uniform_mass = mt_program_div(p, link_mass(b, link, g, s), count);
    const mt_node uniform_length = mt_program_div(p, g->span, count);
    mt_node along = b->zero;
    mt_node previous = MT_NO_NODE; /* length of the element before */
    mt_node total = b->zero;
    const int item = build_item(b, link->name.s, b->zero);
    for (int i = 0; i < link->elements; i++) {
        const mt_node length =
            listed(b, link->element_length, link->n_element_length, i, uniform_length);
        const mt_node mass =
            listed(b, link->element_mass, link->n_element_mass, i, uniform_mass);
        mt_node hinge[3];
        mt_node centre[3];
        point_along(b, g, along, hinge);
        point_along(b, g, mt_program_add(p, along, times(b, 0.5, length)), centre);
        const int body =
            build_body(b, mt_build_name(b, "%s.%d", link->name.s, i + 1), centre, false);
        element_inertias(b, link, g, i, body, (const mt_node[2]){mass, length});
        if (i > 0) {
            mt_node stiffness = b->zero;
            if (link->n_stiffness > 0) {
                stiffness = listed(b, link->stiffness, link->n_stiffness, i - 1, MT_NO_NODE);
            } else if (link->youngs_modulus != MT_ABSENT && s->i3 != MT_NO_NODE) {
                const mt_node ei =
                    mt_program_mul(p, mt_build_num(b, link->youngs_modulus), s->i3);
                stiffness =
                    mt_program_div(p, ei, times(b, 0.5, mt_program_add(p, previous, length)));
            }
            build_hinge(b, link, g, i, hinge, stiffness);
        }
        total = mt_program_add(p, total, mass);
        along = mt_program_add(p, along, length);
        previous = length;
    }
    b->sys->items[item].mass = total;
}

static void beam_spring(mt_builder *b, const mt_link *link, int element,
                        const mt_measure_def *def, mt_node stiffness)
{
    mt_system *const sys = b->sys;
    mt_spring_def *const springs = mt_arena_grow(&sys->mem, sys->springs, sys->n_springs,
                                                 &sys->cap_springs, sizeof *springs);
    if (springs == NULL) {
        return;
    }
    sys->springs = springs;
    const int m = mt_build_measure(b, def);
    sys->springs[sys->n_springs++] =
        (mt_spring_def){.name = mt_build_name(b, "%s.e%d", link->name.s, element),
                        .measure = {m, m},
                        .stiffness = stiffness,
                        .free = MT_NO_NODE,
                        .preload = MT_NO_NODE,
                        .loss = build_loss(b, link->loss_factor),
                        .item = sys->n_items - 1};
}

/* What all elements of a beam have in common. [2]: bending about e2, e3. */
typedef struct beam_nodes {
    mt_node length;
    mt_node mass;
    /* moments of inertia: about the axis, of the sections' rotation in bending */
    mt_node twist;
    mt_node rotary[2];
    mt_node ei[2];
    mt_node gj;
    mt_node shape[2]; /* 1/(1 + Phi); MT_NO_NODE without shear */
} beam_nodes;

static mt_node shear_modulus(mt_builder *b, const mt_link *link)
{
    mt_program *const p = &b->sys->program;
    if (link->shear.poissons_ratio == MT_ABSENT) {
        return mt_build_num_or(b, link->shear_modulus, b->zero);
    }
    const mt_node nu = mt_build_num(b, link->shear.poissons_ratio);
    return mt_program_div(p, mt_build_num(b, link->youngs_modulus),
                          times(b, 2.0, mt_program_add(p, b->one, nu)));
}

/* 1/(1 + Phi) = k A G l^2/(k A G l^2 + 12 E I), over E where Poisson's ratio is known: then it
 * depends on no modulus. */
static mt_node shear_shape(mt_builder *b, const mt_link *link, const section_nodes *s,
                           mt_node second_moment, mt_num coefficient, mt_node length)
{
    mt_program *const p = &b->sys->program;
    mt_node bent = times(b, 12.0, second_moment);
    mt_node area = mt_program_mul(p, mt_build_num(b, coefficient), s->area);
    if (link->shear.poissons_ratio == MT_ABSENT) {
        bent = mt_program_mul(p, bent, mt_build_num(b, link->youngs_modulus));
        area = mt_program_mul(p, area, mt_build_num(b, link->shear_modulus));
    } else {
        const mt_node nu = mt_build_num(b, link->shear.poissons_ratio);
        bent = mt_program_mul(p, bent, times(b, 2.0, mt_program_add(p, b->one, nu)));
    }
    const mt_node sheared = mt_program_mul(p, area, power(b, length, 2));
    return mt_program_div(p, sheared, mt_program_add(p, sheared, bent));
}

static beam_nodes beam_of(mt_builder *b, const mt_link *link, const link_geometry *g,
                          const section_nodes *s, mt_node total)
{
    mt_program *const p = &b->sys->program;
    const bool space = b->sys->dimension == 3;
    const mt_node count = mt_program_const(p, (double)link->elements);
    const mt_node young = mt_build_num(b, link->youngs_modulus);
    const mt_node second[2] = {s->i2, s->i3};
    const mt_num other = link->shear.coefficient_other;
    const mt_num coefficient[2] = {other == MT_ABSENT ? link->shear.coefficient : other,
                                   link->shear.coefficient};
    beam_nodes n = {.length = mt_program_div(p, g->span, count),
                    .mass = mt_program_div(p, total, count),
                    .twist = b->zero,
                    .gj = b->zero};
    for (int k = 0; k < 2; k++) {
        const bool there = space || k == 1;
        n.ei[k] = there ? mt_program_mul(p, young, second[k]) : b->zero;
        n.rotary[k] = b->zero;
        n.shape[k] = MT_NO_NODE;
        if (there && link->shear.given) {
            n.shape[k] = shear_shape(b, link, s, second[k], coefficient[k], n.length);
        }
        if (there && link->rotary_inertia) {
            n.rotary[k] =
                mt_program_div(p, link_rotary(b, link, g, s, total, second[k]), count);
        }
    }
    if (space) {
        const mt_node polar = mt_program_add(p, s->i2, s->i3);
        n.twist = mt_program_div(p, link_rotary(b, link, g, s, total, polar), count);
        n.gj = mt_program_mul(p, shear_modulus(b, link),
                              s->torsion == MT_NO_NODE ? b->zero : s->torsion);
    }
    return n;
}

/* Springs of the six strains. */
static void beam_springs(mt_builder *b, const mt_link *link, const link_geometry *g,
                         const section_nodes *s, const int element[3], const beam_nodes *n)
{
    mt_program *const p = &b->sys->program;
    const mt_node young = mt_build_num(b, link->youngs_modulus);
    mt_measure_def def = mt_measure_def_default(MT_MEASURE_BEAM, element[1], element[2]);
    for (int i = 0; i < 3; i++) {
        def.dir[i] = g->triad[i];
    }
    def.beam[MT_BEAM_LENGTH] = n->length;
    def.beam[MT_BEAM_SHAPE_2] = n->shape[0];
    def.beam[MT_BEAM_SHAPE_3] = n->shape[1];
    if (b->sys->dimension == 3) {
        def.beam[MT_BEAM_POLAR] = mt_program_div(p, mt_program_add(p, s->i2, s->i3), s->area);
    }
    for (int k = b->sys->dimension == 3 ? 0 : 1; k < 2; k++) {
        mt_node sway = times(b, 3.0, n->ei[k]);
        if (n->shape[k] != MT_NO_NODE) {
            sway = mt_program_mul(p, sway, n->shape[k]);
        }
        def.component = MT_BEAM_BEND_2 + k;
        beam_spring(b, link, element[0], &def, mt_program_div(p, n->ei[k], n->length));
        def.component = MT_BEAM_SWAY_2 + k;
        beam_spring(b, link, element[0], &def, mt_program_div(p, sway, n->length));
    }
    def.component = MT_BEAM_STRETCH;
    beam_spring(b, link, element[0], &def,
                mt_program_div(p, mt_program_mul(p, young, s->area), n->length));
    if (b->sys->dimension == 3) {
        def.component = MT_BEAM_TWIST;
        beam_spring(b, link, element[0], &def, mt_program_div(p, n->gj, n->length));
    }
}

static void beam_gravity(mt_builder *b, const link_geometry *g, const int element[3],
                         mt_node half, mt_node length)
{
    /* the consistent load of the cubic element is half its weight at a distance l/6 inwards of
     * each node */
    for (int end = 0; end < 2; end++) {
        mt_node arm[3];
        const mt_node offset = mt_program_div(
            &b->sys->program, times(b, end == 0 ? 1.0 / 6.0 : -1.0 / 6.0, length), g->span);
        for (int i = 0; i < 3; i++) {
            const mt_node d = mt_program_sub(&b->sys->program, g->to[i], g->from[i]);
            arm[i] = mt_program_mul(&b->sys->program, offset, d);
        }
        build_gravity_at(b, element[1 + end], mt_build_vec(b, MT_VEC_NODES, arm, "beam load"),
                         half);
    }
}

static void build_beam_element(mt_builder *b, const mt_link *link, const link_geometry *g,
                               const section_nodes *s, const int element[3],
                               const beam_nodes *n)
{
    beam_springs(b, link, g, s, element, n);
    mt_inertia_def def =
        inertia_default(MT_INERTIA_BEAM, element[1], element[2], n->mass, b->sys->n_items - 1);
    for (int i = 0; i < 3; i++) {
        def.dir[i] = g->triad[i];
    }
    def.shape[0] = n->shape[0];
    def.shape[1] = n->shape[1];
    build_inertia(b, &def);
    def.kind = MT_INERTIA_BEAM_TWIST;
    def.coefficient = n->twist;
    build_inertia(b, &def);
    def.kind = MT_INERTIA_BEAM_ROTARY;
    for (def.bending = 0; def.bending < 2; def.bending++) {
        def.coefficient = n->rotary[def.bending];
        build_inertia(b, &def);
    }
    beam_gravity(b, g, element, times(b, 0.5, n->mass), n->length);
}

static mt_status build_beam(mt_builder *b, const mt_link *link, const link_geometry *g,
                            const section_nodes *s)
{
    mt_program *const p = &b->sys->program;
    if (link->youngs_modulus == MT_ABSENT || s->area == MT_NO_NODE || s->i3 == MT_NO_NODE) {
        return mt_fail(b->err, MT_E_INPUT,
                       "link \"%s\": a beam needs youngs_modulus_pa and a section with area "
                       "and second moment",
                       link->name.s);
    }
    const mt_node total = link_mass(b, link, g, s);
    const beam_nodes n = beam_of(b, link, g, s, total);
    (void)build_item(b, link->name.s, total);
    for (int i = 0; i <= link->elements; i++) {
        mt_node at[3];
        const mt_node s_i =
            mt_program_mul(p, mt_program_const(p, (double)i / (double)link->elements), g->span);
        point_along(b, g, s_i, at);
        const int body =
            build_body(b, mt_build_name(b, "%s.node%d", link->name.s, i), at, false);
        if (i > 0) {
            build_beam_element(b, link, g, s, (const int[3]){i, body - 1, body}, &n);
        }
    }
    return MT_OK;
}

mt_status mt_build_links(mt_builder *b)
{
    for (int i = 0; i < b->model->n_links; i++) {
        const mt_link *const link = &b->model->links[i];
        link_geometry g;
        b->link_first[i] = -1;
        if (!mt_model_present(&link->in, b->sys->configuration)) {
            continue;
        }
        b->link_first[i] = b->sys->n_bodies;
        link_frame(b, link, &g);
        const section_nodes s = section_of(b, &link->section);
        if (link->kind == MT_LINK_BEAM) {
            MT_TRY(build_beam(b, link, &g, &s));
        } else {
            build_lumped(b, link, &g, &s);
        }
    }
    return MT_OK;
}
