/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DOUBT_H
#define BASE_DOUBT_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/diag.h"

/*
 * What an engineer should hear before any answer: a fact of the model that surprises where it
 * is not meant ("2 free motions"), a doubt (a value that is allowed and hardly meant: a margin
 * of 0.1 %), or a fault (a value that cannot be: a negative mass).
 */
typedef enum mt_doubt_level {
    MT_LEVEL_FACT,
    MT_LEVEL_DOUBT,
    MT_LEVEL_FAULT,
    MT_LEVEL_COUNT
} mt_doubt_level;

typedef struct mt_doubt {
    mt_doubt_level level;
    const char *kind;          /* a short name that does not change: "margin", "free_motion" */
    const char *text;          /* a sentence without a full stop */
    const char *configuration; /* NULL: of the whole file */
    const char *pointer;       /* JSON pointer; NULL: not known */
    const char *file;          /* NULL: not known */
    int line;                  /* 0: not known */
    int column;
    mt_addr addr; /* for the reader of the file, which knows the rest */
    double size;  /* how far, in a unit of the kind: the largest is said first */
} mt_doubt;

/* So many are kept, and as many faults besides: no doubt hides one. */
enum { MT_DOUBT_LIMIT = 1000 };

typedef struct mt_doubt_list {
    mt_arena *mem; /* not owned */
    mt_doubt *items;
    int n;
    int capacity;
} mt_doubt_list;

/* Empty list whose texts live in mem, which remembers where there is no memory for one. */
mt_doubt_list mt_doubt_list_default(mt_arena *mem);
/* Add one with a formatted text; returns it (until the next), NULL when out of memory and
 * beyond MT_DOUBT_LIMIT, where none is added. */
mt_doubt *mt_doubt_add(mt_doubt_list *list, mt_doubt_level level, const char *kind,
                       const char *fmt, ...) MT_PRINTF(4, 5);
/* Items first .. n - 1 in the order of falling size; equal ones keep their order. */
void mt_doubt_sort(mt_doubt_list *list, int first);
/* Copy of an item, with all its texts, into another list. */
void mt_doubt_copy(mt_doubt_list *list, const mt_doubt *item);

#endif
