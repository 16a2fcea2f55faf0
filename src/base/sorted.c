/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A. Andersson, "Balanced search trees made simple", WADS 1993, LNCS 709, pp. 60-71: a binary
 * tree whose nodes have levels. Leaves have level 1; an item before is one level below, one
 * behind on the same level or one below, and of three in a row two levels are different. So no
 * path is longer than 2 log2(n + 1). `skew` and `split` restore this on the way back from a new
 * leaf.
 */
#include "base/sorted.h"

#include <limits.h>
#include <string.h>

enum { BEFORE, BEHIND, DEEPEST = 2 * CHAR_BIT * (int)sizeof(int) };

static int *link_of(const mt_sorted *t, int node, int side)
{
    return &t->next[2 * (node - 1) + side];
}

static int level_of(const mt_sorted *t, int node)
{
    return node == 0 ? 0 : t->level[node - 1];
}

int mt_sorted_find(const mt_sorted *t, mt_sorted_compare compare, const void *context,
                   const void *key)
{
    int at = t->root;
    while (at != 0) {
        const int order = compare(context, key, at - 1);
        if (order == 0) {
            return at - 1;
        }
        at = *link_of(t, at, order < 0 ? BEFORE : BEHIND);
    }
    return -1;
}

/* One before on the same level comes up. */
static int skew(const mt_sorted *t, int at)
{
    const int before = *link_of(t, at, BEFORE);
    if (before == 0 || level_of(t, before) != level_of(t, at)) {
        return at;
    }
    *link_of(t, at, BEFORE) = *link_of(t, before, BEHIND);
    *link_of(t, before, BEHIND) = at;
    return before;
}

/* Three items on one level: the second becomes the parent, one level higher. */
static int split(const mt_sorted *t, int at)
{
    const int behind = *link_of(t, at, BEHIND);
    if (behind == 0 || level_of(t, *link_of(t, behind, BEHIND)) != level_of(t, at)) {
        return at;
    }
    *link_of(t, at, BEHIND) = *link_of(t, behind, BEFORE);
    *link_of(t, behind, BEFORE) = at;
    t->level[behind - 1]++;
    return behind;
}

static bool make_room(mt_sorted *t, mt_arena *mem)
{
    enum { FIRST = 32, MOST = INT_MAX / 4 };
    if (t->n < t->room) {
        return true;
    }
    const size_t room = t->room == 0 ? FIRST : t->room > MOST ? SIZE_MAX : 2 * (size_t)t->room;
    int *const level = mt_arena_int(mem, room);
    int *const next = mt_arena_alloc(mem, room, 2 * sizeof *next);
    if (level == NULL || next == NULL) {
        return false;
    }
    if (t->n > 0) {
        memcpy(level, t->level, (size_t)t->n * sizeof *level);
        memcpy(next, t->next, 2 * (size_t)t->n * sizeof *next);
    }
    t->level = level;
    t->next = next;
    t->room = (int)room;
    return true;
}

int mt_sorted_put(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                  const void *key)
{
    int *path[DEEPEST]; /* the links from the root to the new leaf */
    int depth = 0;
    if (!make_room(t, mem)) {
        return MT_SORTED_FULL;
    }
    path[0] = &t->root;
    while (*path[depth] != 0) {
        const int at = *path[depth];
        const int order = compare(context, key, at - 1);
        if (order == 0) {
            return at - 1;
        }
        path[++depth] = link_of(t, at, order < 0 ? BEFORE : BEHIND);
    }
    t->n++;
    t->level[t->n - 1] = 1;
    *link_of(t, t->n, BEFORE) = 0;
    *link_of(t, t->n, BEHIND) = 0;
    *path[depth] = t->n;
    while (depth-- > 0) {
        *path[depth] = split(t, skew(t, *path[depth]));
    }
    return MT_SORTED_NEW;
}

bool mt_sorted_add(mt_sorted *t, mt_arena *mem, mt_sorted_compare compare, const void *context,
                   const void *key)
{
    return mt_sorted_put(t, mem, compare, context, key) == MT_SORTED_NEW;
}
