/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How models and studies are read: from files or from texts in memory, and what was found wrong
 * with them.
 *
 * Structs of options grow with the library. Each begins with its size: set it to sizeof, all
 * else to 0 (which is the default of every member), then what is wanted:
 *     mt_read_options opt = {.size = sizeof opt, .root = "/data"};
 * A library that is newer than the caller sees a shorter struct, and takes 0 for the rest; one
 * that is older refuses a longer struct (MT_E_USAGE) only where a member that it does not know
 * is not 0. So nothing that is asked for is passed over, and no caller needs to be compiled
 * anew. There are no setters: they could not be checked by the compiler against a call that is
 * forgotten, would need memory that may be out, and an object to delete.
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

/* Everything that was found in files, in the order of files and places. To be used by one
 * thread at a time; texts of it live until it is deleted or given to the next call that
 * reads. */
typedef struct mt_diagnostics mt_diagnostics;

/**
 * An empty list.
 * @param[out] out  owned by the caller; NULL on failure
 * Fails: MT_E_MEMORY.
 */
MT_API mt_status mt_diagnostics_new(mt_diagnostics **out, mt_err *err);
/* Accepts NULL. */
MT_API void mt_diagnostics_delete(mt_diagnostics *d);
/* How many are listed: a file has 200 at most; and how many more there are, which are not.
 * None where memory ran out while they were listed: the call has said so. */
MT_API int mt_diagnostics_count(const mt_diagnostics *d);
MT_API int mt_diagnostics_left_out(const mt_diagnostics *d);
/* Number i, from 0. MT_SEVERITY_COUNT beyond the last. */
MT_API mt_severity mt_diagnostics_severity(const mt_diagnostics *d, int i);
/* The file, as it was asked for; NULL beyond the last. */
MT_API const char *mt_diagnostics_file(const mt_diagnostics *d, int i);
/* Where in it: line and column (of code points) from 1; 0 for what has no place. */
MT_API int mt_diagnostics_line(const mt_diagnostics *d, int i);
MT_API int mt_diagnostics_column(const mt_diagnostics *d, int i);
/* JSON pointer (RFC 6901) of the value, "" of the whole; NULL for what has no place. */
MT_API const char *mt_diagnostics_pointer(const mt_diagnostics *d, int i);
MT_API const char *mt_diagnostics_message(const mt_diagnostics *d, int i);
/* All of them as a compiler writes them, "file:line:column: error: /pointer: message", one a
 * line; "" where there are none, NULL without a list. */
MT_API const char *mt_diagnostics_text(const mt_diagnostics *d);

/* A file that is given by its text. */
typedef struct mt_file_text {
    const char *path; /* as the caller or another file names it, "a/../b" being "b" */
    const char *text; /* NUL-terminated; need not outlive the call */
} mt_file_text;

typedef struct mt_read_options {
    size_t size; /* sizeof(mt_read_options) */
    /* folder that files named by other files must lie beneath; NULL: the parent of the
     * study's */
    const char *root;
    /* [n_files] files that are not looked for on the disk, whatever the root; NULL with 0 */
    const mt_file_text *files;
    int n_files;
    int files_only; /* 1: no other files are there, the disk is left alone */
    /* emptied, then filled with every error and warning, also where the call succeeds; NULL */
    mt_diagnostics *diagnostics;
    /* [n_sets] "NAME=VALUE" each: what parameters get instead of their values, of a study
     * those of its own model that it does not vary. A value is a number in the unit that the
     * file gives the parameter in, or an expression of the file's values, in SI ("k=1.1*k").
     * NULL with 0 */
    const char *const *sets;
    int n_sets;
    /* what a study's search draws its starts from instead of what it says, at least 0; NULL */
    const int *seed;
} mt_read_options;

#ifdef __cplusplus
}
#endif

#endif
