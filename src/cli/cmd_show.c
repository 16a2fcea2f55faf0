/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune show: a mechanism as a page that moves, as JSON, or as a still picture. */
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/find_model.h"
#include "cli/svg.h"
#include "io/file.h"
#include "io/folder.h"
#include "io/write_scene.h"
#include "library/scene_designs.h"
#include "report/page.h"
#include "scene/scene.h"

/* What is looked at: a model, at the design of its file and --set, or at those of a result. */
typedef struct subject {
    mt_loaded_model s; /* its designs are those below where there is a result */
    mt_result *result; /* NULL: a model was given */
    char *path;        /* heap: of the model of the result */
    int n;
    mt_scene_query *asks;
} subject;

/* *is: true where the file's format is that of a result. Errors in its text are reported by the
 * full reader. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
static mt_status is_result(const char *path, bool *is, mt_err *err)
{
    static const char format[] = "modetune-result/";
    mt_file file = {.bytes = NULL};
    mt_json *doc = NULL;
    *is = false;
    mt_status rc = mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &file, err);
    rc = rc == MT_OK ? mt_json_parse(file.bytes, file.length, &doc, err) : rc;
    if (rc == MT_OK) {
        const mt_addr member = mt_json_member(doc, MT_JSON_ROOT, "format");
        *is = member != MT_NO_ADDR && mt_json_type_of(doc, member) == MT_JSON_STRING &&
              strncmp(mt_json_string(doc, member), format, sizeof format - 1) == 0;
    }
    mt_json_delete(doc);
    mt_file_free(&file);
    return rc == MT_E_MEMORY || rc == MT_E_SYSTEM ? rc : MT_OK;
}

static mt_status of_model(const mt_args *args, subject *o, mt_err *err)
{
    o->asks = mt_arena_alloc(&o->s.mem, 1, sizeof *o->asks);
    MT_TRY(mt_arena_check(&o->s.mem, err));
    o->asks[0] = (mt_scene_query){.label = args->all[MT_OPT_SET].n == 0 ? "original" : "as set",
                                  .n_inputs = o->s.n_inputs,
                                  .inputs = o->s.inputs,
                                  .at = o->s.at,
                                  .n_shown = -1};
    o->n = 1;
    return args->all[MT_OPT_SET].n == 0
               ? mt_scene_name_modes(o->s.model, &o->s.mem, &o->asks[0], err)
               : MT_OK;
}

/* Load the operand. Returns the exit status, with all messages given. */
static int load_shown_file(const mt_args *args, subject *o)
{
    const mt_io_options opt = mt_cli_io(args);
    const char *const operand = args->operands[0];
    const char *const configuration = args->value[MT_OPT_CONFIGURATION];
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_file file = {.bytes = NULL};
    bool result = false;
    mt_status rc = is_result(operand, &result, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    if (!result && args->given[MT_OPT_MODEL]) {
        return mt_cli_failed(
            mt_fail(&err, MT_E_USAGE, "--model needs a result, and %s is not one", operand),
            &err);
    }
    if (result && args->all[MT_OPT_SET].n > 0) {
        return mt_cli_failed(
            mt_fail(&err, MT_E_USAGE, "--set needs a model: a result has its own values"),
            &err);
    }
    if (!result) {
        const int code = mt_loaded_model_load(args, operand, configuration, &o->s);
        rc = code == MT_EXIT_DONE ? of_model(args, o, &err) : MT_OK;
        return code != MT_EXIT_DONE ? code
               : rc == MT_OK        ? MT_EXIT_DONE
                                    : mt_cli_failed(rc, &err);
    }
    rc = mt_result_load(operand, &opt, &o->result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc != MT_OK) {
        return code;
    }
    rc = mt_find_model(args, o->result, &file, &o->path, &err);
    mt_file_free(&file);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    code = mt_loaded_model_load(args, o->path, configuration, &o->s);
    if (code == MT_EXIT_DONE && configuration == NULL) {
        (void)mt_scene_order(o->s.model, o->result, o->s.configurations); /* all of them */
    }
    rc = code == MT_EXIT_DONE
             ? mt_scene_designs(o->s.model, o->result, o->s.n_configurations,
                                o->s.configurations, &o->s.mem, &o->asks, &o->n, &err)
             : MT_OK;
    (void)mt_err_in(&err, rc, "%s", operand);
    return rc == MT_OK ? code : mt_cli_failed(rc, &err);
}

/* Warn with each reason once, with the first configuration that has it. */
static void warn(const mt_scene *scene, const char *path)
{
    const mt_scene_view *last = NULL;
    int more = 0;
    for (int d = 0; d < scene->n_designs; d++) {
        for (int i = 0; i < scene->designs[d].n_views; i++) {
            const mt_scene_view *const v = &scene->designs[d].views[i];
            if (v->error == NULL) {
                continue;
            }
            if (last != NULL && strcmp(last->error, v->error) == 0) {
                more++;
                continue;
            }
            mt_terminal_warning("%s: configuration \"%s\": %s", path, v->name, v->error);
            last = v;
        }
    }
    if (more > 0) {
        mt_terminal_warning("%s: %d more like these: choose what to show with -c", path, more);
    }
}

static mt_status page(const mt_scene *scene, const char *title, mt_text *out, mt_err *err)
{
    mt_text json = {.s = NULL};
    const mt_status rc = mt_scene_write(scene, &json, err);
    if (rc == MT_OK) {
        const mt_page_data data[] = {{"scene", json.s}};
        mt_page_begin(MT_PAGE_SHOW, title, out);
        mt_page_end(MT_COUNT(data), data, out);
    }
    mt_text_free(&json);
    return rc;
}

/* Draw the best recommended design of a result, else the original one, in its first
 * configuration shown, with the mode of --mode. */
static mt_status still(const mt_args *args, const mt_scene *scene, mt_text *out, mt_err *err)
{
    const mt_scene_design *const d = &scene->designs[scene->n_designs > 1 ? 1 : 0];
    const mt_scene_view *const v = &d->views[0];
    const mt_scene_mode *mode = NULL;
    for (int i = 0; i < v->n_modes; i++) {
        mode = args->mode > 0 && v->modes[i].index == args->mode ? &v->modes[i] : mode;
    }
    if (args->mode > 0 && mode == NULL) {
        return mt_fail(err, MT_E_USAGE,
                       "--mode: configuration \"%s\" shows no vibration mode %d", v->name,
                       args->mode);
    }
    mt_svg(scene, v, mode, out);
    return MT_OK;
}

/* Write the file of --output, completely or not at all. */
static mt_status save_output_file(const char *path, const mt_text *text, mt_err *err)
{
    const char *const name = mt_text_base_name(path);
    if (name[0] == '\0' || strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
        return mt_fail(err, MT_E_USAGE, "--output: \"%s\" is not the name of a file", path);
    }
    if (strlen(name) >= MT_FOLDER_NAME) {
        return mt_fail(err, MT_E_USAGE, "--output: the name \"%s\" is too long", name);
    }
    char *const folder = mt_file_folder(path);
    if (folder == NULL) {
        return mt_fail_memory(err);
    }
    const mt_folder_file file = {name, text->s, text->length};
    const mt_status rc = mt_folder_replace(folder, &file, 1, err);
    free(folder);
    return rc;
}

static mt_status check_use(const mt_args *args, mt_err *err)
{
    if (args->given[MT_OPT_MODE] && !args->given[MT_OPT_SVG]) {
        return mt_fail(err, MT_E_USAGE, "--mode needs --svg: the page shows all modes");
    }
    if (args->given[MT_OPT_FORMAT] && args->given[MT_OPT_SVG]) {
        return mt_fail(err, MT_E_USAGE, "--svg and --format exclude each other");
    }
    return MT_OK;
}

static mt_status write(const mt_args *args, const subject *o, const mt_scene *scene,
                       mt_text *out, mt_err *err)
{
    const char *const title =
        scene->name[0] != '\0' ? scene->name : mt_text_base_name(o->s.path);
    mt_text own = {.s = NULL};
    mt_text *const to = args->given[MT_OPT_OUTPUT] ? &own : out;
    mt_status rc = args->given[MT_OPT_SVG]          ? still(args, scene, to, err)
                   : args->format == MT_FORMAT_JSON ? mt_scene_write(scene, to, err)
                                                    : page(scene, title, to, err);
    rc = rc == MT_OK && to->failed ? mt_fail_memory(err) : rc;
    if (rc == MT_OK && to == &own) {
        rc = save_output_file(args->value[MT_OPT_OUTPUT], &own, err);
    }
    if (rc == MT_OK && to == &own) {
        mt_terminal_talk(args->given[MT_OPT_QUIET], "%s: written to %s", args->operands[0],
                         args->value[MT_OPT_OUTPUT]);
    }
    mt_text_free(&own);
    return rc;
}

int mt_cmd_show(const mt_args *args, mt_text *out)
{
    subject o = {.result = NULL};
    mt_scene *scene = NULL;
    mt_err err = {.code = MT_OK};
    mt_status rc = check_use(args, &err);
    int code = rc == MT_OK ? load_shown_file(args, &o) : mt_cli_failed(rc, &err);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    /* a picture is of one configuration and one design */
    const int n = args->given[MT_OPT_SVG] ? 1 : o.s.n_configurations;
    const mt_scene_extent extent = {
        .n_configurations = n, .configurations = o.s.configurations, .work = MT_SCENE_WORK};
    rc = mt_scene_new(o.s.model, o.n, o.asks, &extent, &scene, &err);
    if (rc == MT_OK) {
        warn(scene, o.s.path);
        rc = write(args, &o, scene, out, &err);
    }
    code = rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
done:
    mt_scene_delete(scene);
    mt_result_delete(o.result);
    mt_loaded_model_free(&o.s);
    free(o.path);
    return code;
}
