/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/diag.h"

#include <stdarg.h>

#include "base/format.h"

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
