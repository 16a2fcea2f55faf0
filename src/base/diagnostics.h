/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIAGNOSTICS_H
#define BASE_DIAGNOSTICS_H

#include "modetune/read.h"

#include <stdbool.h>

#include "base/text.h"

/* A problem with its place: offsets into `parts`, where NUL-terminated texts stand. */
typedef struct mt_diagnostic {
    mt_severity severity;
    int line; /* 0: no place, and no pointer */
    int column;
    size_t file;
    size_t pointer;
    size_t message;
} mt_diagnostic;

/* What is told about files. Zeroed: an empty list. Memory that is out sets `lines.failed`, as
 * in every text. */
struct mt_diagnostics {
    mt_text lines; /* as the program prints them */
    mt_text parts;
    mt_diagnostic *items; /* heap */
    int count;
    int capacity;
    int left_out;
};

/* Where something stands. */
typedef struct mt_diagnostic_place {
    const char *file;
    int line; /* 0: in no place */
    int column;
    const char *pointer; /* NULL: none, as the empty one */
} mt_diagnostic_place;

/* Add one; texts are copied. What a terminal would obey is made visible in message and line,
 * and both are cut where they are long; the pointer stays as it is. */
void mt_diagnostics_add(mt_diagnostics *d, mt_severity severity,
                        const mt_diagnostic_place *place, const char *message);
/* "file: n more not shown" */
void mt_diagnostics_leave_out(mt_diagnostics *d, const char *file, int n);
/* Those of `more` behind those of d. */
void mt_diagnostics_append(mt_diagnostics *d, const mt_diagnostics *more);
/* The first error; -1: there is none. */
int mt_diagnostics_first_error(const mt_diagnostics *d);
/* Give back what it holds, for one that is no heap object of its own: it is empty then. */
void mt_diagnostics_free(mt_diagnostics *d);

#endif
