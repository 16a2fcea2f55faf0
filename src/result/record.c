/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/record.h"

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
        } else if (f->type == MT_FIELD_RECORD) {
            mt_record_clear(f->record, at);
        }
    }
}

void *mt_record_get_pointer(const void *at)
{
    void *pointer = NULL;
    memcpy(&pointer, at, sizeof pointer);
    return pointer;
}

void mt_record_set_pointer(void *at, const void *pointer)
{
    memcpy(at, &pointer, sizeof pointer);
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

static void own_text(const char **text, mt_arena *mem)
{
    *text = *text == NULL ? NULL : mt_arena_strdup(mem, *text);
}

static void own_list(const mt_record *record, void *at, int n, int n_variables, mt_arena *mem)
{
    char *const items = own_items(at, n, record->size, mem);
    for (int i = 0; i < n && items != NULL; i++) {
        mt_record_own(record, items + ((size_t)i * record->size), n_variables, mem);
    }
}

void mt_record_own(const mt_record *record, void *item, int n_variables, mt_arena *mem)
{
    for (int i = 0; i < record->n; i++) {
        const mt_field *const f = &record->fields[i];
        void *const at = (char *)item + f->offset;
        void *const other = (char *)item + f->other;
        const char **texts = NULL;
        switch (f->type) {
        case MT_FIELD_TEXT:
        case MT_FIELD_CHOICE:
            own_text(at, mem);
            break;
        case MT_FIELD_VALUE:
            own_text(other, mem);
            break;
        case MT_FIELD_RECORD:
            mt_record_own(f->record, at, n_variables, mem);
            break;
        case MT_FIELD_OPTION:
            own_list(f->record, at, 1, n_variables, mem);
            break;
        case MT_FIELD_LIST:
            own_list(f->record, at, *(int *)other, n_variables, mem);
            break;
        case MT_FIELD_TEXTS:
            texts = own_items(at, *(int *)other, sizeof *texts, mem);
            for (int k = 0; k < *(int *)other && texts != NULL; k++) {
                own_text(&texts[k], mem);
            }
            break;
        case MT_FIELD_NUMBERS:
            (void)own_items(at, *(int *)other, sizeof(double), mem);
            break;
        case MT_FIELD_BY_VARIABLE:
            (void)own_items(at, n_variables, sizeof(double), mem);
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
}

/* Numbers, texts or structs that a member points to, `size` bytes each; NULL is kept as NULL,
 * and there are none of it. */
static void *tape_items(void *at, int *n, size_t size, mt_tape *tape, mt_arena *mem)
{
    bool there = mt_record_get_pointer(at) != NULL;
    mt_tape_flag(tape, &there);
    if (!there) {
        mt_record_set_pointer(at, NULL);
        *n = 0;
        return NULL;
    }
    void *const items = mt_tape_items(tape, n, size, mt_record_get_pointer(at), mem);
    mt_record_set_pointer(at, items);
    return items;
}

static void tape_list(const mt_record *record, void *at, int *n, int n_variables, mt_tape *tape,
                      mt_arena *mem)
{
    char *const items = tape_items(at, n, record->size, tape, mem);
    for (int i = 0; i < *n && items != NULL && !tape->failed; i++) {
        mt_record_tape(record, items + ((size_t)i * record->size), n_variables, tape, mem);
    }
}

static void tape_numbers(void *at, int *n, mt_tape *tape, mt_arena *mem)
{
    double *const numbers = tape_items(at, n, sizeof *numbers, tape, mem);
    if (numbers != NULL) {
        mt_tape_numbers(tape, (size_t)*n, numbers);
    }
}

static void tape_texts(void *at, int *n, mt_tape *tape, mt_arena *mem)
{
    const char **const texts = tape_items(at, n, sizeof *texts, tape, mem);
    for (int i = 0; i < *n && texts != NULL && !tape->failed; i++) {
        mt_tape_text(tape, &texts[i], mem);
    }
}

static void tape_field(const mt_field *f, void *at, void *other, int n_variables, mt_tape *tape,
                       mt_arena *mem)
{
    int one = 1;
    int size = n_variables;
    switch (f->type) {
    case MT_FIELD_TEXT:
    case MT_FIELD_CHOICE:
        mt_tape_text(tape, at, mem);
        break;
    case MT_FIELD_VALUE:
        mt_tape_numbers(tape, 1, at);
        mt_tape_text(tape, other, mem);
        break;
    case MT_FIELD_NUMBER:
        mt_tape_numbers(tape, 1, at);
        break;
    case MT_FIELD_ENUM:
        mt_tape_int(tape, at, 0, f->n_choices - 1);
        break;
    case MT_FIELD_COUNT:
        mt_tape_int(tape, at, INT_MIN, INT_MAX);
        break;
    case MT_FIELD_LONG:
        mt_tape_long(tape, at, LONG_MIN, LONG_MAX);
        break;
    case MT_FIELD_FLAG:
        mt_tape_flag(tape, at);
        break;
    case MT_FIELD_RECORD:
        mt_record_tape(f->record, at, n_variables, tape, mem);
        break;
    case MT_FIELD_OPTION:
        tape_list(f->record, at, &one, n_variables, tape, mem);
        tape->failed = tape->failed || one != (mt_record_get_pointer(at) != NULL ? 1 : 0);
        break;
    case MT_FIELD_LIST:
        tape_list(f->record, at, other, n_variables, tape, mem);
        break;
    case MT_FIELD_TEXTS:
        tape_texts(at, other, tape, mem);
        break;
    case MT_FIELD_NUMBERS:
        tape_numbers(at, other, tape, mem);
        break;
    case MT_FIELD_BY_VARIABLE:
        tape_numbers(at, &size, tape, mem);
        tape->failed = tape->failed || (size != 0 && size != n_variables);
        break;
    case MT_FIELD_TYPE_COUNT:
        break;
    }
}

void mt_record_tape(const mt_record *record, void *item, int n_variables, mt_tape *tape,
                    mt_arena *mem)
{
    for (int i = 0; i < record->n && !tape->failed; i++) {
        const mt_field *const f = &record->fields[i];
        tape_field(f, (char *)item + f->offset, (char *)item + f->other, n_variables, tape,
                   mem);
    }
}
