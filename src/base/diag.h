/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIAG_H
#define BASE_DIAG_H

#include "modetune/read.h"

#include "base/arena.h"

/*
 * All problems found in an input, in the order found. An address is a number that the reader of
 * the file assigns (for JSON: the index of the value in document order); only that reader turns
 * it into file:line:column and a JSON pointer. MT_NO_ADDR: the problem has no location (a model
 * built in memory).
 */
typedef int mt_addr;
/* MT_DIAG_LIMIT problems are kept. The first MT_DIAG_SUGGESTIONS of them get a suggestion,
 * which costs a walk through all names. */
enum { MT_NO_ADDR = -1, MT_DIAG_LIMIT = 200, MT_DIAG_SUGGESTIONS = 50 };

typedef struct mt_diag {
    mt_addr addr;
    mt_severity severity;
    bool structural; /* a schema of the format finds this error as well */
    const char *text;
} mt_diag;

typedef struct mt_diags {
    mt_arena *mem; /* not owned */
    mt_diag *items;
    int count;
    int capacity;
    int errors;     /* number of errors, including those beyond the limit */
    int structural; /* number of structural errors, including those beyond the limit */
    int warnings;   /* number of warnings, including those beyond the limit */
} mt_diags;

/* Empty list with its texts in mem; a shortage is kept in mem (mt_arena_check). */
mt_diags mt_diags_default(mt_arena *mem);
/* Add a problem; beyond MT_DIAG_LIMIT it is counted only. */
void mt_diag_error(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* Add an error of structure (types, names of members, choices), which a schema finds as
 * well. */
void mt_diag_structure(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* True where another problem would be kept. */
bool mt_diag_has_room(const mt_diags *d);
/* True for the first MT_DIAG_SUGGESTIONS errors, which get a suggestion ("did you mean"). */
bool mt_diag_may_suggest(const mt_diags *d);
void mt_diag_warning(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);

#endif
