/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_TAPE_H
#define BASE_TAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/base.h"

/*
 * A record as a list of 64-bit words. One function tells what a struct holds, and the tape is
 * either written from it or read into it: the two cannot differ. Numbers keep their bits. What
 * is read is believed in nothing: a word that is missing or out of its range fails the tape,
 * from then on nothing more is read; mt_tape_is_read is asked at the end, before anything that
 * was read is used.
 */
typedef struct mt_tape {
    uint64_t *words; /* heap, owned, while it is written; borrowed while it is read */
    size_t n;
    size_t room;
    size_t at; /* next to be read */
    bool reads;
    bool failed; /* or: what was to be written is no record */
    /* what was to be written had no room: that is no answer to whether it is a record */
    bool no_memory;
} mt_tape;

mt_tape mt_tape_of(const uint64_t *words, size_t n); /* to be read */
void mt_tape_free(mt_tape *t);
/* Whether all of it was read, and no more. */
bool mt_tape_is_read(const mt_tape *t);

void mt_tape_numbers(mt_tape *t, size_t n, double *x);
void mt_tape_long(mt_tape *t, long *x, long least, long most);
void mt_tape_int(mt_tape *t, int *x, int least, int most);
void mt_tape_flag(mt_tape *t, bool *x);
/* NULL is a text, too; what is read lies in mem. */
void mt_tape_text(mt_tape *t, const char **text, mt_arena *mem);
/* Room in mem for *n items of `size` bytes that come next, one word each at least; while the
 * tape is written, the items themselves. NULL: none. */
void *mt_tape_items(mt_tape *t, int *n, size_t size, void *items, mt_arena *mem);

#endif
