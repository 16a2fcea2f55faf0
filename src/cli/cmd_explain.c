/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune explain: what moves each goal of a design, what holds it, and the price. */
#include "cli/cli.h"
#include "report/explain.h"

static void print_json(const mt_result *result, const mt_recommendation *r, mt_json_writer *w)
{
    static const char *const members[] = {"rank", "grade", "parameters", "goals", "reasons"};
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "study", result->study.file);
    for (int i = 0; i < MT_COUNT(members); i++) {
        mt_design_put_member(w, members[i], result, r);
    }
    mt_json_close(w);
}

/* The design asked for; without --rank the best, and where none is recommended the original. */
static mt_status choose_explained_design(const mt_args *args, const mt_result *result,
                                         const mt_recommendation **out, mt_err *err)
{
    if (!args->given[MT_OPT_RANK] && result->n_recommendations == 0) {
        *out = &result->baseline;
        return MT_OK;
    }
    return mt_cli_recommendation(args, result, out, err);
}

static int print(const mt_args *args, const mt_result *result, mt_text *out)
{
    const mt_recommendation *r = NULL;
    mt_json_writer w = mt_json_writer_default(out);
    mt_err err = {.code = MT_OK};
    const mt_status rc = choose_explained_design(args, result, &r, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    if (args->format == MT_FORMAT_JSON) {
        print_json(result, r, &w);
        return mt_cli_json_done(&w);
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table t = mt_report_movers(r);
        mt_table_csv(&t, out);
        mt_table_free(&t);
    } else {
        mt_report_explain(result, r, mt_terminal_width(), out);
    }
    return MT_EXIT_DONE;
}

int mt_cmd_explain(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    const mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    code = rc == MT_OK ? print(args, result, out) : code;
    mt_result_delete(result);
    return code;
}
