/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_DOCUMENTS_H
#define CLI_DOCUMENTS_H

#include <stdbool.h>

#include "io/shipped.h"

/* The documents that are part of the program, Markdown, by path; *n their number. */
const mt_shipped *mt_documents_all(int *n);
/* NULL: there is none. */
const mt_shipped *mt_documents_find(const char *path);
/* Is it a reference that is made from schemas, so that other pages come before it? */
bool mt_document_is_reference(const mt_shipped *document);
/* The page of the commands. */
#define MT_DOCUMENT_COMMANDS "src/cli/README.md"

/* A part of a document: a heading with all below it, or an item of a list that begins with a
 * name in backquotes. Code blocks have neither. */
typedef struct mt_passage {
    int level;         /* of a heading, from 1; 0: an item of a list */
    const char *begin; /* its first line */
    const char *body;  /* behind the heading's line; of an item NULL */
    const char *end;   /* behind its last line */
} mt_passage;

/* Make *p the next heading, or item, of the text; with begin NULL the first one. false: there
 * is none. Time in proportion to what is walked over, and to the section. */
bool mt_passage_next(const char *text, mt_passage *p);
/* Its names: of a heading all words in backquotes, of an item the first. *at is NULL before
 * the first; *name, *length: not terminated. false: there are no more. */
bool mt_passage_name(const mt_passage *p, const char **at, const char **name, size_t *length);
/* Is that one of its names? */
bool mt_passage_is(const mt_passage *p, const char *name);

#endif
