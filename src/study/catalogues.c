/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Catalogues of parts, in the study or in a table beside it; and the variables that take their
 * rows. Rows are put in the order of their values, the first parameter first, so that a list of
 * neighbours is a list of similar parts; rows that agree in all columns that are used are one.
 */
#include "study/catalogues.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "io/file.h"
#include "study/check.h"
#include "study/reader.h"

enum { COLUMNS_MOST = 64, TABLE_MAX_BYTES = 1 << 24 };

/* Tables in files: a line of names with units, "D [mm]", then a line for each row. */

typedef struct csv {
    mt_study_reader *s;
    mt_catalogue *c;
    char *at;
    char *line_start;
    int line;
    char separator;
} csv;

typedef struct field {
    char *text; /* without blanks around it, and without its quotes */
    int line;
    int column;
} field;

static void refuse(csv *t, const field *f, const char *problem, const char *what)
{
    mt_diag_error(t->s->r.diags, t->c->file.addr, "%s: line %d, column %d: %s%s%.60s%s",
                  t->c->file.s, f->line, f->column, problem, what == NULL ? "" : " \"",
                  what == NULL ? "" : what, what == NULL ? "" : "\"");
    t->c->wrong = true;
}

static bool ends(const csv *t, char c)
{
    return c == '\0' || c == '\n' || c == '\r' || c == t->separator;
}

/* The next field of the line; *last: the line ends behind it. */
static field next_field(csv *t, bool *last)
{
    while (*t->at == ' ' || (*t->at == '\t' && t->separator != '\t')) {
        t->at++;
    }
    field f = {t->at, t->line, (int)(t->at - t->line_start) + 1};
    char *to = t->at;
    if (*t->at == '"') {
        for (t->at++; *t->at != '\0' && (*t->at != '"' || t->at[1] == '"'); t->at++) {
            t->at += *t->at == '"';
            *to++ = *t->at;
        }
        t->at += *t->at == '"';
        while (!ends(t, *t->at)) {
            t->at++;
        }
    } else {
        while (!ends(t, *t->at)) {
            t->at++;
        }
        to = t->at;
        while (to > f.text && (to[-1] == ' ' || to[-1] == '\t')) {
            to--;
        }
    }
    *last = *t->at != t->separator;
    const char ended = *t->at;
    t->at += ended != '\0';
    if (ended == '\r' && *t->at == '\n') {
        t->at++;
    }
    if (*last) {
        t->line++;
        t->line_start = t->at;
    }
    *to = '\0';
    return f;
}

/* Skip comments and empty lines; false: the end. */
static bool next_record(csv *t)
{
    for (;;) {
        const size_t blanks = strspn(t->at, " ");
        const char c = t->at[blanks];
        if (c == '\0') {
            return false;
        }
        if (c != '#' && c != '\n' && c != '\r') {
            return true;
        }
        t->at += strcspn(t->at, "\r\n");
        t->at += t->at[0] == '\r' && t->at[1] == '\n' ? 2 : *t->at != '\0';
        t->line++;
        t->line_start = t->at;
    }
}

/* Fields of the line, at most `most`, which the list has room for; returns their number. */
static int read_fields(csv *t, int most, field *out)
{
    int n = 0;
    for (bool last = false; !last; n++) {
        const field f = next_field(t, &last);
        if (n < most) {
            out[n] = f;
        }
    }
    return n;
}

static char separator_of(const char *line)
{
    static const char known[] = {',', ';', '\t'};
    int most = 0;
    int best = 0;
    for (int k = 0; k < MT_COUNT(known); k++) {
        int n = 0;
        for (const char *s = line; *s != '\0' && *s != '\n'; s++) {
            n += *s == known[k];
        }
        best = n > most ? k : best;
        most = n > most ? n : most;
    }
    return known[best];
}

/* "D [mm]" into name and unit; also "D (mm)", where that is a unit. */
static mt_name unit_of_header(char *text, mt_addr addr)
{
    const size_t length = strlen(text);
    const mt_name none = {.s = "", .addr = addr};
    const bool square = length > 0 && text[length - 1] == ']';
    if (!square && (length == 0 || text[length - 1] != ')')) {
        return none;
    }
    char *const open = square ? strrchr(text, '[') : strstr(text, " (");
    if (open == NULL) {
        return none;
    }
    char *const unit = square ? open + 1 : open + 2;
    mt_unit_worth worth;
    text[length - 1] = '\0';
    if (!square && !mt_unit_read(unit, MT_READ_MASSES, &worth)) {
        text[length - 1] = ')';
        return none;
    }
    *open = '\0';
    for (char *s = open; s > text && s[-1] == ' '; s--) {
        s[-1] = '\0';
    }
    return (mt_name){.s = unit, .addr = addr};
}

/* A number in a field; a comma is a point where it does not separate. */
static double field_number(csv *t, const field *f)
{
    double number = nan("");
    char *const comma = t->separator == ',' ? NULL : strchr(f->text, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    if (*f->text == '\0') {
        refuse(t, f, "no number is here", NULL);
    } else if (!mt_measuring_number(f->text, strlen(f->text), &number)) {
        refuse(t, f, "not a finite number:", f->text);
        number = nan("");
    }
    return number;
}

/* A column whose first field begins with a letter holds texts: materials, suppliers. */
static bool is_text(const field *f)
{
    const char first = *f->text;
    return (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z');
}

/* The line of names. *names_at: the column of the rows' names, -1: none. */
static int read_header(csv *t, field *fields, int *names_at)
{
    mt_catalogue *const c = t->c;
    const field start = {t->at, t->line, 1};
    const int n = read_fields(t, COLUMNS_MOST, fields);
    mt_arena *const mem = &t->s->study->mem;
    *names_at = -1;
    if (n > COLUMNS_MOST) {
        refuse(t, &start, "more than 64 columns", NULL);
        return 0;
    }
    mt_name *const columns = mt_arena_alloc(mem, (size_t)n, sizeof *columns);
    mt_name *const units = mt_arena_alloc(mem, (size_t)n, sizeof *units);
    for (int i = 0; i < n && columns != NULL && units != NULL; i++) {
        if (*names_at < 0 &&
            (strcmp(fields[i].text, "name") == 0 || strcmp(fields[i].text, "names") == 0)) {
            *names_at = i;
            continue;
        }
        if (*fields[i].text == '\0') {
            refuse(t, &fields[i], "a column without a name", NULL);
        }
        units[c->columns.count] = unit_of_header(fields[i].text, c->file.addr);
        columns[c->columns.count++] = (mt_name){.s = fields[i].text, .addr = c->file.addr};
    }
    c->columns.items = columns;
    c->units = (mt_name_list){.items = units, .count = c->columns.count};
    return n;
}

static void read_lines(csv *t, int lines)
{
    mt_catalogue *const c = t->c;
    mt_arena *const mem = &t->s->study->mem;
    field fields[COLUMNS_MOST];
    int names_at = -1;
    const int n = read_header(t, fields, &names_at);
    c->number = mt_arena_f64(mem, (size_t)c->columns.count, (size_t)lines);
    c->row = mt_arena_alloc(mem, (size_t)lines, sizeof *c->row);
    c->text = mt_arena_alloc(mem, (size_t)c->columns.count, sizeof *c->text);
    mt_name *const names = mt_arena_alloc(mem, (size_t)lines, sizeof *names);
    while (n > 0 && !mt_arena_failed(mem) && next_record(t)) {
        const field start = {t->at, t->line, 1};
        const int has = read_fields(t, COLUMNS_MOST, fields);
        if (c->n_rows == MT_MAX_CATALOGUE) {
            refuse(t, &start, "more than 10000 rows", NULL);
            return;
        }
        if (has != n) {
            refuse(t, &start, "not as many fields as the line of names has", NULL);
            continue;
        }
        for (int i = 0, k = 0; i < n; i++) {
            if (i == names_at) {
                names[c->n_rows] = (mt_name){.s = fields[i].text, .addr = c->file.addr};
                continue;
            }
            c->text[k] = c->n_rows == 0 ? is_text(&fields[i]) : c->text[k];
            c->number[((ptrdiff_t)c->n_rows * c->columns.count) + k] =
                c->text[k] ? nan("") : field_number(t, &fields[i]);
            k++;
        }
        c->row[c->n_rows++] = c->file.addr;
    }
    c->names = (mt_name_list){.items = names, .count = names_at < 0 ? 0 : c->n_rows};
}

static void read_table(mt_study_reader *s, mt_catalogue *c, const char *path)
{
    mt_file file = {0};
    mt_err why = {.code = MT_OK};
    const mt_status rc =
        mt_files_read(&s->files.files, path, s->files.root, TABLE_MAX_BYTES, &file, &why);
    if (rc != MT_OK) {
        mt_read_study_note_failure(s, c->file, path, rc, &why, false);
        c->wrong = true;
        return;
    }
    mt_read_study_note_input(s, c->file.s, file.sha256);
    char *const text = mt_arena_strndup(&s->study->mem, file.bytes, file.length);
    int lines = 1;
    for (size_t i = 0; i < file.length; i++) {
        lines += file.bytes[i] == '\n' || file.bytes[i] == '\r';
    }
    mt_file_free(&file);
    if (text == NULL) {
        return;
    }
    const bool mark = strncmp(text, "\xEF\xBB\xBF", 3) == 0;
    csv t = {.s = s, .c = c, .at = text + (mark ? 3 : 0), .line = 1};
    t.line_start = t.at;
    if (next_record(&t)) {
        t.separator = separator_of(t.at);
        read_lines(&t, lines);
    }
}

/* Tables in the study */

static void read_tolerances(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_catalogue *const c = item;
    (void)key;
    mt_items items = mt_reader_items(r, value);
    if (items.count != c->columns.count && c->file.s == NULL) {
        mt_diag_error(r->diags, value, "%d tolerances for %d columns", items.count,
                      c->columns.count);
        return;
    }
    c->tolerance_percent = mt_reader_room(r, &items, sizeof *c->tolerance_percent);
    for (int i = 0; mt_items_next(&items); i++) {
        const bool none = mt_json_type_of(r->doc, items.at) == MT_JSON_NULL;
        const double number =
            none ? nan("") : mt_read_study_number(mt_study_reader_of(r), items.at);
        c->tolerance_percent[i] = number;
        mt_reader_check_range(r, value, items.at, number);
    }
}

static void read_row(mt_reader *r, mt_catalogue *c, mt_addr value)
{
    mt_items numbers = mt_reader_items(r, value);
    if (!mt_reader_type(r, value, MT_KEY_LIST)) {
        c->wrong = true;
        return;
    }
    bool sound = true;
    for (mt_items each = numbers; mt_items_next(&each);) {
        sound = mt_reader_type(r, each.at, MT_KEY_VALUE) && sound;
    }
    if (!sound) {
        c->wrong = true;
        return;
    }
    if (numbers.count != c->columns.count) {
        mt_diag_error(r->diags, value, "%d number%s in this row, and %d columns", numbers.count,
                      numbers.count == 1 ? "" : "s", c->columns.count);
        c->wrong = true;
        return;
    }
    double *const out = c->number + ((ptrdiff_t)c->n_rows * c->columns.count);
    for (int k = 0; mt_items_next(&numbers); k++) {
        out[k] = mt_json_number(r->doc, numbers.at);
    }
    c->row[c->n_rows++] = value;
}

static void read_rows(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_catalogue *const c = item;
    mt_items items = mt_reader_some_items(r, value, "the list of rows");
    const size_t n = (size_t)items.count;
    (void)key;
    if (items.count > MT_MAX_CATALOGUE) {
        mt_diag_error(r->diags, value, "more than %d rows", MT_MAX_CATALOGUE);
        c->wrong = true;
        return;
    }
    c->number = mt_arena_f64(r->mem, (size_t)c->columns.count, n);
    c->row = mt_arena_alloc(r->mem, n, sizeof *c->row);
    while (!mt_arena_failed(r->mem) && mt_items_next(&items)) {
        read_row(r, c, items.at);
    }
}

/* The first item that an earlier one equals, noted. */
static void check_distinct(mt_reader *r, mt_catalogue *c, const mt_name_list *list,
                           const char *what)
{
    for (int i = 1; i < list->count; i++) {
        for (int k = 0; k < i; k++) {
            const char *const a = list->items[i].s;
            const char *const b = list->items[k].s;
            if (a != NULL && b != NULL && *a != '\0' && strcmp(a, b) == 0) {
                mt_diag_error(r->diags, list->items[i].addr, "two %s are called \"%s\"", what,
                              a);
                c->wrong = true;
                return;
            }
        }
    }
}

static void check_units(mt_reader *r, mt_catalogue *c)
{
    for (int i = 0; i < c->units.count; i++) {
        mt_unit_worth worth;
        const mt_name unit = c->units.items[i];
        if (unit.s != NULL && *unit.s != '\0' && strcmp(unit.s, "1") != 0 &&
            !mt_unit_read(unit.s, MT_READ_MASSES, &worth)) {
            mt_diag_error(r->diags, unit.addr, "unknown unit \"%s\" of column \"%s\"", unit.s,
                          i < c->columns.count ? c->columns.items[i].s : "");
            c->wrong = true;
        }
    }
}

static void check_counts(mt_reader *r, mt_catalogue *c)
{
    if (c->units.count > 0 && c->units.count != c->columns.count) {
        mt_diag_error(r->diags, c->units.items[0].addr, "%d units for %d columns",
                      c->units.count, c->columns.count);
        c->wrong = true;
    }
    if (c->names.count > 0 && c->names.count != c->n_rows && !c->wrong) {
        mt_diag_error(r->diags, c->names.items[0].addr, "%d names for %d rows", c->names.count,
                      c->n_rows);
        c->wrong = true;
    }
    if (c->columns.count == 0 || c->n_rows == 0) {
        if (!c->wrong) {
            mt_diag_error(r->diags, c->file.s == NULL ? c->addr : c->file.addr,
                          "the catalogue has no %s",
                          c->columns.count == 0 ? "columns" : "rows");
        }
        c->wrong = true;
    }
}

/* Rows that are the same in every column; both are given by their number from 1. */
static void check_rows_differ(mt_reader *r, mt_catalogue *c)
{
    const size_t size = (size_t)c->columns.count * sizeof *c->number;
    for (int i = 1; i < c->n_rows; i++) {
        for (int k = 0; k < i; k++) {
            if (memcmp(c->number + ((ptrdiff_t)i * c->columns.count),
                       c->number + ((ptrdiff_t)k * c->columns.count), size) == 0) {
                mt_diag_error(r->diags, c->row[i], "rows %d and %d are the same", k + 1, i + 1);
                c->wrong = true;
                return;
            }
        }
    }
}

static void catalogue_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_catalogue *const c = item;
    if (which == MT_ABSENT) {
        c->wrong = true;
        return;
    }
    if (c->file.s != NULL) {
        static const char *const others[] = {"rows", "names", "units"};
        for (int i = 0; i < MT_COUNT(others); i++) {
            if (mt_object_has(r, o, others[i])) {
                mt_diag_structure(r->diags, mt_object_place(r, o, others[i]),
                                  "\"%s\" goes with \"columns\"; a file has them itself",
                                  others[i]);
                c->wrong = true;
            }
        }
        char *const path = mt_file_join(mt_study_reader_of(r)->study->path, c->file.s);
        if (path == NULL) {
            mt_arena_fail(r->mem);
            return;
        }
        read_table(mt_study_reader_of(r), c, path);
        free(path);
    } else if (!mt_object_has(r, o, "rows")) {
        mt_diag_error(r->diags, c->addr, "\"rows\" is missing");
        c->wrong = true;
    }
    c->wrong = c->wrong || mt_object_wrong(r, o);
    check_counts(r, c);
    check_distinct(r, c, &c->columns, "columns");
    check_distinct(r, c, &c->names, "rows");
    check_units(r, c);
    if (!c->wrong) {
        check_rows_differ(r, c);
    }
}

static void catalogue_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_catalogue *)item = (mt_catalogue){.addr = addr};
}

#define THIS mt_catalogue
static const mt_key PARTS[] = {
    MT_M_REF("file", false, file,
             "Table of the parts (CSV), relative to this file: a line of the columns' names "
             "with their units, \"D [mm]\", then a line for each part; a column \"name\" has "
             "their names."),
    MT_M_REFS("columns", columns, "Names of the columns."),
    MT_M_REFS("units", units,
              "Units of the columns, one of each; \"\" or absent: the unit of the parameter.",
              .examples = "[[\"mm\", \"mm\", \"\"]]"),
    {.name = "rows",
     .type = MT_KEY_LIST,
     .read = read_rows,
     .possible = MT_POSSIBLE_VALUES,
     .says = "The parts that can be had: a number for each column. At most 10000.",
     .examples = "[[[40, 2, 12.5], [40, 3, 17.0]]]",
     .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"array\", "
               "\"items\": {\"type\": "
               "\"number\"}}"},
    MT_M_REFS("names", names, "Names of the rows, such as part numbers: one of each row.",
              .examples = "[[\"T40x2\", \"T40x3\"]]"),
    {.name = "tolerance_percent",
     .type = MT_KEY_LIST,
     .read = read_tolerances,
     .possible = MT_POSSIBLE_TOLERANCE,
     .says =
         "Manufacturing tolerances, one of each column, in percent of the value either way; "
         "null: none. As that of a variable.",
     .examples = "[[1, 5, null]]",
     .schema = "\"type\": \"array\", \"items\": {\"anyOf\": [{\"$ref\": "
               "\"#/definitions/number\"}, {\"type\": \"null\"}]}"},
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_parts_keys = {
    .what = "parts",
    .keys = PARTS,
    .n = MT_COUNT(PARTS),
    .one_of = 2,
    .size = sizeof(mt_catalogue),
    .defaults = catalogue_defaults,
    .finish = catalogue_finish,
    .says = "Parts that come with several numbers at once: a row is chosen whole.",
    .examples =
        "[{\"columns\": [\"D\", \"t\"], \"units\": [\"mm\", \"mm\"], \"rows\": [[40, 2], "
        "[40, 3], [50, 2]], \"names\": [\"T40x2\", \"T40x3\", \"T50x2\"]}, {\"file\": "
        "\"tubes.csv\"}]"};

mt_catalogue *mt_read_study_catalogues(mt_study_reader *s, mt_addr value, int *n)
{
    mt_items items = mt_reader_items(&s->r, value);
    mt_catalogue *const list = mt_reader_room(&s->r, &items, sizeof *list);
    while (mt_items_next(&items)) {
        const mt_name name = mt_reader_member_name(&s->r, items.at, MT_NAME_ITEM);
        mt_catalogue *const c = &list[*n];
        c->wrong = !mt_members_read(&s->r, items.at, &mt_study_parts_keys, c);
        c->name = name;
        (*n)++;
    }
    return list;
}

/* Variables that take rows */

/* The parameter that a column sets. */
typedef struct set_by {
    int column;
    mt_name parameter;
} set_by;

/* Number of a column in SI, as a value of the parameter; what: of its unit. */
static double in_si(const mt_study_check *c, const mt_catalogue *from, int column,
                    int parameter, double number)
{
    const char *const unit = from->units.count > 0 ? from->units.items[column].s : NULL;
    mt_unit_worth worth = {.factor = 1.0};
    if (unit == NULL || *unit == '\0') {
        return parameter == MT_ABSENT
                   ? number
                   : mt_unit_to_si(mt_study_unit(c->study, parameter), number);
    }
    const mt_unit *const known = mt_unit_find(unit);
    if (known != NULL) {
        return mt_unit_to_si(known, number);
    }
    (void)mt_unit_read(unit, MT_READ_MASSES, &worth);
    return number * worth.factor;
}

/* A unit that the column has and its parameter has not is noted. */
static bool units_agree(mt_study_check *c, const mt_catalogue *from, const set_by *one,
                        int parameter)
{
    const char *const unit = from->units.count > 0 ? from->units.items[one->column].s : NULL;
    const char *const own =
        parameter == MT_ABSENT ? NULL : c->model->parameters[parameter].unit;
    mt_unit_worth a = {.factor = 1.0};
    mt_unit_worth b = {.factor = 1.0};
    if (unit == NULL || *unit == '\0' || own == NULL) {
        return true;
    }
    const bool known = (strcmp(unit, "1") == 0 || mt_unit_read(unit, MT_READ_MASSES, &a)) &&
                       (strcmp(own, "1") == 0 || mt_unit_read(own, MT_READ_MASSES, &b));
    if (known && !mt_unit_same_powers(&a, &b, false)) {
        mt_diag_error(
            c->diags, one->parameter.addr, "column \"%s\" of \"%s\" is in %s, and \"%s\" in %s",
            from->columns.items[one->column].s, from->name.s, unit, one->parameter.s, own);
        return false;
    }
    return true;
}

static const mt_catalogue *find_catalogue(mt_study_check *c, mt_name name)
{
    const mt_study *const s = c->study;
    for (int i = 0; i < s->n_catalogues; i++) {
        if (s->catalogues[i].name.s != NULL && strcmp(s->catalogues[i].name.s, name.s) == 0) {
            return &s->catalogues[i];
        }
    }
    mt_check_unknown_name(c, name, "catalogue", s->catalogues, s->n_catalogues,
                          sizeof *s->catalogues);
    return NULL;
}

/* Columns and their parameters; returns their number, 0 where something is wrong (noted). */
static int map_columns(mt_study_check *c, const mt_variable *v, const mt_catalogue *from,
                       set_by *out)
{
    const int n = v->columns.count;
    if (n > MT_MAX_ROW_VARIABLES) {
        mt_diag_error(c->diags, v->addr, "a row sets at most %d parameters, not %d",
                      MT_MAX_ROW_VARIABLES, n);
        return 0;
    }
    if (v->by_order && n > from->columns.count) {
        mt_diag_error(c->diags, v->parameters.items[from->columns.count].addr,
                      "\"%s\" has %d column%s, not %d", from->name.s, from->columns.count,
                      from->columns.count == 1 ? "" : "s", n);
        return 0;
    }
    for (int i = 0; i < n; i++) {
        int column = v->by_order ? i : MT_ABSENT;
        for (int k = 0; k < from->columns.count && !v->by_order; k++) {
            column = strcmp(from->columns.items[k].s, v->columns.items[i].s) == 0 ? k : column;
        }
        if (column == MT_ABSENT) {
            mt_check_unknown_name(c, v->columns.items[i], "column", from->columns.items,
                                  from->columns.count, sizeof *from->columns.items);
            return 0;
        }
        if (from->text != NULL && from->text[column]) {
            mt_diag_error(c->diags, v->parameters.items[i].addr,
                          "column \"%s\" of \"%s\" holds texts, not numbers",
                          from->columns.items[column].s, from->name.s);
            return 0;
        }
        out[i] = (set_by){column, v->parameters.items[i]};
    }
    return n;
}

/* A row of a table while it is sorted. */
typedef struct sorted_row {
    const double *value; /* [n] */
    int n;
    int number; /* in the catalogue, from 0 */
} sorted_row;

static int by_values(const void *a, const void *b)
{
    const sorted_row *const x = a;
    const sorted_row *const y = b;
    for (int i = 0; i < x->n; i++) {
        if (x->value[i] != y->value[i]) {
            return x->value[i] < y->value[i] ? -1 : 1;
        }
    }
    return x->number < y->number ? -1 : x->number > y->number ? 1 : 0;
}

/* The rows of the mapped columns, in SI, sorted, each once. NULL: out of memory. */
static mt_catalogue_rows *sort_rows(mt_study_check *c, const mt_catalogue *from, int n,
                                    const set_by *map)
{
    mt_arena *const mem = &c->study->mem;
    const size_t n_rows = (size_t)from->n_rows;
    mt_catalogue_rows *const rows = mt_arena_alloc(mem, 1, sizeof *rows);
    double *const all = mt_arena_f64(mem, (size_t)n, n_rows);
    double *const value = mt_arena_f64(mem, (size_t)n, n_rows);
    sorted_row *const order = mt_arena_alloc(mem, n_rows, sizeof *order);
    int *const number = mt_arena_int(mem, n_rows);
    const char **const names = mt_arena_alloc(mem, n_rows, sizeof *names);
    if (mt_arena_failed(mem)) {
        return NULL;
    }
    for (int i = 0; i < from->n_rows; i++) {
        double *const row = all + ((ptrdiff_t)i * n);
        for (int k = 0; k < n; k++) {
            const int parameter = mt_model_find_parameter(c->model, map[k].parameter.s);
            row[k] = in_si(c, from, map[k].column, parameter,
                           from->number[((ptrdiff_t)i * from->columns.count) + map[k].column]);
        }
        order[i] = (sorted_row){row, n, i};
    }
    qsort(order, n_rows, sizeof *order, by_values);
    *rows = (mt_catalogue_rows){.catalogue = from->name.s,
                                .n = n,
                                .value = value,
                                .number = number,
                                .names = from->names.count > 0 ? names : NULL};
    for (int i = 0; i < from->n_rows; i++) {
        if (i > 0 &&
            memcmp(order[i].value, order[i - 1].value, (size_t)n * sizeof *value) == 0) {
            continue;
        }
        memcpy(value + ((ptrdiff_t)rows->n_rows * n), order[i].value,
               (size_t)n * sizeof *value);
        number[rows->n_rows] = order[i].number + 1;
        names[rows->n_rows] =
            from->names.count > 0 ? from->names.items[order[i].number].s : NULL;
        rows->n_rows++;
    }
    return rows;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The different values of a column, ascending. */
static void list_column(mt_arena *mem, const mt_catalogue_rows *rows, int column,
                        mt_variable *v)
{
    v->catalogue = mt_arena_f64(mem, (size_t)rows->n_rows, 1);
    v->n_catalogue = 0;
    if (v->catalogue == NULL) {
        return;
    }
    for (int i = 0; i < rows->n_rows; i++) {
        v->catalogue[i] = rows->value[((ptrdiff_t)i * rows->n) + column];
    }
    qsort(v->catalogue, (size_t)rows->n_rows, sizeof *v->catalogue, ascending);
    for (int i = 0; i < rows->n_rows; i++) {
        if (i == 0 || v->catalogue[i] > v->catalogue[v->n_catalogue - 1]) {
            v->catalogue[v->n_catalogue++] = v->catalogue[i];
        }
    }
}

/* The variables of v in out; returns their number. */
static int expand(mt_study_check *c, const mt_variable *v, mt_variable *out)
{
    const mt_catalogue *const from = find_catalogue(c, v->catalogue_name);
    mt_arena *const mem = &c->study->mem;
    set_by *const map = mt_arena_alloc(mem, (size_t)v->columns.count + 1, sizeof *map);
    if (from == NULL || from->wrong || map == NULL) {
        return 0;
    }
    const int n = map_columns(c, v, from, map);
    bool fits = n > 0;
    for (int k = 0; k < n; k++) {
        const int parameter = mt_model_find_parameter(c->model, map[k].parameter.s);
        fits = units_agree(c, from, &map[k], parameter) && fits;
    }
    if (from->tolerance_percent != NULL && MT_HAS(v->tolerance_percent)) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "tolerance_percent"),
                      "\"%s\" has tolerances of its own", from->name.s);
    }
    const mt_catalogue_rows *const rows = fits ? sort_rows(c, from, n, map) : NULL;
    if (rows == NULL) {
        return 0;
    }
    for (int k = 0; k < n; k++) {
        out[k] = *v;
        out[k].parameter_name = map[k].parameter;
        out[k].catalogue_name.s = NULL; /* it is settled */
        out[k].rows = rows;
        out[k].column = k;
        out[k].tolerance_percent = from->tolerance_percent != NULL
                                       ? from->tolerance_percent[map[k].column]
                                       : v->tolerance_percent;
        list_column(mem, rows, k, &out[k]);
    }
    return n;
}

void mt_study_check_rows(mt_study_check *c)
{
    mt_study *const s = c->study;
    int n = 0;
    int total = 0;
    for (int i = 0; i < s->n_variables; i++) {
        total += s->variables[i].catalogue_name.s == NULL ? 1 : s->variables[i].columns.count;
    }
    if (total == s->n_variables && s->n_catalogues == 0) {
        return;
    }
    mt_variable *const list = mt_arena_alloc(&s->mem, (size_t)total, sizeof *list);
    for (int i = 0; list != NULL && i < s->n_variables; i++) {
        if (s->variables[i].catalogue_name.s == NULL) {
            list[n++] = s->variables[i];
        } else {
            n += expand(c, &s->variables[i], list + n);
        }
    }
    if (list != NULL) {
        s->variables = list;
        s->n_variables = n;
        s->cap_variables = n;
    }
}
