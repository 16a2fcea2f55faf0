/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune run and compare: answer studies, write what was found, judge published values. */
#include <math.h>
#include <stdlib.h>

#include "answer/solve.h"
#include "cli/batch.h"
#include "cli/cli.h"
#include "cli/profile.h"
#include "cli/save.h"
#include "cli/watch.h"
#include "cli/work.h"
#include "library/scene_designs.h"
#include "report/result_tables.h"
#include "report/summary.h"
#include "result/result.h"
#include "study/study.h"

/* One study on its way. */
typedef struct job {
    const mt_args *args;
    int operand;
    const char *path;
    mt_study *study;
    mt_result *result;
    double start;
    double seconds;
    mt_profile counts; /* --profile */
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
    (void)mt_save(j->args, j->path, so_far, NULL, mt_terminal_seconds() - j->start, sha256);
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
        const int begun = mt_work_begin(j->args, j->path, j->study, &j->journal);
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
    mt_save_print(j->args, j->result, scene.s, w, out);
    const int saved = mt_save(j->args, j->path, j->result, scene.s, j->seconds, j->sha256);
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
    bool stops;      /* a signal ends a search, not the program */
    mt_batch *batch; /* NULL: no index */
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
        code = mt_work_end(args, j.path, code, j.complete, j.journal);
    }
    mt_terminal_release_signals();
    mt_journal_delete(j.journal);
    free(words);
    if (args->format != MT_FORMAT_JSON) {
        code = mt_exit_worse(code, mt_terminal_put(all->out));
    }
    if (all->batch != NULL) {
        const mt_batch_end end = {.result = j.result,
                                  .sha256 = j.sha256,
                                  .message = j.err.text,
                                  .exit_status = code,
                                  .seconds = j.seconds};
        code = mt_exit_worse(code, mt_batch_note(all->batch, i, &end));
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

int mt_cmd_run(const mt_args *args, mt_text *out)
{
    mt_batch batch = {.args = args};
    round_of all = {.args = args,
                    .use = run_one,
                    .stops = true,
                    .batch = args->n_operands > 1 && args->part == 0 ? &batch : NULL,
                    .w = mt_json_writer_default(out),
                    .out = out};
    int code = mt_save_plan(args);
    if (code == MT_EXIT_DONE && all.batch != NULL) {
        code = mt_batch_begin(args, &batch);
    }
    if (code == MT_EXIT_DONE) {
        code = for_each_study(&all);
        code = all.batch == NULL ? code : mt_exit_worse(code, mt_batch_close(&batch, out));
    }
    mt_batch_free(&batch);
    return code;
}

int mt_cmd_merge(const mt_args *args, mt_text *out)
{
    mt_args one = *args; /* the first operand is the study */
    one.n_operands = 1;
    one.n_journals = args->n_operands - 1;
    one.journals = args->operands + 1;
    return mt_cmd_run(&one, out);
}

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

int mt_cmd_compare(const mt_args *args, mt_text *out)
{
    round_of all = {
        .args = args, .use = compare_one, .w = mt_json_writer_default(out), .out = out};
    return for_each_study(&all);
}
