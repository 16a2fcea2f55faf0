/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SHIPPED_H
#define IO_SHIPPED_H

#include <stddef.h>

/* Files of the source distribution that are part of the program, whole: schemas/, problems/,
 * studies/, and what `init` begins with, init/. */
typedef struct mt_shipped {
    const char *path;  /* "schemas/model.schema.json" */
    const char *bytes; /* size bytes and a NUL */
    size_t size;
} mt_shipped;

/* All of them, by path; *n their number. */
const mt_shipped *mt_shipped_all(int *n);
/* Of n files the one of that path. NULL: there is none. */
const mt_shipped *mt_shipped_among(const mt_shipped *of, int n, const char *path);
/* Of all of them. */
const mt_shipped *mt_shipped_find(const char *path);

#endif
