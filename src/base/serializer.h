/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SERIALIZER_H
#define BASE_SERIALIZER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/base.h"

/*
 * A record as a list of 64-bit words. One function lists the members of a struct, and the same
 * function writes or reads them, so the two directions cannot differ. Numbers keep their bits.
 * Input is not trusted: a missing word or a word out of its range sets `failed`, and nothing
 * more is read; the caller checks mt_serializer_is_read at the end, before it uses anything it
 * read.
 */
typedef struct mt_serializer {
    uint64_t *words; /* heap and owned when writing; borrowed when reading */
    size_t n;
    size_t room;
    size_t at; /* next word to be read */
    bool reads;
    bool failed; /* reading failed, or the value to be written is not a valid record */
    /* writing ran out of memory, which does not say whether the value is a valid record */
    bool no_memory;
} mt_serializer;

mt_serializer mt_serializer_of(const uint64_t *words, size_t n); /* for reading */
void mt_serializer_free(mt_serializer *t);
/* True where all words were read and none is missing. */
bool mt_serializer_is_read(const mt_serializer *t);

void mt_serializer_numbers(mt_serializer *t, size_t n, double *x);
void mt_serializer_long(mt_serializer *t, long *x, long least, long most);
void mt_serializer_int(mt_serializer *t, int *x, int least, int most);
void mt_serializer_flag(mt_serializer *t, bool *x);
/* NULL is a valid text; a text that is read is in mem. */
void mt_serializer_text(mt_serializer *t, const char **text, mt_arena *mem);
/* Reading: zeroed room in mem for the *n items of `size` bytes that follow, each at least one
 * word; writing: returns items. NULL: none. */
void *mt_serializer_items(mt_serializer *t, int *n, size_t size, void *items, mt_arena *mem);

#endif
