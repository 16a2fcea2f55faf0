/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "repeat": copies of items of a document, around an axis, along a line, behind a mirror. */
#include "model/repeat.h"

#include <math.h>
#include <string.h>

static const mt_key POLAR[] = {
    MT_M_JUST("axis", LIST, false, AXIS,
              "Three dimensions: direction of the axis that copies are turned about, three "
              "plain numbers. In two dimensions it is out of the plane.",
              .schema = MT_DIRECTION),
    MT_M_JUST("about", TEXT_OR_LIST, false, POINT,
              "Where the axis is: the name of a point, or coordinates. Absent: the origin.",
              .schema = "\"allOf\": [{" MT_I_OF("position") "}]"),
    MT_M_JUST(
        "angle_rad", NUMBER, false, ANY,
        "From one copy to the next, right-handed about the axis [rad]. Absent: a full turn "
        "divided by the count.",
        .examples = "[\"90*deg\"]"),
};
const mt_key_table mt_polar_keys = {
    .what = "polar", .keys = POLAR, .n = MT_COUNT(POLAR), .says = "Copies around an axis."};

static const mt_key LINEAR[] = {
    MT_M_JUST("step", LIST, true, POINT,
              "From one copy to the next, in the file's units of length.",
              .schema = "\"allOf\": [{" MT_I_OF("vector") "}]"),
};
const mt_key_table mt_linear_keys = {
    .what = "linear", .keys = LINEAR, .n = MT_COUNT(LINEAR), .says = "Copies along a line."};

static const char *const PLANES[] = {"xy", "xz", "yz"};
static const mt_key MIRROR[] = {
    MT_M_JUST("plane", TEXT, false, NONE,
              "The plane, by the two axes of the drawing that it contains (in two dimensions "
              "\"xz\" is the x axis, \"yz\" the y axis).",
              .choices = PLANES, .n_choices = MT_COUNT(PLANES)),
    MT_M_JUST("normal", LIST, false, AXIS,
              "Instead of plane: the direction across it, three plain numbers.",
              .schema = MT_DIRECTION),
    MT_M_JUST("about", TEXT_OR_LIST, false, POINT,
              "A position in the plane. Absent: the origin.",
              .schema = "\"allOf\": [{" MT_I_OF("position") "}]"),
};
const mt_key_table mt_mirror_keys = {.what = "mirror",
                                     .keys = MIRROR,
                                     .n = MT_COUNT(MIRROR),
                                     .one_of = 2,
                                     .says = "A copy on the other side of a plane."};

static const mt_key REPEAT[] = {
    MT_M_OBJECT("polar", mt_polar_keys),
    MT_M_OBJECT("linear", mt_linear_keys),
    MT_M_OBJECT("mirror", mt_mirror_keys),
    MT_M_JUST("of", LIST, true, NONE,
              "Names of what is copied: of points, bodies, links, joints, springs, dampers, "
              "loads, sensors; * stands for any letters. What they refer to among each other, "
              "the copies refer to among each other; anything else they share.",
              .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": "
                        "\"string\"}"),
    MT_M_JUST("kinds", LIST, false, NONE,
              "Which kinds of items the names mean. Absent: all that have such a name.",
              .choices = mt_copied_lists, .n_choices = MT_COUNT(mt_copied_lists)),
    MT_M_JUST("count", COUNT, false, WHOLE,
              "How many there are then, the first of them the item itself; not for a mirror.",
              .least = 2, .most = MT_EXPAND_COPIES),
    MT_M_JUST("suffix", TEXT, false, NONE,
              "What copies are called: name, suffix, number; of a mirror name, suffix.",
              .otherwise = "\"_\"", .examples = "[\"_\", \"_left\"]"),
    MT_M_DESCRIPTION,
};
const mt_key_table mt_repeat_keys = {
    .what = "repeat",
    .keys = REPEAT,
    .n = MT_COUNT(REPEAT),
    .one_of = 3,
    .says = "Copies of items, numbered from 2, since the first is the item itself: mount, "
            "mount_2, mount_3; mirrored: mount, mount_m."};

/* One repeat: what is copied, and how. */
typedef struct repeat {
    mt_object o;
    int count;
    const char *suffix;
    bool mirror;
    int n[MT_COPIED_LISTS];
    mt_addr *items[MT_COPIED_LISTS];
    mt_names own[MT_SPACES];
    mt_motion motion;
} repeat;

static bool means_kind(mt_maker *m, mt_addr kinds, int list)
{
    if (kinds == MT_NO_ADDR) {
        return true;
    }
    for (mt_items i = mt_reader_items(&m->r, kinds); mt_items_next(&i);) {
        if (mt_json_type_of(m->r.doc, i.at) == MT_JSON_STRING &&
            strcmp(mt_json_string(m->r.doc, i.at), mt_copied_lists[list]) == 0) {
            return true;
        }
    }
    return false;
}

static const char *name_of_item(const mt_maker *m, int list, mt_addr item)
{
    if (mt_space_of[list] == MT_OF_POINTS) {
        return mt_json_name(m->r.doc, item);
    }
    const mt_addr name = mt_json_member(m->r.doc, item, "name");
    return name != MT_NO_ADDR && mt_json_type_of(m->r.doc, name) == MT_JSON_STRING
               ? mt_json_string(m->r.doc, name)
               : NULL;
}

/* Add the items of a list that one of the names means; said[k] becomes true for that name. */
static void select_of(mt_maker *m, repeat *p, int list, const mt_name_list *of, bool *said)
{
    const mt_addr at = mt_json_member(m->r.doc, MT_JSON_ROOT, mt_copied_lists[list]);
    const mt_json_type wanted =
        mt_space_of[list] == MT_OF_POINTS ? MT_JSON_OBJECT : MT_JSON_ARRAY;
    if (at == MT_NO_ADDR || mt_json_type_of(m->r.doc, at) != wanted) {
        return;
    }
    mt_items items = mt_reader_items(&m->r, at);
    p->items[list] = mt_reader_room(&m->r, &items, sizeof *p->items[list]);
    while (mt_items_next(&items)) {
        const char *const name = name_of_item(m, list, items.at);
        bool meant = false;
        for (int k = 0; name != NULL && k < of->count; k++) {
            if (of->items[k].s != NULL && mt_text_matches(of->items[k].s, name)) {
                meant = true;
                said[k] = true;
            }
        }
        if (meant) {
            bool taken = false;
            p->items[list][p->n[list]++] = items.at;
            mt_names_add(&p->own[mt_space_of[list]], &m->mem, name, list, &taken);
        }
    }
}

static void select_items(mt_maker *m, repeat *p)
{
    const mt_addr kinds = mt_object_value(&p->o, "kinds");
    const mt_addr list = mt_object_value(&p->o, "of");
    const mt_name_list of = mt_reader_refs(&m->r, list);
    bool *const said = mt_arena_alloc(&m->mem, (size_t)of.count, sizeof *said);
    for (mt_items i = mt_reader_items(&m->r, kinds); mt_items_next(&i);) {
        (void)mt_reader_choice(&m->r, i.at, "kind", mt_copied_lists, MT_COPIED_LISTS);
    }
    if (list != MT_NO_ADDR && mt_reader_items(&m->r, list).count == 0) {
        mt_diag_structure(m->r.diags, list, "must not be empty");
    }
    for (int k = 0; k < MT_COPIED_LISTS && said != NULL; k++) {
        if (means_kind(m, kinds, k)) {
            select_of(m, p, k, &of, said);
        }
    }
    for (int k = 0; k < of.count && said != NULL; k++) {
        if (!said[k] && of.items[k].s != NULL) {
            mt_diag_error(m->r.diags, of.items[k].addr, "nothing is called \"%s\"",
                          of.items[k].s);
        }
    }
}

/* A repeat. */

static bool any_copy(const void *context, const char *list)
{
    const repeat *const p = context;
    for (int k = 0; k < MT_COPIED_LISTS; k++) {
        if (strcmp(mt_copied_lists[k], list) == 0) {
            return p->n[k] > 0;
        }
    }
    return false;
}

static void put_copies(mt_maker *m, void *context, const char *list)
{
    repeat *const p = context;
    const int line = mt_maker_line(m->r.doc, p->o.addr);
    int k = 0;
    while (strcmp(mt_copied_lists[k], list) != 0) {
        k++;
    }
    for (int number = 1; number < p->count && !mt_maker_is_full(m); number++) {
        mt_copy c = mt_copy_begin(m, 0, NULL);
        c.own = p->own;
        c.suffix =
            p->mirror ? p->suffix : mt_arena_printf(&m->mem, "%s%d", p->suffix, number + 1);
        mt_copy_move(&c, &p->motion, number);
        for (int i = 0; i < p->n[k] && !mt_maker_is_full(m) && c.suffix != NULL; i++) {
            const mt_addr item = p->items[k][i];
            const char *const name = name_of_item(m, k, item);
            c.note = mt_maker_note(
                m, p->mirror ? mt_arena_printf(&m->mem,
                                               "in the mirror image of \"%s\", line %d: repeat",
                                               name, line)
                             : mt_arena_printf(&m->mem, "in copy %d of \"%s\", line %d: repeat",
                                               number + 1, name, line));
            mt_copy_item(&c, list, item);
        }
    }
}

static void read_polar(mt_maker *m, repeat *p)
{
    mt_object o;
    p->motion.turns = true;
    if (!mt_object_match(&m->r, mt_object_value(&p->o, "polar"), &mt_polar_keys, &o)) {
        return;
    }
    const mt_addr angle = mt_object_value(&o, "angle_rad");
    (void)mt_read_axis(m, &o, "axis", p->motion.axis);
    (void)mt_read_place(m, mt_object_value(&o, "about"), p->motion.about);
    p->motion.angle = (mt_term){.v = p->count > 0 ? 2.0 * acos(-1.0) / p->count : 0.0};
    if (angle != MT_NO_ADDR) {
        (void)mt_read_own(m, angle, NULL, &p->motion.angle);
    }
}

static void read_mirror(mt_maker *m, repeat *p)
{
    static const double normals[][3] = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
    mt_object o;
    if (!mt_object_match(&m->r, mt_object_value(&p->o, "mirror"), &mt_mirror_keys, &o)) {
        return;
    }
    const mt_addr plane = mt_object_value(&o, "plane");
    const mt_addr normal = mt_object_value(&o, "normal");
    const int which = mt_object_one_of(&m->r, &o, "plane", 2);
    if (which == 0 && plane != MT_NO_ADDR) {
        const int k = mt_reader_choice(&m->r, plane, "plane", PLANES, MT_COUNT(PLANES));
        memcpy(p->motion.axis, normals[k == MT_ABSENT ? 0 : k], sizeof p->motion.axis);
        if (k == 0 && m->dimension == 2) {
            mt_diag_error(m->r.diags, plane, "in two dimensions the plane is \"xz\" or \"yz\"");
        }
    } else if (which == 1 && normal != MT_NO_ADDR &&
               mt_read_axis(m, &o, "normal", p->motion.axis) && m->dimension == 2 &&
               p->motion.axis[2] != 0.0) {
        mt_diag_error(m->r.diags, normal, "in two dimensions the third entry must be 0");
    }
    (void)mt_read_place(m, mt_object_value(&o, "about"), p->motion.about);
}

/* Returns false where it is wrong (noted). */
static bool read_repeat(mt_maker *m, mt_addr entry, repeat *p)
{
    const int errors = m->r.diags->errors;
    mt_object o;
    *p = (repeat){.count = 2, .suffix = "_"};
    if (!mt_object_match(&m->r, entry, &mt_repeat_keys, &p->o)) {
        return false;
    }
    const int which = mt_object_one_of(&m->r, &p->o, "polar", 3);
    const mt_addr suffix = mt_object_value(&p->o, "suffix");
    p->mirror = which == 2;
    p->motion.mirrors = p->mirror;
    if (p->mirror && mt_object_has(&m->r, &p->o, "count")) {
        mt_diag_error(m->r.diags, mt_object_place(&m->r, &p->o, "count"),
                      "a mirror has one image: leave out \"count\"");
    } else if (which != MT_ABSENT && !p->mirror && !mt_object_has(&m->r, &p->o, "count")) {
        mt_diag_error(m->r.diags, entry, "member \"count\" is missing");
    }
    p->count = mt_reader_count(&m->r, mt_object_value(&p->o, "count"), 2, MT_EXPAND_COPIES, 2);
    p->suffix = suffix != MT_NO_ADDR ? mt_json_string(m->r.doc, suffix)
                : p->mirror          ? "_m"
                                     : "_";
    if (p->mirror && *p->suffix == '\0') {
        mt_diag_error(m->r.diags, suffix,
                      "must not be empty: the image needs a name of its own");
    }
    if (which == 0) {
        read_polar(m, p);
    } else if (which == 1 &&
               mt_object_match(&m->r, mt_object_value(&p->o, "linear"), &mt_linear_keys, &o) &&
               mt_object_value(&o, "step") != MT_NO_ADDR) {
        (void)mt_read_place(m, mt_object_value(&o, "step"), p->motion.step);
    } else if (p->mirror) {
        read_mirror(m, p);
    }
    select_items(m, p);
    return m->r.diags->errors == errors;
}

/* The repeat of this index; the last one takes the list away. */
mt_status mt_expand_repeat(mt_json *doc, const char *path, mt_expansion *all, int index,
                           bool last, mt_err *err)
{
    mt_maker m;
    mt_names names = {0};
    repeat *p = NULL;
    mt_status rc = mt_maker_begin(&m, doc, path, all, 0, &names, err);
    if (rc == MT_OK) {
        p = mt_arena_alloc(&m.mem, 1, sizeof *p);
        rc = mt_arena_check(&m.mem, err);
    }
    if (rc == MT_OK) {
        mt_items items = mt_json_items(doc, mt_json_member(doc, MT_JSON_ROOT, "repeat"));
        for (int i = 0; i <= index; i++) {
            (void)mt_items_next(&items);
        }
        if (!read_repeat(&m, items.at, p)) {
            memset(p->n, 0, sizeof p->n);
        }
        const mt_addition what = {.context = p,
                                  .any = any_copy,
                                  .put = put_copies,
                                  .from = items.at,
                                  .drop = last ? "repeat" : NULL};
        rc = mt_maker_end(&m, &what, err);
    }
    mt_maker_finish(&m);
    return rc;
}
