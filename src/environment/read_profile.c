/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles of vibration: the document, its random parts and tones; read_profile_rotor.c has
 * the rotors. */
#include "environment/read_profile_priv.h"

#include <math.h>
#include <stdlib.h>

#include "io/file.h"
#include "io/json_print.h"

#define ROOT_KEYS(X)                                                                         \
    X(ROOT_SCHEMA, "$schema", TEXT, false, NONE, "This schema, for the editor.")             \
    X(ROOT_FORMAT, "format", TEXT, true, NONE, "Kind and version of this file.",             \
      .schema = "\"type\": \"string\", \"enum\": [\"modetune-profile/1\"]")                  \
    X(ROOT_NAME, "name", TEXT, false, NONE, "What tables call it.")                          \
    X(ROOT_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")           \
    X(ROOT_SOURCE, "source", TEXT, false, NONE,                                              \
      "Where it comes from: a standard, a test report.")                                     \
    X(ROOT_ACCEPTED, "accepted", LIST, false, NONE,                                          \
      "Names of warnings that you know and accept: they are not printed.",                   \
      .examples = "[[\"level\"]]", .choices = mt_warning_names,                              \
      .n_choices = MT_WARNING_NAME_COUNT)                                                    \
    X(ROOT_AIRCRAFT, "aircraft", TEXT, false, NONE,                                          \
      "Catalogue of aircraft, relative to this file. Absent: aircraft.json beside it, else " \
      "the one that is part of the program.",                                                \
      .examples = "[\"../aircraft.json\"]")                                                  \
    X(ROOT_AXIS, "axis", TEXT, false, NONE,                                                  \
      "The direction that it is meant for. Absent: any.",                                    \
      .schema = "\"type\": \"string\", \"enum\": [\"x\", \"y\", \"z\"]")                     \
    X(ROOT_RANDOM, "random", OBJECT_OR_LIST, false, NONE,                                    \
      "A random part, or several whose densities add up.",                                   \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/random\"}, {\"type\": \"array\", "   \
                "\"minItems\": 1, \"items\": {\"$ref\": \"#/definitions/random\"}}]")        \
    X(ROOT_TONES, "tones", LIST, false, NONE, "Sines.",                                      \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": "               \
                "\"#/definitions/tone\"}")                                                   \
    X(ROOT_COMBINE, "combine", OBJECT, false, NONE,                                          \
      "How random parts and tones make one peak.",                                           \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/combine\"}]")
enum { ROOT_KEYS(MT_PROFILE_ENUM) ROOT_COUNT };
MT_PROFILE_TABLE(
    ROOT, "", ROOT_KEYS,
    .says = "A vibration profile: the acceleration of a base, as random parts, tones, or both "
            "(sine on random). Numbers are plain; expressions are not allowed.",
    .rules = "\"anyOf\": [{\"required\": [\"random\"]}, {\"required\": [\"tones\"]}]");

#define RANDOM_KEYS(X)                                                                      \
    X(RANDOM_G2, "psd_g2_per_hz", LIST, false, PSD_G,                                       \
      "Breakpoints [frequency in Hz, density in g^2/Hz], in ascending order; two at one "   \
      "frequency are a step. 1 g = 9.80665 m/s^2.",                                         \
      .examples = "[[[20, 0.026], [50, 0.16], [800, 0.16], {\"frequency_hz\": 2000, "       \
                  "\"slope_db_per_octave\": -6}]]",                                         \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/breakpoints\"}]")                   \
    X(RANDOM_SI, "psd_m2_per_s3", LIST, false, PSD,                                         \
      "The same with the density in (m/s^2)^2/Hz.",                                         \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/breakpoints\"}]")                   \
    X(RANDOM_RMS_G, "published_rms_g", VALUE, false, LEVEL_G,                               \
      "The overall RMS that the source prints [g]: where the breakpoints have another (by " \
      "more than 1 %), a warning says so.")                                                 \
    X(RANDOM_ORIGIN, "origin", TEXT, false, NONE, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/origin\"")                                       \
    X(RANDOM_SOURCE, "source", TEXT, false, NONE, "Where the breakpoints come from.")       \
    X(RANDOM_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")
enum { RANDOM_KEYS(MT_PROFILE_ENUM) RANDOM_COUNT };
MT_PROFILE_TABLE(RANDOM, "random", RANDOM_KEYS,
                 .says = "Stationary random acceleration by the breakpoints of its one-sided "
                         "density: straight lines in log-log scales, 0 outside.",
                 .rules = "\"oneOf\": [{\"required\": [\"psd_g2_per_hz\"]}, {\"required\": "
                          "[\"psd_m2_per_s3\"]}]");

#define POINT_KEYS(X)                                               \
    X(POINT_HZ, "frequency_hz", VALUE, true, HZ, "Frequency [Hz].") \
    X(POINT_SLOPE, "slope_db_per_octave", VALUE, true, SLOPE,       \
      "Slope of the segment between the two, for rising frequency [dB/octave].")
enum { POINT_KEYS(MT_PROFILE_ENUM) POINT_COUNT };
MT_PROFILE_TABLE(POINT, "slope", POINT_KEYS,
                 .says = "A breakpoint whose density follows from a slope: from the breakpoint "
                         "before it or, in front of the first density, from the one after it.");

#define TONE_KEYS(X)                                                                      \
    X(TONE_RANGE, "frequency_hz", LIST, false, HZ,                                        \
      "Range [lower, upper] [Hz]; both may be the same.",                                 \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/pair\"}]")                        \
    X(TONE_ROTOR, "rotor", OBJECT, false, NONE, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/rotor\"")                                      \
    X(TONE_G, "acceleration_g", VALUE, false, LEVEL_G, "Amplitude (peak) [g].")           \
    X(TONE_SI, "acceleration_m_per_s2", VALUE, false, LEVEL, "Amplitude (peak) [m/s^2].") \
    X(TONE_ORIGIN, "origin", TEXT, false, NONE, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/origin\"")                                     \
    X(TONE_SOURCE, "source", TEXT, false, NONE, "Where the level comes from.")            \
    X(TONE_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")
enum { TONE_KEYS(MT_PROFILE_ENUM) TONE_COUNT };
MT_PROFILE_TABLE(
    TONE, "tone", TONE_KEYS,
    .says = "A sine whose frequency may lie anywhere within a range, or one for each harmonic "
            "of a rotor.",
    .examples = "[{\"rotor\": {\"aircraft\": \"UH-60\", \"harmonics\": [\"4P\"], "
                "\"speed_range\": [0.95, 1.05]}, \"acceleration_g\": 1.72}]",
    .rules = "\"allOf\": [{\"oneOf\": [{\"required\": [\"frequency_hz\"]}, {\"required\": "
             "[\"rotor\"]}]}, {\"oneOf\": [{\"required\": [\"acceleration_g\"]}, "
             "{\"required\": [\"acceleration_m_per_s2\"]}]}]");

#define COMBINE_KEYS(X)                                                                        \
    X(COMBINE_SIGMA, "sigma", VALUE, false, SIGMA,                                             \
      "How many standard deviations count as the peak of the random response.",                \
      .otherwise = "3")                                                                        \
    X(COMBINE_TONES, "tones", TEXT, false, NONE,                                               \
      "\"sum\": all tones peak at once; \"largest\": one at a time; \"root_sum_square\": as "  \
      "if they were independent.",                                                             \
      .otherwise = "\"sum\"",                                                                  \
      .schema = "\"type\": \"string\", \"enum\": [\"sum\", \"largest\", \"root_sum_square\"]") \
    X(COMBINE_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")
enum { COMBINE_KEYS(MT_PROFILE_ENUM) COMBINE_COUNT };
MT_PROFILE_TABLE(COMBINE, "combine", COMBINE_KEYS,
                 .says = "The combined peak is sigma times the RMS of the random response, and "
                         "the peaks of the tones by a rule.");

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
    static const mt_key_table *const tables[] = {
        &ROOT_TABLE,    &RANDOM_TABLE,          &POINT_TABLE,         &TONE_TABLE,
        &COMBINE_TABLE, &mt_profile_rotor_keys, &mt_profile_tail_keys};
    *n = MT_COUNT(tables);
    return tables;
}

static double read_bare(mt_reader *r, mt_addr value)
{
    return value == MT_NO_ADDR || !mt_reader_type(r, value, MT_KEY_VALUE)
               ? nan("")
               : mt_json_number(r->doc, value);
}

double mt_read_profile_number(mt_reader *r, mt_addr value)
{
    const double number = read_bare(r, value);
    mt_reader_check_range(r, value, value, number);
    return number;
}

bool mt_read_profile_pair(mt_reader *r, mt_addr value, double *lower, double *upper)
{
    mt_addr ends[2];
    if (value == MT_NO_ADDR || !mt_reader_type(r, value, MT_KEY_LIST)) {
        return false;
    }
    if (mt_reader_pair(r, value, &ends[0], &ends[1]) != 2) {
        mt_diag_structure(r->diags, value, "must be two numbers: [lower, upper]");
        return false;
    }
    *lower = read_bare(r, ends[0]);
    *upper = read_bare(r, ends[1]);
    mt_reader_check_range(r, value, ends[0], *lower);
    mt_reader_check_range(r, value, ends[1], *upper);
    return true;
}

static const char *name_at(const mt_key_table *table, int key)
{
    return table->keys[key].name;
}

int mt_read_profile_one_of(mt_reader *r, mt_addr object, const mt_key_table *table, int first)
{
    const mt_addr a = mt_json_member(r->doc, object, name_at(table, first));
    const mt_addr b = mt_json_member(r->doc, object, name_at(table, first + 1));
    if (a != MT_NO_ADDR && b != MT_NO_ADDR) {
        mt_diag_structure(r->diags, mt_json_name_addr(r->doc, b), "\"%s\" excludes \"%s\"",
                          name_at(table, first + 1), name_at(table, first));
        return MT_ABSENT;
    }
    if (a == MT_NO_ADDR && b == MT_NO_ADDR) {
        mt_diag_structure(r->diags, object, "one of \"%s\" or \"%s\" is missing",
                          name_at(table, first), name_at(table, first + 1));
        return MT_ABSENT;
    }
    return a != MT_NO_ADDR ? first : first + 1;
}

static mt_vibration_origin read_origin(mt_reader *r, mt_addr origin, mt_addr source)
{
    static const char *const names[] = {"published", "identified", "assumed"};
    /* the list lacks the first origin, none; MT_ABSENT is -1 */
    return (mt_vibration_origin){
        .origin =
            (mt_origin)(mt_reader_choice(r, origin, "origin", names, MT_COUNT(names)) + 1),
        .source = mt_reader_text(r, source)};
}

/* [f, level], or an object with a slope, of the list of a density. */
static void read_point(mt_reader *r, mt_addr list, mt_addr value, mt_vibration_random *out)
{
    mt_vibration_point p = {
        .hz = nan(""), .level = nan(""), .slope_db = nan(""), .addr = value, .hz_addr = value};
    mt_addr level = MT_NO_ADDR;
    if (!mt_reader_type(r, value, MT_KEY_LIST_OR_OBJECT)) {
        return;
    }
    if (mt_json_type_of(r->doc, value) == MT_JSON_OBJECT) {
        mt_addr found[POINT_COUNT];
        (void)mt_reader_object(r, value, &POINT_TABLE, found);
        p.hz = mt_read_profile_number(r, found[POINT_HZ]);
        p.hz_addr = found[POINT_HZ];
        p.slope_db = mt_read_profile_number(r, found[POINT_SLOPE]);
    } else if (mt_reader_pair(r, value, &p.hz_addr, &level) != 2) {
        mt_diag_structure(r->diags, value, "must be two numbers: [frequency, density]");
        return;
    } else {
        p.hz = read_bare(r, p.hz_addr);
        p.level = read_bare(r, level);
        mt_reader_check_range_of(r, "frequency", p.hz_addr, p.hz, MT_POSSIBLE_HZ);
        mt_reader_check_range(r, list, level, p.level);
    }
    out->points[out->n_points++] = p;
}

static void read_random(mt_reader *r, mt_addr value, mt_vibration *v)
{
    mt_addr found[RANDOM_COUNT];
    if (!mt_reader_type(r, value, MT_KEY_OBJECT) ||
        !mt_reader_object(r, value, &RANDOM_TABLE, found)) {
        return;
    }
    mt_vibration_random *const out = &v->random[v->n_random++];
    const int which = mt_read_profile_one_of(r, value, &RANDOM_TABLE, RANDOM_G2);
    *out = (mt_vibration_random){
        .in_g = which == RANDOM_G2,
        .published_rms = MT_STANDARD_GRAVITY * mt_read_profile_number(r, found[RANDOM_RMS_G]),
        .origin = read_origin(r, found[RANDOM_ORIGIN], found[RANDOM_SOURCE]),
        .addr = value,
    };
    if (which == MT_ABSENT || found[which] == MT_NO_ADDR) {
        return;
    }
    mt_items items = mt_reader_items(r, found[which]);
    if (items.count < 2) {
        mt_diag_structure(r->diags, found[which], "a density has at least two breakpoints");
    }
    out->points = mt_reader_room(r, &items, sizeof *out->points);
    while (mt_items_next(&items)) {
        read_point(r, found[which], items.at, out);
    }
}

static void read_tone(mt_reader *r, mt_addr value, mt_vibration *v)
{
    mt_addr found[TONE_COUNT];
    if (!mt_reader_type(r, value, MT_KEY_OBJECT) ||
        !mt_reader_object(r, value, &TONE_TABLE, found)) {
        return;
    }
    mt_vibration_source *const out = &v->sources[v->n_sources++];
    const int which = mt_read_profile_one_of(r, value, &TONE_TABLE, TONE_RANGE);
    const int level = mt_read_profile_one_of(r, value, &TONE_TABLE, TONE_G);
    *out = (mt_vibration_source){
        .has_rotor = which == TONE_ROTOR,
        .lower_hz = nan(""),
        .upper_hz = nan(""),
        .level = level == MT_ABSENT ? nan("") : mt_read_profile_number(r, found[level]),
        .in_g = level == TONE_G,
        .origin = read_origin(r, found[TONE_ORIGIN], found[TONE_SOURCE]),
        .addr = value,
    };
    if (which == TONE_RANGE) {
        (void)mt_read_profile_pair(r, found[TONE_RANGE], &out->lower_hz, &out->upper_hz);
    } else {
        mt_read_profile_rotor(r, which == TONE_ROTOR ? found[TONE_ROTOR] : MT_NO_ADDR,
                              &out->rotor);
    }
}

static void read_combine(mt_reader *r, mt_addr value, mt_vibration *v)
{
    mt_addr found[COMBINE_COUNT];
    if (value == MT_NO_ADDR || !mt_reader_object(r, value, &COMBINE_TABLE, found)) {
        return;
    }
    const int rule = mt_reader_choice(r, found[COMBINE_TONES], "rule", mt_vibration_sum_names,
                                      MT_TONES_RULES);
    v->rule = rule == MT_ABSENT ? MT_TONES_SUM : (mt_vibration_sum)rule;
    if (found[COMBINE_SIGMA] != MT_NO_ADDR) {
        v->sigma = mt_read_profile_number(r, found[COMBINE_SIGMA]);
    }
}

static void read_parts(mt_reader *r, const mt_addr *found, mt_vibration *v)
{
    mt_items parts =
        found[ROOT_RANDOM] != MT_NO_ADDR &&
                mt_json_type_of(r->doc, found[ROOT_RANDOM]) == MT_JSON_ARRAY
            ? mt_reader_some_items(r, found[ROOT_RANDOM], "the list of random parts")
            : mt_reader_one_or_items(r, found[ROOT_RANDOM]);
    v->random = mt_reader_room(r, &parts, sizeof *v->random);
    while (mt_items_next(&parts)) {
        read_random(r, parts.at, v);
    }
    mt_items tones = mt_reader_some_items(r, found[ROOT_TONES], "the list of tones");
    v->sources = mt_reader_room(r, &tones, sizeof *v->sources);
    while (mt_items_next(&tones)) {
        read_tone(r, tones.at, v);
    }
}

static void read_profile_root(mt_read_profile *p)
{
    static const char *const axes[] = {"x", "y", "z"};
    mt_reader *const r = &p->r;
    mt_vibration *const v = p->v;
    mt_addr found[ROOT_COUNT];
    if (!mt_reader_format(r, "modetune-profile/1", "profile of vibration") ||
        !mt_reader_object(r, MT_JSON_ROOT, &ROOT_TABLE, found)) {
        return;
    }
    v->name = mt_reader_text(r, found[ROOT_NAME]);
    v->description = mt_reader_text(r, found[ROOT_DESCRIPTION]);
    v->source = mt_reader_text(r, found[ROOT_SOURCE]);
    r->accepted = mt_reader_accepted(r, found[ROOT_ACCEPTED]);
    v->axis = mt_reader_choice(r, found[ROOT_AXIS], "axis", axes, MT_COUNT(axes));
    if (mt_json_member(r->doc, MT_JSON_ROOT, "random") == MT_NO_ADDR &&
        mt_json_member(r->doc, MT_JSON_ROOT, "tones") == MT_NO_ADDR) {
        mt_diag_structure(r->diags, MT_JSON_ROOT,
                          "\"random\" or \"tones\" is missing: the profile is empty");
    }
    read_combine(r, found[ROOT_COMBINE], v);
    read_parts(r, found, v);
    mt_read_profile_aircraft(p, found[ROOT_AIRCRAFT]);
    mt_vibration_finish(v, r->diags);
}

/* The document's problems come before those of its catalogue. */
static mt_status read_profile_text(mt_read_profile *p, const mt_file *file,
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
    mt_read_profile p = {.files = opt == NULL ? none : *opt, .failed = MT_OK};
    mt_file file = {0};
    char *root = NULL;
    *out = NULL;
    mt_status rc = mt_vibration_new(&p.v, err);
    if (rc != MT_OK) {
        return rc;
    }
    const size_t limit = p.files.max_bytes == 0 ? MT_JSON_MAX_BYTES : p.files.max_bytes;
    rc = mt_files_read(&p.files.files, path, within, limit, &file, err);
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
