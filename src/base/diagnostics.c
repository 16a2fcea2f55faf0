/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Problems of files, with their places, and warnings. */
#include "base/diagnostics.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/format.h"

/* Number of notes and warnings kept, and of faults besides, so that no warning displaces a
 * fault. */
enum { WARNING_LIMIT = 1000 };

/* Problems by address. */

mt_diags mt_diags_default(mt_arena *mem)
{
    return (mt_diags){.mem = mem};
}

/* Names may be as long as the file: what goes beyond a line is not kept. */
enum { TEXT_SIZE = 2048 };

MT_PRINTF(5, 0)
static void add_diagnostic(mt_diags *d, mt_addr addr, mt_severity severity, bool structural,
                           const char *fmt, va_list args)
{
    char line[TEXT_SIZE];
    const bool written = mt_vsnprintf(line, sizeof line, fmt, args) >= 0;
    const char *const text = mt_arena_strdup(d->mem, written ? line : fmt);
    mt_diag *const items =
        mt_arena_grow(d->mem, d->items, d->count, &d->capacity, sizeof *items);
    if (items == NULL) {
        return;
    }
    items[d->count] =
        (mt_diag){.addr = addr, .severity = severity, .structural = structural, .text = text};
    d->items = items;
    d->count++;
}

mt_addr mt_diag_member(const mt_diags *d, mt_addr object, const char *member)
{
    const mt_addr at = d->document == NULL || member == NULL
                           ? MT_NO_ADDR
                           : d->lookup(d->document, object, member);
    return at == MT_NO_ADDR ? object : at;
}

bool mt_diag_has_room(const mt_diags *d)
{
    return d->count < MT_DIAG_LIMIT;
}

bool mt_diag_may_suggest(const mt_diags *d)
{
    return d->errors < MT_DIAG_SUGGESTIONS;
}

void mt_diag_error(mt_diags *d, mt_addr addr, const char *fmt, ...)
{
    d->errors++;
    if (d->count >= MT_DIAG_LIMIT) {
        return;
    }
    va_list args;
    va_start(args, fmt);
    add_diagnostic(d, addr, MT_SEVERITY_ERROR, false, fmt, args);
    va_end(args);
}

void mt_diag_structure(mt_diags *d, mt_addr addr, const char *fmt, ...)
{
    d->errors++;
    d->structural++;
    if (d->count >= MT_DIAG_LIMIT) {
        return;
    }
    va_list args;
    va_start(args, fmt);
    add_diagnostic(d, addr, MT_SEVERITY_ERROR, true, fmt, args);
    va_end(args);
}

void mt_diag_warning(mt_diags *d, mt_addr addr, const char *fmt, ...)
{
    d->warnings++;
    if (d->count >= MT_DIAG_LIMIT) {
        return;
    }
    va_list args;
    va_start(args, fmt);
    add_diagnostic(d, addr, MT_SEVERITY_WARNING, false, fmt, args);
    va_end(args);
}

/* Problems by file, line and pointer, as they are printed. */

enum { LINE_MAX_BYTES = 1000 }; /* a message is cut there */

mt_status mt_diagnostics_new(mt_diagnostics **out, mt_err *err)
{
    MT_NOT_NULL(out, err);
    *out = calloc(1, sizeof **out);
    return *out == NULL ? mt_fail_memory(err) : MT_OK;
}

void mt_diagnostics_free(mt_diagnostics *d)
{
    mt_text_free(&d->lines);
    mt_text_free(&d->parts);
    free(d->items);
    *d = (mt_diagnostics){0};
}

void mt_diagnostics_delete(mt_diagnostics *d)
{
    if (d != NULL) {
        mt_diagnostics_free(d);
        free(d);
    }
}

/* Text made visible, cut at a character boundary. */
static void add_visible(const char *text, mt_text *out)
{
    mt_text_addf(out, "%.*s%s", LINE_MAX_BYTES, text,
                 strlen(text) > LINE_MAX_BYTES ? "..." : "");
}

/* End a part, and say where the next one begins. */
static size_t end_part(mt_text *parts)
{
    mt_text_add_n(parts, "", 1);
    return parts->length;
}

/* Room for n more items; false where memory is out. */
static bool grow(mt_diagnostics *d, int n)
{
    if (d->count + n > d->capacity) {
        const int capacity = (2 * d->capacity) + n + 2;
        mt_diagnostic *const items = realloc(d->items, (size_t)capacity * sizeof *items);
        if (items == NULL) {
            d->lines.failed = true;
            return false;
        }
        d->items = items;
        d->capacity = capacity;
    }
    return true;
}

void mt_diagnostics_add(mt_diagnostics *d, mt_severity severity,
                        const mt_diagnostic_place *place, const char *message)
{
    static const char *const names[MT_SEVERITY_COUNT] = {"error", "warning", "note"};
    const char *const pointer = place->pointer == NULL ? "" : place->pointer;
    if (!grow(d, 1)) {
        return;
    }
    mt_diagnostic *const item = &d->items[d->count++];
    *item = (mt_diagnostic){.severity = severity,
                            .line = place->line,
                            .column = place->column,
                            .file = d->parts.length};
    mt_text_add(&d->parts, place->file);
    item->pointer = end_part(&d->parts);
    mt_text_add(&d->parts, pointer);
    item->message = end_part(&d->parts);
    add_visible(message, &d->parts);
    (void)end_part(&d->parts);
    mt_text_addf(&d->lines, "%s", place->file);
    if (place->line > 0) {
        mt_text_addf(&d->lines, ":%d:%d", place->line, place->column);
    }
    mt_text_addf(&d->lines, ": %s: ", names[severity]);
    if (pointer[0] != '\0') {
        add_visible(pointer, &d->lines);
        mt_text_add(&d->lines, ": ");
    }
    add_visible(message, &d->lines);
    mt_text_add(&d->lines, "\n");
    d->lines.failed = d->lines.failed || d->parts.failed;
}

void mt_diagnostics_leave_out(mt_diagnostics *d, const char *file, int n)
{
    mt_text_addf(&d->lines, "%s: %d more not shown\n", file, n);
    d->left_out += n;
}

void mt_diagnostics_append(mt_diagnostics *d, const mt_diagnostics *more)
{
    const size_t before = d->parts.length;
    if (more->count > 0 && grow(d, more->count)) {
        for (int i = 0; i < more->count; i++) {
            mt_diagnostic *const item = &d->items[d->count++];
            *item = more->items[i];
            item->file += before;
            item->pointer += before;
            item->message += before;
        }
        mt_text_add_n(&d->parts, more->parts.s, more->parts.length);
    }
    if (more->lines.length > 0) {
        mt_text_add_n(&d->lines, more->lines.s, more->lines.length);
    }
    d->left_out += more->left_out;
    d->lines.failed = d->lines.failed || d->parts.failed || more->lines.failed;
}

int mt_diagnostics_first_error(const mt_diagnostics *d)
{
    for (int i = 0; i < d->count; i++) {
        if (d->items[i].severity == MT_SEVERITY_ERROR) {
            return i;
        }
    }
    return -1;
}

static const mt_diagnostic *item(const mt_diagnostics *d, int i)
{
    return d != NULL && !d->lines.failed && i >= 0 && i < d->count ? &d->items[i] : NULL;
}

int mt_diagnostics_count(const mt_diagnostics *d)
{
    return d == NULL || d->lines.failed ? 0 : d->count;
}

int mt_diagnostics_left_out(const mt_diagnostics *d)
{
    return d == NULL ? 0 : d->left_out;
}

mt_severity mt_diagnostics_severity(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL ? MT_SEVERITY_COUNT : it->severity;
}

const char *mt_diagnostics_file(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL ? NULL : d->parts.s + it->file;
}

int mt_diagnostics_line(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL ? 0 : it->line;
}

int mt_diagnostics_column(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL ? 0 : it->column;
}

const char *mt_diagnostics_pointer(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL || it->line == 0 ? NULL : d->parts.s + it->pointer;
}

const char *mt_diagnostics_message(const mt_diagnostics *d, int i)
{
    const mt_diagnostic *const it = item(d, i);
    return it == NULL ? NULL : d->parts.s + it->message;
}

const char *mt_diagnostics_text(const mt_diagnostics *d)
{
    return d == NULL ? NULL : d->lines.s == NULL ? "" : d->lines.s;
}

/* Warnings. */

const char *const mt_warning_names[MT_WARNING_NAME_COUNT] = {
#define MT_WARNING_NAME(name, of) name,
    MT_WARNING_NAMES(MT_WARNING_NAME)
#undef MT_WARNING_NAME
};

mt_warning_list mt_warning_list_default(mt_arena *mem)
{
    return (mt_warning_list){.mem = mem};
}

static bool is_full(const mt_warning_list *list, mt_warning_level level)
{
    return list->n >= (level == MT_LEVEL_FAULT ? 2 : 1) * WARNING_LIMIT;
}

static mt_warning *append_warning(mt_warning_list *list, const mt_warning *item)
{
    if (is_full(list, item->level)) {
        return NULL;
    }
    mt_warning *const items =
        mt_arena_grow(list->mem, list->items, list->n, &list->capacity, sizeof *items);
    if (items == NULL) {
        return NULL;
    }
    list->items = items;
    items[list->n] = *item;
    return &items[list->n++];
}

mt_warning *mt_warning_add(mt_warning_list *list, mt_warning_level level, const char *kind,
                           const char *fmt, ...)
{
    mt_warning item = {.level = level, .kind = kind, .addr = MT_NO_ADDR};
    if (is_full(list, level)) {
        return NULL;
    }
    va_list args;
    va_start(args, fmt);
    item.text = mt_arena_vprintf(list->mem, fmt, args);
    va_end(args);
    return append_warning(list, &item);
}

void mt_warning_sort(mt_warning_list *list, int first)
{
    for (int i = first + 1; i < list->n; i++) {
        const mt_warning moved = list->items[i];
        int k = i;
        for (; k > first && list->items[k - 1].size < moved.size; k--) {
            list->items[k] = list->items[k - 1];
        }
        list->items[k] = moved;
    }
}

void mt_warning_accept(mt_warning_list *list, int first, const mt_accepted *accepted)
{
    for (int i = first; i < list->n; i++) {
        mt_warning *const d = &list->items[i];
        for (int k = 0; k < accepted->n && d->level == MT_LEVEL_WARNING; k++) {
            if (strcmp(accepted->names[k], d->kind) == 0) {
                d->level = MT_LEVEL_NOTE;
                d->text =
                    mt_arena_printf(list->mem, "accepted: %s", d->text == NULL ? "" : d->text);
            }
        }
    }
}

static const char *text(mt_warning_list *list, const char *s)
{
    return s == NULL ? NULL : mt_arena_strdup(list->mem, s);
}

mt_warning *mt_warning_pick(const mt_warning_list *list, mt_warning_level level, mt_arena *mem,
                            int *n)
{
    mt_warning *const out = mt_arena_alloc(mem, (size_t)list->n, sizeof *out);
    *n = 0;
    for (int i = 0; i < list->n && out != NULL; i++) {
        if (list->items[i].level == level) {
            out[(*n)++] = list->items[i];
        }
    }
    return out;
}

void mt_warning_copy(mt_warning_list *list, const mt_warning *item)
{
    mt_warning copy = *item;
    copy.kind = text(list, item->kind);
    copy.text = text(list, item->text);
    copy.configuration = text(list, item->configuration);
    copy.pointer = text(list, item->pointer);
    copy.file = text(list, item->file);
    (void)append_warning(list, &copy);
}
