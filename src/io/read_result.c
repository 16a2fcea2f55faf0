/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result read back: what `apply` needs. Members that are not looked at may be anything, so
 * that later versions can add some. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/folder.h"
#include "io/io.h"
#include "io/reader.h"

enum { READER_PATIENCE_MS = 10000 };

typedef struct result_reader {
    mt_reader r;
    mt_result *result;
} result_reader;

/* A member that must be there and of the given type; MT_NO_ADDR where it is not (noted). */
static mt_addr need(result_reader *s, mt_addr object, const char *name, mt_key_type type)
{
    const mt_addr value = mt_json_member(s->r.doc, object, name);
    if (value == MT_NO_ADDR && object != MT_NO_ADDR) {
        mt_diag_structure(s->r.diags, object, "member \"%s\" is missing", name);
    }
    return mt_reader_type(&s->r, value, type) ? value : MT_NO_ADDR;
}

/* A number; NaN for null, absent or wrong (noted). */
static double number(result_reader *s, mt_addr object, const char *name)
{
    const mt_addr value = need(s, object, name, MT_KEY_ANY);
    const mt_json_type type =
        value == MT_NO_ADDR ? MT_JSON_NULL : mt_json_type_of(s->r.doc, value);
    if (type == MT_JSON_NUMBER) {
        return mt_json_number(s->r.doc, value);
    }
    if (type != MT_JSON_NULL) {
        mt_diag_structure(s->r.diags, value, "must be a number or null, not %s",
                          mt_json_type_text(type));
    }
    return nan("");
}

/* A text; NULL for null, absent or wrong (noted). */
static const char *text(result_reader *s, mt_addr object, const char *name)
{
    const mt_addr value = need(s, object, name, MT_KEY_ANY);
    if (value == MT_NO_ADDR || mt_json_type_of(s->r.doc, value) == MT_JSON_NULL) {
        return NULL;
    }
    return mt_reader_text(&s->r, value);
}

static void read_parameter(result_reader *s, mt_addr value, mt_result_parameter *p)
{
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return;
    }
    p->name = mt_reader_text(&s->r, need(s, value, "name", MT_KEY_TEXT));
    p->unit = text(s, value, "unit");
    p->original = number(s, value, "original");
    p->recommended = number(s, value, "recommended");
    p->change_percent = number(s, value, "change_percent");
    p->at_bound = text(s, value, "at_bound");
}

static int by_name(const void *a, const void *b)
{
    const mt_name *const x = a;
    const mt_name *const y = b;
    const int order = strcmp(x->s, y->s);
    return order != 0 ? order : (x->addr > y->addr) - (x->addr < y->addr);
}

/* A design gives a parameter one value. */
static void refuse_twice(result_reader *s, mt_addr list, int most)
{
    if (most < 2) {
        return;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&s->result->mem);
    mt_name *const names = mt_arena_alloc(&s->result->mem, (size_t)most, sizeof *names);
    int n = 0;
    s->r.out_of_memory = s->r.out_of_memory || names == NULL;
    for (mt_items i = mt_reader_items(&s->r, list); names != NULL && mt_items_next(&i);) {
        const mt_addr name = mt_json_type_of(s->r.doc, i.at) == MT_JSON_OBJECT
                                 ? mt_json_member(s->r.doc, i.at, "name")
                                 : MT_NO_ADDR;
        if (n < most && name != MT_NO_ADDR &&
            mt_json_type_of(s->r.doc, name) == MT_JSON_STRING) {
            names[n++] = (mt_name){.s = mt_json_string(s->r.doc, name), .addr = name};
        }
    }
    if (n > 0) {
        qsort(names, (size_t)n, sizeof *names, by_name);
    }
    for (int i = 1; i < n; i++) {
        if (strcmp(names[i].s, names[i - 1].s) == 0) {
            mt_diag_error(s->r.diags, names[i].addr, "\"%s\" is listed twice", names[i].s);
        }
    }
    mt_arena_rewind(&s->result->mem, mark);
}

static void read_design(result_reader *s, mt_addr value, mt_recommendation *out)
{
    *out = mt_recommendation_default();
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return;
    }
    out->rank = mt_reader_count(&s->r, need(s, value, "rank", MT_KEY_COUNT), 0, MT_MAX_LIST, 0);
    out->feasible = mt_reader_flag(&s->r, need(s, value, "feasible", MT_KEY_BOOL), false);
    out->grade = text(s, value, "grade");
    out->score = number(s, value, "score");
    out->score_unit = text(s, value, "score_unit");
    out->change = number(s, value, "change");
    out->misfit = number(s, value, "misfit");
    out->violation_percent = number(s, value, "violation_percent");
    const mt_addr list = need(s, value, "parameters", MT_KEY_LIST);
    mt_items items = mt_reader_items(&s->r, list);
    out->parameters = mt_reader_room(&s->r, &items, sizeof *out->parameters);
    while (mt_items_next(&items)) {
        read_parameter(s, items.at, &out->parameters[out->n_parameters++]);
    }
    refuse_twice(s, list, out->n_parameters);
}

static void read_recommendations(result_reader *s, mt_addr list)
{
    mt_result *const result = s->result;
    mt_items items = mt_reader_items(&s->r, list);
    result->recommendations = mt_reader_room(&s->r, &items, sizeof *result->recommendations);
    while (mt_items_next(&items)) {
        read_design(s, items.at, &result->recommendations[result->n_recommendations++]);
    }
}

/* Files and their digests; returns how many. */
static int read_digests(result_reader *s, mt_addr list, const char ***names,
                        const char ***sha256)
{
    int n = 0;
    mt_items items = mt_reader_items(&s->r, list);
    *names = mt_reader_room(&s->r, &items, sizeof **names);
    *sha256 = mt_reader_room(&s->r, &items, sizeof **sha256);
    while (mt_items_next(&items)) {
        if (mt_reader_type(&s->r, items.at, MT_KEY_OBJECT)) {
            (*names)[n] = mt_reader_text(&s->r, need(s, items.at, "file", MT_KEY_TEXT));
            (*sha256)[n] = mt_reader_text(&s->r, need(s, items.at, "sha256", MT_KEY_TEXT));
            n++;
        }
    }
    return n;
}

static void read_run(result_reader *s, mt_addr value)
{
    mt_result_run *const run = &s->result->run;
    run->modetune_version = text(s, value, "modetune");
    run->n_inputs = read_digests(s, need(s, value, "inputs", MT_KEY_LIST), &run->input_names,
                                 &run->input_sha256);
    /* results of version 0.1.0 and before name no outputs */
    const bool has =
        value != MT_NO_ADDR && mt_json_member(s->r.doc, value, "outputs") != MT_NO_ADDR;
    run->n_outputs = !has ? 0
                          : read_digests(s, need(s, value, "outputs", MT_KEY_LIST),
                                         &run->output_names, &run->output_sha256);
}

static void read_named_file(result_reader *s, const char *member, const char **name,
                            const char **file)
{
    const mt_addr object = need(s, MT_JSON_ROOT, member, MT_KEY_OBJECT);
    *name = text(s, object, "name");
    *file = mt_reader_text(&s->r, need(s, object, "file", MT_KEY_TEXT));
}

static void read_root(result_reader *s)
{
#define STATUS_NAME(id, name) name,
    static const char *const statuses[] = {MT_RESULT_STATUS_LIST(STATUS_NAME)};
#undef STATUS_NAME
    static const char *const formats[] = {"modetune-result/1"};
    mt_result *const result = s->result;
    if (!mt_reader_type(&s->r, MT_JSON_ROOT, MT_KEY_OBJECT)) {
        return;
    }
    (void)mt_reader_choice(&s->r, need(s, MT_JSON_ROOT, "format", MT_KEY_TEXT), "format",
                           formats, MT_COUNT(formats));
    read_named_file(s, "study", &result->study_name, &result->study_file);
    read_named_file(s, "model", &result->model_name, &result->model_file);
    const int status = mt_reader_choice(&s->r, need(s, MT_JSON_ROOT, "status", MT_KEY_TEXT),
                                        "status", statuses, MT_COUNT(statuses));
    result->status = status == MT_ABSENT ? MT_RESULT_INTERRUPTED : (mt_result_status)status;
    result->status_text = text(s, MT_JSON_ROOT, "status_text");
    read_design(s, need(s, MT_JSON_ROOT, "baseline", MT_KEY_OBJECT), &result->baseline);
    read_recommendations(s, need(s, MT_JSON_ROOT, "recommendations", MT_KEY_LIST));
    read_run(s, need(s, MT_JSON_ROOT, "run", MT_KEY_OBJECT));
}

static mt_status read_text(result_reader *s, const char *path, const mt_file *file,
                           mt_text *messages, mt_err *err)
{
    mt_json *doc = NULL;
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (doc == NULL) {
        return rc;
    }
    s->r.doc = doc;
    s->r.diags = mt_json_diags(doc);
    s->r.mem = &s->result->mem;
    if (rc == MT_OK) {
        read_root(s);
    }
    rc = mt_reader_status(&s->r, path, err);
    if (messages != NULL) {
        mt_json_print(doc, path, messages);
        rc = messages->failed ? mt_fail_memory(err) : rc;
    }
    mt_json_delete(doc);
    return rc;
}

/* The file by itself; sha256 of its bytes. */
static mt_status load_alone(const char *path, const mt_io_options *opt, mt_result **out,
                            char sha256[MT_SHA256_TEXT], mt_text *messages, mt_err *err)
{
    const size_t limit =
        opt == NULL || opt->max_bytes == 0 ? MT_JSON_MAX_BYTES : opt->max_bytes;
    mt_file file = {0};
    result_reader s = {.result = NULL};
    *out = NULL;
    mt_status rc = mt_result_new(&s.result, err);
    if (rc == MT_OK) {
        rc = mt_file_read(path, NULL, limit, &file, err);
    }
    if (rc == MT_OK) {
        memcpy(sha256, file.sha256, MT_SHA256_TEXT);
        rc = read_text(&s, path, &file, messages, err);
    }
    mt_file_free(&file);
    if (rc != MT_OK) {
        mt_result_delete(s.result);
        return rc;
    }
    *out = s.result;
    return MT_OK;
}

/* Read once more while no run writes: what did not fit together may have been half replaced. */
static mt_status load_locked(const char *path, const mt_io_options *opt, mt_result **out,
                             mt_text *messages, mt_err *err)
{
    char sha256[MT_SHA256_TEXT];
    char *const folder = mt_file_folder(path);
    if (folder == NULL) {
        return mt_fail_memory(err);
    }
    int lock = -1;
    mt_status rc = mt_folder_lock(folder, true, READER_PATIENCE_MS, &lock, err);
    free(folder);
    rc = rc == MT_OK ? load_alone(path, opt, out, sha256, messages, err) : rc;
    if (rc == MT_OK && mt_result_has_folder(path, *out)) {
        rc = mt_result_check_folder(path, sha256, *out, err);
    }
    mt_folder_unlock(lock);
    return rc;
}

mt_status mt_result_load(const char *path, const mt_io_options *opt, mt_result **out,
                         mt_text *messages, mt_err *err)
{
    char sha256[MT_SHA256_TEXT];
    mt_status rc = load_alone(path, opt, out, sha256, messages, err);
    if (rc == MT_OK && mt_result_has_folder(path, *out)) {
        rc = mt_result_check_folder(path, sha256, *out, err);
        if (rc == MT_E_INPUT) {
            mt_result_delete(*out);
            *out = NULL;
            rc = load_locked(path, opt, out, messages, err);
        }
    }
    if (rc != MT_OK) {
        mt_result_delete(*out);
        *out = NULL;
    }
    return rc;
}
