/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FILES_H
#define IO_FILES_H

#include "modetune/read.h"

#include "io/file.h"

/* The source of files: some are given as texts, found by their paths ("a/../b" being "b"); the
 * others are on the disk, or (only) do not exist. Zeroed: the disk. */
typedef struct mt_files {
    const mt_file_text *given; /* [n] */
    int n;
    bool only;
} mt_files;

/* As mt_file_read, from this source; files may be NULL. root does not apply to given texts.
 * O(n) paths. */
mt_status mt_files_read(const mt_files *files, const char *path, const char *root, size_t limit,
                        mt_file *out, mt_err *err);
/* The path without ".", "a/.." and doubled slashes, by its text alone; heap, NULL when out of
 * memory. */
char *mt_files_normal(const char *path);
/* *out: true where the path is given as text. Fails: MT_E_MEMORY. */
mt_status mt_files_give(const mt_files *files, const char *path, bool *out, mt_err *err);
/* True where the path certainly leads to nothing in this source. */
bool mt_files_lack(const mt_files *files, const char *path);

#endif
