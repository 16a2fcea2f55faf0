/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pages. */
#include "report/page.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/arena.h"
#include "base/base.h"
#include "base/number.h"
#include "base/sorted.h"
#include "report/design.h"
#include "report/page_heads.h"
#include "report/summary.h"
#include "report/table.h"

/*
 * Equal values have equal texts, as all numbers come from one writer. So each list and object
 * is given a class by its text, and a class that is met twice is shared; what lies within a
 * value that was met before does not count, since it will not be written. The same goes for the
 * names of objects.
 */

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
    const bool longer = length > sizeof word[0];
    const size_t n = longer ? sizeof word[0] : length;
    memcpy(&word[0], text, n);
    if (longer) {
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

/* What was asked. */

enum { NAMED = 4 }; /* of variables, requirements and configurations: more are counted */

/* Before item i of n: nothing, ", " or " and ". */
static const char *joint(int i, int n)
{
    return i == 0 ? "" : i + 1 < n ? ", " : " and ";
}

static void add_variables(const mt_result *result, mt_text *out)
{
    const int n = result->n_variables;
    if (n > NAMED) {
        mt_text_addf(out, "the %d variables", n);
    }
    for (int i = 0; i < n && n <= NAMED; i++) {
        mt_text_addf(out, "%s%s", joint(i, n), result->variables[i]);
    }
}

/* The requirement in words: "at 18 Hz", "clear of 2 bands". */
static const char *requirement_of(const mt_result_goal *g)
{
    const size_t n = strlen(g->quantity);
    return strncmp(g->text, g->quantity, n) == 0 ? g->text + n : "";
}

/* True where both rows belong to one goal of the study in several configurations: bands between
 * positions of a drive have the requirement of the positions. */
static bool asks_the_same(const mt_result_goal *a, const mt_result_goal *b)
{
    const bool motion = strcmp(b->type, "avoid") == 0 && b->configuration == NULL;
    return strcmp(a->pointer, b->pointer) == 0 &&
           (motion || strcmp(requirement_of(a), requirement_of(b)) == 0);
}

static bool is_first(const mt_recommendation *r, int i)
{
    for (int k = 0; k < i; k++) {
        if (asks_the_same(&r->goals[k], &r->goals[i])) {
            return false;
        }
    }
    return true;
}

/* "fwd mode 1 and aft mode 1 at least 20 Hz" */
static void add_requirement(const mt_recommendation *r, int first, mt_text *out)
{
    int n = 0;
    int told = 0;
    for (int i = first; i < r->n_goals; i++) {
        n += asks_the_same(&r->goals[first], &r->goals[i]) ? 1 : 0;
    }
    for (int i = first; i < r->n_goals && told < n && told < NAMED; i++) {
        if (asks_the_same(&r->goals[first], &r->goals[i])) {
            const int listed = n > NAMED ? NAMED + 1 : n;
            mt_text_addf(out, "%s%s", joint(told, listed), r->goals[i].quantity);
            told++;
        }
    }
    if (n > told) {
        mt_text_addf(out, " and %d others", n - told);
    }
    mt_text_add(out, requirement_of(&r->goals[first]));
}

static void add_requirements(const mt_recommendation *r, mt_text *out)
{
    int n = 0;
    int told = 0;
    for (int i = 0; i < r->n_goals; i++) {
        n += is_first(r, i) ? 1 : 0;
    }
    if (n > NAMED) {
        mt_text_addf(out, "all %d goals", n);
    }
    for (int i = 0; i < r->n_goals && n <= NAMED; i++) {
        if (is_first(r, i)) {
            mt_text_add(out, told == 0 ? "" : told + 1 < n ? "; " : "; and ");
            add_requirement(r, i, out);
            told++;
        }
    }
}

/* ", with the least mass of bar_*" */
static void add_objectives(const mt_result *result, mt_text *out)
{
    for (int i = 0; i < result->n_objectives; i++) {
        const mt_result_objective *const o = &result->objectives[i];
        const bool change = strcmp(o->type, "change") == 0;
        const bool clearance = strcmp(o->type, "clearance") == 0;
        mt_text_addf(out, "%s the %s %s", i == 0 ? ", with" : ", then",
                     clearance ? "greatest" : "least", change ? "total change" : o->text);
    }
}

static bool is_fit(const mt_recommendation *r)
{
    for (int i = 0; i < r->n_goals; i++) {
        if (!r->goals[i].weighted) {
            return false;
        }
    }
    return r->n_goals > 0;
}

/* The verb for the goals: a design fits data, keeps clear of bands, or holds numbers. */
static const char *verb_of(const mt_recommendation *r)
{
    bool bands = true;
    for (int i = 0; i < r->n_goals; i++) {
        bands = bands && strcmp(r->goals[i].type, "avoid") == 0;
    }
    return is_fit(r) ? "fit" : bands ? "keep" : "hold";
}

void mt_report_question(const mt_result *result, mt_text *out)
{
    const mt_recommendation *const r = result->baseline.n_goals > 0 ? &result->baseline
                                       : result->n_recommendations > 0
                                           ? &result->recommendations[0]
                                           : &result->baseline;
    if (r->n_goals == 0 && result->n_variables == 0) {
        mt_text_add(out, "What are the natural frequencies of the design as it is?");
        return;
    }
    if (result->n_variables == 0) {
        mt_text_addf(out, "%s the design as it is %s ", is_fit(r) ? "How well does" : "Does",
                     verb_of(r));
    } else {
        mt_text_add(out, "Which values of ");
        add_variables(result, out);
        mt_text_addf(out, " %s", r->n_goals == 0 ? "are best" : verb_of(r));
        mt_text_add(out, r->n_goals == 0 ? "" : " ");
    }
    add_requirements(r, out);
    if (result->n_variables > 0) {
        add_objectives(result, out);
    }
    mt_text_add(out, result->n_variables > 0 && is_fit(r) && result->n_objectives == 0
                         ? " best?"
                         : "?");
}

/* The title block. */

enum {
    INLINE = 6,  /* assumptions that a block has room for; more fold away */
    DIGEST = 12, /* of SHA-256: tells two issues of a file apart */
    VALUE_DIGITS = 6
};

static void open_definition(const char *term, mt_text *out)
{
    mt_text_addf(out, "<dt>%s</dt><dd>", term);
}

static void add_text(const char *term, const char *text, mt_text *out)
{
    if (text != NULL && text[0] != '\0') {
        open_definition(term, out);
        mt_html_escape(text, out);
        mt_text_add(out, "</dd>\n");
    }
}

/* "Inceptor (../problems/inceptor.json, SHA-256 e3b0c44298fc)" */
static void add_model(const mt_result *result, mt_text *out)
{
    const mt_result_source *const m = &result->model;
    if (m->file == NULL) {
        return;
    }
    open_definition("Model", out);
    mt_html_escape(m->name != NULL ? m->name : m->file, out);
    mt_text_add(out, m->name != NULL ? " (" : "");
    mt_html_escape(m->name != NULL ? m->file : "", out);
    for (int i = 0; i < result->run.n_inputs; i++) {
        const mt_result_digest *const d = &result->run.inputs[i];
        if (strcmp(d->file, m->file) == 0) {
            mt_text_addf(out, ", SHA-256 %.*s", DIGEST, d->sha256);
            break;
        }
    }
    mt_text_add(out, m->name != NULL ? ")</dd>\n" : "</dd>\n");
}

/* "k = 1200 N/m (Fig. 16)" */
static void add_assumption(const mt_result_assumption *a, mt_text *out)
{
    const char *const unit = a->display_unit != NULL ? a->display_unit : a->unit;
    const double value = mt_result_shown(a->value, a->display_factor);
    mt_html_escape(a->parameter, out);
    if (isfinite(value)) {
        mt_text_addf(out, " = %.*g", VALUE_DIGITS, value); /* no column: without its zeros */
        if (unit != NULL && unit[0] != '\0' && strcmp(unit, "1") != 0) {
            mt_text_add(out, " ");
            mt_html_escape(unit, out);
        }
    }
    if (a->source != NULL || a->variable) {
        mt_text_add(out, " (");
        mt_html_escape(a->source != NULL ? a->source : "", out);
        mt_text_add(out, a->source != NULL && a->variable ? "; " : "");
        mt_text_add(out, a->variable ? "before the change" : "");
        mt_text_add(out, ")");
    }
}

static void add_assumptions(const mt_result *result, mt_text *out)
{
    const int n = result->n_assumptions;
    if (n == 0) {
        return;
    }
    open_definition("Assumed", out);
    if (n > INLINE) {
        mt_text_addf(out, "<details><summary>%d parameters of the model</summary>\n", n);
    }
    for (int i = 0; i < n; i++) {
        mt_text_add(out, i == 0 ? "" : "; ");
        add_assumption(&result->assumptions[i], out);
    }
    mt_text_add(out, n > INLINE ? "</details></dd>\n" : "</dd>\n");
}

void mt_report_title(const mt_result *result, mt_text *out)
{
    mt_text question = {.s = NULL};
    mt_report_question(result, &question);
    mt_text_add(out, "<dl class=\"title\">\n");
    add_text("Question", question.s, out);
    add_text("Study", result->study.file, out);
    add_text("Author", result->study.author, out);
    add_text("Revision", result->study.revision, out);
    add_text("Date", result->study.date, out);
    add_model(result, out);
    add_assumptions(result, out);
    mt_text_add(out, "</dl>\n");
    out->failed = out->failed || question.failed;
    mt_text_free(&question);
}

/* Pages of all kinds. */

/* A page that begins like this one; NULL. */
static const mt_page_head *head_of(const char *page, size_t length)
{
    for (int i = 0; i < MT_PAGE_KINDS; i++) {
        const mt_page_head *const head = &mt_page_heads[i];
        if (length >= head->length && memcmp(page, head->text, head->length) == 0) {
            return head;
        }
    }
    return NULL;
}

void mt_page_sha256(const char *page, size_t length, char out[MT_SHA256_TEXT])
{
    const mt_page_head *const head = head_of(page, length);
    if (head == NULL) {
        mt_sha256(page, length, out);
    } else {
        mt_sha256_end(&head->start, page, length, out);
    }
}

void mt_page_begin(mt_page_kind kind, const char *title, mt_text *out)
{
    enum { OFTEN_ENOUGH = 256 * 1024 }; /* for what follows: the head is not copied again */
    mt_text_reserve(out, mt_page_heads[kind].length + OFTEN_ENOUGH);
    mt_text_add_n(out, mt_page_heads[kind].text, mt_page_heads[kind].length);
    mt_text_add(out, "<title>");
    mt_html_escape(title, out);
    mt_text_add(out, "</title>\n</head>\n<body>\n<main>\n<h1>");
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

void mt_page_end(int n, const mt_page_data *data, mt_text *out)
{
    mt_text_add(out, "</main>\n");
    for (int i = 0; i < n; i++) {
        if (data[i].json != NULL) {
            mt_text_addf(out, "<script type=\"application/json\" id=\"%s\">", data[i].id);
            mt_dedupe_json(data[i].json, out);
            mt_text_add(out, "</script>\n");
        }
    }
    mt_text_add(out, "</body>\n</html>\n");
}

/* Several studies in one table. */

enum { CHANGE_DIGITS = 4, TIME_DIGITS = 3 };

mt_table mt_report_index(const mt_index_study *studies, int n)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "study", "study", MT_ALIGN_LEFT);
    mt_table_column(&t, "status", "status", MT_ALIGN_LEFT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    mt_table_column(&t, "change", "change", MT_ALIGN_POINT);
    mt_table_column(&t, "time [s]", "time_s", MT_ALIGN_POINT);
    for (int i = 0; i < n; i++) {
        const mt_index_study *const s = &studies[i];
        mt_table_text(&t, s->path);
        mt_table_text(&t, s->status == NULL ? s->state : s->status);
        mt_table_text(&t, s->grade);
        mt_table_number(&t, s->change, CHANGE_DIGITS);
        mt_table_number(&t, s->seconds, TIME_DIGITS);
    }
    return t;
}

static void add_cell(const char *text, mt_text *out)
{
    mt_text_add(out, "<td>");
    mt_html_escape(text == NULL ? "-" : text, out);
    mt_text_add(out, "</td>");
}

static void add_study(const mt_index_study *s, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    mt_text_add(out, "<tr><td>");
    if (s->has_report) {
        mt_text_add(out, "<a href=\"");
        mt_text_add_uri(out, s->folder);
        mt_text_add(out, "/report.html\">");
    }
    mt_html_escape(s->file, out);
    mt_text_add(out, s->has_report ? "</a></td>" : "</td>");
    add_cell(s->name, out);
    add_cell(s->status == NULL ? s->state : s->status, out);
    add_cell(s->grade, out);
    mt_text_add(out, "<td class=\"n\">");
    mt_text_add(out, mt_report_number(s->change, CHANGE_DIGITS, number));
    mt_text_add(out, "</td>");
    add_cell(s->message == NULL ? "" : s->message, out);
    mt_text_add(out, "</tr>\n");
}

void mt_report_index_html(const mt_index_study *studies, int n, mt_text *out)
{
    mt_page_begin(MT_PAGE_PLAIN, "Studies", out);
    mt_text_add(out, "<table>\n<thead><tr><th>study</th><th>name</th><th>status</th>"
                     "<th>grade</th><th class=\"n\">change</th><th></th></tr></thead>\n"
                     "<tbody>\n");
    for (int i = 0; i < n; i++) {
        add_study(&studies[i], out);
    }
    mt_text_add(out, "</tbody>\n</table>\n");
    mt_page_end(0, NULL, out);
}

/* The abstract. */

enum { LISTED = 4, DIGITS = 3 };

/* "Solved: 2 designs ...": its first word is the status, and stands out. */
static void add_status(const mt_result *result, mt_text *out)
{
    const char *const status = mt_result_status_name(result->status);
    const char *const text = result->status_text == NULL ? "" : result->status_text;
    const size_t length = strlen(status);
    const bool led = strncasecmp(text, status, length) == 0;
    mt_text_addf(out, "<p class=\"status %s\"><b>", status);
    if (led) {
        mt_text_add_n(out, text, length);
    } else {
        mt_text_add(out, status);
    }
    mt_text_add(out, led ? "</b>" : "</b>: ");
    mt_html_escape(text + (led ? length : 0), out);
    mt_text_add(out, "</p>\n");
}

static void open_item(const char *word, mt_text *out)
{
    mt_text_addf(out, "<li><b>%s</b>: ", word);
}

static void close_item(mt_text *out)
{
    mt_text_add(out, "</li>\n");
}

/* Size of a change for sorting: a change from 0, which has no percentage, is the largest. */
static double change_size(const mt_result_parameter *p)
{
    const bool moved = p->recommended < p->original || p->recommended > p->original;
    return isfinite(p->change_percent) ? fabs(p->change_percent) : moved ? HUGE_VAL : 0.0;
}

/* "k +8.21 %", "k to 3.00 N/m" */
static void add_change(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    mt_html_escape(p->name, out);
    if (isfinite(p->change_percent)) {
        mt_text_addf(out, " %s %%", mt_report_change(p->change_percent, DIGITS, number));
        return;
    }
    mt_text_addf(out, " to %s", mt_report_number(p->recommended, DIGITS, number));
    if (p->unit != NULL && p->unit[0] != '\0') {
        mt_text_add(out, " ");
        mt_html_escape(p->unit, out);
    }
}

/* The parameter with the largest change among those that come behind `last`; -1: none. Equal
 * ones as they stand. */
static int next_largest(const mt_recommendation *r, int last)
{
    int found = -1;
    for (int i = 0; i < r->n_parameters; i++) {
        const double size = change_size(&r->parameters[i]);
        const double before = last < 0 ? HUGE_VAL : change_size(&r->parameters[last]);
        const bool behind = size < before || (size == before && i > last);
        if (size > 0.0 && behind && (found < 0 || size > change_size(&r->parameters[found]))) {
            found = i;
        }
    }
    return found;
}

static void add_changes(const mt_recommendation *r, mt_text *out)
{
    int changed = 0;
    for (int i = 0; i < r->n_parameters; i++) {
        changed += change_size(&r->parameters[i]) > 0.0 ? 1 : 0;
    }
    int told = 0;
    for (int i = next_largest(r, -1); i >= 0 && told < LISTED; i = next_largest(r, i)) {
        mt_text_add(out, told++ == 0 ? "" : ", ");
        add_change(&r->parameters[i], out);
    }
    if (changed > told) {
        mt_text_addf(out, " and %d other%s", changed - told, changed - told == 1 ? "" : "s");
    }
    mt_text_add(out, changed == 0 ? "no parameter changes" : "");
}

static void add_best(const mt_recommendation *r, mt_text *out)
{
    char change[MT_NUMBER_TEXT];
    mt_text headline = {.s = NULL};
    open_item("Best design", out);
    if (mt_report_headline(r, &headline)) {
        mt_html_escape(headline.s == NULL ? "" : headline.s, out);
        mt_text_add(out, "; ");
    }
    out->failed = out->failed || headline.failed;
    mt_text_free(&headline);
    add_changes(r, out);
    mt_text_add(out, ". Graded ");
    mt_html_escape(r->grade == NULL ? "not at all" : r->grade, out);
    mt_text_addf(out, "; total change %s.", mt_report_number(r->change, DIGITS, change));
    close_item(out);
}

/* Add the goals that decide the status, those without weights. */
static void add_goals(const mt_recommendation *r, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    int n = 0;
    int met = 0;
    for (int i = 0; i < r->n_goals; i++) {
        n += r->goals[i].weighted ? 0 : 1;
        met += !r->goals[i].weighted && r->goals[i].met ? 1 : 0;
    }
    if (n == 0 && isnan(r->misfit)) {
        return;
    }
    open_item("Goals", out);
    if (n > 0 && met == n) {
        mt_text_addf(out, n == 1 ? "the goal is met" : "all %d are met", n);
    } else if (n > 0) {
        mt_report_number(r->violation_percent, DIGITS, number);
        if (n == 1) {
            mt_text_addf(out, "the goal is missed by %s %%", number);
        } else {
            mt_text_addf(out, "%d of %d are met, others missed by %s %% at most", met, n,
                         number);
        }
    }
    if (!isnan(r->clearance_percent)) {
        mt_text_addf(out, "%s the least clearance from a band is %s %%", n > 0 ? ";" : "",
                     mt_report_number(r->clearance_percent, DIGITS, number));
    }
    if (!isnan(r->misfit)) {
        mt_text_addf(
            out, "%s the misfit is %s", n > 0 ? ";" : "",
            mt_report_number(mt_without_noise(r->misfit, MT_RATIO_NOISE), DIGITS, number));
    }
    mt_text_add(out, ".");
    close_item(out);
}

/* Add what is proven, in full; the unproven statements are many, and follow below. */
static void add_proof(const mt_result *result, mt_text *out)
{
    int sampled = 0;
    int proven = 0;
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        sampled += c->proven ? 0 : 1;
        if (c->proven && proven < LISTED) {
            if (proven++ == 0) {
                open_item("Proven", out);
            } else {
                mt_text_add(out, " ");
            }
            mt_html_escape(c->text, out);
        }
    }
    if (proven > 0) {
        close_item(out);
        return;
    }
    const char *const grade = result->recommendations[0].grade;
    const bool best = grade != NULL && strcmp(grade, "feasible and proven") == 0;
    open_item("Proven", out);
    mt_text_add(out, best                           ? "that the best design meets the goals."
                     : result->certificates == NULL ? "nothing: the run was stopped before."
                     : sampled > 0
                         ? "nothing; what was sampled is listed below."
                         : "nothing; designs were found by local searches from many starts.");
    close_item(out);
}

static void add_others(const mt_result *result, mt_text *out)
{
    const int others = result->n_recommendations - 1;
    if (others > 0) {
        open_item("Alternatives", out);
        mt_text_addf(out, "%d other recommendation%s.", others, others == 1 ? "" : "s");
        close_item(out);
    }
}

void mt_report_abstract(const mt_result *result, mt_text *out)
{
    add_status(result, out);
    if (result->n_recommendations == 0) {
        return;
    }
    mt_text_add(out, "<ul class=\"gist\">\n");
    add_best(&result->recommendations[0], out);
    add_goals(&result->recommendations[0], out);
    add_proof(result, out);
    add_others(result, out);
    mt_text_add(out, "</ul>\n");
}

/* The report of a study as one page: what was asked, what to change, why, and how far to trust
 * it. */

static void add_footer(const mt_result_run *run, mt_text *out)
{
    mt_text_add(out, "<footer class=\"drawn\">modetune ");
    mt_html_escape(run->modetune_version == NULL ? "" : run->modetune_version, out);
    mt_text_add(out, " (");
    mt_html_escape(run->build.commit == NULL ? "" : run->build.commit, out);
    mt_text_addf(out, "), seed %ld, %d starts, ", run->seed, run->starts);
    mt_report_work_counters(run, out);
    mt_text_add(out, ".");
    for (int i = 0; i < run->n_inputs; i++) {
        mt_text_add(out, "<br>");
        mt_html_escape(run->inputs[i].file, out);
        mt_text_add(out, ": sha256 ");
        mt_html_escape(run->inputs[i].sha256, out);
    }
    mt_text_add(out, "</footer>\n");
}

void mt_report_html_told(const mt_result *result, mt_text *out)
{
    mt_report_title(result, out);
    mt_report_abstract(result, out);
    mt_text_add(out, "<noscript><p>Figures are drawn by the page's own script, which is "
                     "switched off here.</p></noscript>\n");
    mt_write_page(out, result);
    add_footer(&result->run, out);
}

void mt_report_html(const mt_result *result, const char *json, const char *scene, mt_text *out)
{
    const mt_page_data data[] = {{"data", json}, {"scene", scene}};
    const char *const name = result->study.name != NULL   ? result->study.name
                             : result->study.file != NULL ? result->study.file
                                                          : "study";
    const mt_page_kind kind = scene == NULL ? MT_PAGE_REPORT : MT_PAGE_REPORT_SCENE;
    mt_page_begin(kind, name, out);
    mt_report_html_told(result, out);
    mt_page_end(MT_COUNT(data), data, out);
}
