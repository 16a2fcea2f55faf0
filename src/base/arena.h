/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_ARENA_H
#define BASE_ARENA_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/base.h"

/*
 * Growing arena: memory that lives and dies together. Blocks are chained (a pointer handed out
 * never moves), every allocation is 64-byte aligned and zeroed, products are checked for
 * overflow; short texts stand one behind the other. `mark`/`rewind` give scratch back without
 * freeing blocks, so a loop that has run once allocates nothing more. Under AddressSanitizer
 * all but the bytes that were asked for is poisoned: what is free, at least 64 bytes and one
 * item behind every allocation, and what mt_arena_grow leaves behind. Not thread safe: one
 * arena, one worker.
 *
 * A request that cannot be met (memory is out, or a product overflows) gives NULL, and the
 * arena remembers: every later request gives NULL as well, without a look at its arguments. So
 * nobody asks after each request, but once, before the first use of what the group was for:
 *
 *     double *const K = mt_arena_f64(mem, n, n);
 *     int *const pivot = mt_arena_int(mem, n);
 *     MT_TRY(mt_arena_check(mem, err));
 *
 * Who only collects (texts, a list that grows, nodes of a program) leaves out what is NULL and
 * lets the owner of the arena ask at the end. A rewind loses no failure that nobody was told
 * of; one that mt_arena_check has told ends with the rewind to a mark from before it, so that
 * an arena outlives a shortage.
 */
enum { MT_ALIGN = 64 };

typedef struct mt_arena_block mt_arena_block;

typedef struct mt_arena {
    mt_arena_block *first;   /* chain of blocks, in order of use */
    mt_arena_block *current; /* the block that allocations come from */
    size_t used;             /* bytes handed out */
    size_t peak;             /* largest `used` ever */
    size_t block_size;       /* least size of a new block */
    char *text;              /* where the next short text goes */
    size_t text_left;        /* bytes there */
    bool failed;             /* a request could not be met */
    bool told;               /* and mt_arena_check has said so */
} mt_arena;

typedef struct mt_arena_mark {
    mt_arena_block *block;
    size_t block_used;
    size_t used;
    char *text;
    size_t text_left;
    bool failed;
} mt_arena_mark;

/* block_size bytes are claimed at once; 0 chooses 64 KiB. Fails: MT_E_MEMORY. */
mt_status mt_arena_init(mt_arena *a, size_t block_size, mt_err *err);
/* Accepts a zeroed or already freed arena. */
void mt_arena_free(mt_arena *a);
/* MT_E_MEMORY where a request since the start, or since a rewind that ended it, could not be
 * met. */
mt_status mt_arena_check(mt_arena *a, mt_err *err);
/* The same as a question, for loops that end early: it does not count as told. */
bool mt_arena_failed(const mt_arena *a);
/* Have it remember a shortage that was met elsewhere (by a text on the heap, by another
 * arena). */
void mt_arena_fail(mt_arena *a);
/* count * size bytes, zeroed. A zero product gives a valid pointer. */
void *mt_arena_alloc(mt_arena *a, size_t count, size_t size);
/* m x n doubles, zeroed. */
double *mt_arena_f64(mt_arena *a, size_t m, size_t n);
/* n ints, zeroed. */
int *mt_arena_int(mt_arena *a, size_t n);
/* Copy of a string (length bytes of it, plus the terminator). */
char *mt_arena_strdup(mt_arena *a, const char *s);
char *mt_arena_strndup(mt_arena *a, const char *s, size_t length);
/* printf into the arena. */
char *mt_arena_printf(mt_arena *a, const char *fmt, ...) MT_PRINTF(2, 3);
char *mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args) MT_PRINTF(2, 0);
/* Growable array in an arena: returns a pointer to the count items with room for one more
 * (doubling; the old copy is abandoned in the arena); *capacity is the room. After NULL items
 * and *capacity stand unchanged. */
void *mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size);
/* Everything handed out after the mark was taken is void after a rewind to it; marks nest like
 * a stack. */
mt_arena_mark mt_arena_get_mark(const mt_arena *a);
void mt_arena_rewind(mt_arena *a, mt_arena_mark mark);
/* A rewind to the very start. */
void mt_arena_clear(mt_arena *a);

/* Fill err with MT_E_MEMORY: for what is not an arena's. */
mt_status mt_fail_memory(mt_err *err);

#endif
