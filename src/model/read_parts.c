/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the items of a model are made of: numbers, vectors, positions, names of bodies,
 * presence. */
#include "model/read_priv.h"

#include <string.h>

#include "io/reader.h"
#include "model/names.h"

mt_num mt_read_num_in(mt_model_reader *mr, mt_addr value, const mt_unit *unit)
{
    mt_expr expr;
    const mt_num num = mt_reader_expr_in(&mr->r, value, unit, &expr)
                           ? mt_model_add_num(mr->m, expr, value)
                           : MT_ABSENT;
    if (num != MT_ABSENT) {
        mr->m->nums[num].possible = mt_reader_possible(&mr->r, value);
    }
    return num;
}

mt_num mt_read_num(mt_model_reader *mr, mt_addr value)
{
    return mt_read_num_in(mr, value, NULL);
}

static void wrong_length(mt_model_reader *mr, mt_addr value, int count, int least, int most)
{
    if (least == most) {
        mt_diag_structure(mr->r.diags, value, "must have %d entries, not %d", least, count);
    } else if (count < least && least == 1) {
        mt_diag_structure(mr->r.diags, value, "must not be empty");
    } else {
        mt_diag_structure(mr->r.diags, value, "must have %d to %d entries, not %d", least, most,
                          count);
    }
}

static mt_num *read_nums(mt_model_reader *mr, mt_addr value, bool single, const int limits[2],
                         const mt_unit *unit, int *n)
{
    *n = 0;
    if (!mt_reader_type(&mr->r, value, single ? MT_KEY_NUMBER_OR_LIST : MT_KEY_LIST)) {
        return NULL;
    }
    const bool is_list = mt_json_type_of(mr->r.doc, value) == MT_JSON_ARRAY;
    mt_items items = mt_reader_one_or_items(&mr->r, value);
    if (is_list && (items.count < limits[0] || items.count > limits[1])) {
        wrong_length(mr, value, items.count, limits[0], limits[1]);
        return NULL;
    }
    mt_num *const nums = mt_reader_room(&mr->r, &items, sizeof *nums);
    const mt_possible_id possible = mt_reader_possible(&mr->r, value);
    while (mt_items_next(&items)) {
        nums[*n] = mt_read_num_in(mr, items.at, unit);
        if (nums[*n] != MT_ABSENT) {
            mr->m->nums[nums[*n]].possible = possible;
            mt_reader_check_kind(&mr->r, items.at, &mr->m->nums[nums[*n]].expr, unit);
        }
        ++*n;
    }
    return nums;
}

mt_num *mt_read_nums(mt_model_reader *mr, mt_addr value, bool single, int least, int most,
                     int *n)
{
    return read_nums(mr, value, single, (const int[]){least, most}, NULL, n);
}

static void no_vector(mt_num x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = MT_ABSENT;
    }
}

static bool read_vector(mt_model_reader *mr, mt_addr value, const mt_unit *unit, mt_num x[3])
{
    int n = 0;
    no_vector(x);
    const mt_num *const nums = read_nums(mr, value, false, (const int[]){2, 3}, unit, &n);
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

bool mt_read_vector(mt_model_reader *mr, mt_addr value, mt_num x[3])
{
    return read_vector(mr, value, NULL, x);
}

bool mt_read_coordinates(mt_model_reader *mr, mt_addr value, mt_num x[3])
{
    return read_vector(mr, value, mr->m->units[MT_LENGTH], x);
}

mt_position mt_read_position(mt_model_reader *mr, mt_addr value)
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
        p.given = mt_read_coordinates(mr, value, p.x);
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

int mt_read_at(mt_model_reader *mr, mt_addr value, mt_position at[2])
{
    at[0] = mt_read_position(mr, MT_NO_ADDR);
    at[1] = at[0];
    if (!mt_reader_type(&mr->r, value, MT_KEY_TEXT_OR_LIST)) {
        return 0;
    }
    bool pair = false;
    if (mt_json_type_of(mr->r.doc, value) == MT_JSON_ARRAY) {
        mt_items items = mt_reader_items(&mr->r, value);
        const int count = items.count;
        while (mt_items_next(&items)) {
            pair = pair || mt_json_type_of(mr->r.doc, items.at) == MT_JSON_ARRAY;
        }
        if (pair && count != 2) {
            mt_diag_structure(mr->r.diags, value, "must be a pair of positions, not %d", count);
            return 0;
        }
        pair = pair || (count == 2 && names_two_points(mr, value));
    }
    if (!pair) {
        at[0] = mt_read_position(mr, value);
        return at[0].given ? 1 : 0;
    }
    mt_addr ends[2];
    (void)mt_reader_pair(&mr->r, value, &ends[0], &ends[1]);
    at[0] = mt_read_position(mr, ends[0]);
    at[1] = mt_read_position(mr, ends[1]);
    return at[0].given && at[1].given ? 2 : 0;
}

void mt_read_bodies(mt_model_reader *mr, mt_addr value, mt_attach bodies[2])
{
    for (int side = 0; side < 2; side++) {
        bodies[side] =
            (mt_attach){.name = {NULL, MT_NO_ADDR}, .index = MT_GROUND, .element = MT_ABSENT};
    }
    if (!mt_reader_type(&mr->r, value, MT_KEY_LIST)) {
        return;
    }
    mt_addr ends[2];
    const int count = mt_reader_pair(&mr->r, value, &ends[0], &ends[1]);
    if (count != 2) {
        wrong_length(mr, value, count, 2, 2);
        return;
    }
    bodies[0].name = mt_reader_ref(&mr->r, ends[0]);
    bodies[1].name = mt_reader_ref(&mr->r, ends[1]);
}

mt_presence mt_read_presence(mt_model_reader *mr, mt_addr value)
{
    mt_presence in = {0};
    if (mt_reader_type(&mr->r, value, MT_KEY_LIST)) {
        in.given = true;
        in.names = mt_reader_refs(&mr->r, value);
    }
    return in;
}
