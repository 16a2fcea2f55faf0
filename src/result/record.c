/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/record.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

void mt_record_clear(const mt_record *record, void *item)
{
    memset(item, 0, record->size);
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        void *const at = (char *)item + f->offset;
        if (f->type == MT_FIELD_NUMBER || f->type == MT_FIELD_VALUE) {
            *(double *)at = nan("");
        } else if (f->type == MT_FIELD_COUNT && f->nullable) {
            *(int *)at = f->least - 1;
        } else if (f->type == MT_FIELD_LONG && f->nullable) {
            *(long *)at = f->least - 1;
        } else if (f->type == MT_FIELD_RECORD) {
            mt_record_clear(f->record, at);
        }
    }
}

/* Replace n borrowed items, if there are any, by their copy; returns it. */
static void *own_items(void *at, int n, size_t size, mt_arena *mem)
{
    const void *const from = mt_record_get_pointer(at);
    void *const own = from == NULL ? NULL : mt_arena_alloc(mem, (size_t)n, size);
    if (own != NULL && n > 0) {
        memcpy(own, from, (size_t)n * size);
    }
    mt_record_set_pointer(at, own);
    return own;
}

/* Take the text of `like` where it is equal, else a copy; returns true where equal. */
static bool own_text(const char **text, const char *like, mt_arena *mem)
{
    const bool same = *text == NULL ? like == NULL : like != NULL && strcmp(*text, like) == 0;
    if (same) {
        *text = like;
    } else if (*text != NULL) {
        *text = mt_arena_strdup(mem, *text);
    }
    return same;
}

/* A list of the record that is copied, and that which may have it already. */
typedef struct twins {
    void *at; /* where its pointer lies */
    int n;
    const void *like; /* its items; NULL: none */
    int n_like;
    size_t size; /* of an item */
} twins;

/* A copy of plain numbers, or those of `like`. */
static bool own_numbers(const twins *t, mt_arena *mem)
{
    const void *const from = mt_record_get_pointer(t->at);
    const bool there = from != NULL && t->like != NULL && t->n == t->n_like;
    if (from == NULL) {
        return t->like == NULL;
    }
    if (there && memcmp(from, t->like, (size_t)t->n * t->size) == 0) {
        mt_record_set_pointer(t->at, t->like);
        return true;
    }
    (void)own_items(t->at, t->n, t->size, mem);
    return false;
}

static bool own_texts(const twins *t, mt_arena *mem)
{
    const char *const *const like = t->like;
    const char **const texts = own_items(t->at, t->n, t->size, mem);
    bool same = texts == NULL ? like == NULL : t->n == t->n_like;
    for (int i = 0; i < t->n && texts != NULL; i++) {
        const bool own =
            own_text(&texts[i], like != NULL && i < t->n_like ? like[i] : NULL, mem);
        same = same && own;
    }
    return same;
}

static bool own(const mt_record *record, void *item, const void *like, int n_variables,
                mt_arena *mem);

/* Take the list of `like` where it is equal in every item. */
static bool own_list(const mt_record *record, const twins *t, int n_variables, mt_arena *mem)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    char *const items = own_items(t->at, t->n, t->size, mem);
    bool same = items == NULL ? t->like == NULL : t->like != NULL && t->n == t->n_like;
    for (int i = 0; i < t->n && items != NULL; i++) {
        const size_t k = (size_t)i * t->size;
        const char *const other =
            t->like != NULL && i < t->n_like ? (const char *)t->like + k : NULL;
        const bool twin = own(record, items + k, other, n_variables, mem);
        same = same && twin;
    }
    if (same && items != NULL) {
        mt_arena_rewind(mem, mark);
        mt_record_set_pointer(t->at, t->like);
    }
    return same;
}

/* Numbers of items of the lists of a record; like NULL: no other record. */
static void read_counts(twins *t, const char *at, const char *like)
{
    memcpy(&t->n, at, sizeof t->n);
    memcpy(&t->n_like, like == NULL ? at : like, sizeof t->n_like);
}

/* One member of an item; like: the same member of another; NULL: none. */
static bool own_field(const mt_field *f, void *item, const void *like, int n_variables,
                      mt_arena *mem)
{
    char *const at = (char *)item + f->offset;
    char *const other = (char *)item + f->other;
    const char *const at_like = like == NULL ? NULL : (const char *)like + f->offset;
    const char *const other_like = like == NULL ? NULL : (const char *)like + f->other;
    twins t = {.at = at,
               .n = 1,
               .like = like == NULL ? NULL : mt_record_get_pointer(at_like),
               .n_like = 1,
               .size = sizeof(double)};
    switch (f->type) {
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
        return own_text((const char **)(void *)at, t.like, mem);
    case MT_FIELD_VALUE:
        t.like = like == NULL ? NULL : mt_record_get_pointer(other_like);
        return own_text((const char **)(void *)other, t.like, mem) && like != NULL &&
               memcmp(at, at_like, sizeof(double)) == 0;
    case MT_FIELD_RECORD:
        return own(f->record, at, at_like, n_variables, mem);
    case MT_FIELD_OPTION:
        t.size = f->record->size;
        return own_list(f->record, &t, n_variables, mem);
    case MT_FIELD_LIST:
        t.size = f->record->size;
        read_counts(&t, other, other_like);
        return own_list(f->record, &t, n_variables, mem);
    case MT_FIELD_TEXTS:
        t.size = sizeof(char *);
        read_counts(&t, other, other_like);
        return own_texts(&t, mem);
    case MT_FIELD_NUMBERS:
        read_counts(&t, other, other_like);
        return own_numbers(&t, mem);
    case MT_FIELD_FORMAT:
        return true;
    case MT_FIELD_BY_VARIABLE:
        t.n = n_variables;
        t.n_like = n_variables;
        return own_numbers(&t, mem);
    case MT_FIELD_NUMBER:
        return like != NULL && memcmp(at, at_like, sizeof(double)) == 0;
    case MT_FIELD_LONG:
        return like != NULL && memcmp(at, at_like, sizeof(long)) == 0;
    case MT_FIELD_ENUM:
    case MT_FIELD_COUNT:
        return like != NULL && memcmp(at, at_like, sizeof(int)) == 0;
    case MT_FIELD_FLAG:
        return like != NULL && memcmp(at, at_like, sizeof(bool)) == 0;
    case MT_FIELD_TYPE_COUNT:
        break;
    }
    return false;
}

/* Own all members of an item; returns true where `like` (NULL: none) is equal in every
 * member. */
static bool own(const mt_record *record, void *item, const void *like, int n_variables,
                mt_arena *mem)
{
    bool same = like != NULL;
    for (int i = 0; i < record->n; i++) {
        const bool twin = own_field(&record->fields[i], item, like, n_variables, mem);
        same = same && twin;
    }
    return same;
}

void mt_record_own(const mt_record *record, void *item, const void *like, int n_variables,
                   mt_arena *mem)
{
    (void)own(record, item, like, n_variables, mem);
}

/* Numbers, texts or structs that a member points to, `size` bytes each; NULL is kept as NULL,
 * and there are none of it. */
static void *serialize_items(void *at, int *n, size_t size, mt_serializer *serializer,
                             mt_arena *mem)
{
    bool there = mt_record_get_pointer(at) != NULL;
    mt_serializer_flag(serializer, &there);
    if (!there) {
        mt_record_set_pointer(at, NULL);
        *n = 0;
        return NULL;
    }
    void *const items =
        mt_serializer_items(serializer, n, size, mt_record_get_pointer(at), mem);
    mt_record_set_pointer(at, items);
    return items;
}

static void serialize_list(const mt_record *record, void *at, int *n, int n_variables,
                           mt_serializer *serializer, mt_arena *mem)
{
    char *const items = serialize_items(at, n, record->size, serializer, mem);
    for (int i = 0; i < *n && items != NULL && !serializer->failed; i++) {
        mt_record_serialize(record, items + ((size_t)i * record->size), n_variables, serializer,
                            mem);
    }
}

static void serialize_numbers(void *at, int *n, mt_serializer *serializer, mt_arena *mem)
{
    double *const numbers = serialize_items(at, n, sizeof *numbers, serializer, mem);
    if (numbers != NULL) {
        mt_serializer_numbers(serializer, (size_t)*n, numbers);
    }
}

static void serialize_texts(void *at, int *n, mt_serializer *serializer, mt_arena *mem)
{
    const char **const texts = serialize_items(at, n, sizeof *texts, serializer, mem);
    for (int i = 0; i < *n && texts != NULL && !serializer->failed; i++) {
        mt_serializer_text(serializer, &texts[i], mem);
    }
}

static void serialize_field(const mt_field *f, void *at, void *other, int n_variables,
                            mt_serializer *serializer, mt_arena *mem)
{
    int one = 1;
    int size = n_variables;
    switch (f->type) {
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
        mt_serializer_text(serializer, at, mem);
        break;
    case MT_FIELD_VALUE:
        mt_serializer_numbers(serializer, 1, at);
        mt_serializer_text(serializer, other, mem);
        break;
    case MT_FIELD_NUMBER:
        mt_serializer_numbers(serializer, 1, at);
        break;
    case MT_FIELD_ENUM:
        mt_serializer_int(serializer, at, 0, f->n_choices - 1);
        break;
    case MT_FIELD_COUNT:
        mt_serializer_int(serializer, at, INT_MIN, INT_MAX);
        break;
    case MT_FIELD_LONG:
        mt_serializer_long(serializer, at, LONG_MIN, LONG_MAX);
        break;
    case MT_FIELD_FLAG:
        mt_serializer_flag(serializer, at);
        break;
    case MT_FIELD_RECORD:
        mt_record_serialize(f->record, at, n_variables, serializer, mem);
        break;
    case MT_FIELD_OPTION:
        serialize_list(f->record, at, &one, n_variables, serializer, mem);
        serializer->failed =
            serializer->failed || one != (mt_record_get_pointer(at) != NULL ? 1 : 0);
        break;
    case MT_FIELD_LIST:
        serialize_list(f->record, at, other, n_variables, serializer, mem);
        break;
    case MT_FIELD_TEXTS:
        serialize_texts(at, other, serializer, mem);
        break;
    case MT_FIELD_NUMBERS:
        serialize_numbers(at, other, serializer, mem);
        break;
    case MT_FIELD_BY_VARIABLE:
        serialize_numbers(at, &size, serializer, mem);
        serializer->failed = serializer->failed || (size != 0 && size != n_variables);
        break;
    case MT_FIELD_FORMAT:
    case MT_FIELD_TYPE_COUNT:
        break;
    }
}

void mt_record_serialize(const mt_record *record, void *item, int n_variables,
                         mt_serializer *serializer, mt_arena *mem)
{
    for (int i = 0; i < record->n && !serializer->failed; i++) {
        const mt_field *const f = &record->fields[i];
        serialize_field(f, (char *)item + f->offset, (char *)item + f->other, n_variables,
                        serializer, mem);
    }
}

bool mt_record_check_format(mt_reader *r, const mt_record *record, const char *kind)
{
    const mt_field *const f = &record->fields[0];
    assert(f->type == MT_FIELD_FORMAT);
    if (!mt_reader_type(r, MT_JSON_ROOT, MT_KEY_OBJECT) ||
        !mt_reader_format(r, f->format, kind)) {
        return false;
    }
    if (mt_json_member(r->doc, MT_JSON_ROOT, f->name) == MT_NO_ADDR) {
        mt_diag_structure(r->diags, MT_JSON_ROOT, "member \"%s\" is missing", f->name);
    }
    return true;
}
