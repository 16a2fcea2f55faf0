/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `run` leaves behind: a folder per study. */
/* realpath is in POSIX.1-2008, but the C library shows it only with X/Open: asked for before
 * any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "cli/save.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/cli.h"
#include "io/file.h"
#include "io/folder.h"
#include "report/html.h"
#include "report/result_tables.h"
#include "report/summary.h"
#include "report/trade.h"

static const char DEFAULT_FOLDER[] = "results";

/* How much of the file name names the folder: all but ".json", unless that would leave no name,
 * or one that leads out of the folder for results. */
static size_t name_length(const char *name)
{
    const size_t length = strlen(name);
    const size_t suffix = strlen(".json");
    if (length <= suffix || strcmp(name + length - suffix, ".json") != 0) {
        return length;
    }
    const size_t left = length - suffix;
    const bool dots = strspn(name, ".") >= left && left <= 2;
    return dots ? length : left;
}

/* Where the result of a study goes; heap, NULL when out of memory. */
static char *folder_of(const mt_args *args, const char *study_path)
{
    const char *const base =
        args->given[MT_OPT_OUTPUT] ? args->value[MT_OPT_OUTPUT] : DEFAULT_FOLDER;
    const char *const name = mt_text_base_name(study_path);
    mt_text t = {.s = NULL};
    mt_text_add(&t, base);
    mt_text_add(&t, "/");
    mt_text_add_n(&t, name, name_length(name));
    if (t.failed) {
        mt_text_free(&t);
    }
    return t.s;
}

static bool is_same_folder(const char *a, const char *b)
{
    struct stat x;
    struct stat y;
    return strcmp(a, b) == 0 || (stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev &&
                                 x.st_ino == y.st_ino);
}

/* Names of folders, not files: they cannot be studies, and their results would have no folder
 * of their own. */
static bool is_no_file(const char *path)
{
    const char *const name = mt_text_base_name(path);
    return name[0] == '\0' || strcmp(name, ".") == 0 || strcmp(name, "..") == 0;
}

/* Of each pair of studies with one folder the second would silently replace the first. */
static bool is_taken(const mt_args *args, char *const *folders, int i)
{
    bool taken = false;
    for (int k = 0; k < i; k++) {
        if (is_same_folder(folders[k], folders[i])) {
            mt_terminal_error("%s and %s would both be written to \"%s\": run one of them "
                              "apart, with another -o",
                              args->operands[k], args->operands[i], folders[i]);
            taken = true;
        }
    }
    return taken;
}

int mt_save_plan(const mt_args *args)
{
    int code = MT_EXIT_DONE;
    char **const folders = calloc((size_t)args->n_operands, sizeof *folders);
    for (int i = 0; folders != NULL && i < args->n_operands; i++) {
        const char *const path = args->operands[i];
        folders[i] = folder_of(args, path);
        if (folders[i] == NULL) {
            code = MT_EXIT_SYSTEM;
            break;
        }
        if (is_no_file(path)) {
            mt_terminal_error("\"%s\" is not the name of a file", path);
            code = MT_EXIT_INPUT;
        }
        code = is_taken(args, folders, i) ? MT_EXIT_INPUT : code;
    }
    for (int i = 0; folders != NULL && i < args->n_operands; i++) {
        free(folders[i]);
    }
    if (folders == NULL || code == MT_EXIT_SYSTEM) {
        mt_terminal_error("out of memory");
        code = MT_EXIT_SYSTEM;
    }
    free(folders);
    return code;
}

/* A result on its way into its folder. */
typedef struct saving {
    const char *study_path; /* or file name: names the folder */
    char *folder;
    mt_text texts[MT_RESULT_FILE_COUNT];
    char sha256[MT_SHA256_TEXT];
    mt_err err;
} saving;

/* What may differ between runs of one result, which it names: result.json does not name it. */
static mt_status write_timing(const mt_args *args, const mt_result *result, double seconds,
                              saving *s)
{
    mt_json_writer w = mt_json_writer_default(&s->texts[MT_RESULT_FILE_TIMING]);
    char *const absolute = realpath(s->study_path, NULL);
    if (absolute == NULL && errno == ENOMEM) {
        return mt_fail_memory(&s->err);
    }
    mt_json_open(&w, NULL, '{');
    mt_json_put_string(&w, "format", "modetune-timing/1");
    mt_json_put_string(&w, "study_path", absolute);
    mt_json_put_string(&w, "result_sha256", s->sha256);
    mt_json_put_number(&w, "solve_s", seconds);
    mt_json_put_integer(&w, "evaluations", result->run.evaluations);
    mt_json_put_integer(&w, "threads", args->threads);
    mt_json_close(&w);
    free(absolute);
    return mt_json_done(&w) ? MT_OK : mt_fail_memory(&s->err);
}

/* The tables and the page; empty where the result has none of the kind. */
static void write_output(const mt_result *result, mt_result_file which, mt_text *out)
{
    mt_table table = {0};
    switch (which) {
    case MT_RESULT_FILE_DESIGNS:
        table = mt_report_designs(result);
        mt_table_csv(&table, out);
        mt_table_free(&table);
        break;
    case MT_RESULT_FILE_TRADE:
        if (result->trade != NULL) {
            table = mt_report_trade(result);
            mt_table_csv(&table, out);
            mt_table_free(&table);
        }
        break;
    case MT_RESULT_FILE_REPORT:
        mt_report_html(result, out);
        break;
    case MT_RESULT_FILE_TIMING:
    case MT_RESULT_FILE_RESULT:
    case MT_RESULT_FILE_COUNT:
        break;
    }
}

void mt_save_print(const mt_args *args, const mt_result *result, mt_json_writer *w,
                   mt_text *out)
{
    switch (args->format) {
    case MT_FORMAT_JSON:
        mt_result_put(w, NULL, result);
        break;
    case MT_FORMAT_CSV:
        write_output(result, MT_RESULT_FILE_DESIGNS, out);
        break;
    case MT_FORMAT_HTML:
        write_output(result, MT_RESULT_FILE_REPORT, out);
        break;
    case MT_FORMAT_TEXT:
        mt_report_summary(result, args->given[MT_OPT_VERIFY], out);
        mt_text_add(out, "\n");
        break;
    }
}

/* The files that result.json names, and itself with its digest. */
static mt_status write_texts(mt_result *result, saving *s)
{
    const char *names[MT_RESULT_FILE_COUNT] = {NULL};
    mt_text outputs[MT_RESULT_FILE_COUNT];
    int n = 0;
    for (int i = 0; i < MT_RESULT_FILE_TIMING; i++) {
        const mt_result_file which = (mt_result_file)i;
        write_output(result, which, &s->texts[i]);
        MT_TRY(s->texts[i].failed ? mt_fail_memory(&s->err) : MT_OK);
        if (s->texts[i].s != NULL) {
            names[n] = mt_result_file_name(which);
            outputs[n++] = s->texts[i];
        }
    }
    MT_TRY(mt_result_note_outputs(result, n, names, outputs, &s->err));
    mt_text *const text = &s->texts[MT_RESULT_FILE_RESULT];
    MT_TRY(mt_result_write(result, text, &s->err));
    mt_sha256(text->s, text->length, s->sha256);
    return MT_OK;
}

static mt_status begin(const mt_args *args, mt_result *result, saving *s)
{
    s->folder = folder_of(args, s->study_path);
    return s->folder == NULL ? mt_fail_memory(&s->err) : write_texts(result, s);
}

static int end(const mt_args *args, mt_status rc, const char *told, saving *s)
{
    if (rc == MT_OK) {
        mt_folder_file files[MT_RESULT_FILE_COUNT];
        for (int i = 0; i < MT_RESULT_FILE_COUNT; i++) {
            files[i] = (mt_folder_file){mt_result_file_name((mt_result_file)i), s->texts[i].s,
                                        s->texts[i].length};
        }
        rc = mt_folder_replace(s->folder, files, MT_RESULT_FILE_COUNT, &s->err);
    }
    if (rc == MT_OK) {
        mt_terminal_talk(args->given[MT_OPT_QUIET], "%s; written to %s/", told, s->folder);
    }
    for (int i = 0; i < MT_RESULT_FILE_COUNT; i++) {
        mt_text_free(&s->texts[i]);
    }
    free(s->folder);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &s->err);
}

int mt_save(const mt_args *args, const char *study_path, mt_result *result, double seconds)
{
    saving s = {.study_path = study_path};
    mt_text told = {.s = NULL};
    mt_status rc = begin(args, result, &s);
    rc = rc == MT_OK ? write_timing(args, result, seconds, &s) : rc;
    mt_text_addf(&told, "%s: %.3g s, %ld evaluations", study_path, seconds,
                 result->run.evaluations);
    rc = rc == MT_OK && told.failed ? mt_fail_memory(&s.err) : rc;
    const int code = end(args, rc, told.s, &s);
    mt_text_free(&told);
    return code;
}

int mt_save_again(const mt_args *args, const char *result_path, mt_result *result)
{
    saving s = {.study_path = result->study.file};
    if (is_no_file(s.study_path)) {
        mt_terminal_error("%s: /study/file: \"%s\" is not the name of a file", result_path,
                          s.study_path);
        return MT_EXIT_INPUT;
    }
    mt_status rc = begin(args, result, &s);
    if (rc == MT_OK) {
        rc = mt_result_read_timing(result_path, s.sha256, &s.texts[MT_RESULT_FILE_TIMING],
                                   &s.err);
    }
    return end(args, rc, result_path, &s);
}
