/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The JSON Schemas of models, studies, profiles and catalogues of aircraft are written from the
 * tables that their readers go by, that of results from those of its writer and reader: here
 * their texts are made, and held against those of schemas/. MT_SCHEMAS_UPDATE=1 writes them
 * there (the target "schemas").
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "cli/cli.h"
#include "cli/cmd_run.h"
#include "cli/shipped.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "model/read.h"
#include "mt_test.h"
#include "result/result.h"
#include "scene/write.h"
#include "study/read.h"

enum { WIDTH = 145, SCHEMA_LIMIT = 1 << 20, MOST_DEFINITIONS = 64 };

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
    } else if (key->possible != MT_POSSIBLE_NONE) {
        mt_text_add(out, "\"$ref\": \"#/definitions/number\"");
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
    } else if (key->type == MT_KEY_NUMBER_OR_LIST) {
        mt_text_add(out, "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {");
        add_list(out, key);
        mt_text_add(out, "}]");
    } else if (key->type == MT_KEY_TEXT_OR_LIST) {
        add_reference(out, "position");
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

static void add_head(mt_text *out, const char *room, const char *name)
{
    mt_text_addf(out,
                 "{\"$schema\": \"http://json-schema.org/draft-07/schema#\", \"$comment\": "
                 "\"Written from the tables of src/%s by the target schemas.\", \"title\": "
                 "\"modetune %s\", ",
                 room, name);
}

static void add_document(mt_test *t, mt_text *out, const document *d)
{
    int n = 0;
    int n_types = 0;
    const mt_key_table *const *const tables = d->tables(&n);
    const mt_schema_type *const types = d->types == NULL ? NULL : d->types(&n_types);
    add_head(out, d->room, d->name);
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

/* Documents that are written from records: there are no other members; files of older programs
 * may lack the later ones. */

static void add_record(mt_test *t, mt_text *out, const mt_record *record);
static void add_field_type(mt_test *t, mt_text *out, const mt_field *f);

/* "type": the type, or null. */
static void add_type_or_null(mt_text *out, const char *type, bool nullable)
{
    mt_text_addf(out, nullable ? "\"type\": [\"%s\", \"null\"]" : "\"type\": \"%s\"", type);
}

/* The members of a record, or the place where they stand. */
static void add_record_or_reference(mt_test *t, mt_text *out, const mt_record *record)
{
    if (record->name != NULL) {
        mt_text_addf(out, "\"$ref\": \"#/definitions/%s\"", record->name);
        return;
    }
    if (record->bare) {
        REQUIRE(t, record->n == 1);
        add_text(out, "description", record->fields[0].says);
        mt_text_add(out, ", ");
        add_field_type(t, out, &record->fields[0]);
        return;
    }
    if (CHECK(t, record->says != NULL)) {
        add_text(out, "description", record->says);
        mt_text_add(out, ", ");
    }
    add_record(t, out, record);
}

static void add_choices(mt_text *out, const mt_field *f)
{
    add_type_or_null(out, "string", f->nullable);
    mt_text_add(out, ", \"enum\": [");
    for (int i = 0; i < f->n_choices; i++) {
        mt_text_add(out, i == 0 ? "" : ", ");
        add_string(out, f->choices[i]);
    }
    mt_text_add(out, f->nullable ? ", null]" : "]");
}

/* A list's items, which rules of numbers are about. */
static void add_items(mt_test *t, mt_text *out, const mt_field *f)
{
    add_type_or_null(out, "array", f->nullable);
    if (f->type == MT_FIELD_LIST) {
        mt_text_addf(out, "%s%s", f->rules == NULL ? "" : ", ",
                     f->rules == NULL ? "" : f->rules);
    }
    mt_text_add(out, ", \"items\": {");
    if (f->type == MT_FIELD_LIST) {
        add_record_or_reference(t, out, f->record);
    } else if (f->type == MT_FIELD_NUMBERS) {
        mt_text_addf(out, "\"type\": [\"number\", \"null\"]%s%s", f->rules == NULL ? "" : ", ",
                     f->rules == NULL ? "" : f->rules);
    } else if (f->choices != NULL) {
        add_choices(out, f);
    } else {
        mt_text_add(out, "\"type\": \"string\"");
    }
    mt_text_add(out, "}");
}

/* What a member may hold: of one value, of records, of several values. */
static void add_field_type(mt_test *t, mt_text *out, const mt_field *f)
{
    switch (f->type) {
    case MT_FIELD_FORMAT:
        mt_text_addf(out, "\"type\": \"string\", \"enum\": [\"%s\"]", f->format);
        break;
    case MT_FIELD_TEXT:
        add_type_or_null(out, "string", f->nullable);
        break;
    case MT_FIELD_CHOICE:
    case MT_FIELD_ENUM:
        add_choices(out, f);
        break;
    case MT_FIELD_NUMBER:
        add_type_or_null(out, "number", f->nullable);
        break;
    case MT_FIELD_VALUE:
        mt_text_addf(out, "\"type\": [\"number\", \"string\", %s\"null\"]",
                     f->logical ? "\"boolean\", " : "");
        break;
    case MT_FIELD_COUNT:
    case MT_FIELD_LONG:
        add_type_or_null(out, "integer", f->nullable);
        mt_text_addf(out, ", \"minimum\": %d", f->least);
        break;
    case MT_FIELD_FLAG:
        mt_text_add(out, "\"type\": \"boolean\"");
        break;
    case MT_FIELD_RECORD:
        if (f->record->name != NULL) {
            add_reference(out, f->record->name);
        } else {
            add_record(t, out, f->record);
        }
        break;
    case MT_FIELD_OPTION:
        mt_text_add(out, "\"if\": {\"type\": \"object\"}, \"then\": {");
        add_record_or_reference(t, out, f->record);
        mt_text_add(out, "}, \"else\": {\"type\": \"null\"}");
        break;
    case MT_FIELD_LIST:
    case MT_FIELD_TEXTS:
    case MT_FIELD_NUMBERS:
        add_items(t, out, f);
        break;
    case MT_FIELD_BY_VARIABLE:
        add_type_or_null(out, "object", f->nullable);
        mt_text_add(out, ", \"additionalProperties\": {");
        add_type_or_null(out, "number", f->numbers_nullable);
        mt_text_add(out, "}");
        break;
    case MT_FIELD_TYPE_COUNT:
        break;
    }
}

static void add_field(mt_test *t, mt_text *out, const mt_field *f)
{
    const bool in_items = f->type == MT_FIELD_LIST || f->type == MT_FIELD_NUMBERS;
    add_string(out, f->name);
    mt_text_add(out, ": {");
    if (f->says == NULL && f->type == MT_FIELD_RECORD && f->record->name != NULL) {
        add_record_or_reference(t, out, f->record);
    } else {
        mt_test_row(t, "member \"%s\"", f->name);
        if (CHECK(t, f->says != NULL)) {
            add_text(out, "description", f->says);
            mt_text_add(out, ", ");
        }
        add_field_type(t, out, f);
        if (!in_items && f->rules != NULL) {
            mt_text_addf(out, ", %s", f->rules);
        }
    }
    mt_text_add(out, "}");
}

/* A configuration of a model that info prints: no record says its other members. */
typedef struct named_configuration {
    const char *name;
} named_configuration;

#define THIS named_configuration
static const mt_field named_fields[] = {MT_F_TEXT("configuration", name, "Its name.")};
static const mt_record named_record = MT_F_RECORD_OF(
    named_fields, "configuration",
    "A configuration of a model. It has many more members, which are not described here.");
#undef THIS

static void add_record(mt_test *t, mt_text *out, const mt_record *record)
{
    const char *names[MT_MAX_KEYS] = {NULL};
    int n = 0;
    REQUIRE(t, record->n <= MT_MAX_KEYS);
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        if (f->name != NULL && !f->later && !f->optional) {
            names[n++] = record->fields[i].name;
        }
    }
    mt_text_addf(out, "\"type\": \"object\", %s",
                 record == &named_record ? "" : "\"additionalProperties\": false, ");
    if (n > 0) {
        add_texts(out, "required", n, names);
        mt_text_add(out, ", ");
    }
    mt_text_add(out, "\"properties\": {");
    for (int i = 0, k = 0; i < record->n; i++) {
        if (record->fields[i].name != NULL) {
            mt_text_add(out, k++ == 0 ? "" : ", ");
            add_field(t, out, &record->fields[i]);
        }
    }
    mt_text_add(out, "}");
}

/* All records below one that are definitions, each once, in the order in which they are first
 * met. */
typedef struct definitions {
    int n;
    const mt_record *items[MOST_DEFINITIONS];
} definitions;

static void find_definitions(mt_test *t, const mt_record *record, definitions *found)
{
    for (int i = 0; i < record->n; i++) {
        const mt_record *const r = record->fields[i].record;
        bool known = r == NULL;
        for (int k = 0; k < found->n && !known; k++) {
            known = found->items[k] == r;
            if (!known && r->name != NULL) {
                mt_test_row(t, "definition \"%s\"", r->name);
                CHECK(t, strcmp(found->items[k]->name, r->name) != 0);
            }
        }
        if (!known && r->name != NULL && CHECK(t, found->n < MOST_DEFINITIONS)) {
            found->items[found->n++] = r;
        }
        if (!known) {
            find_definitions(t, r, found);
        }
    }
}

static void add_definitions(mt_test *t, mt_text *out, const definitions *found)
{
    for (int i = 0; i < found->n; i++) {
        const mt_record *const r = found->items[i];
        mt_text_addf(out, "%s\"%s\": {", i == 0 ? ", \"definitions\": {" : ", ", r->name);
        mt_test_row(t, "definition \"%s\"", r->name);
        if (CHECK(t, r->says != NULL)) {
            add_text(out, "description", r->says);
            mt_text_add(out, ", ");
        }
        add_record(t, out, r);
        mt_text_add(out, i + 1 < found->n ? "}" : "}}");
    }
    mt_text_add(out, "}");
}

static void add_records(mt_test *t, mt_text *out, const char *room, const char *name,
                        const mt_record *root)
{
    definitions found = {.n = 0};
    add_head(out, room, name);
    add_record_or_reference(t, out, root);
    find_definitions(t, root, &found);
    add_definitions(t, out, &found);
}

/* A list of the record, or of files, beside which the record may stand. */
static void add_list_answer(mt_test *t, mt_text *out, const mt_command *command,
                            definitions *found)
{
    const mt_record *const record = command->answer.record;
    const bool files = command->answer.form == MT_ANSWER_FILES;
    const bool both = files && record != NULL;
    const mt_record *const item = files ? &mt_listed_record : record;
    REQUIRE(t, item->name != NULL);
    found->items[found->n++] = item;
    mt_text_addf(out,
                 "\"description\": \"What `modetune %s --format json` prints: a list%s.\", %s"
                 "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/%s\"}",
                 command->name, both ? " of files, or what its operand is" : "",
                 both ? "\"anyOf\": [{" : "", item->name);
    if (both) {
        REQUIRE(t, record->name != NULL);
        found->items[found->n++] = record;
        mt_text_addf(out, "}, {\"$ref\": \"#/definitions/%s\"}]", record->name);
    }
}

/* What a command prints. Records of configurations are definitions. */
static void add_answer(mt_test *t, mt_text *out, const mt_command *command)
{
    const mt_record *const record = command->answer.record;
    definitions found = {.n = 0};
    mt_test_row(t, "%s", command->name);
    add_head(out, "cli", command->name);
    switch (command->answer.form) {
    case MT_ANSWER_ONE:
        mt_text_addf(out, "\"description\": \"What `modetune %s --format json` prints.\", ",
                     command->name);
        add_record(t, out, record);
        break;
    case MT_ANSWER_CONFIGURATIONS:
        REQUIRE(t, record->name != NULL);
        found = (definitions){.n = 2, .items = {record, &mt_failed_record}};
        mt_text_addf(out,
                     "\"description\": \"What `modetune %s --format json` prints: a list of "
                     "the configurations, or the one that -c names alone.\", "
                     "\"anyOf\": [{\"type\": \"array\", \"items\": {\"anyOf\": "
                     "[{\"$ref\": \"#/definitions/%s\"}, {\"$ref\": \"#/definitions/%s\"}]}}, "
                     "{\"$ref\": \"#/definitions/%s\"}, {\"$ref\": \"#/definitions/%s\"}]",
                     command->name, record->name, mt_failed_record.name, record->name,
                     mt_failed_record.name);
        break;
    case MT_ANSWER_HELD:
        REQUIRE(t, record->name != NULL);
        found = (definitions){.n = 2, .items = {record, &named_record}};
        mt_text_addf(out,
                     "\"description\": \"What `modetune %s --format json` prints: what a file "
                     "holds, or of a model a list of the configurations, or the one that -c "
                     "names alone.\", \"anyOf\": [{\"$ref\": \"#/definitions/%s\"}, "
                     "{\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/%s\"}}, "
                     "{\"$ref\": \"#/definitions/%s\"}]",
                     command->name, record->name, named_record.name, named_record.name);
        break;
    case MT_ANSWER_LIST:
    case MT_ANSWER_FILES:
        add_list_answer(t, out, command, &found);
        break;
    }
    if (record != NULL) {
        find_definitions(t, record, &found);
    }
    add_definitions(t, out, &found);
}

static void add_scene_table(mt_test *t, mt_text *out, const mt_scene_table *table,
                            bool or_null);

static void add_scene_row(mt_test *t, mt_text *out, const mt_scene_row *row)
{
    mt_test_row(t, "scene, member \"%s\"", row->name);
    CHECK(t, row->says != NULL && (row->of == NULL) == (row->schema != NULL));
    add_string(out, row->name);
    mt_text_add(out, ": {");
    add_text(out, "description", row->says);
    mt_text_add(out, ", ");
    if (row->list) {
        mt_text_add(out, "\"type\": \"array\", \"items\": {");
        add_text(out, "description", row->of->says);
        mt_text_add(out, ", ");
        add_scene_table(t, out, row->of, false);
        mt_text_add(out, "}");
    } else if (row->of != NULL) {
        add_scene_table(t, out, row->of, row->or_null);
    } else {
        mt_text_add(out, row->schema);
    }
    for (int i = 0; i < row->n_choices; i++) {
        mt_text_add(out, i == 0 ? ", \"enum\": [" : ", ");
        add_string(out, row->choices[i]);
        mt_text_add(out, i + 1 < row->n_choices ? "" : row->or_null ? ", null]" : "]");
    }
    mt_text_addf(out, "%s%s}", row->limits == NULL ? "" : ", ",
                 row->limits == NULL ? "" : row->limits);
}

static void add_scene_table(mt_test *t, mt_text *out, const mt_scene_table *table, bool or_null)
{
    const char *names[MT_MAX_KEYS] = {NULL};
    const int n = table->n;
    REQUIRE(t, n <= MT_MAX_KEYS);
    for (int i = 0; i < n; i++) {
        names[i] = table->rows[i].name;
    }
    add_type_or_null(out, "object", or_null);
    mt_text_add(out, ", \"additionalProperties\": false, ");
    add_texts(out, "required", n, names);
    mt_text_add(out, ", \"properties\": {");
    for (int i = 0; i < n; i++) {
        mt_text_add(out, i == 0 ? "" : ", ");
        add_scene_row(t, out, &table->rows[i]);
    }
    mt_text_add(out, "}");
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

/* Hold a schema, written in one line, against that of schemas/. */
static void check_schema(mt_test *t, const char *name, const mt_text *compact)
{
    char path[256];
    mt_text want = {.s = NULL};
    mt_file file = {0};
    mt_json *doc = NULL;
    mt_err err = {.text = ""};
    (void)snprintf(path, sizeof path, MT_TEST_SOURCE_DIR "/schemas/%s.schema.json", name);
    REQUIRE(t, compact->s != NULL && !compact->failed);
    CHECK_INT(t, mt_json_parse(compact->s, compact->length, &doc, &err), MT_OK);
    if (CHECK(t, doc != NULL) && CHECK_STR(t, err.text, "")) {
        add_lines(&want, doc, compact->s, MT_JSON_ROOT, 0, 0);
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
}

static void schema__of_a_document_is_what_its_tables_say(mt_test *t)
{
    static const document documents[] = {
        {"model", "model", mt_model_key_tables, mt_model_types, false},
        {"study", "study", mt_study_key_tables, mt_study_types, true},
        {"profile", "environment", mt_profile_key_tables, mt_profile_types, false},
        {"aircraft", "environment", mt_aircraft_key_tables, NULL, false}};
    for (int i = 0; i < MT_COUNT(documents); i++) {
        mt_text compact = {.s = NULL};
        add_document(t, &compact, &documents[i]);
        check_schema(t, documents[i].name, &compact);
        mt_text_free(&compact);
    }
}

static void schema__of_what_is_written_is_what_its_records_say(mt_test *t)
{
    static const struct {
        const char *name;
        const char *room;
        const mt_record *root;
    } documents[] = {{"result", "result", &mt_result_record},
                     {"index", "cli", &mt_index_record},
                     {"progress", "cli", &mt_progress_record}};
    for (int i = 0; i < MT_COUNT(documents); i++) {
        mt_text compact = {.s = NULL};
        add_records(t, &compact, documents[i].room, documents[i].name, documents[i].root);
        check_schema(t, documents[i].name, &compact);
        mt_text_free(&compact);
    }
}

static void schema__of_what_commands_print_is_what_their_records_say(mt_test *t)
{
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text compact = {.s = NULL};
        char name[64];
        if (mt_commands[i]->answer.record != NULL ||
            mt_commands[i]->answer.form == MT_ANSWER_FILES) {
            (void)snprintf(name, sizeof name, "command_%s", mt_commands[i]->name);
            add_answer(t, &compact, mt_commands[i]);
            check_schema(t, name, &compact);
        }
        mt_text_free(&compact);
    }
}

static void schema__of_a_scene_is_what_its_tables_say(mt_test *t)
{
    mt_text compact = {.s = NULL};
    add_head(&compact, "scene", "scene");
    add_text(&compact, "description", mt_scene_members.says);
    mt_text_add(&compact, ", ");
    add_scene_table(t, &compact, &mt_scene_members, false);
    mt_text_add(&compact, "}");
    check_schema(t, "scene", &compact);
    mt_text_free(&compact);
}

MT_TEST_MAIN(MT_TEST(schema__of_a_scene_is_what_its_tables_say),
             MT_TEST(schema__of_a_document_is_what_its_tables_say),
             MT_TEST(schema__of_what_is_written_is_what_its_records_say),
             MT_TEST(schema__of_what_commands_print_is_what_their_records_say))
