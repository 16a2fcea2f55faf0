/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Reading of models and studies from files or from texts in memory, and its diagnostics.
 *
 * Structs of options grow with the library. Each begins with its size: set it to sizeof, all
 * other members to 0 (their default), then those that are needed:
 *     mt_read_options opt = {.size = sizeof opt, .root = "/data"};
 * A library newer than the caller gets a shorter struct and takes 0 for the rest; an older one
 * refuses a longer struct (MT_E_USAGE) only where a member unknown to it is not 0. So no option
 * is ignored, and callers need not be compiled again. There are no setters: the compiler could
 * not detect a forgotten call, and they would need memory and an object to delete.
 */
#ifndef MODETUNE_READ_H
#define MODETUNE_READ_H

#include "modetune/export.h"
#include "modetune/status.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum mt_severity {
    MT_SEVERITY_ERROR,
    MT_SEVERITY_WARNING,
    MT_SEVERITY_NOTE,
    MT_SEVERITY_COUNT
} mt_severity;

/* All diagnostics of files, in the order of files and places. Used by one thread at a time; its
 * texts live until it is deleted or given to the next call that reads. */
typedef struct mt_diagnostics mt_diagnostics;

/**
 * An empty list.
 * @param[out] out  owned by the caller; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_diagnostics_new(mt_diagnostics **out, mt_err *err);
/* Accepts NULL. */
MT_API void mt_diagnostics_delete(mt_diagnostics *d);
/* Number of listed diagnostics, at most 200 per file, and the number of those left out. Both 0
 * where memory ran out while they were listed, which the reading call reports. */
MT_API int mt_diagnostics_count(const mt_diagnostics *d);
MT_API int mt_diagnostics_left_out(const mt_diagnostics *d);
/* Severity of number i, from 0. MT_SEVERITY_COUNT beyond the last. */
MT_API mt_severity mt_diagnostics_severity(const mt_diagnostics *d, int i);
/* Path of the file as given by the caller; NULL beyond the last. */
MT_API const char *mt_diagnostics_file(const mt_diagnostics *d, int i);
/* Line and column (in code points) from 1; 0 where there is no place. */
MT_API int mt_diagnostics_line(const mt_diagnostics *d, int i);
MT_API int mt_diagnostics_column(const mt_diagnostics *d, int i);
/* JSON pointer (RFC 6901) of the value, "" of the whole file; NULL where there is no place. */
MT_API const char *mt_diagnostics_pointer(const mt_diagnostics *d, int i);
MT_API const char *mt_diagnostics_message(const mt_diagnostics *d, int i);
/* All diagnostics in a compiler's format, "file:line:column: error: /pointer: message", one per
 * line; "" where there are none, NULL without a list. */
MT_API const char *mt_diagnostics_text(const mt_diagnostics *d);

/* A file given as text. */
typedef struct mt_file_text {
    const char *path; /* path as the caller or another file names it, "a/../b" being "b" */
    const char *text; /* NUL-terminated; need not outlive the call */
} mt_file_text;

typedef struct mt_read_options {
    size_t size; /* sizeof(mt_read_options) */
    /* folder that must contain all files named by other files; NULL: the parent of the study's
     * folder */
    const char *root;
    /* [n_files] files given as texts, whatever the root; NULL with 0 */
    const mt_file_text *files;
    int n_files;
    int files_only; /* 1: the disk is not read */
    /* NULL, or emptied and then filled with every error and warning, also where the call
     * succeeds */
    mt_diagnostics *diagnostics;
    /* [n_sets] overrides "NAME=VALUE" of parameters, of a study those of its own model that it
     * does not vary. VALUE is a number in the unit of the parameter's number in the file, or an
     * expression of the file's values, in SI ("k=1.1*k"). NULL with 0 */
    const char *const *sets;
    int n_sets;
    /* seed of a study's search instead of its own, at least 0; NULL */
    const int *seed;
} mt_read_options;

#ifdef __cplusplus
}
#endif

#endif
