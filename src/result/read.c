/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A result read back, whole: every member of the tables must be there and of its type, but for
 * those that programs of earlier days did not write, and no other. Besides, the parameters of
 * every design are the variables, and each point of a trade study has one value of each
 * quantity that varies.
 */
#include "result/read.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/folder.h"
#include "io/json.h"
#include "io/reader.h"
#include "result/folder.h"
#include "study/study.h"

enum { READER_PATIENCE_MS = 10000 };

enum {
    MOST_FIELDS = 40, /* of a record */
    MOST_OUTPUTS = 16,
    MANY_POINTS = 200 /* of a trade study: read one by one */
};

typedef struct result_reader {
    mt_reader r;
    mt_result *result;
    int n_variables;
    const char **variables; /* [n_variables] as listed; they live as long as the document */
    mt_name *by_name;       /* [n_variables] sorted; addr: the place in the list */
} result_reader;

static void read_record(result_reader *s, mt_addr value, const mt_record *record, void *item);

static mt_addr member(const result_reader *s, mt_addr object, const char *name)
{
    return object == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(s->r.doc, object, name);
}

/* Null where it may be; what is absent or wrong has been noted, and reads as null. */
static bool is_null(result_reader *s, const mt_field *f, mt_addr value)
{
    return value == MT_NO_ADDR ||
           (f->nullable && mt_json_type_of(s->r.doc, value) == MT_JSON_NULL);
}

static double read_number(result_reader *s, mt_addr value, bool nullable)
{
    const mt_json_type type = mt_json_type_of(s->r.doc, value);
    if (type == MT_JSON_NUMBER) {
        return mt_json_number(s->r.doc, value);
    }
    if (type != MT_JSON_NULL || !nullable) {
        mt_diag_structure(s->r.diags, value, "must be a number%s, not %s",
                          nullable ? " or null" : "", mt_json_type_text(type));
    }
    return nan("");
}

/* Integers are exact in a double up to here. */
static const double LONGEST = 9007199254740992.0;

static long read_long(result_reader *s, mt_addr value)
{
    if (!mt_reader_type(&s->r, value, MT_KEY_COUNT)) {
        return 0;
    }
    const double number = mt_json_number(s->r.doc, value);
    if (number == floor(number) && number >= 0.0 && number <= LONGEST) {
        return (long)number;
    }
    mt_diag_structure(s->r.diags, value, "must be a whole number, 0 or more");
    return 0;
}

static void read_list(result_reader *s, mt_addr value, const mt_field *f, void *at, int *n)
{
    if (!mt_reader_type(&s->r, value, MT_KEY_LIST)) {
        return;
    }
    mt_items items = mt_reader_items(&s->r, value);
    char *const room = mt_reader_room(&s->r, &items, f->record->size);
    mt_record_set_pointer(at, room);
    for (*n = 0; mt_items_next(&items); ++*n) {
        read_record(s, items.at, f->record, room + ((size_t)*n * f->record->size));
    }
}

/* One of the names; as the table has it, so that it lives for ever. */
static const char *read_choice(result_reader *s, mt_addr value, const mt_field *f)
{
    const int k = mt_reader_choice(&s->r, value, f->name, f->choices, f->n_choices);
    return k == MT_ABSENT ? NULL : f->choices[k];
}

/* The first where it is none of them (noted). */
static int read_enum(result_reader *s, mt_addr value, const mt_field *f)
{
    const int k = mt_reader_choice(&s->r, value, f->name, f->choices, f->n_choices);
    return k == MT_ABSENT ? 0 : k;
}

static void read_texts(result_reader *s, mt_addr value, const mt_field *f, const char ***texts,
                       int *n)
{
    if (!mt_reader_type(&s->r, value, MT_KEY_LIST)) {
        return;
    }
    mt_items items = mt_reader_items(&s->r, value);
    *texts = mt_reader_room(&s->r, &items, sizeof **texts);
    for (*n = 0; mt_items_next(&items); ++*n) {
        (*texts)[*n] =
            f->choices != NULL ? read_choice(s, items.at, f) : mt_reader_text(&s->r, items.at);
    }
}

static void read_numbers(result_reader *s, mt_addr value, double **numbers, int *n)
{
    if (!mt_reader_type(&s->r, value, MT_KEY_LIST)) {
        return;
    }
    mt_items items = mt_reader_items(&s->r, value);
    *numbers = mt_reader_room(&s->r, &items, sizeof **numbers);
    for (*n = 0; mt_items_next(&items); ++*n) {
        (*numbers)[*n] = read_number(s, items.at, true);
    }
}

static int by_name(const void *a, const void *b)
{
    const mt_name *const x = a;
    const mt_name *const y = b;
    return strcmp(x->s, y->s);
}

/* Index of the variable; `expected` is tried first. MT_ABSENT: there is none of that name. */
static int find_variable(const result_reader *s, const char *name, int expected)
{
    if (expected < s->n_variables && strcmp(s->variables[expected], name) == 0) {
        return expected;
    }
    const mt_name key = {.s = name};
    const mt_name *const found =
        s->n_variables == 0
            ? NULL
            : bsearch(&key, s->by_name, (size_t)s->n_variables, sizeof key, by_name);
    return found == NULL ? MT_ABSENT : (int)found->addr;
}

/* Each variable's number, by its name: the parser has seen that no name comes twice. */
static double *read_by_variable(result_reader *s, mt_addr value, bool nullable)
{
    const int n = s->n_variables;
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return NULL;
    }
    double *const values = mt_arena_f64(s->r.mem, (size_t)n, 1);
    int members = 0;
    bool known = true;
    for (mt_items i = mt_reader_items(&s->r, value); values != NULL && mt_items_next(&i);) {
        const char *const name = mt_json_name(s->r.doc, i.at);
        const int k = find_variable(s, name, members);
        if (k == MT_ABSENT) {
            mt_diag_error(s->r.diags, mt_json_name_addr(s->r.doc, i.at),
                          "\"%s\" is not a variable", name);
            known = false;
        } else {
            values[k] = read_number(s, i.at, nullable);
            members++;
        }
    }
    if (values != NULL && known && members < n) {
        mt_diag_error(s->r.diags, value, "%d of %d variables are missing", n - members, n);
    }
    return values;
}

static void read_option(result_reader *s, mt_addr value, const mt_field *f, void *at)
{
    void *const own = mt_arena_alloc(s->r.mem, 1, f->record->size);
    mt_record_set_pointer(at, own);
    if (own != NULL) {
        read_record(s, value, f->record, own);
    }
}

/* `value` is neither null nor absent. */
static void read_field(result_reader *s, mt_addr value, const mt_field *f, void *item)
{
    void *const at = (char *)item + f->offset;
    void *const other = (char *)item + f->other;
    switch (f->type) {
    case MT_FIELD_FORMAT: /* mt_record_check_format */
        break;
    case MT_FIELD_TEXT:
        *(const char **)at = mt_reader_text(&s->r, value);
        break;
    case MT_FIELD_CHOICE:
        *(const char **)at = read_choice(s, value, f);
        break;
    case MT_FIELD_ENUM:
        *(int *)at = read_enum(s, value, f);
        break;
    case MT_FIELD_NUMBER:
        *(double *)at = read_number(s, value, f->nullable);
        break;
    case MT_FIELD_VALUE:
        if (mt_json_type_of(s->r.doc, value) == MT_JSON_STRING) {
            *(const char **)other = mt_reader_text(&s->r, value);
            break;
        }
        *(double *)at = read_number(s, value, f->nullable);
        break;
    case MT_FIELD_COUNT:
        *(int *)at = mt_reader_count(&s->r, value, f->least, INT_MAX, *(int *)at);
        break;
    case MT_FIELD_LONG:
        *(long *)at = read_long(s, value);
        break;
    case MT_FIELD_FLAG:
        *(bool *)at = mt_reader_flag(&s->r, value, false);
        break;
    case MT_FIELD_RECORD:
        read_record(s, value, f->record, at);
        break;
    case MT_FIELD_OPTION:
        read_option(s, value, f, at);
        break;
    case MT_FIELD_LIST:
        read_list(s, value, f, at, other);
        break;
    case MT_FIELD_TEXTS:
        read_texts(s, value, f, at, other);
        break;
    case MT_FIELD_NUMBERS:
        read_numbers(s, value, at, other);
        break;
    case MT_FIELD_BY_VARIABLE:
        mt_record_set_pointer(at, read_by_variable(s, value, f->numbers_nullable));
        break;
    case MT_FIELD_TYPE_COUNT:
        break;
    }
}

static const mt_field *find_field(const mt_record *record, const char *name, int expected)
{
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[(expected + i) % record->n];
        if (f->name != NULL && strcmp(f->name, name) == 0) {
            return f;
        }
    }
    return NULL;
}

/* What stands for a member that the program that wrote the file did not know; item: cleared,
 * with all members that the file has. */
static void leave_out(const mt_field *f, void *item)
{
    void *const at = (char *)item + f->offset;
    if (f->type == MT_FIELD_TEXT && !f->nullable) {
        mt_record_set_pointer(at, mt_record_get_pointer((const char *)item + f->other));
    } else if (f->type == MT_FIELD_LONG) {
        *(long *)at = f->least - 1L;
    } else if (f->type == MT_FIELD_RECORD) {
        for (int i = 0; i < f->record->n; i++) {
            leave_out(&f->record->fields[i], at);
        }
    }
}

static void read_members(result_reader *s, mt_addr value, const mt_record *record, void *item)
{
    bool seen[MOST_FIELDS] = {false};
    int expected = 0;
    assert(record->n <= MOST_FIELDS);
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return;
    }
    for (mt_items i = mt_reader_items(&s->r, value); mt_items_next(&i);) {
        const char *const name = mt_json_name(s->r.doc, i.at);
        const mt_field *const f = find_field(record, name, expected);
        if (f != NULL && !seen[f - record->fields]) { /* given twice has been noted */
            seen[f - record->fields] = true;
            expected = (int)(f - record->fields) + 1;
            if (!is_null(s, f, i.at)) {
                read_field(s, i.at, f, item);
            }
        } else if (f == NULL) {
            mt_diag_structure(s->r.diags, mt_json_name_addr(s->r.doc, i.at),
                              "unknown member \"%s\"", name);
        }
    }
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        if (f->later && !seen[i]) {
            leave_out(f, item);
        } else if (f->name != NULL && f->type != MT_FIELD_FORMAT && !seen[i]) {
            mt_diag_structure(s->r.diags, value, "member \"%s\" is missing", f->name);
        }
    }
}

/* The text that stands in place of the record; NULL: this value is none. */
static const mt_field *find_alone(const result_reader *s, mt_addr value,
                                  const mt_record *record)
{
    for (int i = 0; i < record->n && mt_json_type_of(s->r.doc, value) == MT_JSON_STRING; i++) {
        if (record->fields[i].alone) {
            return &record->fields[i];
        }
    }
    return NULL;
}

static void read_record(result_reader *s, mt_addr value, const mt_record *record, void *item)
{
    const mt_field *const alone = find_alone(s, value, record);
    mt_record_clear(record, item);
    if (alone != NULL) {
        read_field(s, value, alone, item);
    } else {
        read_members(s, value, record, item);
    }
}

/* The variables come before what is told by their names, wherever they stand; what is no text
 * is noted when its turn comes. */
static void list_variables(result_reader *s)
{
    const mt_addr list = member(s, MT_JSON_ROOT, "variables");
    mt_items items = mt_reader_items(&s->r, list);
    const mt_items again = items;
    s->variables = mt_reader_room(&s->r, &items, sizeof *s->variables);
    items = again;
    s->by_name = mt_reader_room(&s->r, &items, sizeof *s->by_name);
    if (mt_arena_failed(s->r.mem)) {
        return;
    }
    while (mt_items_next(&items)) {
        const bool is_text = mt_json_type_of(s->r.doc, items.at) == MT_JSON_STRING;
        const char *const name = is_text ? mt_json_string(s->r.doc, items.at) : "";
        if (is_text && mt_json_type_of(s->r.doc, list) == MT_JSON_ARRAY) {
            s->by_name[s->n_variables] = (mt_name){.s = name, .addr = s->n_variables};
            s->variables[s->n_variables++] = name;
        }
    }
    if (s->n_variables > 0) {
        qsort(s->by_name, (size_t)s->n_variables, sizeof *s->by_name, by_name);
    }
    for (int i = 1; i < s->n_variables; i++) {
        if (strcmp(s->by_name[i].s, s->by_name[i - 1].s) == 0) {
            mt_diag_error(s->r.diags, list, "\"%s\" is listed twice", s->by_name[i].s);
        }
    }
}

/* The parameters of a design are the variables, in their order; a design that was not found has
 * none. */
static void check_design(result_reader *s, mt_addr design)
{
    const mt_addr list = member(s, design, "parameters");
    mt_items items = mt_reader_items(&s->r, list);
    if (items.count != 0 && items.count != s->n_variables) {
        mt_diag_error(s->r.diags, list, "has %d parameters, not one for each of %d variables",
                      items.count, s->n_variables);
        return;
    }
    for (int i = 0; mt_items_next(&items); i++) {
        const mt_addr name = member(s, items.at, "name");
        if (name != MT_NO_ADDR && mt_json_type_of(s->r.doc, name) == MT_JSON_STRING &&
            strcmp(mt_json_string(s->r.doc, name), s->variables[i]) != 0) {
            mt_diag_error(s->r.diags, name, "must be \"%s\", the variable of this place",
                          s->variables[i]);
        }
    }
}

/* A value for each of the n quantities that vary, and the variables. */
static void check_point(result_reader *s, int n, mt_addr point)
{
    const mt_addr values = member(s, point, "values");
    if (values != MT_NO_ADDR && mt_reader_items(&s->r, values).count != n) {
        mt_diag_error(s->r.diags, values, "must have %d value%s, as many as vary", n,
                      n == 1 ? "" : "s");
    }
    check_design(s, member(s, point, "best"));
}

static void check_trade(result_reader *s, mt_addr trade)
{
    const mt_addr vary = member(s, trade, "vary");
    const int n = mt_reader_items(&s->r, vary).count;
    if (n < 1 || n > MT_MAX_VARY) {
        mt_diag_structure(s->r.diags, vary == MT_NO_ADDR ? trade : vary,
                          "must have 1 to %d quantities", MT_MAX_VARY);
    }
    mt_items points = mt_reader_items(&s->r, member(s, trade, "points"));
    while (mt_items_next(&points)) {
        check_point(s, n, points.at);
    }
}

/* Check the outputs: few, and with valid places. */
static void check_outputs(result_reader *s, mt_addr list)
{
    mt_items items = mt_reader_items(&s->r, list);
    if (items.count > MOST_OUTPUTS) {
        mt_diag_error(s->r.diags, list, "names more than %d files", MOST_OUTPUTS);
        return;
    }
    while (mt_items_next(&items)) {
        const mt_addr file = member(s, items.at, "file");
        const bool is_text =
            file != MT_NO_ADDR && mt_json_type_of(s->r.doc, file) == MT_JSON_STRING;
        const char *const name = is_text ? mt_json_string(s->r.doc, file) : "";
        if (is_text && (name[0] == '\0' || strchr(name, '/') != NULL ||
                        strcmp(name, ".") == 0 || strcmp(name, "..") == 0)) {
            mt_diag_error(s->r.diags, file, "\"%s\" is not a file beside it", name);
        }
    }
}

static bool is_number(const result_reader *s, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER;
}

/* True where one of the designs tells a clearance from bands; design: the member of the items
 * that is one; NULL: the items are. */
static bool has_clearance(const result_reader *s, mt_addr designs, const char *design)
{
    for (mt_items i = mt_reader_items(&s->r, designs); mt_items_next(&i);) {
        const mt_addr at = design == NULL ? i.at : member(s, i.at, design);
        if (is_number(s, member(s, at, "clearance_percent"))) {
            return true;
        }
    }
    return false;
}

/* False where no defaults stand for what has changed since the file was written. Up to November
 * 22, 2026, goals were only words, without type, unit, target and limits, and designs had a
 * "score_unit". Up to November 26 (a result had no "assumptions" then) clearances from bands
 * were told in percent of the edge, in numbers and sentences. */
static bool check_age(const result_reader *s)
{
    const mt_addr baseline = member(s, MT_JSON_ROOT, "baseline");
    const mt_addr points = member(s, member(s, MT_JSON_ROOT, "trade"), "points");
    const char *why = NULL;
    if (member(s, baseline, "score_unit") != MT_NO_ADDR) {
        why = "22, 2026, or before, which tells neither types nor limits of goals";
    } else if (member(s, MT_JSON_ROOT, "assumptions") == MT_NO_ADDR &&
               (has_clearance(s, member(s, MT_JSON_ROOT, "recommendations"), NULL) ||
                has_clearance(s, points, "best") ||
                is_number(s, member(s, baseline, "clearance_percent")))) {
        why = "26, 2026, or before, which tells clearances from bands in percent of the edge, "
              "not "
              "as ratios of frequencies";
    }
    if (why != NULL) {
        mt_diag_structure(s->r.diags, MT_JSON_ROOT,
                          "written by a modetune 0.1.0 of November %s: run the study again",
                          why);
    }
    return why == NULL;
}

static void read_result_root(result_reader *s)
{
    if (!mt_record_check_format(&s->r, &mt_result_record, "result")) {
        return;
    }
    if (!check_age(s)) {
        return;
    }
    list_variables(s);
    read_members(s, MT_JSON_ROOT, &mt_result_record, s->result);
    check_design(s, member(s, MT_JSON_ROOT, "baseline"));
    const mt_addr list = member(s, MT_JSON_ROOT, "recommendations");
    for (mt_items i = mt_reader_items(&s->r, list); mt_items_next(&i);) {
        check_design(s, i.at);
    }
    if (s->result->trade != NULL) {
        check_trade(s, member(s, MT_JSON_ROOT, "trade"));
    }
    check_outputs(s, member(s, member(s, MT_JSON_ROOT, "run"), "outputs"));
    for (int i = 0; i < s->result->n_doubts; i++) {
        s->result->doubts[i].level = MT_LEVEL_WARNING;
    }
}

/*
 * The points of a trade study as mt_result_write writes them: nearly all of a large
 * result.json, and each a JSON text of its own that can be read alone. JSON as a whole takes
 * nine times its text while it is read.
 */
typedef struct point_texts {
    int n;
    const char *at; /* the next one */
    char *rest;     /* the text with an empty list instead of the points; from malloc */
    size_t rest_length;
} point_texts;

static const char TRADE[] = "\n  \"trade\": {\n";
static const char LIST[] = "\n    \"points\": [";
static const char POINT[] = "\n      {\n";
static const char POINT_END[] = "\n      }";
static const char LIST_END[] = "\n    ]";

static bool stands_at(const char *text, const char *what)
{
    return strncmp(text, what, strlen(what)) == 0;
}

/* Walk over the points behind `from`, which ends behind the last of them. -1: laid out
 * otherwise. */
static int count_points(const char **from)
{
    int n = 0;
    const char *at = *from;
    while (stands_at(at, POINT) && n < INT_MAX) {
        const char *const end = strstr(at + 1, POINT_END);
        if (end == NULL) {
            return -1;
        }
        at = end + strlen(POINT_END);
        n++;
        if (stands_at(at, LIST_END)) {
            *from = at;
            return n;
        }
        if (*at++ != ',') {
            return -1;
        }
    }
    return -1;
}

/* Find the points, by lines and their indentation: no line feed stands within a valid string.
 * If `rest` and every point are JSON, and `rest` has no list of points elsewhere, these are the
 * points of /trade/points. n 0 and rest NULL where the text has fewer than `least` points or is
 * laid out otherwise; else owned by the caller (free_points), and `text` outlives it. Fails:
 * MT_E_MEMORY. */
static mt_status find_points(const char *text, size_t length, int least, point_texts *out,
                             mt_err *err)
{
    *out = (point_texts){.n = 0};
    const char *const trade = strstr(text, TRADE);
    const char *const list = trade == NULL ? NULL : strstr(trade, LIST);
    const char *const first = list == NULL ? NULL : list + strlen(LIST);
    const char *end = first;
    const int n = first == NULL ? -1 : count_points(&end);
    if (n < least || end == NULL) {
        return MT_OK;
    }
    const size_t before = (size_t)(first - text);
    const size_t after = length - (size_t)(end - text);
    char *const rest = malloc(before + after + 1);
    if (rest == NULL) {
        return mt_fail(err, MT_E_MEMORY, "%s", mt_status_text(MT_E_MEMORY));
    }
    memcpy(rest, text, before);
    memcpy(rest + before, end, after);
    rest[before + after] = '\0';
    out->n = n;
    out->at = first;
    out->rest = rest;
    out->rest_length = before + after;
    return MT_OK;
}

/* The text of the next of the n points; returns its length. */
static size_t next_point(point_texts *p, const char **text)
{
    *text = p->at + 1;
    const char *const end = strstr(*text, POINT_END) + strlen(POINT_END);
    p->at = end + 1; /* behind its comma, but for the last one */
    return (size_t)(end - *text);
}

static void free_points(point_texts *p)
{
    free(p->rest);
    *p = (point_texts){.n = 0};
}

/* Parse a text, and read from it next; *whole: nothing is to be said about it. */
static mt_status open_part(result_reader *s, const char *text, size_t length, mt_json **doc,
                           bool *whole, mt_err *err)
{
    const mt_status rc = mt_json_parse(text, length, doc, err);
    s->r.doc = *doc;
    s->r.diags = *doc == NULL ? NULL : mt_json_diags(*doc);
    s->r.n_matched = 0; /* addresses of another text */
    *whole = rc == MT_OK;
    return rc == MT_E_INPUT ? MT_OK : rc;
}

static mt_status close_part(result_reader *s, bool *whole, mt_err *err)
{
    *whole = *whole && s->r.diags->errors == 0 && s->r.diags->warnings == 0;
    MT_TRY(mt_arena_check(s->r.diags->mem, err));
    return mt_arena_check(s->r.mem, err);
}

static mt_status read_points(result_reader *s, point_texts *points, bool *whole, mt_err *err)
{
    const mt_field *const trade = find_field(&mt_result_record, "trade", 0);
    const mt_field *const list = trade == NULL ? NULL : find_field(trade->record, "points", 0);
    mt_trade_result *const to = s->result->trade;
    if (list == NULL) {
        return mt_fail(err, MT_E_INTERNAL, "a result has no list of points");
    }
    to->points = mt_arena_alloc(s->r.mem, (size_t)points->n, sizeof *to->points);
    MT_TRY(mt_arena_check(s->r.mem, err));
    for (int i = 0; i < points->n && *whole; i++) {
        mt_json *doc = NULL;
        const char *text = NULL;
        const size_t length = next_point(points, &text);
        mt_status rc = open_part(s, text, length, &doc, whole, err);
        if (*whole) {
            read_record(s, MT_JSON_ROOT, list->record, &to->points[i]);
            check_point(s, to->n_vary, MT_JSON_ROOT);
            rc = close_part(s, whole, err);
        }
        mt_json_delete(doc);
        MT_TRY(rc);
    }
    to->n_points = points->n;
    return MT_OK;
}

/* The same as of the whole text, in a tenth of its memory, where the text is laid out as
 * mt_result_write does and there is nothing to say about it; else *whole is false. */
static mt_status read_in_parts(result_reader *s, const mt_file *file, bool *whole, mt_err *err)
{
    point_texts points;
    mt_json *rest = NULL; /* the names of the variables live in it */
    *whole = false;
    MT_TRY(find_points(file->bytes, file->length, MANY_POINTS, &points, err));
    if (points.rest == NULL) {
        return MT_OK;
    }
    mt_status rc = open_part(s, points.rest, points.rest_length, &rest, whole, err);
    if (*whole) {
        read_result_root(s);
        rc = close_part(s, whole, err);
    }
    *whole = *whole && s->result->trade != NULL && s->result->trade->n_points == 0;
    if (rc == MT_OK && *whole) {
        rc = read_points(s, &points, whole, err);
    }
    mt_json_delete(rest);
    free_points(&points);
    return rc;
}

static mt_status read_result_text(result_reader *s, const char *path, const mt_file *file,
                                  mt_diagnostics *messages, mt_err *err)
{
    mt_json *doc = NULL;
    bool whole = false;
    mt_err own = {.code = MT_OK};
    s->r.mem = &s->result->mem;
    mt_status rc = read_in_parts(s, file, &whole, &own);
    if (rc != MT_OK) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (whole) {
        return MT_OK;
    }
    mt_result_delete(s->result); /* what could be read of it in parts */
    *s = (result_reader){.result = NULL};
    MT_TRY(mt_result_new(&s->result, err));
    rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (doc == NULL) {
        return rc;
    }
    s->r.doc = doc;
    s->r.diags = mt_json_diags(doc);
    s->r.mem = &s->result->mem;
    if (rc == MT_OK) {
        read_result_root(s);
    }
    rc = mt_reader_status(&s->r, path, err);
    if (messages != NULL) {
        mt_json_report(doc, path, messages);
        rc = messages->lines.failed ? mt_fail_memory(err) : rc;
    }
    mt_json_delete(doc);
    return rc;
}

/*
 * What belongs to a result.json. It names the files beside it with their digests (run.outputs)
 * but for timing.json, which differs from run to run where the result does not, and so names
 * the result's digest instead. A file that is not there contradicts nothing, unless the folder
 * is just being replaced; one that is must be the one that is named.
 */
static const char RESULT[] = "result.json";
static const char TIMING[] = "timing.json";

enum { PART_MAX_BYTES = 1 << 28 };

typedef enum part_state { PART_MISSING, PART_BELONGS, PART_FOREIGN } part_state;

/* *does: true where timing.json names the result with this digest. */
static mt_status names_result(const mt_file *timing, const char *sha256, bool *does,
                              mt_err *err)
{
    mt_json *doc = NULL;
    mt_status rc = mt_json_parse(timing->bytes, timing->length, &doc, err);
    *does = false;
    if (rc == MT_OK) {
        const mt_addr value = mt_json_member(doc, MT_JSON_ROOT, "result_sha256");
        *does = value != MT_NO_ADDR && mt_json_type_of(doc, value) == MT_JSON_STRING &&
                strcmp(mt_json_string(doc, value), sha256) == 0;
    }
    mt_json_delete(doc);
    return rc == MT_E_INPUT ? MT_OK : rc;
}

mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out, mt_err *err)
{
    const char *const name = mt_result_file_name(MT_RESULT_FILE_TIMING);
    char *const timing = mt_file_join(path, name);
    mt_file file = {.bytes = NULL};
    bool belongs = false;
    if (timing == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = MT_OK;
    if (!mt_file_absent(timing)) {
        rc = mt_file_read(timing, NULL, PART_MAX_BYTES, &file, err);
        rc = rc == MT_OK ? names_result(&file, sha256, &belongs, err) : rc;
    }
    if (belongs) {
        mt_text_add_n(out, file.bytes, file.length);
    }
    mt_file_free(&file);
    free(timing);
    return out->failed ? mt_fail_memory(err) : rc == MT_E_INPUT ? MT_OK : rc;
}

/* The file of that name beside the result; `sha256` is its own digest, or the result's for
 * timing.json. */
static mt_status check_part_file(const char *path, const char *name, const char *sha256,
                                 part_state *state, mt_err *err)
{
    char *const part = mt_file_join(path, name);
    mt_file file = {.bytes = NULL};
    if (part == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = MT_OK;
    *state = PART_MISSING;
    if (!mt_file_absent(part)) {
        bool belongs = false;
        rc = mt_file_read(part, NULL, PART_MAX_BYTES, &file, err);
        if (rc == MT_OK && strcmp(name, TIMING) == 0) {
            rc = names_result(&file, sha256, &belongs, err);
        } else if (rc == MT_OK) {
            belongs = strcmp(file.sha256, sha256) == 0;
        }
        *state = belongs ? PART_BELONGS : PART_FOREIGN;
        if (rc == MT_E_SYSTEM && mt_file_absent(part)) { /* gone meanwhile */
            *state = PART_MISSING;
            rc = MT_OK;
        }
        rc = rc == MT_E_INPUT ? MT_OK : rc; /* a pipe, a folder: not what was written */
    }
    mt_file_free(&file);
    free(part);
    return rc;
}

static mt_status refuse_foreign_part(const char *path, const char *name, bool unfinished,
                                     mt_err *err)
{
    if (unfinished) {
        return mt_fail(err, MT_E_INPUT,
                       "%s: a run ended while it replaced the files of this folder, and \"%s\" "
                       "is not of this result: run the study again",
                       path, name);
    }
    return mt_fail(err, MT_E_INPUT,
                   "%s: \"%s\" beside it is not of this result: one of them was changed, or "
                   "comes from another run. Run the study again, or copy the %s that you trust "
                   "to where it stands alone",
                   path, name, RESULT);
}

/* The digest that the result names for a file; NULL. */
static const char *named_digest(const mt_result *r, const char *name)
{
    for (int i = 0; i < r->run.n_outputs; i++) {
        if (strcmp(r->run.outputs[i].file, name) == 0) {
            return r->run.outputs[i].sha256;
        }
    }
    return NULL;
}

/* True where the result was written as a folder and the path still has its file name. A renamed
 * copy belongs to no folder. */
static bool has_folder(const char *path, const mt_result *result)
{
    return result->run.n_outputs > 0 && strcmp(mt_text_base_name(path), RESULT) == 0;
}

/* Check that the other files in the folder of such a result, where they exist, match it.
 * sha256: of its own bytes. Fails: MT_E_INPUT where they do not, MT_E_SYSTEM, MT_E_MEMORY. */
static mt_status check_folder(const char *path, const char *sha256, const mt_result *result,
                              mt_err *err)
{
    char *const folder = mt_file_folder(path);
    if (folder == NULL) {
        return mt_fail_memory(err);
    }
    const bool unfinished = mt_folder_unfinished(folder, RESULT);
    free(folder);
    part_state state = PART_MISSING;
    for (int i = 0; i < result->run.n_outputs; i++) {
        const char *const name = result->run.outputs[i].file;
        MT_TRY(check_part_file(path, name, result->run.outputs[i].sha256, &state, err));
        if (state == PART_FOREIGN || (state == PART_MISSING && unfinished)) {
            return refuse_foreign_part(path, name, unfinished, err);
        }
    }
    for (int i = 0; i < MT_RESULT_FILE_COUNT;
         i++) { /* also what a result without it stands by */
        const char *const name = mt_result_file_name((mt_result_file)i);
        if (i != MT_RESULT_FILE_RESULT && named_digest(result, name) == NULL) {
            MT_TRY(check_part_file(path, name, i == MT_RESULT_FILE_TIMING ? sha256 : "", &state,
                                   err));
            if (state == PART_FOREIGN) {
                return refuse_foreign_part(path, name, unfinished, err);
            }
        }
    }
    return MT_OK;
}

/* From a file. */

static const mt_files *files_of(const mt_io_options *opt)
{
    return opt == NULL ? NULL : &opt->files;
}

/* The file by itself; sha256 of its bytes. */
static mt_status load_alone(const char *path, const mt_io_options *opt, mt_result **out,
                            char sha256[MT_SHA256_TEXT], mt_diagnostics *messages, mt_err *err)
{
    const size_t limit =
        opt == NULL || opt->max_bytes == 0 ? MT_JSON_MAX_BYTES : opt->max_bytes;
    mt_file file = {0};
    result_reader s = {.result = NULL};
    *out = NULL;
    mt_status rc = mt_result_new(&s.result, err);
    if (rc == MT_OK) {
        rc = mt_files_read(files_of(opt), path, NULL, limit, &file, err);
    }
    if (rc == MT_OK) {
        memcpy(sha256, file.sha256, MT_SHA256_TEXT);
        rc = read_result_text(&s, path, &file, messages, err);
    }
    mt_file_free(&file);
    if (rc != MT_OK) {
        mt_result_delete(s.result);
        return rc;
    }
    *out = s.result;
    return MT_OK;
}

/* Read again under the folder's lock: files that did not match may have been in the middle of a
 * replacement. */
static mt_status load_locked(const char *path, const mt_io_options *opt, mt_result **out,
                             mt_diagnostics *messages, mt_err *err)
{
    char sha256[MT_SHA256_TEXT];
    char *const folder = mt_file_folder(path);
    if (folder == NULL) {
        return mt_fail_memory(err);
    }
    int lock = -1;
    mt_status rc = mt_folder_lock(folder, true, READER_PATIENCE_MS, &lock, err);
    free(folder);
    rc = rc == MT_OK ? load_alone(path, opt, out, sha256, messages, err) : rc;
    if (rc == MT_OK && has_folder(path, *out)) {
        rc = check_folder(path, sha256, *out, err);
    }
    mt_folder_unlock(lock);
    return rc;
}

mt_status mt_result_load(const char *path, const mt_io_options *opt, mt_result **out,
                         mt_diagnostics *messages, mt_err *err)
{
    char sha256[MT_SHA256_TEXT];
    bool given = false; /* by its text, which has no folder */
    *out = NULL;
    MT_TRY(mt_files_give(files_of(opt), path, &given, err));
    mt_status rc = load_alone(path, opt, out, sha256, messages, err);
    if (rc == MT_OK && !given && has_folder(path, *out)) {
        rc = check_folder(path, sha256, *out, err);
        if (rc == MT_E_INPUT) {
            mt_result_delete(*out);
            *out = NULL;
            rc = load_locked(path, opt, out, messages, err);
        }
    }
    if (rc != MT_OK) {
        mt_result_delete(*out);
        *out = NULL;
    }
    return rc;
}
