/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "include": sub-assemblies from other files; and what is written out, in order. */
#include "model/expand.h"

#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "model/copy.h"
#include "model/repeat.h"

static const mt_key ROTATE[] = {
    MT_M_JUST("axis", LIST, false, AXIS,
              "Three dimensions: direction of the axis, three plain numbers.",
              .schema = MT_DIRECTION),
    MT_M_JUST("angle_rad", NUMBER, true, ANY, "How far, right-handed about the axis [rad].",
              .examples = "[\"90*deg\"]"),
};
const mt_key_table mt_rotate_keys = {.what = "rotate",
                                     .keys = ROTATE,
                                     .n = MT_COUNT(ROTATE),
                                     .says = "Turned about an axis through its origin."};

static const mt_key INCLUDE[] = {
    MT_M_JUST("file", TEXT, true, NONE, "A model file, seen from the folder of this one."),
    MT_M_JUST("prefix", TEXT, true, NONE,
              "What the names of its items, parameters and curves begin with here: a letter or "
              "_, then letters, digits and _.",
              .pattern = "^[A-Za-z_][A-Za-z0-9_]*$"),
    MT_M_JUST("at", TEXT_OR_LIST, false, POINT,
              "Where its origin is: the name of a point, or coordinates. Absent: the origin.",
              .schema = "\"allOf\": [{" MT_I_OF("position") "}]"),
    MT_M_OBJECT("rotate", mt_rotate_keys),
    MT_M_JUST("parameters", OBJECT, false, ANY,
              "Values of its parameters, by their names there: numbers, in the unit that the "
              "parameter has there, or expressions of this model's parameters.",
              .schema = MT_I_BY_NAME(MT_I_NAMES_WORD, MT_I_OF("number"))),
    MT_M_JUST("ground", TEXT, false, NONE,
              "The body or part of a link that its \"ground\" is. Absent: the ground."),
    MT_M_DESCRIPTION,
};
const mt_key_table mt_include_keys = {
    .what = "include",
    .keys = INCLUDE,
    .n = MT_COUNT(INCLUDE),
    .says = "A sub-assembly: the parameters, curves, points, bodies, links, joints, springs, "
            "dampers, loads and sensors of another model file, in that file's units. Its "
            "gravity, damping, modes and configurations are for itself alone."};

/* Includes. */

static int dimension_of(const mt_json *doc)
{
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, "dimension");
    const double n = at == MT_NO_ADDR ? 0.0 : mt_json_number(doc, at);
    return n == 2.0 ? 2 : n == 3.0 ? 3 : 0;
}

typedef struct sub {
    mt_copy c;
    bool used; /* false: it could not be read */
} sub;

typedef struct sub_list {
    int n;
    sub *items;
} sub_list;

static bool any_sub(const void *context, const char *list)
{
    const sub_list *const subs = context;
    bool any = false;
    for (int i = 0; i < subs->n; i++) {
        const mt_json *const doc = subs->items[i].c.doc;
        const mt_addr at =
            subs->items[i].used ? mt_json_member(doc, MT_JSON_ROOT, list) : MT_NO_ADDR;
        any = any || (at != MT_NO_ADDR && mt_json_items(doc, at).count > 0);
    }
    return any;
}

static void put_subs(mt_maker *m, void *context, const char *list)
{
    const sub_list *const subs = context;
    for (int i = 0; i < subs->n && !mt_maker_is_full(m); i++) {
        sub *const s = &subs->items[i];
        const mt_addr at = s->used ? mt_json_member(s->c.doc, MT_JSON_ROOT, list) : MT_NO_ADDR;
        for (mt_items v = mt_json_items(s->c.doc, at);
             mt_items_next(&v) && !mt_maker_is_full(m);) {
            mt_copy_item(&s->c, list, v.at);
        }
    }
}

static mt_status expand(mt_json *doc, const char *path, mt_expansion *all, mt_err *err);

/* True (noted) where the file is being read already, or is one too many. */
static bool is_refused(mt_maker *m, mt_addr file, const char *path)
{
    mt_expansion *const all = m->all;
    for (int i = 0; i <= all->depth; i++) {
        if (strcmp(all->paths[i], path) == 0) {
            mt_text circle = {0};
            for (int k = i; k <= all->depth; k++) {
                mt_text_addf(&circle, "\"%s\" -> ", all->paths[k]);
            }
            mt_diag_error(m->r.diags, file, "a circle of includes: %s\"%s\"",
                          circle.s == NULL ? "" : circle.s, path);
            mt_text_free(&circle);
            return true;
        }
    }
    if (all->depth == MT_EXPAND_DEPTH) {
        mt_diag_error(m->r.diags, file, "included more than %d deep", (int)MT_EXPAND_DEPTH);
        return true;
    }
    all->n_files++;
    if (all->n_files == MT_EXPAND_FILES + 1) { /* said once */
        mt_diag_error(m->r.diags, file, "more than %d files are included",
                      (int)MT_EXPAND_FILES);
    }
    return all->n_files > MT_EXPAND_FILES;
}

static void note_file(mt_expansion *all, const char *name, const char *sha256)
{
    mt_included_list *const list = all->files;
    mt_included *const items = list == NULL ? NULL
                                            : mt_arena_grow(list->mem, list->items, list->n,
                                                            &list->capacity, sizeof *items);
    if (items != NULL) {
        list->items = items;
        items[list->n++] = (mt_included){.name = mt_arena_strdup(list->mem, name),
                                         .sha256 = mt_arena_strdup(list->mem, sha256)};
    }
}

/* The path without detours, in the arena. */
static const char *normal_path(mt_arena *mem, const char *path)
{
    char *const normal = path == NULL ? NULL : mt_files_normal(path);
    const char *const kept = normal == NULL ? NULL : mt_arena_strdup(mem, normal);
    if (kept == NULL) {
        mt_arena_fail(mem);
    }
    free(normal);
    return kept;
}

/* The file of an include, itself written out; *out NULL where there is none (noted in the
 * including document). MT_E_INPUT where it is wrong (noted in it). */
static mt_status read_sub(mt_maker *m, mt_addr file, const char *path, mt_json **out,
                          mt_err *err)
{
    mt_expansion *const all = m->all;
    const mt_io_options *const opt = all->opt;
    mt_file bytes = {0};
    mt_err why = {.code = MT_OK};
    const char *const normal = normal_path(&m->mem, path);
    char *const joined = mt_file_join(all->names[all->depth], mt_json_string(m->r.doc, file));
    const char *const seen = joined == NULL ? NULL : mt_arena_strdup(&m->mem, joined);
    free(joined);
    *out = NULL;
    if (normal == NULL || seen == NULL) {
        return mt_fail_memory(err);
    }
    if (is_refused(m, file, normal)) {
        return MT_OK;
    }
    mt_status rc = mt_files_read(
        opt == NULL ? NULL : &opt->files, path, opt == NULL ? NULL : opt->root,
        opt != NULL && opt->max_bytes != 0 ? opt->max_bytes : MT_JSON_MAX_BYTES, &bytes, &why);
    if (rc != MT_OK) {
        mt_diag_error(m->r.diags, file, "%s", why.text);
        return rc == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
    }
    rc = mt_json_parse(bytes.bytes, bytes.length, out, err);
    note_file(all, seen, bytes.sha256);
    mt_file_free(&bytes);
    if (rc == MT_OK) {
        all->depth++;
        all->paths[all->depth] = normal;
        all->names[all->depth] = seen;
        rc = expand(*out, path, all, err);
        all->depth--;
    }
    return rc;
}

/* Where it comes to stand. */
static mt_motion read_motion(mt_maker *m, const mt_object *o)
{
    mt_object turn;
    mt_motion out = {.turns = false};
    const mt_addr rotate = mt_object_value(o, "rotate");
    if (rotate != MT_NO_ADDR && mt_object_match(&m->r, rotate, &mt_rotate_keys, &turn) &&
        mt_read_axis(m, &turn, "axis", out.axis) &&
        mt_object_value(&turn, "angle_rad") != MT_NO_ADDR) {
        out.turns = mt_read_own(m, mt_object_value(&turn, "angle_rad"), NULL, &out.angle);
    }
    (void)mt_read_place(m, mt_object_value(o, "at"), out.step);
    return out;
}

/* Values for parameters that it does not have. */
static void check_bound(mt_maker *m, const sub *s)
{
    for (mt_items i = mt_reader_items(&m->r, s->c.bound); mt_items_next(&i);) {
        const char *const name = mt_json_name(m->r.doc, i.at);
        const mt_addr all = mt_json_member(s->c.doc, MT_JSON_ROOT, "parameters");
        (void)mt_reader_type(&m->r, i.at, MT_KEY_NUMBER);
        if (all == MT_NO_ADDR || mt_json_member(s->c.doc, all, name) == MT_NO_ADDR) {
            mt_diag_error(m->r.diags, mt_json_name_addr(m->r.doc, i.at),
                          "the included model has no parameter \"%s\"", name);
        }
    }
}

/* What the document itself must be to be included. */
static bool fits(mt_maker *m, mt_json *doc, mt_addr file)
{
    mt_reader r = {.doc = doc, .diags = mt_json_diags(doc), .mem = &m->mem};
    mt_object root;
    if (r.diags->errors > 0 || !mt_reader_format(&r, "modetune-model/1", "model file") ||
        !mt_object_match(&r, MT_JSON_ROOT, &mt_model_keys, &root) || r.diags->errors > 0) {
        return false;
    }
    if (dimension_of(doc) != m->dimension) {
        mt_diag_error(m->r.diags, file, "it has %d dimensions, this model %d",
                      dimension_of(doc), m->dimension);
        return false;
    }
    return true;
}

static mt_status read_include(mt_maker *m, mt_addr entry, sub *s, mt_err *err)
{
    mt_object o;
    *s = (sub){.used = false};
    if (!mt_object_match(&m->r, entry, &mt_include_keys, &o)) {
        return MT_OK;
    }
    const mt_addr file = mt_object_value(&o, "file");
    const mt_addr prefix = mt_object_value(&o, "prefix");
    const mt_addr ground = mt_object_value(&o, "ground");
    const mt_name name = mt_reader_name(&m->r, prefix);
    if (name.s != NULL && strpbrk(name.s, "+-") != NULL) {
        mt_diag_structure(m->r.diags, prefix,
                          "names of parameters begin with it: without + and -");
    }
    if (file == MT_NO_ADDR) {
        return MT_OK;
    }
    mt_json *doc = NULL;
    char *const path = mt_file_join(m->path, mt_json_string(m->r.doc, file));
    const mt_status rc = read_sub(m, file, path, &doc, err);
    if (doc != NULL) {
        const char *const own = name.s == NULL ? "" : name.s;
        const int index = m->n_docs++;
        m->docs[index] = doc;
        m->files[index] = path == NULL ? NULL : mt_arena_strdup(&m->mem, path);
        m->by[index] = mt_maker_note(
            m, mt_arena_printf(&m->mem, "included as \"%s\" in %s, line %d", own,
                               mt_text_base_name(m->path), mt_maker_line(m->r.doc, entry)));
        s->c = mt_copy_begin(m, index, own);
        s->c.note = m->by[index];
        s->c.ground = ground == MT_NO_ADDR ? NULL : mt_json_string(m->r.doc, ground);
        s->c.ground_addr = ground;
        s->c.bound = mt_object_value(&o, "parameters");
        const mt_motion motion = read_motion(m, &o);
        mt_copy_move(&s->c, &motion, 1);
        s->used = rc == MT_OK && name.s != NULL && fits(m, doc, file);
        if (s->used) {
            check_bound(m, s);
        }
    }
    free(path);
    return rc == MT_E_INPUT ? MT_OK : rc;
}

static mt_status expand_includes(mt_json *doc, const char *path, mt_expansion *all,
                                 mt_addr list, mt_err *err)
{
    mt_maker m;
    mt_names names = {0};
    sub_list subs = {0};
    mt_items items = mt_json_items(doc, list);
    mt_status rc = mt_maker_begin(&m, doc, path, all, items.count, &names, err);
    if (rc == MT_OK) {
        subs.items = mt_reader_room(&m.r, &items, sizeof *subs.items);
        rc = mt_arena_check(&m.mem, err);
    }
    while (rc == MT_OK && mt_items_next(&items)) {
        rc = read_include(&m, items.at, &subs.items[subs.n++], err);
    }
    if (rc == MT_OK) {
        const mt_addition what = {
            .context = &subs, .any = any_sub, .put = put_subs, .from = list, .drop = "include"};
        rc = mt_maker_end(&m, &what, err);
    } else {
        for (int i = 1; i < m.n_docs; i++) {
            mt_json_delete(m.docs[i]);
        }
    }
    mt_maker_finish(&m);
    return rc;
}

/* A list of the document; MT_NO_ADDR: absent, or none (noted). */
static mt_addr list_of(mt_json *doc, const char *member)
{
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, member);
    return at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_ARRAY ? at : MT_NO_ADDR;
}

/* Includes, then repeats one after the other, so that each can copy what the others made. */
static mt_status write_out(mt_json *doc, const char *path, mt_expansion *all, mt_err *err)
{
    const mt_addr includes = list_of(doc, "include");
    const mt_addr repeats = list_of(doc, "repeat");
    const int n = mt_json_items(doc, repeats).count;
    if (n > MT_EXPAND_REPEATS) {
        mt_diag_error(mt_json_diags(doc), repeats, "has %d entries, more than %d", n,
                      (int)MT_EXPAND_REPEATS);
        return mt_fail(err, MT_E_INPUT, "too many repeats");
    }
    if (includes != MT_NO_ADDR) {
        MT_TRY(expand_includes(doc, path, all, includes, err));
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_expand_repeat(doc, path, all, i, i == n - 1, err));
    }
    return MT_OK;
}

static mt_status expand(mt_json *doc, const char *path, mt_expansion *all, mt_err *err)
{
    const mt_addr format = mt_json_member(doc, MT_JSON_ROOT, "format");
    const int outer = all->dimension;
    all->dimension = dimension_of(doc);
    const bool model = all->dimension != 0 && format != MT_NO_ADDR &&
                       strcmp(mt_json_string(doc, format), "modetune-model/1") == 0;
    const mt_status rc = model ? write_out(doc, path, all, err) : MT_OK; /* its reader tells */
    all->dimension = outer;
    return rc;
}

mt_status mt_model_expand(mt_json *doc, const char *path, const mt_io_options *opt,
                          mt_included_list *files, mt_err *err)
{
    char *const normal = mt_files_normal(path == NULL ? "" : path);
    mt_expansion all = {.opt = opt, .files = files};
    if (normal == NULL) {
        return mt_fail_memory(err);
    }
    all.paths[0] = normal;
    all.names[0] = mt_text_base_name(path == NULL ? "" : path);
    const mt_status rc = expand(doc, path == NULL ? "" : path, &all, err);
    free(normal);
    return rc;
}
