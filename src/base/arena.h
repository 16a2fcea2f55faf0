/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_ARENA_H
#define BASE_ARENA_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/base.h"

/*
 * Growing arena: memory that is allocated piece by piece and freed at once. Blocks are chained,
 * so a pointer never moves. Every allocation is 64-byte aligned and zeroed; products are
 * checked for overflow; short texts are packed one behind the other. `mark`/`rewind` release
 * scratch without freeing blocks, so the second pass of a loop allocates nothing from the heap.
 * Under AddressSanitizer every byte that was not requested is poisoned: the free part, at least
 * 64 bytes and one item behind every allocation, and the old copy that mt_arena_grow leaves.
 * Not thread safe: one arena, one worker.
 *
 * A request that cannot be met (memory is out, or a product overflows) returns NULL and sets
 * `failed`; every later request then returns NULL without reading its arguments. The caller
 * checks once for a group of requests, before it first uses the memory:
 *
 *     double *const K = mt_arena_f64(mem, n, n);
 *     int *const pivot = mt_arena_int(mem, n);
 *     MT_TRY(mt_arena_check(mem, err));
 *
 * A caller that only collects (texts, a growing list, nodes of a program) skips NULL and leaves
 * the check to the owner of the arena. A rewind keeps a failure that mt_arena_check has not
 * returned yet. It clears a returned failure if the mark is older than the failure, so the
 * arena can be used again after a shortage.
 */
enum { MT_ALIGN = 64 };

typedef struct mt_arena_block mt_arena_block;

typedef struct mt_arena {
    mt_arena_block *first;   /* chain of blocks, in order of use */
    mt_arena_block *current; /* the block that allocations come from */
    size_t used;             /* bytes handed out */
    size_t peak;             /* largest `used` ever */
    size_t block_size;       /* least size of a new block */
    char *text;              /* where the next short text starts */
    size_t text_left;        /* bytes left there */
    bool failed;             /* a request could not be met */
    bool told;               /* mt_arena_check has returned the failure */
} mt_arena;

typedef struct mt_arena_mark {
    mt_arena_block *block;
    size_t block_used;
    size_t used;
    char *text;
    size_t text_left;
    bool failed;
} mt_arena_mark;

/* Allocates the first block of block_size bytes; 0: 64 KiB. Fails: MT_E_MEMORY. */
mt_status mt_arena_init(mt_arena *a, size_t block_size, mt_err *err);
/* Accepts a zeroed or already freed arena. */
void mt_arena_free(mt_arena *a);
/* MT_E_MEMORY where a request since the start, or since the rewind that cleared a failure, was
 * not met. */
mt_status mt_arena_check(mt_arena *a, mt_err *err);
/* True where mt_arena_check would fail, for loops that end early; does not count as a check. */
bool mt_arena_failed(const mt_arena *a);
/* Mark the arena as failed after a shortage elsewhere (a text on the heap, another arena). */
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
/* Growable array: returns a pointer to the count items with room for at least one more;
 * *capacity is the room. The capacity doubles and the old copy stays in the arena. On NULL the
 * items and *capacity are unchanged. */
void *mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size);
/* A rewind releases everything allocated after the mark was taken; marks nest like a stack. */
mt_arena_mark mt_arena_get_mark(const mt_arena *a);
void mt_arena_rewind(mt_arena *a, mt_arena_mark mark);
/* Rewind to the very start. */
void mt_arena_clear(mt_arena *a);

/* Fill err with MT_E_MEMORY, for memory outside of an arena. */
mt_status mt_fail_memory(mt_err *err);

#endif
