/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/doubt.h"

#include <stdarg.h>
#include <stddef.h>
#include <string.h>

const char *const mt_doubt_names[MT_DOUBT_NAME_COUNT] = {
#define MT_DOUBT_NAME(name, of) name,
    MT_DOUBT_NAMES(MT_DOUBT_NAME)
#undef MT_DOUBT_NAME
};

mt_doubt_list mt_doubt_list_default(mt_arena *mem)
{
    return (mt_doubt_list){.mem = mem};
}

static bool is_full(const mt_doubt_list *list, mt_doubt_level level)
{
    return list->n >= (level == MT_LEVEL_FAULT ? 2 : 1) * MT_DOUBT_LIMIT;
}

static mt_doubt *add(mt_doubt_list *list, const mt_doubt *item)
{
    if (is_full(list, item->level)) {
        return NULL;
    }
    mt_doubt *const items =
        mt_arena_grow(list->mem, list->items, list->n, &list->capacity, sizeof *items);
    if (items == NULL) {
        return NULL;
    }
    list->items = items;
    items[list->n] = *item;
    return &items[list->n++];
}

mt_doubt *mt_doubt_add(mt_doubt_list *list, mt_doubt_level level, const char *kind,
                       const char *fmt, ...)
{
    mt_doubt item = {.level = level, .kind = kind, .addr = MT_NO_ADDR};
    if (is_full(list, level)) {
        return NULL;
    }
    va_list args;
    va_start(args, fmt);
    item.text = mt_arena_vprintf(list->mem, fmt, args);
    va_end(args);
    return add(list, &item);
}

void mt_doubt_sort(mt_doubt_list *list, int first)
{
    for (int i = first + 1; i < list->n; i++) {
        const mt_doubt moved = list->items[i];
        int k = i;
        for (; k > first && list->items[k - 1].size < moved.size; k--) {
            list->items[k] = list->items[k - 1];
        }
        list->items[k] = moved;
    }
}

void mt_doubt_accept(mt_doubt_list *list, int first, const mt_accepted *accepted)
{
    for (int i = first; i < list->n; i++) {
        mt_doubt *const d = &list->items[i];
        for (int k = 0; k < accepted->n && d->level == MT_LEVEL_DOUBT; k++) {
            if (strcmp(accepted->names[k], d->kind) == 0) {
                d->level = MT_LEVEL_FACT;
                d->text =
                    mt_arena_printf(list->mem, "accepted: %s", d->text == NULL ? "" : d->text);
            }
        }
    }
}

static const char *text(mt_doubt_list *list, const char *s)
{
    return s == NULL ? NULL : mt_arena_strdup(list->mem, s);
}

void mt_doubt_copy(mt_doubt_list *list, const mt_doubt *item)
{
    mt_doubt copy = *item;
    copy.kind = text(list, item->kind);
    copy.text = text(list, item->text);
    copy.configuration = text(list, item->configuration);
    copy.pointer = text(list, item->pointer);
    copy.file = text(list, item->file);
    (void)add(list, &copy);
}
