/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/names.h"

#include <stdint.h>
#include <string.h>

/* FNV-1a, 32 bits, with its authors' offset basis and prime. */
static uint32_t hash(const char *s, size_t length)
{
    uint32_t h = 2166136261U;
    for (size_t i = 0; i < length; i++) {
        h = (h ^ (unsigned char)s[i]) * 16777619U;
    }
    return h;
}

/* The slot of a name: where it stands or would stand. */
static int slot_of(const mt_names *t, const char *name, size_t length)
{
    uint32_t at = hash(name, length) & (uint32_t)(t->size - 1);
    while (t->keys[at] != NULL &&
           !(strncmp(t->keys[at], name, length) == 0 && t->keys[at][length] == '\0')) {
        at = (at + 1) & (uint32_t)(t->size - 1);
    }
    return (int)at;
}

/* Without memory the table stays as it is. */
static bool grow(mt_names *t, mt_arena *mem)
{
    enum { FIRST = 32 };
    mt_names larger = {.size = t->size == 0 ? FIRST : 2 * t->size, .count = t->count};
    larger.keys = mt_arena_alloc(mem, (size_t)larger.size, sizeof *larger.keys);
    larger.values = mt_arena_int(mem, (size_t)larger.size);
    if (mt_arena_failed(mem)) {
        return false;
    }
    for (int i = 0; i < t->size; i++) {
        if (t->keys[i] != NULL) {
            const int at = slot_of(&larger, t->keys[i], strlen(t->keys[i]));
            larger.keys[at] = t->keys[i];
            larger.values[at] = t->values[i];
        }
    }
    *t = larger;
    return true;
}

void mt_names_add(mt_names *t, mt_arena *mem, const char *name, int value, bool *taken)
{
    *taken = false;
    if (2 * (t->count + 1) > t->size && !grow(t, mem)) {
        return;
    }
    const int at = slot_of(t, name, strlen(name));
    *taken = t->keys[at] != NULL;
    if (!*taken) {
        t->keys[at] = name;
        t->values[at] = value;
        t->count++;
    }
}

int mt_names_find(const mt_names *t, const char *name, size_t length, bool *found)
{
    *found = false;
    if (t->size == 0) {
        return MT_ABSENT;
    }
    const int at = slot_of(t, name, length);
    *found = t->keys[at] != NULL;
    return *found ? t->values[at] : MT_ABSENT;
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
