/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured frequency responses: tables, of fields as RFC 4180 says and columns by their names;
 * universal files are read by read_uff.c. */
#include "measurement/read.h"

#include <math.h>
#include <string.h>

#include "base/sorted.h"
#include "base/text.h"
#include "io/file.h"
#include "measurement/read_uff.h"

#define COLUMN_LIST(X)                     \
    X(FREQUENCY, "frequency_hz")           \
    X(REAL, "real")                        \
    X(RE, "re") /* as `response` has it */ \
    X(IMAG, "imag")                        \
    X(IM, "im")                            \
    X(MAGNITUDE, "magnitude")              \
    X(PHASE, "phase_deg")                  \
    X(COHERENCE, "coherence")              \
    X(CONFIGURATION, "configuration")      \
    X(INPUT, "input")                      \
    X(OUTPUT, "output")                    \
    X(UNIT, "unit")
#define COLUMN_ENUM(id, name) id,
#define COLUMN_NAME(id, name) name,
enum { COLUMN_LIST(COLUMN_ENUM) COLUMN_COUNT, FIELDS_MOST = 200 };
static const char *const NAMES[COLUMN_COUNT] = {COLUMN_LIST(COLUMN_NAME)};

static const double RADIANS_PER_DEG = 3.14159265358979323846 / 180.0;

typedef struct field {
    char *text;
    int line;
    int column;
} field;

typedef struct table {
    mt_measuring *m;
    char separator;
    int n;                    /* fields of every line */
    int column[COLUMN_COUNT]; /* field of each, -1: none */
    int re;                   /* columns of real and imaginary part, or MAGNITUDE and PHASE */
    int im;
    field fields[FIELDS_MOST];
    mt_sorted responses; /* by their labels */
    int last;            /* the response of the line before; -1: none */
} table;

static bool ends_field(const table *t, const char *at)
{
    return at >= t->m->end || *at == t->separator || *at == '\n' || *at == '\r';
}

static void skip_blanks(const table *t)
{
    mt_measuring *const m = t->m;
    while (!ends_field(t, m->at) && (*m->at == ' ' || *m->at == '\t')) {
        m->at++;
    }
}

/* Read a quoted field from after its quote; its content moves to `to`, which ends at its
 * end. */
static mt_status read_quoted(const table *t, char **to)
{
    mt_measuring *const m = t->m;
    const int line = m->line;
    const int column = mt_measuring_column(m);
    m->at++;
    for (;;) {
        if (m->at >= m->end) {
            return mt_measuring_refuse(m, line, column, "a quote is opened and not closed");
        }
        char *const from = m->at;
        if (mt_measuring_newline(m)) {
            *(*to)++ = '\n';
        } else if (*from != '"') {
            *(*to)++ = *m->at++;
        } else if (from + 1 < m->end && from[1] == '"') {
            *(*to)++ = '"';
            m->at += 2;
        } else {
            m->at++;
            break;
        }
    }
    skip_blanks(t);
    return ends_field(t, m->at)
               ? MT_OK
               : mt_measuring_refuse(m, m->line, mt_measuring_column(m),
                                     "behind a closing quote comes neither a separator nor "
                                     "the end of the line");
}

static mt_status read_bare(const table *t, char **to)
{
    mt_measuring *const m = t->m;
    for (; !ends_field(t, m->at); m->at++) {
        if (*m->at == '"') {
            return mt_measuring_refuse(m, m->line, mt_measuring_column(m),
                                       "a quote in the midst of a field: quote all of it, and "
                                       "write the quote twice");
        }
    }
    *to = m->at;
    while (*to > m->start_of_line && ((*to)[-1] == ' ' || (*to)[-1] == '\t')) {
        (*to)--;
    }
    return MT_OK;
}

/* Read a field and skip its separator; *last: true at the end of the line. */
static mt_status read_field(const table *t, field *out, bool *last)
{
    mt_measuring *const m = t->m;
    skip_blanks(t);
    *out = (field){m->at, m->line, mt_measuring_column(m)};
    char *to = m->at;
    MT_TRY(*m->at == '"' && m->at < m->end ? read_quoted(t, &to) : read_bare(t, &to));
    to = to < out->text ? out->text : to; /* a field of blanks */
    *last = m->at >= m->end || *m->at != t->separator;
    if (!*last) {
        m->at++;
    } else {
        (void)mt_measuring_newline(m);
    }
    *to = '\0';
    return MT_OK;
}

/* Skip comments and empty lines; false: end of the text. */
static bool next_line(const table *t)
{
    mt_measuring *const m = t->m;
    while (m->at < m->end) {
        const char *s = m->at;
        while (s < m->end && (*s == ' ' || *s == '\t') && *s != t->separator) {
            s++;
        }
        if (s < m->end && *s != '#' && *s != '\n' && *s != '\r') {
            return true;
        }
        while (m->at < m->end && *m->at != '\n' && *m->at != '\r') {
            m->at++;
        }
        (void)mt_measuring_newline(m);
    }
    return false;
}

static mt_status read_record(table *t, int *n)
{
    bool last = false;
    *n = 0;
    while (!last) {
        if (*n == FIELDS_MOST) {
            return mt_measuring_refuse(t->m, t->m->line, mt_measuring_column(t->m),
                                       "more than %d columns", FIELDS_MOST);
        }
        MT_TRY(read_field(t, &t->fields[(*n)++], &last));
    }
    return MT_OK;
}

/* The separator: the candidate that is most frequent in the line of names, outside of
 * quotes. */
static char separator_of(const mt_measuring *m)
{
    static const char known[] = ",;\t";
    int count[sizeof known - 1] = {0};
    bool quoted = false;
    for (const char *s = m->at; s < m->end && *s != '\n' && *s != '\r'; s++) {
        const char *const at = strchr(known, *s);
        quoted = quoted != (*s == '"');
        if (!quoted && at != NULL && *at != '\0') {
            count[at - known]++;
        }
    }
    const int commas = count[0];
    return (char)(count[1] > commas ? ';' : count[2] > commas ? '\t' : ',');
}

static bool same_name(const char *a, const char *b)
{
    for (; *a != '\0' && *b != '\0'; a++, b++) {
        const char lower = (char)(*a >= 'A' && *a <= 'Z' ? *a - 'A' + 'a' : *a);
        if (lower != *b) {
            return false;
        }
    }
    return *a == *b;
}

static mt_status missing(table *t, int column, const char *what)
{
    const char *names[FIELDS_MOST];
    for (int i = 0; i < t->n; i++) {
        names[i] = t->fields[i].text;
    }
    const char *const near = mt_text_nearest(NAMES[column], names, t->n);
    const field *const first = &t->fields[0];
    return near == NULL
               ? mt_measuring_refuse(t->m, first->line, 1, "no column is called %s", what)
               : mt_measuring_refuse(t->m, first->line, 1,
                                     "no column is called %s; is it \"%s\"?", what, near);
}

static mt_status read_names(table *t)
{
    for (int c = 0; c < COLUMN_COUNT; c++) {
        t->column[c] = -1;
    }
    MT_TRY(read_record(t, &t->n));
    for (int i = 0; i < t->n; i++) {
        for (int c = 0; c < COLUMN_COUNT; c++) {
            if (!same_name(t->fields[i].text, NAMES[c])) {
                continue;
            }
            if (t->column[c] >= 0) {
                return mt_measuring_refuse(t->m, t->fields[i].line, t->fields[i].column,
                                           "column \"%s\" is there twice", NAMES[c]);
            }
            t->column[c] = i;
        }
    }
    t->re = t->column[REAL] >= 0 ? REAL : t->column[RE] >= 0 ? RE : MAGNITUDE;
    t->im = t->re == MAGNITUDE ? PHASE : t->column[IMAG] >= 0 ? IMAG : IM;
    if (t->column[FREQUENCY] < 0) {
        return missing(t, FREQUENCY, "\"frequency_hz\"");
    }
    if (t->column[t->re] < 0) {
        return missing(t, REAL,
                       "\"real\" (with \"imag\") or \"magnitude\" (with \"phase_deg\")");
    }
    return t->column[t->im] >= 0 ? MT_OK
           : t->im == PHASE ? missing(t, PHASE, "\"phase_deg\", which goes with \"magnitude\"")
                            : missing(t, IMAG, "\"imag\", which goes with \"real\"");
}

/* A number in a field; a comma is a point where it does not separate. */
static mt_status read_field_number(const table *t, int column, double *out)
{
    const field *const f = &t->fields[t->column[column]];
    char *const comma = t->separator == ',' ? NULL : strchr(f->text, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    if (mt_measuring_number(f->text, strlen(f->text), out)) {
        return MT_OK;
    }
    return *f->text == '\0' ? mt_measuring_refuse(t->m, f->line, f->column,
                                                  "\"%s\" has no value here", NAMES[column])
                            : mt_measuring_refuse(t->m, f->line, f->column,
                                                  "\"%s\" (%.40s) is not a finite number",
                                                  NAMES[column], f->text);
}

static mt_status read_line(const table *t, mt_measured_line *out)
{
    double a = 0.0;
    double b = 0.0;
    *out = (mt_measured_line){.coherence = nan(""), .line = t->fields[0].line};
    MT_TRY(read_field_number(t, FREQUENCY, &out->frequency_hz));
    MT_TRY(read_field_number(t, t->re, &a));
    MT_TRY(read_field_number(t, t->im, &b));
    const bool polar = t->re == MAGNITUDE;
    out->re = polar ? a * cos(b * RADIANS_PER_DEG) : a;
    out->im = polar ? a * sin(b * RADIANS_PER_DEG) : b;
    const field *const size = &t->fields[t->column[t->re]];
    if (polar && a < 0.0) {
        return mt_measuring_refuse(t->m, size->line, size->column,
                                   "a magnitude must not be below 0, as %.10g is", a);
    }
    if (t->column[COHERENCE] < 0) {
        return MT_OK;
    }
    MT_TRY(read_field_number(t, COHERENCE, &out->coherence));
    const field *const f = &t->fields[t->column[COHERENCE]];
    return out->coherence >= 0.0 && out->coherence <= 1.0
               ? MT_OK
               : mt_measuring_refuse(t->m, f->line, f->column,
                                     "a coherence is from 0 to 1, not %.10g", out->coherence);
}

static const char *label(const table *t, int column)
{
    const char *const s = t->column[column] < 0 ? "" : t->fields[t->column[column]].text;
    return *s == '\0' ? NULL : s;
}

static int compare_optional_texts(const char *a, const char *b)
{
    return strcmp(a == NULL ? "" : a, b == NULL ? "" : b);
}

/* The labels of the line, and those of response i. */
static int compare_labels(const void *context, const void *key, int i)
{
    const mt_measured_response *const r = &((const mt_measuring *)context)->out->responses[i];
    const table *const t = key;
    int order = compare_optional_texts(label(t, OUTPUT), r->output);
    order = order != 0 ? order : compare_optional_texts(label(t, INPUT), r->input);
    order =
        order != 0 ? order : compare_optional_texts(label(t, CONFIGURATION), r->configuration);
    return order != 0 ? order : compare_optional_texts(label(t, UNIT), r->unit);
}

static const char *copy_label(const table *t, int column)
{
    const char *const s = label(t, column);
    return s == NULL ? NULL : mt_arena_strdup(t->m->mem, s);
}

enum { RESPONSES_MOST = 10000 };

/* The response of the line, mostly that of the line before, else a new one. Fails: MT_E_INPUT
 * (too many). */
static mt_status response_of(table *t, mt_measured_response **out)
{
    mt_measuring *const m = t->m;
    const int last = t->last;
    t->last = last >= 0 && compare_labels(m, t, last) == 0
                  ? last
                  : mt_sorted_find(&t->responses, compare_labels, m, t);
    if (t->last >= 0) {
        *out = &m->out->responses[t->last];
        return MT_OK;
    }
    if (m->out->n_responses == RESPONSES_MOST) {
        return mt_measuring_refuse(m, t->fields[0].line, 1, "more than %d responses",
                                   RESPONSES_MOST);
    }
    t->last = t->responses.n;
    *out = mt_sorted_add(&t->responses, m->mem, compare_labels, m, t) ? mt_measuring_response(m)
                                                                      : NULL;
    if (*out != NULL) {
        (*out)->configuration = copy_label(t, CONFIGURATION);
        (*out)->input = copy_label(t, INPUT);
        (*out)->output = copy_label(t, OUTPUT);
        (*out)->unit = copy_label(t, UNIT);
    }
    return mt_arena_check(m->mem, m->err);
}

static mt_status read_csv(mt_measuring *m)
{
    static const char mark[] = "\xef\xbb\xbf"; /* of UTF-8 */
    table t = {.m = m, .last = -1};
    if (m->end - m->at >= 3 && memcmp(m->at, mark, 3) == 0) {
        m->at += 3;
        m->start_of_line = m->at;
    }
    if (!next_line(&t)) {
        return mt_measuring_refuse(m, m->line, 1, "the table is empty");
    }
    t.separator = separator_of(m);
    MT_TRY(read_names(&t));
    while (next_line(&t)) {
        mt_measured_line line;
        mt_measured_response *r = NULL;
        int n = 0;
        MT_TRY(read_record(&t, &n));
        if (n != t.n) {
            return mt_measuring_refuse(m, t.fields[0].line, 1,
                                       "%d fields, where the line of names has %d", n, t.n);
        }
        MT_TRY(read_line(&t, &line));
        MT_TRY(response_of(&t, &r));
        MT_TRY(mt_measuring_add(m, r, &line, t.fields[t.column[FREQUENCY]].column));
    }
    return m->out->n_responses > 0
               ? MT_OK
               : mt_measuring_refuse(m, m->line, 1, "the table has names, and no lines");
}

/* True where the text begins as a universal file, with a line "-1". */
static bool is_universal(const char *s)
{
    s += strspn(s, " \t\r\n");
    return s[0] == '-' && s[1] == '1' && strchr(" \t\r\n", s[2]) != NULL;
}

/* Any file; err is m's. */
static mt_status read_measurement_text(void *context, mt_err *err)
{
    mt_measuring *const m = context;
    m->err = err;
    m->begin = m->at;
    if (is_universal(m->at)) {
        return mt_read_measurement_uff(m);
    }
    const char *const nul = memchr(m->at, '\0', (size_t)(m->end - m->at));
    if (nul != NULL) {
        return mt_measuring_refuse(m, 1, 1,
                                   "this is not text: neither a table (CSV) nor a universal "
                                   "file, which begins with a line \"-1\"");
    }
    return read_csv(m);
}

mt_status mt_measurement_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                              mt_measurement *out, char *sha256, mt_diagnostics *messages,
                              mt_err *err)
{
    mt_file file = {0};
    const size_t limit =
        opt->max_bytes == 0 ? (size_t)MT_MEASUREMENT_MAX_BYTES : opt->max_bytes;
    mt_status rc = mt_files_read(&opt->files, path, opt->root, limit, &file, err);
    if (rc == MT_OK) {
        mt_measuring m = {.path = path,
                          .at = file.bytes,
                          .end = file.bytes + file.length,
                          .start_of_line = file.bytes,
                          .line = 1,
                          .mem = mem,
                          .out = out,
                          .messages = messages};
        memcpy(sha256, file.sha256, sizeof file.sha256);
        rc = mt_locale_plain(read_measurement_text, &m, err);
        rc = rc == MT_OK ? mt_arena_check(mem, err) : rc;
        out->read = rc == MT_OK;
        if (messages != NULL && messages->lines.failed) {
            rc = mt_fail_memory(err);
        }
    }
    mt_file_free(&file);
    return rc;
}
