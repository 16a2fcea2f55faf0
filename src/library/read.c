/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and writing for users of the library: the same as for the program. */
#include "model/read.h"

#include "modetune/model.h"
#include "modetune/profile.h"
#include "modetune/study.h"

#include <math.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/base.h"
#include "environment/vibration.h"
#include "io/options.h"
#include "library/scene_designs.h"
#include "report/page.h"
#include "result/folder.h"
#include "result/read.h"
#include "result/write.h"
#include "study/read.h"

/* What a study is called that comes as a text. */
static const char STUDY_PATH[] = "study.json";

/* What a caller asks for, as the rooms take it: io has the address of asked. */
typedef struct request {
    mt_read_options own;
    mt_io_options io;
    mt_overrides asked;
} request;

static mt_status check_files(const mt_read_options *opt, mt_err *err)
{
    for (int i = 0; i < opt->n_files; i++) {
        if (opt->files == NULL || opt->files[i].path == NULL || opt->files[i].text == NULL) {
            return mt_fail(err, MT_E_USAGE, "files[%d] of the options has no %s", i,
                           opt->files == NULL || opt->files[i].path == NULL ? "path" : "text");
        }
    }
    return opt->n_files < 0 ? mt_fail(err, MT_E_USAGE, "n_files of the options is negative")
                            : MT_OK;
}

static mt_status check_asked(const mt_read_options *opt, mt_err *err)
{
    for (int i = 0; i < opt->n_sets; i++) {
        if (opt->sets == NULL || opt->sets[i] == NULL) {
            return mt_fail(err, MT_E_USAGE, "sets[%d] of the options is NULL", i);
        }
    }
    if (opt->n_sets < 0) {
        return mt_fail(err, MT_E_USAGE, "n_sets of the options is negative");
    }
    return opt->seed != NULL && *opt->seed < 0
               ? mt_fail(err, MT_E_USAGE, "the seed of the options is negative")
               : MT_OK;
}

/* Convert the options of the library to internal ones; empties the diagnostics. */
static mt_status take_read_options(const char *function, const mt_read_options *opt,
                                   request *out, mt_err *err)
{
    mt_read_options *const own = &out->own;
    MT_TRY(mt_options_take(function, opt, sizeof *own, own, err));
    MT_TRY(mt_err_in(err, check_files(own, err), "%s", function));
    MT_TRY(mt_err_in(err, check_asked(own, err), "%s", function));
    if (own->diagnostics != NULL) {
        mt_diagnostics_free(own->diagnostics);
    }
    out->asked = (mt_overrides){.n_sets = own->n_sets,
                                .sets = own->sets,
                                .seed = own->seed == NULL ? -1 : *own->seed,
                                .proof_s = nan("")};
    out->io = (mt_io_options){
        .root = own->root,
        .files = {.given = own->files, .n = own->n_files, .only = own->files_only != 0},
        .asked = &out->asked};
    return MT_OK;
}

mt_status mt_model_read(const char *path, const mt_read_options *opt, mt_model **out,
                        mt_err *err)
{
    request asked;
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(take_read_options(__func__, opt, &asked, err));
    return mt_model_load(path, &asked.io, out, asked.own.diagnostics, err);
}

mt_status mt_vibration_read(const char *path, const mt_read_options *opt, mt_vibration **out,
                            mt_err *err)
{
    request asked;
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(take_read_options(__func__, opt, &asked, err));
    return mt_vibration_load(path, &asked.io, out, asked.own.diagnostics, err);
}

mt_status mt_study_read(const char *path, const mt_read_options *opt, mt_study **out,
                        mt_err *err)
{
    request asked;
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(take_read_options(__func__, opt, &asked, err));
    return mt_study_load(path, &asked.io, out, asked.own.diagnostics, err);
}

mt_status mt_result_read(const char *path, const mt_read_options *opt, mt_result **out,
                         mt_err *err)
{
    request asked;
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(path, err);
    MT_TRY(take_read_options(__func__, opt, &asked, err));
    return mt_result_load(path, &asked.io, out, asked.own.diagnostics, err);
}

mt_status mt_result_model(const mt_result *result, const char *path, const mt_read_options *opt,
                          mt_model **out, mt_err *err)
{
    request asked;
    mt_file file;
    char *found = NULL;
    mt_err why = {.code = MT_OK};
    MT_NOT_NULL(out, err);
    *out = NULL;
    MT_NOT_NULL(result, err);
    MT_NOT_NULL(path, err);
    MT_TRY(take_read_options(__func__, opt, &asked, err));
    mt_status rc = mt_result_find_model(path, result, asked.own.root, &file, &found, &why);
    if (rc == MT_OK) {
        rc = mt_model_load(found, &asked.io, out, asked.own.diagnostics, &why);
    }
    mt_file_free(&file);
    free(found);
    /* not found, or what was solved then is no model today: there is none */
    return rc == MT_OK || rc == MT_E_INPUT ? MT_OK : mt_fail(err, rc, "%s", why.text);
}

mt_status mt_result_html(const mt_result *result, char **text, mt_err *err)
{
    MT_NOT_NULL(text, err);
    *text = NULL;
    MT_NOT_NULL(result, err);
    return mt_result_page(result, NULL, text, err);
}

mt_status mt_result_page(const mt_result *result, const mt_model *model, char **text,
                         mt_err *err)
{
    mt_text out = {0};
    MT_NOT_NULL(text, err);
    *text = NULL;
    MT_NOT_NULL(result, err);
    mt_text json = {0};
    mt_text scene = {0};
    mt_status rc = mt_result_write_page(result, &json, err);
    rc = rc == MT_OK ? mt_scene_of_result(model, result, 1, &scene, err) : rc;
    if (rc == MT_OK) {
        mt_report_html(result, json.s, scene.s, &out);
        rc = out.failed ? mt_fail_memory(err) : MT_OK;
    }
    mt_text_free(&json);
    mt_text_free(&scene);
    if (rc != MT_OK) {
        mt_text_free(&out);
        return rc;
    }
    *text = out.s; /* from malloc */
    return MT_OK;
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

/* The list of given files with the study's text in front; heap. */
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
    request asked;
    mt_study *question = NULL;
    mt_result *answer = NULL;
    MT_NOT_NULL(result, err);
    *result = NULL;
    MT_NOT_NULL(study, err);
    MT_TRY(take_read_options(__func__, read, &asked, err));
    mt_file_text *const files = with_study(study, &asked.own, err);
    if (files == NULL) {
        return MT_E_MEMORY;
    }
    asked.io.files.given = files;
    asked.io.files.n++;
    mt_status rc = mt_study_load(STUDY_PATH, &asked.io, &question, asked.own.diagnostics, err);
    free(files);
    rc = rc == MT_OK ? mt_study_solve(question, solve, &answer, err) : rc;
    rc = rc == MT_OK ? mt_result_json(answer, result, err) : rc;
    mt_result_delete(answer);
    mt_study_delete(question);
    return rc;
}

/* A request to stop as an int of the caller. */

int mt_stop_request_at(void *stop)
{
    /* the int of a caller who sees to it, or whose language does, that it is written at once */
    return stop == NULL ? MT_STOP_REQUEST_NONE : atomic_load((atomic_int *)stop);
}
