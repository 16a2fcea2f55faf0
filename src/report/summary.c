/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/summary.h"

#include <math.h>

#include "report/number.h"
#include "report/result_tables.h"
#include "report/trade.h"

enum { INDENT = 2, DIGITS = 4 };

static void print_table(mt_table t, const char *title, mt_text *out)
{
    if (mt_table_rows(&t) > 0 || t.failed) {
        mt_text_addf(out, "\n%s\n", title);
        mt_table_print(&t, INDENT, out);
    }
    mt_table_free(&t);
}

static void print_list(int n, const char *const *items, const char *title, mt_text *out)
{
    if (n > 0) {
        mt_text_addf(out, "\n%s\n", title);
    }
    for (int i = 0; i < n; i++) {
        mt_text_addf(out, "  - %s\n", items[i]);
    }
}

/* "stick.json:12:9: " as far as it is known. */
static void print_place(const mt_doubt *d, mt_text *out)
{
    if (d->file != NULL) {
        mt_text_addf(out, "%s", d->file);
        if (d->line > 0) {
            mt_text_addf(out, ":%d:%d", d->line, d->column);
        }
        mt_text_add(out, ": ");
    }
    if (d->pointer != NULL && d->pointer[0] != '\0') {
        mt_text_addf(out, "%s: ", d->pointer);
    }
}

void mt_report_doubt(const mt_doubt *d, bool with_place, mt_text *out)
{
    if (with_place) {
        print_place(d, out);
    }
    if (d->configuration != NULL) {
        mt_text_addf(out, "%s: ", d->configuration);
    }
    mt_text_addf(out, "%s", d->text);
}

bool mt_report_doubtful(const mt_result *result)
{
    return result->n_doubts > 0;
}

const char *mt_report_surety(bool proven, bool doubtful)
{
    if (!proven) {
        return "sampled";
    }
    return doubtful ? "proven of the question as it stands, which is doubtful" : "proven";
}

static void print_doubts(int n, const mt_doubt *items, bool doubts, mt_text *out)
{
    if (n > 0) {
        mt_text_add(out, doubts ? "\nDoubts\n" : "\nFacts of the model\n");
    }
    for (int i = 0; i < n; i++) {
        mt_text_add(out, "  - ");
        mt_report_doubt(&items[i], doubts, out);
        mt_text_add(out, "\n");
    }
}

void mt_report_doubts(const mt_result *result, mt_text *out)
{
    print_doubts(result->n_doubts, result->doubts, true, out);
    print_doubts(result->n_facts, result->facts, false, out);
}

void mt_report_objectives_text(const mt_recommendation *r, mt_text *out)
{
    print_table(mt_report_objectives(r), "Objectives", out);
}

static void print_best(const mt_recommendation *r, mt_text *out)
{
    if (r->n_parameters > 0) {
        char change[MT_NUMBER_TEXT];
        mt_text_addf(out, "\nRecommendation %d (%s), size of the redesign %s%s\n", r->rank,
                     r->grade == NULL ? "not graded" : r->grade,
                     mt_report_number(r->change, DIGITS, change),
                     r->singular ? ", a double solution: its parameters are sensitive" : "");
    }
    if (r->n_objectives != 1 || r->objectives[0].recommended != r->change) {
        mt_report_objectives_text(r, out); /* else the size of the redesign is all */
    }
    print_table(mt_report_parameters(r), "Parameters", out);
    for (int i = 0; i < r->n_parameters; i++) {
        mt_text line = {0};
        if (mt_report_measure(&r->parameters[i], &line)) {
            mt_text_addf(out, "  %s\n", line.s == NULL ? "" : line.s);
        }
        out->failed = out->failed || line.failed;
        mt_text_free(&line);
    }
    print_table(mt_report_frequencies(r), "Frequencies", out);
    print_table(mt_report_clearances(r), "Clearances from bands", out);
    print_table(mt_report_motions(r), "Over the range of motion", out);
    print_table(mt_report_goals(r), "Goals", out);
    print_list(r->n_reasons, r->reasons, "Why", out);
}

void mt_report_uncertainty(const mt_result *result, mt_text *out)
{
    if (result->n_undetermined > 0) {
        mt_text_add(out, "\nUndetermined: the goals hardly change along\n");
    }
    for (int i = 0; i < result->n_undetermined; i++) {
        const mt_undetermined *const u = &result->undetermined[i];
        mt_text_addf(out, "  - %s", u->text);
        if (!isnan(u->effect_percent)) {
            char effect[MT_NUMBER_TEXT];
            mt_text_addf(out, " (at most %s %% from bound to bound)",
                         mt_report_number(u->effect_percent, DIGITS, effect));
        }
        mt_text_add(out, "\n");
    }
    print_table(mt_report_spread(result), "Spread under other weights", out);
}

void mt_report_summary(const mt_result *result, bool with_published, mt_text *out)
{
    const char *const name =
        result->study.name == NULL ? result->study.file : result->study.name;
    mt_text_addf(out, "%s\n%s\n", name == NULL ? "study" : name,
                 result->status_text == NULL ? mt_result_status_name(result->status)
                                             : result->status_text);
    mt_report_doubts(result, out);
    const bool doubtful = mt_report_doubtful(result);
    if (result->n_recommendations > 0) {
        print_best(&result->recommendations[0], out);
    } else {
        mt_report_objectives_text(&result->baseline, out);
        print_table(mt_report_frequencies(&result->baseline), "Frequencies as they are", out);
        print_table(mt_report_clearances(&result->baseline), "Clearances from bands", out);
        print_table(mt_report_goals(&result->baseline), "Goals", out);
        print_list(result->baseline.n_reasons, result->baseline.reasons, "Why", out);
    }
    if (result->n_recommendations > 1) {
        print_table(mt_report_alternatives(result), "All recommendations", out);
    }
    mt_report_uncertainty(result, out);
    print_table(mt_report_trade(result), "Trade study: the best design of each point", out);
    if (result->n_certificates > 0) {
        mt_text_add(out, "\nCertificates\n");
    }
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        mt_text_addf(out, "  - %s: %s\n", mt_report_surety(c->proven, doubtful), c->text);
    }
    if (result->n_relaxations > 0) {
        mt_text_add(out, "\nWhat would let a design exist, one change at a time\n");
    }
    for (int i = 0; i < result->n_relaxations; i++) {
        mt_text_addf(out, "  - %s\n", result->relaxations[i].text);
    }
    if (with_published) {
        print_table(mt_report_published(result), "Published against computed", out);
    }
    print_list(result->n_warnings, result->warnings, "Warnings", out);
}
