/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Counts and fails allocations: in every test program malloc, calloc, realloc, aligned_alloc,
 * posix_memalign and free are replaced, also as the shared libraries see them. Where somebody
 * else already replaces them (a sanitizer, valgrind) the counters mean nothing and nothing
 * fails, which mt_alloc_works() tells: ask it first. What OpenBLAS takes for itself is neither
 * counted nor failed: it could not bear it.
 *
 *     for (long nth = 0; mt_alloc_works(); nth++) {
 *         mt_alloc_fail_after(nth);
 *         rc = load(...);
 *         mt_alloc_fail_after(-1);
 *         free what rc == MT_OK gave, then CHECK(t, mt_alloc_live() == before);
 *         if (rc == MT_OK) break;
 *     }
 */
#ifndef MT_ALLOC_H
#define MT_ALLOC_H

#include <stdbool.h>
#include <stddef.h>

/* True where allocations are seen and can be failed. */
bool mt_alloc_works(void);

/* Let the next nth allocations succeed and every later one return NULL; nth < 0: none fails. */
void mt_alloc_fail_after(long nth);

/* Let the nth allocation from here (0: the next) return NULL, and it alone. */
void mt_alloc_fail_only(long nth);

/* Count and fail beside gcc's AddressSanitizer, too, from here on. */
void mt_alloc_use_beside_sanitizer(void);

/* Have every allocation told before it is made or refused, with the address that it returns to;
 * NULL: none. It must not allocate. */
void mt_alloc_watch(void (*seen)(const void *caller, size_t size));

/* Number a request of another allocator (an arena's) as if it were one of these, and tell
 * whether it is to fail. */
bool mt_alloc_refuses(const void *caller, size_t size);

/* Successful allocations since the program started. */
long mt_alloc_count(void);

/* Blocks that are allocated and not yet freed. */
long mt_alloc_live(void);

#endif
