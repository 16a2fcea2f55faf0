/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equal values have equal texts, as all numbers come from one writer. So each list and object
 * is given a class by its text, and a class that is met twice is shared; what lies within a
 * value that was met before does not count, since it will not be written. The same goes for the
 * names of objects.
 */
#include "report/dedupe_json.h"

#include <string.h>

#include "base/arena.h"
#include "base/sorted.h"

/* A list of numbers that is shorter than this is as short as a reference to it. */
enum { LEAST_LIST = 12 };

/* Texts and how often they were met. */
typedef struct entry {
    const char *text;
    size_t length;
    int count;
    int place; /* among those that are shared; -1: not yet, or not at all */
    int node;  /* the first that has it */
} entry;

typedef struct classes {
    entry *at;
    int n;
    int capacity;
    mt_sorted order; /* of the texts */
} classes;

typedef struct node {
    size_t start; /* of its text */
    size_t end;
    int class;
    int keys;   /* class of an object's names; -1: a list, or an object without any */
    int after;  /* the next node that is not within */
    bool words; /* it has texts */
} node;

typedef struct packing {
    mt_arena mem;
    const char *json;
    node *nodes; /* in the order of their starts */
    int n;
    int capacity;
    int next; /* to be met when they are written */
    classes values;
    classes keys;
    bool reserved; /* a name is one of ours */
    mt_text *out;
} packing;

static int compare_texts(const void *context, const void *key, int i)
{
    const entry *const x = key;
    const entry *const y = &((const classes *)context)->at[i];
    if (x->length != y->length) {
        return x->length < y->length ? -1 : 1;
    }
    return memcmp(x->text, y->text, x->length);
}

/* The class of a text, which lives as long; -1: no room. */
static int class_of(packing *p, classes *c, const char *text, size_t length, int first)
{
    const entry new = {text, length, 0, -1, first};
    entry *const at = mt_arena_grow(&p->mem, c->at, c->n, &c->capacity, sizeof *at);
    if (at == NULL) {
        return -1;
    }
    c->at = at;
    const int known = mt_sorted_put(&c->order, &p->mem, compare_texts, c, &new);
    if (known != MT_SORTED_NEW) {
        return known >= 0 ? known : -1;
    }
    at[c->n] = new;
    return c->n++;
}

static size_t string_end(const char *json, size_t at)
{
    for (at++; json[at] != '"' && json[at] != '\0'; at++) {
        at += json[at] == '\\' && json[at + 1] != '\0' ? 1 : 0;
    }
    return at + (json[at] == '"' ? 1 : 0);
}

/* The position after a bracket or colon, at most the end, where a walk without memory has
 * gone. */
static size_t behind(const packing *p, size_t at)
{
    return at + (p->json[at] != '\0' ? 1 : 0);
}

static size_t read_value(packing *p, size_t at, bool *words);

/* Read the members of an object from `at`, which ends after it; their names are added to
 * `names`. */
static size_t read_members(packing *p, size_t at, mt_text *names, bool *words)
{
    while (p->json[at] == '"') {
        const size_t end = string_end(p->json, at);
        p->reserved = p->reserved || strncmp(p->json + at, "\"#\"", 3) == 0 ||
                      strncmp(p->json + at, "\"~\"", 3) == 0;
        mt_text_add(names, names->length > 0 ? "," : "");
        mt_text_add_n(names, p->json + at, end - at);
        at = read_value(p, behind(p, end), words);
        at += p->json[at] == ',' ? 1 : 0;
    }
    return behind(p, at);
}

static size_t read_node(packing *p, size_t at, bool *words)
{
    const int i = p->n;
    const bool object = p->json[at] == '{';
    node *const nodes = mt_arena_grow(&p->mem, p->nodes, p->n, &p->capacity, sizeof *nodes);
    mt_text names = {.s = NULL};
    if (nodes == NULL) {
        return strlen(p->json);
    }
    p->nodes = nodes;
    nodes[p->n++] = (node){.start = at, .keys = -1};
    bool own = object;
    size_t end = at + 1;
    if (object) {
        end = read_members(p, end, &names, &own);
    } else {
        while (strchr("]}", p->json[end]) == NULL) { /* which finds the end of all, too */
            end = read_value(p, end, &own);
            end += p->json[end] == ',' ? 1 : 0;
        }
        end = behind(p, end);
    }
    const char *const text = names.s == NULL ? NULL : mt_arena_strdup(&p->mem, names.s);
    if (text != NULL) {
        p->nodes[i].keys = class_of(p, &p->keys, text, names.length, i);
    }
    p->out->failed = p->out->failed || names.failed;
    mt_text_free(&names);
    p->nodes[i].end = end;
    p->nodes[i].after = p->n;
    p->nodes[i].words = own;
    p->nodes[i].class = class_of(p, &p->values, p->json + at, end - at, i);
    *words = *words || own;
    return end;
}

/* The position after the value at `at`. */
static size_t read_value(packing *p, size_t at, bool *words)
{
    if (p->json[at] == '{' || p->json[at] == '[') {
        return p->mem.failed ? strlen(p->json) : read_node(p, at, words);
    }
    if (p->json[at] == '"') {
        *words = true;
        return string_end(p->json, at);
    }
    return at + strcspn(p->json + at, ",]}");
}

static bool is_worth(const packing *p, const node *v)
{
    return v->words || p->values.at[v->class].length >= LEAST_LIST;
}

/* Give parts that occur twice an index, in the order of the document. */
static void index_repeated_parts(packing *p)
{
    for (int i = 0; i < p->n;) {
        const node *const v = &p->nodes[i];
        entry *const e = &p->values.at[v->class];
        const bool again = e->count++ > 0 && is_worth(p, v);
        if (v->keys >= 0 && !again) {
            p->keys.at[v->keys].count++;
        }
        i = again ? v->after : i + 1;
    }
    int places = 0;
    for (int i = 0; i < p->values.n; i++) {
        entry *const e = &p->values.at[i];
        e->place = e->count > 1 && is_worth(p, &p->nodes[e->node]) ? 0 : -1;
    }
    for (int i = 0; i < p->n; i++) { /* in their order: classes stand in that of their ends */
        entry *const e = &p->values.at[p->nodes[i].class];
        if (e->place == 0 && e->node == i) {
            e->place = places++;
        }
    }
    places = 0;
    for (int i = 0; i < p->keys.n; i++) {
        p->keys.at[i].place = p->keys.at[i].count > 1 ? places++ : -1;
    }
}

static size_t write_value(packing *p, size_t at);

/* A list or object in full: the node that is next. */
static size_t write_node(packing *p)
{
    const node *const v = &p->nodes[p->next++];
    const bool object = p->json[v->start] == '{';
    const int keys = v->keys >= 0 ? p->keys.at[v->keys].place : -1;
    size_t at = v->start + 1;
    if (keys >= 0) {
        mt_text_addf(p->out, "{\"~\":[%d", keys);
    } else {
        mt_text_add_n(p->out, p->json + v->start, 1);
    }
    while (at < v->end - 1) {
        if (object) {
            const size_t value = behind(p, string_end(p->json, at));
            if (keys >= 0) {
                mt_text_add(p->out, ",");
            } else {
                mt_text_add_n(p->out, p->json + at, value - at);
            }
            at = value;
        }
        at = write_value(p, at);
        if (p->json[at] == ',') {
            mt_text_add(p->out, keys >= 0 ? "" : ",");
            at++;
        }
    }
    mt_text_add(p->out, keys >= 0 ? "]}" : object ? "}" : "]");
    return v->end;
}

static size_t write_value(packing *p, size_t at)
{
    if (p->json[at] != '{' && p->json[at] != '[') {
        const size_t end =
            p->json[at] == '"' ? string_end(p->json, at) : at + strcspn(p->json + at, ",]}");
        mt_text_add_n(p->out, p->json + at, end - at);
        return end;
    }
    const node *const v = &p->nodes[p->next];
    const entry *const e = &p->values.at[v->class];
    if (e->place < 0) {
        return write_node(p);
    }
    mt_text_addf(p->out, "{\"#\":%d}", e->place);
    p->next = v->after;
    return v->end;
}

static void write_tables(packing *p)
{
    const char *comma = "";
    mt_text_add(p->out, "[[");
    for (int i = 0; i < p->keys.n; i++) {
        const entry *const e = &p->keys.at[i];
        if (e->place >= 0) {
            mt_text_add(p->out, comma);
            mt_text_add(p->out, "[");
            mt_text_add_n(p->out, e->text, e->length);
            mt_text_add(p->out, "]");
            comma = ",";
        }
    }
    mt_text_add(p->out, "],[");
    comma = "";
    for (int i = 0; i < p->n; i++) {
        const entry *const e = &p->values.at[p->nodes[i].class];
        if (e->place >= 0 && e->node == i) {
            mt_text_add(p->out, comma);
            p->next = i;
            (void)write_node(p);
            comma = ",";
        }
    }
    mt_text_add(p->out, "],");
}

void mt_dedupe_json(const char *json, mt_text *out)
{
    packing p = {.json = json, .out = out};
    bool words = false;
    if (mt_arena_init(&p.mem, 0, NULL) == MT_OK) {
        (void)read_value(&p, 0, &words);
        if (p.reserved) {
            mt_text_add(out, "[[],[],");
            mt_text_add(out, json);
            mt_text_add(out, "]");
        } else if (mt_arena_check(&p.mem, NULL) == MT_OK) {
            index_repeated_parts(&p);
            write_tables(&p);
            p.next = 0;
            (void)write_value(&p, 0);
            mt_text_add(out, "]");
        } else {
            out->failed = true;
        }
    } else {
        out->failed = true;
    }
    mt_arena_free(&p.mem);
}
