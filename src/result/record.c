/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/record.h"

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
        } else if (f->type == MT_FIELD_RECORD) {
            mt_record_clear(f->record, at);
        }
    }
}

/* Replace n borrowed items, if there are any, by their copy. */
static bool own_items(void *at, int n, size_t size, mt_arena *mem)
{
    const void *const from = *(void **)at;
    if (from == NULL) {
        return true;
    }
    void *const own = mt_arena_alloc(mem, (size_t)n, size);
    if (own != NULL && n > 0) {
        memcpy(own, from, (size_t)n * size);
    }
    *(void **)at = own;
    return own != NULL;
}

static bool own_text(void *at, mt_arena *mem)
{
    const char **const text = at;
    if (*text != NULL) {
        *text = mt_arena_strdup(mem, *text);
        return *text != NULL;
    }
    return true;
}

static bool own_texts(void *at, int n, mt_arena *mem)
{
    bool done = own_items(at, n, sizeof(const char *), mem);
    for (int i = 0; i < n && done; i++) {
        done = own_text(*(const char ***)at + i, mem);
    }
    return done;
}

static bool own_list(const mt_record *record, void *at, int n, int n_variables, mt_arena *mem)
{
    bool done = own_items(at, n, record->size, mem);
    for (int i = 0; i < n && done; i++) {
        done =
            mt_record_own(record, *(char **)at + ((size_t)i * record->size), n_variables, mem);
    }
    return done;
}

bool mt_record_own(const mt_record *record, void *item, int n_variables, mt_arena *mem)
{
    bool done = true;
    for (int i = 0; i < record->n && done; i++) {
        const mt_field *const f = &record->fields[i];
        void *const at = (char *)item + f->offset;
        void *const other = (char *)item + f->other;
        switch (f->type) {
        case MT_FIELD_TEXT:
        case MT_FIELD_CHOICE:
            done = own_text(at, mem);
            break;
        case MT_FIELD_VALUE:
            done = own_text(other, mem);
            break;
        case MT_FIELD_RECORD:
            done = mt_record_own(f->record, at, n_variables, mem);
            break;
        case MT_FIELD_OPTION:
            done = own_list(f->record, at, *(void **)at != NULL, n_variables, mem);
            break;
        case MT_FIELD_LIST:
            done = own_list(f->record, at, *(int *)other, n_variables, mem);
            break;
        case MT_FIELD_TEXTS:
            done = own_texts(at, *(int *)other, mem);
            break;
        case MT_FIELD_NUMBERS:
            done = own_items(at, *(int *)other, sizeof(double), mem);
            break;
        case MT_FIELD_BY_VARIABLE:
            done = own_items(at, n_variables, sizeof(double), mem);
            break;
        case MT_FIELD_ENUM:
        case MT_FIELD_NUMBER:
        case MT_FIELD_COUNT:
        case MT_FIELD_LONG:
        case MT_FIELD_FLAG:
        case MT_FIELD_TYPE_COUNT:
            break;
        }
    }
    return done;
}
