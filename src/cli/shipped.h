/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SHIPPED_H
#define CLI_SHIPPED_H

#include "cli/args.h"
#include "io/shipped.h"

enum { MT_SHIPPED_NAME = 64, MT_SHIPPED_MOST = 100 };

/* Files of one folder and ending, which between them have a name. */
typedef struct mt_shipped_kind {
    const char *command; /* that lists them */
    const char *what;    /* one of them is called so */
    const char *folder;
    const char *ending;
    const char *says; /* member of their root that says what they are, and what it is called */
    const char *heading;
} mt_shipped_kind;

extern const mt_shipped_kind mt_shipped_examples;
extern const mt_shipped_kind mt_shipped_schemas;
extern const mt_shipped_kind mt_shipped_profiles;

/* Append their names, a blank between them. */
void mt_shipped_names(const mt_shipped_kind *kind, mt_text *out);
/* A list of them, with the first sentence of what they say, in the form asked for: as JSON a
 * list of objects of texts. Returns the exit status. */
int mt_shipped_list(const mt_args *args, const mt_shipped_kind *kind, mt_text *out);
/* The one of a name. Fails: MT_E_USAGE, with the nearest name or where to see them all. */
mt_status mt_shipped_named(const mt_shipped_kind *kind, const char *name,
                           const mt_shipped **out, mt_err *err);
/**
 * Write n files of the distribution beneath a folder, which is made, under names of theirs
 * there. A file that is there and holds other bytes is left alone, and none is written.
 * Fails: MT_E_INPUT (it names the first such file), MT_E_SYSTEM, MT_E_MEMORY.
 */
typedef struct mt_shipped_copy {
    const mt_shipped *file;
    const char *name; /* "schemas/model.schema.json" */
} mt_shipped_copy;
mt_status mt_shipped_write(const char *folder, const mt_shipped_copy *copies, int n,
                           mt_err *err);

#endif
