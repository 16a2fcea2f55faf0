/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the command line to a model, values and configurations. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "model/expand.h"
#include "model/lint.h"
#include "model/model.h"
#include "model/values.h"
#include "result/folder.h"
#include "result/write.h"

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
    rc = mt_model_load(path, &opt, &out->own, &messages, &err);
    out->model = out->own;
    mt_watch_end(rc == MT_OK);
    const int code = mt_cli_loaded(rc, &messages, &err);
    if (code != MT_EXIT_DONE) {
        return code;
    }
    const mt_values *const sets = &args->all[MT_OPT_SET];
    rc = mt_loaded_model_choose(out, configuration, sets->n, sets->value, &err);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
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

void mt_loaded_model_warn_dropped(const mt_loaded_model *s, int c, const char *option, int n,
                                  const mt_system_drive *drives)
{
    const mt_configuration *const conf = &s->model->configurations[c];
    const char *stranger = NULL; /* a joint that the configuration does not drive */
    for (int i = 0; i < n && stranger == NULL; i++) {
        bool own = false;
        for (int k = 0; k < conf->n_drives; k++) {
            own = own || strcmp(conf->drives[k].joint_name.s, drives[i].joint) == 0;
        }
        stranger = own ? NULL : drives[i].joint;
    }
    for (int k = 0; k < conf->n_drives && stranger != NULL; k++) {
        const char *const own = conf->drives[k].joint_name.s;
        bool driven = false;
        for (int i = 0; i < n; i++) {
            driven = driven || strcmp(own, drives[i].joint) == 0;
        }
        if (!driven) {
            mt_terminal_warning(
                "%s: configuration \"%s\" drives \"%s\", which is dropped while "
                "\"%s\" is driven: \"%s\" is free and stands as it settles",
                option, conf->name.s, own, stranger, own);
        }
    }
}

void mt_loaded_model_warn_overridden(const mt_loaded_model *s, int c)
{
    const mt_configuration *const conf = &s->model->configurations[c];
    for (int k = 0; k < conf->n_overrides; k++) {
        for (int i = 0; i < s->n_set; i++) {
            if (conf->overrides[k].parameter == s->set[i]) {
                mt_terminal_warning("configuration \"%s\" has its own value of \"%s\": --set "
                                    "changes nothing there",
                                    conf->name.s, s->model->parameters[s->set[i]].name.s);
            }
        }
    }
}

/* The record of a configuration without an answer. */
static void put_failed(mt_json_writer *w, const char *configuration, const mt_err *err)
{
    const mt_failed_row row = {configuration, err->text};
    mt_record_put_object(w, NULL, &mt_failed_record, &row, 0, NULL);
}

int mt_cli_json_done(mt_json_writer *w)
{
    if (mt_json_done(w)) {
        return MT_EXIT_DONE;
    }
    if (!w->misused) {
        return MT_EXIT_SYSTEM; /* mt_terminal_put tells */
    }
    mt_terminal_error("the output cannot be written as JSON");
    return MT_EXIT_NUMERICAL;
}

int mt_cli_each(const mt_args *args, mt_loaded_model *s, mt_json_writer *w, mt_cli_show show,
                void *context)
{
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    mt_cli_shown shown = {MT_EXIT_DONE};
    if (list) {
        mt_json_open(w, NULL, '[');
    }
    for (int i = 0; i < s->n_configurations; i++) {
        const int c = s->configurations[i];
        mt_err err = {.code = MT_OK};
        mt_loaded_model_warn_overridden(s, c);
        const mt_status rc = show(context, s, c, &shown, &err);
        if (rc != MT_OK) {
            shown.code = mt_exit_worse(shown.code, mt_cli_failed(rc, &err));
        }
        if (rc != MT_OK && json) {
            put_failed(w, mt_loaded_model_configuration(s, c), &err);
        }
    }
    if (list) {
        mt_json_close(w);
    }
    return json ? mt_exit_worse(shown.code, mt_cli_json_done(w)) : shown.code;
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

/* The digest of a file that was read for the result; NULL: none was of that name. */
static const char *digest_of(const mt_result *result, const char *name)
{
    for (int i = 0; i < result->run.n_inputs; i++) {
        if (strcmp(result->run.inputs[i].file, name) == 0) {
            return result->run.inputs[i].sha256;
        }
    }
    return NULL;
}

/* A file that the model includes and that is another one now is an error; where the model was
 * given by its name (`warns`), a warning. */
static mt_status check_included(const mt_result *result, const mt_file *file, const char *path,
                                bool warns, mt_err *err)
{
    mt_json *doc = NULL;
    mt_arena mem = {.first = NULL};
    mt_included_list files = {.mem = &mem};
    if (strstr(file->bytes, "\"include\"") == NULL) {
        return MT_OK;
    }
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    rc = rc == MT_OK ? mt_model_expand(doc, path, NULL, &files, err) : rc;
    for (int i = 0; rc == MT_OK && i < files.n; i++) {
        char *const name = mt_file_join(result->model.file, files.items[i].name);
        const char *const was = name == NULL ? NULL : digest_of(result, name);
        const bool same = was != NULL && strcmp(was, files.items[i].sha256) == 0;
        if (name == NULL) {
            rc = mt_fail_memory(err);
        } else if (!same && warns) {
            mt_terminal_warning("%s is not what was solved: it has changed since", name);
        } else if (!same) {
            rc = mt_fail(err, MT_E_INPUT,
                         "%s: included file \"%s\" has changed since it was "
                         "solved",
                         path, files.items[i].name);
        }
        free(name);
    }
    if (rc == MT_E_INPUT && doc != NULL && mt_json_diags(doc)->errors > 0) {
        rc = mt_json_status(doc, path, err);
    }
    mt_json_delete(doc);
    mt_arena_free(&mem);
    return rc;
}

mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err)
{
    const char *const given = args->value[MT_OPT_MODEL];
    const char *const root = args->value[MT_OPT_ROOT];
    if (given == NULL) {
        const mt_status rc =
            mt_result_find_model(args->operands[0], result, root, file, path, err);
        return rc == MT_OK ? check_included(result, file, *path, false, err) : rc;
    }
    MT_TRY(mt_file_read(given, root, MT_JSON_MAX_BYTES, file, err));
    const char *const hash = mt_result_model_sha256(result);
    if (hash == NULL || strcmp(hash, file->sha256) != 0) {
        mt_terminal_warning("%s is not what was solved: it has changed since", given);
    }
    *path = mt_file_join("x", given);
    return *path == NULL ? mt_fail_memory(err) : check_included(result, file, *path, true, err);
}

/* Vibrations under a profile as tables and text. */

static const double TWO_PI = 6.28318530717958647693;

enum { DIGITS = 5, HZ_DIGITS = 6, BOUND_DIGITS = 2 };

/* The text in place of a missing number. */
static const char *end_of(const mt_vibration_response *r)
{
    return r->end == MT_FORCED_FINITE ? NULL : mt_forced_end_name(r->end);
}

void mt_vibrated_columns(mt_table *t)
{
    mt_table_column(t, "random [g RMS]", "rms_g", MT_ALIGN_POINT);
    mt_table_column(t, "tones [g]", "sine_g", MT_ALIGN_POINT);
    mt_table_column(t, "peak [g]", "peak_g", MT_ALIGN_POINT);
    mt_table_column(t, "random RMS", "rms", MT_ALIGN_POINT);
    mt_table_column(t, "error at most", "rms_error_at_most", MT_ALIGN_POINT);
    mt_table_column(t, "tones", "sine", MT_ALIGN_POINT);
    mt_table_column(t, "peak", "peak", MT_ALIGN_POINT);
    mt_table_column(t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(t, "no number", "end", MT_ALIGN_LEFT);
}

void mt_vibrated_row(mt_table *t, const mt_vibrated *v)
{
    const mt_vibration_response *const r = v->response;
    const bool random = v->profile->n_random > 0;
    const bool tones = v->profile->n_tones > 0;
    const double none = nan("");
    mt_table_number(t, random ? mt_vibrated_in_g(v, r->rms) : none, DIGITS);
    mt_table_number(t, tones ? mt_vibrated_in_g(v, r->sine) : none, DIGITS);
    mt_table_number(t, mt_vibrated_in_g(v, r->peak), DIGITS);
    mt_table_number(t, random ? r->rms : none, DIGITS);
    mt_table_number(t, random ? r->rms_bound : none, BOUND_DIGITS);
    mt_table_number(t, tones ? r->sine : none, DIGITS);
    mt_table_number(t, r->peak, DIGITS);
    mt_table_text(t, mt_vibrated_unit(v));
    mt_table_text(t, end_of(r));
}

void mt_vibrated_tone_columns(mt_table *t)
{
    mt_table_column(t, "tone", "tone", MT_ALIGN_LEFT);
    mt_table_column(t, "at [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(t, "peak [g]", "peak_g", MT_ALIGN_POINT);
    mt_table_column(t, "peak", "peak", MT_ALIGN_POINT);
    mt_table_column(t, "more at most", "excess_at_most", MT_ALIGN_POINT);
    mt_table_column(t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(t, "where", "where", MT_ALIGN_LEFT);
}

static const char *where(const mt_sine_peak *p)
{
    return p->end != MT_FORCED_FINITE ? mt_forced_end_name(p->end)
           : p->at_edge               ? "end of the range"
                                      : "within";
}

void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone)
{
    const mt_sine_peak *const p = &v->response->tones[tone];
    const double value = mt_vibration_respond_tone(v->profile, v->response, tone);
    mt_table_text(t, v->profile->tones[tone].label);
    mt_table_number(t, p->omega / TWO_PI, HZ_DIGITS);
    mt_table_number(t, mt_vibrated_in_g(v, value), DIGITS);
    mt_table_number(t, value, DIGITS);
    mt_table_number(t, p->excess, BOUND_DIGITS);
    mt_table_text(t, mt_vibrated_unit(v));
    mt_table_text(t, where(p));
}

void mt_vibrated_rule(const mt_vibration *v, mt_text *out)
{
    static const char *const rules[MT_TONES_RULES] = {
        "the sum of all tones", "the largest tone", "the root of the tones' sum of squares"};
    mt_text_add(out, "the peak is ");
    if (v->n_random > 0) {
        mt_text_addf(out, "%.4g times the RMS", v->sigma);
        mt_text_add(out, v->n_tones > 0 ? "\nand " : "");
    }
    mt_text_add(out, v->n_tones > 0 ? rules[v->rule] : "");
}

void mt_vibrated_marks(const mt_vibration *v, mt_text *out)
{
    mt_text_add(out, v->n_marks > 0 ? "  Of the profile is assumed, or unconfirmed:\n" : "");
    for (int i = 0; i < v->n_marks; i++) {
        mt_text_addf(out, "  - %s\n", v->marks[i]);
    }
    mt_text_add(out, v->n_marks > 0 ? "\n" : "");
}
