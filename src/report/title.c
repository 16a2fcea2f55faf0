/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/title.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "report/question.h"
#include "report/table.h"

enum {
    INLINE = 6,  /* assumptions that a block has room for; more fold away */
    DIGEST = 12, /* of SHA-256: tells two issues of a file apart */
    VALUE_DIGITS = 6
};

static void open_definition(const char *term, mt_text *out)
{
    mt_text_addf(out, "<dt>%s</dt><dd>", term);
}

static void add_text(const char *term, const char *text, mt_text *out)
{
    if (text != NULL && text[0] != '\0') {
        open_definition(term, out);
        mt_html_escape(text, out);
        mt_text_add(out, "</dd>\n");
    }
}

/* "Inceptor (../problems/inceptor.json, SHA-256 e3b0c44298fc)" */
static void add_model(const mt_result *result, mt_text *out)
{
    const mt_result_source *const m = &result->model;
    if (m->file == NULL) {
        return;
    }
    open_definition("Model", out);
    mt_html_escape(m->name != NULL ? m->name : m->file, out);
    mt_text_add(out, m->name != NULL ? " (" : "");
    mt_html_escape(m->name != NULL ? m->file : "", out);
    for (int i = 0; i < result->run.n_inputs; i++) {
        const mt_result_digest *const d = &result->run.inputs[i];
        if (strcmp(d->file, m->file) == 0) {
            mt_text_addf(out, ", SHA-256 %.*s", DIGEST, d->sha256);
            break;
        }
    }
    mt_text_add(out, m->name != NULL ? ")</dd>\n" : "</dd>\n");
}

/* "k = 1200 N/m (Fig. 16)" */
static void add_assumption(const mt_result_assumption *a, mt_text *out)
{
    const char *const unit = a->display_unit != NULL ? a->display_unit : a->unit;
    const double value = mt_result_shown(a->value, a->display_factor);
    mt_html_escape(a->parameter, out);
    if (isfinite(value)) {
        mt_text_addf(out, " = %.*g", VALUE_DIGITS, value); /* no column: without its zeros */
        if (unit != NULL && unit[0] != '\0' && strcmp(unit, "1") != 0) {
            mt_text_add(out, " ");
            mt_html_escape(unit, out);
        }
    }
    if (a->source != NULL || a->variable) {
        mt_text_add(out, " (");
        mt_html_escape(a->source != NULL ? a->source : "", out);
        mt_text_add(out, a->source != NULL && a->variable ? "; " : "");
        mt_text_add(out, a->variable ? "before the change" : "");
        mt_text_add(out, ")");
    }
}

static void add_assumptions(const mt_result *result, mt_text *out)
{
    const int n = result->n_assumptions;
    if (n == 0) {
        return;
    }
    open_definition("Assumed", out);
    if (n > INLINE) {
        mt_text_addf(out, "<details><summary>%d parameters of the model</summary>\n", n);
    }
    for (int i = 0; i < n; i++) {
        mt_text_add(out, i == 0 ? "" : "; ");
        add_assumption(&result->assumptions[i], out);
    }
    mt_text_add(out, n > INLINE ? "</details></dd>\n" : "</dd>\n");
}

void mt_report_title(const mt_result *result, mt_text *out)
{
    mt_text question = {.s = NULL};
    mt_report_question(result, &question);
    mt_text_add(out, "<dl class=\"title\">\n");
    add_text("Question", question.s, out);
    add_text("Study", result->study.file, out);
    add_text("Author", result->study.author, out);
    add_text("Revision", result->study.revision, out);
    add_text("Date", result->study.date, out);
    add_model(result, out);
    add_assumptions(result, out);
    mt_text_add(out, "</dl>\n");
    out->failed = out->failed || question.failed;
    mt_text_free(&question);
}
