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

#define ROTOR_KEYS(X)                                               \
    X(ROTOR_AIRCRAFT, "aircraft", MT_KEY_TEXT, false)               \
    X(ROTOR_SPEED_HZ, "speed_hz", MT_KEY_NUMBER, false, SPEED)      \
    X(ROTOR_SPEED_RPM, "speed_rpm", MT_KEY_NUMBER, false, RPM)      \
    X(ROTOR_BLADES, "blades", MT_KEY_COUNT, false, WHOLE)           \
    X(ROTOR_TAIL, "tail", MT_KEY_OBJECT, false)                     \
    X(ROTOR_NAME, "name", MT_KEY_TEXT, false)                       \
    X(ROTOR_HARMONICS, "harmonics", MT_KEY_LIST, true)              \
    X(ROTOR_RANGE, "speed_range", MT_KEY_LIST, false, FACTORS)      \
    X(ROTOR_MARGIN, "margin_percent", MT_KEY_NUMBER, false, MARGIN) \
    X(ROTOR_DESCRIPTION, "description", MT_KEY_TEXT, false)         \
    X(ROTOR_SOURCE, "source", MT_KEY_TEXT, false)
enum { ROTOR_KEYS(MT_STUDY_KEY_ENUM) ROTOR_KEY_COUNT };
static const mt_key ROTOR[] = {ROTOR_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_rotor_keys = {"rotor", ROTOR, ROTOR_KEY_COUNT};

#define TAIL_KEYS(X)                                          \
    X(TAIL_SPEED_HZ, "speed_hz", MT_KEY_NUMBER, false, SPEED) \
    X(TAIL_SPEED_RPM, "speed_rpm", MT_KEY_NUMBER, false, RPM) \
    X(TAIL_BLADES, "blades", MT_KEY_COUNT, false, WHOLE)      \
    X(TAIL_DESCRIPTION, "description", MT_KEY_TEXT, false)    \
    X(TAIL_SOURCE, "source", MT_KEY_TEXT, false)
enum { TAIL_KEYS(MT_STUDY_KEY_ENUM) TAIL_KEY_COUNT };
static const mt_key TAIL[] = {TAIL_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_tail_keys = {"tail_rotor", TAIL, TAIL_KEY_COUNT};

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

/* Read a speed per minute, in Hz. An expression there that converts to Hz itself is refused:
 * the result would be a sixtieth of the intended speed. */
static double read_rpm(mt_study_reader *s, const mt_study_object *o, int key)
{
    const mt_addr at = o->found[key];
    if (at != MT_NO_ADDR && mt_json_type_of(s->r.doc, at) == MT_JSON_STRING &&
        times_rpm(mt_json_string(s->r.doc, at))) {
        mt_diag_error(s->r.diags, at,
                      "is per minute as it is: leave out \"rpm\", or write it as \"speed_hz\"");
        return mt_read_study_number(s, MT_NO_ADDR);
    }
    return mt_read_study_number(s, at) / RPM_PER_HZ;
}

/* One of two members, neighbours in the table: speed_hz or speed_rpm [Hz]. */
static double read_speed(mt_study_reader *s, const mt_study_object *o, int hz)
{
    if (mt_read_study_has(s, o, hz)) {
        return mt_read_study_number(s, o->found[hz]);
    }
    if (mt_read_study_has(s, o, hz + 1)) {
        return read_rpm(s, o, hz + 1);
    }
    return mt_read_study_number(s, MT_NO_ADDR);
}

static void read_tail(mt_study_reader *s, mt_addr value, mt_rotor *rotor)
{
    mt_study_object o;
    if (value == MT_NO_ADDR || !mt_read_study_object(s, value, &mt_study_tail_keys, &o)) {
        return;
    }
    (void)mt_read_study_one_of(s, &o, TAIL_SPEED_HZ, 2);
    rotor->tail_speed_hz = read_speed(s, &o, TAIL_SPEED_HZ);
    rotor->tail_blades = mt_reader_count(&s->r, o.found[TAIL_BLADES], 1, MT_MAX_BLADES, 0);
}

/* An aircraft of the catalogue brings its own numbers. */
static void exclude(mt_study_reader *s, const mt_study_object *o, int key)
{
    if (mt_read_study_has(s, o, ROTOR_AIRCRAFT) && mt_read_study_has(s, o, key)) {
        mt_diag_structure(s->r.diags,
                          mt_json_name_addr(s->r.doc, mt_read_study_place(s, o, key)),
                          "\"%s\" excludes \"aircraft\"", o->table->keys[key].name);
    }
}

void mt_read_study_rotor(mt_study_reader *s, mt_addr value, mt_rotor *rotor)
{
    mt_study_object o;
    double range[2];
    *rotor = mt_rotor_default(value);
    rotor->aircraft.addr = value;
    if (!mt_read_study_object(s, value, &mt_study_rotor_keys, &o)) {
        return;
    }
    (void)mt_read_study_one_of(s, &o, ROTOR_AIRCRAFT, 3);
    exclude(s, &o, ROTOR_BLADES);
    exclude(s, &o, ROTOR_TAIL);
    rotor->aircraft = mt_reader_ref(&s->r, o.found[ROTOR_AIRCRAFT]);
    rotor->aircraft.addr = mt_read_study_place(s, &o, ROTOR_AIRCRAFT);
    rotor->name = mt_reader_text(&s->r, o.found[ROTOR_NAME]);
    rotor->speed_hz = read_speed(s, &o, ROTOR_SPEED_HZ);
    rotor->blades = mt_reader_count(&s->r, o.found[ROTOR_BLADES], 1, MT_MAX_BLADES, 0);
    rotor->has_tail = mt_read_study_has(s, &o, ROTOR_TAIL);
    read_tail(s, o.found[ROTOR_TAIL], rotor);
    mt_read_harmonics(&s->r, o.found[ROTOR_HARMONICS], rotor);
    if (o.found[ROTOR_RANGE] != MT_NO_ADDR &&
        mt_read_study_pair(s, o.found[ROTOR_RANGE], o.found[ROTOR_RANGE], range)) {
        rotor->range_lower = range[0];
        rotor->range_upper = range[1];
        mt_read_warning_range(&s->r, range[0], range[1], MT_ROTOR_LEAST_SPEED, "rotor's",
                              o.found[ROTOR_RANGE]);
    }
    rotor->margin_percent = mt_read_study_number(s, o.found[ROTOR_MARGIN]);
}

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
