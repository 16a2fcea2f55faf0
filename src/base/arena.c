/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Giving back pages of what is still claimed is not in POSIX. */
#define _DEFAULT_SOURCE /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "base/arena.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/format.h"

#if defined(__SANITIZE_ADDRESS__)
#    define ARENA_ASAN 1
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer)
#        define ARENA_ASAN 1
#    endif
#endif

#ifdef ARENA_ASAN
#    include <sanitizer/asan_interface.h>
#    define POISON(p, n)   ASAN_POISON_MEMORY_REGION((p), (n))
#    define UNPOISON(p, n) ASAN_UNPOISON_MEMORY_REGION((p), (n))
#else
#    define POISON(p, n)   ((void)(p), (void)(n))
#    define UNPOISON(p, n) ((void)(p), (void)(n))
#endif

/* For blocks from LARGE on calloc takes pages that the system has zeroed already: what nobody
 * uses of them is never there. */
enum { DEFAULT_BLOCK_SIZE = 64 * 1024, LARGE = 1024 * 1024, LARGEST_ZONE = 4096 };
/* Texts up to this many bytes share room of so many. */
enum { SHORT_TEXT = 96, TEXTS = 512 };

/* data points behind the header, at the first multiple of MT_ALIGN that leaves room for a
 * zone. */
struct mt_arena_block {
    mt_arena_block *next;
    unsigned char *data;
    size_t size;
    size_t used;  /* a multiple of MT_ALIGN */
    size_t dirty; /* bytes that may be other than 0: none behind them was handed out */
};

/* Bytes between an allocation and the next one, poisoned under AddressSanitizer: the size of
 * one item, so that access to one item too many is detected. */
static size_t zone(size_t size)
{
#ifdef ARENA_ASAN
    const size_t kept = size > LARGEST_ZONE ? LARGEST_ZONE : size;
    return kept == 0 ? MT_ALIGN : (kept + MT_ALIGN - 1) / MT_ALIGN * MT_ALIGN;
#else
    (void)size;
    return 0;
#endif
}

static mt_arena_block *block_new(size_t size)
{
    const size_t before = MT_ALIGN + zone(0);
    if (size > SIZE_MAX - sizeof(mt_arena_block) - before) {
        return NULL;
    }
    const size_t all = sizeof(mt_arena_block) + before + size;
    mt_arena_block *const b = size < LARGE ? malloc(all) : calloc(1, all);
    if (b == NULL) {
        return NULL;
    }
    unsigned char *const after = (unsigned char *)(b + 1) + zone(0);
    const size_t skew = (size_t)((uintptr_t)after % MT_ALIGN);
    b->next = NULL;
    b->data = after + (skew == 0 ? 0 : MT_ALIGN - skew);
    b->size = size;
    b->used = 0;
    b->dirty = size < LARGE ? size : 0;
    POISON(b + 1, before + size);
    return b;
}

/* bytes rounded up to a multiple of MT_ALIGN; 0 where count * size does not fit. */
static size_t rounded(size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX - MT_ALIGN) / size) {
        return 0;
    }
    const size_t bytes = count * size;
    return bytes == 0 ? MT_ALIGN : (bytes + MT_ALIGN - 1) / MT_ALIGN * MT_ALIGN;
}

mt_status mt_arena_init(mt_arena *a, size_t block_size, mt_err *err)
{
    *a = (mt_arena){0};
    a->block_size = rounded(block_size == 0 ? DEFAULT_BLOCK_SIZE : block_size, 1);
    a->first = a->block_size == 0 ? NULL : block_new(a->block_size);
    a->current = a->first;
    a->failed = a->first == NULL;
    return mt_arena_check(a, err);
}

void mt_arena_free(mt_arena *a)
{
    mt_arena_block *b = a->first;
    while (b != NULL) {
        mt_arena_block *const next = b->next;
        UNPOISON(b + 1, MT_ALIGN + zone(0) + b->size);
        free(b);
        b = next;
    }
    *a = (mt_arena){0};
}

mt_status mt_arena_check(mt_arena *a, mt_err *err)
{
    a->told = a->failed;
    return a->failed ? mt_fail_memory(err) : MT_OK;
}

bool mt_arena_failed(const mt_arena *a)
{
    return a->failed;
}

void mt_arena_fail(mt_arena *a)
{
    a->failed = true;
}

static void *fail_allocation(mt_arena *a)
{
    mt_arena_fail(a);
    return NULL;
}

static bool fits(const mt_arena_block *b, size_t bytes)
{
    return b != NULL && bytes <= b->size - b->used;
}

/* Make `current` a block with room for bytes. Blocks behind the current one are empty, left
 * over by a rewind: the next is used where it is large enough, else a new one is put before it,
 * so that the same sequence of requests finds the same blocks again. */
static bool make_room(mt_arena *a, size_t bytes)
{
    if (fits(a->current, bytes)) {
        return true;
    }
    mt_arena_block **const link = a->current == NULL ? &a->first : &a->current->next;
    if (!fits(*link, bytes)) {
        const size_t smallest = a->block_size == 0 ? DEFAULT_BLOCK_SIZE : a->block_size;
        mt_arena_block *const b = block_new(bytes > smallest ? bytes : smallest);
        if (b == NULL) {
            return false;
        }
        b->next = *link;
        *link = b;
    }
    a->current = *link;
    return true;
}

void *mt_arena_alloc(mt_arena *a, size_t count, size_t size)
{
    const size_t bytes = rounded(count, size);
    if (a->failed || bytes == 0 || bytes > SIZE_MAX - zone(size) ||
        !make_room(a, bytes + zone(size))) {
        return fail_allocation(a);
    }
    mt_arena_block *const b = a->current;
    unsigned char *const p = b->data + b->used;
    const size_t dirty = b->dirty > b->used ? b->dirty - b->used : 0;
    b->used += bytes + zone(size);
    b->dirty = b->dirty > b->used ? b->dirty : b->used;
    a->used += bytes;
    a->peak = a->used > a->peak ? a->used : a->peak;
    UNPOISON(p, count * size);
    memset(p, 0, count * size < dirty ? count * size : dirty);
    return p;
}

double *mt_arena_f64(mt_arena *a, size_t m, size_t n)
{
    return n != 0 && m > SIZE_MAX / n ? fail_allocation(a)
                                      : mt_arena_alloc(a, m * n, sizeof(double));
}

int *mt_arena_int(mt_arena *a, size_t n)
{
    return mt_arena_alloc(a, n, sizeof(int));
}

/* Room for a text; a short name alone would fill a fifth of an allocation. */
static char *text_room(mt_arena *a, size_t bytes)
{
#ifdef ARENA_ASAN
    return mt_arena_alloc(a, bytes, 1);
#else
    if (a->failed || bytes > SHORT_TEXT) {
        return mt_arena_alloc(a, bytes, 1);
    }
    if (bytes > a->text_left) {
        char *const room = mt_arena_alloc(a, TEXTS, 1);
        a->text = room == NULL ? a->text : room;
        a->text_left = room == NULL ? a->text_left : TEXTS;
    }
    if (bytes > a->text_left) {
        return NULL;
    }
    char *const text = a->text;
    a->text += bytes;
    a->text_left -= bytes;
    return text;
#endif
}

char *mt_arena_strdup(mt_arena *a, const char *s)
{
    return a->failed ? NULL : mt_arena_strndup(a, s, strlen(s));
}

char *mt_arena_strndup(mt_arena *a, const char *s, size_t length)
{
    char *const copy = length == SIZE_MAX ? fail_allocation(a) : text_room(a, length + 1);
    if (copy != NULL) {
        memcpy(copy, s, length);
        copy[length] = '\0';
    }
    return copy;
}

char *mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args)
{
    enum { OFTEN_ENOUGH = 200 };
    char text[OFTEN_ENOUGH];
    va_list again;
    if (a->failed) {
        return NULL;
    }
    va_copy(again, args);
    const int n = mt_vsnprintf(text, sizeof text, fmt, args);
    char *const s = n < 0 ? fail_allocation(a) : text_room(a, (size_t)n + 1);
    if (s != NULL && (size_t)n < sizeof text) {
        memcpy(s, text, (size_t)n + 1);
    } else if (s != NULL) {
        (void)mt_vsnprintf(s, (size_t)n + 1, fmt, again);
    }
    va_end(again);
    return s;
}

char *mt_arena_printf(mt_arena *a, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    char *const s = mt_arena_vprintf(a, fmt, args);
    va_end(args);
    return s;
}

/* Give the whole pages of abandoned memory back to the system; they stay mapped and read as
 * zero. */
static void abandon(void *items, size_t bytes)
{
#ifdef MADV_DONTNEED
    const long page = bytes < LARGE ? 0 : sysconf(_SC_PAGESIZE);
    if (page > 0) {
        const size_t unit = (size_t)page;
        const size_t before = (unit - ((size_t)(uintptr_t)items % unit)) % unit;
        unsigned char *const first = (unsigned char *)items + before;
        (void)madvise(first, (bytes - before) / unit * unit, MADV_DONTNEED);
    }
#endif
    POISON(items, bytes); /* who still looks there is seen */
}

void *mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size)
{
    enum { FIRST_CAPACITY = 8 };
    if (a->failed) {
        return NULL;
    }
    if (count < *capacity) {
        return items;
    }
    if (count > INT_MAX / 2) {
        return fail_allocation(a);
    }
    const int room = count < FIRST_CAPACITY / 2 ? FIRST_CAPACITY : 2 * count;
    void *const grown = mt_arena_alloc(a, (size_t)room, size);
    if (grown == NULL) {
        return NULL;
    }
    if (count > 0) {
        memcpy(grown, items, (size_t)count * size);
        abandon(items, (size_t)count * size);
    }
    *capacity = room;
    return grown;
}

mt_arena_mark mt_arena_get_mark(const mt_arena *a)
{
    return (mt_arena_mark){
        .block = a->current,
        .block_used = a->current == NULL ? 0 : a->current->used,
        .used = a->used,
        .text = a->text,
        .text_left = a->text_left,
        .failed = a->failed,
    };
}

void mt_arena_rewind(mt_arena *a, mt_arena_mark mark)
{
    mt_arena_block *b = mark.block == NULL ? a->first : mark.block;
    a->current = mark.block;
    a->used = mark.used;
    a->text = mark.text;
    a->text_left = mark.text_left;
    if (a->told && !mark.failed) {
        a->failed = false;
        a->told = false;
    }
    size_t keep = mark.block_used;
    for (; b != NULL; b = b->next) {
        b->used = keep;
        POISON(b->data + keep, b->size - keep);
        keep = 0;
    }
}

void mt_arena_clear(mt_arena *a)
{
    mt_arena_rewind(a, (mt_arena_mark){.block = NULL});
}

mt_status mt_fail_memory(mt_err *err)
{
    return mt_fail(err, MT_E_MEMORY, "%s", mt_status_text(MT_E_MEMORY));
}
