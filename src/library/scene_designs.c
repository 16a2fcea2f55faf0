/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "library/scene_designs.h"

#include <math.h>
#include <string.h>

#include "model/lint.h"
#include "scene/write.h"

mt_status mt_scene_name_modes(const mt_model *m, mt_arena *mem, mt_scene_query *ask,
                              mt_err *err)
{
    mt_scene_name *const names = mt_arena_alloc(mem, (size_t)m->n_modes, sizeof *names);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < m->n_modes; i++) {
        names[i] =
            (mt_scene_name){m->modes[i].configuration, m->modes[i].index, m->modes[i].name.s};
    }
    ask->names = names;
    ask->n_names = m->n_modes;
    return MT_OK;
}

/* A parameter of the model by its name in the result, with a value that is one. */
static mt_status take_named_value(const mt_model *model, const char *name, double value,
                                  int *inputs, double *at, int *n, mt_err *err)
{
    const int p = mt_model_find_parameter(model, name);
    if (p == MT_ABSENT) {
        return mt_fail(err, MT_E_INPUT, "the model has no parameter \"%s\"", name);
    }
    if (!isfinite(value)) {
        return mt_fail(err, MT_E_INPUT, "the result has no value of \"%s\"", name);
    }
    for (int i = 0; i < *n; i++) {
        if (inputs[i] == p) {
            return mt_fail(err, MT_E_INPUT, "the result has a value of \"%s\" twice", name);
        }
    }
    inputs[*n] = p;
    at[(*n)++] = value;
    return MT_OK;
}

/* Modes that the result names at a recommended design. */
static mt_status name_tracked(const mt_model *model, const mt_recommendation *r, mt_arena *mem,
                              mt_scene_query *ask, mt_err *err)
{
    mt_scene_name *const names = mt_arena_alloc(mem, (size_t)r->n_frequencies, sizeof *names);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (f->name != NULL && f->identity != NULL && strcmp(f->identity, "tracked") == 0) {
            const int c = mt_model_find_configuration(model, f->configuration);
            names[ask->n_names++] = (mt_scene_name){c, f->mode, f->name};
        }
    }
    ask->names = names;
    return MT_OK;
}

typedef struct source {
    const mt_model *model;
    const mt_result *result;
    int n_configurations;
    const int *configurations; /* that are shown */
    mt_numbers *numbers;       /* [n_configurations] of the model, for these inputs */
    int n_inputs;              /* -1: they are not compiled */
    const int *inputs;
    mt_arena *mem;
} source;

/* The numbers of all configurations that are shown are those of a mechanism. */
static mt_status admit(source *s, const mt_scene_query *ask, mt_err *err)
{
    const mt_model *const m = s->model;
    bool known = s->n_inputs == ask->n_inputs;
    for (int i = 0; i < ask->n_inputs && known; i++) {
        known = s->inputs[i] == ask->inputs[i];
    }
    s->n_inputs = -1;
    for (int i = 0; i < s->n_configurations; i++) {
        const int c = s->configurations[i];
        if (!known) {
            MT_TRY(mt_numbers_new(m, c, ask->n_inputs, ask->inputs, m->n_nums, m->nums, s->mem,
                                  &s->numbers[i], err));
        }
        MT_TRY(mt_model_admit_numbers(m, c, &s->numbers[i], ask->at, s->mem, err));
    }
    s->n_inputs = ask->n_inputs;
    s->inputs = ask->inputs;
    return MT_OK;
}

/* Set the overrides of the study, then the variables at this design; `original`: at their
 * original values. */
static mt_status fill_design_query(source *s, const mt_recommendation *r, bool original,
                                   mt_scene_query *ask, mt_err *err)
{
    const mt_model *const model = s->model;
    const mt_result_run *const run = &s->result->run;
    mt_arena *const mem = s->mem;
    const size_t most = (size_t)r->n_parameters + (size_t)run->n_overrides;
    int *const inputs = mt_arena_int(mem, most);
    double *const at = mt_arena_f64(mem, most, 1);
    MT_TRY(mt_arena_check(mem, err));
    *ask = (mt_scene_query){.label = original ? "original" : "recommended",
                            .rank = original ? 0 : r->rank,
                            .inputs = inputs,
                            .at = at,
                            .shown = inputs};
    for (int i = 0; i < r->n_parameters; i++) {
        const mt_result_parameter *const p = &r->parameters[i];
        MT_TRY(take_named_value(model, p->name, original ? p->original : p->recommended, inputs,
                                at, &ask->n_inputs, err));
    }
    ask->n_shown = ask->n_inputs;
    bool set = false;
    for (int i = 0; i < run->n_overrides; i++) {
        const mt_result_override *const v = &run->overrides[i];
        if (strcmp(v->kind, "parameter") == 0) {
            set = true;
            MT_TRY(take_named_value(model, v->name, v->value, inputs, at, &ask->n_inputs, err));
        }
    }
    MT_TRY(admit(s, ask, err));
    if (original) {
        return set ? MT_OK : mt_scene_name_modes(model, mem, ask, err);
    }
    return name_tracked(model, r, mem, ask, err);
}

mt_status mt_scene_designs(const mt_model *model, const mt_result *result, int n_configurations,
                           const int *configurations, mt_arena *mem, mt_scene_query **asks,
                           int *n, mt_err *err)
{
    static const mt_recommendation none = {.rank = 0};
    source s = {model, result, n_configurations, configurations, .n_inputs = -1, .mem = mem};
    const int count = result->n_recommendations;
    s.numbers = mt_arena_alloc(mem, (size_t)n_configurations, sizeof *s.numbers);
    *n = 0;
    *asks = mt_arena_alloc(mem, (size_t)count + 1, sizeof **asks);
    MT_TRY(mt_arena_check(mem, err));
    const mt_recommendation *const first = count > 0 ? &result->recommendations[0] : &none;
    MT_TRY(fill_design_query(&s, first, true, *asks, err));
    for (*n = 1; *n <= count; (*n)++) {
        mt_scene_query *const ask = *asks + *n;
        MT_TRY(fill_design_query(&s, &result->recommendations[*n - 1], false, ask, err));
        ask->label = count == 1 ? "recommended"
                                : mt_arena_printf(mem, "recommended, rank %d", ask->rank);
    }
    return mt_arena_check(mem, err);
}

int mt_scene_order(const mt_model *model, const mt_result *result, int *configurations)
{
    const mt_recommendation *const r = &result->baseline;
    const int all = model->n_configurations;
    int n = 0;
    int asked = 0;
    for (int i = 0; i < r->n_frequencies + all; i++) {
        const int c = i < r->n_frequencies
                          ? mt_model_find_configuration(model, r->frequencies[i].configuration)
                          : i - r->n_frequencies;
        bool known = c == MT_ABSENT;
        for (int k = 0; k < n && !known; k++) {
            known = configurations[k] == c;
        }
        if (!known) {
            configurations[n++] = c;
        }
        asked = i < r->n_frequencies ? n : asked;
    }
    return asked;
}

static void ask_travel(const mt_model *model, const char *joint, mt_scene_travel *travel)
{
    const int j = mt_model_find_joint(model, joint);
    if (j != MT_ABSENT) {
        travel[j] = MT_TRAVEL_MODES;
    }
}

/* Choose modes along the ranges that goals cover, and poses along those in which a shown
 * configuration holds its joint. travel[joints]. */
static void find_travel(const mt_model *model, const mt_result *result, int n,
                        const int *configurations, mt_scene_travel *travel)
{
    for (int i = 0; i < n; i++) {
        const mt_configuration *const c = &model->configurations[configurations[i]];
        for (int k = 0; k < c->n_drives; k++) {
            travel[c->drives[k].joint] = MT_TRAVEL_POSES;
        }
    }
    for (int r = 0; r <= result->n_recommendations; r++) {
        const mt_recommendation *const design =
            r == 0 ? &result->baseline : &result->recommendations[r - 1];
        for (int i = 0; i < design->n_motions; i++) {
            ask_travel(model, design->motions[i].drive, travel);
        }
        for (int i = 0; i < design->n_between; i++) {
            ask_travel(model, design->between[i].drive, travel);
        }
    }
}

static mt_status make_result_scene(const mt_model *model, const mt_result *result, int threads,
                                   mt_arena *mem, mt_scene **out, mt_err *err)
{
    const int all = model->n_configurations;
    int *const configurations = mt_arena_int(mem, (size_t)all);
    mt_scene_travel *const travel =
        mt_arena_alloc(mem, (size_t)model->n_joints, sizeof *travel);
    mt_scene_query *asks = NULL;
    int n = 0;
    MT_TRY(mt_arena_check(mem, err)); /* zero: MT_TRAVEL_NONE */
    const int asked = mt_scene_order(model, result, configurations);
    const mt_scene_extent extent = {.n_configurations = asked > 0 ? asked : all,
                                    .configurations = configurations,
                                    .work = MT_SCENE_WORK_ALONG,
                                    .threads = threads,
                                    .travel = travel};
    MT_TRY(mt_scene_designs(model, result, extent.n_configurations, configurations, mem, &asks,
                            &n, err));
    find_travel(model, result, extent.n_configurations, configurations, travel);
    return mt_scene_new(model, n, asks, &extent, out, err);
}

mt_status mt_scene_of_result(const mt_model *model, const mt_result *result, int threads,
                             mt_text *json, mt_err *err)
{
    mt_scene *scene = NULL;
    mt_arena mem;
    mt_err why = {.code = MT_OK};
    if (model == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_status rc = make_result_scene(model, result, threads, &mem, &scene, &why);
    if (rc == MT_OK && scene->size > 0.0) {
        rc = mt_scene_write_page(scene, json, &why);
    }
    mt_scene_delete(scene);
    mt_arena_free(&mem);
    return mt_pass_final(rc, &why, err);
}
