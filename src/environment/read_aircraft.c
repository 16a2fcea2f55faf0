/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The catalogue of aircraft: rotor speeds and numbers of blades, each with its source. */
#include "environment/read_aircraft.h"

#include <string.h>

#include "environment/bands.h"
#include "io/file.h"
#include "io/json_print.h"
#include "io/shipped.h"

#define KEY_ENUM(id, ...) id,
#define KEY(id, label, kind, must, row, ...) \
    {.name = (label),                        \
     .type = (kind),                         \
     .required = (must),                     \
     .possible = MT_POSSIBLE_##row,          \
     .says = __VA_ARGS__},

#define ROOT_KEYS(X)                                                                      \
    X(ROOT_SCHEMA, "$schema", MT_KEY_TEXT, false, NONE, "This schema, for the editor.")   \
    X(ROOT_FORMAT, "format", MT_KEY_TEXT, true, NONE, "Kind and version of this file.",   \
      .schema = "\"type\": \"string\", \"enum\": [\"modetune-aircraft/1\"]")              \
    X(ROOT_DESCRIPTION, "description", MT_KEY_TEXT, false, NONE, "Free text for people.") \
    X(ROOT_SOURCE, "source", MT_KEY_TEXT, false, NONE, "Where it comes from.")            \
    X(ROOT_ACCEPTED, "accepted", MT_KEY_LIST, false, NONE,                                \
      "Names of warnings that you know and accept: they are not printed.",                \
      .examples = "[[\"level\"]]", .choices = mt_warning_names,                           \
      .n_choices = MT_WARNING_NAME_COUNT)                                                 \
    X(ROOT_AIRCRAFT, "aircraft", MT_KEY_LIST, true, NONE, "The aircraft.",                \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": "            \
                "\"#/definitions/aircraft\"}")
enum { ROOT_KEYS(KEY_ENUM) ROOT_KEY_COUNT };
static const mt_key ROOT[] = {ROOT_KEYS(KEY)};
static const mt_key_table ROOT_TABLE = {
    .what = "",
    .keys = ROOT,
    .n = ROOT_KEY_COUNT,
    .says = "A catalogue of aircraft for studies that avoid the harmonics of rotors: speeds "
            "and numbers of blades, each with its source."};

#define AIRCRAFT_KEYS(X)                                                                      \
    X(AIRCRAFT_NAME, "name", MT_KEY_TEXT, true, NONE,                                         \
      "What studies call it; every name once.",                                               \
      .schema = "\"type\": \"string\", \"minLength\": 1")                                     \
    X(AIRCRAFT_DESCRIPTION, "description", MT_KEY_TEXT, false, NONE, "Free text for people.") \
    X(AIRCRAFT_SOURCE, "source", MT_KEY_TEXT, false, NONE, "Where it comes from.")            \
    X(AIRCRAFT_MAIN, "main", MT_KEY_OBJECT, true, NONE, "The main rotor.",                    \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/rotor\"}]")                           \
    X(AIRCRAFT_TAIL, "tail", MT_KEY_OBJECT, false, NONE,                                      \
      "The tail rotor. Absent: there is none, or nothing is known of it.",                    \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/rotor\"}]")
enum { AIRCRAFT_KEYS(KEY_ENUM) AIRCRAFT_KEY_COUNT };
static const mt_key AIRCRAFT[] = {AIRCRAFT_KEYS(KEY)};
static const mt_key_table AIRCRAFT_TABLE = {
    .what = "aircraft",
    .keys = AIRCRAFT,
    .n = AIRCRAFT_KEY_COUNT,
    .says =
        "An aircraft: its main rotor (rotors, where several turn alike) and its tail rotor."};

#define ROTOR_KEYS(X)                                                                   \
    X(ROTOR_SPEED_HZ, "speed_hz", MT_KEY_OBJECT, false, NONE, "Nominal speed [1/s].",   \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/speed\"}]")                     \
    X(ROTOR_SPEED_RPM, "speed_rpm", MT_KEY_OBJECT, false, NONE, "Nominal speed [rpm].", \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/speed\"}]")                     \
    X(ROTOR_BLADES, "blades", MT_KEY_OBJECT, true, NONE, "Its blades.",                 \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/blades\"}]")                    \
    X(ROTOR_DESCRIPTION, "description", MT_KEY_TEXT, false, NONE, "Free text for people.")
enum { ROTOR_KEYS(KEY_ENUM) ROTOR_KEY_COUNT };
static const mt_key ROTOR[] = {ROTOR_KEYS(KEY)};
static const mt_key_table ROTOR_TABLE = {
    .what = "rotor",
    .keys = ROTOR,
    .n = ROTOR_KEY_COUNT,
    .says = "A rotor: its nominal speed and its blades.",
    .rules = "\"oneOf\": [{\"required\": [\"speed_hz\"]}, {\"required\": [\"speed_rpm\"]}]"};

#define VALUE_KEYS(X, ...)                                                                 \
    X(VALUE_VALUE, "value", __VA_ARGS__)                                                   \
    X(VALUE_SOURCE, "source", MT_KEY_TEXT, true, NONE,                                     \
      "The document that says so, or, unconfirmed, where the value is said to come from.") \
    X(VALUE_CONFIRMED, "confirmed", MT_KEY_BOOL, true, NONE,                               \
      "true: read in that public document. false: not; studies that use the value warn.")  \
    X(VALUE_DESCRIPTION, "description", MT_KEY_TEXT, false, NONE, "Free text for people.")
enum { VALUE_KEYS(KEY_ENUM, ) VALUE_KEY_COUNT };
static const mt_key SPEED[] = {VALUE_KEYS(KEY, MT_KEY_VALUE, true, SPEED,
                                          "The speed, above 0, in the unit of the member.")};
static const mt_key_table SPEED_TABLE = {
    .what = "speed", .keys = SPEED, .n = VALUE_KEY_COUNT, .says = "A speed, and who says so."};
static const mt_key BLADES[] = {
    VALUE_KEYS(KEY, MT_KEY_COUNT, true, WHOLE, "How many.", .least = 1, .most = 20)};
static const mt_key_table BLADES_TABLE = {.what = "blades",
                                          .keys = BLADES,
                                          .n = VALUE_KEY_COUNT,
                                          .says = "A number of blades, and who says so."};

const mt_key_table *const *mt_aircraft_key_tables(int *n)
{
    static const mt_key_table *const tables[] = {&ROOT_TABLE, &AIRCRAFT_TABLE, &ROTOR_TABLE,
                                                 &SPEED_TABLE, &BLADES_TABLE};
    *n = MT_COUNT(tables);
    return tables;
}

/* What speed and number of blades have in common. */
static void read_origin(mt_reader *r, const mt_addr *found, mt_aircraft_value *out)
{
    out->source = mt_reader_text(r, found[VALUE_SOURCE]);
    out->confirmed = mt_reader_flag(r, found[VALUE_CONFIRMED], false);
}

static void read_speed(mt_reader *r, mt_addr value, bool rpm, mt_aircraft_value *out)
{
    mt_addr found[VALUE_KEY_COUNT];
    if (!mt_reader_object(r, value, &SPEED_TABLE, found)) {
        return;
    }
    read_origin(r, found, out);
    if (found[VALUE_VALUE] == MT_NO_ADDR) {
        return;
    }
    const double speed = mt_json_number(r->doc, found[VALUE_VALUE]);
    mt_reader_check_range_of(r, rpm ? "speed_rpm" : "speed_hz", found[VALUE_VALUE], speed,
                             rpm ? MT_POSSIBLE_RPM : MT_POSSIBLE_SPEED);
    out->value = rpm ? speed / 60.0 : speed;
    out->text = mt_arena_printf(r->mem, "%.10g %s", speed, rpm ? "rpm" : "Hz");
}

static void read_blades(mt_reader *r, mt_addr value, mt_aircraft_value *out)
{
    mt_addr found[VALUE_KEY_COUNT];
    if (!mt_reader_object(r, value, &BLADES_TABLE, found)) {
        return;
    }
    read_origin(r, found, out);
    const int blades = mt_reader_count(r, found[VALUE_VALUE], 1, MT_MAX_BLADES, 1);
    out->value = (double)blades;
    out->text = mt_arena_printf(r->mem, "%d", blades);
}

static void read_rotor(mt_reader *r, mt_addr value, mt_aircraft_rotor *out)
{
    mt_addr found[ROTOR_KEY_COUNT];
    if (value == MT_NO_ADDR || !mt_reader_object(r, value, &ROTOR_TABLE, found)) {
        return;
    }
    const bool hz = mt_json_member(r->doc, value, ROTOR[ROTOR_SPEED_HZ].name) != MT_NO_ADDR;
    const mt_addr rpm = mt_json_member(r->doc, value, ROTOR[ROTOR_SPEED_RPM].name);
    if (hz && rpm != MT_NO_ADDR) {
        mt_diag_structure(r->diags, mt_json_name_addr(r->doc, rpm),
                          "\"speed_rpm\" excludes \"speed_hz\"");
    } else if (!hz && rpm == MT_NO_ADDR) {
        mt_diag_structure(r->diags, value, "one of \"speed_hz\" or \"speed_rpm\" is missing");
    }
    if (found[ROTOR_SPEED_HZ] != MT_NO_ADDR) {
        read_speed(r, found[ROTOR_SPEED_HZ], false, &out->speed);
    }
    if (found[ROTOR_SPEED_RPM] != MT_NO_ADDR) {
        read_speed(r, found[ROTOR_SPEED_RPM], true, &out->speed);
    }
    if (found[ROTOR_BLADES] != MT_NO_ADDR) {
        read_blades(r, found[ROTOR_BLADES], &out->blades);
    }
}

static void read_aircraft_item(mt_reader *r, mt_addr value, mt_aircraft_list *list)
{
    mt_addr found[AIRCRAFT_KEY_COUNT];
    if (!mt_reader_object(r, value, &AIRCRAFT_TABLE, found)) {
        return;
    }
    mt_aircraft *const a = &list->items[list->n];
    a->name = mt_reader_ref(r, found[AIRCRAFT_NAME]);
    if (a->name.s != NULL && *a->name.s == '\0') {
        mt_diag_structure(r->diags, a->name.addr, "a name must not be empty");
    }
    for (int i = 0; i < list->n && a->name.s != NULL; i++) {
        if (strcmp(list->items[i].name.s, a->name.s) == 0) {
            mt_diag_error(r->diags, a->name.addr, "\"%s\" is listed twice", a->name.s);
        }
    }
    read_rotor(r, found[AIRCRAFT_MAIN], &a->main_rotor);
    read_rotor(r, found[AIRCRAFT_TAIL], &a->tail_rotor);
    a->has_tail = found[AIRCRAFT_TAIL] != MT_NO_ADDR;
    list->n += a->name.s != NULL ? 1 : 0;
}

static void read_aircraft_root(mt_reader *r, mt_aircraft_list *list)
{
    mt_addr found[ROOT_KEY_COUNT];
    if (!mt_reader_format(r, "modetune-aircraft/1", "catalogue of aircraft") ||
        !mt_reader_object(r, MT_JSON_ROOT, &ROOT_TABLE, found)) {
        return;
    }
    r->accepted = mt_reader_accepted(r, found[ROOT_ACCEPTED]);
    mt_items items = mt_reader_some_items(r, found[ROOT_AIRCRAFT], "the list of aircraft");
    list->items = mt_reader_room(r, &items, sizeof *list->items);
    while (mt_items_next(&items)) {
        if (mt_reader_type(r, items.at, MT_KEY_OBJECT)) {
            read_aircraft_item(r, items.at, list);
        }
    }
}

static mt_status read_aircraft_text(const char *path, const mt_file *file,
                                    const mt_io_options *opt, mt_arena *mem,
                                    mt_aircraft_list *out, mt_diagnostics *messages,
                                    mt_err *err)
{
    mt_json *doc = NULL;
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (doc == NULL) {
        return rc;
    }
    mt_reader r = {.doc = doc, .diags = mt_json_diags(doc), .mem = mem};
    if (rc == MT_OK) {
        read_aircraft_root(&r, out);
    }
    rc = mt_reader_status(&r, path, err);
    if (opt != NULL && opt->structural != NULL) {
        *opt->structural = r.diags->structural;
    }
    if (messages != NULL) {
        mt_json_report(doc, path, messages);
        rc = messages->lines.failed ? mt_fail_memory(err) : rc;
    }
    mt_json_delete(doc);
    return rc;
}

mt_status mt_aircraft_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                           mt_aircraft_list *out, mt_diagnostics *messages, mt_err *err)
{
    const size_t limit =
        opt == NULL || opt->max_bytes == 0 ? MT_JSON_MAX_BYTES : opt->max_bytes;
    mt_file file = {0};
    *out = (mt_aircraft_list){0};
    mt_status rc = mt_files_read(opt == NULL ? NULL : &opt->files, path,
                                 opt == NULL ? NULL : opt->root, limit, &file, err);
    if (rc == MT_OK) {
        rc = read_aircraft_text(path, &file, opt, mem, out, messages, err);
    }
    if (rc == MT_OK) {
        out->sha256 = mt_arena_strdup(mem, file.sha256);
        rc = mt_arena_check(mem, err);
    }
    mt_file_free(&file);
    return rc;
}

const char mt_aircraft_own_name[] = "aircraft.json of modetune";

mt_io_options mt_aircraft_own(mt_file_text *text)
{
    const mt_shipped *const own = mt_shipped_find("problems/aircraft.json");
    *text = (mt_file_text){.path = mt_aircraft_own_name, .text = own->bytes};
    return (mt_io_options){.files = {.given = text, .n = 1, .only = true}};
}
