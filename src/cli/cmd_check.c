/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune check: every problem of files, each as its format says. */
#include "modetune/read.h"
#include "modetune/version.h"

#include <stdlib.h>
#include <string.h>

#include "answer/examine.h"
#include "answer/warnings.h"
#include "base/base.h"
#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "io/file.h"
#include "io/json.h"
#include "io/write_json.h"
#include "model/expand.h"
#include "problem/problem.h"
#include "report/summary.h"
#include "report/table.h"
#include "result/write.h"

/*
 * Problems of files as SARIF 2.1.0, which code hosts show at the lines of a review and editors
 * in their lists. One log, one run:
 *     sarif_begin(&w);
 *     sarif_put(&w, &problem); ...
 *     sarif_end(&w, code, left_out);
 */
typedef struct file_problem {
    mt_severity severity;
    bool unread;      /* the file itself could not be read */
    const char *file; /* as given; relative ones become relative URIs */
    int line;         /* 0: no place; shown at the first line, which hosts require */
    int column;       /* of code points; 0: no place */
    const char *pointer;
    const char *message;
} file_problem;

static const char *const severities[MT_SEVERITY_COUNT] = {"error", "warning", "note"};

#define THIS file_problem
static const mt_field problem_fields[] = {
    MT_F_TEXT("file", file, "The file, as it was given or is named by one that was."),
    MT_F_COUNT_OR_NULL("line", line, 1, "From 1; null: of the whole file."),
    MT_F_COUNT_OR_NULL("column", column, 1, "From 1, in characters; null: of the whole file."),
    MT_F_TEXT_OR_NULL("pointer", pointer, "JSON pointer in that file."),
    MT_F_ENUM("severity", severity, mt_severity, severities,
              "An error: the file cannot be used; a warning: it is suspicious; a note: good to "
              "know."),
    MT_F_TEXT("message", message, "In words."),
};
static const mt_record problem_record =
    MT_F_RECORD_OF(problem_fields, NULL, "A problem of a file.");
#undef THIS

/* Of SARIF ("Static Analysis Results Interchange Format", OASIS, version 2.1.0) what code hosts
 * read: tool.driver with its rules, results with rule, level, message and place. */

/* id: does not change; text for people. */
#define RULES(X)                                                                             \
    X(RULE_ERROR, "bad-input", "error", "An input file is wrong",                            \
      "Something that is missing, of a wrong type, unknown, out of its range or "            \
      "contradictory: the file cannot be used before it is mended.")                         \
    X(RULE_WARNING, "hardly-meant", "warning", "A value is allowed but suspicious",          \
      "Values that look like other units, joints off their links, bands that no mode comes " \
      "near. They stand before the answer and change no grade.")                             \
    X(RULE_NOTE, "good-to-know", "note", "A fact of the model",                              \
      "Free motions, unstable directions, redundant joints, gaps that were closed: welcome " \
      "where they are meant.")                                                               \
    X(RULE_UNREAD, "not-analysed", "error", "A file could not be read or analysed",          \
      "It is not there, not readable or too large, or the mechanism cannot be analysed.")
#define RULE_ID(id, name, level, brief, whole) id,
typedef enum rule_id { RULES(RULE_ID) RULE_COUNT } rule_id;

static const struct {
    const char *name;
    const char *level;
    const char *brief;
    const char *whole;
} rules[RULE_COUNT] = {
#define RULE_TEXT(id, name, level, brief, whole) [id] = {name, level, brief, whole},
    RULES(RULE_TEXT)};

static void put_text(mt_json_writer *w, const char *member, const char *text)
{
    mt_json_open(w, member, '{');
    mt_json_put_string(w, "text", text);
    mt_json_close(w);
}

static void sarif_begin(mt_json_writer *w)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "$schema",
                       "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/"
                       "sarif-schema-2.1.0.json");
    mt_json_put_string(w, "version", "2.1.0");
    mt_json_open(w, "runs", '[');
    mt_json_open(w, NULL, '{');
    mt_json_open(w, "tool", '{');
    mt_json_open(w, "driver", '{');
    mt_json_put_string(w, "name", "modetune");
    mt_json_put_string(w, "version", mt_version());
    mt_json_open(w, "rules", '[');
    for (int i = 0; i < RULE_COUNT; i++) {
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "id", rules[i].name);
        put_text(w, "shortDescription", rules[i].brief);
        put_text(w, "fullDescription", rules[i].whole);
        mt_json_open(w, "defaultConfiguration", '{');
        mt_json_put_string(w, "level", rules[i].level);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_put_string(w, "columnKind", "unicodeCodePoints");
    mt_json_open(w, "results", '[');
}

/* A relative reference, or file:// and the path. */
static void add_uri(const char *path, mt_text *out)
{
    char *const normal = mt_files_normal(path);
    if (normal == NULL) {
        out->failed = true;
        return;
    }
    mt_text_add(out, normal[0] == '/' ? "file://" : "");
    mt_text_add_uri(out, normal);
    free(normal);
}

static rule_id rule_of(const file_problem *p)
{
    switch (p->severity) {
    case MT_SEVERITY_WARNING:
        return RULE_WARNING;
    case MT_SEVERITY_NOTE:
        return RULE_NOTE;
    case MT_SEVERITY_ERROR:
    case MT_SEVERITY_COUNT:
        break;
    }
    return p->unread ? RULE_UNREAD : RULE_ERROR;
}

static void sarif_put(mt_json_writer *w, const file_problem *p)
{
    const rule_id rule = rule_of(p);
    mt_text uri = {.s = NULL};
    add_uri(p->file, &uri);
    w->out->failed = w->out->failed || uri.failed;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "ruleId", rules[rule].name);
    mt_json_put_integer(w, "ruleIndex", rule);
    mt_json_put_string(w, "level", rules[rule].level);
    put_text(w, "message", p->message);
    mt_json_open(w, "locations", '[');
    mt_json_open(w, NULL, '{');
    mt_json_open(w, "physicalLocation", '{');
    mt_json_open(w, "artifactLocation", '{');
    mt_json_put_string(w, "uri", uri.s == NULL ? "" : uri.s);
    mt_json_close(w);
    mt_json_open(w, "region", '{');
    mt_json_put_integer(w, "startLine", p->line > 0 ? p->line : 1);
    if (p->line > 0) {
        mt_json_put_integer(w, "startColumn", p->column);
    }
    mt_json_close(w);
    mt_json_close(w);
    if (p->line > 0 && p->pointer != NULL && p->pointer[0] != '\0') {
        mt_json_open(w, "logicalLocations", '[');
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "fullyQualifiedName", p->pointer);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_text_free(&uri);
}

/* code: exit status of the program; left_out: number of problems left out. */
static void sarif_end(mt_json_writer *w, int code, int left_out)
{
    mt_json_close(w);
    mt_json_open(w, "invocations", '[');
    mt_json_open(w, NULL, '{');
    mt_json_put_bool(w, "executionSuccessful", code == MT_EXIT_DONE || code == MT_EXIT_INPUT);
    mt_json_put_integer(w, "exitCode", code);
    if (left_out > 0) {
        char text[64];
        (void)mt_snprintf(text, sizeof text, "%d more problems are not shown", left_out);
        mt_json_open(w, "toolExecutionNotifications", '[');
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "level", "note");
        put_text(w, "message", text);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
}

/* The command. */

typedef enum file_kind {
    KIND_MODEL,
    KIND_STUDY,
    KIND_RESULT,
    KIND_AIRCRAFT,
    KIND_PROFILE,
    KIND_COUNT
} file_kind;

static const char *const formats[KIND_COUNT] = {"modetune-model/1", "modetune-study/1",
                                                "modetune-result/1", "modetune-aircraft/1",
                                                "modetune-profile/1"};
static const char *const kinds[KIND_COUNT] = {"model", "study", "result", "aircraft",
                                              "profile"};

/* A text that lists them. */
enum { ALL_FORMATS = 160 };

/* The kind of the document by its format; KIND_COUNT with a diagnostic where it is not
 * known. */
static int find_document_kind(mt_json *doc)
{
    mt_diags *const diags = mt_json_diags(doc);
    const mt_addr value = mt_json_member(doc, MT_JSON_ROOT, "format");
    char all[ALL_FORMATS];
    (void)mt_snprintf(all, sizeof all, "one of \"%s\", \"%s\", \"%s\", \"%s\", \"%s\"",
                      formats[0], formats[1], formats[2], formats[3], formats[4]);
    if (mt_json_type_of(doc, MT_JSON_ROOT) != MT_JSON_OBJECT) {
        mt_diag_structure(diags, MT_JSON_ROOT, "must be an object with a member \"format\"");
        return KIND_COUNT;
    }
    if (value == MT_NO_ADDR) {
        mt_diag_structure(diags, MT_JSON_ROOT, "member \"format\" is missing: %s", all);
        return KIND_COUNT;
    }
    const char *const text =
        mt_json_type_of(doc, value) == MT_JSON_STRING ? mt_json_string(doc, value) : "";
    for (int i = 0; i < KIND_COUNT; i++) {
        if (strcmp(text, formats[i]) == 0) {
            return i;
        }
    }
    const char *const nearest = mt_text_nearest(text, formats, KIND_COUNT);
    mt_diag_structure(diags, value, "must be %s%s%s%s", all,
                      nearest == NULL ? "" : "; did you mean \"",
                      nearest == NULL ? "" : nearest, nearest == NULL ? "" : "\"?");
    return KIND_COUNT;
}

/* *out: the document, the caller's, where it has a kind; else NULL. */
static mt_status find_kind(const char *path, const mt_io_options *opt, int *kind, mt_json **out,
                           mt_diagnostics *messages, mt_err *err)
{
    mt_file file = {.bytes = NULL};
    mt_json *doc = NULL;
    *kind = KIND_COUNT;
    *out = NULL;
    mt_status rc = mt_file_read(path, opt->root, MT_JSON_MAX_BYTES, &file, err);
    if (rc == MT_OK) {
        rc = mt_json_parse(file.bytes, file.length, &doc, err);
    }
    if (doc != NULL) {
        *kind = rc == MT_OK ? find_document_kind(doc) : KIND_COUNT;
        if (*kind == KIND_COUNT) {
            rc = rc == MT_OK ? mt_fail(err, MT_E_INPUT, "%s: the format is unknown", path) : rc;
            mt_json_report(doc, path, messages);
            mt_json_delete(doc);
            doc = NULL;
        }
    }
    *out = doc;
    mt_file_free(&file);
    return rc;
}

/* Analyse every configuration as it is, within a time limit. */
static mt_status examine_model(const mt_model *model, mt_warning_list *found, mt_err *err)
{
    double work = 0.0;
    int left = 0;
    for (int c = 0; c < model->n_configurations; c++) {
        mt_analysis *a = NULL;
        const double takes = mt_warnings_work(model, c);
        if (work + takes > MT_WARNINGS_WORK) {
            left++;
            continue;
        }
        work += takes;
        const mt_system_def def = {.model = model, .configuration = c};
        mt_status rc = mt_analysis_new_of(&def, 1, &a, err);
        rc = rc == MT_OK ? mt_warnings_of_analysis(a, 0, NULL, NULL, found, err) : rc;
        mt_analysis_delete(a);
        MT_TRY(rc);
    }
    if (left > 0) {
        mt_warnings_left_out(left, found);
    }
    return MT_OK;
}

/* Add the messages of the analysis; the diagnostics of loading already hold warnings about
 * single numbers. */
static void add_messages(const mt_warning_list *found, const char *path,
                         mt_diagnostics *messages)
{
    mt_text text = {.s = NULL};
    for (int i = 0; i < found->n; i++) {
        const mt_warning *const d = &found->items[i];
        text.length = 0;
        mt_report_warning(d, false, &text);
        if (text.s != NULL && strstr(mt_diagnostics_text(messages), d->text) == NULL) {
            const mt_diagnostic_place place = {.file = d->file == NULL ? path : d->file,
                                               .line = d->line,
                                               .column = d->column,
                                               .pointer = d->pointer};
            mt_diagnostics_add(
                messages, d->level == MT_LEVEL_WARNING ? MT_SEVERITY_WARNING : MT_SEVERITY_NOTE,
                &place, text.s);
        }
    }
    messages->lines.failed = messages->lines.failed || text.failed;
    mt_text_free(&text);
}

/* What was read: warnings borrow its texts. */
typedef struct subject {
    mt_model *model;
    mt_study *study;
    mt_result *result;
    mt_vibration *profile;
    mt_arena mem; /* of a catalogue of aircraft */
} subject;

/* More goals or variables are not compiled by who only looks: each costs some derivatives. */
enum { MOST_TRIED = 200 };

/* Check a valid file against mechanics: each configuration, and each goal of a study. */
static mt_status examine_mechanics(const subject *s, const char *path, mt_diagnostics *messages,
                                   mt_warning_list *found, mt_err *err)
{
    mt_status rc = MT_OK;
    if (s->model != NULL) {
        rc = examine_model(s->model, found, err);
        return mt_err_in(err, rc, "%s", path);
    }
    if (s->study != NULL) {
        rc = mt_study_examine(s->study, NULL, MT_WARNINGS_WORK, found, err);
        if (rc == MT_OK && s->study->n_goals <= MOST_TRIED &&
            s->study->n_variables <= MOST_TRIED &&
            !mt_study_takes_more(s->study, MT_WARNINGS_WORK)) {
            rc = mt_problem_try(s->study, err);
        }
        mt_cli_place(s->study, path, rc, err, messages);
    }
    return rc;
}

/* Load the file by its kind; deletes the document. A model is made from the document; other
 * kinds read their files again, with those that they name. */
static mt_status load_document(int kind, mt_json *doc, const char *path,
                               const mt_io_options *opt, subject *s, mt_diagnostics *messages,
                               mt_err *err)
{
    mt_aircraft_list aircraft = {0};
    mt_status rc = MT_OK;
    if (kind == KIND_MODEL) {
        rc = mt_model_expand(doc, path, opt, NULL, err);
        rc = rc == MT_OK ? mt_model_from_json(doc, path, &s->model, err) : rc;
        mt_json_report(doc, path, messages);
        rc = messages->lines.failed ? mt_fail_memory(err) : rc;
    }
    mt_json_delete(doc);
    switch ((file_kind)kind) {
    case KIND_MODEL:
        break;
    case KIND_STUDY:
        rc = mt_study_load(path, opt, &s->study, messages, err);
        break;
    case KIND_RESULT:
        rc = mt_result_load(path, opt, &s->result, messages, err);
        break;
    case KIND_AIRCRAFT:
        rc = mt_arena_init(&s->mem, 0, err);
        rc = rc == MT_OK ? mt_aircraft_load(path, opt, &s->mem, &aircraft, messages, err) : rc;
        break;
    case KIND_PROFILE:
        rc = mt_vibration_load(path, opt, &s->profile, messages, err);
        break;
    case KIND_COUNT:
        break;
    }
    return rc;
}

/* What was told of files that were asked for, and of those that these name. */
typedef struct told_before {
    mt_diagnostics of_their_own;
    mt_diagnostics of_others;
} told_before;

/* What goes to standard output, whatever its form. */
typedef struct output {
    mt_format format;
    mt_json_writer w;
    mt_table table;
    mt_text *text;
    int left_out; /* problems of all files that are not told */
    told_before told;
} output;

/* A file that was checked. */
typedef struct checked_row {
    const char *file;
    const char *kind;
    bool ok;
    int n_problems;
    file_problem *problems;
    int left_out;
    int n_warnings;
    mt_warning *warnings;
    int n_notes;
    mt_warning *notes;
} checked_row;

#define THIS checked_row
static const mt_field checked_fields[] = {
    MT_F_TEXT("file", file, "The file, as it was given."),
    MT_F_CHOICE_OR_NULL("kind", kind, kinds, "What its format says; null: that is unknown."),
    MT_F_FLAG("ok", ok, "It has no error."),
    MT_F_LIST(
        "problems", problems, n_problems, file_problem, problem_record,
        "Its problems and those of the files that it names; what was told of a file before "
        "it is left out."),
    MT_F_COUNT("left_out", left_out, 0, "How many more there are."),
    MT_F_LIST("doubts", warnings, n_warnings, mt_warning, mt_warning_record,
              "What is suspicious about its configurations."),
    MT_F_LIST("facts", notes, n_notes, mt_warning, mt_warning_record,
              "What to know of its configurations."),
};
static const mt_record checked_record =
    MT_F_RECORD_OF(checked_fields, "file", "A file that was checked.");
static const mt_record_column checked_columns[] = {
    MT_R_COLUMN(file, "file", 0, MT_IN_CSV),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_CSV),
    MT_R_COLUMN(ok, "ok", 0, MT_IN_CSV),
};
static const mt_record_table checked_rows = MT_R_TABLE_OF(checked_record, checked_columns);
#undef THIS

/* The messages, each with its place, or the failure where no message is an error; in mem. */
static void list_problems(const char *path, const mt_diagnostics *messages, const char *failure,
                          mt_arena *mem, checked_row *out)
{
    const int count = mt_diagnostics_count(messages);
    out->problems = mt_arena_alloc(mem, (size_t)count + 1, sizeof *out->problems);
    out->left_out = mt_diagnostics_left_out(messages);
    if (mt_arena_failed(mem)) {
        return;
    }
    for (int i = 0; i < count; i++) {
        const int line = mt_diagnostics_line(messages, i);
        out->problems[out->n_problems++] =
            (file_problem){.severity = mt_diagnostics_severity(messages, i),
                           .file = mt_diagnostics_file(messages, i),
                           .line = line,
                           .column = line > 0 ? mt_diagnostics_column(messages, i) : 0,
                           .pointer = mt_diagnostics_pointer(messages, i),
                           .message = mt_diagnostics_message(messages, i)};
    }
    if (failure != NULL && mt_diagnostics_first_error(messages) < 0) {
        out->problems[out->n_problems++] =
            (file_problem){.unread = true, .file = path, .message = failure};
    }
}

/* Write what was found of one file; lists lie in mem. */
static void put_file(output *to, checked_row *row, const mt_diagnostics *messages,
                     const mt_warning_list *found, const char *failure, mt_arena *mem)
{
    switch (to->format) {
    case MT_FORMAT_JSON:
        list_problems(row->file, messages, failure, mem, row);
        row->warnings = mt_warning_pick(found, MT_LEVEL_WARNING, mem, &row->n_warnings);
        row->notes = mt_warning_pick(found, MT_LEVEL_NOTE, mem, &row->n_notes);
        if (!mt_arena_failed(mem)) {
            mt_record_put_object(&to->w, NULL, &checked_record, row, 0, NULL);
        }
        break;
    case MT_FORMAT_SARIF:
        list_problems(row->file, messages, failure, mem, row);
        for (int i = 0; i < row->n_problems; i++) {
            sarif_put(&to->w, &row->problems[i]);
        }
        to->left_out += row->left_out;
        break;
    case MT_FORMAT_CSV:
        mt_table_record_row(&to->table, &checked_rows, MT_IN_CSV, row);
        break;
    case MT_FORMAT_HTML: /* of report alone */
    case MT_FORMAT_TEXT:
        if (row->ok) {
            mt_text_addf(to->text, "%s: ok (%s)\n", row->file, row->kind);
        }
        break;
    }
    to->text->failed = to->text->failed || mt_arena_check(mem, NULL) != MT_OK;
}

/* True where both messages are the same at the same place of the same file, given by any
 * path. */
static bool is_same_message(const mt_diagnostics *a, int i, const mt_diagnostics *b, int k)
{
    if (mt_diagnostics_line(a, i) != mt_diagnostics_line(b, k) ||
        mt_diagnostics_column(a, i) != mt_diagnostics_column(b, k) ||
        strcmp(mt_diagnostics_message(a, i), mt_diagnostics_message(b, k)) != 0) {
        return false;
    }
    char *const one = mt_files_normal(mt_diagnostics_file(a, i));
    char *const other = mt_files_normal(mt_diagnostics_file(b, k));
    const bool same = one != NULL && other != NULL && strcmp(one, other) == 0;
    free(one);
    free(other);
    return same;
}

static bool is_told(const mt_diagnostics *messages, int i, const mt_diagnostics *told)
{
    for (int k = 0; k < mt_diagnostics_count(told); k++) {
        if (is_same_message(messages, i, told, k)) {
            return true;
        }
    }
    return false;
}

/* Leave out messages given already: a study's model may be checked itself, and several studies
 * may have the same model. The new ones are kept and appended to those given. */
static void leave_told(const mt_diagnostics *messages, const char *path, told_before *told,
                       mt_diagnostics *fresh)
{
    for (int i = 0; i < mt_diagnostics_count(messages); i++) {
        const bool own = strcmp(mt_diagnostics_file(messages, i), path) == 0;
        const bool again = is_told(messages, i, &told->of_others) ||
                           (!own && is_told(messages, i, &told->of_their_own));
        const mt_diagnostic_place place = {.file = mt_diagnostics_file(messages, i),
                                           .line = mt_diagnostics_line(messages, i),
                                           .column = mt_diagnostics_column(messages, i),
                                           .pointer = mt_diagnostics_pointer(messages, i)};
        if (!again) {
            mt_diagnostics_add(fresh, mt_diagnostics_severity(messages, i), &place,
                               mt_diagnostics_message(messages, i));
            mt_diagnostics_add(own ? &told->of_their_own : &told->of_others,
                               mt_diagnostics_severity(messages, i), &place,
                               mt_diagnostics_message(messages, i));
        }
    }
    if (mt_diagnostics_first_error(messages) >= 0 && mt_diagnostics_first_error(fresh) < 0) {
        const mt_diagnostic_place place = {.file = path};
        mt_diagnostics_add(fresh, MT_SEVERITY_ERROR, &place,
                           "the errors of its model are listed above");
    }
    if (mt_diagnostics_left_out(messages) > 0) {
        mt_diagnostics_leave_out(fresh, path, mt_diagnostics_left_out(messages));
    }
    fresh->lines.failed = fresh->lines.failed || messages->lines.failed ||
                          told->of_others.lines.failed || told->of_their_own.lines.failed;
}

static int check_file(const mt_args *args, const char *path, output *to)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    int kind = KIND_COUNT;
    mt_arena mem = {.first = NULL};
    mt_warning_list found = mt_warning_list_default(&mem);
    subject read = {.model = NULL};
    mt_json *doc = NULL;
    mt_status rc = mt_arena_init(&mem, 0, &err);
    rc = rc == MT_OK ? find_kind(path, &opt, &kind, &doc, &messages, &err) : rc;
    rc = rc == MT_OK ? load_document(kind, doc, path, &opt, &read, &messages, &err) : rc;
    rc = rc == MT_OK ? examine_mechanics(&read, path, &messages, &found, &err) : rc;
    add_messages(&found, path, &messages);
    mt_diagnostics fresh = {.count = 0};
    leave_told(&messages, path, &to->told, &fresh);
    checked_row row = {
        .file = path, .kind = kind == KIND_COUNT ? NULL : kinds[kind], .ok = rc == MT_OK};
    put_file(to, &row, &fresh, &found, rc == MT_OK ? NULL : err.text, &mem);
    mt_arena_free(&read.mem);
    mt_model_delete(read.model);
    mt_study_delete(read.study);
    mt_result_delete(read.result);
    mt_vibration_delete(read.profile);
    mt_arena_free(&mem);
    mt_diagnostics_free(&messages);
    return mt_cli_loaded(rc, &fresh, &err);
}

static int run_check(const mt_args *args, mt_text *out)
{
    const bool sarif = args->format == MT_FORMAT_SARIF;
    const bool json = args->format == MT_FORMAT_JSON;
    output to = {.format = args->format,
                 .w = mt_json_writer_default(out),
                 .table = mt_table_default(),
                 .text = out};
    int code = MT_EXIT_DONE;
    mt_table_record_columns(&to.table, &checked_rows, MT_IN_CSV);
    if (json) {
        mt_json_open(&to.w, NULL, '[');
    } else if (sarif) {
        sarif_begin(&to.w);
    }
    for (int i = 0; i < args->n_operands; i++) {
        code = mt_exit_worse(code, check_file(args, args->operands[i], &to));
    }
    if (json) {
        mt_json_close(&to.w);
    } else if (sarif) {
        sarif_end(&to.w, code, to.left_out);
    }
    if (json || sarif) {
        code = mt_exit_worse(code, mt_cli_json_done(&to.w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
    mt_table_free(&to.table);
    mt_diagnostics_free(&to.told.of_their_own);
    mt_diagnostics_free(&to.told.of_others);
    return code;
}

const mt_command mt_command_check = {
    .name = "check",
    .operands = "FILE...",
    .least = 1,
    .most = -1,
    .summary = "validate model, study, result, aircraft and profile files",
    .details =
        "Reads each file by its \"format\" and prints every problem as file:line:column: "
        "error: /json/pointer: message.\n"
        "Warnings concern suspicious values: numbers that look like other units, joints "
        "off their links, bands that no mode comes near. Notes state what to know of every "
        "configuration, or of those that a study names: free motions, unstable directions, "
        "redundant joints.\n"
        "--format json has the same by members (file, line, column, pointer, severity, "
        "message), --format sarif as SARIF 2.1.0 for code hosts and editors. Paths are "
        "relative to the current folder, which should be that of the repository.",
    .answer = {&checked_record, MT_ANSWER_LIST},
    .run = run_check,
};
