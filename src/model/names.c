/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/names.h"

#include <string.h>

/* A name of so many bytes. */
typedef struct part {
    const char *s;
    size_t length;
} part;

static int compare_with_name(const void *context, const void *key, int i)
{
    const mt_names *const t = context;
    const part *const name = key;
    const int order = strncmp(name->s, t->items[i].name, name->length);
    return order != 0 || t->items[i].name[name->length] == '\0' ? order : -1;
}

void mt_names_add(mt_names *t, mt_arena *mem, const char *name, int value, bool *taken)
{
    const part key = {name, strlen(name)};
    *taken = mt_sorted_find(&t->order, compare_with_name, t, &key) >= 0;
    if (*taken) {
        return;
    }
    mt_named *const items = mt_arena_grow(mem, t->items, t->count, &t->room, sizeof *items);
    if (items == NULL) {
        return;
    }
    t->items = items;
    if (mt_sorted_add(&t->order, mem, compare_with_name, t, &key)) {
        t->items[t->count++] = (mt_named){name, value};
    }
}

int mt_names_find(const mt_names *t, const char *name, size_t length, bool *found)
{
    const part key = {name, length};
    const int i = mt_sorted_find(&t->order, compare_with_name, t, &key);
    *found = i >= 0;
    return *found ? t->items[i].value : MT_ABSENT;
}

void mt_model_index_parameters(mt_model *model)
{
    mt_names *const table = &model->tables->parameters;
    bool taken = false;
    *table = (mt_names){0};
    for (int i = 0; i < model->n_parameters; i++) {
        const char *const name = model->parameters[i].name.s;
        if (name != NULL) {
            mt_names_add(table, &model->mem, name, i, &taken);
        }
    }
}

void mt_model_index_points(mt_model *model)
{
    mt_names *const table = &model->tables->points;
    bool taken = false;
    *table = (mt_names){0};
    for (int i = 0; i < model->n_points; i++) {
        const char *const name = model->points[i].name.s;
        if (name != NULL) {
            mt_names_add(table, &model->mem, name, i, &taken);
        }
    }
}
