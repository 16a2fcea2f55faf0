/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and writing for users of the library: the same as for the program. */
#include "modetune/model.h"
#include "modetune/study.h"

#include <stdlib.h>

#include "base/options.h"
#include "io/io.h"

/* What a study is called that comes as a text. */
static const char STUDY_PATH[] = "study.json";

/* Options of the library as those of the rooms; empties the diagnostics. */
static mt_status take(const mt_read_options *opt, mt_io_options *out, mt_err *err)
{
    for (int i = 0; i < opt->n_files; i++) {
        if (opt->files == NULL || opt->files[i].path == NULL || opt->files[i].text == NULL) {
            return mt_fail(err, MT_E_USAGE, "files[%d] of the options has no %s", i,
                           opt->files == NULL || opt->files[i].path == NULL ? "path" : "text");
        }
    }
    if (opt->n_files < 0) {
        return mt_fail(err, MT_E_USAGE, "n_files of the options is negative");
    }
    if (opt->diagnostics != NULL) {
        mt_diagnostics_free(opt->diagnostics);
    }
    *out = (mt_io_options){
        .root = opt->root,
        .files = {.given = opt->files, .n = opt->n_files, .only = opt->files_only != 0}};
    return MT_OK;
}

mt_status mt_model_read(const char *path, const mt_read_options *opt, mt_model **out,
                        mt_err *err)
{
    mt_read_options own;
    mt_io_options io = {.root = NULL};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(MT_OPTIONS_TAKE(opt, &own, err));
    MT_TRY(mt_err_in(err, take(&own, &io, err), "%s", __func__));
    return mt_model_load(path, &io, out, own.diagnostics, err);
}

mt_status mt_study_read(const char *path, const mt_read_options *opt, mt_study **out,
                        mt_err *err)
{
    mt_read_options own;
    mt_io_options io = {.root = NULL};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(MT_OPTIONS_TAKE(opt, &own, err));
    MT_TRY(mt_err_in(err, take(&own, &io, err), "%s", __func__));
    return mt_study_load(path, &io, out, own.diagnostics, err);
}

mt_status mt_result_json(const mt_result *result, char **text, mt_err *err)
{
    mt_text out = {0};
    MT_NOT_NULL(text, err);
    *text = NULL;
    MT_NOT_NULL(result, err);
    const mt_status rc = mt_result_write(result, &out, err);
    if (rc != MT_OK) {
        mt_text_free(&out);
        return rc;
    }
    *text = out.s; /* from malloc */
    return MT_OK;
}

void mt_string_delete(char *text)
{
    free(text);
}

/* The study's text among the files that are given, and these behind it; heap. */
static mt_file_text *with_study(const char *study, const mt_read_options *read, mt_err *err)
{
    const int n = read->n_files;
    mt_file_text *const files = malloc(((size_t)n + 1) * sizeof *files);
    if (files == NULL) {
        (void)mt_fail_memory(err);
        return NULL;
    }
    files[0] = (mt_file_text){.path = STUDY_PATH, .text = study};
    for (int i = 0; i < n; i++) {
        files[i + 1] = read->files[i];
    }
    return files;
}

mt_status mt_solve_json(const char *study, const mt_read_options *read,
                        const mt_solve_options *solve, char **result, mt_err *err)
{
    mt_read_options own;
    mt_io_options io = {.root = NULL};
    mt_study *asked = NULL;
    mt_result *answer = NULL;
    MT_NOT_NULL(result, err);
    *result = NULL;
    MT_NOT_NULL(study, err);
    MT_TRY(MT_OPTIONS_TAKE(read, &own, err));
    MT_TRY(mt_err_in(err, take(&own, &io, err), "%s", __func__));
    mt_file_text *const files = with_study(study, &own, err);
    if (files == NULL) {
        return MT_E_MEMORY;
    }
    io.files.given = files;
    io.files.n++;
    mt_status rc = mt_study_load(STUDY_PATH, &io, &asked, own.diagnostics, err);
    free(files);
    rc = rc == MT_OK ? mt_study_solve(asked, solve, &answer, err) : rc;
    rc = rc == MT_OK ? mt_result_json(answer, result, err) : rc;
    mt_result_delete(answer);
    mt_study_delete(asked);
    return rc;
}
