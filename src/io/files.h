/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FILES_H
#define IO_FILES_H

#include "modetune/read.h"

#include "io/file.h"

/* Where files come from: some are given by their texts, found by their paths ("a/../b" being
 * "b"), the others are on the disk unless `only` these are there. Zeroed: the disk. */
typedef struct mt_files {
    const mt_file_text *given; /* [n] */
    int n;
    bool only;
} mt_files;

/* As mt_file_read, from there; files may be NULL. What is given has no root. O(n) paths. */
mt_status mt_files_read(const mt_files *files, const char *path, const char *root, size_t limit,
                        mt_file *out, mt_err *err);
/* A path without "." and "a/.." and doubled slashes, by its text alone; heap, NULL when out of
 * memory. */
char *mt_files_normal(const char *path);
/* *out: whether it is among those that are given by their texts. Fails: MT_E_MEMORY. */
mt_status mt_files_give(const mt_files *files, const char *path, bool *out, mt_err *err);
/* Whether it is sure that the path leads to nothing there. */
bool mt_files_lack(const mt_files *files, const char *path);

#endif
