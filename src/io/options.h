/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_OPTIONS_H
#define IO_OPTIONS_H

#include "io/files.h"

/* What every reader of files takes. */
typedef struct mt_io_options {
    /* folder that files named by other files must lie in; NULL: for a study the parent of its
     * folder, for a model no limit */
    const char *root;
    mt_files files;   /* where models, studies and catalogues come from; zeroed: the disk */
    size_t max_bytes; /* of one file; 0: MT_JSON_MAX_BYTES */
    /* [out] number of errors that a JSON Schema of the file sees as well; NULL: not wanted */
    int *structural;
} mt_io_options;

#endif
