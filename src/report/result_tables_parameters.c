/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of parameters, which people see in the units that they gave them in. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "report/number.h"
#include "report/result_tables.h"

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

void mt_report_variable_columns(mt_table *t, const mt_result *result,
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

void mt_report_variable_cells(mt_table *t, const mt_result *result, const mt_recommendation *r)
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
