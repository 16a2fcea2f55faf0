/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SHIPPED_H
#define CLI_SHIPPED_H

#include "cli/args.h"
#include "io/shipped.h"
#include "report/table.h"

enum { MT_SHIPPED_NAME = 64, MT_SHIPPED_MOST = 100 };

/* The first sentence of what a file says of itself in a member of its root, added to out;
 * nothing where it has none. */
void mt_shipped_say(const mt_shipped *file, const char *member, mt_text *out);
/* A list of files in the form asked for; as JSON a list of objects of texts. */
void mt_shipped_print(const mt_args *args, const mt_table *t, mt_text *out);
/* MT_E_USAGE: no `what` ("schema") is called so; with the nearest of the n that there are, or
 * where to see them. */
mt_status mt_shipped_unknown(const char *what, const char *name, const char *const *names,
                             int n, mt_err *err);
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
