/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_FOLDER_H
#define IO_FOLDER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/base.h"

/* One of the files that a folder shall hold. */
typedef struct mt_folder_file {
    const char *name;  /* without folder, below MT_FOLDER_NAME bytes */
    const char *bytes; /* NULL: no file of this name shall stay */
    size_t length;
} mt_folder_file;

enum { MT_FOLDER_NAME = 128, MT_FOLDER_PATIENCE_MS = 60000 };

/* Make a folder and those above it, as far as they are not there. Fails: MT_E_SYSTEM,
 * MT_E_MEMORY. */
mt_status mt_folder_make(const char *path, mt_err *err);

/**
 * Replace n files of a folder as one, others in it are left alone; the folder and those above
 * it are made. The last file decides: until it has been renamed the old files can be had back,
 * from then on the new ones are there. A failure leaves the old files as they were and nothing
 * else; so does, once the next call has come as far as its lock, a process that was killed. One
 * call at a time per folder (mt_folder_lock); a file that is replaced keeps its permissions.
 * @param[in] files the same names in every call, the last one with bytes Fails: MT_E_SYSTEM,
 *   MT_E_MEMORY. After MT_E_SYSTEM the new files may be there all the same where the disk would
 *   not confirm them; the text says so.
 */
mt_status mt_folder_replace(const char *folder, const mt_folder_file *files, int n,
                            mt_err *err);

/**
 * Have the folder to oneself, or (shared) with others who only look. Held by the folder's own
 * descriptor: nothing is written for it, and it ends with the process. Where the file system
 * knows no locks there is none. Waits. Fails: MT_E_SYSTEM, also where it is not to be had in
 * time.
 */
mt_status mt_folder_lock(const char *folder, bool shared, int patience_ms, int *lock,
                         mt_err *err);
void mt_folder_unlock(int lock);

/* True where a replacement of the files that `last` decides about is under way in the folder,
 * or was cut. */
bool mt_folder_unfinished(const char *folder, const char *last);

#endif
