/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trade studies: one line per point. */
#include "report/trade.h"

#include <math.h>

#include "base/format.h"
#include "report/number.h"
#include "report/result_tables.h"

enum { VALUE_DIGITS = 6, PERCENT_DIGITS = 3, HEADING_TEXT = 160 };

static void point_row(mt_table *t, const mt_result *result, const mt_trade_point *p)
{
    for (int i = 0; i < result->trade->n_vary; i++) {
        mt_table_shown(t, p->values[i], result->trade->vary[i].display_factor, VALUE_DIGITS);
    }
    mt_table_text(t, mt_result_status_name(p->status));
    mt_report_objective_cells(t, result, &p->best);
    mt_table_number(t, p->best.clearance_percent, PERCENT_DIGITS);
    mt_table_percent(t, p->best.violation_percent, PERCENT_DIGITS);
    if (result->trade->n_objectives == 2) {
        mt_table_text(t, p->pareto ? "yes" : "no");
    }
    mt_report_variable_cells(t, result, &p->best);
}

/* One that has parameters; NULL: none has. */
static const mt_recommendation *any_design(const mt_trade_result *trade)
{
    for (int i = 0; i < trade->n_points; i++) {
        if (trade->points[i].best.n_parameters > 0) {
            return &trade->points[i].best;
        }
    }
    return NULL;
}

mt_table mt_report_trade(const mt_result *result)
{
    mt_table t = mt_table_default();
    if (result->trade == NULL) {
        return t;
    }
    for (int i = 0; i < result->trade->n_vary; i++) {
        const mt_trade_vary *const v = &result->trade->vary[i];
        const char *const unit = v->display_unit != NULL ? v->display_unit : v->unit;
        const bool bare = unit == NULL;
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "%.120s%s%.20s%s", v->text, bare ? "" : " [",
                          bare ? "" : unit, bare ? "" : "]");
        mt_table_column(&t, heading, v->text, MT_ALIGN_POINT);
    }
    mt_table_column(&t, "status", "status", MT_ALIGN_LEFT);
    mt_report_objective_columns(&t, result);
    mt_report_clearance_column(&t, result);
    mt_table_column(&t, "off by [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->trade->n_objectives == 2) {
        mt_table_column(&t, "front", "pareto", MT_ALIGN_LEFT);
    }
    mt_report_variable_columns(&t, result, any_design(result->trade));
    for (int i = 0; i < result->trade->n_points; i++) {
        point_row(&t, result, &result->trade->points[i]);
    }
    return t;
}
