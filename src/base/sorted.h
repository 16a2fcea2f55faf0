/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SORTED_H
#define BASE_SORTED_H

#include "base/arena.h"

/*
 * Items 0, 1, 2, ... with unique keys: find and insert take O(log n) comparisons in the worst
 * case. A hash table would be as fast only for files without deliberately colliding keys. The
 * caller holds the keys: `compare` orders a key against item i, as strcmp does. Zeroed: empty.
 */
typedef struct mt_sorted {
    int *next; /* [2 * room] children before and behind, stored as 1 + i; 0: none */
    int *level;
    int n;
    int room;
    int root;
} mt_sorted;

typedef int (*mt_sorted_compare)(const void *context, const void *key, int i);

/* Index of the item with the key; -1: none. */
int mt_sorted_find(const mt_sorted *t, mt_sorted_compare compare, const void *context,
                   const void *key);
/* Index of the item with the key. Without one: adds item t->n and returns MT_SORTED_NEW, or
 * MT_SORTED_FULL where the arena is out of memory. */
enum { MT_SORTED_NEW = -1, MT_SORTED_FULL = -2 };
int mt_sorted_put(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                  const void *key);
/* Add item t->n, whose key must be absent. False where the arena is out of memory; the items
 * are then unchanged. */
bool mt_sorted_add(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                   const void *key);

#endif
