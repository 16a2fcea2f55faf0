/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/abstract.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/base.h"
#include "base/number.h"
#include "report/number.h"
#include "report/result_tables.h"
#include "report/table.h"

enum { LISTED = 4, DIGITS = 3, VALUE_DIGITS = 4 };

/* "Solved: 2 designs ...": its first word is the status, and stands out. */
static void add_status(const mt_result *result, mt_text *out)
{
    const char *const status = mt_result_status_name(result->status);
    const char *const text = result->status_text == NULL ? "" : result->status_text;
    const size_t length = strlen(status);
    const bool led = strncasecmp(text, status, length) == 0;
    mt_text_addf(out, "<p class=\"status %s\"><b>", status);
    if (led) {
        mt_text_add_n(out, text, length);
    } else {
        mt_text_add(out, status);
    }
    mt_text_add(out, led ? "</b>" : "</b>: ");
    mt_html_escape(text + (led ? length : 0), out);
    mt_text_add(out, "</p>\n");
}

static void open_item(const char *word, mt_text *out)
{
    mt_text_addf(out, "<li><b>%s</b>: ", word);
}

static void close_item(mt_text *out)
{
    mt_text_add(out, "</li>\n");
}

/* Size of a change for sorting: a change from 0, which has no percentage, is the largest. */
static double change_size(const mt_result_parameter *p)
{
    const bool moved = p->recommended < p->original || p->recommended > p->original;
    return isfinite(p->change_percent) ? fabs(p->change_percent) : moved ? HUGE_VAL : 0.0;
}

/* "k +8.21 %", "k to 3.00 N/m" */
static void add_change(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    mt_html_escape(p->name, out);
    if (isfinite(p->change_percent)) {
        mt_text_addf(out, " %s %%", mt_report_change(p->change_percent, DIGITS, number));
        return;
    }
    mt_text_addf(out, " to %s", mt_report_number(p->recommended, DIGITS, number));
    if (p->unit != NULL && p->unit[0] != '\0') {
        mt_text_add(out, " ");
        mt_html_escape(p->unit, out);
    }
}

/* The parameter with the largest change among those that come behind `last`; -1: none. Equal
 * ones as they stand. */
static int next_largest(const mt_recommendation *r, int last)
{
    int found = -1;
    for (int i = 0; i < r->n_parameters; i++) {
        const double size = change_size(&r->parameters[i]);
        const double before = last < 0 ? HUGE_VAL : change_size(&r->parameters[last]);
        const bool behind = size < before || (size == before && i > last);
        if (size > 0.0 && behind && (found < 0 || size > change_size(&r->parameters[found]))) {
            found = i;
        }
    }
    return found;
}

static void add_changes(const mt_recommendation *r, mt_text *out)
{
    int changed = 0;
    for (int i = 0; i < r->n_parameters; i++) {
        changed += change_size(&r->parameters[i]) > 0.0 ? 1 : 0;
    }
    int told = 0;
    for (int i = next_largest(r, -1); i >= 0 && told < LISTED; i = next_largest(r, i)) {
        mt_text_add(out, told++ == 0 ? "" : ", ");
        add_change(&r->parameters[i], out);
    }
    if (changed > told) {
        mt_text_addf(out, " and %d other%s", changed - told, changed - told == 1 ? "" : "s");
    }
    mt_text_add(out, changed == 0 ? "no parameter changes" : "");
}

bool mt_report_headline(const mt_recommendation *r, mt_text *out)
{
    char now[MT_NUMBER_TEXT];
    const mt_design_objective *const o = r->n_objectives > 0 ? &r->objectives[0] : NULL;
    if (o == NULL || !isfinite(o->recommended) || o->recommended == r->change) {
        return false;
    }
    mt_text_addf(
        out, "%s %s%s%s", o->text,
        mt_report_number(mt_report_objective_value(o->unit, o->recommended), VALUE_DIGITS, now),
        o->unit != NULL && o->unit[0] != '\0' ? " " : "", o->unit != NULL ? o->unit : "");
    if (isfinite(o->original)) {
        char was[MT_NUMBER_TEXT];
        mt_text_addf(out, " (was %s)",
                     mt_report_number(mt_report_objective_value(o->unit, o->original),
                                      VALUE_DIGITS, was));
    }
    return true;
}

static void add_best(const mt_recommendation *r, mt_text *out)
{
    char change[MT_NUMBER_TEXT];
    mt_text headline = {.s = NULL};
    open_item("Best design", out);
    if (mt_report_headline(r, &headline)) {
        mt_html_escape(headline.s == NULL ? "" : headline.s, out);
        mt_text_add(out, "; ");
    }
    out->failed = out->failed || headline.failed;
    mt_text_free(&headline);
    add_changes(r, out);
    mt_text_add(out, ". Graded ");
    mt_html_escape(r->grade == NULL ? "not at all" : r->grade, out);
    mt_text_addf(out, "; total change %s.", mt_report_number(r->change, DIGITS, change));
    close_item(out);
}

/* Add the goals that decide the status, those without weights. */
static void add_goals(const mt_recommendation *r, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    int n = 0;
    int met = 0;
    for (int i = 0; i < r->n_goals; i++) {
        n += r->goals[i].weighted ? 0 : 1;
        met += !r->goals[i].weighted && r->goals[i].met ? 1 : 0;
    }
    if (n == 0 && isnan(r->misfit)) {
        return;
    }
    open_item("Goals", out);
    if (n > 0 && met == n) {
        mt_text_addf(out, n == 1 ? "the goal is met" : "all %d are met", n);
    } else if (n > 0) {
        mt_report_number(r->violation_percent, DIGITS, number);
        if (n == 1) {
            mt_text_addf(out, "the goal is missed by %s %%", number);
        } else {
            mt_text_addf(out, "%d of %d are met, others missed by %s %% at most", met, n,
                         number);
        }
    }
    if (!isnan(r->clearance_percent)) {
        mt_text_addf(out, "%s the least clearance from a band is %s %%", n > 0 ? ";" : "",
                     mt_report_number(r->clearance_percent, DIGITS, number));
    }
    if (!isnan(r->misfit)) {
        mt_text_addf(
            out, "%s the misfit is %s", n > 0 ? ";" : "",
            mt_report_number(mt_without_noise(r->misfit, MT_RATIO_NOISE), DIGITS, number));
    }
    mt_text_add(out, ".");
    close_item(out);
}

/* Add what is proven, in full; the unproven statements are many, and follow below. */
static void add_proof(const mt_result *result, mt_text *out)
{
    int sampled = 0;
    int proven = 0;
    for (int i = 0; i < result->n_certificates; i++) {
        const mt_certificate *const c = &result->certificates[i];
        sampled += c->proven ? 0 : 1;
        if (c->proven && proven < LISTED) {
            if (proven++ == 0) {
                open_item("Proven", out);
            } else {
                mt_text_add(out, " ");
            }
            mt_html_escape(c->text, out);
        }
    }
    if (proven > 0) {
        close_item(out);
        return;
    }
    const char *const grade = result->recommendations[0].grade;
    const bool best = grade != NULL && strcmp(grade, "feasible and proven") == 0;
    open_item("Proven", out);
    mt_text_add(out, best                           ? "that the best design meets the goals."
                     : result->certificates == NULL ? "nothing: the run was stopped before."
                     : sampled > 0
                         ? "nothing; what was sampled is listed below."
                         : "nothing; designs were found by local searches from many starts.");
    close_item(out);
}

static void add_others(const mt_result *result, mt_text *out)
{
    const int others = result->n_recommendations - 1;
    if (others > 0) {
        open_item("Alternatives", out);
        mt_text_addf(out, "%d other recommendation%s.", others, others == 1 ? "" : "s");
        close_item(out);
    }
}

void mt_report_abstract(const mt_result *result, mt_text *out)
{
    add_status(result, out);
    if (result->n_recommendations == 0) {
        return;
    }
    mt_text_add(out, "<ul class=\"gist\">\n");
    add_best(&result->recommendations[0], out);
    add_goals(&result->recommendations[0], out);
    add_proof(result, out);
    add_others(result, out);
    mt_text_add(out, "</ul>\n");
}
