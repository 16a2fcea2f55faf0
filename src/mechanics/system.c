/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mechanics/build.h"
#include "mechanics/data.h"
#include "mechanics/layout.h"
#include "model/values.h"

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
    MT_TRY(mt_program_eval(&sys->program, at, v, &bad, err));
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
    sys->length_m = mt_system_length(sys, v);
    mt_arena_rewind(&sys->mem, mark);
    sys->layout = mt_layout_new(sys, &sys->mem);
    return mt_arena_check(&sys->mem, err);
}

static mt_status build_parts(mt_builder *b, const double *at)
{
    MT_TRY(mt_build_bodies(b));
    MT_TRY(mt_build_links(b));
    MT_TRY(mt_arena_check(&b->sys->mem, b->err)); /* what follows joins bodies by their index */
    MT_TRY(mt_build_joints(b));
    MT_TRY(mt_build_springs(b));
    MT_TRY(mt_build_loads(b));
    MT_TRY(mt_build_drive(b));
    mt_build_damping(b);
    return mt_build_sensors(b, at);
}

static mt_status build(mt_system *sys, const mt_system_drive *drive, const double *at,
                       mt_err *err)
{
    mt_builder b = {.drive = drive};
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
    mt_build_inputs(sys);
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
        sys->n_inputs = n_inputs + (def->drive != NULL && !def->drive->fixed ? 1 : 0);
        sys->drive = MT_NO_NODE;
        sys->inputs = mt_arena_int(&sys->mem, (size_t)n_inputs + 1);
        rc = mt_arena_check(&sys->mem, err);
    }
    if (rc == MT_OK && sys->inputs != NULL) {
        if (n_inputs > 0) {
            memcpy(sys->inputs, def->inputs, (size_t)n_inputs * sizeof *def->inputs);
        }
        sys->inputs[n_inputs] = MT_ABSENT;
        rc = build(sys, def->drive, def->at, err);
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

/* An equilibrium is found again for every design; loops that are closed by force may leave a
 * beam bent in its reference position. */
bool mt_system_beams_shape(const mt_system *sys)
{
    return sys->loaded || !sys->drawn_closed;
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
