/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/work.h"

#include <stdlib.h>

#include "cli/cli.h"
#include "cli/save.h"
#include "describe/describe.h"
#include "io/file.h"
#include "linalg/dense.h"

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
    char *const folder = mt_save_folder(args, study_path);
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

int mt_work_begin(const mt_args *args, const char *study_path, const mt_study *study,
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

int mt_work_end(const mt_args *args, const char *study_path, int code, bool complete,
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
