/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/members.h"

#include <string.h>

#include "base/text.h"

bool mt_object_match(mt_reader *r, mt_addr value, const mt_key_table *table, mt_object *out)
{
    out->addr = value;
    out->table = table;
    out->errors = r->diags->errors;
    memset(out->read, 0, sizeof out->read);
    return mt_reader_object(r, value, table, out->found);
}

/* The index of a member in the table, which has it. */
static int key_index(const mt_object *o, const char *member)
{
    int k = 0;
    while (k + 1 < o->table->n && strcmp(o->table->keys[k].name, member) != 0) {
        k++;
    }
    return k;
}

mt_addr mt_object_value(const mt_object *o, const char *member)
{
    return o->found[key_index(o, member)];
}

bool mt_object_has(const mt_reader *r, const mt_object *o, const char *member)
{
    return mt_json_member(r->doc, o->addr, member) != MT_NO_ADDR;
}

bool mt_object_wrong(const mt_reader *r, const mt_object *o)
{
    return r->diags->errors > o->errors;
}

mt_addr mt_object_place(const mt_reader *r, const mt_object *o, const char *member)
{
    return mt_diag_member(r->diags, o->addr, member);
}

/* "a", "b" or "c" */
static void list_keys(const mt_key *keys, int n, mt_text *out)
{
    for (int i = 0; i < n; i++) {
        const char *const between = i == 0 ? "" : i == n - 1 ? " or " : ", ";
        mt_text_addf(out, "%s\"%s\"", between, keys[i].name);
    }
}

int mt_object_one_of(mt_reader *r, const mt_object *o, const char *first, int n)
{
    const mt_key *const keys = &o->table->keys[key_index(o, first)];
    int which = MT_ABSENT;
    for (int k = 0; k < n; k++) {
        const mt_addr at = mt_json_member(r->doc, o->addr, keys[k].name);
        if (at != MT_NO_ADDR && which != MT_ABSENT) {
            mt_diag_structure(r->diags, mt_json_name_addr(r->doc, at), "\"%s\" excludes \"%s\"",
                              keys[k].name, keys[which].name);
            return MT_ABSENT;
        }
        which = at == MT_NO_ADDR ? which : k;
    }
    if (which == MT_ABSENT) {
        mt_text names = {0};
        list_keys(keys, n, &names);
        if (names.failed) {
            mt_arena_fail(r->mem);
        } else {
            mt_diag_structure(r->diags, o->addr, "one of %s is missing", names.s);
        }
        mt_text_free(&names);
    }
    return which;
}

void mt_object_leave_out(mt_object *o, const char *first, int n)
{
    const int begin = key_index(o, first);
    for (int k = begin; k < begin + n; k++) {
        o->found[k] = MT_NO_ADDR;
    }
}

static void read_row(mt_reader *r, const mt_object *o, int k, void *item)
{
    const mt_key *const key = &o->table->keys[k];
    if (key->read != NULL && (o->found[k] != MT_NO_ADDR || o->table->absent)) {
        key->read(r, key, o->found[k], item);
    }
}

void mt_object_read_first(mt_reader *r, mt_object *o, const char *member, void *item)
{
    const int k = key_index(o, member);
    read_row(r, o, k, item);
    o->read[k] = true;
}

void mt_object_read(mt_reader *r, const mt_object *o, void *item)
{
    for (int k = 0; k < o->table->n; k++) {
        if (!o->read[k]) {
            read_row(r, o, k, item);
        }
    }
}

bool mt_members_read(mt_reader *r, mt_addr value, const mt_key_table *table, void *item)
{
    mt_object o;
    int which = 0;
    if (!mt_object_match(r, value, table, &o) && !table->absent) {
        return false;
    }
    if (table->absent && table->size > 0) {
        memset(item, 0, table->size);
    }
    if (table->one_of > 0) {
        which = mt_object_one_of(r, &o, table->keys[0].name, table->one_of);
    }
    if (table->defaults != NULL) {
        table->defaults(item, value, which);
    }
    if (table->check != NULL) {
        table->check(r, &o);
    }
    mt_object_read(r, &o, item);
    if (table->finish != NULL) {
        table->finish(r, &o, which, item);
    }
    return which != MT_ABSENT;
}

/* Where the row's value goes. */
static void *place(const mt_key *key, void *item)
{
    return (char *)item + key->at;
}

void mt_read_text(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(const char **)place(key, item) = mt_reader_text(r, value);
}

void mt_read_ref(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_name *)place(key, item) = mt_reader_ref(r, value);
}

void mt_read_refs(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_name_list *)place(key, item) = mt_reader_refs(r, value);
}

void mt_read_flag(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    bool *const at = place(key, item);
    *at = mt_reader_flag(r, value, *at);
}

void mt_read_value(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const at = place(key, item);
    *at = mt_json_number(r->doc, value);
    mt_reader_check_range(r, value, value, *at);
}

void mt_read_accepted(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    (void)key;
    (void)item;
    r->accepted = mt_reader_accepted(r, value);
}

void mt_read_count(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    int *const at = place(key, item);
    *at = mt_reader_count(r, value, key->least, key->most, *at);
}

void mt_read_long(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    long *const at = place(key, item);
    *at = mt_reader_count(r, value, key->least, key->most, (int)*at);
}

void mt_read_ulong(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    unsigned long *const at = place(key, item);
    *at = (unsigned long)mt_reader_count(r, value, key->least, key->most, (int)*at);
}

void mt_read_choice(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const int which = mt_reader_choice(r, value, key->what, key->choices, key->n_choices);
    const int is = key->least + which;
    if (which != MT_ABSENT) { /* the enums of C11 here are int or unsigned, of one size */
        memcpy(place(key, item), &is, sizeof is);
    }
}

void mt_read_inner(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    (void)mt_members_read(r, value, key->of, place(key, item));
}

/* Items by their table, in `room` for all of them. */
static void read_all(mt_reader *r, mt_items items, const mt_key_table *of, char *room, int *n)
{
    while (mt_items_next(&items)) {
        *n += mt_members_read(r, items.at, of, room + ((size_t)*n * of->size)) ? 1 : 0;
    }
}

/* The items of a list, or the only one without it. */
static mt_items items_of(mt_reader *r, mt_addr list, const char *what)
{
    const bool may_be_empty =
        what == NULL || list == MT_NO_ADDR || mt_json_type_of(r->doc, list) != MT_JSON_ARRAY;
    return may_be_empty ? mt_reader_one_or_items(r, list) : mt_reader_some_items(r, list, what);
}

void *mt_members_list(mt_reader *r, mt_addr list, const char *what, const mt_key_table *of,
                      int *n)
{
    mt_items items = items_of(r, list, what);
    char *const room = mt_reader_room(r, &items, of->size);
    read_all(r, items, of, room, n);
    return room;
}

void mt_read_items(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    int *const n = (int *)(void *)((char *)item + key->other);
    mt_items items = items_of(r, value, key->what);
    char *const list = mt_reader_room(r, &items, key->of->size);
    /* known to the readers of items, which may look at the ones before theirs */
    memcpy(place(key, item), &list, sizeof list);
    read_all(r, items, key->of, list, n);
}
