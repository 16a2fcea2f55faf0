/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/summary.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "report/abstract.h"
#include "report/compliance.h"
#include "report/curves.h"
#include "report/number.h"
#include "report/result_tables.h"
#include "report/ruler.h"
#include "report/trade.h"

enum {
    INDENT = 2,
    DIGITS = 4,
    SHOWN = 20 /* of more designs a page draws figures only */
};

static void add_heading(const mt_summary_writer *to, const char *title)
{
    if (to->html) {
        mt_text_add(to->out, "<h2>");
        mt_html_escape(title, to->out);
        mt_text_add(to->out, "</h2>\n");
    } else {
        mt_text_addf(to->out, "\n%s\n", title);
    }
}

static void add_table(const mt_summary_writer *to, mt_table t, const char *title)
{
    if (mt_table_rows(&t) > 0 || t.failed) {
        add_heading(to, title);
        if (to->html) {
            mt_table_html(&t, to->out);
        } else {
            mt_table_print(&t, INDENT, to->width, to->out);
        }
    }
    mt_table_free(&t);
}

/* A paragraph, of which `line` is the text; freed. */
static void add_paragraph(const mt_summary_writer *to, const char *indent, mt_text *line)
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

static void add_indented_paragraph(const mt_summary_writer *to, mt_text *line)
{
    add_paragraph(to, "  ", line);
}

/* True where the section was computed. A section that a stopped run left out says so. */
static bool is_section_known(const mt_summary_writer *to, const char *title, const void *items)
{
    if (items == NULL) {
        mt_text line = {0};
        mt_text_add(&line, "not computed: the run was stopped before");
        add_heading(to, title);
        add_indented_paragraph(to, &line);
    }
    return items != NULL;
}

/* The head of a list of n items; false where there are none. */
static bool open_list(const mt_summary_writer *to, const char *title, int n)
{
    if (n > 0) {
        add_heading(to, title);
        mt_text_add(to->out, to->html ? "<ul>\n" : "");
    }
    return n > 0;
}

static void close_list(const mt_summary_writer *to)
{
    mt_text_add(to->out, to->html ? "</ul>\n" : "");
}

/* word: before the text, in bold; "": none */
static void add_item(const mt_summary_writer *to, const char *word, const char *text)
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

static void write_ruler(const mt_summary_writer *to, const mt_recommendation *r)
{
    mt_text ruler = {.s = NULL};
    mt_report_ruler(r, to->width, &ruler);
    if (ruler.s != NULL) {
        add_heading(to, "Frequency ruler");
        mt_text_add(to->out, ruler.s);
    }
    to->out->failed = to->out->failed || ruler.failed;
    mt_text_free(&ruler);
}

/* Write the reasons of a design. */
static void write_reasons(const mt_summary_writer *to, const mt_recommendation *r)
{
    static const struct {
        const char *kind;
        const char *title;
    } parts[] = {{"change", "Why: what changes"},
                 {"hold", "Why: what holds it"},
                 {"cost", "Why: what it costs"},
                 {"rank", "Why: how it stands"}};
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "<div class=\"parts\">\n" : "");
    for (int k = 0; k < MT_COUNT(parts); k++) {
        bool open = false;
        for (int i = 0; i < r->n_reasons; i++) {
            if (strcmp(r->reasons[i].kind, parts[k].kind) == 0) {
                mt_text_add(to->out, to->html && !open ? "<div>" : "");
                open = open || open_list(to, parts[k].title, 1);
                add_item(to, "", r->reasons[i].text);
            }
        }
        if (open) {
            close_list(to);
            mt_text_add(to->out, to->html ? "</div>\n" : "");
        }
    }
    mt_text_add(to->out, to->html && r->n_reasons > 0 ? "</div>\n" : "");
}

/* Add an item of a text that is freed afterwards. */
static void add_made(const mt_summary_writer *to, mt_text *text)
{
    add_item(to, "", text->s == NULL ? "" : text->s);
    to->out->failed = to->out->failed || text->failed;
    mt_text_free(text);
}

static void add_sentences(const mt_summary_writer *to, const char *title, int n,
                          const char *const *items)
{
    if (open_list(to, title, n)) {
        for (int i = 0; i < n; i++) {
            add_item(to, "", items[i]);
        }
        close_list(to);
    }
}

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
    if (open_list(to, title, n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            mt_report_warning(&items[i], true, &text);
            add_made(to, &text);
        }
        close_list(to);
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

static void write_facts(const mt_summary_writer *to, int n, const mt_warning *items)
{
    if (open_list(to, "Notes on the model", n)) {
        for (int i = 0; i < n; i++) {
            mt_text text = {.s = NULL};
            write_fact(i, n, items, &text);
            if (text.s != NULL || text.failed) {
                add_made(to, &text);
            }
        }
        close_list(to);
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
        write_facts(to, result->n_facts, result->facts);
    }
}

void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r)
{
    add_table(to, mt_report_objectives(r), "Objectives");
}

static void write_parameters(const mt_summary_writer *to, const mt_recommendation *r)
{
    add_table(to, mt_report_parameters(r), "Parameters");
    for (int i = 0; i < r->n_parameters; i++) {
        mt_text line = {0};
        if (mt_report_measure(&r->parameters[i], &line)) {
            add_indented_paragraph(to, &line);
        }
    }
}

/* "Recommendation 1 (feasible): mass 16.94 kg (was 11.92), total change 0.0828" */
static void write_rank(const mt_summary_writer *to, const mt_recommendation *r)
{
    char change[MT_NUMBER_TEXT];
    mt_text title = {0};
    mt_text headline = {0};
    mt_text_addf(&title, "Recommendation %d (%s)", r->rank,
                 r->grade == NULL ? "not graded" : r->grade);
    mt_text_add(&title, mt_report_headline(r, &headline) ? ": " : "");
    mt_text_add(&title, headline.s == NULL ? "" : headline.s);
    mt_text_addf(&title, ", total change %s%s", mt_report_number(r->change, DIGITS, change),
                 r->singular ? ", a double solution: its parameters are sensitive" : "");
    add_heading(to, title.s == NULL ? "" : title.s);
    to->out->failed = to->out->failed || title.failed || headline.failed;
    mt_text_free(&headline);
    mt_text_free(&title);
}

/* Its numbers; the original design has no parameters to tell. */
static void write_numbers(const mt_summary_writer *to, const mt_result *result,
                          const mt_recommendation *r)
{
    (void)result;
    const bool found = r->rank > 0;
    if (!(found && r->n_parameters > 0 && r->n_objectives == 1 &&
          r->objectives[0].recommended == r->change)) { /* else its heading has it */
        mt_write_objectives(to, r);
    }
    if (found) {
        write_parameters(to, r);
    }
    add_table(to, mt_report_frequencies(r),
              found ? "Frequencies" : "Frequencies of the original design");
    if (!to->html) {
        write_ruler(to, r);
    }
    if (to->html) {
        add_table(to, mt_report_placements(r), "Bands");
    }
    add_table(to, mt_report_clearances(r), "Clearances from bands");
    add_table(to, mt_report_motions(r), "Over the range of motion");
}

/* Write the requirements compared with this design. */
static void write_compliance(const mt_summary_writer *to, const mt_result *result,
                             const mt_recommendation *r)
{
    static const char title[] = "Requirements";
    if (!to->html) {
        add_table(to, mt_report_compliance(result, r), title);
        return;
    }
    mt_text_add(to->out, "<div class=\"compliance\">\n");
    add_table(to, mt_report_compliance(result, r), title);
    if (r->n_goals > 0) {
        mt_text_add(to->out, "<p class=\"lead\">Margin: what is left to the limit, in per "
                             "cent of it; below 0 the limit is exceeded.</p>\n");
    }
    mt_text_add(to->out, "</div>\n");
}

static void write_design(const mt_summary_writer *to, const mt_result *result,
                         const mt_recommendation *r)
{
    if (r->rank > 0 && r->n_parameters > 0) {
        write_rank(to, r);
    }
    write_compliance(to, result, r);
    write_numbers(to, result, r);
    write_reasons(to, r);
}

void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result)
{
    static const char unidentifiable[] =
        "Not identifiable: directions along which the goals hardly change";
    static const char weight_sensitivity[] =
        "Sensitivity to the weights (the scatter of repeated tests may be many times larger)";
    if (is_section_known(to, unidentifiable, result->unidentifiable) &&
        open_list(to, unidentifiable, result->n_unidentifiable)) {
        for (int i = 0; i < result->n_unidentifiable; i++) {
            const mt_unidentifiable_direction *const u = &result->unidentifiable[i];
            mt_text text = {0};
            mt_text_addf(&text, "%s", u->text);
            if (!isnan(u->effect_percent)) {
                char effect[MT_NUMBER_TEXT];
                mt_text_addf(&text, " (changes no goal by more than %s %% from bound to bound)",
                             mt_report_number(fmax(u->effect_percent, MT_PERCENT_NOISE), DIGITS,
                                              effect));
            }
            add_made(to, &text);
        }
        close_list(to);
    }
    if (is_section_known(to, weight_sensitivity, result->weight_sensitivity)) {
        add_table(to, mt_report_weight_sensitivity(result), weight_sensitivity);
    }
}

static void write_certificates(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What is proven";
    if (is_section_known(to, title, result->certificates) &&
        open_list(to, title, result->n_certificates)) {
        for (int i = 0; i < result->n_certificates; i++) {
            const mt_certificate *const c = &result->certificates[i];
            add_item(to, c->proven ? "proven" : "sampled", c->text);
        }
        close_list(to);
    }
}

static void write_trade(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "Trade study: the best design of each point";
    for (int i = 0; i < result->run.n_incomplete && result->trade == NULL; i++) {
        if (strcmp(result->run.incomplete[i], "trade") == 0) {
            (void)is_section_known(to, title, result->trade);
        }
    }
    if (result->trade != NULL) {
        mt_text line = {.s = NULL};
        add_table(to, mt_report_trade_selected(result), title);
        mt_report_trade_left(result, &line);
        if (line.length > 0 || line.failed) {
            add_paragraph(to, "  ", &line);
        }
    }
}

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
        add_paragraph(to, "", &line);
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
    mt_text_addf(out, ", %ld modal solutions", run->modal_solutions);
    if (s->multiplications > 0) {
        char work[MT_NUMBER_TEXT];
        mt_text_addf(out, ", %s multiplications of proofs",
                     mt_report_number((double)s->multiplications, 2, work));
    }
}

static void write_relaxations(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What would make it feasible, one change at a time";
    if (is_section_known(to, title, result->relaxations) &&
        open_list(to, title, result->n_relaxations)) {
        for (int i = 0; i < result->n_relaxations; i++) {
            add_item(to, "", result->relaxations[i].text);
        }
        close_list(to);
    }
}

static void write_published(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "Published against computed";
    if (is_section_known(to, title, result->published)) {
        add_table(to, mt_report_published(result), title);
    }
}

static void write_responses(const mt_summary_writer *to, const mt_result *result,
                            const mt_recommendation *r)
{
    if (open_list(to, "Responses", result->n_curves)) {
        for (int k = 0; k < result->n_curves; k++) {
            mt_text text = {.s = NULL};
            mt_report_curve(result, k, r, &text);
            add_made(to, &text);
        }
        close_list(to);
    }
}

/* Write the values of unchecked designs, of which nothing else is known. */
static void write_unchecked(const mt_summary_writer *to, const mt_result *result)
{
    if (open_list(to, "Not re-checked before the end: values of the variables, unverified",
                  result->n_unchecked)) {
        for (int i = 0; i < result->n_unchecked; i++) {
            mt_text text = {0};
            mt_text_addf(&text, "%s", result->unchecked[i].text);
            add_made(to, &text);
        }
        close_list(to);
    }
}

/* The best design (goals, frequencies, parameters, reasons), or the original one where there is
 * none; alternatives, directions that are not identifiable, what is proven, relaxations,
 * unchecked designs, warnings. */
static void write_answer(const mt_summary_writer *to, const mt_result *result,
                         bool with_published)
{
    mt_write_overrides(to, &result->run);
    mt_tell_warnings(to, result);
    const mt_recommendation *const best =
        result->n_recommendations > 0 ? &result->recommendations[0] : &result->baseline;
    write_design(to, result, best);
    write_responses(to, result, best);
    if (result->n_recommendations > 1) {
        add_table(to, mt_report_alternatives(result), "Designs side by side");
    }
    mt_write_uncertainty(to, result);
    write_trade(to, result);
    write_certificates(to, result);
    write_relaxations(to, result);
    if (with_published) {
        write_published(to, result);
    }
    write_unchecked(to, result);
    add_sentences(to, "Warnings", result->n_warnings, result->warnings);
}

/* Add a place for a figure of the page's script. */
static void keep_place(const mt_summary_writer *to, const char *id)
{
    mt_text_addf(to->out, "<div id=\"%s\"></div>\n", id);
}

typedef void mt_write_statement(const mt_summary_writer *to, const mt_result *result,
                                const mt_recommendation *r);

/* A part of the page for each design, the first of which is shown until another is chosen; of
 * the original one where there is none. */
static void write_each(const mt_summary_writer *to, const mt_result *result,
                       mt_write_statement *tell)
{
    const int found = result->n_recommendations;
    const mt_recommendation *const first =
        found > 0 ? result->recommendations : &result->baseline;
    for (int i = 0; i < SHOWN && (i < found || i == 0); i++) {
        mt_text_addf(to->out, "<section data-rank=\"%d\"%s>\n", first[i].rank,
                     i == 0 ? "" : " hidden");
        tell(to, result, &first[i]);
        mt_text_add(to->out, "</section>\n");
    }
}

static void write_why(const mt_summary_writer *to, const mt_result *result,
                      const mt_recommendation *r)
{
    (void)result;
    if (r->rank > 0 && r->n_parameters > 0) {
        write_rank(to, r);
    }
    write_reasons(to, r);
}

void mt_write_page(mt_text *out, const mt_result *result)
{
    static const char *const first[] = {"place-choice", "place-alternatives",
                                        "place-frequencies", "place-parameters"};
    const mt_summary_writer to = {.out = out, .html = true};
    mt_write_overrides(&to, &result->run);
    mt_tell_warnings(&to, result);
    write_each(&to, result, write_compliance);
    for (int i = 0; i < MT_COUNT(first); i++) {
        keep_place(&to, first[i]);
    }
    write_each(&to, result, write_why);
    write_relaxations(&to, result);
    mt_write_uncertainty(&to, result);
    write_certificates(&to, result);
    write_unchecked(&to, result);
    add_sentences(&to, "Warnings", result->n_warnings, result->warnings);
    write_facts(&to, result->n_facts, result->facts);
    keep_place(&to, "place-mechanism");
    keep_place(&to, "figures");
    mt_text_add(out, "<details id=\"told\">\n<summary>All numbers as tables</summary>\n");
    write_each(&to, result, write_numbers);
    if (result->n_recommendations > 1) {
        mt_text_add(out, "<div class=\"drawn\">\n");
        add_table(&to, mt_report_alternatives(result), "Designs side by side");
        mt_text_add(out, "</div>\n");
    }
    add_table(&to, mt_report_extremes(result, SHOWN), "Peaks and antiresonances");
    write_trade(&to, result);
    write_published(&to, result);
    mt_text_add(out, "</details>\n");
    keep_place(&to, "place-origin");
}

void mt_report_summary(const mt_result *result, bool with_published, int width, mt_text *out)
{
    const char *const name =
        result->study.name == NULL ? result->study.file : result->study.name;
    mt_text_addf(out, "%s\n%s\n", name == NULL ? "study" : name,
                 result->status_text == NULL ? mt_result_status_name(result->status)
                                             : result->status_text);
    write_answer(&(mt_summary_writer){.out = out, .width = width}, result, with_published);
}
