/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the items of a model are made of: numbers, vectors, positions, names of bodies,
 * presence. */
#include "model/read_priv.h"

#include <string.h>

#include "io/reader.h"
#include "model/names.h"

mt_model_reader *mt_model_reader_of(mt_reader *r)
{
    return (mt_model_reader *)(void *)r;
}

/* Where the row's value goes. */
static void *place(const mt_key *key, void *item)
{
    return (char *)item + key->at;
}

/* And what belongs to it. */
static void *other(const mt_key *key, void *item)
{
    return (char *)item + key->other;
}

mt_num mt_read_num(mt_model_reader *mr, mt_addr value, mt_possible_id possible,
                   const mt_unit *unit)
{
    mt_expr expr;
    const mt_num num = mt_reader_expr_in(&mr->r, value, unit, &expr)
                           ? mt_model_add_num(mr->m, expr, value)
                           : MT_ABSENT;
    if (num != MT_ABSENT) {
        mr->m->nums[num].possible = possible;
    }
    return num;
}

static void wrong_length(mt_reader *r, mt_addr value, int count, int least, int most)
{
    if (least == most) {
        mt_diag_structure(r->diags, value, "must have %d entries, not %d", least, count);
    } else if (count < least && least == 1) {
        mt_diag_structure(r->diags, value, "must not be empty");
    } else {
        mt_diag_structure(r->diags, value, "must have %d to %d entries, not %d", least, most,
                          count);
    }
}

/* What a list of numbers may be. */
typedef struct list_form {
    bool single; /* or a number that stands for a list of one */
    int least;
    int most;
    mt_possible_id possible;
    const mt_unit *unit; /* NULL: SI */
} list_form;

static mt_num *read_nums(mt_model_reader *mr, mt_addr value, const list_form *form, int *n)
{
    *n = 0;
    if (!mt_reader_type(&mr->r, value, form->single ? MT_KEY_NUMBER_OR_LIST : MT_KEY_LIST)) {
        return NULL;
    }
    const bool is_list = mt_json_type_of(mr->r.doc, value) == MT_JSON_ARRAY;
    mt_items items = mt_reader_one_or_items(&mr->r, value);
    if (is_list && (items.count < form->least || items.count > form->most)) {
        wrong_length(&mr->r, value, items.count, form->least, form->most);
        return NULL;
    }
    mt_num *const nums = mt_reader_room(&mr->r, &items, sizeof *nums);
    while (mt_items_next(&items)) {
        nums[*n] = mt_read_num(mr, items.at, form->possible, form->unit);
        if (nums[*n] != MT_ABSENT) {
            mt_reader_check_kind(&mr->r, items.at, &mr->m->nums[nums[*n]].expr, form->unit);
        }
        ++*n;
    }
    return nums;
}

mt_num *mt_read_nums(mt_model_reader *mr, const mt_key *key, mt_addr value, int *n)
{
    const list_form form = {.single = key->type == MT_KEY_NUMBER_OR_LIST,
                            .least = key->least,
                            .most = key->most,
                            .possible = key->possible};
    return read_nums(mr, value, &form, n);
}

static void no_vector(mt_vector x)
{
    for (int k = 0; k < 3; k++) {
        x[k] = MT_ABSENT;
    }
}

/* As many numbers as the model has dimensions; false (all x absent) where absent or wrong. */
static bool read_vector(mt_model_reader *mr, mt_addr value, mt_possible_id possible,
                        const mt_unit *unit, mt_vector x)
{
    const list_form form = {.least = 2, .most = 3, .possible = possible, .unit = unit};
    int n = 0;
    no_vector(x);
    const mt_num *const nums = read_nums(mr, value, &form, &n);
    if (nums == NULL) {
        return false;
    }
    if (mr->m->dimension != 0 && n != mr->m->dimension) {
        mt_diag_error(mr->r.diags, value, "must have %d entries: the model has %d dimensions",
                      mr->m->dimension, mr->m->dimension);
        return false;
    }
    memcpy(x, nums, (size_t)n * sizeof *nums);
    return true;
}

void mt_read_coordinates(mt_model_reader *mr, mt_addr value, mt_vector x)
{
    (void)read_vector(mr, value, MT_POSSIBLE_NONE, mr->m->units[MT_LENGTH], x);
}

/* The name of a point, or coordinates. An absent one has point MT_ABSENT and given false. */
static mt_position read_position(mt_model_reader *mr, mt_addr value, mt_possible_id possible)
{
    mt_position p = {.point_name = {NULL, MT_NO_ADDR}, .point = MT_ABSENT, .addr = value};
    no_vector(p.x);
    if (!mt_reader_type(&mr->r, value, MT_KEY_TEXT_OR_LIST)) {
        return p;
    }
    if (mt_json_type_of(mr->r.doc, value) == MT_JSON_STRING) {
        p.point_name = mt_reader_ref(&mr->r, value);
        p.given = p.point_name.s != NULL;
    } else {
        p.given = read_vector(mr, value, possible, mr->m->units[MT_LENGTH], p.x);
    }
    return p;
}

static bool is_point(const mt_model_reader *mr, mt_addr value)
{
    const char *const s = mt_json_string(mr->r.doc, value);
    bool found = false;
    (void)mt_names_find(&mr->m->tables->points, s, strlen(s), &found);
    return found;
}

/* True where a list of two strings is one of two points, and not of two expressions. In three
 * dimensions only points can be meant. */
static bool names_two_points(mt_model_reader *mr, mt_addr list)
{
    mt_addr a;
    mt_addr b;
    (void)mt_reader_pair(&mr->r, list, &a, &b);
    const bool strings = mt_json_type_of(mr->r.doc, a) == MT_JSON_STRING &&
                         mt_json_type_of(mr->r.doc, b) == MT_JSON_STRING;
    if (!strings || mr->m->dimension == 3) {
        return strings;
    }
    const bool points = is_point(mr, a) && is_point(mr, b);
    const char *const x = mt_json_string(mr->r.doc, a);
    const char *const y = mt_json_string(mr->r.doc, b);
    if (points && mt_model_lookup(mr->m, x, strlen(x)) >= 0 &&
        mt_model_lookup(mr->m, y, strlen(y)) >= 0) {
        mt_diag_error(mr->r.diags, list,
                      "\"%s\" and \"%s\" are points and parameters: write coordinates as "
                      "[\"1*%s\", \"1*%s\"]",
                      x, y, x, y);
    }
    return points;
}

/* True where the list is a pair of positions, of which each may be a list of coordinates or the
 * name of a point. A list with such an entry that is no pair is noted. */
static bool is_pair(mt_model_reader *mr, mt_addr list, bool *wrong)
{
    mt_items items = mt_reader_items(&mr->r, list);
    const int count = items.count;
    bool lists = false;
    while (mt_items_next(&items)) {
        lists = lists || mt_json_type_of(mr->r.doc, items.at) == MT_JSON_ARRAY;
    }
    *wrong = lists && count != 2;
    if (*wrong) {
        mt_diag_structure(mr->r.diags, list, "must be a pair of positions, not %d", count);
    }
    return !*wrong && (lists || (count == 2 && names_two_points(mr, list)));
}

void mt_item_at(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_model_reader *const mr = mt_model_reader_of(r);
    mt_position *const at = place(key, item);
    int *const n = other(key, item);
    mt_addr ends[2] = {value, MT_NO_ADDR};
    bool wrong = false;
    const bool pair = value != MT_NO_ADDR && mt_json_type_of(r->doc, value) == MT_JSON_ARRAY &&
                      is_pair(mr, value, &wrong);
    if (pair) {
        (void)mt_reader_pair(r, value, &ends[0], &ends[1]);
    }
    at[0] = read_position(mr, wrong ? MT_NO_ADDR : ends[0],
                          pair ? MT_POSSIBLE_NONE : key->possible);
    at[1] = read_position(mr, ends[1], MT_POSSIBLE_NONE);
    *n = !at[0].given ? 0 : !pair ? 1 : at[1].given ? 2 : 0;
}

/* Two names; NULL where absent or wrong. */
static void read_two(mt_reader *r, mt_addr value, mt_name two[2])
{
    mt_addr ends[2] = {MT_NO_ADDR, MT_NO_ADDR};
    const int count = value == MT_NO_ADDR ? 2 : mt_reader_pair(r, value, &ends[0], &ends[1]);
    if (count != 2) {
        wrong_length(r, value, count, 2, 2);
    }
    for (int side = 0; side < 2; side++) {
        two[side] = mt_reader_ref(r, count == 2 ? ends[side] : MT_NO_ADDR);
    }
}

void mt_item_names(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    read_two(r, value, place(key, item));
}

void mt_item_bodies(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_attach *const bodies = place(key, item);
    mt_name two[2];
    read_two(r, value, two);
    for (int side = 0; side < 2; side++) {
        bodies[side] = (mt_attach){.name = two[side], .index = MT_GROUND, .element = MT_ABSENT};
    }
}

void mt_item_presence(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_presence *const in = place(key, item);
    *in = (mt_presence){.given = value != MT_NO_ADDR, .names = mt_reader_refs(r, value)};
}

void mt_item_name(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_name *)place(key, item) = mt_reader_name(r, value);
}

void mt_item_num(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_num *)place(key, item) =
        mt_read_num(mt_model_reader_of(r), value, key->possible, NULL);
}

void mt_item_nums(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_num **)place(key, item) =
        mt_read_nums(mt_model_reader_of(r), key, value, other(key, item));
}

void mt_item_vector(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(bool *)other(key, item) =
        read_vector(mt_model_reader_of(r), value, key->possible, NULL, place(key, item));
}

void mt_item_position(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_position *)place(key, item) =
        read_position(mt_model_reader_of(r), value, key->possible);
}

_Static_assert(offsetof(mt_named_mode, name) == 0 && offsetof(mt_configuration, name) == 0,
               "structs by name begin with it");

void mt_item_by_name(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    int *const n = other(key, item);
    mt_items items = mt_reader_items(r, object);
    char *const room = mt_reader_room(r, &items, key->of->size);
    while (mt_items_next(&items)) {
        void *const one = room + ((size_t)*n * key->of->size);
        (void)mt_members_read(r, items.at, key->of, one);
        *(mt_name *)one = mt_reader_member_name(r, items.at, (mt_name_form)key->least);
        ++*n;
    }
    memcpy(place(key, item), &room, sizeof room);
}
