/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rotors of tones: as in studies, but that numbers are plain (there are no parameters) and no
 * margin belongs to them. */
#include "environment/read_profile_priv.h"

#include <stdlib.h>

#include "environment/read_aircraft.h"
#include "environment/read_harmonics.h"
#include "environment/rotor.h"
#include "io/file.h"

#define ROTOR_KEYS(X)                                                                      \
    X(ROTOR_AIRCRAFT, "aircraft", TEXT, false, NONE, "Name in the catalogue of aircraft.") \
    X(ROTOR_SPEED_HZ, "speed_hz", VALUE, false, SPEED,                                     \
      "Nominal speed of the main rotor [1/s].")                                            \
    X(ROTOR_SPEED_RPM, "speed_rpm", VALUE, false, RPM,                                     \
      "Nominal speed of the main rotor [rpm].")                                            \
    X(ROTOR_BLADES, "blades", COUNT, false, WHOLE, "Number of blades of the main rotor.",  \
      .least = 1, .most = 20)                                                              \
    X(ROTOR_TAIL, "tail", OBJECT, false, NONE, NULL,                                       \
      .schema = "\"$ref\": \"#/definitions/tail_rotor\"")                                  \
    X(ROTOR_NAME, "name", TEXT, false, NONE,                                               \
      "What labels call it. Absent: the aircraft's name, else \"rotor\".")                 \
    X(ROTOR_HARMONICS, "harmonics", LIST, true, NONE,                                      \
      "Harmonics: \"1P\", \"4P\", \"nP\" (n: the number of blades) of the main rotor, "    \
      "\"1T\", \"nT\" of the tail rotor.",                                                 \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", " \
                "\"pattern\": \"^([1-9][0-9]{0,2}[nN]?|[nN])[PT]$\"}")                     \
    X(ROTOR_RANGE, "speed_range", LIST, false, FACTORS,                                    \
      "Least and greatest speed as factors of the nominal one. Absent: 1 and 1.",          \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/pair\"}]")                         \
    X(ROTOR_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")        \
    X(ROTOR_SOURCE, "source", TEXT, false, NONE, "Where it comes from.")
enum { ROTOR_KEYS(MT_PROFILE_ENUM) ROTOR_COUNT };
static const mt_key ROTOR_LIST[] = {ROTOR_KEYS(MT_PROFILE_KEY)};
const mt_key_table mt_profile_rotor_keys = {
    .what = "rotor",
    .keys = ROTOR_LIST,
    .n = ROTOR_COUNT,
    .says = "A rotor that excites at its harmonics: an aircraft of the catalogue, or a speed.",
    .rules = "\"oneOf\": [{\"required\": [\"aircraft\"]}, {\"required\": [\"speed_hz\"]}, "
             "{\"required\": [\"speed_rpm\"]}], \"not\": {\"anyOf\": [{\"required\": "
             "[\"aircraft\", \"blades\"]}, {\"required\": [\"aircraft\", \"tail\"]}]}"};

#define TAIL_KEYS(X)                                                                           \
    X(TAIL_SPEED_HZ, "speed_hz", VALUE, false, SPEED, "Nominal speed [1/s].")                  \
    X(TAIL_SPEED_RPM, "speed_rpm", VALUE, false, RPM, "Nominal speed [rpm].")                  \
    X(TAIL_BLADES, "blades", COUNT, false, WHOLE, "Number of blades.", .least = 1, .most = 20) \
    X(TAIL_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")             \
    X(TAIL_SOURCE, "source", TEXT, false, NONE, "Where it comes from.")
enum { TAIL_KEYS(MT_PROFILE_ENUM) TAIL_COUNT };
static const mt_key TAIL_LIST[] = {TAIL_KEYS(MT_PROFILE_KEY)};
const mt_key_table mt_profile_tail_keys = {
    .what = "tail_rotor",
    .keys = TAIL_LIST,
    .n = TAIL_COUNT,
    .says = "The tail rotor.",
    .rules = "\"oneOf\": [{\"required\": [\"speed_hz\"]}, {\"required\": [\"speed_rpm\"]}]"};

static const double RPM_PER_HZ = 60.0;

/* Of two members, speed_hz and speed_rpm [Hz]. */
static double read_speed(mt_reader *r, const mt_addr *found, int hz)
{
    const int which = found[hz] != MT_NO_ADDR ? hz : hz + 1;
    const double speed = mt_read_profile_number(r, found[which]);
    return which == hz ? speed : speed / RPM_PER_HZ;
}

static void read_tail(mt_reader *r, mt_addr value, mt_rotor *rotor)
{
    mt_addr found[TAIL_COUNT];
    if (value == MT_NO_ADDR || !mt_reader_object(r, value, &mt_profile_tail_keys, found)) {
        return;
    }
    rotor->has_tail = true;
    (void)mt_read_profile_one_of(r, value, &mt_profile_tail_keys, TAIL_SPEED_HZ);
    rotor->tail_speed_hz = read_speed(r, found, TAIL_SPEED_HZ);
    rotor->tail_blades = mt_reader_count(r, found[TAIL_BLADES], 1, MT_MAX_BLADES, 0);
}

/* An aircraft of the catalogue brings its own numbers; a rotor without one gives them. */
static void check_members(mt_reader *r, mt_addr value)
{
    static const int own[] = {ROTOR_SPEED_HZ, ROTOR_SPEED_RPM, ROTOR_BLADES, ROTOR_TAIL};
    const bool hz =
        mt_json_member(r->doc, value, ROTOR_LIST[ROTOR_SPEED_HZ].name) != MT_NO_ADDR;
    const bool rpm =
        mt_json_member(r->doc, value, ROTOR_LIST[ROTOR_SPEED_RPM].name) != MT_NO_ADDR;
    if (mt_json_member(r->doc, value, ROTOR_LIST[ROTOR_AIRCRAFT].name) == MT_NO_ADDR) {
        if (!hz && !rpm) {
            mt_diag_structure(r->diags, value,
                              "one of \"aircraft\", \"speed_hz\" or \"speed_rpm\" is missing");
            return;
        }
        (void)mt_read_profile_one_of(r, value, &mt_profile_rotor_keys, ROTOR_SPEED_HZ);
        return;
    }
    for (int i = 0; i < MT_COUNT(own); i++) {
        const char *const name = ROTOR_LIST[own[i]].name;
        const mt_addr at = mt_json_member(r->doc, value, name);
        if (at != MT_NO_ADDR) {
            mt_diag_structure(r->diags, mt_json_name_addr(r->doc, at),
                              "\"%s\" excludes \"aircraft\"", name);
        }
    }
}

void mt_read_profile_rotor(mt_reader *r, mt_addr value, mt_rotor *rotor)
{
    mt_addr found[ROTOR_COUNT];
    *rotor = mt_rotor_default(value);
    rotor->aircraft.addr = value;
    if (value == MT_NO_ADDR || !mt_reader_object(r, value, &mt_profile_rotor_keys, found)) {
        return;
    }
    check_members(r, value);
    if (found[ROTOR_AIRCRAFT] != MT_NO_ADDR) {
        rotor->aircraft = mt_reader_ref(r, found[ROTOR_AIRCRAFT]);
    }
    rotor->name = mt_reader_text(r, found[ROTOR_NAME]);
    rotor->speed_hz = read_speed(r, found, ROTOR_SPEED_HZ);
    rotor->blades = mt_reader_count(r, found[ROTOR_BLADES], 1, MT_MAX_BLADES, 0);
    read_tail(r, found[ROTOR_TAIL], rotor);
    mt_read_harmonics(r, found[ROTOR_HARMONICS], rotor);
    if (mt_read_profile_pair(r, found[ROTOR_RANGE], &rotor->range_lower, &rotor->range_upper)) {
        mt_read_warning_range(r, rotor->range_lower, rotor->range_upper, MT_ROTOR_LEAST_SPEED,
                              "rotor's", found[ROTOR_RANGE]);
    }
}

static bool needs_catalogue(const mt_vibration *v)
{
    for (int i = 0; i < v->n_sources; i++) {
        if (v->sources[i].has_rotor && v->sources[i].rotor.aircraft.s != NULL) {
            return true;
        }
    }
    return false;
}

static void load_profile_aircraft(mt_read_profile *p, mt_addr place, const char *name,
                                  const char *file, const mt_io_options *opt)
{
    mt_vibration *const v = p->v;
    mt_err why = {.code = MT_OK};
    const int told = p->others->count;
    const mt_status rc = mt_aircraft_load(file, opt, &v->mem, &v->aircraft, p->others, &why);
    if (rc == MT_OK) {
        v->aircraft_name = name;
        return;
    }
    v->aircraft = (mt_aircraft_list){0};
    const bool final =
        mt_is_final(rc) || (rc == MT_E_SYSTEM && !mt_files_lack(&opt->files, file));
    if (!final && p->others->count == told) {
        mt_diag_error(p->r.diags, place, "%s", why.text);
    }
    p->failed = final ? rc : MT_E_INPUT;
    p->why = why;
}

void mt_read_profile_aircraft(mt_read_profile *p, mt_addr value)
{
    const bool named = value != MT_NO_ADDR;
    if (!named && !needs_catalogue(p->v)) {
        return;
    }
    const char *const name = named ? mt_reader_text(&p->r, value) : "aircraft.json";
    char *const file = name == NULL ? NULL : mt_file_join(p->v->path, name);
    if (name != NULL && file == NULL) {
        mt_arena_fail(p->r.mem);
    } else if (file != NULL && !named && mt_files_lack(&p->files.files, file)) {
        mt_file_text text;
        const mt_io_options own = mt_aircraft_own(&text);
        load_profile_aircraft(p, MT_JSON_ROOT, mt_aircraft_own_name, mt_aircraft_own_name,
                              &own);
    } else if (file != NULL) {
        load_profile_aircraft(p, named ? value : MT_JSON_ROOT, name, file, &p->files);
    }
    free(file);
}
