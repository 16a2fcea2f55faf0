/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * result.json: everything that a study answered, and nothing about where, when or with how many
 * workers. What is written, and under which name, stands in the tables of the result.
 */
#include "result/write.h"

#include <string.h>

/* Names of the variables, for values that are written by them. */
typedef struct names {
    int n;
    const char *const *items;
} names;

static void put_record(mt_json_writer *w, const char *name, const mt_record *record, bool flat,
                       const void *item, const names *variables);
static void put_members(mt_json_writer *w, const char *name, const mt_record *record,
                        const void *item, const names *variables);

static void put_list(mt_json_writer *w, const mt_field *f, const void *items, int n,
                     const names *variables)
{
    if (items == NULL && f->nullable) {
        mt_json_put_null(w, f->name);
        return;
    }
    mt_json_open(w, f->name, '[');
    for (int i = 0; i < n; i++) {
        put_record(w, NULL, f->record, f->flat,
                   (const char *)items + ((size_t)i * f->record->size), variables);
    }
    mt_json_close(w);
}

static void put_texts(mt_json_writer *w, const mt_field *f, const char *const *items, int n)
{
    if (f->flat) {
        mt_json_open_flat(w, f->name, '[');
    } else {
        mt_json_open(w, f->name, '[');
    }
    for (int i = 0; i < n; i++) {
        mt_json_put_string(w, NULL, items[i]);
    }
    mt_json_close(w);
}

static void put_numbers(mt_json_writer *w, const mt_field *f, const double *items, int n,
                        int step)
{
    mt_json_open_flat(w, f->name, '[');
    for (int i = 0; i < n; i++) {
        const double value = items[(ptrdiff_t)i * step];
        if (f->digits > 0) {
            mt_json_put_rounded(w, NULL, value, f->digits);
        } else {
            mt_json_put_number(w, NULL, value);
        }
    }
    mt_json_close(w);
}

static void put_by_variable(mt_json_writer *w, const char *name, const double *values,
                            const names *variables)
{
    if (values == NULL) {
        mt_json_put_null(w, name);
        return;
    }
    mt_json_open(w, name, '{');
    for (int i = 0; i < variables->n; i++) {
        mt_json_put_number(w, variables->items[i], values[i]);
    }
    mt_json_close(w);
}

/* Less than the least is unknown: null, or of a file that lacks it nothing. */
static void put_long(mt_json_writer *w, const mt_field *f, long value)
{
    if (value >= f->least || (!f->nullable && !f->later)) {
        mt_json_put_integer(w, f->name, value);
    } else if (f->nullable) {
        mt_json_put_null(w, f->name);
    }
}

static void put_value(mt_json_writer *w, const mt_field *f, const void *item)
{
    double value = 0.0;
    memcpy(&value, (const char *)item + f->offset, sizeof value);
    const char *const text = mt_record_get_pointer((const char *)item + f->other);
    if (text != NULL) {
        mt_json_put_string(w, f->name, text);
    } else if (f->logical && *(const bool *)((const char *)item + f->truth)) {
        mt_json_put_bool(w, f->name, value != 0.0);
    } else {
        mt_json_put_number(w, f->name, value);
    }
}

static void put_field(mt_json_writer *w, const mt_field *f, const void *item,
                      const names *variables)
{
    const void *const at = (const char *)item + f->offset;
    const void *const other = (const char *)item + f->other;
    switch (f->type) {
    case MT_FIELD_FORMAT:
        mt_json_put_string(w, f->name, f->format);
        break;
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
        if (f->nullable || !f->later || mt_record_get_pointer(at) != NULL) {
            mt_json_put_string(w, f->name, mt_record_get_pointer(at));
        }
        break;
    case MT_FIELD_ENUM:
        mt_json_put_string(w, f->name, f->choices[*(const unsigned *)at]);
        break;
    case MT_FIELD_VALUE:
        put_value(w, f, item);
        break;
    case MT_FIELD_NUMBER:
        mt_json_put_number(w, f->name, *(const double *)at);
        break;
    case MT_FIELD_COUNT:
        if (f->nullable && *(const int *)at < f->least) {
            mt_json_put_null(w, f->name);
            break;
        }
        mt_json_put_integer(w, f->name, *(const int *)at);
        break;
    case MT_FIELD_LONG:
        put_long(w, f, *(const long *)at);
        break;
    case MT_FIELD_FLAG:
        mt_json_put_bool(w, f->name, *(const bool *)at);
        break;
    case MT_FIELD_RECORD:
        put_record(w, f->name, f->record, f->flat, at, variables);
        break;
    case MT_FIELD_OPTION:
        put_record(w, f->name, f->record, f->flat, mt_record_get_pointer(at), variables);
        break;
    case MT_FIELD_LIST:
        put_list(w, f, mt_record_get_pointer(at), *(const int *)other, variables);
        break;
    case MT_FIELD_TEXTS:
        put_texts(w, f, mt_record_get_pointer(at), *(const int *)other);
        break;
    case MT_FIELD_NUMBERS:
        put_numbers(w, f, mt_record_get_pointer(at), *(const int *)other,
                    f->strided ? *(const int *)(const void *)((const char *)item + f->step)
                               : 1);
        break;
    case MT_FIELD_BY_VARIABLE:
        put_by_variable(w, f->name, mt_record_get_pointer(at), variables);
        break;
    case MT_FIELD_TYPE_COUNT:
        break;
    }
}

/* The members of that name; NULL: all of them. */
static void put_members(mt_json_writer *w, const char *name, const mt_record *record,
                        const void *item, const names *variables)
{
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        const bool there = !f->optional || *(const bool *)((const char *)item + f->when);
        if (there && f->name != NULL && (name == NULL || strcmp(f->name, name) == 0)) {
            put_field(w, f, item, variables);
        }
    }
}

static void put_record(mt_json_writer *w, const char *name, const mt_record *record, bool flat,
                       const void *item, const names *variables)
{
    if (item == NULL) {
        mt_json_put_null(w, name);
        return;
    }
    if (record->bare) {
        mt_field value = record->fields[0];
        value.name = name;
        put_field(w, &value, item, variables);
        return;
    }
    if (flat) {
        mt_json_open_flat(w, name, '{');
    } else {
        mt_json_open(w, name, '{');
    }
    put_members(w, NULL, record, item, variables);
    mt_json_close(w);
}

void mt_record_put(mt_json_writer *w, const mt_record *record, const void *item)
{
    const names none = {0, NULL};
    put_members(w, NULL, record, item, &none);
}

void mt_record_put_object(mt_json_writer *w, const char *name, const mt_record *record,
                          const void *item, int n, const char *const *of)
{
    const names variables = {n, of};
    put_record(w, name, record, false, item, &variables);
}

void mt_json_put_warnings(mt_json_writer *w, const char *name, const mt_warning_list *list,
                          mt_warning_level level)
{
    const names none = {0, NULL};
    mt_json_open(w, name, '[');
    for (int i = 0; i < list->n; i++) {
        if (list->items[i].level == level) {
            put_record(w, NULL, &mt_warning_record, false, &list->items[i], &none);
        }
    }
    mt_json_close(w);
}

void mt_result_put_member(mt_json_writer *w, const char *name, const mt_result *result)
{
    const names variables = {result->n_variables, result->variables};
    put_members(w, name, &mt_result_record, result, &variables);
}

void mt_design_put_member(mt_json_writer *w, const char *name, const mt_result *result,
                          const mt_recommendation *design)
{
    const names variables = {result->n_variables, result->variables};
    put_members(w, name, &mt_design_record, design, &variables);
}

void mt_result_put(mt_json_writer *w, const char *name, const mt_result *result)
{
    mt_json_open(w, name, '{');
    mt_result_put_member(w, NULL, result);
    mt_json_close(w);
}

mt_status mt_result_write(const mt_result *result, mt_text *out, mt_err *err)
{
    mt_json_writer writer = mt_json_writer_default(out);
    mt_result_put(&writer, NULL, result);
    if (mt_json_done(&writer)) {
        return MT_OK;
    }
    return writer.misused ? mt_fail(err, MT_E_INTERNAL, "the result cannot be written as JSON")
                          : mt_fail_memory(err);
}
