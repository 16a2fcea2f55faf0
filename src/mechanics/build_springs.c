/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springs, dampers and bars as energies of measures. */
#include "mechanics/build.h"

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
 * cylindrical one what its first equation measures across the axis (on_line of build_joints.c),
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
        ends e;
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
        ends e;
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

void mt_build_rod(mt_builder *b, const int body[2], const int arm[2], mt_node mass, int item)
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
    ends e;
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
    mt_build_rod(b, e.body, e.arm, mass, item);
    return MT_OK;
}

/* Bushing between the two points, in global axes of the drawn position carried by bodies[0]:
 * displacement (3) and rotation vector (3). */
static mt_status build_bushing(mt_builder *b, const mt_spring *spring)
{
    ends e;
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
