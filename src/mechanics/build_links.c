/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Links. Lumped: n rigid elements of length l_i, hinged, with a torsional spring in each hinge
 * (paper, Fig. 4); default stiffness EI over the distance of the two element centres (EI/L_e
 * for equal elements).
 *
 * Beam element: the springs of its six generalised strains (measure.c), EA/l, GJ/l, EI/l
 * and 3 EI/(l (1 + Phi)); about the straight element that is the Euler-Bernoulli or Timoshenko
 * stiffness exactly, and its springs' forces make the consistent geometric stiffness.
 */
#include "mechanics/build.h"

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
    g->span = mt_build_length(b, g->from, g->to);
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
        g->triad[1] = mt_build_cross(b, axis, g->triad[0]);
        g->triad[2] = axis; /* perpendicular to e1: checked when the system is settled */
        return;
    }
    g->triad[1] = mt_build_perp(b, g->triad[0], 1);
    g->triad[2] = mt_build_perp(b, g->triad[0], 2);
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
    mt_build_inertia(b, &def);
    mt_build_gravity_at(b, body, -1, ml[0]);
    def.kind = MT_INERTIA_ROTATION;
    for (int k = b->sys->dimension == 2 ? 2 : 0; k < 3; k++) {
        def.dir[0] = g->triad[k];
        def.dir[1] = g->triad[k];
        def.coefficient = about_hinge;
        if (k == 0) {
            const mt_node r = mt_build_num_or(b, link->radius_of_gyration, b->zero);
            def.coefficient = mt_program_mul(p, ml[0], power(b, r, 2));
        }
        mt_build_inertia(b, &def);
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
    mt_build_joint_equations(b, MT_JOINT_REVOLUTE, body, arm, axis, MT_NO_NODE);
    joint->count = sys->n_constraints - joint->first;
    joint->coordinate = mt_build_angle(b, body[0], body[1], axis[0]);
    sys->springs[sys->n_springs++] =
        (mt_spring_def){.name = mt_build_name(b, "%s.k%d", link->name.s, i),
                        .measure = {joint->coordinate, joint->coordinate},
                        .stiffness = stiffness,
                        .free = MT_NO_NODE,
                        .preload = MT_NO_NODE,
                        .loss = mt_build_loss(b, link->loss_factor),
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
    const int item = mt_build_item(b, link->name.s, b->zero);
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
            mt_build_body(b, mt_build_name(b, "%s.%d", link->name.s, i + 1), centre, false);
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
                        .loss = mt_build_loss(b, link->loss_factor),
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
        mt_build_gravity_at(b, element[1 + end],
                            mt_build_vec(b, MT_VEC_NODES, arm, "beam load"), half);
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
    mt_build_inertia(b, &def);
    def.kind = MT_INERTIA_BEAM_TWIST;
    def.coefficient = n->twist;
    mt_build_inertia(b, &def);
    def.kind = MT_INERTIA_BEAM_ROTARY;
    for (def.bending = 0; def.bending < 2; def.bending++) {
        def.coefficient = n->rotary[def.bending];
        mt_build_inertia(b, &def);
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
    (void)mt_build_item(b, link->name.s, total);
    for (int i = 0; i <= link->elements; i++) {
        mt_node at[3];
        const mt_node s_i =
            mt_program_mul(p, mt_program_const(p, (double)i / (double)link->elements), g->span);
        point_along(b, g, s_i, at);
        const int body =
            mt_build_body(b, mt_build_name(b, "%s.node%d", link->name.s, i), at, false);
        if (i > 0) {
            build_beam_element(b, link, g, s, (const int[3]){i, body - 1, body}, &n);
        }
    }
    return MT_OK;
}

void mt_build_link_node(mt_builder *b, int link, int node, mt_node out[3])
{
    mt_program *const p = &b->sys->program;
    const mt_link *const l = &b->model->links[link];
    link_geometry g;
    mt_build_position(b, &l->from, g.from);
    mt_build_position(b, &l->to, g.to);
    g.span = mt_build_length(b, g.from, g.to);
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
