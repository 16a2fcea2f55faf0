/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sections of a summary are made of, and what a run says of itself. */
#include "report/section.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "report/table.h"

enum { INDENT = 2 };

void mt_section_heading(const mt_summary_writer *to, const char *title)
{
    if (to->html) {
        mt_text_add(to->out, "<h2>");
        mt_html_escape(title, to->out);
        mt_text_add(to->out, "</h2>\n");
    } else {
        mt_text_addf(to->out, "\n%s\n", title);
    }
}

void mt_section_table(const mt_summary_writer *to, mt_table t, const char *title)
{
    if (mt_table_rows(&t) > 0 || t.failed) {
        mt_section_heading(to, title);
        if (to->html) {
            mt_table_html(&t, to->out);
        } else {
            mt_table_print(&t, INDENT, to->width, to->out);
        }
    }
    mt_table_free(&t);
}

void mt_section_paragraph(const mt_summary_writer *to, const char *indent, mt_text *line)
{
    const char *const text = line->s == NULL ? "" : line->s;
    if (to->html) {
        mt_text_add(to->out, "<p>");
        mt_html_escape(text, to->out);
        mt_text_add(to->out, "</p>\n");
    } else {
        mt_text_addf(to->out, "%s%s\n", indent, text);
    }
    to->out->failed = to->out->failed || line->failed;
    mt_text_free(line);
}

bool mt_section_open(const mt_summary_writer *to, const char *title, int n)
{
    if (n > 0) {
        mt_section_heading(to, title);
        mt_text_add(to->out, to->html ? "<ul>\n" : "");
    }
    return n > 0;
}

void mt_section_close(const mt_summary_writer *to)
{
    mt_text_add(to->out, to->html ? "</ul>\n" : "");
}

void mt_section_item(const mt_summary_writer *to, const char *word, const char *text)
{
    const char *const colon = word[0] == '\0' ? "" : ": ";
    if (to->html) {
        mt_text_addf(to->out, word[0] == '\0' ? "<li>%s%s" : "<li><b>%s</b>%s", word, colon);
        mt_html_escape(text, to->out);
        mt_text_add(to->out, "</li>\n");
    } else {
        mt_text_addf(to->out, "  - %s%s%s\n", word, colon, text);
    }
}

void mt_section_made(const mt_summary_writer *to, mt_text *text)
{
    mt_section_item(to, "", text->s == NULL ? "" : text->s);
    to->out->failed = to->out->failed || text->failed;
    mt_text_free(text);
}

/* Warnings and notes. */

void mt_report_warning(const mt_warning *d, bool with_place, mt_text *out)
{
    if (with_place && d->file != NULL) { /* "stick.json:12:9: " as far as it is known */
        mt_text_addf(out, "%s", d->file);
        if (d->line > 0) {
            mt_text_addf(out, ":%d:%d", d->line, d->column);
        }
        mt_text_add(out, ": ");
    }
    if (with_place && d->pointer != NULL && d->pointer[0] != '\0') {
        mt_text_addf(out, "%s: ", d->pointer);
    }
    if (d->configuration != NULL) {
        mt_text_addf(out, "%s: ", d->configuration);
    }
    mt_text_addf(out, "%s", d->text);
}

static void add_warnings(const mt_summary_writer *to, const char *title, int n,
                         const mt_warning *items)
{
    if (mt_section_open(to, title, n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            mt_report_warning(&items[i], true, &text);
            mt_section_made(to, &text);
        }
        mt_section_close(to);
    }
}

/* True where both notes have the same text, in any configuration. */
static bool is_same_fact(const mt_warning *a, const mt_warning *b)
{
    return a->configuration != NULL && b->configuration != NULL &&
           strcmp(a->text, b->text) == 0;
}

/* Write note i with all configurations that have it; nothing where an earlier one has listed
 * it. */
static void write_fact(int i, int n, const mt_warning *items, mt_text *text)
{
    for (int k = 0; k < i; k++) {
        if (is_same_fact(&items[k], &items[i])) {
            return;
        }
    }
    for (int k = i; k < n && items[i].configuration != NULL; k++) {
        if (k == i || is_same_fact(&items[i], &items[k])) {
            mt_text_addf(text, "%s%s", k == i ? "" : ", ", items[k].configuration);
        }
    }
    mt_text_addf(text, "%s%s", items[i].configuration == NULL ? "" : ": ", items[i].text);
}

void mt_write_facts(const mt_summary_writer *to, int n, const mt_warning *items)
{
    if (mt_section_open(to, "Notes on the model", n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            write_fact(i, n, items, &text);
            if (text.s != NULL || text.failed) {
                mt_section_made(to, &text);
            }
        }
        mt_section_close(to);
    }
}

void mt_tell_warnings(const mt_summary_writer *to, const mt_result *result)
{
    if (result->n_doubts > 0 && to->html) {
        mt_text_add(to->out, "<div class=\"doubts\">\n");
    }
    add_warnings(to, "Warnings of the model and the study", result->n_doubts, result->doubts);
    if (result->n_doubts > 0 && to->html) {
        mt_text_add(to->out, "</div>\n");
    }
    if (!to->html) { /* a page tells them with its warnings */
        mt_write_facts(to, result->n_facts, result->facts);
    }
}

/* The run. */

void mt_write_overrides(const mt_summary_writer *to, const mt_result_run *run)
{
    mt_text line = {.s = NULL};
    for (int i = 0; i < run->n_overrides; i++) {
        const mt_result_override *const o = &run->overrides[i];
        const bool parameter = strcmp(o->kind, "parameter") == 0;
        const char *const unit = o->display_unit != NULL ? o->display_unit : o->unit;
        mt_text_addf(&line, "%s%s%s = %.10g", i == 0 ? "Asked with " : ", ",
                     parameter ? "" : "search ", o->name,
                     mt_result_shown(o->value, o->display_factor));
        mt_text_addf(&line, parameter && unit != NULL ? " %s" : "%s",
                     parameter && unit != NULL ? unit : "");
        if (!isnan(o->original)) {
            mt_text_addf(&line, " (%s: %.10g)", parameter ? "model" : "study",
                         mt_result_shown(o->original, o->display_factor));
        }
    }
    if (run->n_overrides > 0) {
        mt_text_add(&line, ".");
        mt_section_paragraph(to, "", &line);
    }
}

void mt_report_work_counters(const mt_result_run *run, mt_text *out)
{
    const mt_result_work_counters *const s = &run->spent;
    const struct {
        const char *name;
        long n;
    } parts[] = {{"search", s->search},
                 {"positions", s->positions},
                 {"descriptions", s->descriptions},
                 {"spread", s->weight_sensitivity},
                 {"relaxations", s->relaxations},
                 {"trade", s->trade}};
    int told = 0;
    mt_text_addf(out, "%ld evaluations", run->evaluations);
    for (int i = 0; i < MT_COUNT(parts); i++) {
        if (parts[i].n > 0) {
            mt_text_addf(out, "%s%s %ld", told++ == 0 ? " (" : ", ", parts[i].name, parts[i].n);
        }
    }
    mt_text_add(out, told > 0 ? ")" : "");
    if (run->modal_solutions >= 0) { /* an earlier program did not count them */
        mt_text_addf(out, ", %ld modal solutions", run->modal_solutions);
    }
    if (s->multiplications > 0) {
        char work[MT_NUMBER_TEXT];
        mt_text_addf(out, ", %s multiplications of proofs",
                     mt_report_number((double)s->multiplications, 2, work));
    }
}
