/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equal values have equal texts, as all numbers come from one writer. So each list and object
 * is given a class by its text, and a class that is met twice is shared; what lies within a
 * value that was met before does not count, since it will not be written. The same goes for the
 * names of objects.
 */
#include "report/dedupe_json.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/sorted.h"

/* A list of numbers that is shorter than this is as short as a reference to it. */
enum { LEAST_LIST = 12 };
/* Classes met last, by a hash of their texts: a power of two. */
enum { RECENT = 512 };

/* "<" in a string, where it could end the element of the page that holds the document. */
static const char LESS[] = "\\u003c";

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
    mt_sorted order;    /* of the texts */
    int recent[RECENT]; /* 1 + class; 0: none */
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
    const char *json; /* what of the document is not yet read */
    char *text;       /* what is: without white space, and with LESS */
    size_t length;
    size_t written; /* up to here the text, or what stands for it, is in `out` */
    node *nodes;    /* in the order of their starts */
    int n;
    int capacity;
    classes values;
    classes names;
    classes keys; /* their texts are the classes of the names, as integers */
    int *open;    /* names of the objects that are being read, of the outermost first */
    int n_open;
    int open_capacity;
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

/* Place of a text among the recent ones, by its length, beginning, middle and end. Texts that
 * collide only cost a look into the order. */
static size_t hash(const char *text, size_t length)
{
    const uint64_t odd = 0x9e3779b97f4a7c15U; /* 2^64 over the golden ratio */
    uint64_t word[3] = {0};
    const size_t n = length < sizeof word[0] ? length : sizeof word[0];
    memcpy(&word[0], text, n);
    if (length > n) {
        memcpy(&word[1], text + (length - n) / 2, sizeof word[1]);
        memcpy(&word[2], text + length - n, sizeof word[2]);
    }
    const uint64_t sum = ((word[0] * odd ^ word[1]) * odd ^ word[2] ^ length) * odd;
    return (size_t)(sum >> 32) % RECENT;
}

/* The class of a text, which lives as long; -1: no room. */
static int class_of(packing *p, classes *c, const char *text, size_t length, int first)
{
    const entry new = {text, length, 0, -1, first};
    int *const recent = &c->recent[hash(text, length)];
    if (*recent > 0 && compare_texts(c, &new, *recent - 1) == 0) {
        return *recent - 1;
    }
    entry *const at = mt_arena_grow(&p->mem, c->at, c->n, &c->capacity, sizeof *at);
    if (at == NULL) {
        return -1;
    }
    c->at = at;
    int class = mt_sorted_put(&c->order, &p->mem, compare_texts, c, &new);
    if (class == MT_SORTED_FULL) {
        return -1;
    }
    if (class == MT_SORTED_NEW) {
        class = c->n++;
        at[class] = new;
    }
    *recent = 1 + class;
    return class;
}

/* Size of the text: that of the document with every "<" escaped. */
static size_t room_of(const char *json)
{
    size_t n = 1;
    for (const char *at = json; (at = strchr(at, '<')) != NULL; at++) {
        n += sizeof LESS - 2;
    }
    return n + strlen(json);
}

static inline void skip_space(packing *p)
{
    if (*p->json == ' ' || *p->json == '\n') {
        p->json += p->json[1] > ' ' ? 1 : strspn(p->json, " \n");
    }
}

static inline void copy(packing *p, size_t n)
{
    memcpy(p->text + p->length, p->json, n);
    p->length += n;
    p->json += n;
}

/* Copy the character that must be there; nothing where the document has ended. */
static inline void copy_one(packing *p)
{
    if (*p->json != '\0') {
        p->text[p->length++] = *p->json++;
    }
}

/* Copy a string including its end, or up to the end of the document. */
static void copy_string(packing *p)
{
    copy_one(p);
    for (;;) {
        copy(p, strcspn(p->json, "\"\\<"));
        if (*p->json == '<') {
            memcpy(p->text + p->length, LESS, sizeof LESS - 1);
            p->length += sizeof LESS - 1;
            p->json++;
        } else if (*p->json == '\\') { /* and what it escapes */
            copy_one(p);
            copy_one(p);
        } else {
            copy_one(p);
            return;
        }
    }
}

static void read_value(packing *p, bool *words);

/* Read the comma or the bracket behind an item; false: no other one follows. */
static inline bool goes_on(packing *p)
{
    skip_space(p);
    const bool more = *p->json == ',';
    copy_one(p);
    if (more) {
        skip_space(p);
    }
    return more;
}

static void read_name(packing *p)
{
    const size_t start = p->length;
    copy_string(p);
    const char *const name = p->text + start;
    const size_t length = p->length - start;
    p->reserved = p->reserved || (length == 3 && (name[1] == '#' || name[1] == '~'));
    if (p->n_open == p->open_capacity) {
        p->open =
            mt_arena_grow(&p->mem, p->open, p->n_open, &p->open_capacity, sizeof *p->open);
    }
    if (!p->mem.failed) {
        p->open[p->n_open++] = class_of(p, &p->names, name, length, -1);
    }
    skip_space(p);
    copy_one(p); /* the colon */
    skip_space(p);
}

/* The class of the names that are open from `first` on. */
static int keys_of(packing *p, int first, int i)
{
    const char *const ids = (const char *)(p->open + first);
    const size_t length = (size_t)(p->n_open - first) * sizeof *p->open;
    const int class = class_of(p, &p->keys, ids, length, i);
    entry *const e = class < 0 ? NULL : &p->keys.at[class];
    if (e != NULL && e->text == ids) { /* is new */
        char *const own = mt_arena_alloc(&p->mem, length, 1);
        e->text = own == NULL ? "" : own;
        e->length = own == NULL ? 0 : length;
        if (own != NULL) {
            memcpy(own, ids, length);
        }
    }
    return class;
}

static void read_node(packing *p, bool *words)
{
    const int i = p->n;
    const int names = p->n_open;
    const size_t start = p->length;
    const bool object = *p->json == '{';
    node *const nodes = mt_arena_grow(&p->mem, p->nodes, p->n, &p->capacity, sizeof *nodes);
    if (nodes == NULL) {
        p->json += strlen(p->json);
        return;
    }
    p->nodes = nodes;
    nodes[p->n++] = (node){.start = start, .keys = -1};
    bool own = object;
    copy_one(p);
    skip_space(p);
    bool more = *p->json != '\0' && strchr("]}", *p->json) == NULL;
    if (!more) {
        copy_one(p);
    }
    while (more) {
        if (object) {
            read_name(p);
        }
        read_value(p, &own);
        more = goes_on(p);
    }
    node *const v = &p->nodes[i];
    if (p->n_open > names && !p->mem.failed) {
        v->keys = keys_of(p, names, i);
    }
    p->n_open = names;
    v->end = p->length;
    v->after = p->n;
    v->words = own;
    v->class = class_of(p, &p->values, p->text + start, p->length - start, i);
    *words = *words || own;
}

static void read_value(packing *p, bool *words)
{
    if (*p->json == '{' || *p->json == '[') {
        read_node(p, words);
    } else if (*p->json == '"') {
        *words = true;
        copy_string(p);
    } else {
        copy(p, strcspn(p->json, ",]} \n"));
    }
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

/* Add the text up to there that is not yet written; what is behind `next` comes next. */
static void write_until(packing *p, size_t end, size_t next)
{
    if (end > p->written) {
        mt_text_add_n(p->out, p->text + p->written, end - p->written);
    }
    p->written = next;
}

static void write_node(packing *p, int i);

/* A list or object that is part of another one. */
static void write_part(packing *p, int i)
{
    const node *const v = &p->nodes[i];
    const int place = p->values.at[v->class].place;
    if (place < 0) {
        write_node(p, i);
        return;
    }
    write_until(p, v->start, v->end);
    mt_text_addf(p->out, "{\"#\":%d}", place);
}

/* The position after a string, number or word of the text. */
static size_t scalar_end(const packing *p, size_t at)
{
    if (p->text[at] != '"') {
        return at + strcspn(p->text + at, ",}");
    }
    at++;
    while (p->text[at += strcspn(p->text + at, "\"\\")] == '\\') {
        at += p->text[at + 1] == '\0' ? 1 : 2;
    }
    return at + (p->text[at] == '"' ? 1 : 0);
}

/* An object whose names are shared: its values alone. */
static void write_values(packing *p, int i, const entry *keys)
{
    const node *const v = &p->nodes[i];
    size_t at = v->start + 1;
    int next = i + 1;
    write_until(p, v->start, at);
    mt_text_addf(p->out, "{\"~\":[%d", keys->place);
    for (size_t k = 0; k < keys->length / sizeof(int); k++) {
        int name = 0;
        memcpy(&name, keys->text + k * sizeof name, sizeof name);
        at += p->names.at[name].length;
        if (at >= v->end) {
            break; /* the document was cut there */
        }
        p->written = at;
        p->text[at++] = ','; /* instead of the colon */
        if (next < v->after && p->nodes[next].start == at) {
            write_part(p, next);
            at = p->nodes[next].end;
            next = p->nodes[next].after;
        } else {
            at = scalar_end(p, at);
        }
        write_until(p, at, at);
        at++; /* the comma */
    }
    mt_text_add_n(p->out, "]}", 2);
    p->written = v->end;
}

/* A list or object in full. */
static void write_node(packing *p, int i)
{
    const node *const v = &p->nodes[i];
    const entry *const keys = v->keys < 0 ? NULL : &p->keys.at[v->keys];
    if (keys != NULL && keys->place >= 0) {
        write_values(p, i, keys);
        return;
    }
    for (int k = i + 1; k < v->after; k = p->nodes[k].after) {
        write_part(p, k);
    }
}

static void write_names(packing *p, const entry *keys)
{
    mt_text_add_n(p->out, "[", 1);
    for (size_t k = 0; k < keys->length / sizeof(int); k++) {
        int name = 0;
        memcpy(&name, keys->text + k * sizeof name, sizeof name);
        mt_text_add_n(p->out, ",", k == 0 ? 0 : 1);
        mt_text_add_n(p->out, p->names.at[name].text, p->names.at[name].length);
    }
    mt_text_add_n(p->out, "]", 1);
}

static void write_tables(packing *p)
{
    const char *comma = "";
    mt_text_add(p->out, "[[");
    for (int i = 0; i < p->keys.n; i++) {
        if (p->keys.at[i].place >= 0) {
            mt_text_add(p->out, comma);
            write_names(p, &p->keys.at[i]);
            comma = ",";
        }
    }
    mt_text_add(p->out, "],[");
    comma = "";
    for (int i = 0; i < p->n; i++) {
        const node *const v = &p->nodes[i];
        const entry *const e = &p->values.at[v->class];
        if (e->place >= 0 && e->node == i) {
            mt_text_add(p->out, comma);
            p->written = v->start;
            write_node(p, i);
            write_until(p, v->end, v->end);
            comma = ",";
        }
    }
    mt_text_add(p->out, "],");
}

static void write_document(packing *p)
{
    if (p->reserved) {
        mt_text_add(p->out, "[[],[],");
    } else {
        index_repeated_parts(p);
        write_tables(p);
        p->written = 0;
    }
    if (p->n > 0 && !p->reserved) {
        write_part(p, 0);
    }
    write_until(p, p->length, p->length);
    mt_text_add(p->out, "]");
}

void mt_dedupe_json(const char *json, mt_text *out)
{
    packing *const p = calloc(1, sizeof *p);
    char *const text = malloc(room_of(json));
    bool words = false;
    if (p != NULL && text != NULL && mt_arena_init(&p->mem, 0, NULL) == MT_OK) {
        p->json = json;
        p->text = text;
        p->out = out;
        skip_space(p);
        read_value(p, &words);
        text[p->length] = '\0';
        if (mt_arena_check(&p->mem, NULL) == MT_OK) {
            write_document(p);
        } else {
            out->failed = true;
        }
        mt_arena_free(&p->mem);
    } else {
        out->failed = true;
    }
    free(text);
    free(p);
}
