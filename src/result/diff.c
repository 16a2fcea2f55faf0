/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Two JSON values are walked together. Members of objects and items of lists are paired by
 * sorted keys, the k-th of a key with the k-th of it, and visited in the order of the first
 * result, what is in the second alone behind it.
 */
#include "result/diff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/json.h"
#include "io/reader.h"
#include "result/folder.h"
#include "result/result.h"

enum { A, B, SIDES, MOST_KEYS = 3 };

/* What an item of a list is about. Without keys it is its place. */
typedef struct list_rule {
    const char *list;
    const char *one;
    const char *keys[MOST_KEYS];
    const char *shown; /* the member that names it for people; NULL: its keys */
} list_rule;

static const list_rule RULES[] = {
    {"assumptions", "assumption", {"parameter"}, NULL},
    {"certificates", "certificate", {"kind", "pointer"}, NULL},
    {"clearances", "clearance", {"configuration", "mode", "band"}, NULL},
    {"curves", "curve", {"configuration", "pointer"}, NULL},
    {"densities", "density", {NULL}, NULL},
    {"doubts", "doubt", {"kind", "configuration", "pointer"}, NULL},
    {"excitations", "excitation", {"pointer", "name"}, NULL},
    {"extremes", "extreme", {"kind"}, NULL},
    {"facts", "fact", {"kind", "configuration", "pointer"}, NULL},
    {"frequencies", "frequency", {"configuration", "mode", "reference"}, NULL},
    {"gap_assignment", "band", {"configuration", "band"}, NULL},
    {"goals", "goal", {"pointer"}, "goal"},
    {"history", "step", {NULL}, NULL},
    {"inputs", "input", {"file"}, NULL},
    {"limits", "limit", {"pointer"}, NULL},
    {"mac_matrices", "MAC matrix", {"configuration", "reference"}, NULL},
    {"motion", "motion", {"goal", "drive"}, NULL},
    {"objectives", "objective", {"text"}, NULL},
    {"orders", "order", {"label"}, NULL},
    {"overrides", "override", {"kind", "name"}, "name"},
    {"parameters", "parameter", {"name"}, NULL},
    {"per_variable", "variable", {"name"}, NULL},
    {"points", "point", {NULL}, NULL},
    {"responses", "response", {"goal", "configuration"}, NULL},
    {"responses_between", "response between positions", {"goal", "drive"}, NULL},
    {"published", "value", {"pointer"}, "label"},
    {"recommendations", "recommendation", {NULL}, NULL},
    {"reasons", "reason", {NULL}, NULL},
    {"relaxations", "relaxation", {"kind", "pointer", "what"}, NULL},
    {"rows", "mode", {"mode"}, NULL},
    {"spread", "spread", {"parameter"}, NULL},
    {"tones", "tone", {"tone"}, NULL},
    {"unchecked", "design not re-checked", {NULL}, NULL},
    {"undetermined", "direction", {NULL}, NULL},
    {"vary", "quantity", {"pointer"}, "text"},
    {"variables", "variable", {NULL}, NULL},
};

/* Sentences, places in files, measures of rounding, and digests of what is written from all
 * this. */
static const char *const PASSED_OVER[] = {
    "column",      "drawn",         "goal",     "history", "kkt_residual",
    "line",        "orthogonality", "outputs",  "reasons", "residual",
    "status_text", "text",          "warnings",
};

/* What changes where something else in the same part does. */
static const char *const DERIVED[] = {
    "change_percent", "damping_ratio",   "difference", "difference_percent", "error_percent",
    "feasible",       "high_percent",    "hz",         "low_percent",        "margin_lower_hz",
    "margin_percent", "margin_upper_hz", "natural_hz", "original",           "original_hz",
    "phase_deg",      "rival_share",     "score",      "sensitivity",        "share",
};

/* Of these 1 is the whole: they are compared with it. */
static const char *const OF_ONE[] = {"mac",         "values", "share",
                                     "rival_share", "change", "misfit"};
/* Of an object these have one unit. */
static const char *const OF_ONE_UNIT[] = {
    "at_least",  "at_most",     "computed", "from", "high",  "low",   "original",
    "published", "recommended", "target",   "to",   "value", "worst",
};

static bool is_among(const char *name, const char *const *names, int n)
{
    for (int i = 0; i < n; i++) {
        if (name != NULL && strcmp(name, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

static bool ends_with(const char *name, const char *end)
{
    const size_t n = name == NULL ? 0 : strlen(name);
    const size_t m = strlen(end);
    return n >= m && strcmp(name + n - m, end) == 0;
}

static const list_rule *rule_of(const char *list)
{
    for (int i = 0; i < MT_COUNT(RULES); i++) {
        if (list != NULL && strcmp(list, RULES[i].list) == 0) {
            return &RULES[i];
        }
    }
    return NULL;
}

/* The way to a value: a member by its name, or an item of a list. */
typedef struct step {
    const struct step *before;
    const char *name;  /* NULL: an item of a list */
    const char *label; /* for people: "frequency upright mode 1"; NULL: of a list */
    int index[SIDES];  /* of an item */
} step;

/* The largest numbers of an object, of both results, of those that have one unit. */
typedef struct scales {
    double hz;
    double plain;
} scales;

typedef struct search {
    mt_reader r[SIDES];
    mt_arena scratch;
    mt_result_diff *out;
    mt_diff_tolerance tol;
} search;

static mt_json_type type_of(const search *s, int side, mt_addr value)
{
    return value == MT_NO_ADDR ? (mt_json_type)0 : mt_json_type_of(s->r[side].doc, value);
}

static mt_reported told(const search *s, int side, mt_addr value)
{
    mt_reported t = {.type = type_of(s, side, value), .number = nan("")};
    if (t.type == MT_JSON_NUMBER) {
        t.number = mt_json_number(s->r[side].doc, value);
    } else if (t.type == MT_JSON_BOOL) {
        t.number = mt_json_bool(s->r[side].doc, value) ? 1.0 : 0.0;
    } else if (t.type == MT_JSON_STRING) {
        t.text = mt_json_string(s->r[side].doc, value);
    }
    return t;
}

static mt_addr member(const search *s, int side, mt_addr object, const char *name)
{
    return object == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(s->r[side].doc, object, name);
}

static const char *text_member(const search *s, int side, mt_addr object, const char *name)
{
    return told(s, side, member(s, side, object, name)).text;
}

static scales find_largest_sizes(const search *s, const mt_addr v[SIDES])
{
    scales all = {0.0, 0.0};
    for (int side = 0; side < SIDES && s->tol.relative > 0.0; side++) {
        for (mt_items i = mt_reader_items(&s->r[side], v[side]); mt_items_next(&i);) {
            const char *const name = mt_json_name(i.doc, i.at);
            const double size = fabs(told(s, side, i.at).number);
            if (ends_with(name, "hz") && size > all.hz) {
                all.hz = size;
            } else if (is_among(name, OF_ONE_UNIT, MT_COUNT(OF_ONE_UNIT)) && size > all.plain) {
                all.plain = size;
            }
        }
    }
    return all;
}

/* The last member's name on the way. */
static const char *name_at(const step *at)
{
    while (at != NULL && at->name == NULL) {
        at = at->before;
    }
    return at == NULL ? NULL : at->name;
}

static bool same_number(const search *s, const step *at, const scales *all, double a, double b)
{
    static const double PERCENT = 100.0; /* of the whole */
    const char *const name = name_at(at);
    double scale = fmax(fabs(a), fabs(b));
    if (ends_with(name, "percent")) {
        scale = fmax(scale, PERCENT);
    } else if (ends_with(name, "hz")) {
        scale = fmax(scale, all->hz);
    } else if (is_among(name, OF_ONE, MT_COUNT(OF_ONE))) {
        scale = fmax(scale, 1.0);
    } else if (is_among(name, OF_ONE_UNIT, MT_COUNT(OF_ONE_UNIT))) {
        scale = fmax(scale, all->plain);
    }
    return a == b || fabs(a - b) <= fmax(s->tol.relative * scale, s->tol.absolute);
}

static bool is_same_value(const search *s, const step *at, const scales *all,
                          const mt_addr v[SIDES])
{
    const mt_reported a = told(s, A, v[A]);
    const mt_reported b = told(s, B, v[B]);
    if (a.type != b.type) {
        return false;
    }
    switch (a.type) {
    case MT_JSON_NUMBER:
    case MT_JSON_BOOL:
        return same_number(s, at, all, a.number, b.number);
    case MT_JSON_STRING:
        return strcmp(a.text, b.text) == 0;
    case MT_JSON_NULL:
    case MT_JSON_ARRAY:
    case MT_JSON_OBJECT:
        break;
    }
    return true;
}

/* The path from the first to `at`; returns the number of steps. */
static int way_to(const step *at, const step *way[MT_JSON_MAX_DEPTH + 1])
{
    int n = 0;
    for (const step *s = at; s != NULL; s = s->before) {
        n++;
    }
    for (int i = n; i > 0; at = at->before) {
        way[--i] = at;
    }
    return n;
}

static const char *kept(mt_arena *mem, mt_text *t)
{
    if (t->failed) {
        mt_arena_fail(mem);
    }
    const char *const copy = mt_arena_strdup(mem, t->s == NULL ? "" : t->s);
    mt_text_free(t);
    return copy;
}

static const char *pointer_of(int n, const step *const *way, int side, mt_arena *mem)
{
    mt_text t = {.s = NULL};
    for (int i = 0; i < n; i++) {
        mt_text_add(&t, "/");
        if (way[i]->name == NULL) {
            mt_text_addf(&t, "%d", way[i]->index[side]);
            continue;
        }
        for (const char *c = way[i]->name; *c != '\0'; c++) {
            const char *const escape = *c == '~' ? "~0" : *c == '/' ? "~1" : NULL;
            mt_text_add_n(&t, escape == NULL ? c : escape, escape == NULL ? 1 : 2);
        }
    }
    return kept(mem, &t);
}

static const char MADE_BY[] = "made by";

/* The part of a result that a value belongs to, as a text that lives as long as the path, and
 * the number of steps to it. */
static const char *find_result_part(int n, const step *const *way, int *from)
{
    const char *const name = way[0]->name == NULL ? "" : way[0]->name;
    *from = 1;
    if (strcmp(name, "study") == 0 || strcmp(name, "model") == 0) {
        *from = 0;
        return MADE_BY;
    }
    if (strcmp(name, "run") == 0) {
        return MADE_BY;
    }
    if (strcmp(name, "baseline") == 0) {
        return "original design";
    }
    if (strcmp(name, "recommendations") == 0 && n > 1) {
        *from = 2;
        return way[1]->label;
    }
    return n == 1 ? "answer" : name;
}

/* "%" of "change_percent"; else the unit member next to it, where there is one. */
static const char *difference_unit(const search *s, const char *name,
                                   const mt_addr object[SIDES])
{
    if (ends_with(name, "percent")) {
        return "%";
    }
    if (ends_with(name, "hz")) {
        return "Hz";
    }
    if (!is_among(name, OF_ONE_UNIT, MT_COUNT(OF_ONE_UNIT))) {
        return NULL;
    }
    const char *const unit = text_member(s, A, object[A], "unit");
    return unit != NULL ? unit : text_member(s, B, object[B], "unit");
}

static void add_difference(search *s, const step *at, const mt_addr object[SIDES],
                           const mt_addr v[SIDES])
{
    mt_result_diff *const out = s->out;
    const step *way[MT_JSON_MAX_DEPTH + 1];
    const int n = way_to(at, way);
    const int labels = at->name == NULL ? n : n - 1;
    int from = 0;
    mt_difference *const items =
        mt_arena_grow(&out->mem, out->items, out->n, &out->capacity, sizeof *items);
    if (items == NULL) {
        return;
    }
    out->items = items;
    mt_difference *const d = &items[out->n++];
    const char *const part = find_result_part(n, way, &from);
    d->part = mt_arena_strdup(&out->mem, part);
    mt_text what = {.s = NULL};
    for (int i = from; i < labels; i++) {
        if (way[i]->label != NULL) {
            mt_text_add(&what, what.length > 0 ? ", " : "");
            mt_text_add(&what, way[i]->label);
        }
        d->derived = d->derived || is_among(way[i]->name, DERIVED, MT_COUNT(DERIVED));
    }
    d->what = kept(&out->mem, &what);
    d->member = mt_arena_strdup(&out->mem, at->name == NULL ? "" : at->name);
    d->derived = d->derived || is_among(at->name, DERIVED, MT_COUNT(DERIVED));
    const char *const unit = difference_unit(s, at->name, object);
    d->unit = unit == NULL || unit[0] == '\0' ? NULL : unit;
    d->provenance = strcmp(part, MADE_BY) == 0;
    out->of_answer += d->provenance ? 0 : 1;
    for (int side = 0; side < SIDES; side++) {
        d->told[side] = told(s, side, v[side]);
        d->pointer[side] = v[side] == MT_NO_ADDR ? NULL : pointer_of(n, way, side, &out->mem);
    }
}

/* What an item or member is paired by. */
typedef struct entry {
    const char *key;
    mt_addr value;
    int index;
} entry;

typedef struct pair {
    const char *label;
    mt_addr value[SIDES];
    int index[SIDES];
    int order;
} pair;

static int by_key(const void *a, const void *b)
{
    const entry *const x = a;
    const entry *const y = b;
    const int order = strcmp(x->key, y->key);
    return order != 0 ? order : (x->index > y->index) - (x->index < y->index);
}

static int by_order(const void *a, const void *b)
{
    const pair *const x = a;
    const pair *const y = b;
    return (x->order > y->order) - (x->order < y->order);
}

/* "upright mode 1"; a named mode by its name, as its index may be another one. */
static void add_keys(const search *s, int side, mt_addr item, const list_rule *rule, mt_text *t)
{
    for (int k = 0; k < MOST_KEYS && rule->keys[k] != NULL; k++) {
        const char *key = rule->keys[k];
        const char *const name =
            strcmp(key, "mode") == 0 ? text_member(s, side, item, "name") : NULL;
        const mt_reported part = told(s, side, member(s, side, item, key));
        const char *const text = name != NULL ? name : part.text;
        if (text != NULL || part.type == MT_JSON_NUMBER) {
            mt_text_add(t, t->length > 0 ? " " : "");
        }
        if (text != NULL) {
            mt_text_add(t, text);
        } else if (part.type == MT_JSON_NUMBER) {
            mt_text_addf(t, "%s %.17g", key, part.number);
        }
    }
}

/* The entries of one side, sorted by their keys; NULL where memory is out. */
static entry *entries_of(search *s, int side, mt_addr value, const char *list, int *n)
{
    const list_rule *const rule = rule_of(list);
    mt_items items = mt_reader_items(&s->r[side], value);
    entry *const all = mt_reader_room(&s->r[side], &items, sizeof *all);
    for (*n = 0; mt_items_next(&items); ++*n) {
        entry *const e = &all[*n];
        *e = (entry){mt_json_name(items.doc, items.at), items.at, *n};
        if (e->key == NULL) {
            mt_text t = {.s = NULL};
            if (rule != NULL) {
                add_keys(s, side, items.at, rule, &t);
            }
            if (t.s == NULL && !t.failed) {
                mt_text_addf(&t, "%d", *n + 1);
            }
            e->key = kept(&s->scratch, &t);
        }
    }
    if (mt_arena_failed(&s->scratch)) {
        *n = 0;
        return NULL;
    }
    if (*n > 0) {
        qsort(all, (size_t)*n, sizeof *all, by_key);
    }
    return all;
}

/* Both sides merged; what the second has alone comes last. */
static int merge_entries(const entry *const e[SIDES], const int n[SIDES], pair *out)
{
    int a = 0;
    int b = 0;
    int count = 0;
    while (a < n[A] || b < n[B]) {
        const int order = a >= n[A] ? 1 : b >= n[B] ? -1 : strcmp(e[A][a].key, e[B][b].key);
        pair *const p = &out[count++];
        *p = (pair){.value = {MT_NO_ADDR, MT_NO_ADDR}, .index = {-1, -1}};
        if (order >= 0) {
            p->label = e[B][b].key;
            p->value[B] = e[B][b].value;
            p->index[B] = e[B][b].index;
            p->order = n[A] + e[B][b++].index;
        }
        if (order <= 0) {
            p->label = e[A][a].key;
            p->value[A] = e[A][a].value;
            p->index[A] = e[A][a].index;
            p->order = e[A][a++].index;
        }
    }
    if (count > 0) {
        qsort(out, (size_t)count, sizeof *out, by_order);
    }
    return count;
}

/* "goal upright mode 1 at 1 Hz" */
static const char *label_of(search *s, const char *list, const pair *p)
{
    const list_rule *const rule = rule_of(list);
    const char *shown = NULL;
    for (int side = 0; side < SIDES && rule != NULL && rule->shown != NULL; side++) {
        shown = shown == NULL ? text_member(s, side, p->value[side], rule->shown) : shown;
    }
    mt_text t = {.s = NULL};
    mt_text_add(&t, rule != NULL ? rule->one : list == NULL ? "" : list);
    mt_text_add(&t, " ");
    mt_text_add(&t, shown == NULL ? p->label : shown);
    return kept(&s->scratch, &t);
}

static void compare_members(search *s, const step *at, const mt_addr v[SIDES]);

static void compare_one(search *s, const step *next, const mt_addr v[SIDES],
                        const mt_addr inner[SIDES], const scales *all)
{
    const mt_json_type type = type_of(s, A, inner[A]);
    const bool holds = type == MT_JSON_OBJECT || type == MT_JSON_ARRAY;
    if (!is_same_value(s, next, all, inner)) {
        add_difference(s, next, v, inner);
    } else if (holds) {
        compare_members(s, next, inner);
    }
}

/* v: two objects, or two lists */
static void compare_members(search *s, const step *at, const mt_addr v[SIDES])
{
    const mt_arena_mark mark = mt_arena_get_mark(&s->scratch);
    const bool is_list = type_of(s, A, v[A]) == MT_JSON_ARRAY;
    const char *const list = is_list ? name_at(at) : NULL;
    int n[SIDES] = {0, 0};
    const entry *const e[SIDES] = {entries_of(s, A, v[A], list, &n[A]),
                                   entries_of(s, B, v[B], list, &n[B])};
    pair *const pairs = mt_arena_alloc(&s->scratch, (size_t)n[A] + (size_t)n[B], sizeof *pairs);
    const bool short_of_memory = e[A] == NULL || e[B] == NULL || pairs == NULL;
    const int count = short_of_memory ? 0 : merge_entries(e, n, pairs);
    const scales all = find_largest_sizes(s, v);
    for (int i = 0; i < count; i++) {
        const pair *const p = &pairs[i];
        const int side = p->value[A] == MT_NO_ADDR ? B : A;
        step next = {.before = at, .index = {p->index[A], p->index[B]}};
        if (is_list) {
            next.label = label_of(s, list, p);
        } else {
            next.name = p->label;
            next.label = type_of(s, side, p->value[side]) == MT_JSON_ARRAY ? NULL : p->label;
        }
        if (mt_arena_failed(&s->scratch)) {
            break; /* the way is without names */
        }
        if (is_list || !is_among(next.name, PASSED_OVER, MT_COUNT(PASSED_OVER))) {
            compare_one(s, &next, v, p->value, &all);
        }
    }
    mt_arena_rewind(&s->scratch, mark);
}

static mt_status read_result_side(const char *path, const char *root, search *s, int side,
                                  mt_diagnostics *messages, mt_err *err)
{
    mt_file file = {.bytes = NULL};
    mt_json *doc = NULL;
    char *name = NULL;
    mt_status rc = mt_result_path(path, &name, err);
    rc = rc == MT_OK ? mt_file_read(name, root, MT_JSON_MAX_BYTES, &file, err) : rc;
    rc = rc == MT_OK ? mt_json_parse(file.bytes, file.length, &doc, err) : rc;
    mt_file_free(&file);
    if (doc != NULL) {
        s->out->doc[side] = doc;
        s->r[side] = (mt_reader){.doc = doc, .diags = mt_json_diags(doc), .mem = &s->scratch};
        if (rc == MT_OK) {
            (void)mt_record_check_format(&s->r[side], &mt_result_record, "result");
        }
        rc = mt_json_status(doc, name, err);
        mt_json_report(doc, name, messages);
        rc = messages->lines.failed ? mt_fail_memory(err) : rc;
    }
    free(name);
    return rc;
}

mt_status mt_result_diff_find(const char *const paths[2], mt_diff_tolerance tol,
                              const char *root, mt_result_diff *out, mt_diagnostics *messages,
                              mt_err *err)
{
    static const mt_addr roots[SIDES] = {MT_JSON_ROOT, MT_JSON_ROOT};
    search s = {.out = out, .tol = tol};
    mt_status rc = mt_arena_init(&s.scratch, 0, err);
    rc = rc == MT_OK ? mt_arena_init(&out->mem, 0, err) : rc;
    if (rc == MT_OK) { /* both are told what is wrong with them */
        mt_err second = {.code = MT_OK};
        rc = read_result_side(paths[A], root, &s, A, messages, err);
        const mt_status other = read_result_side(paths[B], root, &s, B, messages, &second);
        rc = rc == MT_OK && other != MT_OK ? mt_fail(err, other, "%s", second.text) : rc;
    }
    if (rc == MT_OK) {
        compare_members(&s, NULL, roots);
        rc = mt_arena_check(&s.scratch, err);
    }
    rc = rc == MT_OK ? mt_arena_check(&out->mem, err) : rc;
    mt_arena_free(&s.scratch);
    return rc;
}

void mt_result_diff_free(mt_result_diff *diff)
{
    mt_json_delete(diff->doc[A]);
    mt_json_delete(diff->doc[B]);
    mt_arena_free(&diff->mem);
    *diff = (mt_result_diff){.n = 0};
}
