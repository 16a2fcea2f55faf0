/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/result_tables.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "report/number.h"

/* Frequencies to 6 digits show changes of 1e-5; percentages and sizes of changes need no more
 * than 3; parameters 6, as a drawing would. */
enum {
    HZ_DIGITS = 6,
    VALUE_DIGITS = 6,
    PERCENT_DIGITS = 3,
    MAC_DIGITS = 5,
    REQUIREMENT_TEXT = 120,
    WEIGHT_TEXT = 240
};

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

void mt_report_objective_cell(mt_table *t, const char *unit, double value)
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
        mt_report_objective_cell(&t, o->unit, o->original);
        mt_report_objective_cell(&t, o->unit, o->recommended);
    }
    return t;
}

/* The size of the redesign as tables call it, and as an objective is called that asks for the
 * least. */
static const char CHANGE[] = "change";

bool mt_report_has_objective(const mt_result *result, const char *text)
{
    for (int k = 0; k < result->n_objectives; k++) {
        if (strcmp(result->objectives[k].text, text) == 0) {
            return true;
        }
    }
    return false;
}

void mt_report_clearance_column(mt_table *t, const mt_result *result)
{
    mt_table_column(t,
                    mt_report_has_objective(result, "clearance") ? "without margin [%]"
                                                                 : "clearance [%]",
                    "clearance_percent", MT_ALIGN_POINT);
}

void mt_report_objective_columns(mt_table *t, const mt_result *result)
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
    if (!mt_report_has_objective(result, CHANGE)) {
        mt_table_column(t, CHANGE, CHANGE, MT_ALIGN_POINT);
    }
}

void mt_report_objective_cells(mt_table *t, const mt_result *result, const mt_recommendation *r)
{
    for (int k = 0; k < result->n_objectives; k++) {
        mt_report_objective_cell(t, result->objectives[k].unit,
                                 k < r->n_objectives ? r->objectives[k].recommended : nan(""));
    }
    if (!mt_report_has_objective(result, CHANGE)) {
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
    mt_report_objective_cells(t, result, r);
    mt_table_off_by(t, r->violation_percent, r->feasible, PERCENT_DIGITS);
    if (result->baseline.n_placements > 0) {
        char text[REQUIREMENT_TEXT];
        mt_table_number(t, r->clearance_percent, PERCENT_DIGITS);
        mt_table_text(t, assignment(r, text, sizeof text));
    }
    mt_report_variable_cells(t, result, r);
}

mt_table mt_report_alternatives(const mt_result *result)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "rank", "rank", MT_ALIGN_RIGHT);
    mt_table_column(&t, "grade", "grade", MT_ALIGN_LEFT);
    mt_report_objective_columns(&t, result);
    mt_table_column(&t, "deviation [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->baseline.n_placements > 0) {
        mt_report_clearance_column(&t, result);
        mt_table_column(&t, "modes below bands", "gap_assignment", MT_ALIGN_LEFT);
    }
    const mt_recommendation *const first =
        result->n_recommendations > 0 ? &result->recommendations[0] : NULL;
    mt_report_variable_columns(&t, result, first);
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
    mt_report_objective_cells(t, result, r);
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
    mt_report_objective_columns(&t, result);
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
