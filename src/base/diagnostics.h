/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIAGNOSTICS_H
#define BASE_DIAGNOSTICS_H

#include "modetune/read.h"

#include <stdbool.h>

#include "base/text.h"

/* A problem with its location; file, pointer and message are offsets of NUL-terminated texts in
 * `parts`. */
typedef struct mt_diagnostic {
    mt_severity severity;
    int line; /* 0: no location and no pointer */
    int column;
    size_t file;
    size_t pointer;
    size_t message;
} mt_diagnostic;

/* Messages about files. Zeroed: an empty list. A lack of memory sets `lines.failed`. */
struct mt_diagnostics {
    mt_text lines; /* as the program prints them */
    mt_text parts;
    mt_diagnostic *items; /* heap */
    int count;
    int capacity;
    int left_out;
};

/* Location of a value in a file. */
typedef struct mt_diagnostic_place {
    const char *file;
    int line; /* 0: no location */
    int column;
    const char *pointer; /* NULL or empty: none */
} mt_diagnostic_place;

/* Add one; texts are copied. In message and line, what a terminal would obey is made visible
 * and long texts are cut; the pointer is kept as it is. */
void mt_diagnostics_add(mt_diagnostics *d, mt_severity severity,
                        const mt_diagnostic_place *place, const char *message);
/* Adds "file: n more not shown". */
void mt_diagnostics_leave_out(mt_diagnostics *d, const char *file, int n);
/* Append the messages of `more` to d. */
void mt_diagnostics_append(mt_diagnostics *d, const mt_diagnostics *more);
/* Index of the first error; -1: none. */
int mt_diagnostics_first_error(const mt_diagnostics *d);
/* Free the contents of a struct that is not itself on the heap; it is empty afterwards. */
void mt_diagnostics_free(mt_diagnostics *d);

#endif
