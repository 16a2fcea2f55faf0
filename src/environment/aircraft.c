/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/aircraft.h"

#include <string.h>

#include "base/text.h"

const mt_aircraft *mt_aircraft_find(const mt_aircraft_list *list, const char *name)
{
    for (int i = 0; i < list->n; i++) {
        if (strcmp(list->items[i].name.s, name) == 0) {
            return &list->items[i];
        }
    }
    return NULL;
}

const char *mt_aircraft_nearest(const mt_aircraft_list *list, const char *name, mt_arena *mem)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const char **const names = mt_arena_alloc(mem, (size_t)list->n, sizeof *names);
    for (int i = 0; names != NULL && i < list->n; i++) {
        names[i] = list->items[i].name.s;
    }
    const char *const found = names == NULL ? NULL : mt_text_nearest(name, names, list->n);
    mt_arena_rewind(mem, mark);
    return found;
}
