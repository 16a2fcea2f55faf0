/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The strict scanner: one pass over the bytes by recursive descent (nesting is limited), RFC
 * 8259 exactly. A problem inside a token, a missing or superfluous comma and a comment are
 * noted and the scan goes on; where the structure is lost it ends.
 */
#include "io/json.h"

#include <cjson/cJSON.h>

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "io/file.h"
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

/*
 * The document: the scanner says whether the text is JSON, cJSON builds it. Both go through it
 * in the same order, which makes the scanner's spots the addresses of cJSON's items.
 *
 * cJSON reads numbers as the C library does, correctly rounded, but with the decimal point of
 * the locale, and not beyond the 63rd character. So this thread is in the locale "C" while it
 * reads, and longer numbers are 0 to it and read here.
 */

#ifdef __GLIBC__
#    include <malloc.h>
#endif

/* LARGE: a text whose items are worth giving back to the system. */
enum { CJSON_NUMBER_MOST = 63, CJSON_TYPE = 0xFF, LARGE = 1 << 20 };

/* What a document was made of: documents with texts of their own, the first of them in the
 * place of the file that it was read from; the origins of all values, then those of addresses
 * that are no value's, for problems (2 n, 2 n + 1 ...). */
typedef struct note {
    const char *text;
    int under; /* of what it was made from; -1: nothing */
} note;

typedef struct made {
    int n_docs;
    mt_json **docs;
    const char **files;
    int n_origins;
    mt_json_origin *origins;
    int n_notes;
    note *notes;
} made;

/* cJSON holds names, values and the tree. This struct adds the text, the place of each value in
 * it, and the map from addresses to items (the map back is the item's valueint, otherwise
 * unused). */
struct mt_json {
    mt_arena mem;
    mt_diags diags;
    char *text; /* copy, followed by a NUL */
    size_t length;
    mt_json_spots spots;
    cJSON **items;     /* [spots.n]; NULL where the text is not JSON */
    cJSON *tree;       /* the whole document without duplicates */
    cJSON *duplicates; /* members left out, as the object has their name already */
    made *made;        /* NULL: the text is a file's */
};

/* The item of a value's address; NULL for other addresses. */
static cJSON *item_of(const mt_json *doc, mt_addr value)
{
    return doc->items != NULL && value >= 0 && value < doc->spots.n ? doc->items[value] : NULL;
}

static mt_addr addr_of(const cJSON *item)
{
    return item == NULL ? MT_NO_ADDR : item->valueint;
}

/* Bytes of the number at a spot; 0 where there stands something else. */
static size_t number_length(const mt_json *doc, mt_addr value)
{
    const char *const s = doc->text + doc->spots.items[value].start;
    size_t n = 0; /* no strspn: a checked build measures the whole rest of the text for it */
    while (s[n] != '\0' && strchr("+-.0123456789eE", s[n]) != NULL) {
        n++;
    }
    return n;
}

/* The text as cJSON can read it: every number that is too long for it is 0 and blanks. */
static char *without_long_numbers(mt_json *doc, mt_arena *mem)
{
    char *const copy = mt_arena_strndup(mem, doc->text, doc->length);
    for (int i = 0; copy != NULL && i < doc->spots.n; i++) {
        const size_t n = number_length(doc, i);
        if (n > CJSON_NUMBER_MOST) {
            memset(copy + doc->spots.items[i].start, ' ', n);
            copy[doc->spots.items[i].start] = '0';
        }
    }
    return copy;
}

/* Link addresses and items. False where scanner and cJSON disagree: a bug. */
static bool link_items(mt_json *doc)
{
    cJSON *outer[MT_JSON_MAX_DEPTH];
    int depth = 0;
    int n = 0;
    for (cJSON *at = doc->tree; at != NULL;) {
        if (n == doc->spots.n || (at->child != NULL && depth == MT_JSON_MAX_DEPTH)) {
            return false;
        }
        at->valueint = n;
        doc->items[n++] = at;
        if (at->child != NULL) {
            outer[depth++] = at;
            at = at->child;
            continue;
        }
        while (at->next == NULL && depth > 0) {
            at = outer[--depth];
        }
        at = at->next;
    }
    return n == doc->spots.n;
}

/* The numbers that cJSON has not read; those beyond the range of a double are noted, and the
 * largest one stands for them. */
static void finish_numbers(mt_json *doc)
{
    for (int i = 0; i < doc->spots.n; i++) {
        cJSON *const item = doc->items[i];
        if (!cJSON_IsNumber(item)) {
            continue;
        }
        if (number_length(doc, i) > CJSON_NUMBER_MOST) {
            item->valuedouble = strtod(doc->text + doc->spots.items[i].start, NULL);
        }
        if (!isfinite(item->valuedouble)) {
            mt_diag_error(&doc->diags, i, "the number is beyond the range of a double");
            item->valuedouble = item->valuedouble < 0.0 ? -DBL_MAX : DBL_MAX;
        }
    }
}

static int compare_names(const void *a, const void *b)
{
    const cJSON *const x = *(cJSON *const *)a;
    const cJSON *const y = *(cJSON *const *)b;
    const int order = strcmp(x->string, y->string);
    return order != 0 ? order : (x->valueint > y->valueint) - (x->valueint < y->valueint);
}

static void note_duplicate(mt_json *doc, const cJSON *first, const cJSON *again)
{
    const mt_addr at = mt_json_name_addr(doc, again->valueint);
    if (mt_diag_may_suggest(&doc->diags)) { /* finding a line takes a walk through the text */
        int line = 0;
        int column = 0;
        mt_json_locate(doc, mt_json_name_addr(doc, first->valueint), &line, &column);
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice, first in line %d",
                      again->string, line);
    } else {
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice", again->string);
    }
}

/* Note names that an object has twice, and take all members but the first out of it. Sorted by
 * name, so that a large object takes no longer than its text; members has room for all. */
static void take_out_duplicates(mt_json *doc, cJSON *object, cJSON **members)
{
    size_t n = 0;
    for (cJSON *m = object->child; m != NULL; m = m->next) {
        members[n++] = m;
    }
    qsort(members, n, sizeof(cJSON *), compare_names);
    for (size_t first = 0, i = 1; i < n; i++) {
        if (strcmp(members[first]->string, members[i]->string) != 0) {
            first = i;
            continue;
        }
        note_duplicate(doc, members[first], members[i]);
        cJSON_AddItemToArray(doc->duplicates, cJSON_DetachItemViaPointer(object, members[i]));
    }
}

/* Let cJSON build the values of a scanned text: of a document. */
static mt_status build(void *context, mt_err *err)
{
    mt_json *const doc = context;
    mt_arena scratch = {.first = NULL};
    const size_t n = (size_t)doc->spots.n;
    const char *const text = without_long_numbers(doc, &scratch);
    /* NOLINTBEGIN(bugprone-sizeof-expression): pointers are what is meant */
    cJSON **const members = mt_arena_alloc(&scratch, n, sizeof *members);
    doc->items = mt_arena_alloc(&doc->mem, n, sizeof *doc->items);
    /* NOLINTEND(bugprone-sizeof-expression) */
    doc->duplicates = cJSON_CreateArray();
    if (mt_arena_failed(&scratch) || mt_arena_failed(&doc->mem) || doc->duplicates == NULL) {
        mt_arena_free(&scratch);
        return mt_fail_memory(err);
    }
    doc->tree = cJSON_ParseWithLengthOpts(text, doc->length + 1, NULL, true);
    mt_status rc = MT_OK;
    if (doc->tree == NULL) {
        rc = mt_fail_memory(err); /* the text is valid: only memory can be the reason */
    } else if (!link_items(doc)) {
        rc = mt_fail(err, MT_E_INTERNAL, "scanner and cJSON disagree");
    }
    if (rc == MT_OK) {
        finish_numbers(doc);
    }
    for (size_t i = 0; rc == MT_OK && i < n; i++) {
        if (cJSON_IsObject(doc->items[i])) {
            take_out_duplicates(doc, doc->items[i], members);
        }
    }
    mt_arena_free(&scratch);
    return rc;
}

static mt_addr lookup_member(const void *document, mt_addr object, const char *member)
{
    return mt_json_member(document, object, member);
}

mt_status mt_json_parse(const char *text, size_t length, mt_json **out, mt_err *err)
{
    *out = NULL;
    mt_json *const doc = calloc(1, sizeof *doc);
    if (doc == NULL) {
        return mt_fail_memory(err);
    }
    /* of a text that is too long only the start is of use */
    doc->length = length > MT_JSON_MAX_BYTES ? 0 : length;
    doc->diags = mt_diags_default(&doc->mem);
    doc->diags.document = doc;
    doc->diags.lookup = lookup_member;
    doc->spots.most = MT_JSON_MAX_VALUES;
    doc->text = mt_arena_strndup(&doc->mem, text, doc->length);
    mt_status rc = mt_arena_check(&doc->mem, err);
    if (rc == MT_OK) {
        mt_json_scan(doc->text, length, &doc->spots, &doc->diags);
        rc = mt_arena_check(&doc->mem, err);
    }
    if (rc == MT_OK && doc->diags.errors > 0) {
        *out = doc;
        return mt_fail(err, MT_E_INPUT, "the text is not JSON");
    }
    if (rc == MT_OK) {
        rc = mt_locale_plain(build, doc, err);
    }
    if (rc == MT_OK) {
        rc = mt_arena_check(&doc->mem, err);
    }
    if (rc != MT_OK) {
        mt_json_delete(doc);
        return rc;
    }
    *out = doc;
    return MT_OK;
}

void mt_json_delete(mt_json *doc)
{
    if (doc == NULL) {
        return;
    }
    const bool large = doc->length >= LARGE;
    for (int i = 0; doc->made != NULL && i < doc->made->n_docs; i++) {
        mt_json_delete(doc->made->docs[i]);
    }
    cJSON_Delete(doc->tree);
    cJSON_Delete(doc->duplicates);
    mt_arena_free(&doc->mem);
    free(doc);
#ifdef __GLIBC__
    if (large) { /* seven times the text lies in pieces below what was made of it */
        (void)malloc_trim(0);
    }
#else
    (void)large;
#endif
}

mt_diags *mt_json_diags(mt_json *doc)
{
    return &doc->diags;
}

mt_json_type mt_json_type_of(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    switch (item == NULL ? cJSON_NULL : item->type & CJSON_TYPE) {
    case cJSON_False:
    case cJSON_True:
        return MT_JSON_BOOL;
    case cJSON_Number:
        return MT_JSON_NUMBER;
    case cJSON_String:
        return MT_JSON_STRING;
    case cJSON_Array:
        return MT_JSON_ARRAY;
    case cJSON_Object:
        return MT_JSON_OBJECT;
    default:
        return MT_JSON_NULL;
    }
}

const char *mt_json_type_text(mt_json_type type)
{
    switch (type) {
    case MT_JSON_NULL:
        return "null";
    case MT_JSON_BOOL:
        return "true or false";
    case MT_JSON_NUMBER:
        return "a number";
    case MT_JSON_STRING:
        return "a string";
    case MT_JSON_ARRAY:
        return "a list";
    case MT_JSON_OBJECT:
        return "an object";
    }
    return "nothing";
}

const char *mt_json_string(const mt_json *doc, mt_addr value)
{
    const char *const s = cJSON_GetStringValue(item_of(doc, value));
    return s == NULL ? "" : s;
}

double mt_json_number(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? 0.0 : item->valuedouble;
}

bool mt_json_bool(const mt_json *doc, mt_addr value)
{
    return cJSON_IsTrue(item_of(doc, value)) != 0;
}

int mt_json_count(const mt_json *doc, mt_addr value)
{
    return cJSON_GetArraySize(item_of(doc, value));
}

mt_addr mt_json_first(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? MT_NO_ADDR : addr_of(item->child);
}

mt_addr mt_json_next(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? MT_NO_ADDR : addr_of(item->next);
}

mt_items mt_json_items(const mt_json *doc, mt_addr value)
{
    mt_items items = {.doc = doc, .at = MT_NO_ADDR, .next = MT_NO_ADDR};
    if (value != MT_NO_ADDR) {
        items.count = mt_json_count(doc, value);
        items.left = items.count;
        items.next = mt_json_first(doc, value);
    }
    return items;
}

bool mt_items_next(mt_items *items)
{
    items->at = items->left > 0 ? items->next : MT_NO_ADDR;
    if (items->at == MT_NO_ADDR) {
        return false;
    }
    items->left--;
    items->next = items->left > 0 ? mt_json_next(items->doc, items->at) : MT_NO_ADDR;
    return true;
}

mt_addr mt_json_member(const mt_json *doc, mt_addr value, const char *name)
{
    const cJSON *const item = item_of(doc, value);
    return cJSON_IsObject(item) ? addr_of(cJSON_GetObjectItemCaseSensitive(item, name))
                                : MT_NO_ADDR;
}

const char *mt_json_name(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? NULL : item->string;
}

mt_addr mt_json_name_addr(const mt_json *doc, mt_addr value)
{
    return item_of(doc, value) == NULL || doc->spots.items[value].name == 0
               ? value
               : doc->spots.n + value;
}

bool mt_json_span(const mt_json *doc, mt_addr value, size_t *begin, size_t *end)
{
    const cJSON *const item = item_of(doc, value);
    if (!cJSON_IsNumber(item) && !cJSON_IsString(item)) {
        return false;
    }
    *begin = doc->spots.items[value].start;
    *end = *begin + number_length(doc, value);
    if (cJSON_IsString(item)) {
        for (*end = *begin + 1; doc->text[*end] != '"'; ++*end) {
            *end += doc->text[*end] == '\\';
        }
        ++*end;
    }
    return true;
}

/* Places and pointers. */

/* A place while walking through the text. */
typedef struct cursor {
    size_t offset;
    int line;
    int column;
} cursor;

static void advance(const mt_json *doc, cursor *at, size_t offset)
{
    const char *const s = doc->text;
    for (; at->offset < offset && at->offset < doc->length; at->offset++) {
        const char c = s[at->offset];
        if (c == '\n' || (c == '\r' && s[at->offset + 1] != '\n')) {
            at->line++;
            at->column = 1;
        } else if (((unsigned char)c & 0xC0U) != 0x80U) { /* 10xxxxxx continues a code point */
            at->column++;
        }
    }
}

/* The spot of an address; *name: the address means the member name in front of it. */
static const mt_json_spot *spot_of(const mt_json *doc, mt_addr addr, bool *name)
{
    const int n = doc->spots.n;
    *name = addr >= n;
    const mt_addr index = *name ? addr - n : addr;
    return index >= 0 && index < n ? &doc->spots.items[index] : NULL;
}

static size_t offset_of(const mt_json *doc, mt_addr addr)
{
    bool name = false;
    const mt_json_spot *const spot = spot_of(doc, addr, &name);
    return spot == NULL ? 0 : name ? spot->name : spot->start;
}

/* Where an address stands: in a document with a text of its own. */
typedef struct origin {
    const mt_json *doc;
    const char *file; /* NULL: the one that the reader was asked for */
    mt_addr addr;
    int order; /* of the document among those of one file */
    int note;
} origin;

static origin origin_of(const mt_json *doc, mt_addr addr)
{
    const made *const of = doc->made;
    const int n = doc->spots.n;
    if (of == NULL || addr < 0) {
        return (origin){.doc = doc, .addr = addr, .note = -1};
    }
    const bool name = addr >= n && addr < 2 * n;
    const mt_json_origin *const at = &of->origins[name            ? addr - n
                                                  : addr >= 2 * n ? addr - n
                                                                  : addr];
    return (origin){.doc = of->docs[at->doc],
                    .file = of->files[at->doc],
                    .addr = name ? mt_json_name_addr(of->docs[at->doc], at->addr) : at->addr,
                    .order = at->doc,
                    .note = at->note};
}

const char *mt_json_file(const mt_json *doc, mt_addr addr)
{
    return origin_of(doc, addr).file;
}

const char *mt_json_text(const mt_json *doc, size_t *length)
{
    *length = doc->length;
    return doc->text;
}

void mt_json_locate(const mt_json *doc, mt_addr addr, int *line, int *column)
{
    const origin of = origin_of(doc, addr);
    cursor at = {0, 1, 1};
    advance(of.doc, &at, offset_of(of.doc, of.addr));
    *line = at.line;
    *column = at.column;
}

/* An address in the order of the text that it stands in. */
typedef struct entry {
    long long offset; /* -1: no place */
    int order;        /* of the document */
    int index;
} entry;

static int compare_entries(const void *a, const void *b)
{
    const entry *const x = a;
    const entry *const y = b;
    if (x->order != y->order) {
        return x->order < y->order ? -1 : 1;
    }
    if (x->offset != y->offset) {
        return x->offset < y->offset ? -1 : 1;
    }
    return (x->index > y->index) - (x->index < y->index);
}

static entry entry_of(const mt_json *doc, mt_addr addr, int index)
{
    const origin of = origin_of(doc, addr);
    return (entry){.order = of.order,
                   .offset = addr == MT_NO_ADDR ? -1 : (long long)offset_of(of.doc, of.addr),
                   .index = index};
}

void mt_json_locates(const mt_json *doc, int n, const mt_addr *addrs, int *lines, int *columns)
{
    entry *const sorted = doc->made == NULL ? NULL : calloc((size_t)n + 1, sizeof *sorted);
    for (int i = 0; i < n && sorted != NULL; i++) {
        sorted[i] = entry_of(doc, addrs[i], i);
    }
    if (sorted != NULL) {
        qsort(sorted, (size_t)n, sizeof *sorted, compare_entries);
    }
    cursor at = {0, 1, 1};
    const mt_json *in = doc;
    for (int i = 0; i < n; i++) {
        const int k = sorted == NULL ? i : sorted[i].index;
        const origin of = origin_of(doc, addrs[k]);
        const size_t offset = offset_of(of.doc, of.addr);
        if (of.doc != in || offset < at.offset) {
            at = (cursor){0, 1, 1};
            in = of.doc;
        }
        advance(of.doc, &at, offset);
        lines[k] = at.line;
        columns[k] = at.column;
    }
    free(sorted);
}

/* A member name as a pointer writes it: decoded where the values stand, else as in the
 * source. */
static void add_name(const mt_json *doc, mt_addr value, mt_text *out)
{
    const bool in_source = doc->items == NULL;
    const char *s =
        in_source ? doc->text + doc->spots.items[value].name + 1 : doc->items[value]->string;
    for (; *s != '\0' && !(in_source && (*s == '"' || *s == ':')); s++) {
        if (in_source && *s == '\\' && s[1] != '\0') {
            mt_text_add_n(out, s++, 1);
        }
        if (*s == '~' || *s == '/') {
            mt_text_add(out, *s == '~' ? "~0" : "~1");
        } else {
            mt_text_add_n(out, s, 1);
        }
    }
}

static int index_in_list(const mt_json *doc, mt_addr value)
{
    const mt_json_spot *const spots = doc->spots.items;
    const mt_addr list = spots[value].parent;
    int index = 0;
    for (mt_addr i = list + 1; i < value; i++) {
        index += spots[i].parent == list && !spots[i].mistake;
    }
    return index;
}

/* The child of a value that a pointer's token of n bytes names. */
static mt_addr find_child(const mt_json *doc, mt_addr value, const char *token, size_t n)
{
    if (mt_json_type_of(doc, value) == MT_JSON_ARRAY) {
        const cJSON *const item =
            cJSON_GetArrayItem(doc->items[value], (int)strtol(token, NULL, 10));
        return item == NULL || *token < '0' || *token > '9' ? MT_NO_ADDR : item->valueint;
    }
    mt_text name = {.s = NULL};
    for (size_t i = 0; i < n; i++) { /* ~0 is ~, ~1 is / */
        const bool escaped = token[i] == '~' && i + 1 < n;
        const char *const plain = escaped ? (token[i + 1] == '1' ? "/" : "~") : token + i;
        mt_text_add_n(&name, plain, 1);
        i += escaped ? 1 : 0;
    }
    const mt_addr at =
        name.failed || name.s == NULL ? MT_NO_ADDR : mt_json_member(doc, value, name.s);
    mt_text_free(&name);
    return at;
}

mt_addr mt_json_find(const mt_json *doc, const char *pointer, size_t length)
{
    mt_addr at = doc->items == NULL ? MT_NO_ADDR : MT_JSON_ROOT;
    for (size_t i = 0; i < length && at != MT_NO_ADDR;) {
        size_t n = 0;
        while (i + 1 + n < length && pointer[i + 1 + n] != '/') {
            n++;
        }
        at = pointer[i] == '/' ? find_child(doc, at, pointer + i + 1, n) : MT_NO_ADDR;
        i += n + 1;
    }
    return at;
}

/* Of a document with a text of its own. */
static void add_pointer(const mt_json *doc, mt_addr addr, mt_text *out)
{
    const mt_json_spot *const spots = doc->spots.items;
    mt_addr path[MT_JSON_MAX_DEPTH + 1];
    int depth = 0;
    bool name = false;
    const mt_json_spot *const spot = spot_of(doc, addr, &name);
    if (spot == NULL) {
        return;
    }
    mt_addr at = name || spot->mistake ? spot->parent : addr;
    /* mistakes before the text's value come first: the root is what has no parent */
    for (; at != MT_NO_ADDR && spots[at].parent != MT_NO_ADDR; at = spots[at].parent) {
        path[depth++] = at;
    }
    while (depth > 0) {
        at = path[--depth];
        mt_text_add(out, "/");
        if (spots[at].name != 0) {
            add_name(doc, at, out);
        } else {
            mt_text_addf(out, "%d", index_in_list(doc, at));
        }
    }
}

void mt_json_pointer(const mt_json *doc, mt_addr addr, mt_text *out)
{
    const origin of = origin_of(doc, addr);
    add_pointer(of.doc, of.addr, out);
}

/* What the notes say of a value, from the last that was made of it to the first. */
static void add_notes(const mt_json *doc, int last, mt_text *out)
{
    for (int i = last; i >= 0; i = doc->made->notes[i].under) {
        mt_text_add(out, " (");
        mt_text_add(out, doc->made->notes[i].text);
        mt_text_add(out, ")");
    }
}

static void report_one(const mt_json *doc, const char *file, const mt_diag *diag, cursor *at,
                       mt_diagnostics *out)
{
    mt_text pointer = {0};
    mt_text said = {0};
    mt_diagnostic_place place = {.file = file};
    if (diag->addr != MT_NO_ADDR) {
        const origin of = origin_of(doc, diag->addr);
        const size_t offset = offset_of(of.doc, of.addr);
        if (doc->made != NULL) {
            *at = (cursor){0, 1, 1};
        }
        advance(of.doc, at, offset);
        place.file = of.file == NULL ? file : of.file;
        place.line = at->line;
        place.column = at->column;
        add_pointer(of.doc, of.addr, &pointer);
        place.pointer = pointer.s;
        mt_text_add(&said, diag->text);
        add_notes(doc, of.note, &said);
    }
    mt_diagnostics_add(out, diag->severity, &place, said.s == NULL ? diag->text : said.s);
    out->lines.failed = out->lines.failed || pointer.failed || said.failed;
    mt_text_free(&pointer);
    mt_text_free(&said);
}

/* True where a problem of a copy is one of what it was copied from, too, or has been told word
 * for word of the same value. */
static bool is_repeated(const mt_json *doc, int index)
{
    const mt_diag *const d = &doc->diags.items[index];
    const origin at = origin_of(doc, d->addr);
    bool told = false;
    for (int i = 0; i < doc->diags.count && doc->made != NULL && !told; i++) {
        const mt_diag *const other = &doc->diags.items[i];
        const origin of = origin_of(doc, other->addr);
        told = i != index && d->addr != MT_NO_ADDR && of.doc == at.doc && of.addr == at.addr &&
               other->severity == d->severity &&
               ((of.note < 0 && at.note >= 0) ||
                (i < index && of.note == at.note && strcmp(other->text, d->text) == 0));
    }
    return told;
}

void mt_json_report(const mt_json *doc, const char *file, mt_diagnostics *out)
{
    const mt_diags *const diags = &doc->diags;
    entry order[MT_DIAG_LIMIT] = {{0, 0, 0}};
    int n = 0;
    int again = 0;
    for (int i = 0; i < diags->count && i < MT_DIAG_LIMIT; i++) {
        if (is_repeated(doc, i)) {
            again++;
        } else {
            order[n++] = entry_of(doc, diags->items[i].addr, i);
        }
    }
    qsort(order, (size_t)n, sizeof order[0], compare_entries);
    cursor at = {0, 1, 1};
    for (int i = 0; i < n; i++) {
        report_one(doc, file, &diags->items[order[i].index], &at, out);
    }
    const int more = diags->errors + diags->warnings - n - again;
    if (more > 0) {
        mt_diagnostics_leave_out(out, file, more);
    }
}

mt_status mt_json_status(const mt_json *doc, const char *file, mt_err *err)
{
    const mt_diags *const diags = &doc->diags;
    MT_TRY(mt_arena_check(diags->mem, err));
    if (diags->errors == 0) {
        return MT_OK;
    }
    mt_diagnostics said = {.count = 0};
    mt_json_report(doc, file, &said);
    if (said.lines.failed) {
        mt_diagnostics_free(&said);
        return mt_fail_memory(err);
    }
    /* the line of the first error: warnings may stand before it */
    const char *line = mt_diagnostics_text(&said);
    for (int i = mt_diagnostics_first_error(&said); i > 0; i--) {
        line = strchr(line, '\n') + 1;
    }
    const int length = (int)strcspn(line, "\n");
    int again = 0;
    for (int i = 0; i < diags->count; i++) {
        again += diags->items[i].severity == MT_SEVERITY_ERROR && is_repeated(doc, i) ? 1 : 0;
    }
    const int more = diags->errors - again - 1;
    const mt_status rc =
        more == 0 ? mt_fail(err, MT_E_INPUT, "%.*s", length, line)
                  : mt_fail(err, MT_E_INPUT, "%.*s (and %d more)", length, line, more);
    mt_diagnostics_free(&said);
    return rc;
}

/* A document made of others. */

/* The notes of a part that is made of others itself, behind those there are. */
static void take_notes(mt_json *whole, const made *of, int first)
{
    made *const to = whole->made;
    for (int k = 0; k < of->n_notes; k++) {
        const note *const n = &of->notes[k];
        to->notes[first + k] = (note){.text = mt_arena_strdup(&whole->mem, n->text),
                                      .under = n->under < 0 ? -1 : n->under + first};
    }
    to->n_notes += of->n_notes;
}

/* A document with a text of its own. */
static void take_document(mt_json *whole, mt_json *doc, const char *file)
{
    made *const to = whole->made;
    to->docs[to->n_docs] = doc;
    to->files[to->n_docs++] = file == NULL ? NULL : mt_arena_strdup(&whole->mem, file);
}

/* Add what the parts consist of to the lists: documents with texts of their own. first: where
 * those of each part begin, in documents and in notes. */
static void take_documents(mt_json *whole, const mt_json_parts *parts, int *first_doc,
                           int *first_note)
{
    made *const to = whole->made;
    for (int k = 0; k < parts->n_notes; k++) {
        to->notes[to->n_notes++] =
            (note){.text = mt_arena_strdup(&whole->mem, parts->notes[k]), .under = -1};
    }
    for (int i = 0; i < parts->n_docs; i++) {
        const made *const of = parts->docs[i]->made;
        first_doc[i] = to->n_docs;
        first_note[i] = to->n_notes;
        if (of == NULL) {
            take_document(whole, parts->docs[i], parts->files[i]);
            continue;
        }
        take_notes(whole, of, first_note[i]);
        for (int k = 0; k < of->n_docs; k++) {
            take_document(whole, of->docs[k],
                          of->files[k] == NULL ? parts->files[i] : of->files[k]);
        }
    }
}

/* The note that says the first text, then what was known; of neighbours the same one. */
static int note_upon(made *to, int upper, int under)
{
    if (upper < 0 || under < 0) {
        return upper < 0 ? under : upper;
    }
    const note *const last = &to->notes[to->n_notes - 1];
    if (last->text == to->notes[upper].text && last->under == under) {
        return to->n_notes - 1;
    }
    to->notes[to->n_notes] = (note){.text = to->notes[upper].text, .under = under};
    return to->n_notes++;
}

static mt_json_origin compose(made *to, const mt_json_parts *parts, mt_json_origin at,
                              const int *first_doc, const int *first_note)
{
    const origin of = origin_of(parts->docs[at.doc], at.addr);
    const int under = of.note < 0 ? -1 : of.note + first_note[at.doc];
    return (mt_json_origin){.doc = first_doc[at.doc] + of.order,
                            .addr = of.addr,
                            .note = note_upon(to, at.note, under)};
}

/* Problems of the parts are problems of the whole, at addresses beyond those of its values. */
static void take_problems(mt_json *whole, const mt_json_parts *parts, const int *first_doc,
                          const int *first_note)
{
    made *const to = whole->made;
    for (int i = 0; i < parts->n_docs; i++) {
        const mt_diags *const from = &parts->docs[i]->diags;
        for (int k = 0; k < from->count; k++) {
            const mt_diag *const d = &from->items[k];
            mt_addr addr = d->addr;
            if (addr != MT_NO_ADDR) {
                to->origins[to->n_origins] = compose(
                    to, parts, (mt_json_origin){i, addr, parts->by[i]}, first_doc, first_note);
                addr = whole->spots.n + to->n_origins++;
            }
            void (*const say)(mt_diags *, mt_addr, const char *, ...) =
                d->severity == MT_SEVERITY_WARNING ? mt_diag_warning
                : d->structural                    ? mt_diag_structure
                                                   : mt_diag_error;
            say(&whole->diags, addr, "%s", d->text);
        }
    }
}

/* Room for all: origins and notes of the values, and those of problems. */
static mt_status make_lists(mt_json *whole, const mt_json_parts *parts, int **first,
                            mt_err *err)
{
    size_t docs = 0;
    size_t notes = (size_t)parts->n_notes + (size_t)parts->n_origins + 1;
    size_t problems = 0;
    for (int i = 0; i < parts->n_docs; i++) {
        const made *const of = parts->docs[i]->made;
        docs += of == NULL ? 1 : (size_t)of->n_docs;
        notes += of == NULL ? 0 : (size_t)of->n_notes;
        problems += (size_t)parts->docs[i]->diags.count;
    }
    made *const to = mt_arena_alloc(&whole->mem, 1, sizeof *to);
    *first = mt_arena_int(&whole->mem, 2 * (size_t)parts->n_docs);
    if (to == NULL || *first == NULL) {
        return mt_arena_check(&whole->mem, err);
    }
    /* NOLINTBEGIN(bugprone-sizeof-expression): pointers are what is meant */
    to->docs = mt_arena_alloc(&whole->mem, docs, sizeof *to->docs);
    to->files = mt_arena_alloc(&whole->mem, docs, sizeof *to->files);
    /* NOLINTEND(bugprone-sizeof-expression) */
    to->notes = mt_arena_alloc(&whole->mem, notes + problems, sizeof *to->notes);
    to->origins =
        mt_arena_alloc(&whole->mem, (size_t)parts->n_origins + problems, sizeof *to->origins);
    whole->made = to;
    return mt_arena_check(&whole->mem, err);
}

/* Members given twice in the new text, at their places in the old ones. */
static void note_duplicates(mt_json *whole)
{
    for (const cJSON *m = whole->duplicates->child; m != NULL; m = m->next) {
        mt_diag_error(&whole->diags, mt_json_name_addr(whole, m->valueint),
                      "member \"%s\" is given twice", m->string);
    }
}

static mt_status make_of(mt_json *whole, const mt_json_parts *parts, mt_err *err)
{
    int *first = NULL;
    if (whole->spots.n != parts->n_origins) {
        return mt_fail(err, MT_E_INTERNAL, "%d values with %d origins", whole->spots.n,
                       parts->n_origins);
    }
    MT_TRY(make_lists(whole, parts, &first, err));
    made *const to = whole->made;
    take_documents(whole, parts, first, first + parts->n_docs);
    for (int i = 0; i < parts->n_origins; i++) {
        to->origins[to->n_origins++] =
            compose(to, parts, parts->origins[i], first, first + parts->n_docs);
    }
    whole->diags = mt_diags_default(&whole->mem);
    whole->diags.document = whole;
    whole->diags.lookup = lookup_member;
    take_problems(whole, parts, first, first + parts->n_docs);
    note_duplicates(whole);
    return mt_arena_check(&whole->mem, err);
}

/* The struct goes to another address. */
static void move(mt_json *to, const mt_json *from)
{
    *to = *from;
    to->diags.mem = &to->mem;
    to->diags.document = to;
}

mt_status mt_json_become(mt_json *doc, const char *text, size_t length,
                         const mt_json_parts *parts, mt_err *err)
{
    mt_json *whole = NULL;
    mt_json *const old = calloc(1, sizeof *old);
    mt_status rc = old == NULL ? mt_fail_memory(err) : mt_json_parse(text, length, &whole, err);
    const bool again = rc == MT_E_INPUT;
    rc = again ? mt_fail(err, MT_E_INTERNAL, "a text that was made is not JSON") : rc;
    rc = rc == MT_OK && whole != NULL ? make_of(whole, parts, err) : rc;
    for (int i = 1; i < parts->n_docs; i++) {
        made *const of = parts->docs[i]->made;
        if (rc == MT_OK && of != NULL) {
            of->n_docs = 0; /* the whole has them now */
        }
        if (rc != MT_OK || of != NULL) {
            mt_json_delete(parts->docs[i]);
        }
    }
    if (rc != MT_OK || old == NULL || whole == NULL) {
        if (whole != NULL) {
            whole->made = NULL;
        }
        mt_json_delete(whole);
        free(old);
        return rc;
    }
    move(old, doc);
    move(doc, whole);
    free(whole);
    if (old->made == NULL) {
        doc->made->docs[0] = old;
    } else {
        old->made->n_docs = 0;
        mt_json_delete(old);
    }
    return MT_OK;
}
