/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SHIPPED_H
#define CLI_SHIPPED_H

#include "cli/args.h"
#include "io/file.h"
#include "vibration/profile_response.h"

/* A kind of shipped files: those in one folder with one ending; the name is between these. */
typedef struct mt_shipped_kind {
    const char *command; /* command that lists them */
    const char *what;    /* what one of them is called */
    const char *folder;
    const char *ending;
    const char *says; /* member of their root with their description, and its name */
    const char *heading;
} mt_shipped_kind;

extern const mt_shipped_kind mt_shipped_examples;
extern const mt_shipped_kind mt_shipped_schemas;
extern const mt_shipped_kind mt_shipped_profiles;

/* Append the names of the files, separated by blanks. */
void mt_shipped_names(const mt_shipped_kind *kind, mt_text *out);
/* List the files, with the first sentence of their descriptions, in the requested format: as
 * JSON a list of objects of texts. Returns the exit status. */
extern const mt_record mt_listed_record;
int mt_shipped_list(const mt_args *args, const mt_shipped_kind *kind, mt_text *out);

/* Load the profile in the file of that name, or, where there is none, the profile of that name
 * built into the program, with its catalogue. Fails and messages as mt_vibration_load. */
mt_status mt_shipped_load_profile(const mt_args *args, const char *name, mt_vibration **out,
                                  mt_diagnostics *messages, mt_err *err);

#endif
