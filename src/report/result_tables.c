/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results as tables. */
#include "report/result_tables.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "report/table.h"

/* Values of parameters, which people see in the units that they gave them in. */

/* As a drawing would give them; percentages need no more than 3. */
enum { VALUE_DIGITS = 6, PERCENT_DIGITS = 3, HEADING_TEXT = 160, WEIGHT_TEXT = 240 };

mt_table mt_report_parameters(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "parameter", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "before", "original", MT_ALIGN_POINT);
    mt_table_column(&t, "after", "recommended", MT_ALIGN_POINT);
    mt_table_column(&t, "change [%]", "change_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "at bound", "at_bound", MT_ALIGN_LEFT);
    for (int i = 0; i < r->n_parameters; i++) {
        const mt_result_parameter *const p = &r->parameters[i];
        mt_table_text(&t, p->name);
        mt_table_unit(&t, p->unit, p->display_unit);
        mt_table_shown(&t, p->original, p->display_factor, VALUE_DIGITS);
        mt_table_shown(&t, p->recommended, p->display_factor, VALUE_DIGITS);
        mt_table_percent(&t, p->change_percent, PERCENT_DIGITS);
        mt_table_text(&t, p->at_bound);
    }
    return t;
}

bool mt_report_measure(const mt_result_parameter *p, mt_text *out)
{
    char number[MT_NUMBER_TEXT];
    const char *const name = p->display_unit != NULL ? p->display_unit : p->unit;
    const char *const space = name == NULL ? "" : " ";
    const char *const unit = name == NULL ? "" : name;
    const double factor = p->display_factor;
    if (p->measure_floor > 0.0) {
        mt_text_addf(
            out, "The change of %s counts as ln(new/original), below %s%s%s linearly.", p->name,
            mt_report_number(mt_result_shown(p->measure_floor, factor), VALUE_DIGITS, number),
            space, unit);
        return true;
    }
    if (p->measure_scale > 0.0) {
        mt_text_addf(
            out, "The change of %s counts linearly, %s%s%s as 1.", p->name,
            mt_report_number(mt_result_shown(p->measure_scale, factor), VALUE_DIGITS, number),
            space, unit);
        return true;
    }
    return false;
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
            mt_table_in_unit(t, p->recommended, p->display_factor, VALUE_DIGITS);
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

mt_table mt_report_weight_sensitivity(const mt_result *result)
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

/* Designs, goals and modes. */

/* Frequencies to 6 digits show changes of 1e-5; percentages and sizes of changes need no more
 * than 3; parameters 6, as a drawing would. */
enum { HZ_DIGITS = 6, MAC_DIGITS = 5, REQUIREMENT_TEXT = 120 };

/* "18.0000", "at least 7.00000", "7.00000 to 9.00000", NULL where nothing is asked */
static const char *requirement_of(const mt_result_frequency *f, char *s, size_t size)
{
    char a[MT_NUMBER_TEXT];
    char b[MT_NUMBER_TEXT];
    (void)mt_report_number(f->at_least_hz, HZ_DIGITS, a);
    (void)mt_report_number(f->at_most_hz, HZ_DIGITS, b);
    if (!isnan(f->target_hz)) {
        return mt_report_number(f->target_hz, HZ_DIGITS, s);
    }
    if (!isnan(f->at_least_hz) && !isnan(f->at_most_hz)) {
        (void)mt_snprintf(s, size, "%s to %s", a, b);
    } else if (!isnan(f->at_least_hz)) {
        (void)mt_snprintf(s, size, "at least %s", a);
    } else if (!isnan(f->at_most_hz)) {
        (void)mt_snprintf(s, size, "at most %s", b);
    } else {
        return NULL;
    }
    return s;
}

/* "stick bending", "stick bending (ambiguous)" */
static void name_cell(mt_table *t, const mt_result_frequency *f)
{
    char text[REQUIREMENT_TEXT];
    if (f->name == NULL || f->identity == NULL || strcmp(f->identity, "tracked") == 0) {
        mt_table_text(t, f->name);
        return;
    }
    (void)mt_snprintf(text, sizeof text, "%.90s (%s)", f->name, f->identity);
    mt_table_text(t, text);
}

mt_table mt_report_frequencies(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    const bool ranges = r->worst_case != NULL;
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "name", "name", MT_ALIGN_LEFT);
    mt_table_column(&t, "before [Hz]", "original_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "after [Hz]", "recommended_hz", MT_ALIGN_POINT);
    if (ranges) {
        mt_table_column(&t, "lowest [Hz]", "lowest_hz", MT_ALIGN_POINT);
        mt_table_column(&t, "highest [Hz]", "highest_hz", MT_ALIGN_POINT);
    }
    mt_table_column(&t, "asked [Hz]", "asked_hz", MT_ALIGN_RIGHT);
    mt_table_column(&t, "error [%]", "error_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "MAC", "mac", MT_ALIGN_POINT);
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        char requirement[REQUIREMENT_TEXT];
        mt_table_text(&t, f->configuration);
        mt_table_integer(&t, f->mode);
        name_cell(&t, f);
        mt_table_number(&t, f->original_hz, HZ_DIGITS);
        mt_table_number(&t, f->recommended_hz, HZ_DIGITS);
        if (ranges) {
            mt_table_number(&t, f->lowest_hz, HZ_DIGITS);
            mt_table_number(&t, f->highest_hz, HZ_DIGITS);
        }
        mt_table_text(&t, requirement_of(f, requirement, sizeof requirement));
        mt_table_percent(&t, f->error_percent, PERCENT_DIGITS);
        mt_table_number(&t, f->mac, MAC_DIGITS);
    }
    return t;
}

static bool is_ratio(const char *unit)
{
    return unit == NULL || unit[0] == '\0' || strcmp(unit, "%") == 0;
}

double mt_report_objective_value(const char *unit, double value)
{
    return is_ratio(unit) ? mt_without_noise(value, MT_RATIO_NOISE) : value;
}

/* A cell of an objective's column. */
static void report_objective_cell(mt_table *t, const char *unit, double value)
{
    if (is_ratio(unit)) {
        mt_table_ratio(t, value, VALUE_DIGITS);
    } else {
        mt_table_number(t, value, VALUE_DIGITS);
    }
}

mt_table mt_report_objectives(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "objective", "text", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "before", "original", MT_ALIGN_POINT);
    mt_table_column(&t, "after", "recommended", MT_ALIGN_POINT);
    for (int k = 0; k < r->n_objectives; k++) {
        const mt_design_objective *const o = &r->objectives[k];
        mt_table_text(&t, o->text);
        mt_table_text(&t, o->unit == NULL || o->unit[0] == '\0' ? NULL : o->unit);
        report_objective_cell(&t, o->unit, o->original);
        report_objective_cell(&t, o->unit, o->recommended);
    }
    return t;
}

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
        report_objective_cell(t, result->objectives[k].unit,
                              k < r->n_objectives ? r->objectives[k].recommended : nan(""));
    }
    if (!report_has_objective(result, CHANGE)) {
        mt_table_ratio(t, r->change, VALUE_DIGITS);
    }
}

static void percent_cells(mt_table *t, const mt_recommendation *r, const mt_result_clearance *c)
{
    mt_table_clearance(t, c != NULL ? c->percent : nan(""), c != NULL ? c->margin_percent : 0.0,
                       PERCENT_DIGITS);
    if (r->worst_case != NULL) {
        mt_table_number(t, c != NULL ? c->worst_percent : nan(""), PERCENT_DIGITS);
    }
}

mt_table mt_report_motions(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "drive", "drive", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "from", "from", MT_ALIGN_POINT);
    mt_table_column(&t, "to", "to", MT_ALIGN_POINT);
    mt_table_column(&t, "positions", "positions", MT_ALIGN_RIGHT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "band", "band", MT_ALIGN_LEFT);
    mt_table_column(&t, "at", "at", MT_ALIGN_POINT);
    mt_table_column(&t, "[Hz]", "hz", MT_ALIGN_POINT);
    mt_table_column(&t, "clearance [%]", "clearance_percent", MT_ALIGN_POINT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    for (int i = 0; i < r->n_motions; i++) {
        const mt_result_motion *const m = &r->motions[i];
        mt_table_text(&t, m->drive);
        mt_table_unit(&t, m->unit, m->display_unit);
        mt_table_shown(&t, m->from, m->display_factor, VALUE_DIGITS);
        mt_table_shown(&t, m->to, m->display_factor, VALUE_DIGITS);
        mt_table_integer(&t, m->positions);
        if (m->mode > 0) {
            mt_table_integer(&t, m->mode);
        } else {
            mt_table_text(&t, NULL);
        }
        mt_table_text(&t, m->band);
        mt_table_shown(&t, m->at, m->display_factor, VALUE_DIGITS);
        mt_table_number(&t, m->hz, HZ_DIGITS);
        mt_table_clearance(&t, m->least_clearance_percent, m->margin_percent, PERCENT_DIGITS);
        mt_table_text(&t, m->crosses ? "crosses a band" : m->grade);
    }
    return t;
}

mt_table mt_report_clearances(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    const bool worst = r->worst_case != NULL;
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mode", "mode", MT_ALIGN_RIGHT);
    mt_table_column(&t, "[Hz]", "hz", MT_ALIGN_POINT);
    mt_table_column(&t, "above band", "above_band", MT_ALIGN_LEFT);
    mt_table_column(&t, "by [%]", "above_percent", MT_ALIGN_POINT);
    if (worst) {
        mt_table_column(&t, "at worst [%]", "above_worst_percent", MT_ALIGN_POINT);
    }
    mt_table_column(&t, "below band", "below_band", MT_ALIGN_LEFT);
    mt_table_column(&t, "by [%]", "below_percent", MT_ALIGN_POINT);
    if (worst) {
        mt_table_column(&t, "at worst [%]", "below_worst_percent", MT_ALIGN_POINT);
    }
    for (int i = 0; i < r->n_clearances; i++) {
        const mt_result_clearance *const c = &r->clearances[i];
        const mt_result_clearance *above = strcmp(c->side, "above") == 0 ? c : NULL;
        const mt_result_clearance *below = strcmp(c->side, "below") == 0 ? c : NULL;
        const bool inside = above == NULL && below == NULL;
        /* that of the same mode on the other side: the lists have its lower band first */
        if (above != NULL && i + 1 < r->n_clearances && c->mode == c[1].mode &&
            strcmp(c->configuration, c[1].configuration) == 0 &&
            strcmp(c[1].side, "below") == 0) {
            below = c + 1;
            i++;
        }
        mt_table_text(&t, c->configuration);
        mt_table_integer(&t, c->mode);
        mt_table_number(&t, c->hz, HZ_DIGITS);
        if (inside) {
            char text[REQUIREMENT_TEXT];
            (void)mt_snprintf(text, sizeof text, "inside %.100s", c->band);
            mt_table_text(&t, text);
        } else {
            mt_table_text(&t, above != NULL ? above->band : NULL);
        }
        percent_cells(&t, r, inside ? c : above);
        mt_table_text(&t, below != NULL ? below->band : NULL);
        percent_cells(&t, r, below);
    }
    return t;
}

mt_table mt_report_placements(const mt_recommendation *r)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "band", "band", MT_ALIGN_LEFT);
    mt_table_column(&t, "from [Hz]", "lower_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "to [Hz]", "upper_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "with margin from", "margin_lower_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "to", "margin_upper_hz", MT_ALIGN_POINT);
    mt_table_column(&t, "modes below", "modes_below", MT_ALIGN_RIGHT);
    for (int i = 0; i < r->n_placements; i++) {
        const mt_result_mode_placement *const g = &r->placements[i];
        mt_table_text(&t, g->configuration);
        mt_table_text(&t, g->band);
        mt_table_number(&t, g->lower_hz, HZ_DIGITS);
        mt_table_number(&t, g->upper_hz, HZ_DIGITS);
        mt_table_number(&t, g->margin_lower_hz, HZ_DIGITS);
        mt_table_number(&t, g->margin_upper_hz, HZ_DIGITS);
        mt_table_integer(&t, g->modes_below);
    }
    return t;
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
            mt_table_quoted(&t, p->published, p->display_factor);
            mt_table_shown(&t, p->computed, p->display_factor, VALUE_DIGITS);
        }
        mt_table_difference(&t, p->difference, p->difference_percent, p->display_factor,
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
        mt_table_in_unit(t,
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
            report_objective_cell(t, o == NULL ? "" : o->unit,
                                  o == NULL ? nan("") : o->recommended);
        }
    }
}

static void point_row(mt_table *t, const mt_result *result, const mt_trade_point *p)
{
    for (int i = 0; i < result->trade->n_vary; i++) {
        mt_table_in_unit(t, p->values[i], result->trade->vary[i].display_factor, VALUE_DIGITS);
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

mt_table mt_report_trade_selected(const mt_result *result)
{
    return points(result, false);
}

void mt_report_trade_left(const mt_result *result, mt_text *line)
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
