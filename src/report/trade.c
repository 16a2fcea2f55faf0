/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trade studies: one line per point. */
#include "report/trade.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "report/number.h"
#include "report/result_tables.h"

enum { VALUE_DIGITS = 6, PERCENT_DIGITS = 3, HEADING_TEXT = 160 };

/* True for objectives of the front that are not among the study's, and so need a column. */
static bool has_column(const mt_result *result, int k)
{
    static const char *const own[] = {"change", "clearance"};
    const char *const name = result->trade->objectives[k];
    bool known = mt_report_has_objective(result, name);
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
        mt_table_in_unit(t, p->values[i], result->trade->vary[i].display_factor, VALUE_DIGITS);
    }
    mt_table_text(t, mt_result_status_name(p->status));
    mt_report_objective_cells(t, result, &p->best);
    front_cells(t, result, p);
    mt_table_number(t, p->best.clearance_percent, PERCENT_DIGITS);
    mt_table_off_by(t, p->best.violation_percent, p->best.feasible, PERCENT_DIGITS);
    if (result->trade->n_objectives == 2) {
        mt_table_text(t, p->pareto ? "yes" : "no");
    }
    mt_report_variable_cells(t, result, &p->best);
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
    mt_report_objective_columns(t, result);
    front_columns(t, result);
    mt_report_clearance_column(t, result);
    mt_table_column(t, "deviation [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->trade->n_objectives == 2) {
        mt_table_column(t, "front", "pareto", MT_ALIGN_LEFT);
    }
    mt_report_variable_columns(t, result, any_design(result->trade));
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
