/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model with values of its parameters, and what answers about its configurations share. */
#include "inspect/loaded_model.h"

#include "modetune/model.h"

#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "model/lint.h"
#include "model/values.h"

static mt_status refuse_unknown_name(const char *what, const char *name,
                                     const char *const *names, int n, mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, names, n);
    return nearest == NULL ? mt_fail(err, MT_E_USAGE, "unknown %s \"%s\"", what, name)
                           : mt_fail(err, MT_E_USAGE, "unknown %s \"%s\"; did you mean \"%s\"?",
                                     what, name, nearest);
}

static mt_status find_configuration(mt_loaded_model *s, const char *name, mt_err *err)
{
    const int n = s->model->n_configurations;
    const int found = mt_model_find_configuration(s->model, name);
    if (found != MT_ABSENT) {
        s->configurations[0] = found;
        s->n_configurations = 1;
        return MT_OK;
    }
    const char **const names = mt_arena_alloc(&s->mem, (size_t)n, sizeof *names);
    MT_TRY(mt_arena_check(&s->mem, err));
    for (int i = 0; i < n; i++) {
        names[i] = s->model->configurations[i].name.s;
    }
    return refuse_unknown_name("configuration", name, names, n, err);
}

/* True where the condition of an if() depends on the parameter: nothing has a slope by it. */
static bool decides(const mt_model *model, int parameter, mt_arena *mem)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_numbers numbers;
    const mt_status rc = mt_numbers_new(model, MT_ABSENT, 1, &parameter, model->n_nums,
                                        model->nums, mem, &numbers, NULL);
    mt_arena_rewind(mem, mark);
    return rc == MT_E_INPUT;
}

static bool has_condition(const mt_model *model)
{
    bool any = false;
    for (int i = 0; i < model->n_nums; i++) {
        const mt_expr *const e = &model->nums[i].expr;
        for (int k = 0; k < e->length && !any; k++) {
            any = e->code[k].op == MT_OP_IF;
        }
    }
    return any;
}

/* The model as if its file gave the parameter this value: what decides cases is no input. */
static mt_status write_setting(mt_loaded_model *s, mt_model *changed, mt_setting set,
                               mt_err *err)
{
    if (s->model != changed) {
        *changed = *s->model;
        changed->nums = mt_arena_alloc(&s->mem, (size_t)changed->n_nums, sizeof *changed->nums);
        MT_TRY(mt_arena_check(&s->mem, err));
        memcpy(changed->nums, s->model->nums, (size_t)changed->n_nums * sizeof *changed->nums);
        s->model = changed;
    }
    const mt_num value = changed->parameters[set.parameter].value;
    return mt_expr_number(set.value, &s->mem, &changed->nums[value].expr, err);
}

static mt_status take_settings(mt_loaded_model *s, int n, const char *const *sets, mt_err *err)
{
    mt_setting *settings = NULL;
    mt_model *const changed = mt_arena_alloc(&s->mem, 1, sizeof *changed);
    MT_TRY(mt_arena_check(&s->mem, err));
    const mt_model *const model = s->model;
    mt_status rc = mt_model_read_settings(model, s->original, n, sets, &s->mem, &settings, err);
    const bool conditions = n > 0 && has_condition(model);
    for (int i = 0; rc == MT_OK && i < n; i++) {
        s->set[s->n_set++] = settings[i].parameter;
        if (conditions && decides(model, settings[i].parameter, &s->mem)) {
            rc = write_setting(s, changed, settings[i], err);
        } else {
            s->inputs[s->n_inputs] = settings[i].parameter;
            s->at[s->n_inputs++] = settings[i].value;
        }
    }
    return rc == MT_OK ? rc : mt_err_in(err, rc, "--set");
}

mt_status mt_loaded_model_choose(mt_loaded_model *s, const char *configuration, int n_sets,
                                 const char *const *sets, mt_err *err)
{
    const size_t np = (size_t)s->model->n_parameters;
    const int nc = s->model->n_configurations;
    s->original = mt_arena_f64(&s->mem, np, 1);
    s->values = mt_arena_f64(&s->mem, np, 1);
    s->set = mt_arena_int(&s->mem, np);
    s->inputs = mt_arena_int(&s->mem, np);
    s->at = mt_arena_f64(&s->mem, np, 1);
    s->configurations = mt_arena_int(&s->mem, (size_t)nc);
    MT_TRY(mt_arena_check(&s->mem, err));
    if (configuration != NULL) {
        MT_TRY(find_configuration(s, configuration, err));
    } else {
        for (int i = 0; i < nc; i++) {
            s->configurations[s->n_configurations++] = i;
        }
    }
    mt_status rc = mt_model_original_values(s->model, &s->mem, s->original, NULL, err);
    rc = rc == MT_OK ? take_settings(s, n_sets, sets, err) : rc;
    rc = rc == MT_OK ? mt_model_parameters(s->model, MT_ABSENT, s->n_inputs, s->inputs, s->at,
                                           &s->mem, s->values, err)
                     : rc;
    /* what --set makes of the model must be a mechanism still */
    for (int i = 0; rc == MT_OK && i < s->n_configurations && s->n_set > 0; i++) {
        rc = mt_model_admit(s->model, s->configurations[i], s->n_inputs, s->inputs, s->at,
                            &s->mem, err);
        rc = mt_err_in(err, rc, "--set");
    }
    return rc;
}

const mt_unit *mt_loaded_model_joint_unit(const mt_model *model, const char *name)
{
    const int joint = mt_model_find_joint(model, name);
    const mt_coordinate coordinate =
        joint < 0 ? MT_COORDINATE_ANGLE
                  : mt_joint_kind_of(model->joints[joint].type)->coordinate;
    return model->units[coordinate == MT_COORDINATE_DISPLACEMENT ? MT_LENGTH : MT_ANGLE];
}

mt_status mt_loaded_model_number(mt_loaded_model *s, const char *option, const mt_unit *unit,
                                 const char *text, size_t length, double *out, mt_err *err)
{
    const char *const copy = mt_arena_strndup(&s->mem, text, length);
    mt_typing with;
    MT_TRY(mt_typing_new(s->model, s->values, &s->mem, &with, err));
    const mt_status rc = mt_model_read_typed(&with, copy, unit, unit, out, err);
    return rc == MT_OK
               ? rc
               : mt_err_in(err, rc == MT_E_MEMORY ? rc : MT_E_USAGE, "--%s: %s", option, copy);
}

static mt_status add_parameter(const mt_model *model, const char *option, const char *name,
                               mt_arena *mem, int *n, int *out, mt_err *err)
{
    const int found = mt_model_find_parameter(model, name);
    if (found == MT_ABSENT) {
        const char **const names =
            mt_arena_alloc(mem, (size_t)model->n_parameters, sizeof *names);
        MT_TRY(mt_arena_check(mem, err));
        for (int i = 0; i < model->n_parameters; i++) {
            names[i] = model->parameters[i].name.s;
        }
        const char *const nearest = mt_text_nearest(name, names, model->n_parameters);
        return mt_fail(err, MT_E_USAGE, "--%s: unknown parameter \"%s\"%s%s%s", option, name,
                       nearest == NULL ? "" : "; did you mean \"",
                       nearest == NULL ? "" : nearest, nearest == NULL ? "" : "\"?");
    }
    for (int i = 0; i < *n; i++) {
        if (out[i] == found) {
            return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is given twice", option, name);
        }
    }
    out[(*n)++] = found;
    return MT_OK;
}

mt_status mt_loaded_model_parameters(const mt_loaded_model *s, const char *option,
                                     const char *list, mt_arena *mem, int *n, int **out,
                                     mt_err *err)
{
    const mt_model *const model = s->model;
    *n = 0;
    *out = mt_arena_int(mem, (size_t)model->n_parameters);
    MT_TRY(mt_arena_check(mem, err));
    const bool conditions = list == NULL && has_condition(model);
    for (int i = 0; list == NULL && i < model->n_parameters; i++) {
        if (mt_model_parameter_follows(model, i) == 0 &&
            !(conditions && decides(model, i, mem))) {
            (*out)[(*n)++] = i;
        }
    }
    while (list != NULL && *list != '\0') {
        const size_t length = strcspn(list, ",");
        const char *const name = mt_arena_strndup(mem, list, length);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(add_parameter(model, option, name, mem, n, *out, err));
        list += length + (list[length] == ',' ? 1 : 0);
    }
    return *n > 0 ? MT_OK
                  : mt_fail(err, MT_E_INPUT, "%s: there are no parameters to vary", s->path);
}

mt_system_def mt_loaded_model_system(const mt_loaded_model *s, int c, int n_inputs,
                                     const int *inputs, const double *at)
{
    return (mt_system_def){.model = s->model,
                           .run = s->run,
                           .configuration = c,
                           .n_inputs = n_inputs,
                           .inputs = inputs,
                           .at = at};
}

mt_status mt_loaded_model_analyse(const mt_loaded_model *s, int c, int first, mt_analysis **out,
                                  mt_err *err)
{
    const mt_system_def def = mt_loaded_model_system(s, c, s->n_inputs, s->inputs, s->at);
    const mt_status rc = mt_analysis_new_of(&def, first, out, err);
    return rc == MT_OK ? rc : mt_err_in(err, rc, "%s", s->path);
}

mt_status mt_loaded_model_admit_dense(const mt_loaded_model *s, int c, const char *why,
                                      mt_err *err)
{
    const double bodies = mt_lowest_bodies(s->model, c);
    return bodies <= MT_ANALYSIS_BODIES
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "%s: configuration \"%s\": %.0f bodies are too many for dense "
                         "matrices; %s",
                         s->path, mt_loaded_model_configuration(s, c), bodies, why);
}

mt_status mt_loaded_model_lowest(const mt_loaded_model *s, int c, int n_inputs,
                                 const int *inputs, const double *at, mt_lowest_want want,
                                 mt_lowest **out, mt_err *err)
{
    const double bodies = mt_lowest_bodies(s->model, c);
    char why[MT_LOWEST_WHY + 50] = "ask for the lowest modes only (--count)";
    *out = NULL;
    if (want.count > 0 && want.count <= bodies / 2 && bodies >= MT_LOWEST_BODIES) {
        const mt_system_def def = mt_loaded_model_system(s, c, n_inputs, inputs, at);
        const mt_status rc = mt_lowest_new(&def, want, out, err);
        if (rc != MT_OK) {
            return mt_err_in(err, rc, "%s", s->path);
        }
        if ((*out)->way != MT_LOWEST_NONE) {
            return MT_OK;
        }
        (void)mt_snprintf(why, sizeof why,
                          "the method for large trees does not apply, because %s", (*out)->why);
        mt_lowest_delete(*out);
        *out = NULL;
    }
    return mt_loaded_model_admit_dense(s, c, why, err);
}

const char *mt_loaded_model_configuration(const mt_loaded_model *s, int c)
{
    return s->model->configurations[c].name.s;
}

const char *mt_mode_name(const mt_loaded_model *s, int c, int index)
{
    for (int i = 0; i < s->model->n_modes && s->n_set == 0; i++) {
        const mt_named_mode *const m = &s->model->modes[i];
        if (m->configuration == c && m->index == index && index > 0) {
            return m->name.s;
        }
    }
    return NULL;
}

const char *const mt_lowest_method_names[MT_LOWEST_METHOD_NAMES] = {
    [MT_LOWEST_NONE] = "dense", [MT_LOWEST_TREE] = "tree", [MT_LOWEST_SPARSE] = "sparse"};

/* What answers about configurations share. */

#define THIS mt_failed_row
static const mt_field failed_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_TEXT("error", error, "Why there is no answer."),
};
const mt_record mt_failed_record =
    MT_F_RECORD_OF(failed_fields, "failed", "A configuration without an answer.");
#undef THIS

#define THIS mt_joints_row
static const mt_field joints_fields[] = {
    MT_F_TEXTS(NULL, name, n, "Names of joints.", .flat = true),
};
const mt_record mt_joints_record = MT_F_BARE_RECORD_OF(joints_fields);
#undef THIS

mt_status mt_redundant_rows(mt_linear *lin, mt_arena *mem, int *n, mt_joints_row **out,
                            mt_err *err)
{
    const int count = mt_linear_redundant(lin);
    *out = mt_arena_alloc(mem, (size_t)count + 1, sizeof **out); /* a list of none is one */
    MT_TRY(mt_arena_check(mem, err));
    for (*n = 0; *n < count; (*n)++) {
        mt_joint_names joints;
        MT_TRY(mt_linear_redundant_set(lin, *n, mem, &joints, err));
        (*out)[*n] = mt_joints_row_of(&joints, mem);
    }
    return mt_arena_check(mem, err);
}

#define THIS mt_dead_centre_row
static const mt_field dead_centre_fields[] = {
    MT_F_NUMBER("distance", distance, "About how far it is [rad, model lengths]."),
    MT_F_NUMBER(
        "independence", independence,
        "How independent the equations of its joints are: about 1 far from a dead centre, "
        "0 there."),
    MT_F_TEXTS("joints", joints, n_joints, "Joints whose equations depend on each other there.",
               .flat = true),
};
const mt_record mt_dead_centre_record =
    MT_F_RECORD_OF(dead_centre_fields, "dead_centre", "A dead centre near a position.");
#undef THIS

mt_dead_centre_row *mt_dead_centre_row_of(const mt_nearness *nearness, mt_arena *mem)
{
    mt_dead_centre_row *const out = nearness->near ? mt_arena_alloc(mem, 1, sizeof *out) : NULL;
    if (out != NULL) {
        const mt_joints_row joints = mt_joints_row_of(&nearness->joints, mem);
        *out = (mt_dead_centre_row){.distance = nearness->distance,
                                    .independence = nearness->independence,
                                    .n_joints = joints.n,
                                    .joints = joints.name};
    }
    return out;
}

void mt_loaded_model_free(mt_loaded_model *s)
{
    mt_model_delete(s->own);
    mt_arena_free(&s->mem);
    memset(s, 0, sizeof *s);
}
