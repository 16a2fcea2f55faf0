/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of a study as one page: what was asked, what to change, why, and how far to trust
 * it. */
#include "report/html.h"

#include "report/campbell.h"
#include "report/number.h"
#include "report/result_tables.h"
#include "report/summary.h"
#include "report/svg.h"
#include "report/trade.h"

static const char STYLE[] =
    "body{font:15px/1.45 system-ui,sans-serif;color:#1a1a1a;background:#fff;max-width:60em;"
    "margin:2em auto;padding:0 1em}"
    "h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.1em;margin:1.6em 0 .4em}"
    ".status{padding:.5em .8em;border-left:5px solid #888;background:#f4f4f4}"
    ".solved{border-color:#1b7837}.compromise,.interrupted{border-color:#b8860b}"
    ".infeasible{border-color:#b2182b}.doubts{padding:.5em 2em;background:#fff3cd}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:.4em 0}"
    "th,td{padding:.2em .7em;text-align:left;border-bottom:1px solid #ddd}"
    "th{border-bottom:2px solid #888}.n{text-align:right}"
    "svg{max-width:100%;height:auto}svg text{font:12px system-ui,sans-serif;fill:#333}"
    "footer{margin-top:2em;color:#666;font-size:.85em}"
    "@media "
    "print{body{margin:0;max-width:none}h2{break-after:avoid}table,svg{break-inside:avoid}}";

static void heading(const char *s, mt_text *out)
{
    mt_text_add(out, "<h2>");
    mt_html_escape(s, out);
    mt_text_add(out, "</h2>\n");
}

static void add_table(mt_table t, const char *title, mt_text *out)
{
    if (mt_table_rows(&t) > 0 || t.failed) {
        heading(title, out);
        mt_table_html(&t, out);
    }
    mt_table_free(&t);
}

static void add_item(const char *s, mt_text *out)
{
    mt_text_add(out, "<li>");
    mt_html_escape(s, out);
    mt_text_add(out, "</li>\n");
}

static void add_list(int n, const char *const *items, const char *title, mt_text *out)
{
    if (n == 0) {
        return;
    }
    heading(title, out);
    mt_text_add(out, "<ul>\n");
    for (int i = 0; i < n; i++) {
        add_item(items[i], out);
    }
    mt_text_add(out, "</ul>\n");
}

static void add_best(const mt_recommendation *r, mt_text *out)
{
    add_table(mt_report_objectives(r), "Objectives", out);
    add_table(mt_report_parameters(r), "Parameters", out);
    for (int i = 0; i < r->n_parameters; i++) {
        mt_text line = {0};
        if (mt_report_measure(&r->parameters[i], &line)) {
            mt_text_add(out, "<p>");
            mt_html_escape(line.s == NULL ? "" : line.s, out);
            mt_text_add(out, "</p>\n");
        }
        out->failed = out->failed || line.failed;
        mt_text_free(&line);
    }
    if (r->n_parameters > 0) {
        mt_report_svg_changes(r, out);
    }
    add_table(mt_report_frequencies(r), "Frequencies", out);
    if (r->n_frequencies > 0) {
        mt_report_svg_frequencies(r, out);
    }
    add_table(mt_report_gaps(r), "Bands", out);
    add_table(mt_report_clearances(r), "Clearances from bands", out);
    add_table(mt_report_motions(r), "Over the range of motion", out);
    add_table(mt_report_goals(r), "Goals", out);
    add_list(r->n_reasons, r->reasons, "Why", out);
}

static void add_undetermined(const mt_result *result, mt_text *out)
{
    if (result->n_undetermined == 0) {
        return;
    }
    heading("Undetermined", out);
    mt_text_add(out, "<p>Along these directions the goals hardly change.</p>\n<ul>\n");
    for (int i = 0; i < result->n_undetermined; i++) {
        add_item(result->undetermined[i].text, out);
    }
    mt_text_add(out, "</ul>\n");
}

static void add_certificates(const mt_result *result, mt_text *out)
{
    if (result->n_certificates == 0) {
        return;
    }
    const bool doubtful = mt_report_doubtful(result);
    heading("Certificates", out);
    mt_text_add(out, "<ul>\n");
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        mt_text_addf(out, "<li><b>%s</b>: ", mt_report_surety(c->proven, doubtful));
        mt_html_escape(c->text, out);
        mt_text_add(out, "</li>\n");
    }
    mt_text_add(out, "</ul>\n");
}

static void add_relaxations(const mt_result *result, mt_text *out)
{
    if (result->n_relaxations == 0) {
        return;
    }
    heading("What would let a design exist, one change at a time", out);
    mt_text_add(out, "<ul>\n");
    for (int i = 0; i < result->n_relaxations; i++) {
        add_item(result->relaxations[i].text, out);
    }
    mt_text_add(out, "</ul>\n");
}

static void add_doubts(int n, const mt_doubt *items, bool doubts, mt_text *out)
{
    if (n == 0) {
        return;
    }
    heading(doubts ? "Doubts" : "Facts of the model", out);
    mt_text_addf(out, "<ul%s>\n", doubts ? " class=\"doubts\"" : "");
    for (int i = 0; i < n; i++) {
        mt_text text = {.s = NULL};
        mt_report_doubt(&items[i], doubts, &text);
        add_item(text.s == NULL ? "" : text.s, out);
        out->failed = out->failed || text.failed;
        mt_text_free(&text);
    }
    mt_text_add(out, "</ul>\n");
}

static void add_footer(const mt_result_run *run, mt_text *out)
{
    mt_text_add(out, "<footer>modetune ");
    mt_html_escape(run->modetune_version == NULL ? "" : run->modetune_version, out);
    mt_text_add(out, " (");
    mt_html_escape(run->build.commit == NULL ? "" : run->build.commit, out);
    mt_text_addf(out, "), seed %ld, %ld evaluations from %d starts.", run->seed,
                 run->evaluations, run->starts);
    for (int i = 0; i < run->n_inputs; i++) {
        mt_text_add(out, "<br>");
        mt_html_escape(run->inputs[i].file, out);
        mt_text_add(out, ": sha256 ");
        mt_html_escape(run->inputs[i].sha256, out);
    }
    mt_text_add(out, "</footer>\n");
}

void mt_report_html(const mt_result *result, mt_text *out)
{
    const char *const name = result->study.name != NULL   ? result->study.name
                             : result->study.file != NULL ? result->study.file
                                                          : "study";
    const char *const status = mt_result_status_name(result->status);
    mt_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width\">\n<title>");
    mt_html_escape(name, out);
    mt_text_addf(out, "</title>\n<style>%s</style>\n</head>\n<body>\n<h1>", STYLE);
    mt_html_escape(name, out);
    mt_text_addf(out, "</h1>\n<p class=\"status %s\"><b>%s</b>. ", status, status);
    mt_html_escape(result->status_text == NULL ? "" : result->status_text, out);
    mt_text_add(out, "</p>\n");
    add_doubts(result->n_doubts, result->doubts, true, out);
    add_doubts(result->n_facts, result->facts, false, out);
    add_best(result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline,
             out);
    mt_report_svg_campbell(result, out);
    if (result->n_recommendations > 1) {
        add_table(mt_report_alternatives(result), "All recommendations", out);
    }
    add_undetermined(result, out);
    add_table(mt_report_spread(result), "Spread under other weights", out);
    add_table(mt_report_trade(result), "Trade study: the best design of each point", out);
    mt_report_svg_trade(result, out);
    add_certificates(result, out);
    add_relaxations(result, out);
    add_table(mt_report_published(result), "Published against computed", out);
    add_list(result->n_warnings, result->warnings, "Warnings", out);
    add_footer(&result->run, out);
    mt_text_add(out, "</body>\n</html>\n");
}
