/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result in words and tables: designs side by side, trade studies, responses, and the summary
 * of all of it. */
#include "report/summary.h"

#include <math.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "base/number.h"
#include "report/design.h"
#include "report/table.h"

enum {
    VALUE_DIGITS = 6,
    HZ_DIGITS = 6,
    PERCENT_DIGITS = 3,
    SUMMARY_DIGITS = 4,
    REQUIREMENT_TEXT = 120,
    HEADING_TEXT = 160,
    WEIGHT_TEXT = 240
};

/* Variables in columns. */

/* The same as mt_table_shown, with machines given the displayed value: their heading names the
 * unit. */
static void in_unit_cell(mt_table *t, double value, double factor, int digits)
{
    mt_table_shown(t, mt_result_shown(value, factor), 1.0, digits);
}

/* A column for each variable in its displayed unit (as of design `of`, the same for all; NULL:
 * no design), which the heading gives for machines always and for people where it is not SI;
 * and their cells for one design. */
static void report_variable_columns(mt_table *t, const mt_result *result,
                                    const mt_recommendation *of)
{
    for (int k = 0; k < result->n_variables; k++) {
        const mt_result_parameter *const p =
            of != NULL && k < of->n_parameters ? &of->parameters[k] : NULL;
        const char *const shown = p == NULL ? NULL : p->display_unit;
        const char *const unit = p == NULL || shown != NULL ? shown : p->unit;
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "%.120s [%.20s]", result->variables[k],
                          unit == NULL ? "" : unit);
        mt_table_column(t, shown == NULL ? result->variables[k] : heading,
                        unit == NULL ? result->variables[k] : heading, MT_ALIGN_POINT);
    }
}

static void report_variable_cells(mt_table *t, const mt_result *result,
                                  const mt_recommendation *r)
{
    for (int k = 0; k < result->n_variables; k++) {
        if (k < r->n_parameters) {
            const mt_result_parameter *const p = &r->parameters[k];
            in_unit_cell(t, p->recommended, p->display_factor, VALUE_DIGITS);
        } else {
            mt_table_number(t, nan(""), VALUE_DIGITS);
        }
    }
}

/* "4 x installed mode 1 at 18 Hz": a goal by its words, which are the first requirement's where
 * it has several. */
static void weight_cell(mt_table *t, const mt_result *result, const char *goal, double factor)
{
    char text[WEIGHT_TEXT];
    const char *words = goal;
    for (int i = result->baseline.n_goals - 1; i >= 0 && goal != NULL; i--) {
        const mt_result_goal *const g = &result->baseline.goals[i];
        words = g->pointer != NULL && strcmp(g->pointer, goal) == 0 ? g->text : words;
    }
    if (words != NULL) {
        (void)mt_snprintf(text, sizeof text, "%g x %s", factor, words);
    }
    mt_table_text(t, words == NULL ? NULL : text);
}

/* Sensitivity to the weights: parameter, unit, value, low, high, change of both, and the
 * weights that cause them. */
static mt_table weight_sensitivity_table(const mt_result *result)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "parameter", "parameter", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "value", "value", MT_ALIGN_POINT);
    mt_table_column(&t, "low", "low", MT_ALIGN_POINT);
    mt_table_column(&t, "[%]", "low_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "by weight", "low_goal", MT_ALIGN_LEFT);
    mt_table_column(&t, "high", "high", MT_ALIGN_POINT);
    mt_table_column(&t, "[%]", "high_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "by weight", "high_goal", MT_ALIGN_LEFT);
    for (int i = 0; i < result->n_weight_sensitivity; i++) {
        const mt_result_weight_sensitivity *const s = &result->weight_sensitivity[i];
        mt_table_text(&t, s->parameter);
        mt_table_unit(&t, s->unit, s->display_unit);
        mt_table_shown(&t, s->value, s->display_factor, VALUE_DIGITS);
        mt_table_shown(&t, s->low, s->display_factor, VALUE_DIGITS);
        mt_table_percent(&t, s->low_percent, PERCENT_DIGITS);
        weight_cell(&t, result, s->low_goal, s->low_factor);
        mt_table_shown(&t, s->high, s->display_factor, VALUE_DIGITS);
        mt_table_percent(&t, s->high_percent, PERCENT_DIGITS);
        weight_cell(&t, result, s->high_goal, s->high_factor);
    }
    return t;
}

/* Designs. */

/* The size of the redesign as tables call it, and as an objective is called that asks for the
 * least. */
static const char CHANGE[] = "change";

/* True where the text is one of the result's objectives. */
static bool report_has_objective(const mt_result *result, const char *text)
{
    for (int k = 0; k < result->n_objectives; k++) {
        if (strcmp(result->objectives[k].text, text) == 0) {
            return true;
        }
    }
    return false;
}

/* The column of the least clearance from the bands without their margin, named so as to differ
 * from the objective "clearance". */
static void report_clearance_column(mt_table *t, const mt_result *result)
{
    mt_table_column(
        t, report_has_objective(result, "clearance") ? "without margin [%]" : "clearance [%]",
        "clearance_percent", MT_ALIGN_POINT);
}

/* In tables of designs: a column for each objective of the result ("mass [kg]", for machines
 * "objective mass [kg]") and for the total change ("change"), where it is not an objective; and
 * their cells for one design. */
static void report_objective_columns(mt_table *t, const mt_result *result)
{
    static const char machine[] = "objective ";
    for (int k = 0; k < result->n_objectives; k++) {
        const mt_result_objective *const o = &result->objectives[k];
        const bool bare = o->unit == NULL || o->unit[0] == '\0';
        char member[WEIGHT_TEXT];
        (void)mt_snprintf(member, sizeof member, "%s%.200s%s%s%s", machine, o->text,
                          bare ? "" : " [", bare ? "" : o->unit, bare ? "" : "]");
        const char *const heading = member + strlen(machine);
        mt_table_column(t, heading, strcmp(heading, CHANGE) == 0 ? CHANGE : member,
                        MT_ALIGN_POINT);
    }
    if (!report_has_objective(result, CHANGE)) {
        mt_table_column(t, CHANGE, CHANGE, MT_ALIGN_POINT);
    }
}

static void report_objective_cells(mt_table *t, const mt_result *result,
                                   const mt_recommendation *r)
{
    for (int k = 0; k < result->n_objectives; k++) {
        mt_report_objective_cell(t, result->objectives[k].unit,
                                 k < r->n_objectives ? r->objectives[k].recommended : nan(""));
    }
    if (!report_has_objective(result, CHANGE)) {
        mt_table_ratio(t, r->change, VALUE_DIGITS);
    }
}

/* "0 1 2 4": modes below each band; NULL without bands. */
static const char *assignment(const mt_recommendation *r, char *s, size_t size)
{
    size_t used = 0;
    for (int i = 0; i < r->n_placements; i++) {
        const int n = mt_snprintf(s + used, size - used, "%s%d", i == 0 ? "" : " ",
                                  r->placements[i].modes_below);
        if (n < 0 || (size_t)n >= size - used) {
            s[used] = '\0';
            break; /* more bands than a cell holds: the first of them */
        }
        used += (size_t)n;
    }
    return r->n_placements > 0 ? s : NULL;
}

static void alternative_cells(mt_table *t, const mt_result *result, const mt_recommendation *r)
{
    if (r->rank > 0) {
        mt_table_integer(t, r->rank);
    } else {
        mt_table_text(t, "original");
    }
    mt_table_text(t, r->rank > 0 ? r->grade : NULL);
    report_objective_cells(t, result, r);
    mt_table_off_by(t, r->violation_percent, r->feasible, PERCENT_DIGITS);
    if (result->baseline.n_placements > 0) {
        char text[REQUIREMENT_TEXT];
        mt_table_number(t, r->clearance_percent, PERCENT_DIGITS);
        mt_table_text(t, assignment(r, text, sizeof text));
    }
    report_variable_cells(t, result, r);
}

mt_table mt_report_alternatives(const mt_result *result)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "rank", "rank", MT_ALIGN_RIGHT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    report_objective_columns(&t, result);
    mt_table_column(&t, "deviation [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->baseline.n_placements > 0) {
        report_clearance_column(&t, result);
        mt_table_column(&t, "modes below bands", "gap_assignment", MT_ALIGN_LEFT);
    }
    const mt_recommendation *const first =
        result->n_recommendations > 0 ? &result->recommendations[0] : NULL;
    report_variable_columns(&t, result, first);
    if (result->baseline.n_parameters == result->n_variables) {
        alternative_cells(&t, result, &result->baseline);
    }
    for (int i = 0; i < result->n_recommendations; i++) {
        alternative_cells(&t, result, &result->recommendations[i]);
    }
    return t;
}

bool mt_report_verified(const mt_result *result, int *judged)
{
    int n = 0;
    bool all = true;
    for (int i = 0; i < result->n_published; i++) {
        const mt_result_published *const p = &result->published[i];
        if (p->role == NULL || strcmp(p->role, "not_comparable") != 0) {
            n++;
            all = all && p->holds;
        }
    }
    if (judged != NULL) {
        *judged = n;
    }
    return all;
}

/* A published number in the displayed unit, with at most 10 digits and no trailing zeros. */
static void quoted_cell(mt_table *t, double value, double factor)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const double shown = mt_result_shown(value, factor);
    (void)mt_snprintf(text, sizeof text, "%.10g", shown);
    mt_table_cell(t, isfinite(shown) ? text : mt_report_number(shown, 1, text),
                  mt_report_exact(value, exact));
}

/* Two cells: a difference, displayed as by mt_table_shown, and the same in percent; both 0
 * where it is noise. */
static void difference_cells(mt_table *t, double value, double percent, double factor,
                             int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    const bool noise = fabs(percent) < MT_PERCENT_NOISE;
    const double shown = noise ? 0.0 : mt_result_shown(value, factor);
    mt_table_cell(t, mt_report_change(shown, digits, text), mt_report_exact(value, exact));
    mt_table_percent(t, percent, digits);
}

mt_table mt_report_published(const mt_result *result)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "what", "label", MT_ALIGN_LEFT);
    mt_table_column(&t, "published", "published", MT_ALIGN_POINT);
    mt_table_column(&t, "computed", "computed", MT_ALIGN_POINT);
    mt_table_column(&t, "difference", "difference", MT_ALIGN_POINT);
    mt_table_column(&t, "[%]", "difference_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "asked", "demand", MT_ALIGN_LEFT);
    mt_table_column(&t, "role", "role", MT_ALIGN_LEFT);
    mt_table_column(&t, "verdict", "verdict", MT_ALIGN_LEFT);
    mt_table_column(&t, "source", "source", MT_ALIGN_LEFT);
    for (int i = 0; i < result->n_published; i++) {
        const mt_result_published *const p = &result->published[i];
        mt_table_text(&t, p->label);
        if (p->published_text != NULL) {
            mt_table_text(&t, p->published_text);
            mt_table_text(&t, p->computed_text);
        } else {
            quoted_cell(&t, p->published, p->display_factor);
            mt_table_shown(&t, p->computed, p->display_factor, VALUE_DIGITS);
        }
        difference_cells(&t, p->difference, p->difference_percent, p->display_factor,
                         PERCENT_DIGITS);
        mt_table_text(&t, p->requirement);
        mt_table_text(&t, p->role);
        mt_table_text(&t, p->role != NULL && strcmp(p->role, "not_comparable") == 0
                              ? "not comparable"
                          : p->holds ? "holds"
                                     : "FAILS");
        mt_table_text(&t, p->source);
    }
    return t;
}

/* The same mode, by index, at another design; NULL: it is not listed there. */
static const mt_result_frequency *same_frequency(const mt_recommendation *r,
                                                 const mt_result_frequency *f)
{
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const g = &r->frequencies[i];
        const bool same = g->configuration == f->configuration ||
                          (g->configuration != NULL && f->configuration != NULL &&
                           strcmp(g->configuration, f->configuration) == 0);
        if (same && g->mode == f->mode) {
            return g;
        }
    }
    return NULL;
}

static void design_row(mt_table *t, const mt_result *result, const mt_recommendation *r)
{
    const mt_recommendation *const baseline = &result->baseline;
    const bool is_baseline = r == baseline;
    mt_table_integer(t, r->rank);
    mt_table_text(t, r->feasible ? "true" : "false");
    mt_table_text(t, r->grade);
    mt_table_number(t, r->score, VALUE_DIGITS);
    report_objective_cells(t, result, r);
    mt_table_number(t, r->misfit, VALUE_DIGITS);
    mt_table_number(t, r->violation_percent, VALUE_DIGITS);
    if (baseline->n_placements > 0) {
        char text[REQUIREMENT_TEXT];
        mt_table_number(t, r->clearance_percent, VALUE_DIGITS);
        mt_table_text(t, assignment(r, text, sizeof text));
    }
    for (int k = 0; k < result->n_variables; k++) {
        const bool has = k < r->n_parameters;
        in_unit_cell(t,
                     !has          ? nan("")
                     : is_baseline ? r->parameters[k].original
                                   : r->parameters[k].recommended,
                     has ? r->parameters[k].display_factor : nan(""), VALUE_DIGITS);
    }
    for (int k = 0; k < baseline->n_frequencies; k++) {
        const mt_result_frequency *const f = same_frequency(r, &baseline->frequencies[k]);
        mt_table_number(t, f == NULL ? nan("") : f->recommended_hz, HZ_DIGITS);
        if (baseline->worst_case != NULL) {
            mt_table_number(t, f == NULL ? nan("") : f->lowest_hz, HZ_DIGITS);
            mt_table_number(t, f == NULL ? nan("") : f->highest_hz, HZ_DIGITS);
        }
    }
}

/* "k_1 [N/mm]" */
static void variable_column(mt_table *t, const mt_result *result, int k)
{
    const bool has = k < result->baseline.n_parameters;
    const mt_result_parameter *const p = has ? &result->baseline.parameters[k] : NULL;
    const char *const unit = p == NULL                 ? NULL
                             : p->display_unit != NULL ? p->display_unit
                                                       : p->unit;
    mt_text name = {.s = NULL};
    mt_text_add(&name, result->variables[k]);
    if (unit != NULL && *unit != '\0' && strcmp(unit, "1") != 0) {
        mt_text_addf(&name, " [%s]", unit);
    }
    const char *const heading = name.failed || name.s == NULL ? result->variables[k] : name.s;
    mt_table_column(t, heading, heading, MT_ALIGN_RIGHT);
    mt_text_free(&name);
}

mt_table mt_report_designs(const mt_result *result)
{
    static const char *const judged[] = {"rank", "feasible", "grade", "score"};
    static const char *const sizes[] = {"misfit", "violation_percent"};
    static const char *const ends[] = {"hz", "lowest_hz", "highest_hz"};
    mt_table t = mt_table_default();
    for (int i = 0; i < MT_COUNT(judged); i++) {
        mt_table_column(&t, judged[i], judged[i], MT_ALIGN_RIGHT);
    }
    report_objective_columns(&t, result);
    for (int i = 0; i < MT_COUNT(sizes); i++) {
        mt_table_column(&t, sizes[i], sizes[i], MT_ALIGN_RIGHT);
    }
    if (result->baseline.n_placements > 0) {
        mt_table_column(&t, "clearance_percent", "clearance_percent", MT_ALIGN_RIGHT);
        mt_table_column(&t, "gap_assignment", "gap_assignment", MT_ALIGN_RIGHT);
    }
    for (int k = 0; k < result->n_variables; k++) {
        variable_column(&t, result, k);
    }
    const int ranged = result->baseline.worst_case == NULL ? 1 : MT_COUNT(ends);
    for (int k = 0; k < ranged * result->baseline.n_frequencies; k++) {
        const mt_result_frequency *const f = &result->baseline.frequencies[k / ranged];
        char name[REQUIREMENT_TEXT];
        (void)mt_snprintf(name, sizeof name, "%.80s.mode_%d_%s",
                          f->configuration == NULL ? "" : f->configuration, f->mode,
                          ends[k % ranged]);
        mt_table_column(&t, name, name, MT_ALIGN_RIGHT);
    }
    design_row(&t, result, &result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        design_row(&t, result, &result->recommendations[i]);
    }
    return t;
}

/* Trade studies: one line per point. */

/* True for objectives of the front that are not among the study's, and so need a column. */
static bool has_column(const mt_result *result, int k)
{
    static const char *const own[] = {"change", "clearance"};
    const char *const name = result->trade->objectives[k];
    bool known = report_has_objective(result, name);
    for (int i = 0; i < MT_COUNT(own); i++) {
        known = known || strcmp(own[i], name) == 0;
    }
    return !known;
}

/* An objective at a design; NULL: it has none. */
static const mt_design_objective *objective_at(const mt_recommendation *r, const char *name)
{
    for (int i = 0; i < r->n_objectives; i++) {
        if (strcmp(r->objectives[i].text, name) == 0) {
            return &r->objectives[i];
        }
    }
    return NULL;
}

static const char *front_unit(const mt_trade_result *trade, int k)
{
    for (int i = 0; i < trade->n_points; i++) {
        const mt_design_objective *const o =
            objective_at(&trade->points[i].best, trade->objectives[k]);
        if (o != NULL && o->unit != NULL) {
            return o->unit;
        }
    }
    return "";
}

static void front_columns(mt_table *t, const mt_result *result)
{
    for (int k = 0; k < result->trade->n_objectives; k++) {
        const char *const unit = front_unit(result->trade, k);
        const bool bare = unit[0] == '\0';
        char member[HEADING_TEXT];
        (void)mt_snprintf(member, sizeof member, "objective %.60s%s%.20s%s",
                          result->trade->objectives[k], bare ? "" : " [", unit,
                          bare ? "" : "]");
        if (has_column(result, k)) {
            mt_table_column(t, strchr(member, ' ') + 1, member, MT_ALIGN_POINT);
        }
    }
}

static void front_cells(mt_table *t, const mt_result *result, const mt_trade_point *p)
{
    for (int k = 0; k < result->trade->n_objectives; k++) {
        const mt_design_objective *const o =
            objective_at(&p->best, result->trade->objectives[k]);
        if (has_column(result, k)) {
            mt_report_objective_cell(t, o == NULL ? "" : o->unit,
                                     o == NULL ? nan("") : o->recommended);
        }
    }
}

static void point_row(mt_table *t, const mt_result *result, const mt_trade_point *p)
{
    for (int i = 0; i < result->trade->n_vary; i++) {
        in_unit_cell(t, p->values[i], result->trade->vary[i].display_factor, VALUE_DIGITS);
    }
    mt_table_text(t, mt_result_status_name(p->status));
    report_objective_cells(t, result, &p->best);
    front_cells(t, result, p);
    mt_table_number(t, p->best.clearance_percent, PERCENT_DIGITS);
    mt_table_off_by(t, p->best.violation_percent, p->best.feasible, PERCENT_DIGITS);
    if (result->trade->n_objectives == 2) {
        mt_table_text(t, p->pareto ? "yes" : "no");
    }
    report_variable_cells(t, result, &p->best);
}

/* A design with parameters; NULL: none. */
static const mt_recommendation *any_design(const mt_trade_result *trade)
{
    for (int i = 0; i < trade->n_points; i++) {
        if (trade->points[i].best.n_parameters > 0) {
            return &trade->points[i].best;
        }
    }
    return NULL;
}

static void add_vary_columns(mt_table *t, const mt_result *result)
{
    for (int i = 0; i < result->trade->n_vary; i++) {
        const mt_trade_vary *const v = &result->trade->vary[i];
        const char *const unit = v->display_unit != NULL ? v->display_unit : v->unit;
        const bool bare = unit == NULL;
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "%.120s%s%.20s%s", v->text, bare ? "" : " [",
                          bare ? "" : unit, bare ? "" : "]");
        mt_table_column(t, heading, heading, MT_ALIGN_POINT);
    }
    mt_table_column(t, "status", "status", MT_ALIGN_LEFT);
    report_objective_columns(t, result);
    front_columns(t, result);
    report_clearance_column(t, result);
    mt_table_column(t, "deviation [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->trade->n_objectives == 2) {
        mt_table_column(t, "front", "pareto", MT_ALIGN_LEFT);
    }
    report_variable_columns(t, result, any_design(result->trade));
}

static mt_table points(const mt_result *result, bool all)
{
    mt_table t = mt_table_default();
    if (result->trade != NULL) {
        mt_trade_selection s = mt_trade_select(result->trade);
        add_vary_columns(&t, result);
        for (int i = 0; i < result->trade->n_points; i++) {
            if (mt_trade_is_selected(&s, i) || all) {
                point_row(&t, result, &result->trade->points[i]);
            }
        }
    }
    return t;
}

mt_table mt_report_trade(const mt_result *result)
{
    return points(result, true);
}

/* The rows of the selected points of a large grid (mt_trade_select), and a sentence about their
 * number; of any other grid all rows, and no sentence. The result must have a trade study. */
static mt_table selected_trade_table(const mt_result *result)
{
    return points(result, false);
}

static void write_trade_left(const mt_result *result, mt_text *line)
{
    const mt_trade_result *const trade = result->trade;
    int n = 0;
    mt_trade_selection s = mt_trade_select(trade);
    for (int k = 0; k < trade->n_points; k++) {
        n += mt_trade_is_selected(&s, k) ? 1 : 0;
    }
    if (n < trade->n_points) {
        mt_text_addf(line, "%d of %d points, %s%s; all are in trade.csv and result.json.", n,
                     trade->n_points, s.each > 1 ? "spread evenly over " : "",
                     s.front   ? (s.each > 1 ? "the front" : "all on the front")
                     : s.found ? (s.each > 1 ? "those with a design" : "all with a design")
                               : "the grid");
    }
}

/* Frequency responses of designs, as tables and sentences. */

enum { TOLD_DIGITS = 4, HIGHEST = 3 };

/* Response k of a design; NULL: none, which files may have. */
static const mt_design_curve *at(const mt_recommendation *r, int k)
{
    return k < r->n_curves ? &r->curves[k] : NULL;
}

/* The common length of the lists; files may differ. */
static int curve_point_count(const mt_curve_points *c)
{
    const int n = c->n_hz < c->n_magnitude ? c->n_hz : c->n_magnitude;
    return n < c->n_phase ? n : c->n_phase;
}

static void name_columns(mt_table *t)
{
    mt_table_column(t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(t, "input", "input", MT_ALIGN_LEFT);
    mt_table_column(t, "output", "output", MT_ALIGN_LEFT);
}

static void name_cells(mt_table *t, const mt_result_curve *of)
{
    mt_table_text(t, of->configuration);
    mt_table_text(t, of->input);
    mt_table_text(t, of->output);
}

/* A number for people and machines, both rounded. */
static void rounded_cell(mt_table *t, double value, int digits)
{
    char text[MT_NUMBER_TEXT];
    char exact[MT_NUMBER_TEXT];
    (void)mt_snprintf(exact, sizeof exact, "%.*g", digits, value);
    mt_table_cell(t, mt_report_number(value, digits, text), isfinite(value) ? exact : "");
}

static void add_curve(mt_table *t, const mt_result_curve *of, int rank,
                      const mt_design_curve *r)
{
    for (int i = 0; r != NULL && i < curve_point_count(&r->drawn); i++) {
        mt_table_integer(t, rank);
        name_cells(t, of);
        rounded_cell(t, r->drawn.hz[i], MT_CURVE_HZ_DIGITS);
        rounded_cell(t, r->drawn.magnitude[i], MT_CURVE_DIGITS);
        rounded_cell(t, r->drawn.phase_deg[i], MT_CURVE_DIGITS);
        mt_table_text(t, of->unit);
        rounded_cell(t, i < r->drawn.n_psd ? r->drawn.psd[i] : nan(""), MT_CURVE_DIGITS);
    }
}

/* Add for every response the original design, then the first recommendations. */
static void add_all(mt_table *t, const mt_result *result, int most,
                    void (*add)(mt_table *, const mt_result_curve *, int,
                                const mt_design_curve *))
{
    for (int k = 0; k < result->n_curves; k++) {
        const mt_result_curve *const of = &result->curves[k];
        add(t, of, result->baseline.rank, at(&result->baseline, k));
        for (int i = 0; i < result->n_recommendations && i < most; i++) {
            const mt_recommendation *const r = &result->recommendations[i];
            add(t, of, r->rank, at(r, k));
        }
    }
}

mt_table mt_report_curves(const mt_result *result)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "rank", "rank", MT_ALIGN_RIGHT);
    name_columns(&t);
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "magnitude", "magnitude", MT_ALIGN_POINT);
    mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "PSD", "psd", MT_ALIGN_POINT);
    add_all(&t, result, result->n_recommendations, add_curve);
    return t;
}

static void add_extremes(mt_table *t, const mt_result_curve *of, int rank,
                         const mt_design_curve *r)
{
    for (int e = 0; r != NULL && e < r->n_extremes; e++) {
        const mt_result_extreme *const x = &r->extremes[e];
        name_cells(t, of);
        mt_table_integer(t, rank);
        mt_table_text(t, x->kind);
        mt_table_number(t, x->hz, HZ_DIGITS);
        mt_table_number(t, x->magnitude, TOLD_DIGITS);
        mt_table_text(t, of->unit);
        mt_table_number(t, x->phase_deg, TOLD_DIGITS);
        mt_table_number(t, x->natural_hz, HZ_DIGITS);
        mt_table_number(t, x->damping_ratio, TOLD_DIGITS);
    }
}

/* Peaks, resonances and antiresonances of the original design and of at most `most` recommended
 * ones. */
static mt_table extremes_table(const mt_result *result, int most)
{
    mt_table t = mt_table_default();
    name_columns(&t);
    mt_table_column(&t, "design", "rank", MT_ALIGN_RIGHT);
    mt_table_column(&t, "kind", "kind", MT_ALIGN_LEFT);
    mt_table_column(&t, "frequency [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "magnitude", "magnitude", MT_ALIGN_POINT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "phase [deg]", "phase_deg", MT_ALIGN_POINT);
    mt_table_column(&t, "of a mode at [Hz]", "natural_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "damping ratio", "damping_ratio", MT_ALIGN_POINT);
    add_all(&t, result, most, add_extremes);
    return t;
}

/* Height of an extreme; one without a magnitude is infinite. */
static double height(const mt_result_extreme *x)
{
    return isnan(x->magnitude) ? HUGE_VAL : x->magnitude;
}

static bool is_peak(const mt_result_extreme *x)
{
    return strcmp(x->kind, "peak") == 0 || strcmp(x->kind, "resonance") == 0;
}

/* "25.1 at 18.00 Hz" */
static void write_peak(const mt_result_extreme *x, mt_text *out)
{
    char hz[MT_NUMBER_TEXT];
    char size[MT_NUMBER_TEXT];
    mt_text_addf(out, "%s at %s Hz",
                 isnan(x->magnitude) ? "infinite"
                                     : mt_report_number(x->magnitude, TOLD_DIGITS, size),
                 mt_report_number(x->hz, TOLD_DIGITS, hz));
}

/* The highest peaks, in the order of their frequencies. */
static void write_peaks(const mt_design_curve *r, mt_text *out)
{
    int told = 0;
    for (int i = 0; r != NULL && i < r->n_extremes; i++) {
        int higher = 0;
        for (int k = 0; k < r->n_extremes; k++) {
            const double more = height(&r->extremes[k]) - height(&r->extremes[i]);
            higher += is_peak(&r->extremes[k]) && (more > 0.0 || (!(more < 0.0) && k < i));
        }
        if (is_peak(&r->extremes[i]) && higher < HIGHEST) {
            mt_text_add(out, told++ == 0 ? " " : ", ");
            write_peak(&r->extremes[i], out);
        }
    }
    if (r != NULL && r->trouble != NULL) {
        mt_text_addf(out, " none (%s)", r->trouble);
    } else if (told == 0) {
        mt_text_add(out, " none");
    }
}

/* "3.21 m/s^2 RMS, 12.1 m/s^2 at peak" */
static void tell_forced_response(const mt_result_curve *of, const mt_design_curve *r,
                                 mt_text *out)
{
    const mt_result_forced_response *const s = r == NULL ? NULL : r->vibration;
    char rms[MT_NUMBER_TEXT];
    char peak[MT_NUMBER_TEXT];
    if (s == NULL) {
        mt_text_add(out, " no number");
    } else if (isnan(s->peak)) {
        mt_text_addf(out, " no number (%s)", s->end);
    } else {
        mt_text_addf(out, " %s %s RMS, peak %s %s", mt_report_number(s->rms, TOLD_DIGITS, rms),
                     of->output_unit, mt_report_number(s->peak, TOLD_DIGITS, peak),
                     of->output_unit);
    }
}

/* Append response k of the result as a sentence: its highest peaks in the original design and
 * in r, which may be the same. */
static void write_curve(const mt_result *result, int k, const mt_recommendation *r,
                        mt_text *out)
{
    const mt_result_curve *const of = &result->curves[k];
    const bool found = r != &result->baseline;
    mt_text_addf(out, "%s: %s by %s from %.6g to %.6g Hz [%s], highest peaks%s",
                 of->configuration, of->output, of->input, of->lower_hz, of->upper_hz, of->unit,
                 found ? " before" : "");
    write_peaks(at(&result->baseline, k), out);
    if (found) {
        mt_text_add(out, "; after");
        write_peaks(at(r, k), out);
    }
    if (of->profile != NULL) {
        mt_text_addf(out, ". Under %s:%s",
                     of->profile->name != NULL ? of->profile->name : of->profile->file,
                     found ? " before" : "");
        tell_forced_response(of, at(&result->baseline, k), out);
        if (found) {
            mt_text_add(out, "; after");
            tell_forced_response(of, at(r, k), out);
        }
    }
}

/* The sections. */

enum { SHOWN = 20 /* of more designs a page draws figures only */ };

/* True where the section was computed. A section that a stopped run left out says so. */
static bool is_section_known(const mt_summary_writer *to, const char *title, const void *items)
{
    if (items == NULL) {
        mt_text line = {0};
        mt_text_add(&line, "not computed: the run was stopped before");
        mt_section_heading(to, title);
        mt_section_paragraph(to, "  ", &line);
    }
    return items != NULL;
}

static void add_sentences(const mt_summary_writer *to, const char *title, int n,
                          const char *const *items)
{
    if (mt_section_open(to, title, n)) {
        for (int i = 0; i < n; i++) {
            mt_section_item(to, "", items[i]);
        }
        mt_section_close(to);
    }
}

void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result)
{
    static const char unidentifiable[] =
        "Not identifiable: directions along which the goals hardly change";
    static const char weight_sensitivity[] =
        "Sensitivity to the weights (the scatter of repeated tests may be many times larger)";
    if (is_section_known(to, unidentifiable, result->unidentifiable) &&
        mt_section_open(to, unidentifiable, result->n_unidentifiable)) {
        for (int i = 0; i < result->n_unidentifiable; i++) {
            const mt_unidentifiable_direction *const u = &result->unidentifiable[i];
            mt_text text = {0};
            mt_text_addf(&text, "%s", u->text);
            if (!isnan(u->effect_percent)) {
                char effect[MT_NUMBER_TEXT];
                mt_text_addf(&text, " (changes no goal by more than %s %% from bound to bound)",
                             mt_report_number(fmax(u->effect_percent, MT_PERCENT_NOISE),
                                              SUMMARY_DIGITS, effect));
            }
            mt_section_made(to, &text);
        }
        mt_section_close(to);
    }
    if (is_section_known(to, weight_sensitivity, result->weight_sensitivity)) {
        mt_section_table(to, weight_sensitivity_table(result), weight_sensitivity);
    }
}

static void write_certificates(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What is proven";
    if (is_section_known(to, title, result->certificates) &&
        mt_section_open(to, title, result->n_certificates)) {
        for (int i = 0; i < result->n_certificates; i++) {
            const mt_certificate *const c = &result->certificates[i];
            mt_section_item(to, c->proven ? "proven" : "sampled", c->text);
        }
        mt_section_close(to);
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
        mt_section_table(to, selected_trade_table(result), title);
        write_trade_left(result, &line);
        if (line.length > 0 || line.failed) {
            mt_section_paragraph(to, "  ", &line);
        }
    }
}

static void write_relaxations(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "What would make it feasible, one change at a time";
    if (is_section_known(to, title, result->relaxations) &&
        mt_section_open(to, title, result->n_relaxations)) {
        for (int i = 0; i < result->n_relaxations; i++) {
            mt_section_item(to, "", result->relaxations[i].text);
        }
        mt_section_close(to);
    }
}

static void write_published(const mt_summary_writer *to, const mt_result *result)
{
    static const char title[] = "Published against computed";
    if (is_section_known(to, title, result->published)) {
        mt_section_table(to, mt_report_published(result), title);
    }
}

static void write_responses(const mt_summary_writer *to, const mt_result *result,
                            const mt_recommendation *r)
{
    if (mt_section_open(to, "Responses", result->n_curves)) {
        for (int k = 0; k < result->n_curves; k++) {
            mt_text text = {.s = NULL};
            write_curve(result, k, r, &text);
            mt_section_made(to, &text);
        }
        mt_section_close(to);
    }
}

/* Write the values of unchecked designs, of which nothing else is known. */
static void write_unchecked(const mt_summary_writer *to, const mt_result *result)
{
    if (mt_section_open(to,
                        "Not re-checked before the end: values of the variables, unverified",
                        result->n_unchecked)) {
        for (int i = 0; i < result->n_unchecked; i++) {
            mt_text text = {0};
            mt_text_addf(&text, "%s", result->unchecked[i].text);
            mt_section_made(to, &text);
        }
        mt_section_close(to);
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
    mt_write_design(to, result, best, MT_DESIGN_WHOLE);
    write_responses(to, result, best);
    if (result->n_recommendations > 1) {
        mt_section_table(to, mt_report_alternatives(result), "Designs side by side");
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

/* A part of the page for each design, the first of which is shown until another is chosen; of
 * the original one where there is none. */
static void write_each(const mt_summary_writer *to, const mt_result *result,
                       mt_design_part part)
{
    const int found = result->n_recommendations;
    const mt_recommendation *const first =
        found > 0 ? result->recommendations : &result->baseline;
    for (int i = 0; i < SHOWN && (i < found || i == 0); i++) {
        mt_text_addf(to->out, "<section data-rank=\"%d\"%s>\n", first[i].rank,
                     i == 0 ? "" : " hidden");
        mt_write_design(to, result, &first[i], part);
        mt_text_add(to->out, "</section>\n");
    }
}

void mt_write_page(mt_text *out, const mt_result *result)
{
    static const char *const first[] = {"place-choice", "place-alternatives",
                                        "place-frequencies", "place-parameters"};
    const mt_summary_writer to = {.out = out, .html = true};
    mt_write_overrides(&to, &result->run);
    mt_tell_warnings(&to, result);
    write_each(&to, result, MT_DESIGN_REQUIREMENTS);
    for (int i = 0; i < MT_COUNT(first); i++) {
        keep_place(&to, first[i]);
    }
    write_each(&to, result, MT_DESIGN_REASONS);
    write_relaxations(&to, result);
    mt_write_uncertainty(&to, result);
    write_certificates(&to, result);
    write_unchecked(&to, result);
    add_sentences(&to, "Warnings", result->n_warnings, result->warnings);
    mt_write_facts(&to, result->n_facts, result->facts);
    keep_place(&to, "place-mechanism");
    keep_place(&to, "figures");
    mt_text_add(out, "<details id=\"told\">\n<summary>All numbers as tables</summary>\n");
    write_each(&to, result, MT_DESIGN_NUMBERS);
    if (result->n_recommendations > 1) {
        mt_text_add(out, "<div class=\"drawn\">\n");
        mt_section_table(&to, mt_report_alternatives(result), "Designs side by side");
        mt_text_add(out, "</div>\n");
    }
    mt_section_table(&to, extremes_table(result, SHOWN), "Peaks and antiresonances");
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
