/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of a study as one page: what was asked, what to change, why, and how far to trust
 * it. */
#include "report/html.h"

#include "report/summary.h"
#include "report/table.h"

static const char STYLE[] =
    "body{font:15px/1.45 system-ui,sans-serif;color:#1a1a1a;background:#fff;max-width:60em;"
    "margin:2em auto;padding:0 1em}"
    "h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.1em;margin:1.6em 0 .4em}"
    ".status{padding:.5em .8em;border-left:5px solid #888;background:#f4f4f4}"
    ".solved{border-color:#1b7837}.compromise,.interrupted{border-color:#b8860b}"
    ".infeasible{border-color:#b2182b}.doubts{padding:.1em .8em;background:#fff3cd}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:.4em 0}"
    "th,td{padding:.2em .7em;text-align:left;border-bottom:1px solid #ddd}"
    "th{border-bottom:2px solid #888}.n{text-align:right}"
    "svg{max-width:100%;height:auto}svg text{font:12px system-ui,sans-serif;fill:#333}"
    "footer{margin-top:2em;color:#666;font-size:.85em}"
    "@media "
    "print{body{margin:0;max-width:none}h2{break-after:avoid}table,svg{break-inside:avoid}}";

static void add_footer(const mt_result_run *run, mt_text *out)
{
    mt_text_add(out, "<footer>modetune ");
    mt_html_escape(run->modetune_version == NULL ? "" : run->modetune_version, out);
    mt_text_add(out, " (");
    mt_html_escape(run->build.commit == NULL ? "" : run->build.commit, out);
    mt_text_addf(out, "), seed %ld, %d starts, ", run->seed, run->starts);
    mt_report_spent(run, out);
    mt_text_add(out, ".");
    for (int i = 0; i < run->n_inputs; i++) {
        mt_text_add(out, "<br>");
        mt_html_escape(run->inputs[i].file, out);
        mt_text_add(out, ": sha256 ");
        mt_html_escape(run->inputs[i].sha256, out);
    }
    mt_text_add(out, "</footer>\n");
}

void mt_html_begin(const char *title, mt_text *out)
{
    mt_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width\">\n<title>");
    mt_html_escape(title, out);
    mt_text_addf(out, "</title>\n<style>%s</style>\n</head>\n<body>\n<h1>", STYLE);
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

void mt_html_end(mt_text *out)
{
    mt_text_add(out, "</body>\n</html>\n");
}

void mt_report_html(const mt_result *result, mt_text *out)
{
    const char *const name = result->study.name != NULL   ? result->study.name
                             : result->study.file != NULL ? result->study.file
                                                          : "study";
    const char *const status = mt_result_status_name(result->status);
    mt_html_begin(name, out);
    mt_text_addf(out, "<p class=\"status %s\"><b>%s</b>. ", status, status);
    mt_html_escape(result->status_text == NULL ? "" : result->status_text, out);
    mt_text_add(out, "</p>\n");
    mt_tell_answer(&(mt_teller){out, true}, result, true);
    add_footer(&result->run, out);
    mt_html_end(out);
}
