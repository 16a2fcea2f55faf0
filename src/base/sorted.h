/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SORTED_H
#define BASE_SORTED_H

#include "base/arena.h"

/*
 * Items 0, 1, 2, ... that are known by a key, each once: found, and one more added, in O(log n)
 * comparisons whatever the keys are. A hash table would be as fast only for files whose author
 * does not look for keys that collide. What an item's key is the caller knows: `compare` gives
 * the order of a key and item i, as strcmp does. Zeroed: empty.
 */
typedef struct mt_sorted {
    int *next; /* [2 * room] items before and behind, 1 + i; 0: none */
    int *level;
    int n;
    int room;
    int root;
} mt_sorted;

typedef int (*mt_sorted_compare)(const void *context, const void *key, int i);

/* The item with the key; -1: none. */
int mt_sorted_find(const mt_sorted *t, mt_sorted_compare compare, const void *context,
                   const void *key);
/* The item with the key; or one more, t->n, which has it. */
enum { MT_SORTED_NEW = -1, MT_SORTED_FULL = -2 }; /* it is new; there is no memory for it */
int mt_sorted_put(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                  const void *key);
/* Item t->n, whose key is not there yet. False where the arena is out of memory: the items stay
 * as they were. */
bool mt_sorted_add(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                   const void *key);

#endif
