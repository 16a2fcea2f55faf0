/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `run` leaves behind: a folder per study. */
/* realpath is in POSIX.1-2008, but the C library shows it only with X/Open: asked for before
 * any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "cli/save.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "cli/cli.h"
#include "io/file.h"
#include "io/folder.h"
#include "report/page.h"
#include "report/result_tables.h"
#include "report/ruler.h"
#include "report/summary.h"

static const char DEFAULT_FOLDER[] = "results";
const char *const mt_index_names[MT_INDEX_FILES] = {"index.html", "index.json"};

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

const char *mt_save_base(const mt_args *args)
{
    return args->given[MT_OPT_OUTPUT] ? args->value[MT_OPT_OUTPUT] : DEFAULT_FOLDER;
}

char *mt_save_folder(const mt_args *args, const char *study_path)
{
    const char *const name = mt_text_base_name(study_path);
    mt_text t = {.s = NULL};
    mt_text_add(&t, mt_save_base(args));
    mt_text_add(&t, "/");
    mt_text_add_n(&t, name, name_length(name));
    if (t.failed) {
        mt_text_free(&t);
    }
    return t.s;
}

/* True for names of folders: they cannot be studies, and their results would have no folder of
 * their own. */
static bool is_no_file(const char *path)
{
    const char *const name = mt_text_base_name(path);
    return name[0] == '\0' || strcmp(name, ".") == 0 || strcmp(name, "..") == 0;
}

/* Where the result of one study goes. */
typedef struct place {
    const char *study;
    int order; /* as given */
    char *folder;
    struct stat st;
    bool there;
} place;

/* By name, capital letters or not: file systems may not tell them apart, nor may the next one
 * that the results are copied to. */
static int by_name(const void *a, const void *b)
{
    const place *const x = a;
    const place *const y = b;
    const int order = strcasecmp(x->folder, y->folder);
    return order != 0 ? order : x->order - y->order;
}

/* Order by the existing folder first: links may lead to one folder. */
static int by_inode(const void *a, const void *b)
{
    const place *const x = a;
    const place *const y = b;
    const int there = (int)y->there - (int)x->there;
    const int device = (x->st.st_dev > y->st.st_dev) - (x->st.st_dev < y->st.st_dev);
    const int node = (x->st.st_ino > y->st.st_ino) - (x->st.st_ino < y->st.st_ino);
    return there != 0 ? there : device != 0 ? device : node != 0 ? node : x->order - y->order;
}

static bool is_same_folder(const place *a, const place *b)
{
    return strcasecmp(a->folder, b->folder) == 0 ||
           (a->there && b->there && a->st.st_dev == b->st.st_dev &&
            a->st.st_ino == b->st.st_ino);
}

static int clash(const place *a, const place *b)
{
    const place *const first = a->order < b->order ? a : b;
    const place *const second = first == a ? b : a;
    mt_terminal_error("%s and %s would both be written to \"%s\": run one of them separately, "
                      "with another -o",
                      first->study, second->study, second->folder);
    return MT_EXIT_INPUT;
}

/* Check that a result can be written there, beside an index where there are several. */
static int check_place(place *p, bool index)
{
    struct stat link;
    if (is_no_file(p->study)) {
        mt_terminal_error("\"%s\" is not the name of a file", p->study);
        return MT_EXIT_INPUT;
    }
    for (int i = 0; i < MT_INDEX_FILES && index; i++) {
        if (strcasecmp(mt_text_base_name(p->folder), mt_index_names[i]) == 0) {
            mt_terminal_error("%s would be written to \"%s\", which is the place of the index "
                              "of all studies: run it separately",
                              p->study, p->folder);
            return MT_EXIT_INPUT;
        }
    }
    p->there = stat(p->folder, &p->st) == 0;
    if (!p->there && lstat(p->folder, &link) == 0 && S_ISLNK(link.st_mode)) {
        mt_terminal_error("%s would be written to \"%s\", a link that leads nowhere", p->study,
                          p->folder);
        return MT_EXIT_INPUT;
    }
    return MT_EXIT_DONE;
}

/* Check that no two studies have the same folder: each would silently replace the one
 * before. */
static int check_places(place *places, int n)
{
    int code = MT_EXIT_DONE;
    for (int i = 0; i < n; i++) {
        code = mt_exit_worse(code, check_place(&places[i], n > 1));
    }
    int (*const orders[])(const void *, const void *) = {by_name, by_inode};
    for (int k = 0; k < MT_COUNT(orders) && code == MT_EXIT_DONE; k++) {
        qsort(places, (size_t)n, sizeof *places, orders[k]);
        for (int i = 1; i < n; i++) {
            if (is_same_folder(&places[i - 1], &places[i])) {
                code = clash(&places[i - 1], &places[i]);
            }
        }
    }
    return code;
}

int mt_save_plan(const mt_args *args)
{
    const int n = args->n_operands;
    place *const places = calloc((size_t)n, sizeof *places);
    bool whole = places != NULL;
    for (int i = 0; i < n && whole; i++) {
        places[i].study = args->operands[i];
        places[i].order = i;
        places[i].folder = mt_save_folder(args, args->operands[i]);
        whole = places[i].folder != NULL;
    }
    int code = MT_EXIT_SYSTEM;
    if (whole) {
        code = check_places(places, n);
    } else {
        mt_terminal_error("out of memory");
    }
    for (int i = 0; i < n && places != NULL; i++) {
        free(places[i].folder);
    }
    free(places);
    return code;
}

/* A result on its way into its folder. */
typedef struct saving {
    const char *study_path; /* or file name: names the folder */
    const char *scene;      /* NULL: none */
    char *folder;
    mt_text texts[MT_RESULT_FILE_COUNT];
    mt_text json; /* of the page */
    char sha256[MT_SHA256_TEXT];
    mt_err err;
} saving;

/* Write timing.json, with the values that may differ between runs of one result. It names the
 * result; result.json does not name it. */
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

/* The page, and the JSON that it holds. */
static void write_page(const mt_result *result, const char *scene, mt_text *json, mt_text *out)
{
    if (mt_result_write_page(result, json, NULL) == MT_OK) {
        mt_report_html(result, json->s, scene, out);
    } else {
        out->failed = true;
    }
}

/* The tables; empty where the result has none of the kind. */
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
    case MT_RESULT_FILE_CURVES:
        if (result->n_curves > 0) {
            table = mt_report_curves(result);
            mt_table_csv(&table, out);
            mt_table_free(&table);
        }
        break;
    case MT_RESULT_FILE_REPORT:
    case MT_RESULT_FILE_TIMING:
    case MT_RESULT_FILE_RESULT:
    case MT_RESULT_FILE_COUNT:
        break;
    }
}

void mt_save_print(const mt_args *args, const mt_result *result, const char *scene,
                   mt_json_writer *w, mt_text *out)
{
    mt_text json = {.s = NULL};
    switch (args->format) {
    case MT_FORMAT_JSON:
        mt_result_put(w, NULL, result);
        break;
    case MT_FORMAT_CSV:
        write_output(result, MT_RESULT_FILE_DESIGNS, out);
        break;
    case MT_FORMAT_HTML:
        write_page(result, scene, &json, out);
        break;
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        mt_report_summary(result, args->given[MT_OPT_VERIFY], mt_terminal_width(), out);
        mt_text_add(out, "\n");
        break;
    }
    mt_text_free(&json);
}

/* The files that result.json names, and itself with its digest. */
static mt_status write_texts(const mt_args *args, mt_result *result, saving *s)
{
    const char *names[MT_RESULT_FILE_COUNT] = {NULL};
    char sha256[MT_RESULT_FILE_COUNT][MT_SHA256_TEXT];
    int n = 0;
    for (int i = 0; i < MT_RESULT_FILE_TIMING; i++) {
        const mt_result_file which = (mt_result_file)i;
        if (which != MT_RESULT_FILE_REPORT) {
            write_output(result, which, &s->texts[i]);
        } else if (!args->no_report) {
            write_page(result, s->scene, &s->json, &s->texts[i]);
        }
        MT_TRY(s->texts[i].failed ? mt_fail_memory(&s->err) : MT_OK);
        const mt_text *const made = &s->texts[i];
        if (made->s != NULL) {
            mt_page_sha256(made->s, made->length, sha256[n]);
            names[n++] = mt_result_file_name(which);
        }
    }
    MT_TRY(mt_result_note_outputs(result, n, names, sha256, &s->err));
    mt_text *const text = &s->texts[MT_RESULT_FILE_RESULT];
    MT_TRY(mt_result_write_after_page(result, &s->json, text, &s->err));
    mt_text_free(&s->json);
    mt_sha256(text->s, text->length, s->sha256);
    return MT_OK;
}

static mt_status write_folder_texts(const mt_args *args, mt_result *result, saving *s)
{
    s->folder = mt_save_folder(args, s->study_path);
    return s->folder == NULL ? mt_fail_memory(&s->err) : write_texts(args, result, s);
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
    mt_text_free(&s->json);
    free(s->folder);
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &s->err);
}

int mt_save(const mt_args *args, const char *study_path, mt_result *result, const char *scene,
            double seconds, char sha256[MT_SHA256_TEXT])
{
    saving s = {.study_path = study_path, .scene = scene};
    mt_text told = {.s = NULL};
    mt_status rc = write_folder_texts(args, result, &s);
    rc = rc == MT_OK ? write_timing(args, result, seconds, &s) : rc;
    mt_text_addf(&told, "%s: %.3g s, ", study_path, seconds);
    mt_report_work_counters(&result->run, &told);
    rc = rc == MT_OK && told.failed ? mt_fail_memory(&s.err) : rc;
    const int code = end(args, rc, told.s, &s);
    memcpy(sha256, code == MT_EXIT_DONE ? s.sha256 : "",
           code == MT_EXIT_DONE ? MT_SHA256_TEXT : 1);
    mt_text_free(&told);
    return code;
}

int mt_save_again(const mt_args *args, const char *result_path, mt_result *result,
                  const char *scene)
{
    saving s = {.study_path = result->study.file, .scene = scene};
    if (is_no_file(s.study_path)) {
        mt_terminal_error("%s: /study/file: \"%s\" is not the name of a file", result_path,
                          s.study_path);
        return MT_EXIT_INPUT;
    }
    mt_status rc = write_folder_texts(args, result, &s);
    if (rc == MT_OK) {
        rc = mt_result_read_timing(result_path, s.sha256, &s.texts[MT_RESULT_FILE_TIMING],
                                   &s.err);
    }
    return end(args, rc, result_path, &s);
}
