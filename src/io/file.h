/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FILE_H
#define IO_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/base.h"
#include "base/sha256.h"

/* A whole file in memory (heap). */
typedef struct mt_file {
    char *bytes; /* length bytes and a NUL */
    size_t length;
    char sha256[MT_SHA256_TEXT];
} mt_file;

/*
 * The doors to the disk: nobody else opens files (structure/test_calls). Descriptors that the
 * caller closes, not inherited by other programs; -1 with errno on failure. A name is relative
 * to `folder`, a descriptor or MT_FILE_HERE.
 */
extern const int MT_FILE_HERE;
/* What is there, for reading. ELOOP where the last part of the name is a link; a pipe is not
 * waited for. */
int mt_file_open(int folder, const char *name);
/* A folder, also by a link. */
int mt_file_open_folder(const char *path);
/* For writing at the end: a file that is new, or (adds) one that is there under no other name.
 * Fails: EEXIST, with adds ENOENT, and ELOOP, ENXIO or EMLINK for a link, what is no regular
 * file, and one with several names. */
int mt_file_create(int folder, const char *name, bool adds);
/* All bytes; false with errno. */
bool mt_file_write(int fd, const char *bytes, size_t length);

/**
 * Read a regular file of at most `limit` bytes. Symbolic links are followed; where root is not
 * NULL the file that they lead to must lie beneath that folder (whose links are resolved as
 * well). Fails: MT_E_INPUT (not a regular file, too long, outside root), MT_E_SYSTEM (does not
 * exist, not readable), MT_E_MEMORY. The messages name the path as given.
 */
mt_status mt_file_read(const char *path, const char *root, size_t limit, mt_file *out,
                       mt_err *err);
void mt_file_free(mt_file *f);
/* True where it is sure that the name leads to nothing; false for what is there, and for what
 * cannot be told. */
bool mt_file_absent(const char *path);
/* The system's error number as a failure of the path: MT_E_SYSTEM, or MT_E_MEMORY. */
mt_status mt_file_failed(const char *path, int code, mt_err *err);

/* The path of `name` as meant by the file `naming`: relative names start in the folder of
 * `naming`. Heap, to be freed by the caller; NULL when out of memory. Only joins: nothing is
 * looked up. */
char *mt_file_join(const char *naming, const char *name);
/* The folder of a file ("." where the path has none); heap, NULL when out of memory. */
char *mt_file_folder(const char *path);
/* The folder that the files named by a study must lie in by default: the parent of its folder
 * ("folder/.."). Heap. */
char *mt_file_default_root(const char *study_path);

#endif
