/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_SHIPPED_H
#define IO_SHIPPED_H

#include <stddef.h>

/* Files of the source distribution that are built into the program: schemas/, problems/,
 * studies/, and the templates of `init`, init/. */
typedef struct mt_shipped {
    const char *path;  /* "schemas/model.schema.json" */
    const char *bytes; /* size bytes and a NUL */
    size_t size;
} mt_shipped;

/* All files, ordered by path; *n is their number. */
const mt_shipped *mt_shipped_all(int *n);
/* The file of that path among n files; NULL: none. */
const mt_shipped *mt_shipped_among(const mt_shipped *of, int n, const char *path);
/* The file of that path among all files; NULL: none. */
const mt_shipped *mt_shipped_find(const char *path);

#endif
