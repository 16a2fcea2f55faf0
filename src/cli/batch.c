/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The index of several studies. */
#include "cli/batch.h"

#include "modetune/version.h"

#include <math.h>
#include <stdlib.h>

#include "cli/cli.h"
#include "cli/save.h"
#include "io/folder.h"

/* The index may take a twentieth of the time. */
static const double PATIENCE = 20.0;

int mt_batch_begin(const mt_args *args, mt_batch *out)
{
    mt_err err = {.code = MT_OK};
    out->args = args;
    mt_status rc = mt_arena_init(&out->mem, 0, &err);
    if (rc == MT_OK) {
        out->studies =
            mt_arena_alloc(&out->mem, (size_t)args->n_operands, sizeof *out->studies);
    }
    for (int i = 0; i < args->n_operands && out->studies != NULL; i++) {
        char *const folder = mt_save_folder(args, args->operands[i]);
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

static void put_study(mt_json_writer *w, const mt_index_study *s)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "file", s->file);
    mt_json_put_string(w, "folder", s->folder);
    mt_json_put_string(w, "state", s->state);
    mt_json_put_string(w, "name", s->name);
    mt_json_put_string(w, "status", s->status);
    mt_json_put_string(w, "grade", s->grade);
    mt_json_put_number(w, "change", s->change);
    if (s->exit_status < 0) {
        mt_json_put_null(w, "exit_status");
    } else {
        mt_json_put_integer(w, "exit_status", s->exit_status);
    }
    mt_json_put_string(w, "message", s->message);
    mt_json_put_string(w, "result_sha256", s->sha256);
    mt_json_close(w);
}

static mt_status put_index(const mt_batch *batch, mt_text *out, mt_err *err)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_json_open(&w, NULL, '{');
    mt_json_put_string(&w, "format", "modetune-index/1");
    mt_json_put_string(&w, "modetune", mt_version());
    mt_json_open(&w, "studies", '[');
    for (int i = 0; i < batch->args->n_operands; i++) {
        put_study(&w, &batch->studies[i]);
    }
    mt_json_close(&w);
    mt_json_close(&w);
    return mt_json_done(&w) ? MT_OK : mt_fail_memory(err);
}

static int write_index(mt_batch *batch)
{
    const mt_args *const args = batch->args;
    const double start = mt_terminal_seconds();
    mt_err err = {.code = MT_OK};
    mt_text json = {.s = NULL};
    mt_text page = {.s = NULL};
    mt_report_index_html(batch->studies, args->n_operands, &page);
    mt_status rc = page.failed ? mt_fail_memory(&err) : put_index(batch, &json, &err);
    if (rc == MT_OK) {
        const mt_folder_file files[] = {{mt_index_names[0], page.s, page.length},
                                        {mt_index_names[1], json.s, json.length}};
        mt_terminal_hold_signals();
        rc = mt_folder_replace(mt_save_base(args), files, MT_COUNT(files), &err);
        mt_terminal_release_signals();
    }
    mt_text_free(&json);
    mt_text_free(&page);
    batch->written_s = mt_terminal_seconds();
    batch->cost_s = batch->written_s - start;
    return rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
}

int mt_batch_note(mt_batch *batch, int i, const mt_batch_end *end)
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

int mt_batch_close(mt_batch *batch, mt_text *out)
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
                         n, mt_save_base(batch->args));
    }
    return code;
}

void mt_batch_free(mt_batch *batch)
{
    mt_arena_free(&batch->mem);
}
