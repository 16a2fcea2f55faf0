/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the items of a model are made of: numbers, vectors, positions, attachments, presence;
 * how they are read by rows of tables, and how their names are resolved. */
#include "model/item.h"

#include <limits.h>
#include <stdarg.h>
#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "io/reader.h"
#include "model/model.h"

const char *const mt_origin_names[] = {"published", "identified", "assumed"};

mt_model_reader *mt_model_reader_of(mt_reader *r)
{
    return (mt_model_reader *)(void *)r;
}

/* Where the row's value goes. */
static void *place_of_value(const mt_key *key, void *item)
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
        const bool here = mt_json_file(mr->r.doc, items.at) == NULL;
        if (nums[*n] != MT_ABSENT && here) { /* an included file has units of its own */
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
    mt_position *const at = place_of_value(key, item);
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

void mt_item_names(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    char *const first = place_of_value(key, item);
    mt_addr ends[2] = {MT_NO_ADDR, MT_NO_ADDR};
    const int count = value == MT_NO_ADDR ? 2 : mt_reader_pair(r, value, &ends[0], &ends[1]);
    if (count != 2) {
        wrong_length(r, value, count, 2, 2);
    }
    for (size_t side = 0; side < 2; side++) {
        mt_name *const name = (mt_name *)(void *)(first + (side * key->other));
        *name = mt_reader_ref(r, count == 2 ? ends[side] : MT_NO_ADDR);
    }
}

void mt_item_presence(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_presence *const in = place_of_value(key, item);
    *in = (mt_presence){.given = value != MT_NO_ADDR, .names = mt_reader_refs(r, value)};
}

void mt_item_name(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_name *)place_of_value(key, item) = mt_reader_name(r, value);
}

void mt_item_num(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_num *)place_of_value(key, item) =
        mt_read_num(mt_model_reader_of(r), value, key->possible, NULL);
}

void mt_item_nums(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_num **)place_of_value(key, item) =
        mt_read_nums(mt_model_reader_of(r), key, value, other(key, item));
}

void mt_item_loss(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_model_reader *const mr = mt_model_reader_of(r);
    mt_loss *const loss = place_of_value(key, item);
    const int wanted = mr->m->dimension == 2 ? 3 : 6;
    int n = 0;
    mt_num *const nums = mt_read_nums(mr, key, value, &n);
    *loss = (mt_loss){.all = MT_ABSENT};
    if (n == 1) {
        loss->all = nums[0];
    } else if (n > 0 && n != wanted) {
        mt_diag_error(r->diags, value, "must be one number, or %s, not %d",
                      wanted == 3 ? "three: along x, along y, about z"
                                  : "six: along its three axes, about its three axes",
                      n);
    } else {
        loss->n = n;
        loss->each = nums;
    }
}

void mt_item_vector(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(bool *)other(key, item) = read_vector(mt_model_reader_of(r), value, key->possible, NULL,
                                            place_of_value(key, item));
}

void mt_item_position(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    *(mt_position *)place_of_value(key, item) =
        read_position(mt_model_reader_of(r), value, key->possible);
}

/* Resolved: names, positions, presence; circles. */

mt_addr mt_resolve_addr(const mt_model *m, mt_num num)
{
    return num == MT_ABSENT ? MT_NO_ADDR : m->nums[num].addr;
}

/* Error: unknown `what` "x", with the nearest name of the table or of `more`. */
static void resolve_unknown(mt_resolve *f, mt_name name, const mt_names *table,
                            const char *what, const char *const *more, int n_more)
{
    if (!mt_diag_may_suggest(f->d)) {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"", what, name.s);
        return;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&f->m->mem);
    const char **const names =
        mt_arena_alloc(&f->m->mem, (size_t)table->count + (size_t)n_more, sizeof *names);
    if (names == NULL) {
        return;
    }
    int n = 0;
    for (int i = 0; i < n_more; i++) {
        names[n++] = more[i];
    }
    for (int i = 0; i < table->count; i++) {
        names[n++] = table->items[i].name;
    }
    const char *const near = mt_text_nearest(name.s, names, n);
    mt_arena_rewind(&f->m->mem, mark);
    if (near != NULL) {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"; did you mean \"%s\"?", what, name.s,
                      near);
    } else {
        mt_diag_error(f->d, name.addr, "unknown %s \"%s\"", what, name.s);
    }
}

/* Axes of an item's own. */

static void axes_defaults(void *item, mt_addr addr, int which)
{
    mt_axes *const a = item;
    (void)which;
    a->given = addr != MT_NO_ADDR;
    a->addr = addr;
}

/* Axes that could not be read are not checked. */
static void axes_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_axes *const a = item;
    (void)which;
    a->given = a->given && !mt_object_wrong(r, o);
}

#define THIS mt_axes
static const mt_key AXES[] = {
    MT_I_VECTOR("x", x, has_x, AXIS, "Direction of the first axis, of any length."),
    MT_I_VECTOR(
        "y", y, has_y, AXIS,
        "Three dimensions, with x: a direction in the plane of the first and the second "
        "axis, on the second's side: what of it lies along x does not count."),
    MT_I_VECTOR("z", z, has_z, AXIS,
                "Three dimensions, instead of y: a direction in the plane of the first and the "
                "third axis, on the third's side."),
    MT_I_NUMS("angles_rad", NUMBER_OR_LIST, angles, n_angles, ANY, 1, 3,
              "Instead of vectors: [a, b, c] turns the drawing's axes about its x by a, then "
              "about its y by b, then about its z by c [rad] (the same as about z by c, then "
              "about the new y by b, then about the new x by a: yaw, pitch, roll). In two "
              "dimensions one angle, counter-clockwise.",
              .examples = "[[\"-40*deg\", 0, 0]]"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_axes_keys = {
    MT_I_TABLE("axes", AXES, mt_axes), .defaults = axes_defaults, .finish = axes_finish,
    .says =
        "Axes of its own, right-handed and at right angles, in the reference position: two "
        "vectors, x with y or z, or angles; in two dimensions x alone, or one angle. Absent: "
        "the drawing's.",
    .examples = "[{\"x\": [1, 0, 1], \"y\": [0, 1, 0]}]"};

void mt_resolve_axes(mt_resolve *f, mt_name name, const char *what, const mt_axes *a)
{
    const bool two = f->m->dimension == 2;
    const int vectors = (a->has_x ? 1 : 0) + (a->has_y ? 1 : 0) + (a->has_z ? 1 : 0);
    if (!a->given) {
        return;
    }
    if (a->n_angles > 0 ? vectors > 0 : !a->has_x || vectors != (two ? 1 : 2)) {
        mt_diag_error(f->d, a->addr, "axes of %s \"%s\" need %s, or \"angles_rad\"", what,
                      name.s,
                      two ? "\"x\" alone: the model has two dimensions"
                          : "two vectors: \"x\", and \"y\" or \"z\"");
    } else if (a->n_angles > 0 && a->n_angles != (two ? 1 : 3)) {
        mt_diag_error(
            f->d, a->addr,
            "axes of %s \"%s\": \"angles_rad\" must be %s: the model has %d dimensions", what,
            name.s, two ? "one angle" : "three angles", f->m->dimension);
    }
}

int mt_resolve_find(mt_resolve *f, mt_name name, const mt_names *table, const char *what)
{
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    bool found = false;
    const int i = mt_names_find(table, name.s, strlen(name.s), &found);
    if (!found) {
        resolve_unknown(f, name, table, what, NULL, 0);
    }
    return i;
}

void mt_resolve_position(mt_resolve *f, mt_position *p)
{
    p->point = mt_resolve_find(f, p->point_name, &f->m->tables->points, "point");
}

static const mt_num *coordinates(const mt_model *m, const mt_position *p)
{
    return p->point == MT_ABSENT ? p->x : m->points[p->point].x;
}

static bool same_number(const mt_model *m, mt_num a, mt_num b)
{
    if (a == b || a == MT_ABSENT || b == MT_ABSENT) {
        return a == b;
    }
    const mt_expr *const x = &m->nums[a].expr;
    const mt_expr *const y = &m->nums[b].expr;
    bool same = x->length == y->length;
    for (int i = 0; i < x->length && same; i++) {
        const mt_code *const p = &x->code[i];
        const mt_code *const q = &y->code[i];
        same = p->op == q->op && (p->op != MT_OP_PARAM || p->param == q->param) &&
               (p->op != MT_OP_CONST || !(p->value < q->value || p->value > q->value)) &&
               (p->op != MT_OP_INTERP || p->curve == q->curve);
    }
    return same;
}

bool mt_resolve_same_position(const mt_model *m, const mt_position *a, const mt_position *b)
{
    const mt_num *const x = coordinates(m, a);
    const mt_num *const y = coordinates(m, b);
    return same_number(m, x[0], y[0]) && same_number(m, x[1], y[1]) &&
           same_number(m, x[2], y[2]);
}

void mt_resolve_needs(mt_resolve *f, mt_name item, const char *what, const mt_presence *in,
                      const mt_presence *part, const char *part_what, const char *part_name)
{
    for (int c = 0; c < f->m->n_configurations; c++) {
        if (mt_model_present(in, c) && !mt_model_present(part, c)) {
            mt_diag_error(f->d, item.addr,
                          "%s \"%s\" is in configuration \"%s\", but its %s \"%s\" is not",
                          what, item.s, f->m->configurations[c].name.s, part_what, part_name);
            return; /* one configuration is enough to say so */
        }
    }
}

void mt_resolve_ring_add(mt_resolve_ring *ring, const char *name)
{
    if (ring->count < MT_RING_FIRST) {
        ring->start[ring->count] = name;
    } else {
        ring->last[ring->count % MT_RING_LAST] = name;
    }
    ring->count++;
}

MT_PRINTF(3, 4)
static void ring_write(mt_resolve_ring *ring, size_t *length, const char *fmt, ...)
{
    const size_t left = sizeof ring->text - *length;
    va_list args;
    va_start(args, fmt);
    const int n = mt_vsnprintf(ring->text + *length, left, fmt, args);
    va_end(args);
    *length += n < 0 ? 0 : (size_t)n < left ? (size_t)n : left - 1;
}

static void ring_name(mt_resolve_ring *ring, size_t *length, const char *arrow,
                      const char *name)
{
    ring_write(ring, length, "%s%.*s%s", arrow, (int)MT_RING_NAME, name,
               strlen(name) > MT_RING_NAME ? "..." : "");
}

void mt_resolve_ring_end(mt_resolve_ring *ring)
{
    static const char arrow[] = " -> ";
    const int end = MT_RING_FIRST + MT_RING_LAST;
    size_t length = 0;
    ring_name(ring, &length, "", ring->first);
    for (int i = 0; i < ring->count && i < MT_RING_FIRST; i++) {
        ring_name(ring, &length, arrow, ring->start[i]);
    }
    if (ring->count > end) {
        ring_write(ring, &length, "%s(%d more)", arrow, ring->count - end);
    }
    for (int i = ring->count > end ? ring->count - MT_RING_LAST : MT_RING_FIRST;
         i < ring->count; i++) {
        ring_name(ring, &length, arrow, ring->last[i % MT_RING_LAST]);
    }
    ring_name(ring, &length, arrow, ring->first);
}

/* What joints, springs and sensors hold on to: "ground", a body, "link.start", "link.end",
 * "link.node3", "link.3". */

/* The number written in s, 0 or more without leading zeros; -1: not a number. */
static int whole_number(const char *s)
{
    int n = 0;
    if (*s == '\0' || (s[0] == '0' && s[1] != '\0')) {
        return -1;
    }
    for (; *s != '\0'; s++) {
        if (*s < '0' || *s > '9' || n > (INT_MAX - 9) / 10) {
            return -1;
        }
        n = 10 * n + (*s - '0');
    }
    return n;
}

/* "start", "end", "3", "node3"; false for any other part. Elements count from 1, nodes from
 * 0. */
static bool read_part(mt_attach *a, const mt_link *l, const char *part)
{
    static const char node[] = "node";
    const bool beam = l->kind == MT_LINK_BEAM;
    const int last = beam ? l->elements : l->elements - 1;
    if (strcmp(part, "start") == 0) {
        a->kind = MT_ATTACH_LINK_START;
        a->part = 0;
        return true;
    }
    if (strcmp(part, "end") == 0) {
        a->kind = MT_ATTACH_LINK_END;
        a->part = last;
        return true;
    }
    if (strncmp(part, node, sizeof node - 1) == 0) {
        a->kind = MT_ATTACH_LINK_NODE;
        a->element = whole_number(part + sizeof node - 1);
        /* the element that ends there */
        a->part = beam || a->element == 0 ? a->element : a->element - 1;
        return a->element >= 0 && a->element <= l->elements;
    }
    a->kind = MT_ATTACH_LINK_ELEMENT;
    a->element = whole_number(part) - 1;
    a->part = a->element;
    return !beam && a->element >= 0 && a->element <= last;
}

/* Part of a link behind the dot. */
static void attach_link(mt_resolve *f, mt_attach *a, int link, const char *part)
{
    const mt_link *const l = &f->m->links[link];
    a->index = link;
    if (read_part(a, l, part) || l->elements == 0) {
        return; /* or the link could not be read */
    }
    if (l->kind == MT_LINK_BEAM) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\": beam link \"%s\" has \"start\", \"end\" and the nodes node0 to "
                      "node%d",
                      a->name.s, l->name.s, l->elements);
    } else {
        mt_diag_error(
            f->d, a->name.addr,
            "\"%s\": link \"%s\" has \"start\", \"end\", the elements 1 to %d and the "
            "nodes node0 to node%d",
            a->name.s, l->name.s, l->elements, l->elements);
    }
}

/* True for other common names of the ground. */
static bool is_ground(const char *word)
{
    static const char *const words[] = {"world", "World",    "base",  "Base",
                                        "frame", "Frame",    "earth", "chassis",
                                        "fixed", "inertial", "wall",  "0"};
    for (int i = 0; i < MT_COUNT(words); i++) {
        if (strcmp(word, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

void mt_resolve_attach(mt_resolve *f, mt_attach *a)
{
    const mt_names *const table = &f->m->tables->bodies;
    const char *const s = a->name.s;
    a->kind = MT_ATTACH_GROUND;
    a->index = MT_GROUND;
    a->element = MT_ABSENT;
    a->part = 0;
    if (s == NULL || strcmp(s, "ground") == 0) {
        return;
    }
    bool found = false;
    const char *const dot = strchr(s, '.');
    const size_t length = dot == NULL ? strlen(s) : (size_t)(dot - s);
    const int i = mt_names_find(table, s, length, &found);
    if (!found) {
        static const char *const more[] = {"ground"};
        const char *const stem = mt_arena_strndup(&f->m->mem, s, length);
        const mt_name name = {.s = stem, .addr = a->name.addr};
        if (stem != NULL && dot == NULL && is_ground(stem)) {
            mt_diag_error(f->d, name.addr, "unknown body \"%s\"; did you mean \"ground\"?",
                          stem);
        } else if (stem != NULL) {
            resolve_unknown(f, name, table, dot == NULL ? "body" : "link", more,
                            dot == NULL ? 1 : 0);
        }
    } else if (i >= 0 && dot == NULL) {
        a->kind = MT_ATTACH_BODY;
        a->index = i;
    } else if (i >= 0) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\": \"%.*s\" is a body, not a link: it has no parts", s, (int)length,
                      s);
    } else if (dot == NULL) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\" is a link: write \"%s.start\", \"%s.end\" or one of its %s", s, s,
                      s, f->m->links[-1 - i].kind == MT_LINK_BEAM ? "nodes" : "elements");
    } else {
        attach_link(f, a, -1 - i, dot + 1);
    }
}

bool mt_resolve_same_attach(const mt_attach *a, const mt_attach *b)
{
    if (a->name.s == NULL || b->name.s == NULL) {
        return false;
    }
    if (a->kind == MT_ATTACH_GROUND || b->kind == MT_ATTACH_GROUND) {
        return strcmp(a->name.s, b->name.s) == 0; /* an unknown name counts as ground as well */
    }
    /* "l.start" and "l.1" are one rigid element */
    return (a->kind == MT_ATTACH_BODY) == (b->kind == MT_ATTACH_BODY) && a->index == b->index &&
           a->part == b->part;
}

bool mt_resolve_is_point_mass(const mt_resolve *f, const mt_attach *a)
{
    return a->kind == MT_ATTACH_BODY && f->m->bodies[a->index].point_mass;
}

void mt_resolve_needs_attach(mt_resolve *f, mt_name item, const char *what,
                             const mt_presence *in, const mt_attach *part)
{
    switch (part->kind) {
    case MT_ATTACH_GROUND:
        return;
    case MT_ATTACH_BODY:
        mt_resolve_needs(f, item, what, in, &f->m->bodies[part->index].in, "body",
                         f->m->bodies[part->index].name.s);
        return;
    case MT_ATTACH_LINK_START:
    case MT_ATTACH_LINK_END:
    case MT_ATTACH_LINK_ELEMENT:
    case MT_ATTACH_LINK_NODE:
        mt_resolve_needs(f, item, what, in, &f->m->links[part->index].in, "link",
                         f->m->links[part->index].name.s);
        return;
    }
}
