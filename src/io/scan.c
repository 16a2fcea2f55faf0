/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The strict scanner: one pass over the bytes by recursive descent (nesting is limited), RFC
 * 8259 exactly. A problem inside a token, a missing or superfluous comma and a comment are
 * noted and the scan goes on; where the structure is lost it ends.
 */
#include "io/scan.h"

#include <limits.h>
#include <stdarg.h>
#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "io/json.h"
#include "io/universal.h"

enum {
    MESSAGE_SIZE = 256,
    WORD_SHOWN = 40, /* bytes of an unexpected word that a message shows */
    MAX_SYNTAX_ERRORS = 50
};

typedef struct scan {
    const char *s;
    size_t n;
    size_t i;   /* next byte */
    int parent; /* container that we are in */
    int depth;
    mt_json_spots *out;
    mt_diags *diags;
} scan;

/* Its address; MT_NO_ADDR where memory is out, which the arena remembers. */
static mt_addr add_spot(scan *sc, mt_json_spot spot)
{
    mt_json_spots *const out = sc->out;
    mt_json_spot *const items =
        mt_arena_grow(sc->diags->mem, out->items, out->n, &out->capacity, sizeof *items);
    if (items == NULL) {
        return MT_NO_ADDR;
    }
    out->items = items;
    items[out->n] = spot;
    return out->n++;
}

/* Note a problem; true where the scan may go on. */
static bool MT_PRINTF(3, 4) wrong(scan *sc, size_t at, const char *fmt, ...)
{
    char text[MESSAGE_SIZE];
    va_list args;
    va_start(args, fmt);
    (void)mt_vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const mt_addr spot = add_spot(
        sc, (mt_json_spot){.start = (unsigned)at, .parent = sc->parent, .mistake = true});
    mt_diag_error(sc->diags, spot, "%s", text);
    return sc->diags->errors < MAX_SYNTAX_ERRORS && spot != MT_NO_ADDR;
}

static int peek(const scan *sc)
{
    return sc->i < sc->n ? (unsigned char)sc->s[sc->i] : -1;
}

/* Skip a comment, which JSON has not. */
static bool skip_comment(scan *sc)
{
    const size_t at = sc->i;
    const bool block = sc->s[at + 1] == '*';
    sc->i += 2;
    while (sc->i < sc->n) {
        const char c = sc->s[sc->i];
        if (block ? c == '*' && sc->i + 1 < sc->n && sc->s[sc->i + 1] == '/' : c == '\n') {
            sc->i += block ? 2 : 1;
            break;
        }
        sc->i++;
    }
    return wrong(sc, at, "comments are not allowed in JSON; use \"description\" or \"source\"");
}

static bool skip_space(scan *sc)
{
    for (;;) {
        const int c = peek(sc);
        if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
            sc->i++;
        } else if (c == '/' && sc->i + 1 < sc->n &&
                   (sc->s[sc->i + 1] == '/' || sc->s[sc->i + 1] == '*')) {
            if (!skip_comment(sc)) {
                return false;
            }
        } else {
            return true;
        }
    }
}

/* The four hexadecimal digits at offset at; -1 where they are not. */
static int hex4(const scan *sc, size_t at)
{
    if (at > sc->n || sc->n - at < 4) {
        return -1;
    }
    int value = 0;
    for (size_t k = 0; k < 4; k++) {
        const char c = sc->s[at + k];
        const int digit = c >= '0' && c <= '9'   ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (digit < 0) {
            return -1;
        }
        value = 16 * value + digit;
    }
    return value;
}

/* \uXXXX at sc->i (on the backslash); surrogates must come as a pair. */
static bool scan_unicode_escape(scan *sc)
{
    enum { HIGH = 0xD800, LOW = 0xDC00, AFTER = 0xE000, LENGTH = 6 };
    const size_t at = sc->i;
    const int code = hex4(sc, at + 2);
    sc->i += 2;
    if (code < 0) {
        return wrong(sc, at, "\\u must be followed by four hexadecimal digits");
    }
    sc->i = at + LENGTH;
    if (code == 0) {
        return wrong(sc, at, "the character U+0000 is not allowed in strings");
    }
    if (code < HIGH || code >= AFTER) {
        return true;
    }
    const bool escape_follows =
        sc->n - sc->i >= 2 && sc->s[sc->i] == '\\' && sc->s[sc->i + 1] == 'u';
    const int second = escape_follows ? hex4(sc, sc->i + 2) : -1;
    if (code >= LOW || second < LOW || second >= AFTER) {
        return wrong(sc, at, "\\u%04x is half of a surrogate pair without its other half",
                     (unsigned)code);
    }
    sc->i += LENGTH;
    return true;
}

static bool scan_escape(scan *sc)
{
    const int c = sc->i + 1 < sc->n ? (unsigned char)sc->s[sc->i + 1] : -1;
    if (c == 'u') {
        return scan_unicode_escape(sc);
    }
    if (c > 0 && strchr("\"\\/bfnrt", c) != NULL) {
        sc->i += 2;
        return true;
    }
    sc->i++;
    return wrong(sc, sc->i - 1, "unknown escape in a string: write \"\\\\\" for a backslash");
}

/* A string at sc->i (on the quote). */
static bool scan_string(scan *sc)
{
    const size_t start = sc->i++;
    bool go_on = true;
    while (go_on) {
        const int c = peek(sc);
        if (c == '"') {
            sc->i++;
            return true;
        }
        if (c < 0 || c == '\n' || c == '\r') {
            (void)wrong(sc, start,
                        "the string that begins here has no closing quote on its line");
            return false;
        }
        if (c == '\\') {
            go_on = scan_escape(sc);
            continue;
        }
        const size_t length = c < ' ' ? 0 : mt_utf8_length(sc->s + sc->i, sc->n - sc->i);
        if (length == 0) {
            go_on = c < ' ' ? wrong(sc, sc->i,
                                    "control character U+%04X in a string: write \\u%04x",
                                    (unsigned)c, (unsigned)c)
                            : wrong(sc, sc->i, "byte 0x%02X is not valid UTF-8", (unsigned)c);
        }
        sc->i += length == 0 ? 1 : length;
    }
    return false;
}

static bool is_digit(int c)
{
    return c >= '0' && c <= '9';
}

static bool is_word(int c)
{
    return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           c == '+' || c == '-' || c == '.';
}

static size_t digits(const char *s, size_t n)
{
    size_t k = 0;
    while (k < n && is_digit(s[k])) {
        k++;
    }
    return k;
}

/* What is wrong with a number, by the grammar of RFC 8259, 6: [-] int [ "." digits ] [ e [+-]
 * digits ]; NULL: nothing. */
static const char *number_fault(const char *s, size_t n)
{
    size_t i = s[0] == '-' ? 1 : 0;
    const size_t whole = digits(s + i, n - i);
    if (whole == 0) {
        return "digits are missing before the point";
    }
    if (whole > 1 && s[i] == '0') {
        return "it must not start with 0";
    }
    i += whole;
    if (i < n && s[i] == '.') {
        const size_t part = digits(s + i + 1, n - i - 1);
        if (part == 0) {
            return "digits are missing after the point";
        }
        i += 1 + part;
    }
    if (i < n && (s[i] == 'e' || s[i] == 'E')) {
        i += i + 1 < n && (s[i + 1] == '+' || s[i + 1] == '-') ? 2 : 1;
        const size_t part = digits(s + i, n - i);
        if (part == 0) {
            return "digits are missing in the exponent";
        }
        i += part;
    }
    return i == n ? NULL : "write an expression as a string in double quotes";
}

static bool is_text(const char *s, size_t n, const char *text)
{
    return n == strlen(text) && memcmp(s, text, n) == 0;
}

/* A number or one of true, false, null. */
static bool scan_word(scan *sc)
{
    const size_t start = sc->i;
    while (is_word(peek(sc))) {
        sc->i++;
    }
    const char *const s = sc->s + start;
    const size_t n = sc->i - start;
    const int shown = n < WORD_SHOWN ? (int)n : WORD_SHOWN;
    if (is_text(s, n, "true") || is_text(s, n, "false") || is_text(s, n, "null")) {
        return true;
    }
    if (is_text(s, n, "NaN") || is_text(s, n, "Infinity") || is_text(s, n, "-Infinity")) {
        return wrong(sc, start, "%.*s is not a number in JSON: numbers must be finite", shown,
                     s);
    }
    if (is_digit(s[0]) || s[0] == '-' || s[0] == '+' || s[0] == '.') {
        const char *const fault = s[0] == '+' ? "it must not start with +" : number_fault(s, n);
        return fault == NULL || wrong(sc, start, "malformed number %.*s: %s", shown, s, fault);
    }
    return wrong(sc, start, "unexpected %.*s: strings are written in double quotes", shown, s);
}

static bool unexpected(scan *sc, const char *wanted)
{
    const int c = peek(sc);
    if (c < 0) {
        return wrong(sc, sc->i, "the text ends where %s is expected", wanted);
    }
    if (c == '"') {
        return wrong(sc, sc->i, "unexpected string where %s is expected", wanted);
    }
    if (c > ' ' && c < 0x7F) {
        return wrong(sc, sc->i, "unexpected \"%c\" where %s is expected", c, wanted);
    }
    return wrong(sc, sc->i, "unexpected byte 0x%02X where %s is expected", (unsigned)c, wanted);
}

static bool scan_value(scan *sc, size_t name);

/* A member name and its colon; *name is the offset of its quote. */
static bool scan_member_name(scan *sc, size_t *name)
{
    *name = sc->i;
    if (peek(sc) == '"') {
        if (!scan_string(sc)) {
            return false;
        }
    } else if (is_word(peek(sc))) {
        if (!wrong(sc, sc->i, "a member name must stand in double quotes")) {
            return false;
        }
        while (is_word(peek(sc))) {
            sc->i++;
        }
    } else {
        (void)unexpected(sc, "a member name in double quotes");
        return false;
    }
    if (!skip_space(sc)) {
        return false;
    }
    if (peek(sc) != ':') {
        (void)unexpected(sc, "\":\"");
        return false;
    }
    sc->i++;
    return true;
}

/* What stands between two items: a comma, or what is to be said about it. *more: another item
 * follows. */
static bool scan_separator(scan *sc, char close, bool *more)
{
    const bool is_list = close == ']';
    if (!skip_space(sc)) {
        return false;
    }
    *more = peek(sc) != close;
    if (!*more) {
        return true;
    }
    const int c = peek(sc);
    if (c == ',') {
        const size_t comma = sc->i++;
        if (!skip_space(sc)) {
            return false;
        }
        *more = peek(sc) != close;
        return *more || wrong(sc, comma, "no comma is allowed behind the last %s",
                              is_list ? "item of a list" : "member of an object");
    }
    const bool go_on = unexpected(sc, is_list ? "\",\" or \"]\"" : "\",\" or \"}\"");
    return go_on && (c == '"' || is_word(c) || c == '{' || c == '[');
}

/* The items behind an opening bracket. */
static bool scan_items(scan *sc, char close)
{
    const bool is_list = close == ']';
    bool more = true;
    if (!skip_space(sc)) {
        return false;
    }
    more = peek(sc) != close;
    while (more) {
        size_t name = 0;
        if (!is_list && !scan_member_name(sc, &name)) {
            return false;
        }
        if (!skip_space(sc)) {
            return false;
        }
        if (!scan_value(sc, name) || !scan_separator(sc, close, &more)) {
            return false;
        }
    }
    sc->i++;
    return true;
}

static bool scan_container(scan *sc, mt_addr self)
{
    const char close = sc->s[sc->i] == '[' ? ']' : '}';
    if (sc->depth == MT_JSON_MAX_DEPTH) {
        (void)wrong(sc, sc->i, "nested deeper than %d levels", MT_JSON_MAX_DEPTH);
        return false;
    }
    sc->i++;
    const int outer = sc->parent;
    sc->parent = self;
    sc->depth++;
    const bool ok = scan_items(sc, close);
    sc->depth--;
    sc->parent = outer;
    return ok;
}

static bool scan_quoted_wrongly(scan *sc)
{
    const size_t at = sc->i++;
    while (sc->i < sc->n && sc->s[sc->i] != '\'' && sc->s[sc->i] != '\n') {
        sc->i++;
    }
    sc->i += peek(sc) == '\'' ? 1 : 0;
    return wrong(sc, at, "strings are written in double quotes");
}

static bool scan_value(scan *sc, size_t name)
{
    if (sc->out->n >= sc->out->most) {
        (void)wrong(sc, sc->i, "more than %d values", sc->out->most);
        return false;
    }
    const int c = peek(sc);
    const mt_addr self = add_spot(
        sc,
        (mt_json_spot){.start = (unsigned)sc->i, .name = (unsigned)name, .parent = sc->parent});
    if (self == MT_NO_ADDR) {
        return false;
    }
    if (c == '{' || c == '[') {
        return scan_container(sc, self);
    }
    if (c == '"') {
        return scan_string(sc);
    }
    if (c == '\'') {
        return scan_quoted_wrongly(sc);
    }
    if (is_word(c)) {
        return scan_word(sc);
    }
    (void)unexpected(sc, "a value");
    return false;
}

/* A whole text: one value between white space. */
static void scan_text(scan *sc)
{
    static const char bom[] = {'\xEF', '\xBB', '\xBF'};
    if (sc->n >= sizeof bom && memcmp(sc->s, bom, sizeof bom) == 0) {
        (void)wrong(sc, 0,
                    "the text starts with a byte order mark: save it as UTF-8 without one");
        sc->i = sizeof bom;
    }
    if (sc->n >= 2 && (unsigned char)sc->s[0] >= 0xFEU && (unsigned char)sc->s[1] >= 0xFEU) {
        (void)wrong(sc, 0, "the text is UTF-16: save it as UTF-8");
        return;
    }
    if (!skip_space(sc)) {
        return;
    }
    if (peek(sc) < 0) {
        (void)wrong(sc, 0, "the text is empty");
        return;
    }
    if (scan_value(sc, 0) && skip_space(sc) && peek(sc) >= 0) {
        (void)unexpected(sc, "the end of the text");
    }
}

/* The other files of a test are given by mistake. */
static void write_universal(scan *sc)
{
    mt_text holds = {.s = NULL};
    mt_universal_contents(sc->s, sc->n, &holds);
    (void)wrong(sc, 0, "this is a universal file, no JSON: %s", holds.s == NULL ? "" : holds.s);
    mt_text_free(&holds);
}

void mt_json_scan(const char *text, size_t length, mt_json_spots *out, mt_diags *diags)
{
    scan sc = {.s = text, .n = length, .parent = MT_NO_ADDR, .out = out, .diags = diags};
    if (length <= MT_JSON_MAX_BYTES && mt_universal_begins(text, length)) {
        write_universal(&sc);
    } else if (length > MT_JSON_MAX_BYTES) {
        (void)wrong(&sc, 0, "longer than %d bytes", MT_JSON_MAX_BYTES);
    } else {
        scan_text(&sc);
    }
}
