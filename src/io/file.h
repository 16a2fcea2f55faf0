/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FILE_H
#define IO_FILE_H

#include "modetune/read.h"

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
 * The only functions that open files (structure/test_calls). They return descriptors that the
 * caller closes, not inherited by other programs; -1 with errno on failure. A name is relative
 * to `folder`, a descriptor or MT_FILE_HERE.
 */
extern const int MT_FILE_HERE;
/* Open a file for reading. ELOOP where the last part of the name is a link; does not wait for a
 * pipe. */
int mt_file_open(int folder, const char *name);
/* Open a folder, also by a link. */
int mt_file_open_folder(const char *path);
/* Open a file for appending: a new one, or (adds) an existing one that has no other name.
 * Fails: EEXIST, with adds ENOENT, and ELOOP, ENXIO or EMLINK for a link, a file that is not
 * regular, and one with several names. */
int mt_file_create(int folder, const char *name, bool adds);
/* Write all bytes; false with errno. */
bool mt_file_write(int fd, const char *bytes, size_t length);

/**
 * Read a regular file of at most `limit` bytes. Symbolic links are followed; where root is not
 * NULL their target must lie within that folder (whose links are resolved, too). Fails:
 * MT_E_INPUT (not a regular file, too long, outside root), MT_E_SYSTEM (does not exist, not
 * readable), MT_E_MEMORY. The messages name the path as given.
 */
mt_status mt_file_read(const char *path, const char *root, size_t limit, mt_file *out,
                       mt_err *err);
void mt_file_free(mt_file *f);
/* True where the name certainly leads to nothing; false where something is there, or where that
 * is unknown. */
bool mt_file_absent(const char *path);
/* Turn the system's error number into a failure of the path: MT_E_SYSTEM, or MT_E_MEMORY. */
mt_status mt_file_failed(const char *path, int code, mt_err *err);

/* The path of `name` as given in the file `naming`: relative names start in the folder of
 * `naming`. Heap, to be freed by the caller; NULL when out of memory. Joins texts without
 * access to the disk. */
char *mt_file_join(const char *naming, const char *name);
/* The folder of a file ("." where the path has none); heap, NULL when out of memory. */
char *mt_file_folder(const char *path);
/* The folder that the files named by a study must lie in by default: the parent of its folder
 * ("folder/.."). Heap. */
char *mt_file_default_root(const char *study_path);

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

/* Call f(context, err) with this thread in the locale "C", so that numbers of the C library
 * have its decimal point; then restore the thread's locale. Fails: as f, MT_E_MEMORY. */
mt_status mt_locale_plain(mt_status (*f)(void *context, mt_err *err), void *context,
                          mt_err *err);

#endif
