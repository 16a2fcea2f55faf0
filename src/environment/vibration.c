/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles of vibration: densities by their breakpoints, the tables and the reader of the
 * document, and what is made of it: densities, tones and marks. */
#include "environment/vibration.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/possible.h"
#include "base/text.h"
#include "io/file.h"
#include "io/json.h"
#include "io/members.h"

static const double DB_PER_OCTAVE = 3.0102999566398120; /* 10 log10(2): of an exponent of 1 */
/* Numbers nearer to each other than this factor have the logarithm of their quotient from their
 * difference. */
static const double CLOSE = 2.0;

double mt_psd_log_ratio(double a, double b)
{
    return b < CLOSE * a && a < CLOSE * b ? log1p((b - a) / a) : log(b / a);
}

double mt_psd_exponent(const mt_psd *psd, int i)
{
    const double l = mt_psd_log_ratio(psd->hz[i], psd->hz[i + 1]);
    return l > 0.0 ? mt_psd_log_ratio(psd->level[i], psd->level[i + 1]) / l : 0.0;
}

double mt_psd_slope_db(const mt_psd *psd, int i)
{
    return DB_PER_OCTAVE * mt_psd_exponent(psd, i);
}

double mt_psd_at(const mt_psd *psd, double hz)
{
    double most = 0.0;
    for (int i = 0; i + 1 < psd->n; i++) {
        if (hz >= psd->hz[i] && hz <= psd->hz[i + 1]) {
            const double l = mt_psd_log_ratio(psd->hz[i], hz);
            most = fmax(most, hz == psd->hz[i + 1]
                                  ? psd->level[i + 1]
                                  : psd->level[i] * exp(mt_psd_exponent(psd, i) * l));
        }
    }
    return most;
}

double mt_psd_power_integral(double e, double l)
{
    const double x = e * l;
    return x == 0.0 ? l : l * (expm1(x) / x);
}

double mt_psd_area(const mt_psd *psd, double from_hz, double to_hz)
{
    double sum = 0.0;
    for (int i = 0; i + 1 < psd->n; i++) {
        const double a = fmax(from_hz, psd->hz[i]);
        const double b = fmin(to_hz, psd->hz[i + 1]);
        if (a < b) {
            const double e = mt_psd_exponent(psd, i);
            const double level = psd->level[i] * exp(e * mt_psd_log_ratio(psd->hz[i], a));
            sum += level * a * mt_psd_power_integral(e + 1.0, mt_psd_log_ratio(a, b));
        }
    }
    return sum;
}

double mt_psd_mean_square(const mt_psd *psd)
{
    return mt_psd_area(psd, psd->hz[0], psd->hz[psd->n - 1]);
}

static const double DEFAULT_SIGMA = 3.0;
static const double DB_PER_DECADE = 10.0;
/* An RMS that is printed has some digits; one that is further off is a typing error. */
static const double PUBLISHED_TOL = 0.01;
/* So many harmonics are named one by one, and so many sentences looked back. */
enum { LISTED_MOST = 6, LAST_MARKS = 16 };

const char *const mt_vibration_sum_names[MT_TONES_RULES] = {"sum", "largest",
                                                            "root_sum_square"};

static const double RPM_PER_HZ = 60.0;
static const char FORMAT[] = "modetune-profile/1";
static const char *const FORMATS[] = {FORMAT};
static const char *const AXES[] = {"x", "y", "z"};
static const char *const ORIGINS[] = {"published", "identified", "assumed"};

/* The state of reading a profile. */
typedef struct profile_reader {
    mt_reader r;
    mt_vibration *v;
    mt_io_options files;
    mt_diagnostics *others; /* diagnostics of the catalogue of aircraft */
    mt_status failed;       /* reason of failing to read the catalogue */
    mt_err why;
} profile_reader;

/* A plain number; NaN where it is none (noted). */
static double read_bare(mt_reader *r, mt_addr value)
{
    return mt_reader_type(r, value, MT_KEY_VALUE) ? mt_json_number(r->doc, value) : nan("");
}

/* Two numbers, lower and upper. */
static void read_range(mt_reader *r, mt_addr value, double *lower, double *upper)
{
    mt_addr ends[2];
    if (mt_reader_pair(r, value, &ends[0], &ends[1]) != 2) {
        mt_diag_structure(r->diags, value, "must be two numbers: [lower, upper]");
        return;
    }
    *lower = read_bare(r, ends[0]);
    *upper = read_bare(r, ends[1]);
    mt_reader_check_range(r, value, ends[0], *lower);
    mt_reader_check_range(r, value, ends[1], *upper);
}

static void read_origin(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_origin *const origin = (mt_origin *)(void *)((char *)item + key->at);
    /* the list lacks the first origin, none; MT_ABSENT is -1 */
    *origin = (mt_origin)(mt_reader_choice(r, value, "origin", ORIGINS, MT_COUNT(ORIGINS)) + 1);
}

/* where the numbers of a part come from */
#define ORIGIN(of)                                    \
    {.name = "origin",                                \
     .type = MT_KEY_TEXT,                             \
     MT_M_TO(read_origin, mt_origin, origin.origin),  \
     .schema = "\"$ref\": \"#/definitions/origin\""}, \
        MT_M_TEXT("source", origin.source, "Where the " of " from."), MT_M_DESCRIPTION

/* A breakpoint with a slope. */
#define THIS mt_vibration_point
static const mt_key POINT[] = {
    MT_M_VALUE("frequency_hz", true, hz, HZ, "Frequency [Hz]."),
    MT_M_VALUE("slope_db_per_octave", true, slope_db, SLOPE,
               "Slope of the segment between the two, for rising frequency [dB/octave]."),
};
#undef THIS
static const mt_key_table POINT_TABLE = {
    .what = "slope",
    .keys = POINT,
    .n = MT_COUNT(POINT),
    .says = "A breakpoint whose density follows from a slope: from the breakpoint before it "
            "or, in front of the first density, from the one after it."};

/* [f, level], or an object with a slope, of the list of a density. */
static void read_point(mt_reader *r, mt_addr list, mt_addr value, mt_vibration_random *out)
{
    mt_vibration_point p = {
        .hz = nan(""), .level = nan(""), .slope_db = nan(""), .addr = value};
    mt_addr hz = MT_NO_ADDR;
    mt_addr level = MT_NO_ADDR;
    if (!mt_reader_type(r, value, MT_KEY_LIST_OR_OBJECT)) {
        return;
    }
    if (mt_json_type_of(r->doc, value) == MT_JSON_OBJECT) {
        (void)mt_members_read(r, value, &POINT_TABLE, &p);
    } else if (mt_reader_pair(r, value, &hz, &level) != 2) {
        mt_diag_structure(r->diags, value, "must be two numbers: [frequency, density]");
        return;
    } else {
        p.hz = read_bare(r, hz);
        p.level = read_bare(r, level);
        mt_reader_check_range_of(r, "frequency", hz, p.hz, MT_POSSIBLE_HZ);
        mt_reader_check_range(r, list, level, p.level);
    }
    out->points[out->n_points++] = p;
}

static void random_defaults(void *item, mt_addr addr, int which)
{
    *(mt_vibration_random *)item =
        (mt_vibration_random){.in_g = which == 0, .published_rms = nan(""), .addr = addr};
}

/* The breakpoints in the unit that is given. */
static void random_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_vibration_random *const out = item;
    const mt_addr list =
        which == MT_ABSENT ? MT_NO_ADDR : mt_object_value(o, o->table->keys[which].name);
    out->published_rms *= MT_STANDARD_GRAVITY;
    if (list == MT_NO_ADDR) {
        return;
    }
    mt_items items = mt_reader_items(r, list);
    if (items.count < 2) {
        mt_diag_structure(r->diags, list, "a density has at least two breakpoints");
    }
    out->points = mt_reader_room(r, &items, sizeof *out->points);
    while (mt_items_next(&items)) {
        read_point(r, list, items.at, out);
    }
}

#define THIS mt_vibration_random
static const mt_key RANDOM[] = {
    MT_M_JUST("psd_g2_per_hz", LIST, false, PSD_G,
              "Breakpoints [frequency in Hz, density in g^2/Hz], in ascending order; two at "
              "one frequency are a step. 1 g = 9.80665 m/s^2.",
              .examples = "[[[20, 0.026], [50, 0.16], [800, 0.16], {\"frequency_hz\": 2000, "
                          "\"slope_db_per_octave\": -6}]]",
              .schema = "\"allOf\": [{\"$ref\": \"#/definitions/breakpoints\"}]"),
    MT_M_JUST("psd_m2_per_s3", LIST, false, PSD, "The same with the density in (m/s^2)^2/Hz.",
              .schema = "\"allOf\": [{\"$ref\": \"#/definitions/breakpoints\"}]"),
    MT_M_VALUE("published_rms_g", false, published_rms, LEVEL_G,
               "The overall RMS that the source prints [g]: where the breakpoints have another "
               "(by more than 1 %), a warning says so."),
    ORIGIN("breakpoints come"),
};
#undef THIS
static const mt_key_table RANDOM_TABLE = {
    .what = "random",
    .keys = RANDOM,
    .n = MT_COUNT(RANDOM),
    .one_of = 2,
    .size = sizeof(mt_vibration_random),
    .defaults = random_defaults,
    .finish = random_finish,
    .says = "Stationary random acceleration by the breakpoints of its one-sided density: "
            "straight lines in log-log scales, 0 outside."};

/* A speed per minute, in Hz; beside "speed_hz" it is refused. */
static void read_rpm(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const hz = (double *)(void *)((char *)item + key->at);
    if (!MT_HAS(*hz)) {
        mt_read_value(r, key, value, item);
        *hz /= RPM_PER_HZ;
    }
}

static void read_speed_range(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_rotor *const rotor = item;
    (void)key;
    read_range(r, value, &rotor->range_lower, &rotor->range_upper);
    mt_read_warning_range(r, rotor->range_lower, rotor->range_upper, MT_ROTOR_LEAST_SPEED,
                          "rotor's", value);
}

static void read_harmonics(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    (void)key;
    mt_read_harmonics(r, value, item);
}

/* Rotors of tones: as in studies, but that numbers are plain (there are no parameters) and no
 * margin belongs to them. */
#define THIS mt_rotor
#define ROTOR_RPM(m, ...)                                         \
    {                                                             \
        .name = "speed_rpm", .type = MT_KEY_VALUE, MT_M_ROW(RPM), \
        MT_M_TO(read_rpm, double, m), .says = __VA_ARGS__         \
    }
static const mt_key TAIL[] = {
    MT_M_VALUE("speed_hz", false, tail_speed_hz, SPEED, "Nominal speed [1/s]."),
    ROTOR_RPM(tail_speed_hz, "Nominal speed [rpm]."),
    MT_M_COUNT("blades", false, tail_blades, 1, MT_MAX_BLADES, "Number of blades."),
    MT_M_DESCRIPTION,
    MT_M_FREE("source", "Where it comes from."),
};
static const mt_key_table TAIL_TABLE = {.what = "tail_rotor",
                                        .keys = TAIL,
                                        .n = MT_COUNT(TAIL),
                                        .one_of = 2,
                                        .says = "The tail rotor."};

static const mt_key ROTOR[] = {
    MT_M_REF("aircraft", false, aircraft, "Name in the catalogue of aircraft."),
    MT_M_VALUE("speed_hz", false, speed_hz, SPEED, "Nominal speed of the main rotor [1/s]."),
    ROTOR_RPM(speed_hz, "Nominal speed of the main rotor [rpm]."),
    MT_M_COUNT("blades", false, blades, 1, MT_MAX_BLADES,
               "Number of blades of the main rotor."),
    MT_M_INNER("tail", TAIL_TABLE),
    MT_M_TEXT("name", name,
              "What labels call it. Absent: the aircraft's name, else \"rotor\"."),
    {.name = "harmonics",
     .type = MT_KEY_LIST,
     .required = true,
     .read = read_harmonics,
     .least = 1,
     .pattern = "^([1-9][0-9]{0,2}[nN]?|[nN])[PT]$",
     .says = "Harmonics: \"1P\", \"4P\", \"nP\" (n: the number of blades) of the main rotor, "
             "\"1T\", \"nT\" of the tail rotor."},
    {.name = "speed_range",
     .type = MT_KEY_NUMBERS,
     MT_M_ROW(FACTORS),
     .read = read_speed_range,
     .says = "Least and greatest speed as factors of the nominal one. Absent: 1 and 1."},
    MT_M_DESCRIPTION,
    MT_M_FREE("source", "Where it comes from."),
};
#undef THIS

static void rotor_defaults(void *item, mt_addr addr, int which)
{
    mt_rotor *const rotor = item;
    (void)which;
    *rotor = mt_rotor_default(addr);
    rotor->aircraft.addr = addr;
}

/* An aircraft of the catalogue brings its own numbers; a rotor without one gives them. */
static void rotor_check(mt_reader *r, mt_object *o)
{
    static const char *const own[] = {"speed_hz", "speed_rpm", "blades", "tail"};
    const bool speed = mt_object_has(r, o, "speed_hz") || mt_object_has(r, o, "speed_rpm");
    if (!mt_object_has(r, o, "aircraft")) {
        (void)(speed ? mt_object_one_of(r, o, "speed_hz", 2)
                     : mt_object_one_of(r, o, "aircraft", 3));
        return;
    }
    for (int i = 0; i < MT_COUNT(own); i++) {
        if (mt_object_has(r, o, own[i])) {
            mt_diag_structure(r->diags,
                              mt_json_name_addr(r->doc, mt_object_place(r, o, own[i])),
                              "\"%s\" excludes \"aircraft\"", own[i]);
        }
    }
}

static void rotor_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_rotor *const rotor = item;
    (void)r;
    (void)which;
    rotor->has_tail = mt_object_value(o, "tail") != MT_NO_ADDR;
}

static const mt_key_table ROTOR_TABLE = {
    .what = "rotor",
    .keys = ROTOR,
    .n = MT_COUNT(ROTOR),
    .size = sizeof(mt_rotor),
    .defaults = rotor_defaults,
    .check = rotor_check,
    .finish = rotor_finish,
    .says = "A rotor that excites at its harmonics: an aircraft of the catalogue, or a speed.",
    .rules = "\"oneOf\": [{\"required\": [\"aircraft\"]}, {\"required\": [\"speed_hz\"]}, "
             "{\"required\": [\"speed_rpm\"]}], \"not\": {\"anyOf\": [{\"required\": "
             "[\"aircraft\", \"blades\"]}, {\"required\": [\"aircraft\", \"tail\"]}]}"};

/* The index of "rotor" among the members that say a tone's frequency. */
enum { BY_ROTOR = 1 };

static void tone_defaults(void *item, mt_addr addr, int which)
{
    mt_vibration_source *const out = item;
    *out = (mt_vibration_source){.has_rotor = which == BY_ROTOR,
                                 .lower_hz = nan(""),
                                 .upper_hz = nan(""),
                                 .level = nan(""),
                                 .addr = addr};
    rotor_defaults(&out->rotor, MT_NO_ADDR, 0);
}

/* A level in one unit. */
static void tone_check(mt_reader *r, mt_object *o)
{
    if (mt_object_one_of(r, o, "acceleration_g", 2) == MT_ABSENT) {
        mt_object_leave_out(o, "acceleration_g", 2);
    }
}

/* The one frequency that is given. */
static void tone_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_vibration_source *const out = item;
    const mt_addr range = mt_object_value(o, "frequency_hz");
    out->in_g = mt_object_has(r, o, "acceleration_g");
    if (which == BY_ROTOR) {
        (void)mt_members_read(r, mt_object_value(o, "rotor"), &ROTOR_TABLE, &out->rotor);
    } else if (which != MT_ABSENT && range != MT_NO_ADDR) {
        read_range(r, range, &out->lower_hz, &out->upper_hz);
    }
}

#define THIS mt_vibration_source
static const mt_key TONE[] = {
    MT_M_JUST("frequency_hz", NUMBERS, false, HZ,
              "Range [lower, upper] [Hz]; both may be the same."),
    MT_M_OBJECT("rotor", ROTOR_TABLE),
    MT_M_VALUE("acceleration_g", false, level, LEVEL_G, "Amplitude (peak) [g]."),
    MT_M_VALUE("acceleration_m_per_s2", false, level, LEVEL, "Amplitude (peak) [m/s^2]."),
    ORIGIN("level comes"),
};
#undef THIS
static const mt_key_table TONE_TABLE = {
    .what = "tone",
    .keys = TONE,
    .n = MT_COUNT(TONE),
    .one_of = 2,
    .size = sizeof(mt_vibration_source),
    .defaults = tone_defaults,
    .check = tone_check,
    .finish = tone_finish,
    .says = "A sine whose frequency may lie anywhere within a range, or one for each harmonic "
            "of a rotor.",
    .examples = "[{\"rotor\": {\"aircraft\": \"UH-60\", \"harmonics\": [\"4P\"], "
                "\"speed_range\": [0.95, 1.05]}, \"acceleration_g\": 1.72}]",
    .rules = "\"allOf\": [{\"oneOf\": [{\"required\": [\"acceleration_g\"]}, "
             "{\"required\": [\"acceleration_m_per_s2\"]}]}]"};

#define THIS mt_vibration
static const mt_key COMBINE[] = {
    MT_M_CHOICE("tones", false, rule, mt_vibration_sum, "rule", mt_vibration_sum_names,
                "\"sum\": all tones peak at once; \"largest\": one at a time; "
                "\"root_sum_square\": as if they were independent.",
                .otherwise = "\"sum\""),
    MT_M_VALUE("sigma", false, sigma, SIGMA,
               "How many standard deviations count as the peak of the random response.",
               .otherwise = "3"),
    MT_M_DESCRIPTION,
};
static const mt_key_table COMBINE_TABLE = {
    .what = "combine",
    .keys = COMBINE,
    .n = MT_COUNT(COMBINE),
    .says = "The combined peak is sigma times the RMS of the random response, and the peaks of "
            "the tones by a rule."};

/* Rows without a place are read by read_profile_root, once it is known that there is a part. */
static const mt_key ROOT[] = {
    MT_M_FREE("$schema", "This schema, for the editor."),
    MT_M_FORMAT(FORMATS),
    MT_M_TEXT("name", name, "What tables call it."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_TEXT("source", source, "Where it comes from: a standard, a test report."),
    MT_M_ACCEPTED("Names of warnings that you know and accept: they are not printed.",
                  .examples = "[[\"level\"]]"),
    MT_M_JUST("aircraft", TEXT, false, NONE,
              "Catalogue of aircraft, relative to this file. Absent: aircraft.json beside it, "
              "else the one that is part of the program.",
              .examples = "[\"../aircraft.json\"]"),
    MT_M_CHOICE("axis", false, axis, int, "axis", AXES,
                "The direction that it is meant for. Absent: any."),
    {.name = "random",
     .type = MT_KEY_OBJECT_OR_LIST,
     .what = "the list of random parts",
     .of = &RANDOM_TABLE,
     .says = "A random part, or several whose densities add up."},
    {.name = "tones",
     .type = MT_KEY_LIST,
     .what = "the list of tones",
     .of = &TONE_TABLE,
     .says = "Sines."},
    {.name = "combine",
     .type = MT_KEY_OBJECT,
     .of = &COMBINE_TABLE,
     .says = "How random parts and tones make one peak."},
};
#undef THIS
static const mt_key_table ROOT_TABLE = {
    .what = "",
    .keys = ROOT,
    .n = MT_COUNT(ROOT),
    .says = "A vibration profile: the acceleration of a base, as random parts, tones, or both "
            "(sine on random). Numbers are plain; expressions are not allowed.",
    .rules = "\"anyOf\": [{\"required\": [\"random\"]}, {\"required\": [\"tones\"]}]"};

const mt_schema_type *mt_profile_types(int *n)
{
    static const mt_schema_type types[] = {
        {.name = "breakpoints",
         .says = "Breakpoints of a density.",
         .schema = "\"type\": \"array\", \"minItems\": 2, \"items\": {\"anyOf\": [{\"$ref\": "
                   "\"#/definitions/pair\"}, {\"$ref\": \"#/definitions/slope\"}]}"},
        {.name = "origin",
         .says = "Where the numbers come from; whatever uses assumed ones says so.",
         .schema =
             "\"type\": \"string\", \"enum\": [\"published\", \"identified\", \"assumed\"]"},
        {.name = "pair",
         .says = "Two numbers.",
         .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "
                   "{\"type\": \"number\"}"},
    };
    *n = MT_COUNT(types);
    return types;
}

const mt_key_table *const *mt_profile_key_tables(int *n)
{
    static const mt_key_table *const tables[] = {&ROOT_TABLE, &RANDOM_TABLE,  &POINT_TABLE,
                                                 &TONE_TABLE, &COMBINE_TABLE, &ROTOR_TABLE,
                                                 &TAIL_TABLE};
    *n = MT_COUNT(tables);
    return tables;
}

/* A profile with every member at its default; NULL: out of memory. */
static mt_vibration *make_profile(mt_err *err)
{
    mt_vibration *const v = calloc(1, sizeof *v);
    if (v == NULL) {
        (void)mt_fail_memory(err);
        return NULL;
    }
    *v = (mt_vibration){.axis = MT_ABSENT, .sigma = DEFAULT_SIGMA};
    if (mt_arena_init(&v->mem, 0, err) != MT_OK) {
        free(v);
        return NULL;
    }
    return v;
}

void mt_vibration_delete(mt_vibration *v)
{
    if (v != NULL) {
        mt_arena_free(&v->mem);
        free(v);
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

static void load_profile_aircraft(profile_reader *p, mt_addr place, const char *name,
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

/* Read the catalogue where a tone needs one or the profile names one. */
static void read_catalogue(profile_reader *p, mt_addr value)
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

/* True where the number is given and possible; otherwise the reader has noted it. */
static bool is_good(mt_possible_id row, double value)
{
    return value == value && mt_possible_is(&mt_possible_of[row], value);
}

/* The place of a breakpoint's frequency. */
static mt_addr frequency_place(const mt_reader *r, mt_addr point)
{
    mt_addr hz = MT_NO_ADDR;
    mt_addr level = MT_NO_ADDR;
    if (mt_json_type_of(r->doc, point) == MT_JSON_OBJECT) {
        return mt_diag_member(r->diags, point, "frequency_hz");
    }
    (void)mt_reader_pair(r, point, &hz, &level);
    return hz;
}

static bool check_order(const mt_reader *reader, const mt_vibration_random *r)
{
    bool right = true;
    for (int i = 1; i < r->n_points; i++) {
        const double hz = r->points[i].hz;
        if (hz < r->points[i - 1].hz) {
            mt_diag_error(reader->diags, frequency_place(reader, r->points[i].addr),
                          "%g Hz is below the breakpoint before it", hz);
            right = false;
        } else if (hz == r->points[i - 1].hz &&
                   (i == 1 || i == r->n_points - 1 || hz == r->points[i - 2].hz)) {
            mt_diag_error(reader->diags, frequency_place(reader, r->points[i].addr),
                          i > 1 && hz == r->points[i - 2].hz
                              ? "a third breakpoint at %g Hz: a step has two"
                              : "two breakpoints at %g Hz, where the density begins or ends",
                          hz);
            right = false;
        }
    }
    return right;
}

/* The level at the other end of a segment with a slope. */
static double level_at_segment_end(double level, double from_hz, double to_hz, double slope_db)
{
    return level *
           pow(10.0, slope_db * mt_psd_log_ratio(from_hz, to_hz) / (log(2.0) * DB_PER_DECADE));
}

/* Points without a level take it from the one before them, those before the first level from
 * the one after them. */
static bool follow_slopes(mt_diags *d, mt_vibration_random *r)
{
    int first = 0;
    while (first < r->n_points && r->points[first].slope_db == r->points[first].slope_db) {
        first++;
    }
    if (first == r->n_points) {
        mt_diag_error(d,
                      mt_diag_member(d, r->addr, r->in_g ? "psd_g2_per_hz" : "psd_m2_per_s3"),
                      "no breakpoint has a level");
        return false;
    }
    for (int i = first - 1; i >= 0; i--) {
        mt_vibration_point *const p = &r->points[i];
        p->level = level_at_segment_end(p[1].level, p[1].hz, p->hz, p->slope_db);
    }
    for (int i = first + 1; i < r->n_points; i++) {
        mt_vibration_point *const p = &r->points[i];
        if (p->slope_db == p->slope_db) {
            p->level = level_at_segment_end(p[-1].level, p[-1].hz, p->hz, p->slope_db);
        }
    }
    for (int i = 0; i < r->n_points; i++) {
        const mt_vibration_point *const p = &r->points[i];
        if (!is_good(MT_POSSIBLE_PSD, p->level)) {
            mt_diag_error(d, p->addr, "the level that follows (%g) %s", p->level,
                          mt_possible_of[MT_POSSIBLE_PSD].impossible);
            return false;
        }
    }
    return true;
}

static void compare_with_print(mt_diags *d, const mt_vibration_random *r)
{
    const double off = (r->rms / r->published_rms) - 1.0;
    if (fabs(off) > PUBLISHED_TOL) {
        mt_diag_warning(d, mt_diag_member(d, r->addr, "published_rms_g"),
                        "the breakpoints have an RMS of %.4g g, which is %.2g %% off the "
                        "published one",
                        r->rms / MT_STANDARD_GRAVITY, 100.0 * off);
    }
}

static void finish_random(const mt_reader *reader, mt_vibration *v, mt_vibration_random *r)
{
    mt_diags *const d = reader->diags;
    bool right = r->n_points >= 2;
    for (int i = 0; i < r->n_points; i++) {
        const mt_vibration_point *const p = &r->points[i];
        right = right && is_good(MT_POSSIBLE_HZ, p->hz);
        right = right && (p->slope_db == p->slope_db || is_good(MT_POSSIBLE_PSD, p->level));
    }
    const bool printed = is_good(MT_POSSIBLE_LEVEL, r->published_rms);
    if (!right || !check_order(reader, r) || !follow_slopes(d, r)) {
        return;
    }
    const double square = MT_STANDARD_GRAVITY * MT_STANDARD_GRAVITY;
    const size_t n = (size_t)r->n_points;
    r->psd.hz = mt_arena_f64(&v->mem, n, 1);
    r->psd.level = mt_arena_f64(&v->mem, n, 1);
    r->level_g = mt_arena_f64(&v->mem, n, 1);
    if (mt_arena_failed(&v->mem)) {
        return;
    }
    for (int i = 0; i < r->n_points; i++) {
        r->psd.hz[i] = r->points[i].hz;
        r->psd.level[i] = r->in_g ? square * r->points[i].level : r->points[i].level;
        r->level_g[i] = r->in_g ? r->points[i].level : r->points[i].level / square;
    }
    r->psd.n = r->n_points;
    r->rms = sqrt(mt_psd_mean_square(&r->psd));
    if (printed) {
        compare_with_print(d, r);
    }
}

typedef struct marking {
    mt_vibration *v;
    mt_diags *diags;
    int room; /* for marks */
} marking;

/* True where one of the last marks has the same text: consecutive sources of one aircraft have
 * the same marks. */
static bool is_said(const mt_vibration *v, const char *text)
{
    bool said = false;
    for (int i = v->n_marks; i > 0 && i > v->n_marks - LAST_MARKS && !said; i--) {
        said = strcmp(v->marks[i - 1], text) == 0;
    }
    return said;
}

/* Add a mark to the profile, and a warning. */
static void add_profile_mark(marking *m, mt_addr addr, const char *text)
{
    mt_vibration *const v = m->v;
    if (text == NULL || is_said(v, text)) {
        return;
    }
    mt_diag_warning(m->diags, addr, "%s", text);
    const char **const list =
        mt_arena_grow(&v->mem, (void *)v->marks, v->n_marks, &m->room, sizeof *list);
    if (list != NULL) {
        list[v->n_marks++] = text;
        v->marks = list;
    }
}

/* The nearest name of the catalogue, for "did you mean"; NULL: none is near. Scratch in mem. */
static const char *nearest_aircraft(const mt_aircraft_list *list, const char *name,
                                    mt_arena *mem)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const char **const names = mt_arena_alloc(mem, (size_t)list->n, sizeof *names);
    for (int i = 0; names != NULL && i < list->n; i++) {
        names[i] = list->items[i].name.s;
    }
    const char *const found = names == NULL ? NULL : mt_text_nearest(name, names, list->n);
    mt_arena_rewind(mem, mark);
    return found;
}

static const mt_aircraft *find_aircraft(mt_vibration *v, mt_name name, mt_diags *d)
{
    const mt_aircraft *const found =
        name.s == NULL ? NULL : mt_aircraft_find(&v->aircraft, name.s);
    if (name.s != NULL && found == NULL && v->aircraft.n > 0) {
        const char *const guess =
            mt_diag_may_suggest(d) ? nearest_aircraft(&v->aircraft, name.s, &v->mem) : NULL;
        mt_diag_error(d, name.addr, "unknown aircraft \"%s\"%s%s%s", name.s,
                      guess == NULL ? "" : "; did you mean \"", guess == NULL ? "" : guess,
                      guess == NULL ? "" : "\"?");
    }
    return found;
}

static void check_rotor(mt_vibration *v, mt_rotor *rotor, mt_diags *d)
{
    const mt_aircraft *const aircraft = find_aircraft(v, rotor->aircraft, d);
    if (aircraft != NULL) {
        mt_rotor_take(rotor, aircraft);
    }
    if (aircraft != NULL || rotor->aircraft.addr == rotor->addr) {
        mt_rotor_check_harmonics(rotor, aircraft, d); /* else the aircraft is wrong */
    }
    mt_rotor_check_range(rotor, d);
}

static void check_source(mt_vibration *v, mt_vibration_source *s, mt_diags *d)
{
    if (s->has_rotor) {
        check_rotor(v, &s->rotor, d);
        return;
    }
    if (s->lower_hz > s->upper_hz) {
        mt_diag_error(d, mt_diag_member(d, s->addr, "frequency_hz"),
                      "the range (%g to %g Hz) must be ascending", s->lower_hz, s->upper_hz);
    }
}

static const char *rotor_name(const mt_rotor *rotor)
{
    return rotor->name != NULL         ? rotor->name
           : rotor->aircraft.s != NULL ? rotor->aircraft.s
                                       : "rotor";
}

static void add_tone(mt_vibration *v, int source, double lower, double upper, const char *label,
                     mt_diags *d)
{
    const mt_vibration_source *const s = &v->sources[source];
    if (!is_good(MT_POSSIBLE_HZ, lower) || !is_good(MT_POSSIBLE_HZ, upper)) {
        if (s->has_rotor) { /* else the reader has noted it */
            mt_diag_error(d, s->addr, "%s: its frequency (%g to %g Hz) %s", label, lower, upper,
                          mt_possible_of[MT_POSSIBLE_HZ].impossible);
        }
        return;
    }
    v->tones[v->n_tones++] = (mt_vibration_tone){
        .label = label,
        .lower_hz = lower,
        .upper_hz = upper,
        .level = s->in_g ? MT_STANDARD_GRAVITY * s->level : s->level,
        .level_g = s->in_g ? s->level : s->level / MT_STANDARD_GRAVITY,
        .source = source,
    };
}

static void add_harmonics(mt_vibration *v, int source, mt_diags *d)
{
    const mt_rotor *const rotor = &v->sources[source].rotor;
    for (int i = 0; i < rotor->n_harmonics; i++) {
        const double hz = mt_rotor_harmonic_hz(rotor, &rotor->harmonics[i]);
        const char *const label =
            mt_arena_printf(&v->mem, "%s of %s", rotor->harmonics[i].text, rotor_name(rotor));
        if (hz == hz && label != NULL) { /* else its aircraft could not be read */
            add_tone(v, source, hz * rotor->range_lower, hz * rotor->range_upper, label, d);
        }
    }
}

static void make_tones(mt_vibration *v, mt_diags *d)
{
    size_t most = 0;
    for (int i = 0; i < v->n_sources; i++) {
        most += v->sources[i].has_rotor ? (size_t)v->sources[i].rotor.n_harmonics : 1;
    }
    v->tones = mt_arena_alloc(&v->mem, most, sizeof *v->tones);
    if (v->tones == NULL) {
        return;
    }
    for (int i = 0; i < v->n_sources; i++) {
        const mt_vibration_source *const s = &v->sources[i];
        if (s->has_rotor) {
            add_harmonics(v, i, d);
            continue;
        }
        const char *const label =
            s->lower_hz == s->upper_hz
                ? mt_arena_printf(&v->mem, "%.6g Hz", s->lower_hz)
                : mt_arena_printf(&v->mem, "%.6g to %.6g Hz", s->lower_hz, s->upper_hz);
        if (label != NULL) {
            add_tone(v, i, s->lower_hz, s->upper_hz, label, d);
        }
    }
}

/* "4P, 8P of UH-60", "16.3 to 18.1 Hz" */
static const char *name_source(mt_vibration *v, const mt_vibration_source *s)
{
    const mt_rotor *const rotor = &s->rotor;
    const char *text = "";
    if (!s->has_rotor) {
        return mt_arena_printf(&v->mem, "%.6g to %.6g Hz", s->lower_hz, s->upper_hz);
    }
    if (rotor->n_harmonics > LISTED_MOST) {
        return mt_arena_printf(&v->mem, "%d harmonics of %s", rotor->n_harmonics,
                               rotor_name(rotor));
    }
    for (int i = 0; i < rotor->n_harmonics && text != NULL; i++) {
        text = mt_arena_printf(&v->mem, "%s%s%s", text, i == 0 ? "" : ", ",
                               rotor->harmonics[i].text);
    }
    return text == NULL ? NULL : mt_arena_printf(&v->mem, "%s of %s", text, rotor_name(rotor));
}

static void mark_source(marking *m, const mt_vibration_source *s)
{
    mt_vibration *const v = m->v;
    mt_rotor_warning warning_list[MT_ROTOR_WARNINGS];
    const mt_aircraft *const a = s->has_rotor && s->rotor.aircraft.s != NULL
                                     ? mt_aircraft_find(&v->aircraft, s->rotor.aircraft.s)
                                     : NULL;
    const int n = a == NULL ? 0 : mt_rotor_warnings(&s->rotor, a, warning_list);
    for (int i = 0; i < n; i++) {
        add_profile_mark(
            m, s->rotor.aircraft.addr,
            mt_arena_printf(&v->mem, "%s: the %s (%s) is unconfirmed (source needed: %s)",
                            s->rotor.aircraft.s, warning_list[i].what,
                            warning_list[i].value->text, warning_list[i].value->source));
    }
    const char *const name = name_source(v, s);
    if (s->origin.origin == MT_ORIGIN_ASSUMED && name != NULL) {
        add_profile_mark(
            m, s->addr,
            mt_arena_printf(&v->mem, "the level of %s is assumed (%s)", name,
                            s->origin.source == NULL ? "no source" : s->origin.source));
    }
}

static void make_marks(mt_vibration *v, mt_diags *diags)
{
    marking m = {.v = v, .diags = diags};
    for (int i = 0; i < v->n_random; i++) {
        const mt_vibration_random *const r = &v->random[i];
        if (r->origin.origin == MT_ORIGIN_ASSUMED) {
            add_profile_mark(
                &m, r->addr,
                mt_arena_printf(&v->mem, "the density from %.6g to %.6g Hz is assumed (%s)",
                                r->psd.hz[0], r->psd.hz[r->psd.n - 1],
                                r->origin.source == NULL ? "no source" : r->origin.source));
        }
    }
    for (int i = 0; i < v->n_sources; i++) {
        mark_source(&m, &v->sources[i]);
    }
}

/* Check what is read of numbers together and note every problem, look up aircraft, resolve
 * slopes into levels, make tones and marks. Parts with errors are left empty; a shortage is
 * remembered by the arena. */
static void finish_profile(const mt_reader *r, mt_vibration *v)
{
    mt_diags *const diags = r->diags;
    for (int i = 0; i < v->n_random; i++) {
        finish_random(r, v, &v->random[i]);
    }
    for (int i = 0; i < v->n_sources; i++) {
        check_source(v, &v->sources[i], diags);
    }
    if (diags->errors == 0) {
        make_tones(v, diags);
    }
    if (diags->errors == 0 && !mt_arena_failed(&v->mem)) {
        make_marks(v, diags);
    }
}

static void read_profile_root(profile_reader *p)
{
    mt_reader *const r = &p->r;
    mt_vibration *const v = p->v;
    mt_object o;
    if (!mt_reader_format(r, FORMAT, "profile of vibration") ||
        !mt_object_match(r, MT_JSON_ROOT, &ROOT_TABLE, &o)) {
        return;
    }
    mt_object_read(r, &o, v);
    if (!mt_object_has(r, &o, "random") && !mt_object_has(r, &o, "tones")) {
        mt_diag_structure(r->diags, MT_JSON_ROOT,
                          "\"random\" or \"tones\" is missing: the profile is empty");
    }
    (void)mt_members_read(r, mt_object_value(&o, "combine"), &COMBINE_TABLE, v);
    v->random = mt_members_list(r, mt_object_value(&o, "random"), "the list of random parts",
                                &RANDOM_TABLE, &v->n_random);
    v->sources = mt_members_list(r, mt_object_value(&o, "tones"), "the list of tones",
                                 &TONE_TABLE, &v->n_sources);
    read_catalogue(p, mt_object_value(&o, "aircraft"));
    finish_profile(r, v);
}

/* The document's problems come before those of its catalogue. */
static mt_status read_profile_text(profile_reader *p, const mt_file *file,
                                   mt_diagnostics *messages, mt_err *err)
{
    mt_json *doc = NULL;
    mt_diagnostics others = {.count = 0};
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (doc == NULL) {
        return rc;
    }
    int *const structural = p->files.structural;
    p->files.structural = NULL; /* counts this file alone */
    p->r = (mt_reader){.doc = doc, .diags = mt_json_diags(doc), .mem = &p->v->mem};
    p->others = &others;
    if (rc == MT_OK) {
        read_profile_root(p);
    }
    rc = mt_reader_status(&p->r, p->v->path, err);
    /* a shortage, or a disk that fails, counts whatever else is wrong */
    if (p->failed != MT_OK && (rc == MT_OK || p->failed != MT_E_INPUT)) {
        rc = mt_fail(err, p->failed, "%s", p->why.text);
    }
    if (structural != NULL) {
        *structural = p->r.diags->structural;
    }
    if (messages != NULL) {
        mt_json_report(doc, p->v->path, messages);
        mt_diagnostics_append(messages, &others);
    }
    rc = others.lines.failed || (messages != NULL && messages->lines.failed)
             ? mt_fail_memory(err)
             : rc;
    p->others = NULL;
    mt_diagnostics_free(&others);
    mt_json_delete(doc);
    return rc;
}

static mt_status load_from(const char *path, const char *within, const mt_io_options *opt,
                           mt_vibration **out, mt_diagnostics *messages, mt_err *err)
{
    const mt_io_options none = {0};
    profile_reader p = {.files = opt == NULL ? none : *opt, .failed = MT_OK};
    mt_file file = {0};
    char *root = NULL;
    *out = NULL;
    p.v = make_profile(err);
    if (p.v == NULL) {
        return MT_E_MEMORY;
    }
    const size_t limit = p.files.max_bytes == 0 ? MT_JSON_MAX_BYTES : p.files.max_bytes;
    mt_status rc = mt_files_read(&p.files.files, path, within, limit, &file, err);
    if (rc != MT_OK) {
        goto done;
    }
    root = p.files.root == NULL ? mt_file_default_root(path) : NULL;
    if (root == NULL && p.files.root == NULL) {
        rc = mt_fail_memory(err);
        goto done;
    }
    p.files.root = root == NULL ? p.files.root : root;
    p.v->path = mt_arena_strdup(&p.v->mem, path);
    p.v->sha256 = mt_arena_strdup(&p.v->mem, file.sha256);
    rc = mt_arena_check(&p.v->mem, err);
    if (rc != MT_OK) {
        goto done;
    }
    rc = read_profile_text(&p, &file, messages, err);
done:
    mt_file_free(&file);
    free(root);
    if (rc != MT_OK) {
        mt_vibration_delete(p.v);
        return rc;
    }
    *out = p.v;
    return MT_OK;
}

mt_status mt_vibration_load(const char *path, const mt_io_options *opt, mt_vibration **out,
                            mt_diagnostics *messages, mt_err *err)
{
    return load_from(path, NULL, opt, out, messages, err);
}

mt_status mt_vibration_load_within(const char *path, const mt_io_options *opt,
                                   mt_vibration **out, mt_diagnostics *messages, mt_err *err)
{
    return load_from(path, opt->root, opt, out, messages, err);
}

double mt_vibration_rms(const mt_vibration *v)
{
    double sum = v == NULL ? nan("") : 0.0;
    for (int i = 0; v != NULL && i < v->n_random; i++) {
        sum += v->random[i].rms * v->random[i].rms;
    }
    return sqrt(sum);
}

double mt_vibration_density(const mt_vibration *v, double hz)
{
    double sum = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        sum += mt_psd_at(&v->random[i].psd, hz);
    }
    return sum;
}

void mt_vibration_range(const mt_vibration *v, bool random, bool tones, double hz[2])
{
    hz[0] = HUGE_VAL;
    hz[1] = 0.0;
    for (int i = 0; random && i < v->n_random; i++) {
        const mt_psd *const psd = &v->random[i].psd;
        hz[0] = fmin(hz[0], psd->hz[0]);
        hz[1] = fmax(hz[1], psd->hz[psd->n - 1]);
    }
    for (int i = 0; tones && i < v->n_tones; i++) {
        hz[0] = fmin(hz[0], v->tones[i].lower_hz);
        hz[1] = fmax(hz[1], v->tones[i].upper_hz);
    }
}
