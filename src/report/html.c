/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of a study as one page: what was asked, what to change, why, and how far to trust
 * it. */
#include "report/html.h"

#include "base/base.h"
#include "report/abstract.h"
#include "report/page.h"
#include "report/summary.h"
#include "report/table.h"
#include "report/title.h"

static void add_footer(const mt_result_run *run, mt_text *out)
{
    mt_text_add(out, "<footer class=\"drawn\">modetune ");
    mt_html_escape(run->modetune_version == NULL ? "" : run->modetune_version, out);
    mt_text_add(out, " (");
    mt_html_escape(run->build.commit == NULL ? "" : run->build.commit, out);
    mt_text_addf(out, "), seed %ld, %d starts, ", run->seed, run->starts);
    mt_report_work_counters(run, out);
    mt_text_add(out, ".");
    for (int i = 0; i < run->n_inputs; i++) {
        mt_text_add(out, "<br>");
        mt_html_escape(run->inputs[i].file, out);
        mt_text_add(out, ": sha256 ");
        mt_html_escape(run->inputs[i].sha256, out);
    }
    mt_text_add(out, "</footer>\n");
}

void mt_report_html_told(const mt_result *result, mt_text *out)
{
    mt_report_title(result, out);
    mt_report_abstract(result, out);
    mt_text_add(out, "<noscript><p>Figures are drawn by the page's own script, which is "
                     "switched off here.</p></noscript>\n");
    mt_write_page(out, result);
    add_footer(&result->run, out);
}

void mt_report_html(const mt_result *result, const char *json, const char *scene, mt_text *out)
{
    const mt_page_data data[] = {{"data", json}, {"scene", scene}};
    const char *const name = result->study.name != NULL   ? result->study.name
                             : result->study.file != NULL ? result->study.file
                                                          : "study";
    const mt_page_kind kind = scene == NULL ? MT_PAGE_REPORT : MT_PAGE_REPORT_SCENE;
    mt_page_begin(kind, name, out);
    mt_report_html_told(result, out);
    mt_page_end(MT_COUNT(data), data, out);
}
