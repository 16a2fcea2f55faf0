/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_DOCUMENTS_H
#define CLI_DOCUMENTS_H

#include <stdbool.h>

#include "io/shipped.h"

/* The documents that are part of the program, Markdown, by path; *n their number. */
const mt_shipped *mt_documents_all(int *n);
/* NULL: there is none. */
const mt_shipped *mt_documents_find(const char *path);
/* It is a reference that is made from schemas: other pages come before it. */
bool mt_document_is_reference(const mt_shipped *document);
/* The page of the commands. */
#define MT_DOCUMENT_COMMANDS "src/cli/README.md"

/* A part of a document: a heading with all below it, or an item of a list or a row of a table
 * that begins with a name in backquotes. Code blocks have none of these. */
typedef struct mt_passage {
    int level;         /* of a heading, from 1; 0: an item or a row */
    const char *begin; /* its first line */
    const char *body;  /* behind the heading's line; else NULL */
    const char *end;   /* behind its last line */
} mt_passage;

/* Make *p the next heading, item or row of the text; with begin NULL the first one. false:
 * there is none. Time in proportion to what is walked over, and to the section. */
bool mt_passage_next(const char *text, mt_passage *p);
/* Its names: all words in backquotes of a heading or of the first cell of a row, of an item
 * the first. *at is NULL before the first; *name, *length: not terminated. false: there are no
 * more. */
bool mt_passage_name(const mt_passage *p, const char **at, const char **name, size_t *length);
/* That is one of its names. */
bool mt_passage_is(const mt_passage *p, const char *name);
bool mt_passage_is_row(const mt_passage *p);

#endif
