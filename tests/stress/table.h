/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the programs of this folder share besides matrices: an arena, and how long they run. */
#ifndef STRESS_TABLE_H
#define STRESS_TABLE_H

#include <stdlib.h>

#include "base/arena.h"

static mt_arena table_mem;

/* MT_STRESS_ROUNDS, or 1. */
static inline int rounds(void)
{
    const char *const text = getenv("MT_STRESS_ROUNDS");
    return text != NULL ? (int)strtol(text, NULL, 10) : 1;
}

/* For cmocka: before and after all tests. */
static inline int prepare(void **state)
{
    (void)state;
    return mt_arena_init(&table_mem, (size_t)1 << 20, NULL) == MT_OK ? 0 : 1;
}

static inline int release(void **state)
{
    (void)state;
    mt_arena_free(&table_mem);
    return 0;
}

#endif
