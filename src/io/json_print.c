/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses to places and JSON pointers, and diagnostics with these. */
#include "io/json_print.h"

#include "io/json_priv.h"

#include <stdlib.h>
#include <string.h>

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

void mt_json_locate(const mt_json *doc, mt_addr addr, int *line, int *column)
{
    cursor at = {0, 1, 1};
    advance(doc, &at, offset_of(doc, addr));
    *line = at.line;
    *column = at.column;
}

void mt_json_locates(const mt_json *doc, int n, const mt_addr *addrs, int *lines, int *columns)
{
    cursor at = {0, 1, 1};
    for (int i = 0; i < n; i++) {
        advance(doc, &at, offset_of(doc, addrs[i]));
        lines[i] = at.line;
        columns[i] = at.column;
    }
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

void mt_json_pointer(const mt_json *doc, mt_addr addr, mt_text *out)
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

typedef struct entry {
    long long offset; /* -1: no place */
    int index;
} entry;

static int compare_entries(const void *a, const void *b)
{
    const entry *const x = a;
    const entry *const y = b;
    if (x->offset != y->offset) {
        return x->offset < y->offset ? -1 : 1;
    }
    return (x->index > y->index) - (x->index < y->index);
}

static void report_one(const mt_json *doc, const char *file, const mt_diag *diag, cursor *at,
                       mt_diagnostics *out)
{
    mt_text pointer = {0};
    mt_diagnostic_place place = {.file = file};
    if (diag->addr != MT_NO_ADDR) {
        advance(doc, at, offset_of(doc, diag->addr));
        place.line = at->line;
        place.column = at->column;
        mt_json_pointer(doc, diag->addr, &pointer);
        place.pointer = pointer.s;
    }
    mt_diagnostics_add(out, diag->severity, &place, diag->text);
    out->lines.failed = out->lines.failed || pointer.failed;
    mt_text_free(&pointer);
}

void mt_json_report(const mt_json *doc, const char *file, mt_diagnostics *out)
{
    const mt_diags *const diags = &doc->diags;
    entry order[MT_DIAG_LIMIT] = {{0, 0}};
    int n = 0;
    for (; n < diags->count && n < MT_DIAG_LIMIT; n++) {
        const mt_addr addr = diags->items[n].addr;
        order[n] = (entry){addr == MT_NO_ADDR ? -1 : (long long)offset_of(doc, addr), n};
    }
    qsort(order, (size_t)n, sizeof order[0], compare_entries);
    cursor at = {0, 1, 1};
    for (int i = 0; i < n; i++) {
        report_one(doc, file, &diags->items[order[i].index], &at, out);
    }
    const int more = diags->errors + diags->warnings - n;
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
    const int more = diags->errors - 1;
    const mt_status rc =
        more == 0 ? mt_fail(err, MT_E_INPUT, "%.*s", length, line)
                  : mt_fail(err, MT_E_INPUT, "%.*s (and %d more)", length, line, more);
    mt_diagnostics_free(&said);
    return rc;
}
