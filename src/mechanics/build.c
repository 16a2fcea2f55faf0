/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared pieces of the builder: numbers, vectors, bodies, measures. */
#include "mechanics/build.h"

#include <stdarg.h>
#include <string.h>

#include "base/format.h"

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
