/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/warning.h"

#include <stdarg.h>
#include <stddef.h>
#include <string.h>

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
    return list->n >= (level == MT_LEVEL_FAULT ? 2 : 1) * MT_WARNING_LIMIT;
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
