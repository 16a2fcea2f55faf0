/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SERIALIZER_H
#define BASE_SERIALIZER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/base.h"

/*
 * A record as a list of 64-bit words. One function tells what a struct holds, and the tape is
 * either written from it or read into it: the two cannot differ. Numbers keep their bits. What
 * is read is believed in nothing: a word that is missing or out of its range fails the tape,
 * from then on nothing more is read; mt_serializer_is_read is asked at the end, before anything
 * that was read is used.
 */
typedef struct mt_serializer {
    uint64_t *words; /* heap, owned, while it is written; borrowed while it is read */
    size_t n;
    size_t room;
    size_t at; /* next to be read */
    bool reads;
    bool failed; /* or: what was to be written is no record */
    /* what was to be written had no room: that is no answer to whether it is a record */
    bool no_memory;
} mt_serializer;

mt_serializer mt_serializer_of(const uint64_t *words, size_t n); /* to be read */
void mt_serializer_free(mt_serializer *t);
/* Whether all of it was read, and no more. */
bool mt_serializer_is_read(const mt_serializer *t);

void mt_serializer_numbers(mt_serializer *t, size_t n, double *x);
void mt_serializer_long(mt_serializer *t, long *x, long least, long most);
void mt_serializer_int(mt_serializer *t, int *x, int least, int most);
void mt_serializer_flag(mt_serializer *t, bool *x);
/* NULL is a text, too; what is read lies in mem. */
void mt_serializer_text(mt_serializer *t, const char **text, mt_arena *mem);
/* Room in mem for *n items of `size` bytes that come next, one word each at least; while the
 * tape is written, the items themselves. NULL: none. */
void *mt_serializer_items(mt_serializer *t, int *n, size_t size, void *items, mt_arena *mem);

#endif
