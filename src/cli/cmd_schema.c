/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune schema: the JSON Schemas, which editors complete and check files by. */
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/shipped.h"
#include "report/table.h"

static const char folder[] = "schemas/";
static const char ending[] = ".schema.json";

/* "model" of schemas/model.schema.json, in name[size]; false: it is no schema. */
static bool name_of(const mt_shipped *file, char *name, size_t size)
{
    const size_t before = sizeof folder - 1;
    const size_t behind = sizeof ending - 1;
    const size_t length = strlen(file->path);
    if (strncmp(file->path, folder, before) != 0 || length <= before + behind) {
        return false;
    }
    (void)mt_snprintf(name, size, "%.*s", (int)(length - before - behind), file->path + before);
    return true;
}

static void list(const mt_args *args, mt_text *out)
{
    mt_table t = mt_table_default();
    int n = 0;
    const mt_shipped *const files = mt_shipped_all(&n);
    mt_table_column(&t, "schema", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "of", "description", MT_ALIGN_LEFT);
    for (int i = 0; i < n; i++) {
        char name[MT_SHIPPED_NAME];
        mt_text said = {.s = NULL};
        if (name_of(&files[i], name, sizeof name)) {
            mt_shipped_say(&files[i], "description", &said);
            mt_table_text(&t, name);
            mt_table_text(&t, said.s);
        }
        t.failed = t.failed || said.failed;
        mt_text_free(&said);
    }
    mt_shipped_print(args, &t, out);
    mt_table_free(&t);
}

int mt_cmd_schema(const mt_args *args, mt_text *out)
{
    if (args->n_operands == 0) {
        list(args, out);
        return MT_EXIT_DONE;
    }
    const char *names[MT_SHIPPED_MOST];
    char text[MT_SHIPPED_MOST][MT_SHIPPED_NAME];
    int n = 0;
    int count = 0;
    const mt_shipped *const files = mt_shipped_all(&count);
    for (int i = 0; i < count && n < MT_SHIPPED_MOST; i++) {
        if (!name_of(&files[i], text[n], MT_SHIPPED_NAME)) {
            continue;
        }
        if (strcmp(text[n], args->operands[0]) == 0) {
            mt_text_add_n(out, files[i].bytes, files[i].size);
            return MT_EXIT_DONE;
        }
        names[n] = text[n];
        n++;
    }
    mt_err err = {.code = MT_OK};
    return mt_cli_failed(mt_shipped_unknown("schema", args->operands[0], names, n, &err), &err);
}
