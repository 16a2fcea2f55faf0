/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rotors whose harmonics are to be avoided, and the catalogue of aircraft that they may come
 * from. */
#include "study/read_priv.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "environment/read_harmonics.h"
#include "environment/rotor.h"
#include "io/file.h"

static const double RPM_PER_HZ = 60.0;

/* True where the text multiplies by rpm, as speeds in Hz do ("258*rpm", or meant so: "258
 * rpm"). */
static bool times_rpm(const char *text)
{
    static const char RPM[] = "rpm";
    const size_t n = strlen(RPM);
    for (const char *at = strstr(text, RPM); at != NULL; at = strstr(at + 1, RPM)) {
        const char *before = at;
        while (before > text && before[-1] == ' ') {
            before--;
        }
        const char last = (char)(before > text ? before[-1] : ' ');
        const bool word = last != '_' && (before < at || isalnum((unsigned char)last) == 0) &&
                          at[n] != '_' && isalnum((unsigned char)at[n]) == 0;
        if (word && last != '/') {
            return true;
        }
    }
    return false;
}

/* A speed per minute, in Hz. An expression there that converts to Hz itself is refused: the
 * result would be a sixtieth of the intended speed. */
static void read_rpm(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const hz = (double *)(void *)((char *)item + key->at);
    if (mt_json_type_of(r->doc, value) == MT_JSON_STRING &&
        times_rpm(mt_json_string(r->doc, value))) {
        mt_diag_error(r->diags, value,
                      "is per minute as it is: leave out \"rpm\", or write it as \"speed_hz\"");
        return;
    }
    const double rpm = mt_read_study_number(mt_study_reader_of(r), value);
    *hz = MT_HAS(*hz) ? *hz : rpm / RPM_PER_HZ; /* beside "speed_hz" it is refused */
}

#define THIS mt_rotor
#define ROTOR_RPM(m, ...)                                          \
    {                                                              \
        .name = "speed_rpm", .type = MT_KEY_NUMBER, MT_M_ROW(RPM), \
        MT_M_TO(read_rpm, double, m), .says = __VA_ARGS__          \
    }
static const mt_key TAIL[] = {
    MT_S_NUMBER("speed_hz", false, tail_speed_hz, SPEED, "Nominal speed [1/s]."),
    ROTOR_RPM(tail_speed_hz, "Nominal speed [rpm]."),
    MT_M_COUNT("blades", false, tail_blades, 1, MT_MAX_BLADES, "Number of blades."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
const mt_key_table mt_study_tail_keys = {.what = "tail_rotor",
                                         .keys = TAIL,
                                         .n = MT_COUNT(TAIL),
                                         .one_of = 2,
                                         .says = "The tail rotor."};

static void read_rotor_harmonics(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    (void)key;
    mt_read_harmonics(r, value, item);
}

static const mt_key ROTOR[] = {
    MT_M_REF("aircraft", false, aircraft, "Name in the catalogue of aircraft."),
    MT_S_NUMBER("speed_hz", false, speed_hz, SPEED, "Nominal speed of the main rotor [1/s]."),
    ROTOR_RPM(speed_hz, "Nominal speed of the main rotor [rpm]."),
    MT_M_COUNT("blades", false, blades, 1, MT_MAX_BLADES,
               "Number of blades of the main rotor."),
    MT_M_INNER("tail", mt_study_tail_keys),
    MT_M_TEXT("name", name, "Its name in reports. Absent: the aircraft."),
    {.name = "harmonics",
     .type = MT_KEY_LIST,
     .required = true,
     .read = read_rotor_harmonics,
     .says = "Multiples of the rotor's speed: \"1P\", \"4P\" of the main rotor, \"1T\" of the "
             "tail rotor; n is the number of blades: \"nP\", \"2nP\" (or \"2NP\"), \"nT\".",
     .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", "
               "\"pattern\": \"^([1-9][0-9]{0,2}[nN]?|[nN])[PT]$\"}"},
    MT_S_PAIR("speed_range", false, range_lower, range_upper, FACTORS,
              "Least and greatest speed, as multiples of the nominal one.",
              .otherwise = "[1, 1]", .examples = "[[0.95, 1.05]]"),
    MT_S_NUMBER("margin_percent", false, margin_percent, MARGIN,
                "Separation margin on both sides of its bands, in percent of their edges. "
                "Absent: the goal's."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS

static void rotor_defaults(void *item, mt_addr addr, int which)
{
    mt_rotor *const rotor = item;
    (void)which;
    *rotor = mt_rotor_default(addr);
    rotor->aircraft.addr = addr;
}

/* An aircraft of the catalogue brings its own numbers. */
static void exclude(mt_reader *r, const mt_object *o, const char *member)
{
    if (mt_object_has(r, o, "aircraft") && mt_object_has(r, o, member)) {
        mt_diag_structure(r->diags, mt_json_name_addr(r->doc, mt_object_place(r, o, member)),
                          "\"%s\" excludes \"aircraft\"", member);
    }
}

static void rotor_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_rotor *const rotor = item;
    (void)which;
    exclude(r, o, "blades");
    exclude(r, o, "tail");
    rotor->aircraft.addr = mt_object_place(r, o, "aircraft");
    rotor->has_tail = mt_object_has(r, o, "tail");
    if (mt_object_value(o, "speed_range") != MT_NO_ADDR) {
        mt_read_warning_range(r, rotor->range_lower, rotor->range_upper, MT_ROTOR_LEAST_SPEED,
                              "rotor's", mt_object_value(o, "speed_range"));
    }
}

const mt_key_table mt_study_rotor_keys = {
    .what = "rotor",
    .keys = ROTOR,
    .n = MT_COUNT(ROTOR),
    .one_of = 3,
    .size = sizeof(mt_rotor),
    .defaults = rotor_defaults,
    .finish = rotor_finish,
    .says = "A rotor whose harmonics are forbidden: an aircraft of the catalogue, or a speed.",
    .examples = "[{\"aircraft\": \"UH-60\", \"harmonics\": [\"1P\", \"nP\"], \"speed_range\": "
                "[0.95, 1.05], \"margin_percent\": 10}]",
    .rules = "\"not\": {\"anyOf\": [{\"required\": [\"aircraft\", \"blades\"]}, {\"required\": "
             "[\"aircraft\", \"tail\"]}]}"};

static bool needs_catalogue(const mt_study *study)
{
    for (int i = 0; i < study->n_goals; i++) {
        const mt_avoid *const avoid = study->goals[i].avoid;
        for (int k = 0; avoid != NULL && k < avoid->source.n_rotors; k++) {
            if (avoid->source.rotors[k].aircraft.s != NULL) {
                return true;
            }
        }
    }
    return false;
}

static void load_study_aircraft(mt_study_reader *s, mt_name path, const char *file,
                                const mt_io_options *opt)
{
    mt_study *const study = s->study;
    mt_err why = {.code = MT_OK};
    const int told = s->model_messages->count;
    study->aircraft_path = path;
    const mt_status rc =
        mt_aircraft_load(file, opt, &study->mem, &study->aircraft, s->model_messages, &why);
    if (rc == MT_OK) {
        mt_read_study_note_input(s, path.s, study->aircraft.sha256);
    } else {
        study->aircraft = (mt_aircraft_list){0};
        mt_read_study_note_failure(s, path, file, rc, &why, s->model_messages->count > told);
    }
}

/* Where the study names no catalogue: the one beside the model, if there is one. */
static mt_name beside_model(mt_study_reader *s)
{
    const mt_name model = s->study->model_path;
    char *const joined = model.s == NULL ? NULL : mt_file_join(model.s, "aircraft.json");
    const mt_name path = {.s = joined == NULL ? NULL : mt_arena_strdup(&s->study->mem, joined),
                          .addr = model.addr};
    if (model.s != NULL && joined == NULL) {
        mt_arena_fail(s->r.mem);
    }
    free(joined);
    return path;
}

/* Load the catalogue built into the program. */
static void load_own(mt_study_reader *s)
{
    mt_file_text text;
    const mt_io_options opt = mt_aircraft_own(&text);
    const mt_name path = {.s = mt_aircraft_own_name, .addr = s->study->model_path.addr};
    load_study_aircraft(s, path, mt_aircraft_own_name, &opt);
}

void mt_read_study_aircraft(mt_study_reader *s, mt_addr value)
{
    const bool named = value != MT_NO_ADDR;
    if (!named && !needs_catalogue(s->study)) {
        return;
    }
    const mt_name path = named ? mt_reader_ref(&s->r, value) : beside_model(s);
    char *const file = path.s == NULL ? NULL : mt_file_join(s->study->path, path.s);
    if (path.s != NULL && file == NULL) {
        mt_arena_fail(s->r.mem);
    } else if (file != NULL && !named && mt_files_lack(&s->files.files, file)) {
        load_own(s);
    } else if (file != NULL) {
        load_study_aircraft(s, path, file, &s->files);
    }
    free(file);
}
