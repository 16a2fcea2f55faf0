/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_OPTIONS_H
#define IO_OPTIONS_H

#include "io/file.h"

/* Numbers that override those of the files. */
typedef struct mt_overrides {
    int n_sets;
    const char *const *sets;  /* NAME=VALUE (model/values.h), of the study's own model */
    long seed;                /* -1: as the study says */
    long starts;              /* 0: as the study says */
    long max_evaluations;     /* 0: as the study says */
    long max_modal_solutions; /* 0: as the study says */
    double proof_s;           /* NaN: as the study says */
} mt_overrides;

/* Options of every reader of files. */
typedef struct mt_io_options {
    /* folder that must contain files named by other files; NULL: for a study the parent of its
     * folder, for a model no limit */
    const char *root;
    mt_files files;            /* source of models, studies and catalogues; zeroed: the disk */
    size_t max_bytes;          /* of one file; 0: MT_JSON_MAX_BYTES */
    const mt_overrides *asked; /* NULL: no overrides */
    /* [out] number of errors that a JSON Schema of the file detects, too; NULL: not
     * requested */
    int *structural;
} mt_io_options;

#endif
