/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/shipped.h"

#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/folder.h"
#include "io/io.h"
#include "io/write_json.h"

void mt_shipped_say(const mt_shipped *file, const char *member, mt_text *out)
{
    mt_json *doc = NULL;
    if (mt_json_parse(file->bytes, file->size, &doc, NULL) != MT_OK) {
        out->failed = true; /* it is ours: memory is out */
        return;
    }
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, member);
    if (at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_STRING) {
        const char *const text = mt_json_string(doc, at);
        const char *const end = strstr(text, ". ");
        mt_text_add_n(out, text, end == NULL ? strlen(text) : (size_t)(end + 1 - text));
    }
    mt_json_delete(doc);
}

static void print_json(const mt_table *t, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_json_open(&w, NULL, '[');
    for (int row = 0; row < mt_table_rows(t); row++) {
        mt_json_open(&w, NULL, '{');
        for (int k = 0; k < t->n_columns; k++) {
            const mt_cell *const cell = &t->cells[(row * t->n_columns) + k];
            mt_json_put_string(&w, t->columns[k].member, cell->exact);
        }
        mt_json_close(&w);
    }
    mt_json_close(&w);
    (void)mt_json_done(&w);
    out->failed = out->failed || t->failed;
}

void mt_shipped_print(const mt_args *args, const mt_table *t, mt_text *out)
{
    if (args->format == MT_FORMAT_JSON) {
        print_json(t, out);
    } else if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(t, out);
    } else {
        mt_table_print(t, 0, out);
    }
}

mt_status mt_shipped_unknown(const char *what, const char *name, const char *const *names,
                             int n, mt_err *err)
{
    const char *const near = mt_text_nearest(name, names, n);
    return near == NULL
               ? mt_fail(err, MT_E_USAGE,
                         "no %s is called \"%s\": \"modetune %s%s\" lists them", what, name,
                         what, strcmp(what, "example") == 0 ? "s" : "")
               : mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"; did you mean \"%s\"?", what,
                         name, near);
}

/* Is there something else under the path? *same: the very bytes. */
static mt_status look(const char *path, const mt_shipped *file, bool *same, mt_err *err)
{
    mt_file there = {.bytes = NULL};
    *same = false;
    if (mt_file_absent(path)) {
        return MT_OK;
    }
    const mt_status rc = mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &there, err);
    if (rc != MT_OK) {
        return rc;
    }
    *same = there.length == file->size && memcmp(there.bytes, file->bytes, file->size) == 0;
    mt_file_free(&there);
    return *same ? MT_OK
                 : mt_fail(err, MT_E_INPUT, "%s: is there already, and is left alone", path);
}

static mt_status write_one(const char *folder, const mt_shipped_copy *copy, mt_err *err)
{
    const char *const slash = strrchr(copy->name, '/');
    mt_text into = {.s = NULL};
    mt_text_add(&into, folder);
    if (slash != NULL) {
        mt_text_add(&into, "/");
        mt_text_add_n(&into, copy->name, (size_t)(slash - copy->name));
    }
    const mt_folder_file file = {.name = slash == NULL ? copy->name : slash + 1,
                                 .bytes = copy->file->bytes,
                                 .length = copy->file->size};
    const mt_status rc =
        into.failed ? mt_fail_memory(err) : mt_folder_replace(into.s, &file, 1, err);
    mt_text_free(&into);
    return rc;
}

mt_status mt_shipped_write(const char *folder, const mt_shipped_copy *copies, int n,
                           mt_err *err)
{
    bool same[MT_SHIPPED_MOST] = {false};
    mt_status rc = MT_OK;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        mt_text path = {.s = NULL};
        mt_text_addf(&path, "%s/%s", folder, copies[i].name);
        rc = path.failed ? mt_fail_memory(err) : look(path.s, copies[i].file, &same[i], err);
        mt_text_free(&path);
    }
    for (int i = 0; i < n && rc == MT_OK; i++) {
        rc = same[i] ? MT_OK : write_one(folder, &copies[i], err);
    }
    return rc;
}
