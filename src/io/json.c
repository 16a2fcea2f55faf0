/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The document: text, scanned nodes and cJSON's tree side by side. cJSON gets a copy of the
 * text in which every number is 0: it cuts numbers off at 63 characters, so that ours are read
 * from the source, by strtod, with the decimal point of the locale in place of ours (the C
 * library rounds correctly).
 */
#include "io/json_priv.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_value(const mt_json *doc, mt_addr value)
{
    return value >= 0 && value < doc->count && doc->nodes[value].item != NULL;
}

/* The source with all numbers replaced by 0 and spaces; heap. */
static char *without_numbers(const mt_json *doc)
{
    char *const copy = malloc(doc->length + 1);
    if (copy == NULL) {
        return NULL;
    }
    memcpy(copy, doc->text, doc->length + 1);
    for (int i = 0; i < doc->count; i++) {
        const mt_json_node *const node = &doc->nodes[i];
        if (node->type == MT_JSON_NUMBER) {
            memset(copy + node->start, ' ', node->end - node->start);
            copy[node->start] = '0';
        }
    }
    return copy;
}

/* Give every node its cJSON item. False where the two trees differ: a bug. */
static bool link_items(mt_json *doc)
{
    doc->nodes[MT_JSON_ROOT].item = doc->tree;
    for (int i = 0; i < doc->count; i++) {
        const mt_json_node *const node = &doc->nodes[i];
        if (node->type != MT_JSON_ARRAY && node->type != MT_JSON_OBJECT) {
            continue;
        }
        cJSON *item = node->item->child;
        mt_addr child = i + 1;
        for (int k = 0; k < node->children; k++) {
            if (item == NULL || child == MT_NO_ADDR) {
                return false;
            }
            doc->nodes[child].item = item;
            item = item->next;
            child = doc->nodes[child].next;
        }
        if (item != NULL) {
            return false;
        }
    }
    return true;
}

/* How this locale writes the decimal point, found by writing one. */
static void decimal_point(char *point, size_t size)
{
    char half[32];
    const int n = snprintf(half, sizeof half, "%.1f", 0.5); /* "0", the point, "5" */
    const size_t length = n > 2 ? (size_t)n - 2 : 0;
    if (length == 0 || length >= size) {
        (void)snprintf(point, size, ".");
        return;
    }
    memcpy(point, half + 1, length);
    point[length] = '\0';
}

/* The value of one number; beyond the range of a double it is noted and the largest one stands
 * for it. */
static bool read_number(mt_json *doc, mt_addr value, const char *point)
{
    const mt_json_node *const node = &doc->nodes[value];
    const char *const source = doc->text + node->start;
    const size_t n = node->end - node->start;
    const char *const dot = memchr(source, '.', n);
    const size_t before = dot == NULL ? n : (size_t)(dot - source);
    const mt_arena_mark mark = mt_arena_get_mark(&doc->mem);
    const char *const text = dot == NULL
                                 ? mt_arena_printf(&doc->mem, "%.*s", (int)n, source)
                                 : mt_arena_printf(&doc->mem, "%.*s%s%.*s", (int)before, source,
                                                   point, (int)(n - before - 1), dot + 1);
    if (text == NULL) {
        return false;
    }
    double number = strtod(text, NULL);
    mt_arena_rewind(&doc->mem, mark);
    if (!isfinite(number)) {
        mt_diag_error(&doc->diags, value, "the number is beyond the range of a double");
        number = number < 0.0 ? -DBL_MAX : DBL_MAX;
    }
    node->item->valuedouble = number;
    return true;
}

static bool read_numbers(mt_json *doc)
{
    char point[8];
    decimal_point(point, sizeof point);
    for (int i = 0; i < doc->count; i++) {
        if (doc->nodes[i].type == MT_JSON_NUMBER && !read_number(doc, i, point)) {
            return false;
        }
    }
    return true;
}

typedef struct member {
    int parent;
    mt_addr value;
    const char *name;
} member;

static int compare_members(const void *a, const void *b)
{
    const member *const x = a;
    const member *const y = b;
    if (x->parent != y->parent) {
        return x->parent < y->parent ? -1 : 1;
    }
    const int order = strcmp(x->name, y->name);
    return order != 0 ? order : (x->value > y->value) - (x->value < y->value);
}

static void note_duplicate(mt_json *doc, const member *first, const member *again)
{
    const mt_addr at = mt_json_name_addr(doc, again->value);
    if (mt_diag_may_suggest(&doc->diags)) { /* finding a line takes a walk through the text */
        int line = 0;
        int column = 0;
        mt_json_place(doc, mt_json_name_addr(doc, first->value), &line, &column);
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice, first in line %d",
                      again->name, line);
    } else {
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice", again->name);
    }
}

/* Note names that an object has twice: all members sorted by object, name, place. */
static bool find_duplicates(mt_json *doc)
{
    member *const members = malloc((size_t)doc->count * sizeof *members);
    if (members == NULL) {
        return false;
    }
    size_t n = 0;
    for (int i = 1; i < doc->count; i++) {
        if (doc->nodes[i].name != 0) {
            members[n++] = (member){doc->nodes[i].parent, i, doc->nodes[i].item->string};
        }
    }
    qsort(members, n, sizeof *members, compare_members);
    size_t first = 0; /* of those equal to the one before i */
    for (size_t i = 1; i < n; i++) {
        if (members[i].parent != members[first].parent ||
            strcmp(members[i].name, members[first].name) != 0) {
            first = i;
            continue;
        }
        doc->nodes[members[i].value].duplicate = true;
        doc->nodes[members[i].parent].children--;
        note_duplicate(doc, &members[first], &members[i]);
    }
    free(members);
    return true;
}

/* Let cJSON build the values of a scanned text. */
static mt_status build(mt_json *doc, mt_err *err)
{
    char *const copy = without_numbers(doc);
    if (copy == NULL) {
        return mt_fail_memory(err);
    }
    doc->tree = cJSON_ParseWithLengthOpts(copy, doc->length + 1, NULL, true);
    free(copy);
    if (doc->tree == NULL) {
        return mt_fail_memory(err); /* the text is valid: only memory can be the reason */
    }
    if (!link_items(doc)) {
        return mt_fail(err, MT_E_INTERNAL, "scanner and cJSON disagree");
    }
    if (!read_numbers(doc) || !find_duplicates(doc) || mt_arena_failed(doc->diags.mem)) {
        return mt_fail_memory(err);
    }
    return MT_OK;
}

mt_status mt_json_parse(const char *text, size_t length, mt_json **out, mt_err *err)
{
    *out = NULL;
    mt_json *const doc = calloc(1, sizeof *doc);
    if (doc == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = mt_arena_init(&doc->mem, 0, err);
    if (rc != MT_OK) {
        goto done;
    }
    doc->diags = mt_diags_default(&doc->mem);
    doc->length = length;
    /* of a text that is too long only the start is of use */
    const size_t kept = length > MT_JSON_MAX_BYTES ? 0 : length;
    doc->text = mt_arena_strndup(&doc->mem, text, kept);
    if (doc->text == NULL) {
        rc = mt_fail_memory(err);
        goto done;
    }
    rc = mt_json_scan(doc, err);
    doc->length = kept;
    if (rc == MT_OK) {
        rc = build(doc, err);
    }
done:
    if (rc == MT_OK || rc == MT_E_INPUT) {
        *out = doc;
    } else {
        mt_json_delete(doc);
    }
    return rc;
}

void mt_json_delete(mt_json *doc)
{
    if (doc == NULL) {
        return;
    }
    cJSON_Delete(doc->tree);
    mt_arena_free(&doc->mem);
    free(doc);
}

mt_diags *mt_json_diags(mt_json *doc)
{
    return &doc->diags;
}

mt_json_type mt_json_type_of(const mt_json *doc, mt_addr value)
{
    return is_value(doc, value) ? (mt_json_type)doc->nodes[value].type : MT_JSON_NULL;
}

const char *mt_json_type_text(mt_json_type type)
{
    switch (type) {
    case MT_JSON_NULL:
        return "null";
    case MT_JSON_BOOL:
        return "true or false";
    case MT_JSON_NUMBER:
        return "a number";
    case MT_JSON_STRING:
        return "a string";
    case MT_JSON_ARRAY:
        return "a list";
    case MT_JSON_OBJECT:
        return "an object";
    }
    return "nothing";
}

const char *mt_json_string(const mt_json *doc, mt_addr value)
{
    const char *const s = is_value(doc, value) ? doc->nodes[value].item->valuestring : NULL;
    return s == NULL ? "" : s;
}

double mt_json_number(const mt_json *doc, mt_addr value)
{
    return is_value(doc, value) ? doc->nodes[value].item->valuedouble : 0.0;
}

bool mt_json_bool(const mt_json *doc, mt_addr value)
{
    return is_value(doc, value) && cJSON_IsTrue(doc->nodes[value].item);
}

int mt_json_count(const mt_json *doc, mt_addr value)
{
    return is_value(doc, value) ? doc->nodes[value].children : 0;
}

mt_addr mt_json_first(const mt_json *doc, mt_addr value)
{
    return mt_json_count(doc, value) > 0 ? value + 1 : MT_NO_ADDR;
}

mt_addr mt_json_next(const mt_json *doc, mt_addr value)
{
    if (!is_value(doc, value)) {
        return MT_NO_ADDR;
    }
    mt_addr next = doc->nodes[value].next;
    while (next != MT_NO_ADDR && doc->nodes[next].duplicate) {
        next = doc->nodes[next].next;
    }
    return next;
}

mt_addr mt_json_member(const mt_json *doc, mt_addr value, const char *name)
{
    if (mt_json_type_of(doc, value) != MT_JSON_OBJECT) {
        return MT_NO_ADDR;
    }
    for (mt_addr m = mt_json_first(doc, value); m != MT_NO_ADDR; m = mt_json_next(doc, m)) {
        if (strcmp(doc->nodes[m].item->string, name) == 0) {
            return m;
        }
    }
    return MT_NO_ADDR;
}

const char *mt_json_name(const mt_json *doc, mt_addr value)
{
    return is_value(doc, value) ? doc->nodes[value].item->string : NULL;
}

mt_addr mt_json_name_addr(const mt_json *doc, mt_addr value)
{
    return value < 0 || doc->nodes[value].name == 0 ? value : doc->count + value;
}
