/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/write_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/text.h"

enum { LONGEST_CHARACTER = 4 }; /* in bytes of UTF-8 */
/* Digits that identify a double, and those that a double keeps of any decimal number
 * (IEEE 754-2019, 5.12.2). */
enum { EXACT = 17, CERTAIN = 15 };

mt_json_writer mt_json_writer_default(mt_text *out)
{
    return (mt_json_writer){.out = out};
}

static const char *format_number(double value, int digits, char buffer[MT_JSON_NUMBER_SIZE])
{
    if (value == 0.0) { /* -0, too */
        return "0";
    }
    if (mt_decimal(value, digits, buffer) > 0) {
        return buffer;
    }
    if (isfinite(value)) {
        (void)mt_snprintf(buffer, MT_JSON_NUMBER_SIZE, "%.*g", digits, value);
    } else {
        memcpy(buffer, "null", sizeof "null");
    }
    return buffer;
}

/* The double that such a number is read as: its digits as a whole number, and the exponent that
 * goes with it, have no decimal point. */
static double read_back(const char *number)
{
    char plain[MT_JSON_NUMBER_SIZE + sizeof "e-2147483648"];
    const size_t mantissa = strcspn(number, "e");
    const char *const exponent = number[mantissa] == 'e' ? number + mantissa + 1 : "0";
    size_t n = 0;
    int behind = 0;
    bool pointed = false;
    for (size_t i = 0; i < mantissa; i++) {
        if (number[i] == '.') {
            pointed = true;
        } else {
            plain[n++] = number[i];
            behind += pointed ? 1 : 0;
        }
    }
    (void)mt_snprintf(plain + n, sizeof plain - n, "e%ld", strtol(exponent, NULL, 10) - behind);
    return strtod(plain, NULL);
}

const char *mt_json_format_number(double value, char buffer[MT_JSON_NUMBER_SIZE])
{
    return format_number(value, EXACT, buffer);
}

const char *mt_json_format_shortest(double value, char buffer[MT_JSON_NUMBER_SIZE])
{
    for (int digits = CERTAIN; digits < EXACT; digits++) {
        const char *const text = format_number(value, digits, buffer);
        if (!isfinite(value) || read_back(text) == value) {
            return text;
        }
    }
    return format_number(value, EXACT, buffer);
}

/* One character at s as JSON text; returns how many bytes of s it took. What cannot be seen is
 * escaped, too. */
static size_t put_character(mt_text *out, const char *s)
{
    static const char SHORT[] = "\"\"\\\\\bb\ff\nn\rr\tt"; /* character, letter of its escape */
    for (const char *pair = SHORT; *pair != '\0'; pair += 2) {
        if (*s == *pair) {
            mt_text_addf(out, "\\%c", pair[1]);
            return 1;
        }
    }
    const size_t left = strnlen(s, LONGEST_CHARACTER);
    const size_t n = mt_utf8_length(s, left);
    if (n == 0) {
        mt_text_add(out, "\xEF\xBF\xBD");
        return 1;
    }
    if (mt_visible_run(s, n, false) == 0) {
        char escape[MT_VISIBLE_SIZE];
        (void)mt_visible_escape(s, n, escape);
        mt_text_add(out, escape);
        return n;
    }
    mt_text_add_n(out, s, n);
    return n;
}

static bool is_plain(char c)
{
    return c >= ' ' && c < 0x7F && c != '"' && c != '\\';
}

/* A text of any length and characters. */
static void put_text(mt_text *out, const char *s)
{
    mt_text_add(out, "\"");
    while (*s != '\0') {
        size_t plain = 0;
        while (is_plain(s[plain])) {
            plain++;
        }
        mt_text_add_n(out, s, plain);
        s += plain;
        s += *s != '\0' ? put_character(out, s) : 0;
    }
    mt_text_add(out, "\"");
}

/* What comes next in the text, gathered to be added at once: comma, line, name and value. */
enum { SHORT_NAME = 48, HEAD = 2 * MT_JSON_WRITER_DEPTH + 2 * SHORT_NAME + 16 };
typedef struct head {
    char s[HEAD];
    size_t n;
} head;

static void append(head *h, const char *s, size_t n)
{
    memcpy(h->s + h->n, s, n);
    h->n += n;
}

static void flush(mt_json_writer *w, head *h)
{
    mt_text_add_n(w->out, h->s, h->n);
    h->n = 0;
}

static void append_text(mt_json_writer *w, head *h, const char *s)
{
    char *const quoted = h->s + h->n;
    size_t n = 0;
    quoted[0] = '"';
    while (n < SHORT_NAME - 2 && is_plain(s[n])) {
        quoted[n + 1] = s[n];
        n++;
    }
    if (s[n] == '\0') { /* as names are */
        quoted[n + 1] = '"';
        h->n += n + 2;
        return;
    }
    flush(w, h);
    put_text(w->out, s);
}

static void append_line(const mt_json_writer *w, head *h)
{
    const size_t indent = 2 * (size_t)w->depth;
    if (!w->tight) {
        h->s[h->n] = '\n';
        memset(h->s + h->n + 1, ' ', indent);
        h->n += 1 + indent;
    }
}

/* Comma, line and name before a value; false where the writer was misused. */
static bool begin_value(mt_json_writer *w, const char *name, head *h)
{
    const int level = w->depth - 1;
    const bool in_object = level >= 0 && w->close[level] == '}';
    const bool second_top = level < 0 && w->any[0];
    h->n = 0;
    if (w->misused || in_object != (name != NULL) || second_top) {
        w->misused = true;
        return false;
    }
    if (level < 0) {
        w->any[0] = true;
        return true;
    }
    if (w->any[level]) {
        append(h, ", ", w->flat[level] && !w->tight ? 2 : 1);
    }
    if (!w->flat[level]) {
        append_line(w, h);
    }
    w->any[level] = true;
    if (name != NULL) {
        append_text(w, h, name);
        append(h, ": ", w->tight ? 1 : 2);
    }
    return true;
}

static void open_level(mt_json_writer *w, const char *name, char bracket, bool flat)
{
    head h;
    const bool known = bracket == '{' || bracket == '[';
    if (!known || w->depth == MT_JSON_WRITER_DEPTH) {
        w->misused = true;
    }
    if (!begin_value(w, name, &h)) {
        return;
    }
    append(&h, &bracket, 1);
    flush(w, &h);
    const bool inherited = w->depth > 0 && w->flat[w->depth - 1];
    w->close[w->depth] = bracket == '{' ? '}' : ']';
    w->any[w->depth] = false;
    w->flat[w->depth] = flat || inherited;
    w->depth++;
}

void mt_json_open(mt_json_writer *w, const char *name, char bracket)
{
    open_level(w, name, bracket, false);
}

void mt_json_open_flat(mt_json_writer *w, const char *name, char bracket)
{
    open_level(w, name, bracket, true);
}

void mt_json_close(mt_json_writer *w)
{
    head h = {.n = 0};
    if (w->misused || w->depth == 0) {
        w->misused = true;
        return;
    }
    w->depth--;
    if (w->any[w->depth] && !w->flat[w->depth]) {
        append_line(w, &h);
    }
    append(&h, &w->close[w->depth], 1);
    flush(w, &h);
    w->any[w->depth == 0 ? 0 : w->depth - 1] = true;
}

/* value: no longer than a number. */
static void put_raw(mt_json_writer *w, const char *name, const char *value)
{
    head h;
    if (begin_value(w, name, &h)) {
        append(&h, value, strlen(value));
        flush(w, &h);
    }
}

void mt_json_put_number(mt_json_writer *w, const char *name, double value)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    put_raw(w, name, mt_json_format_number(value, buffer));
}

void mt_json_put_rounded(mt_json_writer *w, const char *name, double value, int digits)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    put_raw(w, name, format_number(value, digits, buffer));
}

void mt_json_put_integer(mt_json_writer *w, const char *name, long long value)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    (void)mt_snprintf(buffer, sizeof buffer, "%lld", value);
    put_raw(w, name, buffer);
}

void mt_json_put_bool(mt_json_writer *w, const char *name, bool value)
{
    put_raw(w, name, value ? "true" : "false");
}

void mt_json_put_string(mt_json_writer *w, const char *name, const char *value)
{
    head h;
    if (value == NULL) {
        put_raw(w, name, "null");
    } else if (begin_value(w, name, &h)) {
        append_text(w, &h, value);
        flush(w, &h);
    }
}

void mt_json_put_null(mt_json_writer *w, const char *name)
{
    put_raw(w, name, "null");
}

bool mt_json_done(mt_json_writer *w)
{
    if (w->depth != 0 || !w->any[0]) {
        w->misused = true;
    }
    if (!w->misused && !w->tight) {
        mt_text_add(w->out, "\n");
    }
    return !w->misused && !w->out->failed;
}
