/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables, and the numbers in them. */
#include "report/table.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/text.h"
#include "result/result.h"

/* Numbers. */

/* "2.10000e+11" says no more than "2.1e+11", and "100000." no more than "100000". */
static void trim(char *s)
{
    char *const exponent = strchr(s, 'e');
    char *end = exponent == NULL ? s + strlen(s) : exponent;
    const char *const from = end;
    while (exponent != NULL && end > s && end[-1] == '0') {
        end--;
    }
    if (end > s && end[-1] == '.') {
        end--;
    }
    memmove(end, from, strlen(from) + 1);
}

static const char *format(double x, int digits, bool sign, char *buffer)
{
    if (isnan(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "-");
    } else if (x == 0.0 || isinf(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "%g", x); /* 0, or the word */
    } else {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, sign ? "%+#.*g" : "%#.*g", digits, x);
        trim(buffer);
    }
    return buffer;
}

const char *mt_report_number(double x, int digits, char buffer[MT_NUMBER_TEXT])
{
    return format(x, digits, false, buffer);
}

const char *mt_report_change(double x, int digits, char buffer[MT_NUMBER_TEXT])
{
    return format(x, digits, true, buffer);
}

const char *mt_report_exact(double x, char buffer[MT_NUMBER_TEXT])
{
    if (isfinite(x)) {
        (void)mt_snprintf(buffer, MT_NUMBER_TEXT, "%.17g", x);
    } else {
        buffer[0] = '\0';
    }
    return buffer;
}

/* Tables. */

enum { INTEGER_TEXT = 24 };

mt_table mt_table_default(void)
{
    mt_table t = {.columns = NULL};
    t.failed = mt_arena_init(&t.mem, 0, NULL) != MT_OK;
    return t;
}

void mt_table_free(mt_table *t)
{
    mt_arena_free(&t->mem);
    memset(t, 0, sizeof *t);
}

static const char *copy(mt_table *t, const char *s)
{
    const char *const kept = t->failed ? NULL : mt_arena_strdup(&t->mem, s);
    t->failed = t->failed || kept == NULL;
    return kept;
}

/* A text for people, in one line. */
static const char *copy_visible(mt_table *t, const char *s)
{
    const char *const kept = t->failed ? NULL : mt_arena_printf(&t->mem, "%s", s);
    t->failed = t->failed || kept == NULL;
    return kept;
}

void mt_table_column(mt_table *t, const char *heading, const char *member, mt_align align)
{
    const mt_column column = {copy_visible(t, heading), copy(t, member), align};
    if (t->failed) {
        return;
    }
    mt_column *const grown =
        mt_arena_grow(&t->mem, t->columns, t->n_columns, &t->cap_columns, sizeof *grown);
    if (grown == NULL) {
        t->failed = true;
        return;
    }
    t->columns = grown;
    t->columns[t->n_columns++] = column;
}

void mt_table_cell(mt_table *t, const char *text, const char *exact)
{
    const mt_cell cell = {copy_visible(t, text), copy(t, exact), NULL};
    if (t->failed) {
        return;
    }
    mt_cell *const grown =
        mt_arena_grow(&t->mem, t->cells, t->n_cells, &t->cap_cells, sizeof *grown);
    if (grown == NULL) {
        t->failed = true;
        return;
    }
    t->cells = grown;
    t->cells[t->n_cells++] = cell;
}

void mt_table_text(mt_table *t, const char *text)
{
    mt_table_cell(t, text == NULL ? "-" : text, text == NULL ? "" : text);
}

void mt_table_integer(mt_table *t, long long value)
{
    char s[INTEGER_TEXT];
    (void)mt_snprintf(s, sizeof s, "%lld", value);
    mt_table_cell(t, s, s);
}

void mt_table_shown(mt_table *t, double value, double factor, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    mt_table_cell(t, mt_report_number(mt_result_shown(value, factor), digits, text),
                  mt_report_exact(value, exact));
}

void mt_table_number(mt_table *t, double value, int digits)
{
    mt_table_shown(t, value, 1.0, digits);
}

void mt_table_unit(mt_table *t, const char *unit, const char *display_unit)
{
    const char *const shown = display_unit != NULL ? display_unit : unit;
    mt_table_cell(t, shown == NULL ? "-" : shown, unit == NULL ? "" : unit);
}

void mt_table_change(mt_table *t, double value, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    mt_table_cell(t, mt_report_change(value, digits, text), mt_report_exact(value, exact));
}

void mt_table_percent(mt_table *t, double value, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const double shown = mt_without_noise(value, MT_PERCENT_NOISE);
    mt_table_cell(t, mt_report_change(shown, digits, text), mt_report_exact(value, exact));
}

void mt_table_ratio(mt_table *t, double value, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const double shown = mt_without_noise(value, MT_RATIO_NOISE);
    mt_table_cell(t, mt_report_number(shown, digits, text), mt_report_exact(value, exact));
}

int mt_table_rows(const mt_table *t)
{
    return t->n_columns == 0 ? 0 : t->n_cells / t->n_columns;
}

/* Records. */

/* The member that a column shows. A column without one is a bug of its table. */
static const mt_field *field_of(const mt_record_table *of, const mt_record_column *c)
{
    const mt_record *const record = of->record;
    int i = 0;
    while (i < record->n - 1 && record->fields[i].offset != c->offset) {
        i++;
    }
    assert(record->fields[i].offset == c->offset);
    return &record->fields[i];
}

/* Texts stand at the left, counts at the right, numbers by their points. */
static mt_align align_of(const mt_field *f)
{
    switch (f->type) {
    case MT_FIELD_COUNT:
    case MT_FIELD_LONG:
        return MT_ALIGN_RIGHT;
    case MT_FIELD_NUMBER:
    case MT_FIELD_VALUE:
    case MT_FIELD_NUMBERS:
        return MT_ALIGN_POINT;
    case MT_FIELD_FORMAT:
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
    case MT_FIELD_ENUM:
    case MT_FIELD_FLAG:
    case MT_FIELD_RECORD:
    case MT_FIELD_OPTION:
    case MT_FIELD_LIST:
    case MT_FIELD_TEXTS:
    case MT_FIELD_BY_VARIABLE:
    case MT_FIELD_TYPE_COUNT:
        break;
    }
    return MT_ALIGN_LEFT;
}

/* What machines call a column. */
static const char *member_of(const mt_record_column *c, const mt_field *f)
{
    return c->member != NULL ? c->member : f->name != NULL ? f->name : c->heading;
}

void mt_table_record_columns(mt_table *t, const mt_record_table *of, unsigned in)
{
    for (int k = 0; k < of->n; k++) {
        const mt_record_column *const c = &of->columns[k];
        const mt_field *const f = field_of(of, c);
        if ((c->in & in) != 0U) {
            mt_table_column(t, c->heading, member_of(c, f),
                            c->right ? MT_ALIGN_RIGHT : align_of(f));
        }
    }
}

static void add_number(mt_table *t, const mt_record_column *c, double value)
{
    if (c->with_sign) {
        mt_table_change(t, value, c->digits);
    } else {
        mt_table_number(t, value, c->digits);
    }
}

/* A count below its least is none. */
static void add_count(mt_table *t, const mt_field *f, int value)
{
    if (f->nullable && value < f->least) {
        mt_table_text(t, NULL);
    } else {
        mt_table_integer(t, value);
    }
}

static void add_cell(mt_table *t, const mt_record_column *c, const mt_field *f,
                     const void *item, int i)
{
    const void *const at = (const char *)item + f->offset;
    const double *numbers = NULL;
    const char *word = NULL;
    switch (f->type) {
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
        mt_table_text(t, mt_record_get_pointer(at));
        return;
    case MT_FIELD_NUMBER:
        add_number(t, c, *(const double *)at);
        return;
    case MT_FIELD_VALUE:
        word = mt_record_get_pointer((const char *)item + f->other);
        if (word != NULL) {
            mt_table_text(t, word);
        } else {
            add_number(t, c, *(const double *)at);
        }
        return;
    case MT_FIELD_NUMBERS:
        numbers = mt_record_get_pointer(at);
        add_number(t, c, numbers[i]);
        return;
    case MT_FIELD_COUNT:
        add_count(t, f, *(const int *)at);
        return;
    case MT_FIELD_LONG:
        mt_table_integer(t, *(const long *)at);
        return;
    case MT_FIELD_FLAG:
        mt_table_text(t, *(const bool *)at ? "true" : "false");
        return;
    case MT_FIELD_FORMAT:
    case MT_FIELD_ENUM:
    case MT_FIELD_RECORD:
    case MT_FIELD_OPTION:
    case MT_FIELD_LIST:
    case MT_FIELD_TEXTS:
    case MT_FIELD_BY_VARIABLE:
    case MT_FIELD_TYPE_COUNT:
        break;
    }
    t->failed = true; /* no cell holds these: no table has them */
}

void mt_table_record_nth(mt_table *t, const mt_record_table *of, unsigned in, const void *item,
                         int i)
{
    for (int k = 0; k < of->n; k++) {
        const mt_record_column *const c = &of->columns[k];
        if ((c->in & in) != 0U) {
            add_cell(t, c, field_of(of, c), item, i);
        }
    }
}

void mt_table_record_row(mt_table *t, const mt_record_table *of, unsigned in, const void *item)
{
    mt_table_record_nth(t, of, in, item, 0);
}

/* A number as this program and others write it: [+-] digits [. digits] [e [+-] digits]. */
static bool is_number(const char *s)
{
    static const char digits[] = "0123456789";
    s += *s == '-' || *s == '+' ? 1 : 0;
    const size_t whole = strspn(s, digits);
    s += whole;
    const size_t point = *s == '.' ? 1 : 0;
    const size_t part = strspn(s + point, digits);
    s += point == 1 ? point + part : 0;
    if (whole + (point == 1 ? part : 0) > 0 && (*s == 'e' || *s == 'E')) {
        s += s[1] == '-' || s[1] == '+' ? 2 : 1;
        const size_t exponent = strspn(s, digits);
        return exponent > 0 && s[exponent] == '\0';
    }
    return whole + part > 0 && *s == '\0';
}

/*
 * True for a cell that spreadsheets take for a formula: all do where it begins with = + - @
 * (tabs and line ends are escaped before), some with their full-width forms, some after blanks.
 * A cell with an apostrophe there counts, too, so that removing one always restores the text.
 */
static bool is_formula(const char *s)
{
    static const char *const wide[] = {"\xEF\xBC\x9D", "\xEF\xBC\x8B", "\xEF\xBC\x8D",
                                       "\xEF\xBC\xA0"}; /* U+FF1D, FF0B, FF0D, FF20 */
    const char *const at = s + strspn(s, " '");
    bool starts = *at != '\0' && strchr("=+-@", *at) != NULL;
    for (int i = 0; i < MT_COUNT(wide); i++) {
        starts = starts || strncmp(at, wide[i], strlen(wide[i])) == 0;
    }
    return starts && !is_number(s);
}

void mt_csv_field(const char *s, mt_text *out)
{
    mt_text shown = {.s = NULL};
    mt_text_add(&shown, is_formula(s) ? "'" : "");
    mt_text_add_visible(&shown, s);
    out->failed = out->failed || shown.failed;
    if (out->failed || strpbrk(shown.s, ",\"") == NULL) {
        mt_text_add(out, shown.failed ? "" : shown.s);
    } else {
        mt_text_add(out, "\"");
        for (const char *at = shown.s; *at != '\0'; at++) {
            mt_text_add_n(out, *at == '"' ? "\"\"" : at, *at == '"' ? 2 : 1);
        }
        mt_text_add(out, "\"");
    }
    mt_text_free(&shown);
}

void mt_table_csv(const mt_table *t, mt_text *out)
{
    const int n = t->n_columns;
    out->failed = out->failed || t->failed;
    for (int c = 0; !t->failed && c < n; c++) {
        mt_csv_field(t->columns[c].member, out);
        mt_text_add(out, c == n - 1 ? "\r\n" : ",");
    }
    for (int i = 0; !t->failed && i < t->n_cells; i++) {
        mt_csv_field(t->cells[i].exact, out);
        mt_text_add(out, i % n == n - 1 ? "\r\n" : ",");
    }
}

void mt_html_escape(const char *s, mt_text *out)
{
    static const char special[] = "&<>\"'";
    static const char *const reference[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    size_t plain = 0;
    while (s[plain] >= ' ' && s[plain] <= '~' && s[plain] != '&' && s[plain] != '<' &&
           s[plain] != '>' && s[plain] != '"' && s[plain] != '\'') {
        plain++;
    }
    mt_text_add_n(out, s, plain); /* often all of it */
    s += plain;
    size_t left = strlen(s);
    while (left > 0) {
        const char *const found = strchr(special, *s);
        const bool blank = *s == '\n';
        size_t used = found != NULL || blank ? 1 : mt_visible_run(s, left, false);
        if (found != NULL) {
            mt_text_add(out, reference[found - special]);
        } else if (used == 0) {
            char escape[MT_VISIBLE_SIZE];
            used = mt_visible_escape(s, left, escape);
            mt_text_add(out, escape);
        } else {
            plain = strcspn(s, special);
            used = blank || used < plain ? used : plain;
            mt_text_add_n(out, s, used);
        }
        s += used;
        left -= used;
    }
}

/* mark: a class of the cell's own; NULL */
static void html_cell(const char *tag, mt_align align, const char *mark, const char *text,
                      mt_text *out)
{
    const char *const class = mark != NULL ? mark : align != MT_ALIGN_LEFT ? "n" : NULL;
    mt_text_add(out, "<");
    mt_text_add(out, tag);
    if (class != NULL) {
        mt_text_add(out, " class=\"");
        mt_text_add(out, class);
        mt_text_add(out, "\"");
    }
    mt_text_add(out, ">");
    mt_html_escape(text, out);
    mt_text_add(out, "</");
    mt_text_add(out, tag);
    mt_text_add(out, ">");
}

void mt_table_html(const mt_table *t, mt_text *out)
{
    const int n = t->n_columns;
    out->failed = out->failed || t->failed;
    mt_text_add(out, "<table>\n<thead><tr>");
    for (int c = 0; !t->failed && c < n; c++) {
        html_cell("th", t->columns[c].align, NULL, t->columns[c].heading, out);
    }
    mt_text_add(out, "</tr></thead>\n<tbody>\n");
    for (int i = 0; !t->failed && i < t->n_cells; i++) {
        mt_text_add(out, i % n == 0 ? "<tr>" : "");
        html_cell("td", t->columns[i % n].align, t->cells[i].mark, t->cells[i].text, out);
        mt_text_add(out, i % n == n - 1 ? "</tr>\n" : "");
    }
    mt_text_add(out, "</tbody>\n</table>\n");
}

/* A table as aligned text: columns that hold nothing are left out, and what a terminal has no
 * room for is told below, under the same first columns. */

enum { GAP = 2, MOST_KEYS = 2 };

/* Columns up to the decimal point, or where it would stand. */
static int before_point(const char *s)
{
    return mt_text_width(s) - mt_text_width(s + strcspn(s, ".e"));
}

typedef struct layout {
    int width;  /* of the column */
    int before; /* MT_ALIGN_POINT: widest part before the point */
} layout;

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static layout measure_column(const mt_table *t, int column)
{
    layout l = {0, 0};
    int after = 0;
    const bool point = t->columns[column].align == MT_ALIGN_POINT;
    for (int i = column; i < t->n_cells; i += t->n_columns) {
        const char *const s = t->cells[i].text;
        if (point) {
            l.before = larger(l.before, before_point(s));
            after = larger(after, mt_text_width(s) - before_point(s));
        } else {
            l.width = larger(l.width, mt_text_width(s));
        }
    }
    l.width = larger(l.width, l.before + after);
    const int heading = mt_text_width(t->columns[column].heading);
    if (point && heading > l.width) {
        l.before += heading - l.width; /* numbers stand at the right end of a wider heading */
    }
    l.width = larger(l.width, heading);
    return l;
}

static void pad(mt_text *out, int n)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

static void print_cell(mt_align align, const layout *l, const char *s, bool last, mt_text *out)
{
    const int width = mt_text_width(s);
    int before = align == MT_ALIGN_LEFT ? 0 : l->width - width;
    if (align == MT_ALIGN_POINT) {
        before = l->before - before_point(s);
    }
    pad(out, before);
    mt_text_add(out, s);
    pad(out, last ? 0 : l->width - width - before);
}

/* Trailing blanks of the line just written. */
static void end_line(mt_text *out)
{
    while (!out->failed && out->length > 0 && out->s[out->length - 1] == ' ') {
        out->s[--out->length] = '\0';
    }
    mt_text_add(out, "\n");
}

/* The columns that one block of lines shows. */
typedef struct block {
    int n;
    const int *columns;
} block;

static void print_block(const mt_table *t, const layout *l, const block *b, int indent,
                        mt_text *out)
{
    pad(out, indent);
    for (int k = 0; k < b->n; k++) {
        const int c = b->columns[k];
        const mt_align align =
            t->columns[c].align == MT_ALIGN_LEFT ? MT_ALIGN_LEFT : MT_ALIGN_RIGHT;
        print_cell(align, &l[c], t->columns[c].heading, k == b->n - 1, out);
        pad(out, k == b->n - 1 ? 0 : GAP);
    }
    end_line(out);
    pad(out, indent);
    for (int k = 0; k < b->n; k++) {
        for (int i = 0; i < l[b->columns[k]].width; i++) {
            mt_text_add(out, "-");
        }
        pad(out, k == b->n - 1 ? 0 : GAP);
    }
    end_line(out);
    for (int row = 0; row < t->n_cells; row += t->n_columns) {
        pad(out, indent);
        for (int k = 0; k < b->n; k++) {
            const int c = b->columns[k];
            print_cell(t->columns[c].align, &l[c], t->cells[row + c].text, k == b->n - 1, out);
            pad(out, k == b->n - 1 ? 0 : GAP);
        }
        end_line(out);
    }
}

static bool is_empty(const mt_table *t, int column)
{
    for (int i = column; i < t->n_cells; i += t->n_columns) {
        const char *const s = t->cells[i].text;
        if (s[0] != '\0' && strcmp(s, "-") != 0) {
            return false;
        }
    }
    return t->n_cells > 0;
}

/* The first columns that tell rows apart, which every block repeats: texts and counts, as long
 * as they leave half of the width. */
static int key_columns(const mt_table *t, const layout *l, int n, const int *kept, int room)
{
    int keys = 1;
    int used = l[kept[0]].width;
    while (keys < n && keys < MOST_KEYS && t->columns[kept[keys]].align != MT_ALIGN_POINT &&
           2 * (used + GAP + l[kept[keys]].width) <= room) {
        used += GAP + l[kept[keys++]].width;
    }
    return keys;
}

/* Blocks of as many columns as fit into the width, at least one besides those repeated. */
static void print_folded(const mt_table *t, const layout *l, int n, const int *kept, int *shown,
                         int indent, int width, mt_text *out)
{
    const int keys = key_columns(t, l, n, kept, width - indent);
    int used = indent;
    for (int k = 0; k < keys; k++) {
        shown[k] = kept[k];
        used += l[kept[k]].width + (k > 0 ? GAP : 0);
    }
    for (int next = keys; next < n || next == keys;) {
        int m = keys;
        int line = used;
        while (next < n && (m == keys || line + GAP + l[kept[next]].width <= width)) {
            line += GAP + l[kept[next]].width;
            shown[m++] = kept[next++];
        }
        print_block(t, l, &(block){m, shown}, indent, out);
        if (next >= n) {
            return;
        }
        mt_text_add(out, "\n");
    }
}

static int whole_width(const layout *l, int n, const int *kept, int indent)
{
    int width = indent;
    for (int k = 0; k < n; k++) {
        width += l[kept[k]].width + (k > 0 ? GAP : 0);
    }
    return width;
}

void mt_table_print(const mt_table *t, int indent, int width, mt_text *out)
{
    mt_arena scratch = {.first = NULL};
    const size_t n = (size_t)t->n_columns;
    layout *l = NULL;
    int *kept = NULL;
    if (!t->failed && mt_arena_init(&scratch, 0, NULL) == MT_OK) {
        l = mt_arena_alloc(&scratch, n, sizeof *l);
        kept = mt_arena_int(&scratch, 2 * n);
    }
    if (l == NULL || kept == NULL) {
        out->failed = true;
    } else if (n > 0) {
        int m = 0;
        for (int c = 0; c < t->n_columns; c++) {
            l[c] = measure_column(t, c);
            if (c == 0 || !is_empty(t, c)) {
                kept[m++] = c;
            }
        }
        if (width <= 0 || whole_width(l, m, kept, indent) <= width) {
            print_block(t, l, &(block){m, kept}, indent, out);
        } else {
            print_folded(t, l, m, kept, kept + n, indent, width, out);
        }
    }
    mt_arena_free(&scratch);
}
