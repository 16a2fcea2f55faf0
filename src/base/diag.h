/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIAG_H
#define BASE_DIAG_H

#include "modetune/read.h"

#include "base/arena.h"

/*
 * Problems found in an input, all of them, in the order found. An address is a number that the
 * reader of the file hands out (for JSON: the index of the value in document order); only that
 * reader can turn it into file:line:column and a JSON pointer. MT_NO_ADDR: the problem belongs
 * to no place (a model built in memory).
 */
typedef int mt_addr;
/* So many problems are kept; so many of them, the first, say what may have been meant: to look
 * for it takes a walk through all names. */
enum { MT_NO_ADDR = -1, MT_DIAG_LIMIT = 200, MT_DIAG_SUGGESTIONS = 50 };

typedef struct mt_diag {
    mt_addr addr;
    mt_severity severity;
    bool structural; /* an error that a schema of the format can see as well */
    const char *text;
} mt_diag;

typedef struct mt_diags {
    mt_arena *mem; /* not owned */
    mt_diag *items;
    int count;
    int capacity;
    int errors;     /* how many of them are errors (also those beyond the limit) */
    int structural; /* how many of the errors are structural, likewise */
    int warnings;   /* how many are warnings, likewise */
} mt_diags;

/* Empty list whose texts live in mem, which remembers where there is no memory for one. */
mt_diags mt_diags_default(mt_arena *mem);
/* Add a problem; beyond MT_DIAG_LIMIT only counted. */
void mt_diag_error(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* An error of structure: a schema (types, names of members, choices) sees it as well. */
void mt_diag_structure(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* Whether another problem will be kept. */
bool mt_diag_has_room(const mt_diags *d);
/* True where a suggestion ("did you mean") is still worth its search: for the first
 * MT_DIAG_SUGGESTIONS errors. */
bool mt_diag_may_suggest(const mt_diags *d);
void mt_diag_warning(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);

#endif
