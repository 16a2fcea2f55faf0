/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The JSON Schemas of models, studies, profiles and catalogues of aircraft are written from the
 * tables that their readers go by: here their texts are made, and held against those of
 * schemas/. MT_SCHEMAS_UPDATE=1 writes them there (the target "schemas").
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "model/read.h"
#include "mt_test.h"
#include "study/read.h"

enum { WIDTH = 145, SCHEMA_LIMIT = 1 << 20 };

/* A text as JSON. */
static void add_string(mt_text *out, const char *s)
{
    mt_text_add(out, "\"");
    for (; *s != '\0'; s++) {
        if (*s == '"' || *s == '\\') {
            mt_text_add(out, "\\");
        }
        mt_text_add_n(out, s, 1);
    }
    mt_text_add(out, "\"");
}

/* "label": a text of the tables; a comma is before it. */
static void add_text(mt_text *out, const char *label, const char *text)
{
    if (text != NULL) {
        mt_text_addf(out, "\"%s\": ", label);
        add_string(out, text);
    }
}

static void add_texts(mt_text *out, const char *label, int n, const char *const *texts)
{
    mt_text_addf(out, "\"%s\": [", label);
    for (int i = 0; i < n; i++) {
        mt_text_add(out, i == 0 ? "" : ", ");
        add_string(out, texts[i]);
    }
    mt_text_add(out, "]");
}

static void add_reference(mt_text *out, const char *definition)
{
    mt_text_addf(out, "\"allOf\": [{\"$ref\": \"#/definitions/%s\"}]", definition);
}

/* A string, or each of a list. */
static void add_string_type(mt_text *out, const mt_key *key)
{
    mt_text_add(out, "\"type\": \"string\"");
    mt_text_add(out, key->pattern == NULL ? "" : ", ");
    add_text(out, "pattern", key->pattern);
    if (key->choices != NULL) {
        mt_text_add(out, ", ");
        add_texts(out, "enum", key->n_choices, key->choices);
    }
}

static void add_list(mt_text *out, const mt_key *key)
{
    mt_text_add(out, "\"type\": \"array\"");
    if (key->what != NULL || key->least > 0) {
        mt_text_addf(out, ", \"minItems\": %d", key->least > 0 ? key->least : 1);
    }
    if (key->most > 0) {
        mt_text_addf(out, ", \"maxItems\": %d", key->most);
    }
    mt_text_add(out, ", \"items\": {");
    if (key->of != NULL) {
        /* kinds of goals are told apart by their type */
        mt_text_addf(out, "\"$ref\": \"#/definitions/%s\"", key->of->what);
    } else {
        add_string_type(out, key);
    }
    mt_text_add(out, "}");
}

/* What a member may hold, where its columns say it. */
static void add_type(mt_test *t, mt_text *out, const mt_key *key)
{
    if (key->type == MT_KEY_TEXT) {
        add_string_type(out, key);
    } else if (key->type == MT_KEY_COUNT) {
        mt_text_addf(out, "\"type\": \"integer\", \"minimum\": %d, \"maximum\": %d", key->least,
                     key->most);
    } else if (key->type == MT_KEY_BOOL) {
        mt_text_add(out, "\"type\": \"boolean\"");
    } else if (key->type == MT_KEY_LIST) {
        add_list(out, key);
    } else if (key->type == MT_KEY_OBJECT && key->of != NULL) {
        add_reference(out, key->of->what);
    } else if (key->type == MT_KEY_OBJECT_OR_LIST && key->of != NULL) {
        mt_text_addf(out, "\"anyOf\": [{\"$ref\": \"#/definitions/%s\"}, {", key->of->what);
        add_list(out, key);
        mt_text_add(out, "}]");
    } else if (key->type == MT_KEY_VALUE) {
        mt_text_add(out, "\"type\": \"number\"");
    } else if (key->type == MT_KEY_NUMBER) {
        add_reference(out, "number");
    } else if (key->type == MT_KEY_NUMBERS) {
        add_reference(out, "pair");
    } else {
        mt_test_row(t, "member \"%s\"", key->name);
        CHECK_INT(t, key->type, MT_KEY_TEXT_OR_COUNT);
        add_reference(out, "mode");
    }
}

static void add_member(mt_test *t, mt_text *out, const mt_key_table *table, const mt_key *key)
{
    add_string(out, key->name);
    mt_text_add(out, ": {");
    if (key->type == MT_KEY_OBJECT && key->schema == NULL && key->of != NULL &&
        key->says == NULL) {
        mt_text_addf(out, "\"$ref\": \"#/definitions/%s\"}", key->of->what);
        return;
    }
    mt_test_row(t, "definition \"%s\", member \"%s\"", table->what, key->name);
    if (CHECK(t, key->says != NULL || key->schema != NULL)) {
        add_text(out, "description", key->says);
        mt_text_add(out, key->says == NULL ? "" : ", ");
    }
    if (strncmp(table->what, "goal_", 5) == 0 && strcmp(key->name, "type") == 0) {
        add_text(out, "const", table->what + 5);
    } else if (key->schema != NULL) {
        mt_text_add(out, key->schema);
    } else {
        add_type(t, out, key);
    }
    mt_text_addf(out, "%s%s", key->otherwise == NULL ? "" : ", \"default\": ",
                 key->otherwise == NULL ? "" : key->otherwise);
    mt_text_addf(out, "%s%s}", key->examples == NULL ? "" : ", \"examples\": ",
                 key->examples == NULL ? "" : key->examples);
}

/* The members of a table, and what holds of them. */
static void add_object(mt_test *t, mt_text *out, const mt_key_table *table)
{
    const char *required[MT_MAX_KEYS];
    int n = 0;
    mt_test_row(t, "definition \"%s\"", table->what);
    if (!CHECK(t, table->says != NULL)) {
        return;
    }
    add_text(out, "description", table->says);
    mt_text_add(out, ", \"type\": \"object\", \"additionalProperties\": false");
    for (int i = 0; i < table->n; i++) {
        if (table->keys[i].required) {
            required[n++] = table->keys[i].name;
        }
    }
    if (n > 0) {
        mt_text_add(out, ", ");
        add_texts(out, "required", n, required);
    }
    for (int i = 0; i < table->one_of; i++) {
        mt_text_addf(out, "%s{\"required\": [\"%s\"]}%s", i == 0 ? ", \"oneOf\": [" : ", ",
                     table->keys[i].name, i + 1 == table->one_of ? "]" : "");
    }
    mt_text_addf(out, "%s%s", table->rules == NULL || *table->rules == '\0' ? "" : ", ",
                 table->rules == NULL ? "" : table->rules);
    mt_text_addf(out, "%s%s", table->examples == NULL ? "" : ", \"examples\": ",
                 table->examples == NULL ? "" : table->examples);
    mt_text_add(out, ", \"properties\": {");
    for (int i = 0; i < table->n; i++) {
        mt_text_add(out, i == 0 ? "" : ", ");
        add_member(t, out, table, &table->keys[i]);
    }
    mt_text_add(out, "}");
}

/* A goal is of the kind that its type says. */
static void add_goal(mt_text *out, int n, const mt_key_table *const *tables)
{
    const char *names[MT_MAX_KEYS] = {NULL};
    int n_names = 0;
    for (int i = 0; i < n; i++) {
        if (strncmp(tables[i]->what, "goal_", 5) == 0) {
            names[n_names++] = tables[i]->what + 5;
        }
    }
    mt_text_add(out, "\"goal\": {\"description\": \"What the study asks. A goal is a "
                     "constraint, unless it carries a weight.\", \"type\": \"object\", "
                     "\"required\": [\"type\"], \"properties\": {\"type\": {\"description\": "
                     "\"What kind of goal this is.\", \"type\": \"string\", ");
    add_texts(out, "enum", n_names, names);
    mt_text_add(out, "}}, \"allOf\": [");
    for (int i = 0; i < n_names; i++) {
        mt_text_addf(out,
                     "%s{\"if\": {\"type\": \"object\", \"required\": [\"type\"], "
                     "\"properties\": {\"type\": {\"description\": \"A goal of this type.\", "
                     "\"const\": \"%s\"}}}, \"then\": {\"$ref\": "
                     "\"#/definitions/goal_%s\"}}",
                     i == 0 ? "" : ", ", names[i], names[i]);
    }
    mt_text_add(out, "]}");
}

/* A document: the tables of its reader, the types that members share, and whether one of the
 * definitions is a goal. */
typedef struct document {
    const char *name;
    const char *room;
    const mt_key_table *const *(*tables)(int *n);
    const mt_schema_type *(*types)(int *n);
    bool goals;
} document;

static void add_document(mt_test *t, mt_text *out, const document *d)
{
    int n = 0;
    int n_types = 0;
    const mt_key_table *const *const tables = d->tables(&n);
    const mt_schema_type *const types = d->types == NULL ? NULL : d->types(&n_types);
    mt_text_addf(out,
                 "{\"$schema\": \"http://json-schema.org/draft-07/schema#\", \"$comment\": "
                 "\"Written from the tables of src/%s by the target schemas.\", \"title\": "
                 "\"modetune %s\", ",
                 d->room, d->name);
    add_object(t, out, tables[0]);
    mt_text_add(out, ", \"definitions\": {");
    for (int i = 0; i < n_types; i++) {
        mt_text_addf(out, "\"%s\": {", types[i].name);
        add_text(out, "description", types[i].says);
        mt_text_addf(out, ", %s}, ", types[i].schema);
    }
    for (int i = 1; i < n; i++) {
        mt_text_addf(out, "\"%s\": {", tables[i]->what);
        add_object(t, out, tables[i]);
        mt_text_add(out, i + 1 < n || d->goals ? "}, " : "}");
    }
    if (d->goals) {
        add_goal(out, n, tables);
    }
    mt_text_add(out, "}}");
}

/* A value in one line, as it stands in the source. */
static void add_line(mt_text *out, const mt_json *doc, const char *source, mt_addr value)
{
    size_t begin = 0;
    size_t end = 0;
    const mt_json_type type = mt_json_type_of(doc, value);
    if (mt_json_span(doc, value, &begin, &end)) {
        mt_text_add_n(out, source + begin, end - begin);
    } else if (type == MT_JSON_BOOL) {
        mt_text_add(out, mt_json_bool(doc, value) ? "true" : "false");
    } else if (type == MT_JSON_NULL) {
        mt_text_add(out, "null");
    } else {
        mt_text_add(out, type == MT_JSON_ARRAY ? "[" : "{");
        for (mt_addr i = mt_json_first(doc, value); i != MT_NO_ADDR; i = mt_json_next(doc, i)) {
            mt_text_add(out, i == mt_json_first(doc, value) ? "" : ", ");
            if (type == MT_JSON_OBJECT) {
                add_string(out, mt_json_name(doc, i));
                mt_text_add(out, ": ");
            }
            add_line(out, doc, source, i);
        }
        mt_text_add(out, type == MT_JSON_ARRAY ? "]" : "}");
    }
}

/* A value in one line where that is short enough, else an item in each line. */
static void add_lines(mt_text *out, const mt_json *doc, const char *source, mt_addr value,
                      int indent, size_t before)
{
    mt_text line = {.s = NULL};
    const mt_json_type type = mt_json_type_of(doc, value);
    const bool parts = type == MT_JSON_ARRAY || type == MT_JSON_OBJECT;
    add_line(&line, doc, source, value);
    if (!parts || line.length + before <= WIDTH) {
        mt_text_add(out, line.s == NULL ? "" : line.s);
        mt_text_free(&line);
        return;
    }
    mt_text_free(&line);
    mt_text_add(out, type == MT_JSON_ARRAY ? "[" : "{");
    for (mt_addr i = mt_json_first(doc, value); i != MT_NO_ADDR; i = mt_json_next(doc, i)) {
        mt_text_addf(out, "%s\n%*s", i == mt_json_first(doc, value) ? "" : ",", indent + 2, "");
        size_t used = (size_t)indent + 2;
        if (type == MT_JSON_OBJECT) {
            used += strlen(mt_json_name(doc, i)) + 4;
            add_string(out, mt_json_name(doc, i));
            mt_text_add(out, ": ");
        }
        add_lines(out, doc, source, i, indent + 2, used);
    }
    mt_text_addf(out, "\n%*s%s", indent, "", type == MT_JSON_ARRAY ? "]" : "}");
}

static void check_document(mt_test *t, const document *d)
{
    char path[256];
    mt_text compact = {.s = NULL};
    mt_text want = {.s = NULL};
    mt_file file = {0};
    mt_json *doc = NULL;
    mt_err err = {.text = ""};
    (void)snprintf(path, sizeof path, MT_TEST_SOURCE_DIR "/schemas/%s.schema.json", d->name);
    add_document(t, &compact, d);
    REQUIRE(t, compact.s != NULL && !compact.failed);
    CHECK_INT(t, mt_json_parse(compact.s, compact.length, &doc, &err), MT_OK);
    if (CHECK(t, doc != NULL) && CHECK_STR(t, err.text, "")) {
        add_lines(&want, doc, compact.s, MT_JSON_ROOT, 0, 0);
        mt_text_add(&want, "\n");
    }
    if (getenv("MT_SCHEMAS_UPDATE") != NULL && want.s != NULL) {
        FILE *const f = fopen(path, "w");
        if (CHECK(t, f != NULL)) {
            CHECK(t, fwrite(want.s, 1, want.length, f) == want.length);
            CHECK_INT(t, fclose(f), 0);
        }
    }
    mt_test_row(t, "%s: differs from what cmake --build build/release --target schemas writes",
                path);
    if (CHECK_INT(t, mt_file_read(path, NULL, SCHEMA_LIMIT, &file, NULL), MT_OK)) {
        CHECK(t, want.length == file.length &&
                     memcmp(want.s == NULL ? "" : want.s, file.bytes, file.length) == 0);
    }
    mt_file_free(&file);
    mt_json_delete(doc);
    mt_text_free(&want);
    mt_text_free(&compact);
}

static void schema__of_a_document_is_what_its_tables_say(mt_test *t)
{
    static const document documents[] = {
        {"model", "model", mt_model_key_tables, mt_model_types, false},
        {"study", "study", mt_study_key_tables, mt_study_types, true},
        {"profile", "environment", mt_profile_key_tables, mt_profile_types, false},
        {"aircraft", "environment", mt_aircraft_key_tables, NULL, false}};
    for (int i = 0; i < MT_COUNT(documents); i++) {
        check_document(t, &documents[i]);
    }
}

MT_TEST_MAIN(MT_TEST(schema__of_a_document_is_what_its_tables_say))
