/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the command line to a model, values and configurations. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "model/lint.h"
#include "model/model.h"
#include "model/values.h"
#include "result/folder.h"
#include "result/write.h"

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

static mt_status take_settings(const mt_args *args, mt_loaded_model *s, mt_err *err)
{
    mt_setting *settings = NULL;
    const mt_status rc =
        mt_model_read_settings(s->model, s->original, args->all[MT_OPT_SET].n,
                               args->all[MT_OPT_SET].value, &s->mem, &settings, err);
    for (int i = 0; rc == MT_OK && i < args->all[MT_OPT_SET].n; i++) {
        s->inputs[s->n_inputs] = settings[i].parameter;
        s->at[s->n_inputs++] = settings[i].value;
    }
    return rc == MT_OK ? rc : mt_err_in(err, rc, "--set");
}

static mt_status apply_model_options(const mt_args *args, const char *configuration,
                                     mt_loaded_model *s, mt_err *err)
{
    const size_t np = (size_t)s->model->n_parameters;
    const int nc = s->model->n_configurations;
    s->original = mt_arena_f64(&s->mem, np, 1);
    s->values = mt_arena_f64(&s->mem, np, 1);
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
    rc = rc == MT_OK ? take_settings(args, s, err) : rc;
    rc = rc == MT_OK ? mt_model_parameters(s->model, MT_ABSENT, s->n_inputs, s->inputs, s->at,
                                           &s->mem, s->values, err)
                     : rc;
    /* what --set makes of the model must be a mechanism still */
    for (int i = 0; rc == MT_OK && i < s->n_configurations && s->n_inputs > 0; i++) {
        rc = mt_model_admit(s->model, s->configurations[i], s->n_inputs, s->inputs, s->at,
                            &s->mem, err);
        rc = mt_err_in(err, rc, "--set");
    }
    return rc;
}

int mt_loaded_model_load(const mt_args *args, const char *path, const char *configuration,
                         mt_loaded_model *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    out->path = path;
    mt_status rc = mt_arena_init(&out->mem, 0, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    (void)mt_watch_begin(args, 0, "reading");
    rc = mt_model_load(path, &opt, &out->model, &messages, &err);
    mt_watch_end(rc == MT_OK);
    const int code = mt_cli_loaded(rc, &messages, &err);
    if (code != MT_EXIT_DONE) {
        return code;
    }
    rc = apply_model_options(args, configuration, out, &err);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

void mt_loaded_model_free(mt_loaded_model *s)
{
    mt_model_delete(s->model);
    mt_arena_free(&s->mem);
    memset(s, 0, sizeof *s);
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
    for (int i = 0; list == NULL && i < model->n_parameters; i++) {
        if (mt_model_parameter_follows(model, i) == 0) {
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

void mt_loaded_model_note_links(const mt_loaded_model *s, int c, mt_text *out)
{
    mt_arena mem = {.first = NULL};
    bool any = false;
    for (int i = 0; i < s->model->n_links; i++) {
        const char *const limit = mt_model_link_limit(s->model, c, i, &mem);
        if (limit != NULL) {
            mt_text_addf(out, "  Note: %s.\n", limit);
            any = true;
        }
    }
    mt_text_add(out, any ? "\n" : "");
    out->failed = out->failed || mt_arena_failed(&mem);
    mt_arena_free(&mem);
}

void mt_loaded_model_warn_dropped(const mt_loaded_model *s, int c, const char *option,
                                  const char *joint)
{
    const mt_configuration *const conf = &s->model->configurations[c];
    const char *const own = conf->drive.given ? conf->drive.joint_name.s : NULL;
    if (own != NULL && joint != NULL && strcmp(own, joint) != 0) {
        mt_terminal_warning("%s: configuration \"%s\" drives \"%s\", which is dropped while "
                            "\"%s\" is driven: \"%s\" is free and stands as it settles",
                            option, conf->name.s, own, joint, own);
    }
}

void mt_loaded_model_warn_overridden(const mt_loaded_model *s, int c)
{
    const mt_configuration *const conf = &s->model->configurations[c];
    for (int k = 0; k < conf->n_overrides; k++) {
        for (int i = 0; i < s->n_inputs; i++) {
            if (conf->overrides[k].parameter == s->inputs[i]) {
                mt_terminal_warning("configuration \"%s\" has its own value of \"%s\": --set "
                                    "changes nothing there",
                                    conf->name.s, s->model->parameters[s->inputs[i]].name.s);
            }
        }
    }
}

const char *mt_mode_name(const mt_loaded_model *s, int c, int index)
{
    for (int i = 0; i < s->model->n_modes && s->n_inputs == 0; i++) {
        const mt_named_mode *const m = &s->model->modes[i];
        if (m->configuration == c && m->index == index && index > 0) {
            return m->name.s;
        }
    }
    return NULL;
}

const char *const mt_cli_methods[MT_CLI_METHODS] = {
    [MT_LOWEST_NONE] = "dense", [MT_LOWEST_TREE] = "tree", [MT_LOWEST_SPARSE] = "sparse"};

/* What answers about configurations share. */

typedef struct failed_row {
    const char *configuration;
    const char *error;
} failed_row;

#define THIS failed_row
static const mt_field failed_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_TEXT("error", error, "Why there is no answer."),
};
const mt_record mt_failed_record =
    MT_F_RECORD_OF(failed_fields, "failed", "A configuration without an answer.");
#undef THIS

void mt_cli_json_failed(mt_json_writer *w, const char *configuration, const mt_err *err)
{
    const failed_row row = {configuration, err->text};
    mt_record_put_object(w, NULL, &mt_failed_record, &row, 0, NULL);
}

#define THIS mt_joints_row
static const mt_field joints_fields[] = {
    MT_F_TEXTS(NULL, name, n, "Names of joints.", .flat = true),
};
const mt_record mt_joints_record = MT_F_BARE_RECORD_OF(joints_fields);
#undef THIS

mt_status mt_cli_redundant(mt_linear *lin, mt_arena *mem, int *n, mt_joints_row **out,
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

mt_dead_centre_row *mt_cli_dead_centre(const mt_nearness *nearness, mt_arena *mem)
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

void mt_cli_print_warnings(const mt_warning_list *list, mt_text *out)
{
    for (int i = 0; i < list->n; i++) {
        const mt_warning *const d = &list->items[i];
        mt_text_addf(out, "  %s: %s\n", d->level == MT_LEVEL_WARNING ? "doubtful" : "note",
                     d->text);
    }
}

/* --model takes a file as it is, with a warning where it is not what was solved; without it the
 * model is looked for (result/folder.h). */

mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err)
{
    const char *const given = args->value[MT_OPT_MODEL];
    const char *const root = args->value[MT_OPT_ROOT];
    if (given == NULL) {
        return mt_result_find_model(args->operands[0], result, root, file, path, err);
    }
    MT_TRY(mt_file_read(given, root, MT_JSON_MAX_BYTES, file, err));
    const char *const hash = mt_result_model_sha256(result);
    if (hash == NULL || strcmp(hash, file->sha256) != 0) {
        mt_terminal_warning("%s is not what was solved: it has changed since", given);
    }
    *path = mt_file_join("x", given);
    return *path == NULL ? mt_fail_memory(err) : MT_OK;
}
