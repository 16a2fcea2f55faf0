/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A result names its model relative to the study's folder and holds its SHA-256, but no path of
 * this machine. So the model is looked for where it may be: from the study that timing.json
 * beside the result names, from the result's folder and those above it, from the current folder
 * and its "studies". Only the very bytes that were solved are taken; --model takes a file as it
 * is, with a warning where it has changed.
 */
#include "cli/find_model.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* The recorded hash of the model; NULL where the result has none. */
static const char *hash_of_model(const mt_result *result)
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
    const char *root;
    mt_file file;
    char *path; /* heap; NULL: not found yet */
    /* memory is out, or what may be it could not be read: the first such failure */
    mt_status failed;
    mt_err why;
} quest;

/* Read the model as meant by the file `naming`; found where it holds what was solved. */
static void try_from(quest *q, const char *naming)
{
    const char *const hash = hash_of_model(q->result);
    mt_err why = {.code = MT_OK};
    if (q->path != NULL || q->failed == MT_E_MEMORY) {
        return;
    }
    char *const path = naming == NULL ? NULL : mt_file_join(naming, q->result->model.file);
    const mt_status rc = path == NULL
                             ? mt_fail_memory(&why)
                             : mt_file_read(path, q->root, MT_JSON_MAX_BYTES, &q->file, &why);
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

static mt_status search(const char *result_path, quest *q, mt_err *err)
{
    static const char *const beside[] = {"x", "../x", "../../x", "../studies/x",
                                         "../../studies/x"};
    static const char *const here[] = {"x", "studies/x"};
    mt_text study = {.s = NULL};
    if (study_of(result_path, &study) == MT_E_MEMORY) {
        q->failed = mt_fail_memory(&q->why);
    } else if (study.s != NULL) {
        try_from(q, study.s);
    }
    mt_text_free(&study);
    for (int i = 0; i < MT_COUNT(beside); i++) {
        char *const naming = mt_file_join(result_path, beside[i]);
        try_from(q, naming);
        free(naming);
    }
    for (int i = 0; i < MT_COUNT(here); i++) {
        try_from(q, here[i]);
    }
    if (q->path != NULL) {
        return MT_OK;
    }
    if (q->failed != MT_OK) {
        return mt_fail(err, q->failed, "%s", q->why.text);
    }
    return mt_fail(
        err, MT_E_INPUT,
        "%s: the model \"%s\" is not found as it was when the study was solved: name "
        "it with --model",
        result_path, q->result->model.file);
}

mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err)
{
    const char *const given = args->value[MT_OPT_MODEL];
    const char *const root = args->value[MT_OPT_ROOT];
    if (given == NULL) {
        quest q = {.result = result, .root = root};
        const mt_status rc = search(args->operands[0], &q, err);
        *file = q.file;
        *path = q.path;
        return rc;
    }
    MT_TRY(mt_file_read(given, root, MT_JSON_MAX_BYTES, file, err));
    const char *const hash = hash_of_model(result);
    if (hash == NULL || strcmp(hash, file->sha256) != 0) {
        mt_terminal_warning("%s is not what was solved: it has changed since", given);
    }
    *path = mt_file_join("x", given);
    return *path == NULL ? mt_fail_memory(err) : MT_OK;
}
