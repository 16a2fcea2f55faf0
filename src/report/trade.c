/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trade studies: one line per point, and the curve of the best score over what varies. */
#include "report/trade.h"

#include <math.h>

#include "base/format.h"
#include "report/number.h"
#include "report/result_tables.h"

enum { VALUE_DIGITS = 6, PERCENT_DIGITS = 3, HEADING_TEXT = 160 };
/* Layout of the curve in pixels. */
enum {
    WIDTH = 760,
    HEIGHT = 320,
    LEFT = 90,
    RIGHT = 600,
    TOP = 20,
    BOTTOM = 270,
    DOT = 4,
    MARKS = 6,
    COLOURS = 6,
    LINE = 16
};

static void point_row(mt_table *t, const mt_result *result, const mt_trade_point *p)
{
    for (int i = 0; i < result->trade->n_vary; i++) {
        mt_table_number(t, p->values[i], VALUE_DIGITS);
    }
    mt_table_text(t, mt_result_status_name(p->status));
    mt_report_objective_cells(t, result, &p->best);
    mt_table_number(t, p->best.clearance_percent, PERCENT_DIGITS);
    mt_table_percent(t, p->best.violation_percent, PERCENT_DIGITS);
    if (result->trade->n_objectives == 2) {
        mt_table_text(t, p->pareto ? "yes" : "no");
    }
    for (int k = 0; k < result->n_variables; k++) {
        const bool has = k < p->best.n_parameters;
        mt_table_number(t, has ? p->best.parameters[k].recommended : nan(""), VALUE_DIGITS);
    }
}

mt_table mt_report_trade(const mt_result *result)
{
    mt_table t = mt_table_default();
    if (result->trade == NULL) {
        return t;
    }
    for (int i = 0; i < result->trade->n_vary; i++) {
        const mt_trade_vary *const v = &result->trade->vary[i];
        const bool bare = v->unit == NULL;
        char heading[HEADING_TEXT];
        (void)mt_snprintf(heading, sizeof heading, "%.120s%s%.20s%s", v->text, bare ? "" : " [",
                          bare ? "" : v->unit, bare ? "" : "]");
        mt_table_column(&t, heading, v->text, MT_ALIGN_POINT);
    }
    mt_table_column(&t, "status", "status", MT_ALIGN_LEFT);
    mt_report_objective_columns(&t, result);
    mt_report_clearance_column(&t, result);
    mt_table_column(&t, "off by [%]", "violation_percent", MT_ALIGN_POINT);
    if (result->trade->n_objectives == 2) {
        mt_table_column(&t, "front", "pareto", MT_ALIGN_LEFT);
    }
    for (int k = 0; k < result->n_variables; k++) {
        mt_table_column(&t, result->variables[k], result->variables[k], MT_ALIGN_POINT);
    }
    for (int i = 0; i < result->trade->n_points; i++) {
        point_row(&t, result, &result->trade->points[i]);
    }
    return t;
}

/* Half the stretch around a single great value, of that value. */
static const double SHARE_OF_ONE = 1e-6;

typedef struct frame {
    double low[2]; /* x, y */
    double high[2];
} frame;

static bool drawn(const mt_trade_point *p)
{
    return p->best.feasible && isfinite(p->best.score);
}

static frame frame_of(const mt_trade_result *trade)
{
    frame f = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (int i = 0; i < trade->n_points; i++) {
        const mt_trade_point *const p = &trade->points[i];
        const double at[2] = {p->values[trade->n_vary - 1], p->best.score};
        for (int k = 0; k < 2 && (drawn(p) || k == 0); k++) {
            f.low[k] = fmin(f.low[k], at[k]);
            f.high[k] = fmax(f.high[k], at[k]);
        }
    }
    for (int k = 0; k < 2; k++) {
        if (!(f.high[k] > f.low[k])) { /* one value: a stretch around it */
            const double half = fmax(0.5, SHARE_OF_ONE * fabs(f.high[k]));
            f.low[k] -= half;
            f.high[k] += half;
        }
    }
    return f;
}

static double x_of(const frame *f, double x)
{
    return LEFT + ((x - f->low[0]) / (f->high[0] - f->low[0]) * (RIGHT - LEFT));
}

static double y_of(const frame *f, double y)
{
    return BOTTOM - ((y - f->low[1]) / (f->high[1] - f->low[1]) * (BOTTOM - TOP));
}

static void axes(const frame *f, const mt_result *result, mt_text *out)
{
    const mt_trade_vary *const v = &result->trade->vary[result->trade->n_vary - 1];
    for (int i = 0; i <= MARKS; i++) {
        const double part = (double)i / MARKS;
        const double x = f->low[0] + (part * (f->high[0] - f->low[0]));
        const double y = f->low[1] + (part * (f->high[1] - f->low[1]));
        mt_text_addf(out,
                     "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#ddd\"/>"
                     "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.4g</text>\n",
                     x_of(f, x), TOP, x_of(f, x), BOTTOM, x_of(f, x), BOTTOM + 16, x);
        mt_text_addf(out,
                     "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#ddd\"/>"
                     "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.4g</text>\n",
                     LEFT, y_of(f, y), RIGHT, y_of(f, y), LEFT - 8, y_of(f, y) + 4.0, y);
    }
    mt_text_addf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", (LEFT + RIGHT) / 2,
                 BOTTOM + 36);
    mt_html_escape(v->text, out);
    mt_text_add(out, v->unit != NULL ? " [" : "");
    mt_html_escape(v->unit != NULL ? v->unit : "", out);
    mt_text_add(out, v->unit != NULL ? "]</text>\n" : "</text>\n");
}

/* Points first .. first + n - 1 as one line; a point without a design that meets the goals
 * breaks it. */
static void curve(const frame *f, const mt_trade_result *trade, int first, int n,
                  const char *colour, mt_text *out)
{
    bool pen = false;
    mt_text_addf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"2\" d=\"", colour);
    for (int i = first; i < first + n; i++) {
        const mt_trade_point *const p = &trade->points[i];
        if (drawn(p)) {
            mt_text_addf(out, "%s%.1f %.1f ", pen ? "L" : "M",
                         x_of(f, p->values[trade->n_vary - 1]), y_of(f, p->best.score));
        }
        pen = drawn(p);
    }
    mt_text_add(out, "\"/>\n");
    for (int i = first; i < first + n; i++) {
        const mt_trade_point *const p = &trade->points[i];
        const double x = x_of(f, p->values[trade->n_vary - 1]);
        if (drawn(p)) {
            mt_text_addf(
                out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\" stroke=\"%s\"/>\n",
                x, y_of(f, p->best.score), DOT, p->pareto ? colour : "#fff", colour);
        } else {
            mt_text_addf(out,
                         "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">&#215;</text>\n", x,
                         BOTTOM - 2);
        }
    }
}

void mt_report_svg_trade(const mt_result *result, mt_text *out)
{
    static const char *const colours[COLOURS] = {"#2166ac", "#b2182b", "#1b7837",
                                                 "#762a83", "#b8860b", "#444"};
    const mt_trade_result *const trade = result->trade;
    if (trade == NULL || trade->n_points < 1) {
        return;
    }
    int n = trade->n_points; /* of one curve: the points that share the first of two values */
    for (int i = 0; trade->n_vary == 2 && i < trade->n_points; i++) {
        if (trade->points[i].values[0] != trade->points[0].values[0]) {
            n = i;
            break;
        }
    }
    const frame f = frame_of(trade);
    if (!isfinite(f.high[0] - f.low[0]) || !isfinite(f.high[1] - f.low[1])) {
        return; /* no point has a design that meets its goals, or no scale holds them */
    }
    mt_text_addf(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
        "height=\"%d\" role=\"img\"><title>Best score of each point; full dots: on the "
        "front; crosses: goals not met</title>\n",
        WIDTH, HEIGHT, WIDTH, HEIGHT);
    axes(&f, result, out);
    for (int first = 0, curves = 0; first < trade->n_points; first += n, curves++) {
        const char *const colour = colours[curves % COLOURS];
        curve(&f, trade, first, n, colour, out);
        if (trade->n_vary == 2) {
            mt_text_addf(out, "<text x=\"%d\" y=\"%d\" fill=\"%s\">%.6g</text>\n", RIGHT + 24,
                         TOP + 12 + (curves * LINE), colour, trade->points[first].values[0]);
        }
    }
    mt_text_add(out, "</svg>\n");
}
