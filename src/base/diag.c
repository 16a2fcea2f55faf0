/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/diag.h"

#include <stdarg.h>

mt_diags mt_diags_default(mt_arena *mem)
{
    return (mt_diags){.mem = mem};
}

static void add(mt_diags *d, mt_addr addr, mt_severity severity, bool structural,
                const char *text)
{
    mt_diag *const items =
        text == NULL ? NULL
                     : mt_arena_grow(d->mem, d->items, d->count, &d->capacity, sizeof *items);
    if (items == NULL) {
        d->out_of_memory = 1;
        return;
    }
    items[d->count] =
        (mt_diag){.addr = addr, .severity = severity, .structural = structural, .text = text};
    d->items = items;
    d->count++;
}

void mt_diag_error(mt_diags *d, mt_addr addr, const char *fmt, ...)
{
    d->errors++;
    if (d->count >= MT_DIAG_LIMIT) {
        return;
    }
    va_list args;
    va_start(args, fmt);
    add(d, addr, MT_SEV_ERROR, false, mt_arena_vprintf(d->mem, fmt, args));
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
    add(d, addr, MT_SEV_ERROR, true, mt_arena_vprintf(d->mem, fmt, args));
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
    add(d, addr, MT_SEV_WARNING, false, mt_arena_vprintf(d->mem, fmt, args));
    va_end(args);
}
