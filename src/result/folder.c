/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What belongs to a result.json. It names the files beside it with their digests (run.outputs)
 * but for timing.json, which differs from run to run where the result does not, and so names
 * the result's digest instead. A file that is not there contradicts nothing, unless the folder
 * is just being replaced; one that is must be the one that is named.
 */
#include "result/folder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/file.h"
#include "io/folder.h"
#include "io/json.h"

static const char RESULT[] = "result.json";
static const char TIMING[] = "timing.json";

enum { PART_MAX_BYTES = 1 << 28 };

typedef enum part_state { PART_MISSING, PART_BELONGS, PART_FOREIGN } part_state;

const char *mt_result_file_name(mt_result_file which)
{
#define FILE_NAME(id, name) [id] = (name),
    static const char *const names[MT_RESULT_FILE_COUNT] = {MT_RESULT_FILE_LIST(FILE_NAME)};
#undef FILE_NAME
    return names[which];
}

mt_status mt_result_path(const char *path, char **out, mt_err *err)
{
    struct stat st;
    mt_text t = {.s = NULL};
    const bool there = stat(path, &st) == 0;
    *out = NULL;
    if (!there && !mt_file_absent(path)) {
        return mt_file_failed(path, errno, err);
    }
    mt_text_add(&t, path);
    if (there && S_ISDIR(st.st_mode)) {
        mt_text_add(&t, path[0] != '\0' && path[strlen(path) - 1] == '/' ? "" : "/");
        mt_text_add(&t, RESULT);
    }
    if (t.failed) {
        mt_text_free(&t);
        return mt_fail_memory(err);
    }
    *out = t.s;
    return MT_OK;
}

mt_status mt_result_note_outputs(mt_result *result, int n, const char *const *names,
                                 char (*sha256)[MT_SHA256_TEXT], mt_err *err)
{
    mt_result_run *const run = &result->run;
    run->n_outputs = 0;
    run->outputs = mt_arena_alloc(&result->mem, (size_t)n, sizeof *run->outputs);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < n; i++) {
        mt_result_digest *const output = &run->outputs[i];
        output->file = mt_arena_strdup(&result->mem, names[i]);
        output->sha256 = mt_arena_strdup(&result->mem, sha256[i]);
    }
    MT_TRY(mt_arena_check(&result->mem, err));
    run->n_outputs = n;
    return MT_OK;
}

/* *does: true where timing.json names the result with this digest. */
static mt_status names_result(const mt_file *timing, const char *sha256, bool *does,
                              mt_err *err)
{
    mt_json *doc = NULL;
    mt_status rc = mt_json_parse(timing->bytes, timing->length, &doc, err);
    *does = false;
    if (rc == MT_OK) {
        const mt_addr value = mt_json_member(doc, MT_JSON_ROOT, "result_sha256");
        *does = value != MT_NO_ADDR && mt_json_type_of(doc, value) == MT_JSON_STRING &&
                strcmp(mt_json_string(doc, value), sha256) == 0;
    }
    mt_json_delete(doc);
    return rc == MT_E_INPUT ? MT_OK : rc;
}

mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out, mt_err *err)
{
    const char *const name = mt_result_file_name(MT_RESULT_FILE_TIMING);
    char *const timing = mt_file_join(path, name);
    mt_file file = {.bytes = NULL};
    bool belongs = false;
    if (timing == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = MT_OK;
    if (!mt_file_absent(timing)) {
        rc = mt_file_read(timing, NULL, PART_MAX_BYTES, &file, err);
        rc = rc == MT_OK ? names_result(&file, sha256, &belongs, err) : rc;
    }
    if (belongs) {
        mt_text_add_n(out, file.bytes, file.length);
    }
    mt_file_free(&file);
    free(timing);
    return out->failed ? mt_fail_memory(err) : rc == MT_E_INPUT ? MT_OK : rc;
}

/* The file of that name beside the result; `sha256` is its own digest, or the result's for
 * timing.json. */
static mt_status check_part_file(const char *path, const char *name, const char *sha256,
                                 part_state *state, mt_err *err)
{
    char *const part = mt_file_join(path, name);
    mt_file file = {.bytes = NULL};
    if (part == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = MT_OK;
    *state = PART_MISSING;
    if (!mt_file_absent(part)) {
        bool belongs = false;
        rc = mt_file_read(part, NULL, PART_MAX_BYTES, &file, err);
        if (rc == MT_OK && strcmp(name, TIMING) == 0) {
            rc = names_result(&file, sha256, &belongs, err);
        } else if (rc == MT_OK) {
            belongs = strcmp(file.sha256, sha256) == 0;
        }
        *state = belongs ? PART_BELONGS : PART_FOREIGN;
        if (rc == MT_E_SYSTEM && mt_file_absent(part)) { /* gone meanwhile */
            *state = PART_MISSING;
            rc = MT_OK;
        }
        rc = rc == MT_E_INPUT ? MT_OK : rc; /* a pipe, a folder: not what was written */
    }
    mt_file_free(&file);
    free(part);
    return rc;
}

static mt_status refuse_foreign_part(const char *path, const char *name, bool unfinished,
                                     mt_err *err)
{
    if (unfinished) {
        return mt_fail(err, MT_E_INPUT,
                       "%s: a run ended while it replaced the files of this folder, and \"%s\" "
                       "is not of this result: run the study again",
                       path, name);
    }
    return mt_fail(err, MT_E_INPUT,
                   "%s: \"%s\" beside it is not of this result: one of them was changed, or "
                   "comes from another run. Run the study again, or copy the %s that you trust "
                   "to where it stands alone",
                   path, name, RESULT);
}

/* The digest that the result names for a file; NULL. */
static const char *named_digest(const mt_result *r, const char *name)
{
    for (int i = 0; i < r->run.n_outputs; i++) {
        if (strcmp(r->run.outputs[i].file, name) == 0) {
            return r->run.outputs[i].sha256;
        }
    }
    return NULL;
}

bool mt_result_has_folder(const char *path, const mt_result *result)
{
    return result->run.n_outputs > 0 && strcmp(mt_text_base_name(path), RESULT) == 0;
}

mt_status mt_result_check_folder(const char *path, const char *sha256, const mt_result *result,
                                 mt_err *err)
{
    char *const folder = mt_file_folder(path);
    if (folder == NULL) {
        return mt_fail_memory(err);
    }
    const bool unfinished = mt_folder_unfinished(folder, RESULT);
    free(folder);
    part_state state = PART_MISSING;
    for (int i = 0; i < result->run.n_outputs; i++) {
        const char *const name = result->run.outputs[i].file;
        MT_TRY(check_part_file(path, name, result->run.outputs[i].sha256, &state, err));
        if (state == PART_FOREIGN || (state == PART_MISSING && unfinished)) {
            return refuse_foreign_part(path, name, unfinished, err);
        }
    }
    for (int i = 0; i < MT_RESULT_FILE_COUNT;
         i++) { /* also what a result without it stands by */
        const char *const name = mt_result_file_name((mt_result_file)i);
        if (i != MT_RESULT_FILE_RESULT && named_digest(result, name) == NULL) {
            MT_TRY(check_part_file(path, name, i == MT_RESULT_FILE_TIMING ? sha256 : "", &state,
                                   err));
            if (state == PART_FOREIGN) {
                return refuse_foreign_part(path, name, unfinished, err);
            }
        }
    }
    return MT_OK;
}
