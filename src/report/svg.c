/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of the report: one row per frequency or parameter, drawn to a common linear
 * scale. */
#include "report/svg.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "report/number.h"
#include "report/table.h"

/* Layout in pixels. */
enum {
    WIDTH = 760,
    LEFT = 200, /* where the scale begins; names stand before it */
    RIGHT = 700,
    ROW = 22,
    TOP = 14,
    AXIS = 26,
    DOT = 5,
    LABEL_TEXT = 64
};

typedef struct scale {
    double low;
    double high;
} scale;

static double place(const scale *s, double x)
{
    return LEFT + ((x - s->low) / (s->high - s->low) * (RIGHT - LEFT));
}

static void widen(scale *s, double x)
{
    if (isfinite(x)) {
        s->low = fmin(s->low, x);
        s->high = fmax(s->high, x);
    }
}

double mt_svg_step(double length)
{
    const double raw = length / 6.0;
    const double power = pow(10.0, floor(log10(raw)));
    if (!(power > 0.0)) {
        return length; /* next to nothing: one mark */
    }
    const double lead = raw / power;
    return power * (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0);
}

static void begin(int rows, const char *title, mt_text *out)
{
    const int height = TOP + (rows * ROW) + AXIS;
    mt_text_addf(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
                 "height=\"%d\" role=\"img\"><title>%s</title>\n",
                 WIDTH, height, WIDTH, height, title);
}

static void axis(const scale *s, int rows, const char *unit, mt_text *out)
{
    const double step = mt_svg_step(s->high - s->low);
    const int bottom = TOP + (rows * ROW);
    const long first = (long)ceil(s->low / step);
    const long last = (long)floor(s->high / step);
    for (long k = first; k <= last; k++) {
        const double x = place(s, (double)k * step);
        mt_text_addf(out,
                     "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#ddd\"/>"
                     "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.6g</text>\n",
                     x, TOP - 4, x, bottom, x, bottom + 15, (double)k * step);
    }
    mt_text_addf(out, "<text x=\"%d\" y=\"%d\">%s</text>\n", RIGHT + 22, bottom + 15, unit);
}

static void row_label(int row, const char *label, mt_text *out)
{
    mt_text_addf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">", LEFT - 12,
                 TOP + (row * ROW) + (ROW / 2) + 4);
    mt_html_escape(label, out);
    mt_text_add(out, "</text>\n");
}

/* A shaded stretch of what is allowed, a mark for a target. */
static void demand(const scale *s, const mt_result_frequency *f, int y, mt_text *out)
{
    if (isfinite(f->at_least_hz) || isfinite(f->at_most_hz)) {
        const double a = place(s, isfinite(f->at_least_hz) ? f->at_least_hz : s->low);
        const double b = place(s, isfinite(f->at_most_hz) ? f->at_most_hz : s->high);
        mt_text_addf(
            out, "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"12\" fill=\"#d9efdc\"/>\n",
            a, y - 6, b > a ? b - a : 0.0);
    }
    if (isfinite(f->target_hz)) {
        const double x = place(s, f->target_hz);
        mt_text_addf(out,
                     "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#1b7837\" "
                     "stroke-width=\"3\"/>\n",
                     x, y - 9, x, y + 9);
    }
}

/* Bands behind the rows of their configuration, the margin lighter. */
static void shade(const scale *s, double low, double high, int row, const char *colour,
                  mt_text *out)
{
    const double a = place(s, fmax(low, s->low));
    const double b = place(s, fmin(high, s->high));
    if (b > a) {
        mt_text_addf(out,
                     "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>\n",
                     a, TOP + (row * ROW), b - a, ROW, colour);
    }
}

static void bands(const scale *s, const mt_recommendation *r, int row, mt_text *out)
{
    const char *const configuration = r->frequencies[row].configuration;
    for (int i = 0; i < r->n_gaps; i++) {
        const mt_result_gap *const g = &r->gaps[i];
        if (configuration != NULL && g->configuration != NULL &&
            strcmp(configuration, g->configuration) == 0) {
            shade(s, g->margin_lower_hz, g->margin_upper_hz, row, "#fbe3df", out);
            shade(s, g->lower_hz, g->upper_hz, row, "#f2b8ae", out);
        }
    }
}

void mt_report_svg_frequencies(const mt_recommendation *r, mt_text *out)
{
    scale s = {0.0, 0.0};
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        widen(&s, f->original_hz);
        widen(&s, f->recommended_hz);
        widen(&s, f->target_hz);
        widen(&s, f->at_least_hz);
        widen(&s, f->at_most_hz);
    }
    s.high = s.high > 0.0 ? s.high * 1.05 : 1.0;
    if (!isfinite(s.high - s.low)) {
        return; /* no scale holds them */
    }
    begin(r->n_frequencies,
          r->n_gaps > 0
              ? "Frequencies: open circles before, full after, green what is asked, red "
                "the bands, lighter their margin"
              : "Frequencies: open circles before, full after, green what is asked",
          out);
    for (int i = 0; i < r->n_frequencies; i++) {
        bands(&s, r, i, out);
    }
    axis(&s, r->n_frequencies, "Hz", out);
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        const int y = TOP + (i * ROW) + (ROW / 2);
        char label[LABEL_TEXT];
        (void)mt_snprintf(label, sizeof label, "%.24s, mode %d",
                          f->configuration == NULL ? "" : f->configuration, f->mode);
        row_label(i, label, out);
        demand(&s, f, y, out);
        if (isfinite(f->original_hz)) {
            mt_text_addf(out,
                         "<circle cx=\"%.1f\" cy=\"%d\" r=\"%d\" fill=\"none\" stroke=\"#555\" "
                         "stroke-width=\"1.5\"/>\n",
                         place(&s, f->original_hz), y, DOT);
        }
        if (isfinite(f->recommended_hz)) {
            mt_text_addf(out, "<circle cx=\"%.1f\" cy=\"%d\" r=\"%d\" fill=\"#2166ac\"/>\n",
                         place(&s, f->recommended_hz), y, DOT);
        }
    }
    mt_text_add(out, "</svg>\n");
}

void mt_report_svg_changes(const mt_recommendation *r, mt_text *out)
{
    scale s = {0.0, 0.0};
    for (int i = 0; i < r->n_parameters; i++) {
        widen(&s, r->parameters[i].change_percent);
    }
    if (!(s.high - s.low > 0.0) || !isfinite(s.high - s.low)) {
        return; /* nothing changes, or beyond any scale */
    }
    begin(r->n_parameters, "Change of each parameter in per cent", out);
    axis(&s, r->n_parameters, "%", out);
    const double zero = place(&s, 0.0);
    for (int i = 0; i < r->n_parameters; i++) {
        const mt_result_parameter *const p = &r->parameters[i];
        const int y = TOP + (i * ROW) + 4;
        row_label(i, p->name, out);
        if (isfinite(p->change_percent)) {
            const double x = place(&s, p->change_percent);
            mt_text_addf(
                out, "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>\n",
                fmin(x, zero), y, fabs(x - zero), ROW - 8,
                p->change_percent < 0.0 ? "#b2182b" : "#2166ac");
        }
    }
    mt_text_addf(out, "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#333\"/>\n",
                 zero, TOP - 4, zero, TOP + (r->n_parameters * ROW));
    mt_text_add(out, "</svg>\n");
}
