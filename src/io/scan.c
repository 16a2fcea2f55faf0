/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The strict scanner: one pass over the bytes by recursive descent (nesting is limited), RFC
 * 8259 exactly. A problem inside a token, a missing or superfluous comma and a comment are
 * noted and the scan goes on; where the structure is lost it ends.
 */
#include "io/json_priv.h"

#include <limits.h>
#include <stdarg.h>
#include <string.h>

#include "base/format.h"

enum {
    MESSAGE_SIZE = 256,
    WORD_SHOWN = 40, /* bytes of an unexpected word that a message shows */
    MAX_SYNTAX_ERRORS = 50
};

typedef struct scan {
    mt_json *doc;
    const unsigned char *s;
    size_t n;
    size_t i;   /* next byte */
    int parent; /* container that we are in */
    int depth;
    bool out_of_memory;
} scan;

static mt_addr add_node(scan *sc, size_t start, int type)
{
    mt_json *const doc = sc->doc;
    mt_json_node *const nodes =
        mt_arena_grow(&doc->mem, doc->nodes, doc->count, &doc->capacity, sizeof *nodes);
    if (nodes == NULL) {
        sc->out_of_memory = true;
        return MT_NO_ADDR;
    }
    doc->nodes = nodes;
    nodes[doc->count] = (mt_json_node){
        .start = (unsigned)start, .parent = sc->parent, .next = MT_NO_ADDR, .type = type};
    return doc->count++;
}

/* Note a problem; true where the scan may go on. */
static bool MT_PRINTF(3, 4) wrong(scan *sc, size_t at, const char *fmt, ...)
{
    char text[MESSAGE_SIZE];
    va_list args;
    va_start(args, fmt);
    (void)mt_vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const mt_addr mark = add_node(sc, at, 0);
    if (mark == MT_NO_ADDR) {
        return false;
    }
    mt_diag_error(&sc->doc->diags, mark, "%s", text);
    return sc->doc->diags.errors < MAX_SYNTAX_ERRORS;
}

static int peek(const scan *sc)
{
    return sc->i < sc->n ? sc->s[sc->i] : -1;
}

/* Length of the well-formed UTF-8 sequence that starts at s (Unicode 15, table 3-7), 0 where
 * there is none. */
static size_t utf8_length(const unsigned char *s, size_t n)
{
    if (s[0] < 0x80U) {
        return 1;
    }
    if (s[0] < 0xC2U || s[0] > 0xF4U) {
        return 0;
    }
    const size_t length = s[0] < 0xE0U ? 2 : s[0] < 0xF0U ? 3 : 4;
    if (n < length) {
        return 0;
    }
    const unsigned low = s[0] == 0xE0U ? 0xA0U : s[0] == 0xF0U ? 0x90U : 0x80U;
    const unsigned high = s[0] == 0xEDU ? 0x9FU : s[0] == 0xF4U ? 0x8FU : 0xBFU;
    if (s[1] < low || s[1] > high) {
        return 0;
    }
    for (size_t k = 2; k < length; k++) {
        if ((s[k] & 0xC0U) != 0x80U) {
            return 0;
        }
    }
    return length;
}

/* Skip a comment, which JSON has not. */
static bool skip_comment(scan *sc)
{
    const size_t at = sc->i;
    const bool block = sc->s[at + 1] == '*';
    sc->i += 2;
    while (sc->i < sc->n) {
        const unsigned char c = sc->s[sc->i];
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
        const unsigned char c = sc->s[at + k];
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
    const int c = sc->i + 1 < sc->n ? sc->s[sc->i + 1] : -1;
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
        const size_t length = c < ' ' ? 0 : utf8_length(sc->s + sc->i, sc->n - sc->i);
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

static size_t digits(const unsigned char *s, size_t n)
{
    size_t k = 0;
    while (k < n && is_digit(s[k])) {
        k++;
    }
    return k;
}

/* What is wrong with a number, by the grammar of RFC 8259, 6: [-] int [ "." digits ] [ e [+-]
 * digits ]; NULL: nothing. */
static const char *number_fault(const unsigned char *s, size_t n)
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

static bool is_text(const unsigned char *s, size_t n, const char *text)
{
    return n == strlen(text) && memcmp(s, text, n) == 0;
}

/* A number or one of true, false, null. */
static bool scan_word(scan *sc, int *type)
{
    const size_t start = sc->i;
    while (is_word(peek(sc))) {
        sc->i++;
    }
    const unsigned char *const s = sc->s + start;
    const size_t n = sc->i - start;
    const int shown = n < WORD_SHOWN ? (int)n : WORD_SHOWN;
    const char *const word = (const char *)s;
    if (is_text(s, n, "true") || is_text(s, n, "false")) {
        *type = MT_JSON_BOOL;
        return true;
    }
    if (is_text(s, n, "null")) {
        *type = MT_JSON_NULL;
        return true;
    }
    *type = MT_JSON_NUMBER;
    if (is_text(s, n, "NaN") || is_text(s, n, "Infinity") || is_text(s, n, "-Infinity")) {
        return wrong(sc, start, "%.*s is not a number in JSON: numbers must be finite", shown,
                     word);
    }
    if (is_digit(s[0]) || s[0] == '-' || s[0] == '+' || s[0] == '.') {
        const char *const fault = s[0] == '+' ? "it must not start with +" : number_fault(s, n);
        return fault == NULL ||
               wrong(sc, start, "malformed number %.*s: %s", shown, word, fault);
    }
    return wrong(sc, start, "unexpected %.*s: strings are written in double quotes", shown,
                 word);
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
static bool scan_items(scan *sc, mt_addr self, char close)
{
    const bool is_list = close == ']';
    mt_addr last = MT_NO_ADDR;
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
        const mt_addr item = sc->doc->count;
        if (!scan_value(sc, name)) {
            return false;
        }
        if (last != MT_NO_ADDR) {
            sc->doc->nodes[last].next = item;
        }
        last = item;
        sc->doc->nodes[self].children++;
        if (!scan_separator(sc, close, &more)) {
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
    const bool ok = scan_items(sc, self, close);
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
    if (sc->doc->count >= MT_JSON_MAX_VALUES) {
        (void)wrong(sc, sc->i, "more than %d values", MT_JSON_MAX_VALUES);
        return false;
    }
    const int c = peek(sc);
    int type = c == '{' ? MT_JSON_OBJECT : c == '[' ? MT_JSON_ARRAY : MT_JSON_STRING;
    const mt_addr self = add_node(sc, sc->i, type);
    if (self == MT_NO_ADDR) {
        return false;
    }
    sc->doc->nodes[self].name = (unsigned)name;
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
        const bool ok = scan_word(sc, &type);
        sc->doc->nodes[self].type = type;
        sc->doc->nodes[self].end = (unsigned)sc->i;
        return ok;
    }
    (void)unexpected(sc, "a value");
    return false;
}

/* A whole text: one value between white space. */
static void scan_text(scan *sc)
{
    static const unsigned char bom[] = {0xEF, 0xBB, 0xBF};
    if (sc->n >= sizeof bom && memcmp(sc->s, bom, sizeof bom) == 0) {
        (void)wrong(sc, 0,
                    "the text starts with a byte order mark: save it as UTF-8 without one");
        sc->i = sizeof bom;
    }
    if (sc->n >= 2 && sc->s[0] >= 0xFEU && sc->s[1] >= 0xFEU) {
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

mt_status mt_json_scan(mt_json *doc, mt_err *err)
{
    scan sc = {.doc = doc,
               .s = (const unsigned char *)doc->text,
               .n = doc->length,
               .parent = MT_NO_ADDR};
    if (doc->length > MT_JSON_MAX_BYTES) {
        (void)wrong(&sc, 0, "longer than %d bytes", MT_JSON_MAX_BYTES);
    } else {
        scan_text(&sc);
    }
    if (sc.out_of_memory || mt_arena_failed(doc->diags.mem)) {
        return mt_fail_memory(err);
    }
    return doc->diags.errors == 0 ? MT_OK : mt_fail(err, MT_E_INPUT, "the text is not JSON");
}
