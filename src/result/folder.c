/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a result: what stands beside a result.json, and the model it was solved from. */
#include "result/folder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/arena.h"
#include "base/text.h"
#include "io/json.h"

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
        mt_text_add(&t, mt_result_file_name(MT_RESULT_FILE_RESULT));
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

/*
 * A result names its model relative to the study's folder and holds its SHA-256, but no path of
 * this machine. So the model is looked for where it may be: from the study that timing.json
 * beside the result names, from the result's folder and those above it, from the current folder
 * and its "studies", each with the rules for files that a study there has. Only the very bytes
 * that were solved are taken.
 */
const char *mt_result_model_sha256(const mt_result *result)
{
    for (int i = 0; i < result->run.n_inputs; i++) {
        if (strcmp(result->run.inputs[i].file, result->model.file) == 0) {
            return result->run.inputs[i].sha256;
        }
    }
    return NULL;
}

/* A search for the model: `file` and `path` once it is found. */
typedef struct quest {
    const mt_result *result;
    const char *root; /* NULL: of each place that of a study there */
    mt_file file;
    char *path; /* heap; NULL: not found yet */
    /* memory is out, or what may be it could not be read: the first such failure */
    mt_status failed;
    mt_err why;
} quest;

/* Read the model at its path relative to the file `naming`; found where its bytes are those
 * that were solved. */
static void try_from(quest *q, const char *naming)
{
    const char *const hash = mt_result_model_sha256(q->result);
    mt_err why = {.code = MT_OK};
    if (q->path != NULL || q->failed == MT_E_MEMORY) {
        return;
    }
    char *const path = naming == NULL ? NULL : mt_file_join(naming, q->result->model.file);
    char *const own = naming == NULL || q->root != NULL ? NULL : mt_file_default_root(naming);
    const char *const root = q->root != NULL ? q->root : own;
    const mt_status rc = path == NULL || root == NULL
                             ? mt_fail_memory(&why)
                             : mt_file_read(path, root, MT_JSON_MAX_BYTES, &q->file, &why);
    free(own);
    if (rc == MT_OK && hash != NULL && strcmp(q->file.sha256, hash) == 0) {
        q->path = path;
        return;
    }
    if (rc == MT_E_MEMORY ||
        (rc == MT_E_SYSTEM && q->failed == MT_OK && !mt_file_absent(path))) {
        q->failed = rc;
        q->why = why;
    }
    mt_file_free(&q->file);
    free(path);
}

/* The study's path that `run` left in timing.json beside the result; empty where there is none.
 * Fails: MT_E_MEMORY. */
static mt_status study_of(const char *result_path, mt_text *study)
{
    char *const path = mt_file_join(result_path, "timing.json");
    mt_file file = {.bytes = NULL};
    mt_json *doc = NULL;
    mt_status rc =
        path == NULL ? MT_E_MEMORY : mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &file, NULL);
    rc = rc == MT_OK ? mt_json_parse(file.bytes, file.length, &doc, NULL) : rc;
    if (rc == MT_OK) {
        const mt_addr member = mt_json_member(doc, MT_JSON_ROOT, "study_path");
        if (member != MT_NO_ADDR && mt_json_type_of(doc, member) == MT_JSON_STRING) {
            mt_text_add(study, mt_json_string(doc, member));
        }
    }
    mt_json_delete(doc);
    mt_file_free(&file);
    free(path);
    return rc == MT_E_MEMORY || study->failed ? MT_E_MEMORY : MT_OK;
}

mt_status mt_result_find_model(const char *result_path, const mt_result *result,
                               const char *root, mt_file *file, char **path, mt_err *err)
{
    static const char *const beside[] = {"x", "../x", "../../x", "../studies/x",
                                         "../../studies/x"};
    static const char *const here[] = {"x", "studies/x"};
    quest q = {.result = result, .root = root};
    mt_text study = {.s = NULL};
    *file = (mt_file){.bytes = NULL};
    *path = NULL;
    if (study_of(result_path, &study) == MT_E_MEMORY) {
        q.failed = mt_fail_memory(&q.why);
    } else if (study.s != NULL) {
        try_from(&q, study.s);
    }
    mt_text_free(&study);
    for (int i = 0; i < MT_COUNT(beside); i++) {
        char *const naming = mt_file_join(result_path, beside[i]);
        try_from(&q, naming);
        free(naming);
    }
    for (int i = 0; i < MT_COUNT(here); i++) {
        try_from(&q, here[i]);
    }
    if (q.path != NULL) {
        *file = q.file;
        *path = q.path;
        return MT_OK;
    }
    if (q.failed != MT_OK) {
        return mt_fail(err, q.failed, "%s", q.why.text);
    }
    return mt_fail(err, MT_E_INPUT,
                   "%s: the model \"%s\" is not found as it was when the study was solved: "
                   "name it with --model, or with --root a folder that it lies in",
                   result_path, result->model.file);
}
