/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune run, merge and compare: answer studies, write what was found, judge published
 * values; and report, which writes a result again. */
/* realpath is in POSIX.1-2008, but the C library shows it only with X/Open: asked for before
 * any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "cli/cmd_run.h"

#include "modetune/version.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "answer/solve.h"
#include "base/sha256.h"
#include "cli/args.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "describe/describe.h"
#include "io/file.h"
#include "io/folder.h"
#include "io/journal.h"
#include "library/scene_designs.h"
#include "linalg/dense.h"
#include "report/design.h"
#include "report/page.h"
#include "report/summary.h"
#include "result/result.h"
#include "result/write.h"
#include "study/study.h"

/* The files of the index of several studies, the last one decisive. */
enum { INDEX_FILES = 2 };

/* What a run leaves behind: a folder per study. */

static const char DEFAULT_FOLDER[] = "results";
static const char *const index_names[INDEX_FILES] = {"index.html", "index.json"};

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

/* The folder for the results of all studies, and the folder for the result of one (heap, NULL
 * when out of memory). */
static const char *save_base(const mt_args *args)
{
    return args->given[MT_OPT_OUTPUT] ? args->value[MT_OPT_OUTPUT] : DEFAULT_FOLDER;
}

static char *save_folder(const mt_args *args, const char *study_path)
{
    const char *const name = mt_text_base_name(study_path);
    mt_text t = {.s = NULL};
    mt_text_add(&t, save_base(args));
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
typedef struct put_in_place {
    const char *study;
    int order; /* as given */
    char *folder;
    struct stat st;
    bool there;
} put_in_place;

/* By name, capital letters or not: file systems may not tell them apart, nor may the next one
 * that the results are copied to. */
static int by_name(const void *a, const void *b)
{
    const put_in_place *const x = a;
    const put_in_place *const y = b;
    const int order = strcasecmp(x->folder, y->folder);
    return order != 0 ? order : x->order - y->order;
}

/* Order by the existing folder first: links may lead to one folder. */
static int by_inode(const void *a, const void *b)
{
    const put_in_place *const x = a;
    const put_in_place *const y = b;
    const int there = (int)y->there - (int)x->there;
    const int device = (x->st.st_dev > y->st.st_dev) - (x->st.st_dev < y->st.st_dev);
    const int node = (x->st.st_ino > y->st.st_ino) - (x->st.st_ino < y->st.st_ino);
    return there != 0 ? there : device != 0 ? device : node != 0 ? node : x->order - y->order;
}

static bool is_same_folder(const put_in_place *a, const put_in_place *b)
{
    return strcasecmp(a->folder, b->folder) == 0 ||
           (a->there && b->there && a->st.st_dev == b->st.st_dev &&
            a->st.st_ino == b->st.st_ino);
}

static int clash(const put_in_place *a, const put_in_place *b)
{
    const put_in_place *const first = a->order < b->order ? a : b;
    const put_in_place *const second = first == a ? b : a;
    mt_terminal_error("%s and %s would both be written to \"%s\": run one of them separately, "
                      "with another -o",
                      first->study, second->study, second->folder);
    return MT_EXIT_INPUT;
}

/* Check that a result can be written there, beside an index where there are several. */
static int check_place(put_in_place *p, bool index)
{
    struct stat link;
    if (is_no_file(p->study)) {
        mt_terminal_error("\"%s\" is not the name of a file", p->study);
        return MT_EXIT_INPUT;
    }
    for (int i = 0; i < INDEX_FILES && index; i++) {
        if (strcasecmp(mt_text_base_name(p->folder), index_names[i]) == 0) {
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
static int check_places(put_in_place *places, int n)
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

/* Check, before anything is run, that every study has its own folder. Returns MT_EXIT_DONE, or
 * the exit status, with all messages given. */
static int save_plan(const mt_args *args)
{
    const int n = args->n_operands;
    put_in_place *const places = calloc((size_t)n, sizeof *places);
    bool whole = places != NULL;
    for (int i = 0; i < n && whole; i++) {
        places[i].study = args->operands[i];
        places[i].order = i;
        places[i].folder = save_folder(args, args->operands[i]);
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

/* Append the standard output: summary (with published values for --verify), table, page, or, as
 * a value of w, the result. */
static void save_print(const mt_args *args, const mt_result *result, const char *scene,
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
    s->folder = save_folder(args, s->study_path);
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

/* Write all files of a result into its folder atomically, and record them in result->run.
 * Returns the exit status, with all messages given. scene: of its mechanism, as JSON for the
 * report; NULL: none. sha256: of result.json, "" where it was not written. */
static int save(const mt_args *args, const char *study_path, mt_result *result,
                const char *scene, double seconds, char sha256[MT_SHA256_TEXT])
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

/* save for a result that was read; timing.json is kept where the one next to result_path
 * names the written result. */
static int save_again(const mt_args *args, const char *result_path, mt_result *result,
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

/* The commands. */

/*
 * Several studies run together: the outcome of each, as a table at the end and as index.json
 * and index.html in the folder of their results. The index is replaced after every study,
 * unless that takes more than a small part of the time. In the index of a killed run, studies
 * not yet recorded are "not run".
 */
typedef struct study_batch {
    const mt_args *args;
    mt_arena mem;
    mt_index_study *studies; /* [n_operands] */
    double written_s;        /* time of writing the index, and the duration of writing */
    double cost_s;
} study_batch;

/* The end of running one study. */
typedef struct batch_end {
    const mt_result *result; /* NULL: none */
    const char *sha256;      /* of result.json; "": not written */
    const char *message;     /* reason for no result; "": unknown */
    int exit_status;
    double seconds;
} batch_end;

/*
 * The journal of one study's run, for --resume, --shard and merge. All functions return an exit
 * status, with all messages given.
 */

/* The identity of a run, known before anything is computed: program, libraries, files and
 * settings, and the properties of processors that affect arithmetic. Runs with the same
 * identity give the same record of every task. */
static mt_status identity_of(const mt_study *study, mt_text *out, mt_err *err)
{
    mt_result *result = NULL;
    MT_TRY(mt_result_new(&result, err));
    mt_status rc = mt_describe_run(study, result, err);
    if (rc == MT_OK) {
        char digits[MT_ARITHMETIC_TEXT];
        mt_json_writer w = mt_json_writer_default(out);
        mt_json_open(&w, NULL, '{');
        mt_result_put_member(&w, "run", result);
        mt_arithmetic_digest(digits);
        mt_json_put_string(&w, "arithmetic", digits);
        mt_json_close(&w);
        rc = mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
    }
    mt_result_delete(result);
    return rc;
}

/* Path of the journal: next to the folder of the result; a part has its own. Heap, NULL when
 * out of memory. */
static char *journal_of(const mt_args *args, const char *study_path)
{
    mt_text t = {.s = NULL};
    char *const folder = save_folder(args, study_path);
    if (folder == NULL) {
        return NULL;
    }
    mt_text_add(&t, folder);
    if (args->part > 0) {
        mt_text_addf(&t, ".%d-of-%d", args->part, args->parts);
    }
    mt_text_add(&t, ".journal");
    free(folder);
    if (t.failed) {
        mt_text_free(&t);
    }
    return t.s;
}

/* Report the state of the path of this run's journal. Fails: MT_E_SYSTEM, for a part, whose
 * only output is its journal. */
static mt_status write_place(const mt_args *args, const char *study_path, const char *path,
                             mt_journal *j, mt_journal_place place, mt_err *err)
{
    const bool quiet = args->given[MT_OPT_QUIET];
    const bool part = args->part > 0;
    switch (place) {
    case MT_JOURNAL_NEW:
        if (args->given[MT_OPT_RESUME]) {
            mt_terminal_talk(quiet, "%s: there is no %s to resume, so everything is computed",
                             study_path, path);
        }
        break;
    case MT_JOURNAL_KEPT:
        mt_terminal_talk(
            quiet,
            "%s: a journal was left there, of a run that was not finished or of a "
            "part: it is kept as %s" MT_JOURNAL_OLD
            "; --resume would have gone on from it, and `modetune merge %s %s" MT_JOURNAL_OLD
            "` does",
            study_path, path, study_path, path);
        break;
    case MT_JOURNAL_HELD:
        if (part) {
            return mt_fail(err, MT_E_SYSTEM, "%s: another run is writing it", path);
        }
        mt_terminal_talk(quiet, "%s: another run is writing %s: this one keeps no journal",
                         study_path, path);
        break;
    case MT_JOURNAL_FAILED:
        return part ? mt_journal_end(j, false, err) : MT_OK;
    case MT_JOURNAL_CONTINUED:
        break;
    }
    return MT_OK;
}

/* The journals that are read, and where new records go. */
static mt_status open_files(const mt_args *args, const char *study_path, mt_journal *j,
                            mt_err *err)
{
    char *const path = journal_of(args, study_path);
    if (path == NULL) {
        return mt_fail_memory(err);
    }
    const bool adds = args->given[MT_OPT_RESUME] && !mt_file_absent(path);
    const bool quiet = args->given[MT_OPT_QUIET];
    mt_journal_place place = MT_JOURNAL_NEW;
    mt_status rc = MT_OK;
    for (int i = 0; i < args->n_journals && rc == MT_OK; i++) {
        bool foreign = false;
        rc = mt_journal_read(j, args->journals[i], &foreign, err);
        if (foreign) {
            const mt_err why = *err;
            const bool redo = args->given[MT_OPT_REDO];
            rc = redo ? MT_OK : mt_fail(err, rc, "%s; --redo does its tasks again", why.text);
            mt_terminal_talk(quiet || !redo, "%s; its tasks are done again", why.text);
        }
    }
    rc = rc == MT_OK && adds ? mt_journal_read(j, path, NULL, err) : rc;
    if (args->command == MT_CMD_RUN && rc == MT_OK) {
        rc = mt_journal_write_to(j, path, adds, &place, err);
        rc = rc == MT_OK ? write_place(args, study_path, path, j, place, err) : rc;
    }
    free(path);
    return rc;
}

/* Open the journal for a study that was read; NULL on failure. */
static int work_begin(const mt_args *args, const char *study_path, const mt_study *study,
                      mt_journal **out)
{
    mt_err err = {.code = MT_OK};
    mt_text identity = {.s = NULL};
    *out = NULL;
    mt_status rc = identity_of(study, &identity, &err);
    rc = rc == MT_OK ? mt_journal_new(identity.s, out, &err) : rc;
    mt_text_free(&identity);
    rc = rc == MT_OK ? open_files(args, study_path, *out, &err) : rc;
    if (rc == MT_OK) {
        return MT_EXIT_DONE;
    }
    mt_journal_delete(*out);
    *out = NULL;
    return mt_cli_failed(rc, &err);
}

/* Report the use of the records read, and the state of the part where one was requested. */
static void report_journal_use(const mt_args *args, const char *study_path, bool complete,
                               bool part, const mt_journal *j)
{
    const mt_journal_counts n = mt_journal_count(j);
    const bool quiet = args->given[MT_OPT_QUIET];
    if (n.ignored > 0) {
        mt_terminal_warning("%s: %ld lines of the journals are damaged or contradict each "
                            "other: what they held was done again",
                            study_path, n.ignored);
    }
    if (args->command == MT_CMD_MERGE || args->given[MT_OPT_RESUME]) {
        mt_terminal_talk(quiet, "%s: %ld tasks known of %ld in journals, %ld done now",
                         study_path, n.used, n.known, n.made);
    } else if (part || (!complete && n.written > 0)) {
        mt_terminal_talk(quiet, "%s: %ld tasks are in the journal", study_path, n.written);
    }
}

/* End the journal after an answer with this exit status so far. `complete`: nothing is left to
 * resume, and the journal, unless it is a part's, is removed. A failure to write it is a
 * warning, for a part an error. */
static int work_end(const mt_args *args, const char *study_path, int code, bool complete,
                    mt_journal *j)
{
    mt_err err = {.code = MT_OK};
    const bool part = args->given[MT_OPT_SHARD];
    const bool cut = code == MT_EXIT_INTERRUPTED || code == MT_EXIT_GOALS;
    const bool done = part && (complete || !cut); /* or it cannot be */
    if (done) {                                   /* one without a record is a part, too */
        mt_journal_begin(j);
    }
    const mt_status rc = mt_journal_end(j, complete && !part, &err);
    report_journal_use(args, study_path, complete, done, j);
    if (rc != MT_OK && part) {
        return mt_exit_worse(code, mt_cli_failed(rc, &err));
    }
    if (rc != MT_OK && code != MT_EXIT_SYSTEM) { /* else the same is told of the result */
        mt_terminal_warning("%s: the journal: %s", study_path, err.text);
    }
    return code;
}

/* The index of several studies. */

/* The index may take a twentieth of the time. */
static const double PATIENCE = 20.0;

/* Begin with all studies "not run". Returns MT_EXIT_DONE or the exit status, with all messages
 * given; batch_free in any case (out zeroed before). */
static int batch_begin(const mt_args *args, study_batch *out)
{
    mt_err err = {.code = MT_OK};
    out->args = args;
    mt_status rc = mt_arena_init(&out->mem, 0, &err);
    if (rc == MT_OK) {
        out->studies =
            mt_arena_alloc(&out->mem, (size_t)args->n_operands, sizeof *out->studies);
    }
    for (int i = 0; i < args->n_operands && out->studies != NULL; i++) {
        char *const folder = save_folder(args, args->operands[i]);
        if (folder == NULL) {
            mt_arena_fail(&out->mem);
            break;
        }
        out->studies[i] = (mt_index_study){
            .path = args->operands[i],
            .file = mt_text_base_name(args->operands[i]),
            .folder = mt_arena_strdup(&out->mem, mt_text_base_name(folder)),
            .state = "not run",
            .change = nan(""),
            .seconds = nan(""),
            .exit_status = -1,
        };
        free(folder);
    }
    rc = rc == MT_OK ? mt_arena_check(&out->mem, &err) : rc;
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

/* index.json, as schemas/index.schema.json. */
typedef struct index_document {
    const char *version;
    mt_index_study *studies;
    int n;
} index_document;

static const char *const STATES[] = {"answered", "not answered", "not run"};
static const char *const STATUSES[] = {
#define STATUS_NAME(id, name) name,
    MT_RESULT_STATUS_LIST(STATUS_NAME)
#undef STATUS_NAME
};

#define THIS mt_index_study
static const mt_field STUDY_FIELDS[] = {
    MT_F_TEXT("file", file, "Name of the study's file, without folder.",
              .rules = "\"minLength\": 1"),
    MT_F_TEXT("folder", folder,
              "Folder of its result, beside the index. What lies there is of this run where "
              "the state is \"answered\".",
              .rules = "\"minLength\": 1"),
    MT_F_CHOICE("state", state, STATES,
                "\"answered\": there is a result, whatever it says. \"not answered\": a file "
                "is wrong, or something failed; the message says what. \"not run\": an "
                "interrupt came before, or the study had not ended when this was written."),
    MT_F_TEXT_OR_NULL("name", name, "Name that the study gives itself."),
    MT_F_CHOICE_OR_NULL("status", status, STATUSES, "Status of the result."),
    MT_F_TEXT_OR_NULL("grade", grade, "Grade of the first recommendation."),
    MT_F_NUMBER_OR_NULL("change", change, "Size of its redesign."),
    MT_F_COUNT_OR_NULL(
        "exit_status", exit_status, 0,
        "What running this study alone would have ended with; that of the whole run is "
        "the worst of all.",
        .rules = "\"enum\": [0, 1, 2, 3, 4, 130, null]"),
    MT_F_TEXT_OR_NULL("message", message, "The first error, where there is no answer."),
    MT_F_TEXT_OR_NULL(
        "result_sha256", sha256,
        "SHA-256 of result.json in the folder: another one there is of another run.",
        .rules = "\"pattern\": \"^[0-9a-f]{64}$\""),
};
static const mt_record STUDY = MT_F_RECORD_OF(STUDY_FIELDS, "study", "One of the studies.");
#undef THIS

#define THIS index_document
static const mt_field INDEX_FIELDS[] = {
    MT_F_FORMAT("format", "modetune-index/1", "Kind and version of this file."),
    MT_F_TEXT("modetune", version, "Version of the program."),
    MT_F_LIST("studies", studies, n, mt_index_study, STUDY,
              "The studies, in the order in which they were given.",
              .rules = "\"minItems\": 2"),
};
const mt_record mt_index_record = MT_F_RECORD_OF(
    INDEX_FIELDS, NULL,
    "What became of several studies that were run together: `modetune run` writes it beside "
    "the folders of their results. Every member is always there; null is what there is not.");
#undef THIS

static mt_status put_index(const study_batch *batch, mt_text *out, mt_err *err)
{
    const index_document index = {
        .version = mt_version(), .studies = batch->studies, .n = batch->args->n_operands};
    mt_json_writer w = mt_json_writer_default(out);
    mt_json_open(&w, NULL, '{');
    mt_record_put(&w, &mt_index_record, &index);
    mt_json_close(&w);
    return mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
}

static int write_index(study_batch *batch)
{
    const mt_args *const args = batch->args;
    const double start = mt_terminal_seconds();
    mt_err err = {.code = MT_OK};
    mt_text json = {.s = NULL};
    mt_text page = {.s = NULL};
    mt_report_index_html(batch->studies, args->n_operands, &page);
    mt_status rc = page.failed ? mt_fail_memory(&err) : put_index(batch, &json, &err);
    if (rc == MT_OK) {
        const mt_folder_file files[] = {{index_names[0], page.s, page.length},
                                        {index_names[1], json.s, json.length}};
        mt_terminal_hold_signals();
        rc = mt_folder_replace(save_base(args), files, MT_COUNT(files), &err);
        mt_terminal_release_signals();
    }
    mt_text_free(&json);
    mt_text_free(&page);
    batch->written_s = mt_terminal_seconds();
    batch->cost_s = batch->written_s - start;
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

/* Record the end of study i. Returns the exit status of writing the index. */
static int batch_note(study_batch *batch, int i, const batch_end *end)
{
    static const char unwritten[] = "the result was not written";
    mt_arena *const mem = &batch->mem;
    mt_index_study *const s = &batch->studies[i];
    const mt_result *const r = end->result;
    s->exit_status = end->exit_status;
    if (end->sha256[0] != '\0') {
        s->state = "answered";
        s->name = r->study.name == NULL ? NULL : mt_arena_strdup(mem, r->study.name);
        s->status = mt_result_status_name(r->status);
        s->seconds = end->seconds;
        s->sha256 = mt_arena_strdup(mem, end->sha256);
        s->has_report = !batch->args->no_report;
        if (r->n_recommendations > 0) {
            s->grade = mt_arena_strdup(mem, r->recommendations[0].grade);
            s->change = r->recommendations[0].change;
        }
    } else {
        s->state = "not answered";
        s->message = mt_arena_strdup(mem, end->message[0] != '\0' ? end->message : unwritten);
    }
    mt_err err = {.code = MT_OK};
    const mt_status rc = mt_arena_check(mem, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    const bool late = mt_terminal_seconds() - batch->written_s > PATIENCE * batch->cost_s;
    return late ? write_index(batch) : MT_EXIT_DONE;
}

/* Write the whole index; as text append the table to out. Returns the exit status of
 * writing. */
static int batch_close(study_batch *batch, mt_text *out)
{
    const int n = batch->args->n_operands;
    if (mt_arena_failed(&batch->mem)) {
        return MT_EXIT_SYSTEM; /* no index with holes; what could not be noted has been said */
    }
    if (batch->args->format == MT_FORMAT_TEXT) {
        mt_table t = mt_report_index(batch->studies, n);
        mt_text_add(out, "Studies\n");
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_table_free(&t);
    }
    const int code = write_index(batch);
    if (code == MT_EXIT_DONE) {
        mt_terminal_talk(batch->args->given[MT_OPT_QUIET], "%d studies; index written to %s/",
                         n, save_base(batch->args));
    }
    return code;
}

static void batch_free(study_batch *batch)
{
    mt_arena_free(&batch->mem);
}

/* The commands. */

/* One study on its way. */
typedef struct job {
    const mt_args *args;
    int operand;
    const char *path;
    mt_study *study;
    mt_result *result;
    double start;
    double seconds;
    mt_profile counts; /* --timing */
    mt_profile *profile;
    bool stops;                  /* a signal ends the search, not the program */
    char sha256[MT_SHA256_TEXT]; /* of result.json, "" as long as it is not written */
    mt_err err;
    mt_journal *journal; /* of a command that writes its result; else NULL */
    bool complete;       /* nothing is left to be resumed */
    bool searches;       /* what comes before is done */
    bool stopped;        /* by a signal or the end of its time */
} job;

/* Save the designs before a long proof begins. A failure to write is reported, and again for
 * the whole answer. */
static mt_status save_designs_so_far(void *context, mt_result *so_far, mt_err *err)
{
    const job *const j = context;
    char sha256[MT_SHA256_TEXT] = "";
    (void)err;
    mt_watch_hold();
    (void)save(j->args, j->path, so_far, NULL, mt_terminal_seconds() - j->start, sha256);
    mt_watch_go_on();
    return MT_OK;
}

/* Reserve time before the time limit: the best design will take as long as the original one,
 * and again for its slopes and its reasons. */
static void leave_time(void *context, const char *text)
{
    enum { TIMES = 4 };
    job *const j = context;
    (void)text;
    if (!j->searches && j->args->part == 0) {
        mt_terminal_reserve(TIMES * (mt_terminal_seconds() - j->start));
    }
    j->searches = true;
}

static bool is_cut(const mt_result *result)
{
    return result->status == MT_RESULT_INTERRUPTED || result->status == MT_RESULT_TIME_LIMIT;
}

/* True where the time limit ended the search, not a signal. */
static bool is_late(const job *j)
{
    return j->stopped && !mt_terminal_is_stopped();
}

/* Load and solve; all failures are reported. */
static int answer(job *j)
{
    const mt_args *const args = j->args;
    const mt_overrides asked = {.n_sets = args->all[MT_OPT_SET].n,
                                .sets = args->all[MT_OPT_SET].value,
                                .seed = args->given[MT_OPT_SEED] ? (long)args->seed : -1,
                                .starts = args->starts,
                                .max_evaluations = args->max_evaluations,
                                .max_modal_solutions = args->max_modal_solutions,
                                .proof_s = args->given[MT_OPT_PROOF] ? args->proof_s : nan("")};
    mt_io_options io = mt_cli_io(args);
    io.asked = &asked;
    mt_diagnostics messages = {.count = 0};
    (void)mt_watch_begin(j->args, j->operand, "reading");
    mt_status rc = mt_study_load(j->path, &io, &j->study, &messages, &j->err);
    mt_watch_end(rc == MT_OK);
    const int code = mt_cli_loaded(rc, &messages, &j->err);
    if (rc != MT_OK) {
        return code;
    }
    mt_solve_options opt = {.size = sizeof opt};
    opt.threads = j->args->threads;
    opt.stop = j->stops ? mt_terminal_stop_request : NULL;
    opt.cause = j->stops ? mt_terminal_stop_reason : NULL;
    opt.progress = j->stops && j->args->given[MT_OPT_TIME] ? leave_time : NULL;
    opt.progress_context = j;
    j->profile = mt_cli_profile(j->args, &j->counts);
    mt_task_path tasks = {.store = NULL};
    if (j->args->command != MT_CMD_COMPARE) {
        const int begun = work_begin(j->args, j->path, j->study, &j->journal);
        if (begun != MT_EXIT_DONE) {
            return begun;
        }
        tasks.store = mt_journal_checkpoint_store(j->journal, j->args->part, j->args->parts);
    }
    const mt_incumbent_callback early = {save_designs_so_far, j};
    const bool kept = j->args->command != MT_CMD_COMPARE && j->args->part == 0;
    j->start = mt_terminal_seconds();
    if (j->stops) {
        mt_terminal_hold_signals();
        mt_terminal_limit(j->args->time_s);
    }
    const mt_run run = {.progress = mt_watch_begin(j->args, j->operand, "baseline"),
                        .profile = j->profile,
                        .tasks = &tasks};
    rc = mt_study_solve_with(j->study, &opt, &run, kept ? &early : NULL, &j->result, &j->err);
    j->seconds = mt_terminal_seconds() - j->start;
    j->stopped = mt_terminal_stop_request(NULL) != MT_STOP_REQUEST_NONE;
    mt_terminal_limit(0.0);
    mt_watch_end(rc == MT_OK && !is_cut(j->result));
    const bool late = is_late(j) && (rc == MT_E_INTERRUPTED || j->args->part > 0 ||
                                     (rc == MT_OK && is_cut(j->result)));
    if (late) {
        mt_terminal_talk(j->args->given[MT_OPT_QUIET],
                         "%s: stopped at the time limit of %s s%s", j->path,
                         j->args->value[MT_OPT_TIME],
                         j->args->command == MT_CMD_RUN ? "; --resume goes on from here" : "");
    }
    mt_cli_place(j->study, j->path, rc, &j->err, &messages);
    const int ended = mt_cli_loaded(rc, &messages, &j->err);
    return late && ended == MT_EXIT_INTERRUPTED ? MT_EXIT_GOALS : ended;
}

/* True where a design was analysed again and meets all goals. A fit that was cut has not
 * converged, for any misfit. */
static bool is_met_by_best(const mt_result *r)
{
    const mt_recommendation *const best = r->recommendations;
    bool asked = false;
    for (int i = 0; r->n_recommendations > 0 && i < best->n_goals; i++) {
        asked = asked || !best->goals[i].weighted;
    }
    return asked && best->feasible;
}

static int outcome(const job *j, bool verify)
{
    const mt_result *const r = j->result;
    if (r->status == MT_RESULT_INTERRUPTED) {
        return MT_EXIT_INTERRUPTED;
    }
    int judged = 0;
    const bool late = r->status == MT_RESULT_TIME_LIMIT;
    const bool met = late ? is_met_by_best(r)
                          : r->status == MT_RESULT_SOLVED || r->status == MT_RESULT_FITTED;
    const bool holds = verify ? mt_report_verified(r, &judged) && (met || !late) : met;
    if (late && !(holds && (!verify || judged > 0))) {
        return MT_EXIT_GOALS;
    }
    if (verify && judged == 0) { /* nothing to judge must not look like a success */
        mt_terminal_error("%s: there are no published values to judge", j->path);
        return MT_EXIT_INPUT;
    }
    return holds ? MT_EXIT_DONE : MT_EXIT_GOALS;
}

/* What a command does with an answer; its exit status. */
typedef int (*use_answer)(job *j, mt_json_writer *w, mt_text *out);

static int run_one(job *j, mt_json_writer *w, mt_text *out)
{
    const bool verify = j->args->given[MT_OPT_VERIFY];
    if (j->args->part > 0) { /* its journal is what it leaves */
        j->complete = !j->stopped;
        return j->complete ? MT_EXIT_DONE : is_late(j) ? MT_EXIT_GOALS : MT_EXIT_INTERRUPTED;
    }
    mt_text scene = {.s = NULL};
    if (j->result->status == MT_RESULT_TIME_LIMIT && j->args->command == MT_CMD_RUN) {
        j->result->status_text = mt_arena_printf(
            &j->result->mem, "%s `run --resume` goes on from here.", j->result->status_text);
    }
    mt_status rc = mt_arena_check(&j->result->mem, &j->err);
    if (rc == MT_OK && !j->args->no_report) {
        rc = mt_scene_of_result(j->study->model, j->result, j->args->threads, &scene, &j->err);
    }
    if (rc != MT_OK) { /* no other answer than with memory */
        mt_text_free(&scene);
        return mt_cli_failed(rc, &j->err);
    }
    save_print(j->args, j->result, scene.s, w, out);
    const int saved = save(j->args, j->path, j->result, scene.s, j->seconds, j->sha256);
    mt_text_free(&scene);
    j->complete = saved == MT_EXIT_DONE && !is_cut(j->result);
    return mt_exit_worse(outcome(j, verify),
                         mt_exit_worse(saved, mt_cli_profile_print(j->profile)));
}

/* The studies from number `first` on that an interrupt leaves out, as an error; heap. NULL: out
 * of memory, which is reported. */
static char *words_about(const mt_args *args, int first)
{
    mt_text t = {.s = NULL};
    mt_text_add(&t, "modetune: error: interrupted; not answered:");
    for (int i = first; i < args->n_operands; i++) {
        mt_text_addf(&t, " %s", args->operands[i]);
    }
    if (t.failed) {
        mt_err err;
        (void)mt_cli_failed(mt_fail_memory(&err), &err);
    }
    return t.s;
}

/* Studies on their way. */
typedef struct round_of {
    const mt_args *args;
    use_answer use;
    bool stops;         /* a signal ends a search, not the program */
    study_batch *batch; /* NULL: no index */
    mt_json_writer w;
    mt_text *out;
} round_of;

/* One study: read (a signal then ends the program), solved and used (where it may, a signal
 * ends the search), told. */
static int one_study(round_of *all, int i)
{
    const mt_args *const args = all->args;
    job j = {.args = args, .operand = i, .path = args->operands[i], .stops = all->stops};
    char *const words = words_about(args, i);
    if (words == NULL) {
        return MT_EXIT_SYSTEM;
    }
    mt_terminal_last_words(words);
    int code = answer(&j);
    if (code == MT_EXIT_DONE) {
        code = all->use(&j, &all->w, all->out);
    }
    if (j.journal != NULL) {
        code = work_end(args, j.path, code, j.complete, j.journal);
    }
    mt_terminal_release_signals();
    mt_journal_delete(j.journal);
    free(words);
    if (args->format != MT_FORMAT_JSON) {
        code = mt_exit_worse(code, mt_terminal_put(all->out));
    }
    if (all->batch != NULL) {
        const batch_end end = {.result = j.result,
                               .sha256 = j.sha256,
                               .message = j.err.text,
                               .exit_status = code,
                               .seconds = j.seconds};
        code = mt_exit_worse(code, batch_note(all->batch, i, &end));
    }
    mt_result_delete(j.result);
    mt_study_delete(j.study);
    return code;
}

/* All studies in turn. Text leaves as it comes; JSON is one document (a list where several
 * studies are given). */
static int for_each_study(round_of *all)
{
    const mt_args *const args = all->args;
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && args->n_operands > 1;
    int code = MT_EXIT_DONE;
    int i = 0;
    if (list) {
        mt_json_open(&all->w, NULL, '[');
    }
    for (; i < args->n_operands && !mt_terminal_is_stopped(); i++) {
        code = mt_exit_worse(code, one_study(all, i));
    }
    if (list) {
        mt_json_close(&all->w);
    }
    if (json && all->out->length > 0) {
        code = mt_exit_worse(code, mt_cli_json_done(&all->w));
    }
    if (i < args->n_operands) {
        char *const words = words_about(args, i);
        mt_terminal_talk(false, "%s", words == NULL ? "" : words);
        code = mt_exit_worse(code, words == NULL ? MT_EXIT_SYSTEM : MT_EXIT_INTERRUPTED);
        free(words);
    }
    return code;
}

static int run_run(const mt_args *args, mt_text *out)
{
    study_batch batch = {.args = args};
    round_of all = {.args = args,
                    .use = run_one,
                    .stops = true,
                    .batch = args->n_operands > 1 && args->part == 0 ? &batch : NULL,
                    .w = mt_json_writer_default(out),
                    .out = out};
    int code = save_plan(args);
    if (code == MT_EXIT_DONE && all.batch != NULL) {
        code = batch_begin(args, &batch);
    }
    if (code == MT_EXIT_DONE) {
        code = for_each_study(&all);
        code = all.batch == NULL ? code : mt_exit_worse(code, batch_close(&batch, out));
    }
    batch_free(&batch);
    return code;
}

const mt_command mt_command_run = {
    .name = "run",
    .operands = "STUDY...",
    .least = 1,
    .most = -1,
    .summary = "solve studies and write the results",
    .details =
        "Solves each study, prints a summary and writes the result into DIR/<study file name "
        "without .json>/: result.json, recommendations.csv, report.html, timing.json, "
        "trade.csv (of a trade study) and curves.csv (if the study lists responses). A run "
        "that fails or is killed leaves the old result, or one that the next run repairs.\n"
        "Several studies are answered one after the other, whatever happens to each. A table "
        "at the end, and index.json and index.html in DIR, list what became of them.\n"
        "After an interrupt (Ctrl-C) the best designs so far are written, and run.incomplete "
        "of the result lists what is missing. --resume continues from the journal that every "
        "run keeps while it works.",
    .run = run_run,
};

static int run_merge(const mt_args *args, mt_text *out)
{
    mt_args one = *args; /* the first operand is the study */
    one.n_operands = 1;
    one.n_journals = args->n_operands - 1;
    one.journals = args->operands + 1;
    return run_run(&one, out);
}

const mt_command mt_command_merge = {
    .name = "merge",
    .operands = "STUDY JOURNAL...",
    .least = 2,
    .most = -1,
    .summary = "join the parts of a study's work",
    .details = "Reads the journals that `run --shard PART/PARTS` left in DIR/<study file name "
               "without .json>.PART-of-PARTS.journal, does the remaining work, and prints and "
               "writes what `run` would have printed and written. A journal of another study, "
               "model, program or library is refused; the work of a damaged line is repeated.",
    .run = run_merge,
};

static int compare_one(job *j, mt_json_writer *w, mt_text *out)
{
    const mt_result *const r = j->result;
    const mt_recommendation *const best =
        r->n_recommendations > 0 ? &r->recommendations[0] : &r->baseline;
    const mt_summary_writer to = {.out = out, .width = mt_terminal_width()};
    mt_table t = mt_report_published(r);
    int judged = 0;
    const bool holds = mt_report_verified(r, &judged);
    switch (j->args->format) {
    case MT_FORMAT_JSON:
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "study", r->study.file);
        mt_result_put_member(w, "status", r);
        mt_result_put_member(w, "doubts", r);
        mt_json_put_bool(w, "holds", holds && judged > 0);
        mt_design_put_member(w, "objectives", r, best);
        mt_result_put_member(w, "published", r);
        mt_result_put_member(w, "undetermined", r);
        mt_result_put_member(w, "spread", r);
        mt_json_close(w);
        break;
    case MT_FORMAT_CSV:
        mt_table_csv(&t, out);
        break;
    case MT_FORMAT_HTML: /* of report alone */
    case MT_FORMAT_SARIF:
    case MT_FORMAT_TEXT:
        mt_text_addf(out, "%s: %s\n", r->study.name == NULL ? j->path : r->study.name,
                     mt_result_status_name(r->status));
        mt_write_overrides(&to, &r->run);
        if (r->n_doubts > 0) {
            mt_tell_warnings(&to, r);
            mt_text_add(out, "\n");
        }
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_write_objectives(&to, best);
        mt_write_uncertainty(&to, r);
        mt_text_add(out, "\n");
        break;
    }
    mt_table_free(&t);
    return outcome(j, true);
}

static int run_compare(const mt_args *args, mt_text *out)
{
    round_of all = {
        .args = args, .use = compare_one, .w = mt_json_writer_default(out), .out = out};
    return for_each_study(&all);
}

const mt_command mt_command_compare = {
    .name = "compare",
    .operands = "STUDY...",
    .least = 1,
    .most = -1,
    .summary = "published against computed values",
    .details =
        "Solves each study and prints its published values beside the computed ones, with "
        "differences, roles and sources. Writes no files. The exit status is 0 if all "
        "values hold, and 1 otherwise.",
    .run = run_compare,
};

/* modetune report: a result read back and told again, from itself alone; where its model is
 * found, pages show the mechanism, too. */

/* The scene of the result's designs, where the model that was solved is found. Fails:
 * MT_E_MEMORY, MT_E_SYSTEM (a candidate cannot be read: the page would differ). */
static mt_status find_scene(const mt_args *args, const mt_result *result, mt_text *scene,
                            mt_err *err)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_file file = {.bytes = NULL};
    char *path = NULL;
    mt_model *model = NULL;
    mt_diagnostics messages = {.count = 0};
    mt_err why = {.code = MT_OK};
    mt_status rc = mt_find_model(args, result, &file, &path, &why);
    rc = rc == MT_OK ? mt_model_load(path, &opt, &model, &messages, &why) : rc;
    rc = rc == MT_OK ? mt_scene_of_result(model, result, 1, scene, &why) : rc;
    mt_diagnostics_free(&messages);
    mt_model_delete(model);
    mt_file_free(&file);
    free(path);
    return mt_is_final(rc) || rc == MT_E_SYSTEM ? mt_fail(err, rc, "%s", why.text) : MT_OK;
}

static int run_report(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    mt_text scene = {.s = NULL};
    mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK && (args->format == MT_FORMAT_HTML || args->given[MT_OPT_OUTPUT])) {
        rc = find_scene(args, result, &scene, &err);
        code = rc == MT_OK ? code : mt_cli_failed(rc, &err);
    }
    if (rc == MT_OK) {
        mt_json_writer w = mt_json_writer_default(out);
        save_print(args, result, scene.s, &w, out);
        code = args->format == MT_FORMAT_JSON ? mt_cli_json_done(&w) : MT_EXIT_DONE;
    }
    if (rc == MT_OK && args->given[MT_OPT_OUTPUT]) {
        code = mt_exit_worse(code, save_again(args, args->operands[0], result, scene.s));
    }
    mt_text_free(&scene);
    mt_result_delete(result);
    return code;
}

const mt_command mt_command_report = {
    .name = "report",
    .operands = "RESULT.json",
    .least = 1,
    .most = 1,
    .summary = "a result as text, CSV or HTML",
    .details =
        "Prints the summary that run printed (--format csv: recommendations.csv, html: "
        "report.html, json: the result) from the result, or its folder, alone. It needs no "
        "study and solves nothing; only the page's view of the mechanism needs the model, "
        "and is omitted if apply would not find it. --output writes all files again into "
        "DIR/<study file name without .json>/, as run does, except timing.json, which is "
        "copied if it lies beside the result. A result.json whose neighbours were changed "
        "or belong to another run is refused; a copy by itself is read.",
    .run = run_report,
};
