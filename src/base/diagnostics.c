/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/diagnostics.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"

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
