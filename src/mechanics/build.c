/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers, vectors, points, measures, equations and loads as nodes of one program. */
#include "mechanics/build.h"

#include <stdarg.h>

#include "base/format.h"
#include "model/model.h"

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
    mt_vec_def *const grown = MT_BUILD_GROW(b, vecs);
    if (grown == NULL) {
        return 0;
    }
    sys->vecs = grown;
    const int known = mt_sorted_put(&b->vec_order, &sys->mem, compare_vecs, b, def);
    if (known != MT_SORTED_NEW) {
        return known >= 0 ? known : 0;
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

int mt_build_cross(mt_builder *b, mt_vec_kind kind, int first, int second)
{
    const mt_vec_def def = {.kind = kind,
                            .node = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE},
                            .axis = first,
                            .helper = second,
                            .what = b->sys->vecs != NULL ? b->sys->vecs[first].what : NULL};
    return add_vec(b, &def);
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
    mt_measure_def *const grown = MT_BUILD_GROW(b, measures);
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
    mt_constraint_def *const grown = MT_BUILD_GROW(b, constraints);
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

void mt_build_load(mt_builder *b, const mt_load_def *def)
{
    mt_system *const sys = b->sys;
    mt_load_def *const grown = MT_BUILD_GROW(b, loads);
    if (grown == NULL) {
        return;
    }
    sys->loads = grown;
    sys->loads[sys->n_loads++] = *def;
    sys->loaded = true;
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
