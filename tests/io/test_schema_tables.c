/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each reader's table of keys holds the members of the schema's definition of the same name:
 * names, which are required, and types. */
#include <string.h>

#include "io/file.h"
#include "io/read_aircraft.h"
#include "io/read_model.h"
#include "io/read_study.h"
#include "mt_test.h"

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

MT_TEST_MAIN(MT_TEST(schema__has_the_members_of_the_model_reader),
             MT_TEST(schema__has_the_members_of_the_study_reader),
             MT_TEST(schema__has_the_members_of_the_aircraft_reader))
