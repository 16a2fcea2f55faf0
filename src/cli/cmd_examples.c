/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune examples: the studies that are part of the program, with all that they name. */
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"

/* True where the text of a file names the other one, be it by its path from its own folder, or,
 * a catalogue of aircraft, by one of these. */
static bool names(const mt_shipped *file, const mt_shipped *other)
{
    const char *const base = strrchr(other->path, '/') + 1;
    char quoted[MT_SHIPPED_NAME + 4];
    const bool catalogue = strcmp(base, "aircraft.json") == 0;
    (void)mt_snprintf(quoted, sizeof quoted, "%s%s\"", catalogue ? "" : "/", base);
    return strstr(file->bytes, quoted) != NULL ||
           (catalogue && strstr(file->bytes, "\"aircraft\"") != NULL);
}

/* The files that those of copies[0 .. n) name, and what these name. */
static int add_named(mt_shipped_copy *copies, int n)
{
    int count = 0;
    const mt_shipped *const files = mt_shipped_all(&count);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < count && n < MT_SHIPPED_MOST; k++) {
            bool has = strncmp(files[k].path, mt_shipped_examples.folder,
                               strlen(mt_shipped_examples.folder)) == 0;
            for (int j = 0; j < n; j++) {
                has = has || copies[j].file == &files[k];
            }
            if (!has && strncmp(files[k].path, "init/", strlen("init/")) != 0 &&
                names(copies[i].file, &files[k])) {
                copies[n++] = (mt_shipped_copy){&files[k], files[k].path};
            }
        }
    }
    return n;
}

int mt_cmd_examples(const mt_args *args, mt_text *out)
{
    mt_shipped_copy copies[MT_SHIPPED_MOST];
    mt_err err = {.code = MT_OK};
    int n = 0;
    if (args->n_operands == 0) {
        return mt_shipped_list(args, &mt_shipped_examples, out);
    }
    mt_status rc = MT_OK;
    for (int i = 0; i < args->n_operands && i < MT_SHIPPED_MOST && rc == MT_OK; i++) {
        const mt_shipped *file = NULL;
        rc = mt_shipped_named(&mt_shipped_examples, args->operands[i], &file, &err);
        if (rc == MT_OK) {
            copies[n++] = (mt_shipped_copy){file, file->path};
        }
    }
    const char *const to =
        args->value[MT_OPT_OUTPUT] != NULL ? args->value[MT_OPT_OUTPUT] : ".";
    n = rc == MT_OK ? add_named(copies, n) : n;
    rc = rc == MT_OK ? mt_shipped_write(to, copies, n, &err) : rc;
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    for (int i = 0; i < n; i++) {
        mt_text_addf(out, "%s/%s\n", to, copies[i].name);
    }
    return MT_EXIT_DONE;
}
