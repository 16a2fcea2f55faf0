/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The catalogue of aircraft: rotor speeds and numbers of blades, each with its source. */
#include "environment/aircraft.h"

#include <math.h>
#include <string.h>

#include "io/file.h"
#include "io/json.h"
#include "io/members.h"

/* The state of reading a catalogue. */
typedef struct aircraft_reader {
    mt_reader r;
    mt_aircraft_list *list; /* those before the present one are complete */
} aircraft_reader;

static const double RPM_PER_HZ = 60.0;
static const char FORMAT[] = "modetune-aircraft/1";
static const char *const FORMATS[] = {FORMAT};

static void read_speed_number(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_aircraft_value *const out = item;
    (void)key;
    out->value = mt_json_number(r->doc, value); /* checked by read_speed, which has its unit */
}

static void read_blade_number(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_aircraft_value *const out = item;
    const int blades = mt_reader_count(r, value, key->least, key->most, 1);
    out->value = (double)blades;
    out->text = mt_arena_printf(r->mem, "%d", blades);
}

#define THIS mt_aircraft_value
/* what speeds and numbers of blades have in common */
#define VALUE_ORIGIN                                                                        \
    {.name = "source",                                                                      \
     .type = MT_KEY_TEXT,                                                                   \
     .required = true,                                                                      \
     MT_M_TO(mt_read_text, const char *, source),                                           \
     .says = "The document that says so, or, unconfirmed, where the value is said to come " \
             "from."},                                                                      \
        MT_M_FLAG(                                                                          \
            "confirmed", true, confirmed,                                                   \
            "true: read in that public document. false: not; studies that use the value "   \
            "warn."),                                                                       \
        MT_M_DESCRIPTION
static const mt_key SPEED[] = {
    {.name = "value",
     .type = MT_KEY_VALUE,
     .required = true,
     MT_M_ROW(SPEED),
     .read = read_speed_number,
     .says = "The speed, above 0, in the unit of the member."},
    VALUE_ORIGIN,
};
static const mt_key BLADES[] = {
    {.name = "value",
     .type = MT_KEY_COUNT,
     .required = true,
     MT_M_ROW(WHOLE),
     .read = read_blade_number,
     .least = 1,
     .most = MT_MAX_BLADES,
     .says = "How many."},
    VALUE_ORIGIN,
};
#undef THIS
static const mt_key_table SPEED_TABLE = {
    .what = "speed", .keys = SPEED, .n = MT_COUNT(SPEED), .says = "A speed, and who says so."};
static const mt_key_table BLADES_TABLE = {.what = "blades",
                                          .keys = BLADES,
                                          .n = MT_COUNT(BLADES),
                                          .says = "A number of blades, and who says so."};

static void read_speed(mt_reader *r, const mt_key *key, mt_addr value, void *item, bool rpm)
{
    mt_aircraft_value *const out = (mt_aircraft_value *)(void *)((char *)item + key->at);
    out->value = nan("");
    (void)mt_members_read(r, value, key->of, out);
    const double speed = out->value;
    if (speed != speed) {
        return;
    }
    mt_reader_check_range_of(r, key->name, mt_diag_member(r->diags, value, "value"), speed,
                             rpm ? MT_POSSIBLE_RPM : MT_POSSIBLE_SPEED);
    out->value = rpm ? speed / RPM_PER_HZ : speed;
    out->text = mt_arena_printf(r->mem, "%.10g %s", speed, rpm ? "rpm" : "Hz");
}

static void read_speed_hz(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_speed(r, key, value, item, false);
}

static void read_speed_rpm(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_speed(r, key, value, item, true);
}

#define THIS mt_aircraft_rotor
static const mt_key ROTOR[] = {
    {.name = "speed_hz",
     .type = MT_KEY_OBJECT,
     MT_M_TO(read_speed_hz, mt_aircraft_value, speed),
     .of = &SPEED_TABLE,
     .says = "Nominal speed [1/s]."},
    {.name = "speed_rpm",
     .type = MT_KEY_OBJECT,
     MT_M_TO(read_speed_rpm, mt_aircraft_value, speed),
     .of = &SPEED_TABLE,
     .says = "Nominal speed [rpm]."},
    MT_M_PART("blades", true, blades, mt_aircraft_value, BLADES_TABLE, "Its blades."),
    MT_M_DESCRIPTION,
};
#undef THIS
static const mt_key_table ROTOR_TABLE = {.what = "rotor",
                                         .keys = ROTOR,
                                         .n = MT_COUNT(ROTOR),
                                         .one_of = 2,
                                         .says = "A rotor: its nominal speed and its blades."};

/* Every name once. */
static void read_name(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const aircraft_reader *const reader = (const void *)r;
    const mt_aircraft_list *const list = reader->list;
    mt_aircraft *const a = item;
    (void)key;
    a->name = mt_reader_ref(r, value);
    if (a->name.s != NULL && *a->name.s == '\0') {
        mt_diag_structure(r->diags, a->name.addr, "a name must not be empty");
    }
    for (int i = 0; i < list->n && a->name.s != NULL; i++) {
        const char *const other = list->items[i].name.s;
        if (other != NULL && strcmp(other, a->name.s) == 0) {
            mt_diag_error(r->diags, a->name.addr, "\"%s\" is listed twice", a->name.s);
        }
    }
}

static void aircraft_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_aircraft *const a = item;
    (void)r;
    (void)which;
    a->has_tail = mt_object_value(o, "tail") != MT_NO_ADDR;
}

#define THIS mt_aircraft
static const mt_key AIRCRAFT[] = {
    {.name = "name",
     .type = MT_KEY_TEXT,
     .required = true,
     .read = read_name,
     .says = "What studies call it; every name once.",
     .schema = "\"type\": \"string\", \"minLength\": 1"},
    MT_M_DESCRIPTION,
    MT_M_FREE("source", "Where it comes from."),
    MT_M_PART("main", true, main_rotor, mt_aircraft_rotor, ROTOR_TABLE, "The main rotor."),
    MT_M_PART("tail", false, tail_rotor, mt_aircraft_rotor, ROTOR_TABLE,
              "The tail rotor. Absent: there is none, or nothing is known of it."),
};
#undef THIS
static const mt_key_table AIRCRAFT_TABLE = {
    .what = "aircraft",
    .keys = AIRCRAFT,
    .n = MT_COUNT(AIRCRAFT),
    .size = sizeof(mt_aircraft),
    .finish = aircraft_finish,
    .says =
        "An aircraft: its main rotor (rotors, where several turn alike) and its tail rotor."};

#define THIS mt_aircraft_list
static const mt_key ROOT[] = {
    MT_M_FREE("$schema", "This schema, for the editor."),
    MT_M_FORMAT(FORMATS),
    MT_M_DESCRIPTION,
    MT_M_FREE("source", "Where it comes from."),
    MT_M_ACCEPTED("Names of warnings that you know and accept: they are not printed.",
                  .examples = "[[\"level\"]]"),
    MT_M_ITEMS("aircraft", true, items, n, mt_aircraft, "the list of aircraft", AIRCRAFT_TABLE,
               "The aircraft."),
};
#undef THIS
static const mt_key_table ROOT_TABLE = {
    .what = "",
    .keys = ROOT,
    .n = MT_COUNT(ROOT),
    .says = "A catalogue of aircraft for studies that avoid the harmonics of rotors: speeds "
            "and numbers of blades, each with its source."};

const mt_key_table *const *mt_aircraft_key_tables(int *n)
{
    static const mt_key_table *const tables[] = {&ROOT_TABLE, &AIRCRAFT_TABLE, &ROTOR_TABLE,
                                                 &SPEED_TABLE, &BLADES_TABLE};
    *n = MT_COUNT(tables);
    return tables;
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
    aircraft_reader a = {.r = {.doc = doc, .diags = mt_json_diags(doc), .mem = mem},
                         .list = out};
    if (rc == MT_OK && mt_reader_format(&a.r, FORMAT, "catalogue of aircraft")) {
        (void)mt_members_read(&a.r, MT_JSON_ROOT, &ROOT_TABLE, out);
    }
    rc = mt_reader_status(&a.r, path, err);
    if (opt != NULL && opt->structural != NULL) {
        *opt->structural = a.r.diags->structural;
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

const mt_aircraft *mt_aircraft_find(const mt_aircraft_list *list, const char *name)
{
    for (int i = 0; i < list->n; i++) {
        if (strcmp(list->items[i].name.s, name) == 0) {
            return &list->items[i];
        }
    }
    return NULL;
}
