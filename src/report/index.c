/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several studies in one table. */
#include "report/index.h"

#include "report/number.h"
#include "report/page.h"

enum { CHANGE_DIGITS = 4, TIME_DIGITS = 3 };

mt_table mt_report_index(const mt_index_study *studies, int n)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "study", "study", MT_ALIGN_LEFT);
    mt_table_column(&t, "status", "status", MT_ALIGN_LEFT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    mt_table_column(&t, "change", "change", MT_ALIGN_POINT);
    mt_table_column(&t, "time [s]", "time_s", MT_ALIGN_POINT);
    for (int i = 0; i < n; i++) {
        const mt_index_study *const s = &studies[i];
        mt_table_text(&t, s->path);
        mt_table_text(&t, s->status == NULL ? s->state : s->status);
        mt_table_text(&t, s->grade);
        mt_table_number(&t, s->change, CHANGE_DIGITS);
        mt_table_number(&t, s->seconds, TIME_DIGITS);
    }
    return t;
}

static void add_cell(const char *text, mt_text *out)
{
    mt_text_add(out, "<td>");
    mt_html_escape(text == NULL ? "-" : text, out);
    mt_text_add(out, "</td>");
}

static void add_study(const mt_index_study *s, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    mt_text_add(out, "<tr><td>");
    if (s->has_report) {
        mt_text_add(out, "<a href=\"");
        mt_text_add_uri(out, s->folder);
        mt_text_add(out, "/report.html\">");
    }
    mt_html_escape(s->file, out);
    mt_text_add(out, s->has_report ? "</a></td>" : "</td>");
    add_cell(s->name, out);
    add_cell(s->status == NULL ? s->state : s->status, out);
    add_cell(s->grade, out);
    mt_text_add(out, "<td class=\"n\">");
    mt_text_add(out, mt_report_number(s->change, CHANGE_DIGITS, number));
    mt_text_add(out, "</td>");
    add_cell(s->message == NULL ? "" : s->message, out);
    mt_text_add(out, "</tr>\n");
}

void mt_report_index_html(const mt_index_study *studies, int n, mt_text *out)
{
    mt_page_begin(MT_PAGE_PLAIN, "Studies", out);
    mt_text_add(out, "<table>\n<thead><tr><th>study</th><th>name</th><th>status</th>"
                     "<th>grade</th><th class=\"n\">change</th><th></th></tr></thead>\n"
                     "<tbody>\n");
    for (int i = 0; i < n; i++) {
        add_study(&studies[i], out);
    }
    mt_text_add(out, "</tbody>\n</table>\n");
    mt_page_end(0, NULL, out);
}
