/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FOLDER_H
#define IO_FOLDER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/base.h"

/* One of the files of a folder after a replacement. */
typedef struct mt_folder_file {
    const char *name;  /* name without folder, below */
    const char *bytes; /* NULL: the file of this name is removed */
    size_t length;
} mt_folder_file;

enum { MT_FOLDER_NAME = 128, MT_FOLDER_PATIENCE_MS = 60000 };

/* Make a folder and its parents where missing. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_folder_make(const char *path, mt_err *err);

/**
 * Replace n files of a folder atomically; other files in it are unchanged; the folder and its
 * parents are made. The last file is decisive: until it is renamed the old files can be
 * restored, afterwards the new ones are valid. After a failure the old files are unchanged and
 * nothing else remains; after a killed process the next call restores this when it has the
 * lock. One call at a time per folder (mt_folder_lock); a replaced file keeps its permissions.
 * @param[in] files the same names in every call, the last one with bytes
 * Fails: MT_E_SYSTEM, MT_E_MEMORY. After MT_E_SYSTEM the new files may still be there where the
 * disk did not confirm them; the text says so.
 */
mt_status mt_folder_replace(const char *folder, const mt_folder_file *files, int n,
                            mt_err *err);

/**
 * Lock the folder exclusively, or (shared) together with readers. The lock is on the folder's
 * descriptor: no file is written, and it ends with the process. On file systems without locks
 * there is none. Waits up to patience_ms. Fails: MT_E_SYSTEM, also where the lock is not free
 * in time.
 */
mt_status mt_folder_lock(const char *folder, bool shared, int patience_ms, int *lock,
                         mt_err *err);
void mt_folder_unlock(int lock);

/* True where a replacement of the files of which `last` is decisive is in progress in the
 * folder, or was interrupted. */
bool mt_folder_unfinished(const char *folder, const char *last);

#endif
