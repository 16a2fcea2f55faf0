/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune run and compare: answer studies, write what was found, judge published values. */
#include <stdlib.h>

#include "cli/cli.h"
#include "cli/profile.h"
#include "cli/save.h"
#include "report/result_tables.h"
#include "report/summary.h"
#include "result/result.h"
#include "study/study.h"

/* One study on its way. */
typedef struct job {
    const mt_args *args;
    const char *path;
    mt_study *study;
    mt_result *result;
    double seconds;
    mt_profile counts; /* --profile */
    mt_profile *profile;
    bool stops; /* a signal ends the search, not the program */
} job;

static void progress(void *context, const char *text)
{
    const mt_args *const args = context;
    mt_terminal_progress(args->given[MT_OPT_QUIET], text);
}

/* Load and solve; everything that went wrong is said. */
static int answer(job *j)
{
    mt_io_options io = mt_cli_io(j->args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_status rc = mt_study_load(j->path, &io, &j->study, &messages, &err);
    const int code = mt_cli_loaded(rc, &messages, &err);
    if (rc != MT_OK) {
        return code;
    }
    mt_solve_options opt = {.size = sizeof opt};
    mt_args progress_args = *j->args;
    opt.threads = j->args->threads;
    opt.stop = j->stops ? mt_terminal_wish : NULL;
    opt.progress = progress;
    opt.progress_context = &progress_args;
    j->profile = mt_cli_profile(j->args, &j->counts);
    j->study->model->profile = j->profile;
    const double start = mt_terminal_seconds();
    if (j->stops) {
        mt_terminal_hold_signals();
    }
    rc = mt_study_solve(j->study, &opt, &j->result, &err);
    j->seconds = mt_terminal_seconds() - start;
    mt_terminal_progress(j->args->given[MT_OPT_QUIET], NULL);
    mt_cli_place(j->study, j->path, rc, &err, &messages);
    return mt_cli_loaded(rc, &messages, &err);
}

static int outcome(const job *j, bool verify)
{
    if (j->result->status == MT_RESULT_INTERRUPTED) {
        return MT_EXIT_INTERRUPTED;
    }
    int judged = 0;
    const bool holds =
        verify ? mt_report_verified(j->result, &judged) : j->result->status == MT_RESULT_SOLVED;
    if (verify && judged == 0) { /* nothing to judge must not look like a success */
        mt_terminal_error("%s: there are no published values to judge", j->path);
        return MT_EXIT_INPUT;
    }
    return holds ? MT_EXIT_DONE : MT_EXIT_GOALS;
}

/* What a command does with an answer; its exit status. */
typedef int (*use_answer)(const job *j, mt_json_writer *w, mt_text *out);

static int run_one(const job *j, mt_json_writer *w, mt_text *out)
{
    const bool verify = j->args->given[MT_OPT_VERIFY];
    mt_save_print(j->args, j->result, w, out);
    return mt_exit_worse(outcome(j, verify),
                         mt_exit_worse(mt_save(j->args, j->path, j->result, j->seconds),
                                       mt_cli_profile_print(j->profile)));
}

/* Which studies an interrupt leaves out from number `first` on, as an error; heap. NULL: out of
 * memory, which is said. */
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

/* One study: read (a signal then ends the program), solved and used (where it may, a signal
 * ends the search), told. */
static int one_study(const mt_args *args, int i, bool stops, mt_json_writer *w, mt_text *out,
                     use_answer use)
{
    const bool json = args->format == MT_FORMAT_JSON;
    job j = {.args = args, .path = args->operands[i], .stops = stops};
    char *const words = words_about(args, i);
    if (words == NULL) {
        return MT_EXIT_SYSTEM;
    }
    mt_terminal_last_words(words);
    int code = answer(&j);
    if (code == MT_EXIT_DONE) {
        code = use(&j, w, out);
    }
    mt_terminal_release_signals();
    free(words);
    mt_result_delete(j.result);
    mt_study_delete(j.study);
    return mt_exit_worse(code, json ? MT_EXIT_DONE : mt_terminal_put(out));
}

/* All studies in turn. Text leaves as it comes; JSON is one document (a list where several
 * studies are given). */
static int for_each_study(const mt_args *args, mt_text *out, bool stops, use_answer use)
{
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && args->n_operands > 1;
    mt_json_writer w = mt_json_writer_default(out);
    int code = MT_EXIT_DONE;
    int i = 0;
    if (list) {
        mt_json_open(&w, NULL, '[');
    }
    for (; i < args->n_operands && !mt_terminal_is_stopped(); i++) {
        code = mt_exit_worse(code, one_study(args, i, stops, &w, out, use));
    }
    if (list) {
        mt_json_close(&w);
    }
    if (json && out->length > 0) {
        code = mt_exit_worse(code, mt_cli_json_done(&w));
    }
    if (i < args->n_operands) {
        char *const words = words_about(args, i);
        mt_terminal_talk(false, "%s", words == NULL ? "" : words);
        code = mt_exit_worse(code, words == NULL ? MT_EXIT_SYSTEM : MT_EXIT_INTERRUPTED);
        free(words);
    }
    return code;
}

int mt_cmd_run(const mt_args *args, mt_text *out)
{
    const int code = mt_save_plan(args);
    return code == MT_EXIT_DONE ? for_each_study(args, out, true, run_one) : code;
}

static int compare_one(const job *j, mt_json_writer *w, mt_text *out)
{
    const mt_result *const r = j->result;
    const mt_recommendation *const best =
        r->n_recommendations > 0 ? &r->recommendations[0] : &r->baseline;
    const mt_teller to = {out, false};
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
    case MT_FORMAT_TEXT:
        mt_text_addf(out, "%s: %s\n", r->study.name == NULL ? j->path : r->study.name,
                     mt_result_status_name(r->status));
        if (r->n_doubts > 0) {
            mt_tell_doubts(&to, r);
            mt_text_add(out, "\n");
        }
        mt_table_print(&t, 2, out);
        mt_tell_objectives(&to, best);
        mt_tell_uncertainty(&to, r);
        mt_text_add(out, "\n");
        break;
    }
    mt_table_free(&t);
    return outcome(j, true);
}

int mt_cmd_compare(const mt_args *args, mt_text *out)
{
    return for_each_study(args, out, false, compare_one);
}
