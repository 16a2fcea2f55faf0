/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune examples: the studies that are part of the program, with all that they name. */
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"

static const char folder[] = "studies/";
static const char ending[] = ".json";

/* "inceptor_rotor" of studies/inceptor_rotor.json, in name[size]; false: it is no study. */
static bool name_of(const mt_shipped *file, char *name, size_t size)
{
    const size_t before = sizeof folder - 1;
    const size_t length = strlen(file->path);
    if (strncmp(file->path, folder, before) != 0) {
        return false;
    }
    (void)mt_snprintf(name, size, "%.*s", (int)(length - before - (sizeof ending - 1)),
                      file->path + before);
    return true;
}

static void list(const mt_args *args, mt_text *out)
{
    mt_table t = mt_table_default();
    int n = 0;
    const mt_shipped *const files = mt_shipped_all(&n);
    mt_table_column(&t, "example", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "what it is", "title", MT_ALIGN_LEFT);
    for (int i = 0; i < n; i++) {
        char name[MT_SHIPPED_NAME];
        mt_text title = {.s = NULL};
        if (name_of(&files[i], name, sizeof name)) {
            mt_shipped_say(&files[i], "name", &title);
            mt_table_text(&t, name);
            mt_table_text(&t, title.s);
        }
        t.failed = t.failed || title.failed;
        mt_text_free(&title);
    }
    mt_shipped_print(args, &t, out);
    mt_table_free(&t);
}

/* Does the text of a file name the other one, be it by its path from its own folder, or, a
 * catalogue of aircraft, by one of these? */
static bool names(const mt_shipped *file, const mt_shipped *other)
{
    const char *const base = strrchr(other->path, '/') + 1;
    char quoted[MT_SHIPPED_NAME + 4];
    (void)mt_snprintf(quoted, sizeof quoted, "/%s\"", base);
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
            bool has = strncmp(files[k].path, folder, sizeof folder - 1) == 0;
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

static mt_status find(const char *wanted, mt_shipped_copy *copies, int *n, mt_err *err)
{
    const char *known[MT_SHIPPED_MOST];
    char text[MT_SHIPPED_MOST][MT_SHIPPED_NAME];
    int n_known = 0;
    int count = 0;
    const mt_shipped *const files = mt_shipped_all(&count);
    for (int i = 0; i < count && n_known < MT_SHIPPED_MOST; i++) {
        if (!name_of(&files[i], text[n_known], MT_SHIPPED_NAME)) {
            continue;
        }
        if (strcmp(text[n_known], wanted) == 0) {
            copies[(*n)++] = (mt_shipped_copy){&files[i], files[i].path};
            return MT_OK;
        }
        known[n_known] = text[n_known];
        n_known++;
    }
    return mt_shipped_unknown("example", wanted, known, n_known, err);
}

int mt_cmd_examples(const mt_args *args, mt_text *out)
{
    mt_shipped_copy copies[MT_SHIPPED_MOST];
    mt_err err = {.code = MT_OK};
    int n = 0;
    if (args->n_operands == 0) {
        list(args, out);
        return MT_EXIT_DONE;
    }
    mt_status rc = MT_OK;
    for (int i = 0; i < args->n_operands && i < MT_SHIPPED_MOST && rc == MT_OK; i++) {
        rc = find(args->operands[i], copies, &n, &err);
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
