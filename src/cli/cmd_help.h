/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CMD_HELP_H
#define CLI_CMD_HELP_H

#include <stdbool.h>

#include "io/shipped.h"

/* The document of that path; NULL: none. */
const mt_shipped *mt_documents_find(const char *path);
/* The document of the commands. */
#define MT_DOCUMENT_COMMANDS "src/cli/README.md"

/* A part of a document: a heading with everything below it, or an item of a list or a row of a
 * table that begins with a name in backquotes. Code blocks have none of these. */
typedef struct mt_passage {
    int level;         /* of a heading, from 1; 0: an item or a row */
    const char *begin; /* its first line */
    const char *body;  /* after the heading's line; NULL for an item or a row */
    const char *end;   /* after its last line */
} mt_passage;

/* Move *p to the next heading, item or row of the text, or, with begin NULL, to the first one.
 * False: none. O(text passed over and the section). */
bool mt_passage_next(const char *text, mt_passage *p);
/* The next name of a passage. Names are all words in backquotes of a heading or of the first
 * cell of a row, and the first one of an item. *at is NULL before the first; *name has *length
 * bytes, not terminated. False: no more names. */
bool mt_passage_name(const mt_passage *p, const char **at, const char **name, size_t *length);
/* True where name is one of the passage's names. */
bool mt_passage_is(const mt_passage *p, const char *name);

#endif
