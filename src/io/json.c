/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The document: the scanner says whether the text is JSON, cJSON builds it. Both go through it
 * in the same order, which makes the scanner's spots the addresses of cJSON's items.
 *
 * cJSON reads numbers as the C library does, correctly rounded, but with the decimal point of
 * the locale, and not beyond the 63rd character. So this thread is in the locale "C" while it
 * reads, and longer numbers are 0 to it and read here.
 */
#include "io/json_priv.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#    include <malloc.h>
#endif

#include "io/json_print.h"
#include "io/locale.h"

/* LARGE: a text whose items are worth giving back to the system. */
enum { CJSON_NUMBER_MOST = 63, CJSON_TYPE = 0xFF, LARGE = 1 << 20 };

/* The item of a value's address; NULL for other addresses. */
static cJSON *item_of(const mt_json *doc, mt_addr value)
{
    return doc->items != NULL && value >= 0 && value < doc->spots.n ? doc->items[value] : NULL;
}

static mt_addr addr_of(const cJSON *item)
{
    return item == NULL ? MT_NO_ADDR : item->valueint;
}

/* Bytes of the number at a spot; 0 where there stands something else. */
static size_t number_length(const mt_json *doc, mt_addr value)
{
    const char *const s = doc->text + doc->spots.items[value].start;
    size_t n = 0; /* no strspn: a checked build measures the whole rest of the text for it */
    while (s[n] != '\0' && strchr("+-.0123456789eE", s[n]) != NULL) {
        n++;
    }
    return n;
}

/* The text as cJSON can read it: every number that is too long for it is 0 and blanks. */
static char *without_long_numbers(mt_json *doc, mt_arena *mem)
{
    char *const copy = mt_arena_strndup(mem, doc->text, doc->length);
    for (int i = 0; copy != NULL && i < doc->spots.n; i++) {
        const size_t n = number_length(doc, i);
        if (n > CJSON_NUMBER_MOST) {
            memset(copy + doc->spots.items[i].start, ' ', n);
            copy[doc->spots.items[i].start] = '0';
        }
    }
    return copy;
}

/* Link addresses and items. False where scanner and cJSON disagree: a bug. */
static bool link_items(mt_json *doc)
{
    cJSON *outer[MT_JSON_MAX_DEPTH];
    int depth = 0;
    int n = 0;
    for (cJSON *at = doc->tree; at != NULL;) {
        if (n == doc->spots.n || (at->child != NULL && depth == MT_JSON_MAX_DEPTH)) {
            return false;
        }
        at->valueint = n;
        doc->items[n++] = at;
        if (at->child != NULL) {
            outer[depth++] = at;
            at = at->child;
            continue;
        }
        while (at->next == NULL && depth > 0) {
            at = outer[--depth];
        }
        at = at->next;
    }
    return n == doc->spots.n;
}

/* The numbers that cJSON has not read; those beyond the range of a double are noted, and the
 * largest one stands for them. */
static void finish_numbers(mt_json *doc)
{
    for (int i = 0; i < doc->spots.n; i++) {
        cJSON *const item = doc->items[i];
        if (!cJSON_IsNumber(item)) {
            continue;
        }
        if (number_length(doc, i) > CJSON_NUMBER_MOST) {
            item->valuedouble = strtod(doc->text + doc->spots.items[i].start, NULL);
        }
        if (!isfinite(item->valuedouble)) {
            mt_diag_error(&doc->diags, i, "the number is beyond the range of a double");
            item->valuedouble = item->valuedouble < 0.0 ? -DBL_MAX : DBL_MAX;
        }
    }
}

static int compare_names(const void *a, const void *b)
{
    const cJSON *const x = *(cJSON *const *)a;
    const cJSON *const y = *(cJSON *const *)b;
    const int order = strcmp(x->string, y->string);
    return order != 0 ? order : (x->valueint > y->valueint) - (x->valueint < y->valueint);
}

static void note_duplicate(mt_json *doc, const cJSON *first, const cJSON *again)
{
    const mt_addr at = mt_json_name_addr(doc, again->valueint);
    if (mt_diag_may_suggest(&doc->diags)) { /* finding a line takes a walk through the text */
        int line = 0;
        int column = 0;
        mt_json_locate(doc, mt_json_name_addr(doc, first->valueint), &line, &column);
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice, first in line %d",
                      again->string, line);
    } else {
        mt_diag_error(&doc->diags, at, "member \"%s\" is given twice", again->string);
    }
}

/* Note names that an object has twice, and take all members but the first out of it. Sorted by
 * name, so that a large object takes no longer than its text; members has room for all. */
static void take_out_duplicates(mt_json *doc, cJSON *object, cJSON **members)
{
    size_t n = 0;
    for (cJSON *m = object->child; m != NULL; m = m->next) {
        members[n++] = m;
    }
    qsort(members, n, sizeof(cJSON *), compare_names);
    for (size_t first = 0, i = 1; i < n; i++) {
        if (strcmp(members[first]->string, members[i]->string) != 0) {
            first = i;
            continue;
        }
        note_duplicate(doc, members[first], members[i]);
        cJSON_AddItemToArray(doc->duplicates, cJSON_DetachItemViaPointer(object, members[i]));
    }
}

/* Let cJSON build the values of a scanned text: of a document. */
static mt_status build(void *context, mt_err *err)
{
    mt_json *const doc = context;
    mt_arena scratch = {.first = NULL};
    const size_t n = (size_t)doc->spots.n;
    const char *const text = without_long_numbers(doc, &scratch);
    /* NOLINTBEGIN(bugprone-sizeof-expression): pointers are what is meant */
    cJSON **const members = mt_arena_alloc(&scratch, n, sizeof *members);
    doc->items = mt_arena_alloc(&doc->mem, n, sizeof *doc->items);
    /* NOLINTEND(bugprone-sizeof-expression) */
    doc->duplicates = cJSON_CreateArray();
    if (mt_arena_failed(&scratch) || mt_arena_failed(&doc->mem) || doc->duplicates == NULL) {
        mt_arena_free(&scratch);
        return mt_fail_memory(err);
    }
    doc->tree = cJSON_ParseWithLengthOpts(text, doc->length + 1, NULL, true);
    mt_status rc = MT_OK;
    if (doc->tree == NULL) {
        rc = mt_fail_memory(err); /* the text is valid: only memory can be the reason */
    } else if (!link_items(doc)) {
        rc = mt_fail(err, MT_E_INTERNAL, "scanner and cJSON disagree");
    }
    if (rc == MT_OK) {
        finish_numbers(doc);
    }
    for (size_t i = 0; rc == MT_OK && i < n; i++) {
        if (cJSON_IsObject(doc->items[i])) {
            take_out_duplicates(doc, doc->items[i], members);
        }
    }
    mt_arena_free(&scratch);
    return rc;
}

static mt_addr lookup_member(const void *document, mt_addr object, const char *member)
{
    return mt_json_member(document, object, member);
}

mt_status mt_json_parse(const char *text, size_t length, mt_json **out, mt_err *err)
{
    *out = NULL;
    mt_json *const doc = calloc(1, sizeof *doc);
    if (doc == NULL) {
        return mt_fail_memory(err);
    }
    /* of a text that is too long only the start is of use */
    doc->length = length > MT_JSON_MAX_BYTES ? 0 : length;
    doc->diags = mt_diags_default(&doc->mem);
    doc->diags.document = doc;
    doc->diags.lookup = lookup_member;
    doc->spots.most = MT_JSON_MAX_VALUES;
    doc->text = mt_arena_strndup(&doc->mem, text, doc->length);
    mt_status rc = mt_arena_check(&doc->mem, err);
    if (rc == MT_OK) {
        mt_json_scan(doc->text, length, &doc->spots, &doc->diags);
        rc = mt_arena_check(&doc->mem, err);
    }
    if (rc == MT_OK && doc->diags.errors > 0) {
        *out = doc;
        return mt_fail(err, MT_E_INPUT, "the text is not JSON");
    }
    if (rc == MT_OK) {
        rc = mt_locale_plain(build, doc, err);
    }
    if (rc == MT_OK) {
        rc = mt_arena_check(&doc->mem, err);
    }
    if (rc != MT_OK) {
        mt_json_delete(doc);
        return rc;
    }
    *out = doc;
    return MT_OK;
}

void mt_json_delete(mt_json *doc)
{
    if (doc == NULL) {
        return;
    }
    const bool large = doc->length >= LARGE;
    cJSON_Delete(doc->tree);
    cJSON_Delete(doc->duplicates);
    mt_arena_free(&doc->mem);
    free(doc);
#ifdef __GLIBC__
    if (large) { /* seven times the text lies in pieces below what was made of it */
        (void)malloc_trim(0);
    }
#else
    (void)large;
#endif
}

mt_diags *mt_json_diags(mt_json *doc)
{
    return &doc->diags;
}

mt_json_type mt_json_type_of(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    switch (item == NULL ? cJSON_NULL : item->type & CJSON_TYPE) {
    case cJSON_False:
    case cJSON_True:
        return MT_JSON_BOOL;
    case cJSON_Number:
        return MT_JSON_NUMBER;
    case cJSON_String:
        return MT_JSON_STRING;
    case cJSON_Array:
        return MT_JSON_ARRAY;
    case cJSON_Object:
        return MT_JSON_OBJECT;
    default:
        return MT_JSON_NULL;
    }
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
    const char *const s = cJSON_GetStringValue(item_of(doc, value));
    return s == NULL ? "" : s;
}

double mt_json_number(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? 0.0 : item->valuedouble;
}

bool mt_json_bool(const mt_json *doc, mt_addr value)
{
    return cJSON_IsTrue(item_of(doc, value)) != 0;
}

int mt_json_count(const mt_json *doc, mt_addr value)
{
    return cJSON_GetArraySize(item_of(doc, value));
}

mt_addr mt_json_first(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? MT_NO_ADDR : addr_of(item->child);
}

mt_addr mt_json_next(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? MT_NO_ADDR : addr_of(item->next);
}

mt_addr mt_json_member(const mt_json *doc, mt_addr value, const char *name)
{
    const cJSON *const item = item_of(doc, value);
    return cJSON_IsObject(item) ? addr_of(cJSON_GetObjectItemCaseSensitive(item, name))
                                : MT_NO_ADDR;
}

const char *mt_json_name(const mt_json *doc, mt_addr value)
{
    const cJSON *const item = item_of(doc, value);
    return item == NULL ? NULL : item->string;
}

mt_addr mt_json_name_addr(const mt_json *doc, mt_addr value)
{
    return item_of(doc, value) == NULL || doc->spots.items[value].name == 0
               ? value
               : doc->spots.n + value;
}

bool mt_json_span(const mt_json *doc, mt_addr value, size_t *begin, size_t *end)
{
    const cJSON *const item = item_of(doc, value);
    if (!cJSON_IsNumber(item) && !cJSON_IsString(item)) {
        return false;
    }
    *begin = doc->spots.items[value].start;
    *end = *begin + number_length(doc, value);
    if (cJSON_IsString(item)) {
        for (*end = *begin + 1; doc->text[*end] != '"'; ++*end) {
            *end += doc->text[*end] == '\\';
        }
        ++*end;
    }
    return true;
}
