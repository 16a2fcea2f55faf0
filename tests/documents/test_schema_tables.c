/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Each reader's table of keys holds the members of the schema's definition of the same name:
 * names, which are required, and types. The tables of a result cover its structs.
 */
#include <string.h>

#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "model/read.h"
#include "mt_test.h"
#include "result/result.h"
#include "study/read.h"

enum { SCHEMA_LIMIT = 1 << 20 };

static bool is_required(const mt_json *doc, mt_addr object, const char *name)
{
    const mt_addr list = mt_json_member(doc, object, "required");
    for (mt_addr i = list == MT_NO_ADDR ? MT_NO_ADDR : mt_json_first(doc, list);
         i != MT_NO_ADDR; i = mt_json_next(doc, i)) {
        if (strcmp(mt_json_string(doc, i), name) == 0) {
            return true;
        }
    }
    return false;
}

static mt_addr resolved(const mt_json *doc, mt_addr schema);

/* Does what a schema allows hold numbers of its own, in itself, in a list or as members of free
 * names? An object with properties has a table of its own. */
static bool holds_numbers(const mt_json *doc, mt_addr schema)
{
    static const char *const several[] = {"anyOf", "oneOf"};
    static const char *const parts[] = {"items", "additionalProperties", "then", "else"};
    const mt_addr at = resolved(doc, schema);
    if (mt_json_type_of(doc, at) != MT_JSON_OBJECT ||
        mt_json_member(doc, at, "properties") != MT_NO_ADDR) {
        return false;
    }
    const mt_addr type = mt_json_member(doc, at, "type");
    const bool list = type != MT_NO_ADDR && mt_json_type_of(doc, type) == MT_JSON_ARRAY;
    for (mt_addr i = list ? mt_json_first(doc, type) : type; i != MT_NO_ADDR;
         i = list ? mt_json_next(doc, i) : MT_NO_ADDR) {
        if (strcmp(mt_json_string(doc, i), "number") == 0 ||
            strcmp(mt_json_string(doc, i), "integer") == 0) {
            return true;
        }
    }
    for (int k = 0; k < MT_COUNT(several); k++) {
        const mt_addr any = mt_json_member(doc, at, several[k]);
        for (mt_addr i = any == MT_NO_ADDR ? any : mt_json_first(doc, any); i != MT_NO_ADDR;
             i = mt_json_next(doc, i)) {
            if (holds_numbers(doc, i)) {
                return true;
            }
        }
    }
    for (int k = 0; k < MT_COUNT(parts); k++) {
        const mt_addr part = mt_json_member(doc, at, parts[k]);
        if (part != MT_NO_ADDR && holds_numbers(doc, part)) {
            return true;
        }
    }
    return false;
}

static void check_table(mt_test *t, const mt_json *doc, const mt_key_table *table)
{
    const mt_addr definitions = mt_json_member(doc, MT_JSON_ROOT, "definitions");
    const mt_addr object =
        *table->what == '\0' ? MT_JSON_ROOT : mt_json_member(doc, definitions, table->what);
    const mt_addr properties =
        object == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(doc, object, "properties");
    mt_test_row(t, "definition \"%s\"", table->what);
    if (!CHECK(t, properties != MT_NO_ADDR)) {
        return;
    }
    CHECK_INT(t, mt_json_count(doc, properties), table->n);
    CHECK(t, table->n <= MT_MAX_KEYS);
    for (int i = 0; i < table->n; i++) {
        const char *const name = table->keys[i].name;
        mt_test_row(t, "definition \"%s\", member \"%s\"", table->what, name);
        CHECK(t, mt_json_member(doc, properties, name) != MT_NO_ADDR);
        CHECK(t, is_required(doc, object, name) == table->keys[i].required);
        /* a row of what is possible, for numbers and for nothing else */
        const mt_addr member = mt_json_member(doc, properties, name);
        CHECK(t, (table->keys[i].possible != MT_POSSIBLE_NONE) ==
                     (member != MT_NO_ADDR && holds_numbers(doc, member)));
    }
}

/* The schema that a reference, or an "allOf" of one, stands for. */
static mt_addr resolved(const mt_json *doc, mt_addr schema)
{
    const mt_addr all = mt_json_member(doc, schema, "allOf");
    const mt_addr at = all == MT_NO_ADDR ? schema : mt_json_first(doc, all);
    const mt_addr reference = mt_json_member(doc, at, "$ref");
    const mt_addr definitions = mt_json_member(doc, MT_JSON_ROOT, "definitions");
    return reference == MT_NO_ADDR
               ? at
               : mt_json_member(doc, definitions,
                                strrchr(mt_json_string(doc, reference), '/') + 1);
}

/* Sizes as a struct has them: the next member begins where the one before ends, but for
 * alignment. */
static size_t size_of_field(const mt_field *f)
{
    static const size_t sizes[MT_FIELD_TYPE_COUNT] = {
        [MT_FIELD_TEXT] = sizeof(char *),       [MT_FIELD_CHOICE] = sizeof(char *),
        [MT_FIELD_ENUM] = sizeof(int),          [MT_FIELD_NUMBER] = sizeof(double),
        [MT_FIELD_VALUE] = sizeof(double),      [MT_FIELD_COUNT] = sizeof(int),
        [MT_FIELD_LONG] = sizeof(long),         [MT_FIELD_FLAG] = sizeof(bool),
        [MT_FIELD_OPTION] = sizeof(void *),     [MT_FIELD_LIST] = sizeof(void *),
        [MT_FIELD_TEXTS] = sizeof(void *),      [MT_FIELD_NUMBERS] = sizeof(void *),
        [MT_FIELD_BY_VARIABLE] = sizeof(void *)};
    return f->type == MT_FIELD_RECORD ? f->record->size : sizes[f->type];
}

enum { LARGEST = 4096 };

static void check_cover(mt_test *t, const mt_record *record)
{
    bool covered[LARGEST] = {false};
    REQUIRE(t, record->size <= LARGEST);
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        const bool two = f->other != 0 || f->type == MT_FIELD_LIST ||
                         f->type == MT_FIELD_TEXTS || f->type == MT_FIELD_NUMBERS;
        const size_t second = f->type == MT_FIELD_VALUE ? sizeof(char *) : sizeof(int);
        for (size_t k = 0; k < size_of_field(f); k++) {
            covered[f->offset + k] = true;
        }
        for (size_t k = 0; two && k < second; k++) {
            covered[f->other + k] = true;
        }
        mt_test_row(t, "below member \"%s\"", f->name == NULL ? "" : f->name);
        if (f->record != NULL && f->record != &mt_warning_record) {
            check_cover(t, f->record);
        }
    }
    size_t hole = 0;
    for (size_t k = 0; k < record->size; k++) {
        const bool begins = !covered[k] && (k == 0 || covered[k - 1]);
        hole = covered[k] ? 0 : begins ? 1 : hole + 1;
        CHECK(t, hole < sizeof(void *));
        CHECK(t, !begins || k % sizeof(int) != 0 || k % sizeof(void *) != 0);
    }
}

/* A member that no table has would be forgotten by writer, reader and copier: but for padding,
 * the fields cover every struct. */
static void tables__cover_the_structs_of_a_result(mt_test *t)
{
    check_cover(t, &mt_design_record);
    for (int i = 0; i < mt_result_record.n; i++) {
        const mt_record *const r = mt_result_record.fields[i].record;
        if (r != NULL && r != &mt_warning_record) {
            mt_test_row(t, "\"%s\"", mt_result_record.fields[i].name);
            check_cover(t, r);
        }
    }
}

static void check_schema(mt_test *t, const char *path, const mt_key_table *const *tables, int n)
{
    mt_file file = {0};
    mt_json *doc = NULL;
    mt_test_row(t, "%s", path);
    REQUIRE(t, mt_file_read(path, NULL, SCHEMA_LIMIT, &file, NULL) == MT_OK);
    CHECK_INT(t, mt_json_parse(file.bytes, file.length, &doc, NULL), MT_OK);
    CHECK(t, n > 1);
    for (int i = 0; i < n && doc != NULL; i++) {
        check_table(t, doc, tables[i]);
    }
    mt_json_delete(doc);
    mt_file_free(&file);
}

static void schema__has_the_members_of_the_model_reader(mt_test *t)
{
    int n = 0;
    const mt_key_table *const *const tables = mt_model_key_tables(&n);
    check_schema(t, MT_TEST_SOURCE_DIR "/schemas/model.schema.json", tables, n);
}

static void schema__has_the_members_of_the_study_reader(mt_test *t)
{
    int n = 0;
    const mt_key_table *const *const tables = mt_study_key_tables(&n);
    check_schema(t, MT_TEST_SOURCE_DIR "/schemas/study.schema.json", tables, n);
}

static void schema__has_the_members_of_the_aircraft_reader(mt_test *t)
{
    int n = 0;
    const mt_key_table *const *const tables = mt_aircraft_key_tables(&n);
    check_schema(t, MT_TEST_SOURCE_DIR "/schemas/aircraft.schema.json", tables, n);
}

static void schema__has_the_members_of_the_profile_reader(mt_test *t)
{
    int n = 0;
    const mt_key_table *const *const tables = mt_profile_key_tables(&n);
    check_schema(t, MT_TEST_SOURCE_DIR "/schemas/profile.schema.json", tables, n);
}

MT_TEST_MAIN(MT_TEST(schema__has_the_members_of_the_model_reader),
             MT_TEST(schema__has_the_members_of_the_study_reader),
             MT_TEST(schema__has_the_members_of_the_aircraft_reader),
             MT_TEST(schema__has_the_members_of_the_profile_reader),
             MT_TEST(tables__cover_the_structs_of_a_result))
