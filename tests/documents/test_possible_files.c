/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The rows of base/possible.h that studies, profiles of vibration and catalogues of aircraft
 * name, driven from both sides: the schemas are walked along good files, and at the first place
 * of each numeric member its number is replaced by one just inside and one just outside each
 * edge of its row. What is impossible is an error at its pointer, what is implausible a warning
 * there, what lies inside neither. What a number can be beside others, by the function that the
 * row names, stands in BESIDE: a wrong and a right number of every such member. A member that
 * no file has, or that nothing drives, fails. (Models: test_possible.c.)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diagnostics.h"
#include "base/possible.h"
#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "io/options.h"
#include "mt_test.h"
#include "study/read.h"
#include "study/study.h"

enum {
    FILE_LIMIT = 1 << 20,
    PATH_SIZE = 512,
    NUMBER_SIZE = 40,
    MOST_TABLES = 40,
    MOST_NAMES = 40,
    MOST_LEAVES = 8,
    MOST_DEEP = 12
};

/* Leaf number `leaf` of the member, replaced by `wrong`, is told with `text`; by `right` it is
 * not. */
static const struct beside {
    const char *table;
    const char *member;
    int leaf;
    mt_severity severity;
    const char *wrong;
    const char *right;
    const char *text;
} BESIDE[] = {
    {"variable", "lower", 0, MT_SEVERITY_ERROR, "100", "0.1", "is below lower"},
    {"variable", "upper", 0, MT_SEVERITY_ERROR, "0.01", "9", "is below lower"},
    {"variable", "catalogue", 1, MT_SEVERITY_ERROR, "4", "5", "lists 4 twice"},
    {"variable", "tolerance_percent", 0, MT_SEVERITY_WARNING, "0.05", "0.1",
     "no spring or damper is made so exactly; is 5 % meant?"},
    {"parts", "rows", 4, MT_SEVERITY_ERROR, "1000", "500", "are the same"},
    {"parts", "tolerance_percent", 0, MT_SEVERITY_ERROR, "100", "5", "below 100"},
    {"catalogue", "lower", 0, MT_SEVERITY_ERROR, "5", "1", "is below lower"},
    {"catalogue", "upper", 0, MT_SEVERITY_ERROR, "0.1", "2", "is below lower"},
    {"vary", "values", 0, MT_SEVERITY_ERROR, "0.5", "9", "is not above the lower bound"},
    {"span", "from", 0, MT_SEVERITY_ERROR, "-1", "0", "margin_percent cannot be -1"},
    {"span", "to", 0, MT_SEVERITY_ERROR, "100", "99", "margin_percent cannot be 100"},
    {"goal_frequency", "at_least_hz", 0, MT_SEVERITY_ERROR, "8", "6", "is not above"},
    {"goal_frequency", "at_most_hz", 0, MT_SEVERITY_ERROR, "0.05", "0.2", "is not above"},
    {"goal_limit", "at_least", 0, MT_SEVERITY_ERROR, "8", "6", "is not above"},
    {"goal_limit", "at_most", 0, MT_SEVERITY_ERROR, "0", "2", "is not above"},
    {"goal_static", "at_least", 0, MT_SEVERITY_ERROR, "8", "-1", "is not above"},
    {"goal_static", "at_most", 0, MT_SEVERITY_ERROR, "-4", "2", "is not above"},
    {"published", "at_least", 0, MT_SEVERITY_ERROR, "4", "2", "is below at_least"},
    {"published", "at_most", 0, MT_SEVERITY_ERROR, "0", "2", "is below at_least"},
    {"goal_response", "band_hz", 1, MT_SEVERITY_ERROR, "1", "3", "ascending"},
    {"goal_frequency_response", "band_hz", 1, MT_SEVERITY_ERROR, "0.25", "3", "ascending"},
    {"response", "band_hz", 1, MT_SEVERITY_ERROR, "0.5", "3", "ascending"},
    {"goal_avoid", "bands_hz", 1, MT_SEVERITY_ERROR, "30", "41", "is not above 40 Hz"},
    {"goal_avoid", "margin_percent", 0, MT_SEVERITY_WARNING, "0.9", "1", "next to nothing"},
    {"rotor", "margin_percent", 0, MT_SEVERITY_WARNING, "0.9", "1", "next to nothing"},
    {"machine", "margin_percent", 0, MT_SEVERITY_WARNING, "0.9", "1", "next to nothing"},
    {"rotor", "speed_range", 1, MT_SEVERITY_ERROR, "0.8", "1", "must be ascending"},
    {"rotor", "speed_range", 1, MT_SEVERITY_WARNING, "105", "2", "look like per cent"},
    {"machine", "speed_range", 1, MT_SEVERITY_ERROR, "0.4", "1", "must be ascending"},
    {"machine", "speed_range", 1, MT_SEVERITY_WARNING, "105", "2", "look like per cent"},
    {"machine", "speed_hz", 0, MT_SEVERITY_WARNING, "501", "500", "if turns per minute are"},
    {"machine", "speed_range_hz", 1, MT_SEVERITY_ERROR, "9", "12", "must be ascending"},
    {"machine", "speed_range_hz", 1, MT_SEVERITY_WARNING, "501", "500", "if turns per minute"},
    {"random", "psd_g2_per_hz", 2, MT_SEVERITY_ERROR, "19", "99", "is below the breakpoint"},
    {"random", "psd_m2_per_s3", 2, MT_SEVERITY_ERROR, "29", "31", "is below the breakpoint"},
    {"random", "published_rms_g", 0, MT_SEVERITY_WARNING, "2.6", "2.54", "off the published"},
    {"slope", "frequency_hz", 0, MT_SEVERITY_ERROR, "2e9", "6", "must be within"},
    {"slope", "slope_db_per_octave", 0, MT_SEVERITY_ERROR, "1000", "7", "level that follows"},
    {"tone", "frequency_hz", 1, MT_SEVERITY_ERROR, "47", "48", "must be ascending"},
    {"tone", "acceleration_g", 0, MT_SEVERITY_ERROR, "1e31", "1", "must be within"},
};
/* What only an analysis of the model can judge is driven by tests/cli/test_doubts.py. */
static const char *const ANALYSED[] = {"warn_target", "warn_reference"};

static const struct kind {
    const char *schema;
    const mt_key_table *const *(*tables)(int *n);
    const char *files[6];
} KINDS[] = {
    {"study",
     mt_study_key_tables,
     {"tests/documents/good/study_goals.json", "tests/documents/good/study_full.json",
      "tests/documents/good/study_bands.json"}},
    {"profile", mt_profile_key_tables, {"tests/documents/good/profile.json"}},
    {"aircraft", mt_aircraft_key_tables, {"tests/documents/good/aircraft.json"}},
};

typedef struct walk {
    mt_test *t;
    const struct kind *kind;
    const mt_key_table *const *tables;
    int n_tables;
    bool driven[MOST_TABLES][MT_MAX_KEYS];
    const mt_json *schema;
    const mt_json *doc; /* the good file */
    const char *path;
    const char *text;
    size_t length;
    int trials;
} walk;

/* Names of the definitions that a schema refers to, itself or by those it refers to, but not by
 * the members of an object. */
typedef struct name_set {
    const char *names[MOST_NAMES];
    int n;
} name_set;

static void gather(const walk *w, mt_addr schema, name_set *out)
{
    const mt_json_type type = mt_json_type_of(w->schema, schema);
    if (type != MT_JSON_OBJECT && type != MT_JSON_ARRAY) {
        return;
    }
    for (mt_addr i = mt_json_first(w->schema, schema); i != MT_NO_ADDR;
         i = mt_json_next(w->schema, i)) {
        const char *const name = type == MT_JSON_OBJECT ? mt_json_name(w->schema, i) : "";
        if (strcmp(name, "$ref") == 0) {
            const char *const to = strrchr(mt_json_string(w->schema, i), '/') + 1;
            bool known = out->n == MOST_NAMES;
            for (int k = 0; k < out->n; k++) {
                known = known || strcmp(out->names[k], to) == 0;
            }
            if (!known) {
                const mt_addr all = mt_json_member(w->schema, MT_JSON_ROOT, "definitions");
                out->names[out->n++] = to;
                gather(w, mt_json_member(w->schema, all, to), out);
            }
        } else if (strcmp(name, "properties") != 0) {
            gather(w, i, out);
        }
    }
}

static int find_table(const walk *w, const char *what)
{
    for (int i = 0; i < w->n_tables; i++) {
        if (strcmp(w->tables[i]->what, what) == 0) {
            return i;
        }
    }
    return -1;
}

static int find_key(const mt_key_table *table, const char *name)
{
    for (int k = 0; k < table->n; k++) {
        if (strcmp(table->keys[k].name, name) == 0) {
            return k;
        }
    }
    return -1;
}

/* Has the table all members of the object, and the object all that the table requires? */
static bool fits(const walk *w, const mt_key_table *table, mt_addr object)
{
    bool all = true;
    for (mt_addr i = mt_json_first(w->doc, object); i != MT_NO_ADDR;
         i = mt_json_next(w->doc, i)) {
        all = all && find_key(table, mt_json_name(w->doc, i)) >= 0;
    }
    for (int k = 0; k < table->n; k++) {
        all = all && (!table->keys[k].required ||
                      mt_json_member(w->doc, object, table->keys[k].name) != MT_NO_ADDR);
    }
    return all;
}

/* The table of an object that a member of this schema is or has; -1: it has free names. */
static int table_of(const walk *w, mt_addr schema, mt_addr object)
{
    name_set set = {.n = 0};
    const mt_addr type = mt_json_member(w->doc, object, "type");
    char goal[PATH_SIZE] = "";
    if (type != MT_NO_ADDR && mt_json_type_of(w->doc, type) == MT_JSON_STRING) {
        (void)snprintf(goal, sizeof goal, "goal_%s", mt_json_string(w->doc, type));
    }
    gather(w, schema, &set);
    int found = -1;
    for (int i = 0; i < set.n; i++) {
        const int table = find_table(w, set.names[i]);
        if (table >= 0 && fits(w, w->tables[table], object) &&
            (found < 0 || strcmp(set.names[i], goal) == 0)) {
            found = table;
        }
    }
    return found;
}

/* Messages of the file with a text in the place of the value. */
static void read_with(const walk *w, mt_addr value, const char *with, mt_diagnostics *out)
{
    size_t begin = 0;
    size_t end = 0;
    const bool token = mt_json_span(w->doc, value, &begin, &end);
    char *const text = malloc(w->length + strlen(with) + 1);
    if (!CHECK(w->t, token && text != NULL)) {
        free(text);
        return;
    }
    (void)snprintf(text, w->length + strlen(with) + 1, "%.*s%s%s", (int)begin, w->text, with,
                   w->text + end);
    const mt_file_text file = {.path = w->path, .text = text};
    const mt_io_options opt = {.files = {.given = &file, .n = 1}};
    if (w->kind->tables == mt_study_key_tables) {
        mt_study *study = NULL;
        (void)mt_study_load(w->path, &opt, &study, out, NULL);
        mt_study_delete(study);
    } else if (w->kind->tables == mt_profile_key_tables) {
        mt_vibration *v = NULL;
        (void)mt_vibration_load(w->path, &opt, &v, out, NULL);
        mt_vibration_delete(v);
    } else {
        mt_arena mem;
        mt_aircraft_list list;
        if (CHECK(w->t, mt_arena_init(&mem, 0, NULL) == MT_OK)) {
            (void)mt_aircraft_load(w->path, &opt, &mem, &list, out, NULL);
            mt_arena_free(&mem);
        }
    }
    free(text);
}

/* Is it the pointer of what is around the other's value, or of one beside it? */
static bool is_around(const char *at, const char *pointer)
{
    const size_t n = strlen(at);
    const size_t parent = (size_t)(strrchr(pointer, '/') - pointer) + 1;
    return (strncmp(at, pointer, n) == 0 && (pointer[n] == '/' || pointer[n] == '\0')) ||
           (strncmp(at, pointer, parent) == 0 && strchr(at + parent, '/') == NULL);
}

/* Is a text told of the pointer, or (`around`) of what is around it or beside it? */
static bool tells(const mt_diagnostics *d, const char *pointer, mt_severity severity,
                  const char *text, bool around)
{
    for (int i = 0; text != NULL && i < mt_diagnostics_count(d); i++) {
        const char *const at = mt_diagnostics_pointer(d, i);
        if (mt_diagnostics_severity(d, i) == severity && at != NULL &&
            (around ? is_around(at, pointer) : strcmp(at, pointer) == 0) &&
            strstr(mt_diagnostics_message(d, i), text) != NULL) {
            return true;
        }
    }
    return false;
}

/* The next number below (-1) or above (1), seen from an edge of any size. */
static double next_to(double edge, double way)
{
    return edge + (way * 1e-9 * (fabs(edge) > 0.0 ? fabs(edge) : 1e-3));
}

static void drive_row(walk *w, const mt_possible *row, mt_addr leaf, const char *pointer)
{
    const struct {
        double value;
        bool impossible;
        bool implausible; /* of what is possible */
    } trials[] = {
        {row->above ? row->least : next_to(row->least, -1.0), true, false},
        {row->above ? next_to(row->least, 1.0) : row->least, false, row->least < row->low},
        {row->under ? row->most : next_to(row->most, 1.0), true, false},
        {row->under ? next_to(row->most, -1.0) : row->most, false, row->most > row->high},
        {next_to(row->low, -1.0), false, true},
        {row->low, false, false},
        {row->at_high ? row->high : next_to(row->high, 1.0), false, true},
        {row->at_high ? next_to(row->high, -1.0) : row->high, false, false},
    };
    for (int i = 0; i < MT_COUNT(trials); i++) {
        char number[NUMBER_SIZE];
        mt_diagnostics got = {.count = 0};
        if (!isfinite(trials[i].value)) {
            continue;
        }
        (void)snprintf(number, sizeof number, "%.17g", trials[i].value);
        mt_test_row(w->t, "%s: %s with %s", w->path, pointer, number);
        read_with(w, leaf, number, &got);
        const bool impossible = tells(&got, pointer, MT_SEVERITY_ERROR, row->impossible, false);
        const bool implausible = tells(&got, pointer, MT_SEVERITY_WARNING, row->below, false) ||
                                 tells(&got, pointer, MT_SEVERITY_WARNING, row->beyond, false);
        CHECK(w->t, impossible == trials[i].impossible);
        CHECK(w->t, impossible || implausible == trials[i].implausible);
        mt_diagnostics_free(&got);
        w->trials++;
    }
}

/* A whole number: no part of one, and not below 0. */
static void drive_count(walk *w, mt_addr leaf, const char *pointer)
{
    static const char *const wrong[] = {"0.5", "-1", "1e300"};
    for (int i = 0; i < MT_COUNT(wrong); i++) {
        mt_diagnostics got = {.count = 0};
        mt_test_row(w->t, "%s: %s with %s", w->path, pointer, wrong[i]);
        read_with(w, leaf, wrong[i], &got);
        CHECK(w->t, tells(&got, pointer, MT_SEVERITY_ERROR, "must be a whole number", false));
        mt_diagnostics_free(&got);
        w->trials++;
    }
}

static void drive_beside(walk *w, const struct beside *b, mt_addr leaf, const char *pointer)
{
    for (int right = 0; right < 2; right++) {
        mt_diagnostics got = {.count = 0};
        const char *const with = right ? b->right : b->wrong;
        mt_test_row(w->t, "%s: %s with %s (%s)", w->path, pointer, with, b->text);
        read_with(w, leaf, with, &got);
        CHECK(w->t, tells(&got, pointer, b->severity, b->text, true) == (right == 0));
        mt_diagnostics_free(&got);
        w->trials++;
    }
}

static bool is_analysed(const char *function)
{
    bool is = false;
    for (int i = 0; i < MT_COUNT(ANALYSED); i++) {
        is = is || strcmp(ANALYSED[i], function) == 0;
    }
    return is;
}

/* The row of leaf number `i`: of breakpoints the first is a frequency; a catalogue's speed is
 * in the unit that the member around it names. */
static mt_possible_id row_of(const mt_key_table *table, const mt_key *key, int i,
                             const char *pointer)
{
    if (key->possible == MT_POSSIBLE_PSD || key->possible == MT_POSSIBLE_PSD_G) {
        return i % 2 == 0 ? MT_POSSIBLE_HZ : key->possible;
    }
    if (strcmp(table->what, "speed") == 0 && strstr(pointer, "speed_rpm") != NULL) {
        return MT_POSSIBLE_RPM;
    }
    return key->possible;
}

/* Numbers and expressions within a value, in lists and under free names. */
static int find_leaves(const mt_json *doc, mt_addr value, bool free_names, mt_addr *leaves,
                       int n)
{
    const mt_json_type type = mt_json_type_of(doc, value);
    if (type == MT_JSON_NUMBER || type == MT_JSON_STRING) {
        leaves[n++] = value;
    } else if (type == MT_JSON_ARRAY || (type == MT_JSON_OBJECT && free_names)) {
        for (mt_addr i = mt_json_first(doc, value); i != MT_NO_ADDR && n < MOST_LEAVES;
             i = mt_json_next(doc, i)) {
            n = find_leaves(doc, i, free_names, leaves, n);
        }
    }
    return n;
}

static void drive_member(walk *w, int table, int k, mt_addr value)
{
    const mt_key_table *const of = w->tables[table];
    const mt_key *const key = &of->keys[k];
    const mt_possible *const row = &mt_possible_of[key->possible];
    mt_addr leaves[MOST_LEAVES];
    const int n = find_leaves(w->doc, value, key->possible == MT_POSSIBLE_ANY, leaves, 0);
    const bool again = strcmp(of->what, "speed") == 0; /* in two units */
    bool judged = row->with == NULL || is_analysed(row->with);
    if (n == 0 || (w->driven[table][k] && !again) ||
        (key->possible == MT_POSSIBLE_WHOLE &&
         mt_json_type_of(w->doc, leaves[0]) != MT_JSON_NUMBER)) {
        return; /* a name of a mode, a rule of a catalogue */
    }
    for (int i = 0; i < n; i++) {
        mt_text pointer = {.s = NULL};
        mt_json_pointer(w->doc, leaves[i], &pointer);
        REQUIRE(w->t, pointer.s != NULL);
        if (key->possible == MT_POSSIBLE_WHOLE &&
            mt_json_type_of(w->doc, leaves[i]) != MT_JSON_NUMBER) {
            judged = true; /* a name in a list of modes */
        } else if (key->possible == MT_POSSIBLE_WHOLE) {
            drive_count(w, leaves[i], pointer.s);
            judged = true;
        } else if (i < 2) {
            drive_row(w, &mt_possible_of[row_of(of, key, i, pointer.s)], leaves[i], pointer.s);
        }
        for (int b = 0; b < MT_COUNT(BESIDE); b++) {
            if (BESIDE[b].leaf == i && strcmp(BESIDE[b].table, of->what) == 0 &&
                strcmp(BESIDE[b].member, key->name) == 0) {
                drive_beside(w, &BESIDE[b], leaves[i], pointer.s);
                judged = true;
            }
        }
        mt_text_free(&pointer);
    }
    mt_test_row(w->t, "\"%s\", member \"%s\": a wrong and a right number beside others",
                of->what, key->name);
    CHECK(w->t, judged);
    w->driven[table][k] = true;
}

static void walk_value(walk *w, mt_addr schema, mt_addr value, int deep);

static void walk_object(walk *w, int table, mt_addr object, int deep)
{
    const mt_key_table *const of = w->tables[table];
    const mt_addr definitions = mt_json_member(w->schema, MT_JSON_ROOT, "definitions");
    const mt_addr definition =
        *of->what == '\0' ? MT_JSON_ROOT : mt_json_member(w->schema, definitions, of->what);
    const mt_addr properties = mt_json_member(w->schema, definition, "properties");
    for (mt_addr i = mt_json_first(w->doc, object); i != MT_NO_ADDR;
         i = mt_json_next(w->doc, i)) {
        const int k = find_key(of, mt_json_name(w->doc, i));
        REQUIRE(w->t, k >= 0);
        if (of->keys[k].possible != MT_POSSIBLE_NONE) {
            drive_member(w, table, k, i);
        }
        walk_value(w, mt_json_member(w->schema, properties, of->keys[k].name), i, deep + 1);
    }
}

static void walk_value(walk *w, mt_addr schema, mt_addr value, int deep)
{
    const mt_json_type type = mt_json_type_of(w->doc, value);
    if (deep > MOST_DEEP || (type != MT_JSON_OBJECT && type != MT_JSON_ARRAY)) {
        return;
    }
    const int table = type == MT_JSON_OBJECT ? table_of(w, schema, value) : -1;
    if (table >= 0) {
        walk_object(w, table, value, deep);
        return;
    }
    for (mt_addr i = mt_json_first(w->doc, value); i != MT_NO_ADDR;
         i = mt_json_next(w->doc, i)) {
        walk_value(w, schema, i, deep + 1);
    }
}

static void walk_file(walk *w, const char *name)
{
    char path[PATH_SIZE];
    mt_file file = {0};
    mt_json *doc = NULL;
    (void)snprintf(path, sizeof path, "%s/%s", MT_TEST_SOURCE_DIR, name);
    REQUIRE(w->t, mt_file_read(path, NULL, FILE_LIMIT, &file, NULL) == MT_OK);
    REQUIRE(w->t, mt_json_parse(file.bytes, file.length, &doc, NULL) == MT_OK);
    w->path = path;
    w->text = file.bytes;
    w->length = file.length;
    w->doc = doc;
    walk_object(w, find_table(w, ""), MT_JSON_ROOT, 0);
    w->path = NULL;
    mt_json_delete(doc);
    mt_file_free(&file);
}

static void drive_kind(mt_test *t, const struct kind *kind)
{
    char path[PATH_SIZE];
    mt_file file = {0};
    mt_json *schema = NULL;
    walk w = {.t = t, .kind = kind};
    (void)snprintf(path, sizeof path, "%s/schemas/%s.schema.json", MT_TEST_SOURCE_DIR,
                   kind->schema);
    REQUIRE(t, mt_file_read(path, NULL, FILE_LIMIT, &file, NULL) == MT_OK);
    REQUIRE(t, mt_json_parse(file.bytes, file.length, &schema, NULL) == MT_OK);
    w.schema = schema;
    w.tables = kind->tables(&w.n_tables);
    REQUIRE(t, w.n_tables <= MOST_TABLES);
    for (int i = 0; i < MT_COUNT(kind->files) && kind->files[i] != NULL; i++) {
        walk_file(&w, kind->files[i]);
    }
    for (int i = 0; i < w.n_tables; i++) {
        for (int k = 0; k < w.tables[i]->n; k++) {
            const mt_key *const key = &w.tables[i]->keys[k];
            mt_test_row(t, "%s: \"%s\", member \"%s\" stands in no good file", kind->schema,
                        w.tables[i]->what, key->name);
            CHECK(t, key->possible == MT_POSSIBLE_NONE || w.driven[i][k]);
        }
    }
    mt_test_row(t, "%s", kind->schema);
    CHECK(t, w.trials > 5);
    mt_json_delete(schema);
    mt_file_free(&file);
}

static void possible__every_number_of_a_study_is_driven_from_both_sides(mt_test *t)
{
    drive_kind(t, &KINDS[0]);
}

static void possible__every_number_of_a_profile_is_driven_from_both_sides(mt_test *t)
{
    drive_kind(t, &KINDS[1]);
}

static void possible__every_number_of_a_catalogue_is_driven_from_both_sides(mt_test *t)
{
    drive_kind(t, &KINDS[2]);
}

MT_TEST_MAIN(MT_TEST(possible__every_number_of_a_study_is_driven_from_both_sides),
             MT_TEST(possible__every_number_of_a_profile_is_driven_from_both_sides),
             MT_TEST(possible__every_number_of_a_catalogue_is_driven_from_both_sides))
