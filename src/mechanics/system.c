/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A configuration flattened to a system: sensors, drive, loads, damping, and the order of
 * its states. */
#include "mechanics/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "expr/op.h"
#include "mechanics/build.h"
#include "mechanics/data.h"
#include "model/values.h"

static bool system_beams_shape(const mt_system *sys);

/* Sensors: which freedoms each channel reads. The element that a fraction of a link falls into
 * is chosen once, at the original design. */

static const char *const CHANNEL_NAMES[6] = {"x", "y", "z", "rx", "ry", "rz"};

static void add_channels(mt_builder *b, const mt_sensor *sensor, mt_channel_def def, bool beam)
{
    mt_system *const sys = b->sys;
    for (int k = 0; k < 6; k++) {
        if ((sensor->directions & (1U << k)) == 0U) {
            continue;
        }
        mt_channel_def *const grown = mt_arena_grow(&sys->mem, sys->channels, sys->n_channels,
                                                    &sys->cap_channels, sizeof *grown);
        if (grown == NULL) {
            return;
        }
        sys->channels = grown;
        const char *const direction = sys->dimension == 2 && k == 5 ? "r" : CHANNEL_NAMES[k];
        def.name = mt_build_name(b, "%s.%s", sensor->name.s, direction);
        def.axis = k % 3;
        def.kind = k < 3 ? (beam ? MT_CHANNEL_BEAM_POINT : MT_CHANNEL_POINT)
                         : (beam ? MT_CHANNEL_BEAM_ROTATION : MT_CHANNEL_ROTATION);
        sys->channels[sys->n_channels++] = def;
    }
}

/* Values of nodes at the original design, of those that were asked for so far. */
typedef struct known {
    const double *at;
    double *value;
    int count;
    int capacity;
    mt_arena mem;
} known;

/* ... and of all that were made since; NULL: no memory. */
static const double *values_so_far(const mt_program *p, known *k)
{
    for (; k->count < p->count; k->count++) {
        double *const v = mt_arena_grow(&k->mem, k->value, k->count, &k->capacity, sizeof *v);
        if (v == NULL) {
            return NULL;
        }
        k->value = v;
        v[k->count] = mt_program_node_value(&p->nodes[k->count], k->at, v);
    }
    return k->value;
}

/* Point of the link at `fraction`: from + fraction (to - from). */
static void link_point(mt_builder *b, const mt_link *link, mt_node fraction, mt_node out[3])
{
    mt_program *const p = &b->sys->program;
    mt_node from[3];
    mt_node to[3];
    mt_build_position(b, &link->from, from);
    mt_build_position(b, &link->to, to);
    for (int i = 0; i < 3; i++) {
        out[i] = mt_program_add(p, from[i],
                                mt_program_mul(p, fraction, mt_program_sub(p, to[i], from[i])));
    }
}

/* Rigid element whose centre is the nearest to the point among those that contain it: the
 * nearest centre measured in half lengths. */
static int element_at(mt_builder *b, int first, int n, const mt_node at[3], const double *v)
{
    int best = 0;
    double least = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        const mt_vec_def *const c = &b->sys->vecs[b->sys->bodies[first + i].centre];
        double d2 = 0.0;
        for (int k = 0; k < 3; k++) {
            const double d = v[c->node[k]] - v[at[k]];
            d2 += d * d;
        }
        if (d2 < least) {
            least = d2;
            best = i;
        }
    }
    return first + best;
}

static mt_status sensor_on_link(mt_builder *b, const mt_sensor *sensor, known *original)
{
    mt_program *const p = &b->sys->program;
    const mt_link *const link = &b->model->links[sensor->on];
    const int first = b->link_first[sensor->on];
    const mt_node fraction = mt_build_num_or(b, sensor->fraction, b->zero);
    mt_node at[3];
    link_point(b, link, fraction, at);
    MT_TRY(mt_arena_check(&b->sys->mem, b->err));
    const double *const v = values_so_far(p, original);
    MT_TRY(mt_arena_check(&original->mem, b->err));
    const double f = v[fraction];
    const bool inside = f >= 0.0 && f <= 1.0;
    const int rigid =
        link->kind == MT_LINK_LUMPED ? element_at(b, first, link->elements, at, v) : -1;
    if (!inside) {
        return mt_fail(b->err, MT_E_INPUT, "sensor \"%s\": fraction %g is not between 0 and 1",
                       sensor->name.s, f);
    }
    mt_channel_def def = {.body = {rigid, MT_GROUND},
                          .point = -1,
                          .dir = {-1, -1, -1},
                          .shape = {MT_NO_NODE, MT_NO_NODE},
                          .fraction = MT_NO_NODE};
    if (rigid >= 0) {
        def.point = mt_build_arm(b, rigid, at, sensor->name.s);
        add_channels(b, sensor, def, false);
        return MT_OK;
    }
    const double along = f * (double)link->elements;
    int element = (int)along;
    element = element >= link->elements ? link->elements - 1 : element;
    def.body[0] = first + element;
    def.body[1] = first + element + 1;
    const mt_node scaled =
        mt_program_mul(p, fraction, mt_program_const(p, (double)link->elements));
    def.fraction = mt_program_sub(p, scaled, mt_program_const(p, (double)element));
    for (int i = 0; i < b->sys->n_measures && def.dir[0] < 0; i++) {
        const mt_measure_def *const m = &b->sys->measures[i];
        if (m->kind == MT_MEASURE_BEAM && m->body[0] == def.body[0] &&
            m->body[1] == def.body[1]) {
            for (int k = 0; k < 3; k++) {
                def.dir[k] = m->dir[k];
            }
            def.shape[0] = m->beam[MT_BEAM_SHAPE_2];
            def.shape[1] = m->beam[MT_BEAM_SHAPE_3];
        }
    }
    add_channels(b, sensor, def, true);
    return MT_OK;
}

static void sensor_on_body(mt_builder *b, const mt_sensor *sensor, int body)
{
    mt_channel_def def = {.body = {body, MT_GROUND},
                          .point = -1,
                          .dir = {-1, -1, -1},
                          .shape = {MT_NO_NODE, MT_NO_NODE},
                          .fraction = MT_NO_NODE};
    if (sensor->at.given) {
        mt_node at[3];
        mt_build_position(b, &sensor->at, at);
        def.point = mt_build_arm(b, body, at, sensor->name.s);
    }
    add_channels(b, sensor, def, false);
}

static mt_status build_sensors(mt_builder *b, known *original)
{
    for (int i = 0; i < b->model->n_sensors; i++) {
        const mt_sensor *const s = &b->model->sensors[i];
        if (s->on_kind == MT_ATTACH_BODY) {
            if (b->body_of[s->on] >= 0) {
                sensor_on_body(b, s, b->body_of[s->on]);
            }
            continue;
        }
        if (b->link_first[s->on] < 0) {
            continue;
        }
        if (s->on_kind == MT_ATTACH_LINK_ELEMENT) {
            sensor_on_body(b, s, b->link_first[s->on] + s->element);
            continue;
        }
        MT_TRY(sensor_on_link(b, s, original));
    }
    return MT_OK;
}

static mt_status add_sensors(mt_builder *b, const double *original)
{
    known k = {.at = original};
    MT_TRY(mt_arena_init(&k.mem, 0, b->err));
    const mt_status rc = build_sensors(b, &k);
    mt_arena_free(&k.mem);
    return rc;
}

/* The driven joints: those of the configuration, and ones that the caller names, whose
 * positions are then inputs. */

/* Who drives what, in names: `who` begins the message where something is wrong. */
typedef struct request {
    const char *who;
    const char *joint;
    mt_node position;
    const char *spring; /* NULL: lock */
    int input;          /* that the position is; -1: none */
} request;

static mt_status no_such_joint(mt_builder *b, const request *r, int found)
{
    const mt_system *const sys = b->sys;
    const char *const configuration = b->model->configurations[sys->configuration].name.s;
    if (found >= 0) {
        return mt_fail(b->err, MT_E_INPUT, "%s: joint \"%s\" (%s) has no coordinate to drive",
                       r->who, r->joint, mt_joint_type_name(sys->joints[found].type));
    }
    const char **const names =
        mt_arena_alloc(&b->sys->mem, (size_t)sys->n_joints, sizeof *names);
    MT_TRY(mt_arena_check(&b->sys->mem, b->err));
    int n = 0;
    for (int i = 0; i < sys->n_joints; i++) {
        if (sys->joints[i].coordinate >= 0) {
            names[n++] = sys->joints[i].name;
        }
    }
    const char *const nearest = mt_text_nearest(r->joint, names, n);
    return mt_fail(b->err, MT_E_INPUT,
                   "%s: there is no joint \"%s\" in configuration \"%s\"%s%s%s", r->who,
                   r->joint, configuration, nearest == NULL ? "" : "; did you mean \"",
                   nearest == NULL ? "" : nearest, nearest == NULL ? "" : "\"?");
}

static mt_status find_spring(mt_builder *b, const request *r, int *spring)
{
    mt_system *const sys = b->sys;
    *spring = -1;
    for (int i = 0; i < sys->n_springs && *spring < 0; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && s->measure[0] == s->measure[1] && strcmp(s->name, r->spring) == 0) {
            *spring = i;
        }
    }
    if (*spring < 0) {
        return mt_fail(b->err, MT_E_INPUT,
                       "%s: there is no spring \"%s\" to hold it in configuration \"%s\"",
                       r->who, r->spring, b->model->configurations[sys->configuration].name.s);
    }
    return mt_system_trim_of(sys, *spring) < 0
               ? MT_OK
               : mt_fail(b->err, MT_E_INPUT, "%s: spring \"%s\" already holds another joint",
                         r->who, r->spring);
}

static mt_status drive(mt_builder *b, const request *r)
{
    mt_system *const sys = b->sys;
    mt_drive_def def = {.position = r->position, .spring = -1, .input = r->input};
    def.joint = mt_system_find_joint(sys, r->joint);
    if (def.joint < 0 || sys->joints[def.joint].coordinate < 0) {
        return no_such_joint(b, r, def.joint);
    }
    if (mt_system_drive_of(sys, def.joint) >= 0) {
        return mt_fail(b->err, MT_E_INPUT, "%s: joint \"%s\" is driven twice", r->who,
                       r->joint);
    }
    if (sys->n_drives == MT_DRIVES_MOST) {
        return mt_fail(b->err, MT_E_INPUT, "%s: at most %d joints are driven", r->who,
                       (int)MT_DRIVES_MOST);
    }
    if (r->spring != NULL) {
        MT_TRY(find_spring(b, r, &def.spring));
        sys->n_trims++;
    }
    def.constraint = sys->n_constraints;
    mt_build_constraint(b, sys->joints[def.joint].coordinate, MT_NO_NODE, false);
    if (!mt_arena_failed(&sys->mem)) {
        sys->constraints[def.constraint].joint = def.joint;
    }
    sys->driven = true;
    sys->drives[sys->n_drives++] = def;
    return MT_OK;
}

/* The drives of the caller that are locked, or those that springs hold. */
static mt_status drive_for_caller(mt_builder *b, bool trimmed)
{
    mt_system *const sys = b->sys;
    int input = sys->n_inputs;
    for (int i = b->n_drives - 1; i >= 0; i--) {
        input -= b->drive[i].fixed ? 0 : 1;
    }
    for (int i = 0; i < b->n_drives; i++) {
        const mt_system_drive *const own = &b->drive[i];
        const int at = own->fixed ? -1 : input++;
        if ((own->spring != NULL) != trimmed) {
            continue;
        }
        const request r = {
            .who = "drive",
            .joint = own->joint,
            .position = own->fixed ? mt_program_const(&sys->program, own->position)
                                   : mt_program_input(&sys->program, at, MT_NO_ADDR),
            .spring = own->spring,
            .input = at,
        };
        MT_TRY(drive(b, &r));
    }
    return MT_OK;
}

static bool is_drive_of_caller(const mt_builder *b, const char *joint)
{
    for (int i = 0; i < b->n_drives; i++) {
        if (strcmp(b->drive[i].joint, joint) == 0) {
            return true;
        }
    }
    return false;
}

/* True where the configuration's own drives stay, but for those of the caller's joints. */
static bool own_drives_stay(const mt_builder *b)
{
    const mt_configuration *const c = &b->model->configurations[b->sys->configuration];
    bool all = true;
    for (int i = 0; i < b->n_drives; i++) {
        bool own = false;
        for (int k = 0; k < c->n_drives; k++) {
            own = own ||
                  strcmp(b->model->joints[c->drives[k].joint].name.s, b->drive[i].joint) == 0;
        }
        all = all && own;
    }
    return all;
}

static mt_status drive_of_configuration(mt_builder *b, bool trimmed)
{
    const mt_configuration *const c = &b->model->configurations[b->sys->configuration];
    const bool stay = own_drives_stay(b);
    for (int i = 0; i < c->n_drives && stay; i++) {
        const mt_drive *const own = &c->drives[i];
        const char *const joint = b->model->joints[own->joint].name.s;
        if (own->trim != trimmed || is_drive_of_caller(b, joint)) {
            continue;
        }
        const request r = {
            .who = mt_build_name(b, "drive of configuration \"%s\"", c->name.s),
            .joint = joint,
            .position = mt_build_num(b, own->position),
            .spring = trimmed ? b->model->springs[own->trim_spring].name.s : NULL,
            .input = -1,
        };
        MT_TRY(drive(b, &r));
    }
    return MT_OK;
}

static mt_status build_drives(mt_builder *b)
{
    for (int trimmed = 0; trimmed < 2; trimmed++) {
        MT_TRY(drive_for_caller(b, trimmed == 1));
        MT_TRY(drive_of_configuration(b, trimmed == 1));
    }
    return MT_OK;
}

/*
 * Dead loads as potentials: -F . x of a point, -M theta of a plane angle, -F s or -M theta of a
 * joint's coordinate s or theta. Their second derivatives are the geometric stiffness: that of
 * a force at the arm w is (F . w) I - (F w^T + w F^T)/2 on the rotation of its body
 * (measure.c), that of a plane angle is none.
 */

static mt_status absent(mt_builder *b, const mt_load *load)
{
    return mt_fail(b->err, MT_E_INPUT,
                   "load \"%s\" acts on what is not in configuration \"%s\"", load->name.s,
                   b->model->configurations[b->sys->configuration].name.s);
}

/* Point of the load: as given, at the end or node of a link, or at the centre (-1). */
static int point_of(mt_builder *b, const mt_load *load, int body)
{
    mt_node at[3];
    const bool start = load->on.kind == MT_ATTACH_LINK_START;
    if (load->at.given) {
        mt_build_position(b, &load->at, at);
    } else if (start || load->on.kind == MT_ATTACH_LINK_END) {
        const mt_link *const link = &b->model->links[load->on.index];
        mt_build_position(b, start ? &link->from : &link->to, at);
    } else if (load->on.kind == MT_ATTACH_LINK_NODE) {
        mt_build_link_node(b, load->on.index, load->on.element, at);
    } else {
        return -1;
    }
    return mt_build_arm(b, body, at, mt_build_name(b, "point of load \"%s\"", load->name.s));
}

static void build_size(mt_builder *b, const mt_load *load, int measure, mt_node size)
{
    if (size != b->zero) {
        const mt_load_def def = {.name = load->name.s,
                                 .measure = measure,
                                 .body = MT_GROUND,
                                 .point = -1,
                                 .force = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE},
                                 .size = size};
        mt_build_load(b, &def);
    }
}

static mt_status build_on_joint(mt_builder *b, const mt_load *load)
{
    const int measure = mt_build_find_coordinate(b, load->joint, load->joint_link,
                                                 load->joint_hinge, load->has_moment);
    if (measure < 0) {
        return absent(b, load);
    }
    build_size(b, load, measure,
               mt_build_num(b, load->has_moment ? load->moment : load->force[0]));
    return MT_OK;
}

static mt_status build_load(mt_builder *b, const mt_load *load)
{
    if (load->joint_name.s != NULL) {
        return build_on_joint(b, load);
    }
    mt_load_def def = {.name = load->name.s, .measure = -1, .size = MT_NO_NODE};
    if (!mt_build_attach(b, &load->on, &def.body)) {
        return absent(b, load);
    }
    if (load->has_force) {
        bool any = false;
        mt_build_coordinates(b, load->force, def.force);
        for (int i = 0; i < 3; i++) {
            any = any || def.force[i] != b->zero;
        }
        if (any) {
            def.point = point_of(b, load, def.body);
            mt_build_load(b, &def);
        }
    }
    if (load->has_moment) { /* two dimensions */
        build_size(b, load, mt_build_angle(b, MT_GROUND, def.body, b->axis_vec[2]),
                   mt_build_num(b, load->moment));
    }
    return MT_OK;
}

static mt_status build_loads(mt_builder *b)
{
    for (int i = 0; i < b->model->n_loads; i++) {
        const mt_load *const load = &b->model->loads[i];
        if (mt_model_present(&load->in, b->sys->configuration)) {
            MT_TRY(build_load(b, load));
        }
    }
    return MT_OK;
}

/* The numbers of a configuration's damping. */

static void build_damping(mt_builder *b)
{
    mt_system *const sys = b->sys;
    const mt_damping *const d = &b->model->configurations[sys->configuration].damping;
    mt_damping_def *const def = &sys->damping;
    *def = (mt_damping_def){.mass = MT_NO_NODE, .stiffness = MT_NO_NODE, .ratio = MT_NO_NODE};
    if (!d->given) {
        return;
    }
    def->mass = mt_build_num(b, d->mass);
    def->stiffness = mt_build_num(b, d->stiffness);
    def->ratio = mt_build_num(b, d->ratio);
    def->ratios = mt_arena_alloc(&sys->mem, (size_t)d->n_ratios, sizeof *def->ratios);
    def->named = mt_arena_int(&sys->mem, (size_t)d->n_named);
    def->named_ratios =
        mt_arena_alloc(&sys->mem, (size_t)d->n_named, sizeof *def->named_ratios);
    if (mt_arena_failed(&sys->mem)) {
        return;
    }
    def->n_ratios = d->n_ratios;
    for (int i = 0; i < d->n_ratios; i++) {
        def->ratios[i] = mt_build_num(b, d->ratios[i]);
    }
    for (int i = 0; i < d->n_named; i++) {
        const mt_mode_ratio *const m = &d->named[i];
        if (b->model->modes[m->mode].configuration == sys->configuration) {
            def->named[def->n_named] = m->mode;
            def->named_ratios[def->n_named++] = mt_build_num(b, m->ratio);
        }
    }
    def->modal = def->ratio != MT_NO_NODE || def->n_ratios > 0 || def->n_named > 0;
}

/* Inputs that shape and forces depend on. */

/* Add all inputs of what is drawn: vectors, joints, drive. */
static void include_places(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_drives; i++) {
        mt_program_include_inputs(p, sys->drives[i].position, set);
    }
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            mt_program_include_inputs(p, sys->vecs[i].node[k], set);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        mt_program_include_inputs(p, sys->constraints[i].target, set);
        mt_program_include_inputs(p, sys->constraints[i].coefficient[0], set);
        mt_program_include_inputs(p, sys->constraints[i].coefficient[1], set);
    }
}

/* Add all other inputs of the geometry of stiffness and mass: sections of beams. */
static void include_sections(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_measures && system_beams_shape(sys); i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            mt_program_include_inputs(p, sys->measures[i].beam[k], set);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        mt_program_include_inputs(p, sys->inertias[i].shape[0], set);
        mt_program_include_inputs(p, sys->inertias[i].shape[1], set);
    }
}

static void include_sensors(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_channels; i++) {
        mt_program_include_inputs(p, sys->channels[i].shape[0], set);
        mt_program_include_inputs(p, sys->channels[i].shape[1], set);
        mt_program_include_inputs(p, sys->channels[i].fraction, set);
    }
}

/* All numbers of the energy that an equilibrium is a stationary point of. */
static void include_forces(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_springs; i++) {
        mt_program_include_inputs(p, sys->springs[i].stiffness, set);
        mt_program_include_inputs(p, sys->springs[i].free, set);
        mt_program_include_inputs(p, sys->springs[i].preload, set);
    }
    for (int i = 0; i < sys->n_measures; i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            mt_program_include_inputs(p, sys->measures[i].beam[k], set);
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        for (int k = 0; k < 3; k++) {
            mt_program_include_inputs(p, sys->loads[i].force[k], set);
        }
        mt_program_include_inputs(p, sys->loads[i].size, set);
    }
}

/* Fill shape, forces and geometry_fixed of a system whose program is finished.
 * A failure is the arena's. */
static void build_inputs(mt_system *sys)
{
    const size_t words = (size_t)sys->program.words;
    sys->places = mt_arena_alloc(&sys->mem, words, sizeof *sys->places);
    sys->frame = mt_arena_alloc(&sys->mem, words, sizeof *sys->frame);
    sys->shape = mt_arena_alloc(&sys->mem, words, sizeof *sys->shape);
    sys->forces = mt_arena_alloc(&sys->mem, words, sizeof *sys->forces);
    if (mt_arena_failed(&sys->mem)) {
        return;
    }
    include_places(sys, sys->places);
    memcpy(sys->frame, sys->places, words * sizeof *sys->frame);
    include_sections(sys, sys->frame);
    memcpy(sys->shape, sys->frame, words * sizeof *sys->shape);
    include_sensors(sys, sys->shape);
    include_forces(sys, sys->forces);
    sys->geometry_fixed = true;
    for (size_t w = 0; w < words; w++) {
        sys->geometry_fixed = sys->geometry_fixed && sys->shape[w] == 0;
    }
}

/* The order of states and equations. */

/* Bodies and the ways between them: neighbours of body b are other[start[b]] ..
 * other[start[b + 1] - 1]. */
typedef struct graph {
    int n;
    int *start;
    int *other;
    int *turn; /* [n] bodies in the order in which they are met */
    int *met;  /* [n] in which walk; 0: not yet */
} graph;

typedef void visit_pair(void *context, int a, int b);

/* All pairs of bodies (equal ones too) that an energy or an equation couples. */
static void visit_measure(const mt_measure_def *m, visit_pair *visit, void *context)
{
    if (m->body[0] != MT_GROUND && m->body[1] != MT_GROUND) {
        visit(context, m->body[0], m->body[1]);
    }
}

static void visit_couplings(const mt_system *sys, visit_pair *visit, void *context)
{
    for (int i = 0; i < sys->n_springs; i++) {
        visit_measure(&sys->measures[sys->springs[i].measure[0]], visit, context);
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].measure >= 0) {
            visit_measure(&sys->measures[sys->loads[i].measure], visit, context);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        for (int t = 0; t < sys->constraints[i].terms; t++) {
            visit_measure(&sys->measures[sys->constraints[i].measure[t]], visit, context);
        }
    }
}

/* Bodies of an equation, each side of each term; how many. */
static int bodies_of(const mt_system *sys, const mt_constraint_def *c, int body[4])
{
    int n = 0;
    for (int t = 0; t < c->terms; t++) {
        for (int side = 0; side < 2; side++) {
            const int b = sys->measures[c->measure[t]].body[side];
            if (b != MT_GROUND) {
                body[n++] = b;
            }
        }
    }
    return n;
}

static void count_pair(void *context, int a, int b)
{
    graph *const g = context;
    g->start[a + 1]++;
    g->start[b + 1]++;
}

static void note_pair(void *context, int a, int b)
{
    graph *const g = context;
    g->other[g->start[a]++] = b;
    g->other[g->start[b]++] = a;
}

/* An equation of two terms (a gear) couples the bodies of both. */
static void visit_equations(const mt_system *sys, visit_pair *visit, void *context)
{
    for (int i = 0; i < sys->n_constraints; i++) {
        int body[4];
        const int n = bodies_of(sys, &sys->constraints[i], body);
        for (int k = 2; k < n; k++) {
            visit(context, body[0], body[k]);
        }
    }
}

static bool graph_init(graph *g, const mt_system *sys, mt_arena *mem)
{
    const size_t n = (size_t)sys->n_bodies;
    g->n = sys->n_bodies;
    g->start = mt_arena_int(mem, n + 2);
    g->turn = mt_arena_int(mem, n);
    g->met = mt_arena_int(mem, n);
    if (mt_arena_failed(mem)) {
        return false;
    }
    visit_couplings(sys, count_pair, g);
    visit_equations(sys, count_pair, g);
    for (int b = 0; b < g->n; b++) {
        g->start[b + 1] += g->start[b];
    }
    g->other = mt_arena_int(mem, (size_t)g->start[g->n]);
    if (mt_arena_failed(mem)) {
        return false;
    }
    visit_couplings(sys, note_pair, g);
    visit_equations(sys, note_pair, g);
    memmove(g->start + 1, g->start, n * sizeof *g->start);
    g->start[0] = 0;
    return true;
}

/* Bodies within reach of `from`, breadth first, into turn[at..]; returns where they end. */
static int number_connected_bodies(graph *g, int from, int at, int number)
{
    int end = at;
    g->turn[end++] = from;
    g->met[from] = number;
    for (; at < end; at++) {
        const int b = g->turn[at];
        for (int k = g->start[b]; k < g->start[b + 1]; k++) {
            if (g->met[g->other[k]] != number) {
                g->met[g->other[k]] = number;
                g->turn[end++] = g->other[k];
            }
        }
    }
    return end;
}

/* Every part of the mechanism from one of its ends: the last body that a walk comes to, twice.
 * */
static void walk_all(graph *g)
{
    int number = 0;
    int end = 0;
    for (int b = 0; b < g->n; b++) {
        if (g->met[b] == 0) {
            const int at = end;
            end = number_connected_bodies(g, b, at, ++number);
            end = number_connected_bodies(g, g->turn[end - 1], at, ++number);
            end = number_connected_bodies(g, g->turn[end - 1], at, ++number);
        }
    }
}

/* States of the bodies in their turn, each equation as soon as its bodies are there. */
static void give_places(const mt_system *sys, const graph *g, const int *first, const int *next,
                        mt_layout *o)
{
    int place = 0;
    for (int t = 0; t < g->n; t++) {
        const int b = g->turn[t];
        for (int k = 0; k < 6; k++) {
            if (sys->bodies[b].dof[k] >= 0) {
                o->state[sys->bodies[b].dof[k]] = place++;
            }
        }
        for (int i = first[t] - 1; i >= 0; i = next[i] - 1) {
            o->equation[i] = place++;
        }
    }
}

static void touch(mt_envelope *e, int i, int j)
{
    const int low = i < j ? i : j;
    const int high = i < j ? j : i;
    e->first[high] = e->first[high] < low ? e->first[high] : low;
    e->last[low] = e->last[low] > high ? e->last[low] : high;
}

typedef struct pattern {
    const mt_system *sys;
    mt_layout *o;
} pattern;

static void touch_pair(void *context, int a, int b)
{
    const pattern *const p = context;
    for (int k = 0; k < 36; k++) {
        const int i = p->sys->bodies[a].dof[k / 6];
        const int j = p->sys->bodies[b].dof[k % 6];
        if (i >= 0 && j >= 0) {
            touch(&p->o->envelope, p->o->state[i], p->o->state[j]);
        }
    }
}

static void find_envelope(const mt_system *sys, mt_layout *o)
{
    mt_envelope *const e = &o->envelope;
    pattern p = {.sys = sys, .o = o};
    for (int i = 0; i < e->n; i++) {
        e->first[i] = i;
        e->last[i] = i;
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        touch_pair(&p, b, b);
    }
    visit_couplings(sys, touch_pair, &p);
    for (int i = 0; i < sys->n_constraints; i++) {
        int body[4];
        const int n = bodies_of(sys, &sys->constraints[i], body);
        for (int k = 0; k < 6 * n; k++) {
            const int dof = sys->bodies[body[k / 6]].dof[k % 6];
            if (dof >= 0) {
                touch(e, o->equation[i], o->state[dof]);
            }
        }
    }
}

/* Set the positions of rows, and the cost of a factorisation. closed[n]: zeroed. */
static void measure_envelope(mt_layout *o, int *closed)
{
    mt_envelope *const e = &o->envelope;
    int open = 0;
    for (int i = 0; i < e->n; i++) {
        e->row[i] = (ptrdiff_t)e->count - e->first[i];
        e->count += (size_t)(i - e->first[i]) + 1;
        closed[e->last[i]]++;
    }
    for (int i = 0; i < e->n; i++) {
        open++;
        e->front = e->front > open ? e->front : open;
        o->work += (double)closed[i] * open * open;
        open -= closed[i];
    }
}

/* Linear in bodies, joints, springs and loads. In mem; a shortage is the arena's. */
static const mt_layout *layout_new(const mt_system *sys, mt_arena *mem)
{
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    mt_layout *const o = mt_arena_alloc(mem, 1, sizeof *o);
    graph g = {.n = 0};
    if (mt_arena_failed(mem)) {
        return NULL;
    }
    o->state = mt_arena_int(mem, nq);
    o->equation = mt_arena_int(mem, m);
    o->envelope = (mt_envelope){.n = sys->nq + sys->n_constraints,
                                .first = mt_arena_int(mem, nq + m),
                                .last = mt_arena_int(mem, nq + m),
                                .row = mt_arena_alloc(mem, nq + m, sizeof(ptrdiff_t))};
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    int *const turn_of = mt_arena_int(mem, (size_t)sys->n_bodies);
    int *const first = mt_arena_int(mem, (size_t)sys->n_bodies + 1);
    int *const next = mt_arena_int(mem, m);
    int *const closed = mt_arena_int(mem, nq + m);
    if (!graph_init(&g, sys, mem)) {
        return NULL;
    }
    walk_all(&g);
    for (int t = 0; t < g.n; t++) {
        turn_of[g.turn[t]] = t;
    }
    for (int i = sys->n_constraints - 1; i >= 0; i--) {
        int body[4];
        int last = 0;
        for (int k = bodies_of(sys, &sys->constraints[i], body) - 1; k >= 0; k--) {
            last = turn_of[body[k]] > last ? turn_of[body[k]] : last;
        }
        next[i] = first[last];
        first[last] = i + 1;
    }
    give_places(sys, &g, first, next, o);
    find_envelope(sys, o);
    measure_envelope(o, closed);
    mt_arena_rewind(mem, mark);
    return o;
}

/*
 * The model length: what a displacement is compared with, so that it has to scale as the model
 * does. Where bodies have an extent it is theirs. Else (one body held at its centre) it is, of
 * what is there, the first of
 *     the distance between the ends of springs, joints and links,
 *     a radius of gyration sqrt(J / m),
 *     a static displacement F / k of the largest force and the stiffest spring,
 * each taken of the largest there are. Where there is none of them nothing moves by a length,
 * or nothing says how far, and 1 will do.
 */

static double vector_length(const mt_vec_def *def, const double *v)
{
    return hypot(hypot(v[def->node[0]], v[def->node[1]]), v[def->node[2]]);
}

static double value_or_zero(const double *v, mt_node node)
{
    return node == MT_NO_NODE ? 0.0 : v[node];
}

/* Diagonal of the box around all centres. */
static double diagonal(const mt_system *sys, const double *v)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL;
        double high = -HUGE_VAL;
        for (int i = 0; i < sys->n_bodies; i++) {
            const double x = v[sys->vecs[sys->bodies[i].centre].node[k]];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        sum = sys->n_bodies > 0 ? hypot(sum, high - low) : 0.0;
    }
    return sum;
}

/* Longest arm from a centre. */
static double longest_arm(const mt_system *sys, const double *v)
{
    double most = 0.0;
    for (int i = 0; i < sys->n_measures; i++) {
        const mt_measure_def *const m = &sys->measures[i];
        for (int side = 0; side < 2; side++) {
            if (m->point[side] >= 0 && m->body[side] != MT_GROUND) {
                most = fmax(most, vector_length(&sys->vecs[m->point[side]], v));
            }
        }
    }
    return most;
}

/* Coordinate k of an end of a measure in the drawn position. */
static double end_of(const mt_system *sys, const mt_measure_def *m, int side, int k,
                     const double *v)
{
    const double arm = m->point[side] >= 0 ? v[sys->vecs[m->point[side]].node[k]] : 0.0;
    return m->body[side] == MT_GROUND
               ? arm
               : v[sys->vecs[sys->bodies[m->body[side]].centre].node[k]] + arm;
}

static bool is_between_points(const mt_measure_def *m)
{
    return m->kind == MT_MEASURE_PLANE || m->kind == MT_MEASURE_DISTANCE;
}

/* Longest distance between the ends of a measure. */
static double span(const mt_system *sys, const double *v)
{
    double most = 0.0;
    for (int i = 0; i < sys->n_measures; i++) {
        const mt_measure_def *const m = &sys->measures[i];
        double sum = 0.0;
        for (int k = 0; k < 3 && is_between_points(m); k++) {
            sum = hypot(sum, end_of(sys, m, 1, k, v) - end_of(sys, m, 0, k, v));
        }
        most = fmax(most, sum);
    }
    return most;
}

static double gyration(const mt_system *sys, const double *v)
{
    double mass = 0.0;
    double inertia = 0.0;
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_inertia_def *const def = &sys->inertias[i];
        const double size = value_or_zero(v, def->coefficient);
        mass = def->kind == MT_INERTIA_TRANSLATION ? fmax(mass, size) : mass;
        inertia = def->kind == MT_INERTIA_ROTATION ? fmax(inertia, size) : inertia;
    }
    return mass > 0.0 ? sqrt(inertia / mass) : 0.0;
}

static double deflection(const mt_system *sys, const double *v)
{
    double force = 0.0;
    double stiffness = 0.0;
    for (int i = 0; i < sys->n_loads; i++) {
        double sum = 0.0;
        for (int k = 0; k < 3 && sys->loads[i].measure < 0; k++) {
            sum = hypot(sum, value_or_zero(v, sys->loads[i].force[k]));
        }
        force = fmax(force, sum);
    }
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (is_between_points(&sys->measures[s->measure[0]]) && !s->damper) {
            stiffness = fmax(stiffness, fabs(value_or_zero(v, s->stiffness)));
        }
    }
    return stiffness > 0.0 ? force / stiffness : 0.0;
}

/* Model length, the reference length of displacements, from the values v of
 * all nodes; above 0. */
static double system_length(const mt_system *sys, const double *v)
{
    double (*const of[])(const mt_system *, const double *) = {span, gyration, deflection};
    double length = fmax(diagonal(sys, v), longest_arm(sys, v));
    for (size_t i = 0; i < sizeof of / sizeof of[0] && !(length > 0.0); i++) {
        length = of[i](sys, v);
    }
    return length > 0.0 && isfinite(length) ? length : 1.0;
}

/* The system. */

/* Give a list its first entry: where memory ends later, index 0 stands for what could not be
 * made and may be read until the shortage is reported. */
#define RESERVE(sys, name) \
    (sys)->name = mt_arena_grow(&(sys)->mem, NULL, 0, &(sys)->cap_##name, sizeof *(sys)->name)

static mt_status reserve(mt_system *sys, mt_err *err)
{
    RESERVE(sys, vecs);
    RESERVE(sys, measures);
    RESERVE(sys, bodies);
    RESERVE(sys, constraints);
    RESERVE(sys, joints);
    RESERVE(sys, springs);
    RESERVE(sys, inertias);
    RESERVE(sys, loads);
    RESERVE(sys, channels);
    RESERVE(sys, items);
    return mt_arena_check(&sys->mem, err);
}

static mt_status init_builder(mt_builder *b, mt_system *sys, mt_err *err)
{
    const mt_model *const model = sys->model;
    b->sys = sys;
    b->model = model;
    b->err = err;
    b->body_of = mt_arena_int(&sys->mem, (size_t)model->n_bodies + 1);
    b->link_first = mt_arena_int(&sys->mem, (size_t)model->n_links + 1);
    b->joint_at = mt_arena_int(&sys->mem, (size_t)model->n_joints + 1);
    b->hinge_at = mt_arena_int(&sys->mem, (size_t)model->n_links + 1);
    MT_TRY(mt_arena_check(&sys->mem, err));
    memset(b->joint_at, 0xFF, (size_t)model->n_joints * sizeof *b->joint_at);
    memset(b->hinge_at, 0xFF, (size_t)model->n_links * sizeof *b->hinge_at);
    MT_TRY(reserve(sys, err));
    b->zero = mt_program_const(&sys->program, 0.0);
    b->one = mt_program_const(&sys->program, 1.0);
    for (int i = 0; i < 3; i++) {
        mt_node e[3] = {b->zero, b->zero, b->zero};
        e[i] = b->one;
        b->axis_vec[i] = mt_build_vec(b, MT_VEC_UNIT, e, "global axis");
    }
    return MT_OK;
}

/* Global axis least along v; in two dimensions z for a direction in the plane, so that the
 * perpendicular lies in the plane too. */
static int helper_axis(const mt_system *sys, const double v[3])
{
    int best = 2;
    for (int k = 1; k >= 0; k--) {
        const bool planar = sys->dimension == 2 && v[2] == 0.0;
        best = !planar && fabs(v[k]) < fabs(v[best]) ? k : best;
    }
    return best;
}

static double length_of_vec(const mt_vec_def *def, const double *v)
{
    return hypot(hypot(v[def->node[0]], v[def->node[1]]), v[def->node[2]]);
}

/* A point mass is held, and loaded, at its centre. */
static mt_status check_arm(const mt_system *sys, int arm, int body, const double *v,
                           mt_err *err)
{
    const mt_vec_def *const def = &sys->vecs[arm];
    const mt_state_body *const on = &sys->bodies[body];
    const double n = length_of_vec(def, v);
    if (on->dof[5] < 0 && n > 0.0) {
        return mt_fail(
            err, MT_E_INPUT,
            "%s lies %g m from the centre of \"%s\", which has no inertia_kg_m2 and is "
            "therefore a point mass; hold it at its centre or give it an inertia",
            def->what != NULL ? def->what : "a joint or spring", n, on->name);
    }
    return MT_OK;
}

/* Hinge axes drawn further than this (cosine) from a right angle to their link are refused. */
static const double NOT_PERPENDICULAR = 1e-6;
/* Sine of the angle between two vectors that make axes. */
static const double PARALLEL = 1e-9;

/* Walk through the vectors in order, choosing helper axes and refusing directions of length
 * zero. */
static mt_status choose_helpers(mt_system *sys, const double *v, mt_err *err)
{
    mt_data d;
    MT_TRY(mt_data_init(&d, sys, &sys->mem, err));
    d.value = v;
    for (int i = 0; i < sys->n_vecs; i++) {
        mt_vec_def *const def = &sys->vecs[i];
        const char *const what = def->what != NULL ? def->what : "a direction";
        if (def->kind == MT_VEC_PERP1 || def->kind == MT_VEC_PERP2) {
            const double a[3] = {creal(d.vec[def->axis][0]), creal(d.vec[def->axis][1]),
                                 creal(d.vec[def->axis][2])};
            def->helper = helper_axis(sys, a);
        }
        if (def->kind == MT_VEC_CROSS) {
            const double cosine = creal(cx_dot3(d.vec[def->axis], d.vec[def->helper]));
            if (!(fabs(cosine) <= NOT_PERPENDICULAR)) {
                return mt_fail(err, MT_E_INPUT,
                               "%s is not perpendicular to the link (cosine %g)", what, cosine);
            }
        }
        if (def->kind == MT_VEC_ACROSS) {
            mt_cx n[3];
            cx_cross3(d.vec[def->axis], d.vec[def->helper], n);
            if (!(hypot(hypot(creal(n[0]), creal(n[1])), creal(n[2])) > PARALLEL)) {
                return mt_fail(err, MT_E_INPUT, "%s: two of their vectors are parallel", what);
            }
        }
        if (def->kind == MT_VEC_UNIT && !(length_of_vec(def, v) > 0.0)) {
            return mt_fail(err, MT_E_INPUT, "%s has length zero", what);
        }
        mt_data_vec(&d, i);
    }
    return MT_OK;
}

/* Choices that need numbers: helper axes, the model length, and the checks of arms of point
 * masses. */
static mt_status settle_by_numbers(mt_system *sys, const double *at, mt_err *err)
{
    mt_node bad = MT_NO_NODE;
    const mt_arena_mark mark = mt_arena_get_mark(&sys->mem);
    double *const v = mt_arena_f64(&sys->mem, (size_t)sys->program.count, 1);
    MT_TRY(mt_arena_check(&sys->mem, err));
    const mt_status rc = mt_program_eval(&sys->program, at, v, &bad, err);
    if (rc != MT_OK) {
        const mt_addr addr = bad == MT_NO_NODE ? MT_NO_ADDR : sys->program.nodes[bad].addr;
        int line = 0;
        int column = 0;
        return mt_model_locate(sys->model, addr, &line, &column)
                   ? mt_err_in(err, rc, "line %d, column %d", line, column)
                   : rc;
    }
    MT_TRY(choose_helpers(sys, v, err));
    for (int i = 0; i < sys->n_measures; i++) {
        for (int side = 0; side < 2; side++) {
            const mt_measure_def *const m = &sys->measures[i];
            if (m->point[side] < 0 || m->body[side] == MT_GROUND) {
                continue;
            }
            MT_TRY(check_arm(sys, m->point[side], m->body[side], v, err));
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        const mt_load_def *const load = &sys->loads[i];
        if (load->point >= 0) {
            MT_TRY(check_arm(sys, load->point, load->body, v, err));
        }
    }
    sys->length_m = system_length(sys, v);
    mt_arena_rewind(&sys->mem, mark);
    sys->layout = layout_new(sys, &sys->mem);
    return mt_arena_check(&sys->mem, err);
}

static mt_status build_parts(mt_builder *b, const double *at)
{
    MT_TRY(mt_build_bodies(b));
    MT_TRY(mt_build_links(b));
    MT_TRY(mt_arena_check(&b->sys->mem, b->err)); /* what follows joins bodies by their index */
    MT_TRY(mt_build_joints(b));
    MT_TRY(mt_build_springs(b));
    MT_TRY(build_loads(b));
    MT_TRY(build_drives(b));
    build_damping(b);
    return add_sensors(b, at);
}

/* Drives that a caller names. */
static int drives_of(const mt_system_def *def)
{
    return def->drive == NULL ? 0 : def->n_drives > 0 ? def->n_drives : 1;
}

static mt_status build(mt_system *sys, const mt_system_def *def, mt_err *err)
{
    const double *const at = def->at;
    mt_builder b = {.drive = def->drive, .n_drives = drives_of(def)};
    const size_t n_parameters = (size_t)sys->model->n_parameters;
    int *const is_input = mt_arena_int(&sys->mem, n_parameters + 1);
    sys->parameters = mt_arena_alloc(&sys->mem, n_parameters + 1, sizeof *sys->parameters);
    MT_TRY(mt_arena_check(&sys->mem, err));
    for (size_t i = 0; i < n_parameters; i++) {
        is_input[i] = -1;
    }
    for (int i = 0; i < sys->n_inputs; i++) {
        if (sys->inputs[i] != MT_ABSENT) {
            is_input[sys->inputs[i]] = i;
        }
    }
    sys->drawn_closed = true; /* until a joint says otherwise */
    MT_TRY(mt_program_init(&sys->program, sys->n_inputs, &sys->mem, err));
    MT_TRY(mt_emit_parameters(sys->model, sys->configuration, is_input, &sys->program,
                              sys->parameters, &sys->mem, err));
    MT_TRY(init_builder(&b, sys, err));
    const mt_status rc = build_parts(&b, at);
    MT_TRY(mt_arena_check(&sys->mem, err)); /* whatever else the shortage led to */
    MT_TRY(rc);
    MT_TRY(mt_program_finish(&sys->program, err));
    build_inputs(sys);
    MT_TRY(mt_arena_check(&sys->mem, err));
    return settle_by_numbers(sys, at, err);
}

mt_status mt_system_new_of(const mt_system_def *def, mt_system **out, mt_err *err)
{
    const int n_inputs = def->n_inputs;
    mt_system *const sys = calloc(1, sizeof *sys);
    *out = NULL;
    if (sys == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = mt_arena_init(&sys->mem, 0, err);
    if (rc == MT_OK) {
        sys->model = def->model;
        sys->run = mt_run_or_none(def->run);
        sys->configuration = def->configuration;
        sys->dimension = def->model->dimension;
        sys->n_inputs = n_inputs;
        for (int i = 0; i < drives_of(def); i++) {
            sys->n_inputs += def->drive[i].fixed ? 0 : 1;
        }
        sys->inputs = mt_arena_int(&sys->mem, (size_t)sys->n_inputs + 1);
        rc = mt_arena_check(&sys->mem, err);
    }
    if (rc == MT_OK && sys->inputs != NULL) {
        if (n_inputs > 0) {
            memcpy(sys->inputs, def->inputs, (size_t)n_inputs * sizeof *def->inputs);
        }
        for (int i = n_inputs; i <= sys->n_inputs; i++) {
            sys->inputs[i] = MT_ABSENT;
        }
        rc = build(sys, def, err);
    }
    if (rc != MT_OK) {
        mt_system_delete(sys);
        return rc;
    }
    *out = sys;
    return MT_OK;
}

mt_status mt_system_new(const mt_model *model, int configuration, int n_inputs,
                        const int *inputs, const double *at, mt_system **out, mt_err *err)
{
    const mt_system_def def = {.model = model,
                               .configuration = configuration,
                               .n_inputs = n_inputs,
                               .inputs = inputs,
                               .at = at};
    return mt_system_new_of(&def, out, err);
}

void mt_system_delete(mt_system *sys)
{
    if (sys != NULL) {
        mt_arena_free(&sys->mem);
        free(sys);
    }
}

/* True where the numbers of the beams' strains affect the geometry of stiffness. They do not in
 * an unloaded system that is closed in the drawn position: a straight beam without force
 * has strains that do not depend on them. */
/* An equilibrium is found again for every design; loops that are closed by force may leave a
 * beam bent in its reference position. */
static bool system_beams_shape(const mt_system *sys)
{
    return sys->loaded || !sys->drawn_closed;
}

int mt_system_drive_of(const mt_system *sys, int joint)
{
    for (int i = 0; i < sys->n_drives; i++) {
        if (sys->drives[i].joint == joint) {
            return i;
        }
    }
    return -1;
}

int mt_system_trim_of(const mt_system *sys, int spring)
{
    for (int i = 0; i < sys->n_trims; i++) {
        if (sys->drives[sys->n_drives - sys->n_trims + i].spring == spring) {
            return i;
        }
    }
    return -1;
}

int mt_system_find_channel(const mt_system *sys, const char *name)
{
    for (int i = 0; i < sys->n_channels; i++) {
        if (strcmp(sys->channels[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

int mt_system_find_joint(const mt_system *sys, const char *name)
{
    for (int i = 0; i < sys->n_joints; i++) {
        if (strcmp(sys->joints[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}
