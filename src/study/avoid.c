/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals of type "avoid": what makes bands (machines with orders and gear meshes, rotors with
 * harmonics), the catalogue of aircraft that rotors may come from, and the checks. */
#include "study/avoid.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "environment/aircraft.h"
#include "environment/rotor.h"
#include "io/file.h"
#include "study/check.h"
#include "study/reader.h"

/* Machines */

/* A bare number: times per turn, or of the mesh. */
static void refuse_number(mt_study_reader *s, mt_addr at, char letter)
{
    const char *const meant =
        mt_arena_printf(s->r.mem, "%.10g%c", mt_json_number(s->r.doc, at), letter);
    mt_order is;
    const bool good = meant != NULL && mt_order_parse(meant, letter, &is);
    mt_diag_structure(s->r.diags, at, "must be a string, not a number%s%s%s",
                      good ? ": orders are written \"" : "", good ? meant : "",
                      !good           ? ""
                      : letter == 'E' ? "\", times per turn"
                                      : "\", multiples of the gear mesh");
}

static mt_order *read_orders(mt_study_reader *s, mt_addr list, char letter, int *n)
{
    mt_items items = mt_reader_some_items(&s->r, list, "the list of orders");
    mt_order *const orders = mt_reader_room(&s->r, &items, sizeof *orders);
    while (mt_items_next(&items)) {
        if (mt_json_type_of(s->r.doc, items.at) == MT_JSON_NUMBER) {
            refuse_number(s, items.at, letter);
            continue;
        }
        const char *const text = mt_reader_text(&s->r, items.at);
        if (text != NULL && mt_order_parse(text, letter, &orders[*n])) {
            orders[(*n)++].addr = items.at;
        } else if (text != NULL) {
            const char *const meant = mt_read_multiple_meant(&s->r, text, letter);
            mt_order is;
            const bool good = meant != NULL && mt_order_parse(meant, letter, &is);
            mt_diag_structure(
                s->r.diags, items.at,
                "\"%s\" is not an order: a number above 0 and below 1000 with at most three "
                "decimals, then %c (%s)%s%s%s",
                text, letter, letter == 'E' ? "times per turn" : "multiples of the gear mesh",
                good ? "; did you mean \"" : "", good ? meant : "", good ? "\"?" : "");
        }
    }
    return orders;
}

static void gear_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_gear *)item = mt_gear_default(addr);
}

static void gear_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_gear *const gear = item;
    (void)which;
    gear->orders =
        read_orders(mt_study_reader_of(r), mt_object_value(o, "orders"), 'G', &gear->n_orders);
}

#define THIS mt_gear
static const mt_key GEAR[] = {
    MT_M_COUNT("teeth", true, teeth, 1, MT_MAX_TEETH, "Number of teeth."),
    MT_S_NUMBER("ratio", false, ratio, POSITIVE,
                "Turns of its shaft per turn of the machine's.", .otherwise = "1"),
    {.name = "orders",
     .type = MT_KEY_LIST,
     .says = "Multiples of the mesh, up to three decimals: \"1G\", \"2G\".",
     .otherwise = "[\"1G\"]",
     .schema =
         "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", \"pattern\": "
         "\"^(?!0(\\\\.0{1,3})?G)(0|[1-9][0-9]{0,2})(\\\\.[0-9]{1,3})?G$\"}"},
    MT_M_COUNT("sidebands", false, sidebands, 0, MT_MAX_SIDEBANDS,
               "Number of sidebands on each side of every multiple, spaced by the speed of its "
               "own shaft.",
               .otherwise = "0"),
    MT_M_TEXT("name", name, "Its name in reports. Absent: the machine."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_gear_keys = {
    .what = "gear",
    .keys = GEAR,
    .n = MT_COUNT(GEAR),
    .size = sizeof(mt_gear),
    .defaults = gear_defaults,
    .finish = gear_finish,
    .says = "A gear of a machine: it meshes teeth times ratio times per turn of the machine.",
    .examples = "[{\"name\": \"pinion\", \"teeth\": 23, \"ratio\": 1.5, \"orders\": [\"1G\", "
                "\"2G\"], \"sidebands\": 1}]"};

static void machine_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_machine *)item = mt_machine_default(addr);
}

/* A nominal speed with factors, or the two speeds themselves; orders, or gears. */
static void machine_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_machine *const machine = item;
    const mt_addr range = mt_object_value(o, "speed_range");
    (void)which;
    if (mt_object_has(r, o, "speed_range") && !mt_object_has(r, o, "speed_hz")) {
        mt_diag_structure(r->diags, mt_object_place(r, o, "speed_range"),
                          "\"speed_range\" multiplies \"speed_hz\", which is missing");
    }
    if (range != MT_NO_ADDR && MT_HAS(machine->range_lower)) {
        mt_read_warning_range(r, machine->range_lower, machine->range_upper,
                              MT_MACHINE_LEAST_SPEED, "machine's", range);
    }
    if (!mt_object_has(r, o, "orders") && !mt_object_has(r, o, "gears")) {
        (void)mt_object_one_of(r, o, "orders", 2);
    }
    machine->orders = read_orders(mt_study_reader_of(r), mt_object_value(o, "orders"), 'E',
                                  &machine->n_orders);
}

#define THIS mt_machine
static const mt_key MACHINE[] = {
    MT_S_NUMBER("speed_hz", false, speed_hz, MACHINE,
                "Nominal speed [1/s]; \"1500*rpm\" is 25."),
    MT_S_PAIR("speed_range_hz", false, lower_hz, upper_hz, MACHINE,
              "Least and greatest speed [1/s]."),
    MT_S_PAIR("speed_range", false, range_lower, range_upper, FACTORS,
              "Least and greatest speed, as multiples of the nominal one.",
              .otherwise = "[1, 1]", .examples = "[[0.95, 1.05]]"),
    MT_M_TEXT("name", name, "Its name in reports. Absent: \"machine\"."),
    {.name = "orders",
     .type = MT_KEY_LIST,
     .says = "Events per turn of its shaft, up to three decimals: \"1E\"; half orders of a "
             "four-stroke engine \"0.5E\", \"1.5E\".",
     .schema =
         "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", \"pattern\": "
         "\"^(?!0(\\\\.0{1,3})?E)(0|[1-9][0-9]{0,2})(\\\\.[0-9]{1,3})?E$\"}"},
    MT_M_ITEMS("gears", false, gears, n_gears, mt_gear, "the list of gears", mt_study_gear_keys,
               "Gears whose meshes are forbidden too."),
    MT_S_NUMBER("margin_percent", false, margin_percent, MARGIN,
                "Separation margin on both sides of its bands, in percent of their edges. "
                "Absent: the goal's."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_machine_keys = {
    .what = "machine",
    .keys = MACHINE,
    .n = MT_COUNT(MACHINE),
    .one_of = 2,
    .size = sizeof(mt_machine),
    .defaults = machine_defaults,
    .finish = machine_finish,
    .says = "A machine (engine, pump, gearbox) whose orders are forbidden over its range of "
            "speeds: events per turn of its shaft, and gear meshes.",
    .examples = "[{\"name\": \"engine\", \"speed_range_hz\": [\"700*rpm\", \"3000*rpm\"], "
                "\"orders\": [\"0.5E\", \"1E\", \"2E\"], \"margin_percent\": 10}]",
    .rules = "\"anyOf\": [{\"required\": [\"orders\"]}, {\"required\": [\"gears\"]}], "
             "\"dependencies\": {\"speed_range\": [\"speed_hz\"]}"};

/* Rotors */

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

/* The goal */

static void read_bands(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const mt_key edges = {.name = key->name,
                          .possible = key->possible,
                          .at = offsetof(mt_band_hz, lower_hz),
                          .other = offsetof(mt_band_hz, upper_hz)};
    mt_bands_source *const source = &((mt_goal_parts *)item)->avoid.source;
    mt_items items = mt_reader_some_items(r, value, key->what);
    source->intervals = mt_reader_room(r, &items, sizeof *source->intervals);
    while (mt_items_next(&items)) {
        mt_band_hz *const band = &source->intervals[source->n_intervals++];
        *band = (mt_band_hz){nan(""), nan(""), items.at};
        mt_study_pair(r, &edges, items.at, band);
    }
}

/* Structs of the row's table and their number: of a list, or of the single one. A wrong one
 * still counts. */
static void read_sources(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    int *const n = (int *)(void *)((char *)item + key->other);
    mt_items items = key->type == MT_KEY_LIST ? mt_reader_some_items(r, value, key->what)
                                              : mt_reader_one_or_items(r, value);
    char *const room = mt_reader_room(r, &items, key->of->size);
    while (mt_items_next(&items)) {
        if (mt_reader_type(r, items.at, MT_KEY_OBJECT)) {
            (void)mt_members_read(r, items.at, key->of, room + ((size_t)*n * key->of->size));
            (*n)++;
        }
    }
    memcpy((char *)item + key->at, &room, sizeof room);
}

#define THIS mt_goal_parts
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
#define SOURCES(of, m, n) \
    MT_M_TO(read_sources, of *, avoid.source.m), .other = MT_M_PLACE(int, avoid.source.n)
/* NOLINTEND(bugprone-macro-parentheses) */
static const mt_key AVOID[] = {
    MT_GOAL_ROWS("The goal is met within this, in percent of a band's edge."),
    MT_GOAL_CONFIGURATION_ROWS,
    {.name = "bands_hz",
     .type = MT_KEY_NUMBERS,
     MT_M_ROW(BAND),
     .read = read_bands,
     .what = "the list of bands",
     .says = "Bands [lower, upper] [Hz].",
     .examples = "[[[15.5, 18.9]]]",
     .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": "
               "\"#/definitions/pair\"}"},
    {.name = "rotor",
     .type = MT_KEY_OBJECT,
     SOURCES(mt_rotor, rotors, n_rotors),
     .of = &mt_study_rotor_keys},
    {.name = "rotors",
     .type = MT_KEY_LIST,
     SOURCES(mt_rotor, rotors, n_rotors),
     .what = "the list of rotors",
     .of = &mt_study_rotor_keys,
     .says = "Several rotors."},
    {.name = "machine",
     .type = MT_KEY_OBJECT,
     SOURCES(mt_machine, machines, n_machines),
     .of = &mt_study_machine_keys},
    {.name = "machines",
     .type = MT_KEY_LIST,
     SOURCES(mt_machine, machines, n_machines),
     .what = "the list of machines",
     .of = &mt_study_machine_keys,
     .says = "Several machines."},
    MT_S_NUMBER("margin_percent", false, avoid.source.margin_percent, MARGIN,
                "Separation margin on both sides of every band, in percent of its edges: of "
                "\"bands_hz\", and of rotors and machines that give none.",
                .otherwise = "0"),
    MT_S_NUMBER("up_to_hz", false, avoid.source.up_to_hz, POSITIVE,
                "Bands are cut off at this frequency [Hz]; modes above it are free."),
    MT_M_COUNT("cluster", false, avoid.cluster, 1, MT_MAX_CLUSTER,
               "Number of neighbouring modes on each side of a band that the search constrains "
               "individually.",
               .otherwise = "2"),
};
#undef THIS

static void avoid_defaults(void *item, mt_addr addr, int which)
{
    (void)addr;
    (void)which;
    ((mt_goal_parts *)item)->avoid = (mt_avoid){
        .source = {.margin_percent = nan(""), .up_to_hz = nan("")},
        .cluster = MT_DEFAULT_CLUSTER,
    };
}

static void avoid_check(mt_reader *r, mt_object *o)
{
    static const char *const alone[][2] = {{"rotor", "rotors"}, {"machine", "machines"}};
    static const char *const makes[] = {"bands_hz", "rotor", "rotors", "machine", "machines"};
    bool any = false;
    mt_goal_check(r, o);
    for (int i = 0; i < MT_COUNT(makes); i++) {
        any = any || mt_object_has(r, o, makes[i]);
    }
    if (!any) {
        (void)mt_object_one_of(r, o, makes[0], MT_COUNT(makes));
    }
    for (int i = 0; i < MT_COUNT(alone); i++) {
        if (mt_object_has(r, o, alone[i][0]) && mt_object_has(r, o, alone[i][1])) {
            (void)mt_object_one_of(r, o, alone[i][0], 2);
        }
        if (mt_object_value(o, alone[i][1]) != MT_NO_ADDR) {
            mt_object_leave_out(o, alone[i][0], 1);
        }
    }
}

static void avoid_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal_parts *const parts = item;
    mt_goal_finish(r, o, which, item);
    parts->goal.avoid = mt_arena_alloc(r->mem, 1, sizeof parts->avoid);
    if (parts->goal.avoid != NULL) {
        *parts->goal.avoid = parts->avoid;
    }
}

const mt_key_table mt_goal_avoid_keys = {
    .what = "goal_avoid",
    .keys = AVOID,
    .n = MT_COUNT(AVOID),
    .defaults = avoid_defaults,
    .check = avoid_check,
    .finish = avoid_finish,
    .says = "Forbidden frequency bands: every mode keeps clear of them. Bands that overlap are "
            "merged.",
    .rules = "\"anyOf\": [{\"required\": [\"bands_hz\"]}, {\"required\": [\"rotor\"]}, "
             "{\"required\": [\"rotors\"]}, {\"required\": [\"machine\"]}, {\"required\": "
             "[\"machines\"]}], \"allOf\": [{" MT_GOAL_ONE_OR_SEVERAL
             "}, {\"not\": {\"required\": [\"rotor\", \"rotors\"]}}, {\"not\": "
             "{\"required\": [\"machine\", \"machines\"]}}]"};

/* The catalogue of aircraft */

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

/* Checks */

static void check_intervals(mt_study_check *c, const mt_bands_source *source)
{
    for (int i = 0; i < source->n_intervals; i++) {
        const mt_band_hz *const band = &source->intervals[i];
        if (band->lower_hz >= band->upper_hz) {
            mt_diag_error(c->diags, band->addr, "the band's end (%g Hz) is not above %g Hz",
                          band->upper_hz, band->lower_hz);
        }
    }
}

/* Warn, also in the result, that an unconfirmed value is used. */
static void warn_unconfirmed(mt_study_check *c, const mt_rotor *rotor,
                             const mt_aircraft *aircraft)
{
    mt_rotor_warning warning_list[MT_ROTOR_WARNINGS];
    const int n = mt_rotor_warnings(rotor, aircraft, warning_list);
    for (int i = 0; i < n; i++) {
        const mt_rotor_warning *const d = &warning_list[i];
        mt_diag_warning(c->diags, rotor->aircraft.addr, "%s: the %s (%s) is unconfirmed",
                        rotor->aircraft.s, d->what, d->value->text);
        mt_check_warn_result(
            c, mt_arena_printf(&c->study->mem,
                               "%s: the %s (%s) is unconfirmed (source needed: %s)",
                               rotor->aircraft.s, d->what, d->value->text, d->value->source));
    }
}

/* The aircraft of that name. NULL where the name is absent or unknown (noted, unless the
 * catalogue itself could not be read). */
static const mt_aircraft *find_aircraft(mt_study_check *c, mt_name name)
{
    const mt_aircraft_list *const list = &c->study->aircraft;
    if (name.s == NULL) {
        return NULL;
    }
    const mt_aircraft *const found = mt_aircraft_find(list, name.s);
    if (found == NULL && list->n > 0) {
        mt_check_unknown_name(c, name, "aircraft", list->items, list->n, sizeof *list->items);
    }
    return found;
}

static void check_rotor(mt_study_check *c, const mt_avoid *avoid, mt_rotor *rotor)
{
    const mt_aircraft *const aircraft = find_aircraft(c, rotor->aircraft);
    if (aircraft != NULL) {
        mt_rotor_take(rotor, aircraft);
        warn_unconfirmed(c, rotor, aircraft);
    }
    if (aircraft != NULL || rotor->aircraft.addr == rotor->addr) {
        /* else the aircraft is wrong, which says enough */
        mt_rotor_check_harmonics(rotor, aircraft, c->diags);
    }
    mt_rotor_check_range(rotor, c->diags);
    const double margin =
        MT_HAS(rotor->margin_percent) ? rotor->margin_percent : avoid->source.margin_percent;
    if (rotor->range_lower == rotor->range_upper && !(margin > 0.0)) {
        mt_diag_error(c->diags, rotor->addr,
                      "the bands have no width: give \"speed_range\" or \"margin_percent\"");
    }
}

static void check_orders(mt_study_check *c, const mt_order *orders, int n)
{
    if (n > 0 && mt_rotor_too_many(c->diags, n, orders[0].addr, "orders")) {
        return;
    }
    for (int i = 1; i < n; i++) {
        for (int k = 0; k < i; k++) {
            if (orders[k].thousandths == orders[i].thousandths) {
                mt_diag_error(c->diags, orders[i].addr, "order \"%s\" is given twice",
                              orders[i].text);
                break;
            }
        }
    }
}

static void check_gear(mt_study_check *c, const mt_gear *gear)
{
    double least = 1.0;
    check_orders(c, gear->orders, gear->n_orders);
    for (int i = 0; i < gear->n_orders; i++) {
        const double times = (double)gear->orders[i].thousandths / 1000.0;
        least = i == 0 ? times : fmin(least, times);
    }
    if (gear->teeth > 0 && !(least * gear->teeth > gear->sidebands)) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, gear->addr, "sidebands"),
                      "sideband %d of a mesh of %g per turn does not lie above 0 Hz",
                      gear->sidebands, least * gear->teeth);
    }
}

static void check_machine(mt_study_check *c, const mt_avoid *avoid, const mt_machine *machine)
{
    const double lower = mt_machine_speed_hz(machine, 0);
    const double upper = mt_machine_speed_hz(machine, 1);
    if (!(machine->speed_hz <= 0.0) && lower > upper) {
        mt_diag_error(c->diags, mt_machine_range_addr(machine, c->diags),
                      "the range of speeds (%g to %g Hz) must be ascending", lower, upper);
    }
    check_orders(c, machine->orders, machine->n_orders);
    for (int i = 0; i < machine->n_gears; i++) {
        check_gear(c, &machine->gears[i]);
    }
    if (lower == upper && !(mt_bands_margin(&avoid->source, machine->margin_percent) > 0.0)) {
        mt_diag_error(c->diags, machine->addr,
                      "the bands have no width: give a range of speeds or \"margin_percent\"");
    }
}

/* True where the rotor's speed is known. A catalogue that could not be read (noted) leaves
 * rotors without a speed. */
static bool has_rotor_speeds(const mt_bands_source *source)
{
    for (int i = 0; i < source->n_rotors; i++) {
        if (!MT_HAS(source->rotors[i].speed_hz)) {
            return false;
        }
    }
    return true;
}

static void make_bands(mt_study_check *c, const mt_goal *goal)
{
    mt_avoid *const avoid = goal->avoid;
    mt_study *const s = c->study;
    if (mt_bands_make(&avoid->source, nan(""), &s->mem, &avoid->bands, NULL) != MT_OK) {
        return; /* as the arena knows */
    }
    if (avoid->bands.n == 0) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, goal->addr, "up_to_hz"),
                      "no band lies below up_to_hz (%g)", avoid->source.up_to_hz);
    }
    for (int i = 0; i < avoid->bands.n_notes; i++) {
        mt_check_warn_result(c, mt_arena_printf(&s->mem, "/goals/%d: %s",
                                                (int)(goal - s->goals), avoid->bands.notes[i]));
    }
}

/* Warn where the name is that of a body of the model: its modes are those of the mechanism at
 * rest. */
static void warn_spin(mt_study_check *c, const mt_goal *goal, const char *name)
{
    const mt_model *const model = c->study->model;
    for (int i = 0; name != NULL && i < model->n_bodies; i++) {
        if (strcmp(model->bodies[i].name.s, name) == 0) {
            mt_check_warn_result(
                c, mt_arena_printf(&c->study->mem,
                                   "/goals/%d: body \"%s\" turns, and the modes are those of "
                                   "the mechanism at rest: without the gyroscopic and "
                                   "centrifugal terms of what spins",
                                   (int)(goal - c->study->goals), model->bodies[i].name.s));
            return;
        }
    }
}

static void warn_spins(mt_study_check *c, const mt_goal *goal)
{
    const mt_bands_source *const source = &goal->avoid->source;
    for (int i = 0; i < source->n_rotors; i++) {
        warn_spin(c, goal, source->rotors[i].name);
    }
    for (int i = 0; i < source->n_machines; i++) {
        const mt_machine *const m = &source->machines[i];
        warn_spin(c, goal, m->name);
        for (int k = 0; k < m->n_gears; k++) {
            warn_spin(c, goal, m->gears[k].name);
        }
    }
}

void mt_study_check_avoid(mt_study_check *c, mt_goal *goal)
{
    mt_avoid *const avoid = goal->avoid;
    if (avoid == NULL) {
        mt_diag_error(c->diags, goal->addr, "the goal names no bands");
        return;
    }
    check_intervals(c, &avoid->source);
    /* several rotors or machines without a name are told apart by number */
    for (int i = 0; i < avoid->source.n_rotors; i++) {
        mt_rotor *const rotor = &avoid->source.rotors[i];
        if (avoid->source.n_rotors > 1 && rotor->name == NULL && rotor->aircraft.s == NULL) {
            rotor->name = mt_arena_printf(&c->study->mem, "rotor %d", i + 1);
        }
        check_rotor(c, avoid, rotor);
    }
    for (int i = 0; i < avoid->source.n_machines; i++) {
        mt_machine *const machine = &avoid->source.machines[i];
        if (avoid->source.n_machines > 1 && machine->name == NULL) {
            machine->name = mt_arena_printf(&c->study->mem, "machine %d", i + 1);
        }
        check_machine(c, avoid, machine);
    }
    if (c->diags->errors == 0 && has_rotor_speeds(&avoid->source)) {
        make_bands(c, goal);
        warn_spins(c, goal);
    }
}
