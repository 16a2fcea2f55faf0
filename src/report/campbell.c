/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Campbell diagrams: frequency over the speed of what turns. Orders are straight lines through
 * the origin, modes horizontals; where they cross within the operating range a mode is excited.
 * One diagram for each rotor and machine that the study avoids.
 */
#include "report/campbell.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "report/svg.h"
#include "report/table.h"

/* Layout in pixels. */
enum {
    WIDTH = 760,
    HEIGHT = 520,
    LEFT = 66,
    RIGHT = 650, /* labels of orders stand behind it */
    TOP = 44,    /* and above it, in two rows */
    BOTTOM = 420,
    LABEL_GAP = 13, /* between labels below each other */
    ROWS = 2,
    LABELS_MOST = 64,
    TEXT_SIZE = 96
};

/* Of a letter of 12 px, on average; a little generous. */
static const double LETTER = 7.0;
static const double PERCENT = 100.0;
static const double RPM_PER_HZ = 60.0;
/* The plot goes so far beyond the operating range and the highest mode. */
static const double BEYOND_SPEED = 1.08;
static const double BEYOND_MODES = 1.2;
static const double NEAR = 2.0;

typedef struct plot {
    const mt_result_excitation *e;
    const mt_recommendation *rec;
    bool before;   /* rec has been changed: original frequencies are shown, too */
    int which;     /* number of the diagram in the page */
    double x_most; /* speed [1/s] */
    double y_most; /* frequency [Hz] */
    int n_labels;
    double label_y[LABELS_MOST];
    int n_top; /* labels above the plot: their row, left and right end */
    int top_row[LABELS_MOST];
    double top_from[LABELS_MOST];
    double top_to[LABELS_MOST];
    mt_text *out;
} plot;

static double place_x(const plot *p, double speed)
{
    return LEFT + (speed / p->x_most * (RIGHT - LEFT));
}

static double place_y(const plot *p, double hz)
{
    return BOTTOM - (hz / p->y_most * (BOTTOM - TOP));
}

/* Does the goal hold where this frequency was found? */
static bool concerns(const plot *p, const mt_result_frequency *f)
{
    for (int i = 0; i < p->e->n_configurations; i++) {
        if (f->configuration != NULL &&
            strcmp(f->configuration, p->e->configurations[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* Is there room for another label at this height? Then it is taken. */
static bool take_label(plot *p, double y)
{
    for (int i = 0; i < p->n_labels; i++) {
        if (fabs(p->label_y[i] - y) < LABEL_GAP) {
            return false;
        }
    }
    if (p->n_labels == LABELS_MOST) {
        return false;
    }
    p->label_y[p->n_labels++] = y;
    return true;
}

/* A row above the plot where a label of so many letters has room at x, which it then takes; -1:
 * none. */
static int take_top(plot *p, double x, size_t letters)
{
    const double half = 0.5 * LETTER * (double)letters;
    for (int row = 0; row < ROWS && p->n_top < LABELS_MOST; row++) {
        bool is_free = x - half > 0.0;
        for (int i = 0; i < p->n_top; i++) {
            is_free = is_free && (p->top_row[i] != row || x + half < p->top_from[i] ||
                                  x - half > p->top_to[i]);
        }
        if (is_free) {
            p->top_row[p->n_top] = row;
            p->top_from[p->n_top] = x - half;
            p->top_to[p->n_top++] = x + half;
            return row;
        }
    }
    return -1;
}

/* The greater of the mode's frequencies that are shown and lie at or below `top`; 0 where there
 * is none. */
static double within(const plot *p, const mt_result_frequency *f, double top)
{
    const double before = p->before && f->original_hz <= top ? f->original_hz : 0.0;
    const double after = f->recommended_hz <= top ? f->recommended_hz : 0.0;
    return concerns(p, f) ? fmax(before, after) : 0.0;
}

/* As high as the modes that some order comes near to; one that lies far above all of them would
 * press the rest flat. */
static void set_scales(plot *p)
{
    double modes = 0.0;
    double least = HUGE_VAL;
    double most = 0.0;
    for (int i = 0; i < p->e->n_orders; i++) {
        least = fmin(least, p->e->orders[i].order);
        most = fmax(most, p->e->orders[i].order);
    }
    p->x_most = p->e->speed_upper_hz * BEYOND_SPEED;
    const double top = most * p->x_most * (1.0 + p->e->margin_percent / PERCENT);
    for (int i = 0; i < p->rec->n_frequencies; i++) {
        modes = fmax(modes, within(p, &p->rec->frequencies[i], BEYOND_MODES * top));
    }
    p->y_most = fmax(modes * BEYOND_MODES, least * p->x_most);
    for (int i = 0; i < p->e->n_orders; i++) { /* the next band above them, if it is near */
        const double next = p->e->orders[i].order * p->e->speed_lower_hz;
        if (next > modes && next < NEAR * modes) {
            p->y_most = fmax(p->y_most, next * BEYOND_MODES);
        }
    }
}

static void add_axes(const plot *p)
{
    mt_text *const out = p->out;
    const double step_x = mt_svg_step(p->x_most * RPM_PER_HZ);
    const double step_y = mt_svg_step(p->y_most);
    for (int k = 0; (double)k * step_x <= p->x_most * RPM_PER_HZ; k++) {
        const double x = place_x(p, (double)k * step_x / RPM_PER_HZ);
        mt_text_addf(out,
                     "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#e4e4e4\"/>"
                     "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.6g</text>\n",
                     x, TOP, x, BOTTOM, x, BOTTOM + 17, (double)k * step_x);
    }
    for (int k = 0; (double)k * step_y <= p->y_most; k++) {
        const double y = place_y(p, (double)k * step_y);
        mt_text_addf(out,
                     "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"#e4e4e4\"/>"
                     "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.6g</text>\n",
                     LEFT, y, RIGHT, y, LEFT - 7, y + 4.0, (double)k * step_y);
    }
    mt_text_addf(out,
                 "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">speed [1/min]</text>\n"
                 "<text transform=\"translate(16 %d) rotate(-90)\" "
                 "text-anchor=\"middle\">frequency [Hz]</text>\n",
                 (LEFT + RIGHT) / 2, BOTTOM + 38, (TOP + BOTTOM) / 2);
}

/* The operating range, and in it what an order with its margin forbids. */
static void add_shades(const plot *p)
{
    const mt_result_excitation *const e = p->e;
    const double from = place_x(p, e->speed_lower_hz);
    const double to = place_x(p, e->speed_upper_hz);
    mt_text_addf(p->out,
                 "<rect x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"#eef3f8\"/>\n",
                 from, TOP, fmax(to - from, 1.0), BOTTOM - TOP);
    for (int i = 0; i < e->n_orders && e->margin_percent > 0.0; i++) {
        const double low = e->orders[i].order * (1.0 - e->margin_percent / PERCENT);
        const double high = e->orders[i].order * (1.0 + e->margin_percent / PERCENT);
        mt_text_addf(p->out,
                     "<polygon clip-path=\"url(#campbell%d)\" points=\"%.1f,%.1f %.1f,%.1f "
                     "%.1f,%.1f %.1f,%.1f\" fill=\"#d6604d\" fill-opacity=\"0.18\"/>\n",
                     p->which, from, place_y(p, low * e->speed_lower_hz), to,
                     place_y(p, low * e->speed_upper_hz), to,
                     place_y(p, high * e->speed_upper_hz), from,
                     place_y(p, high * e->speed_lower_hz));
    }
}

static void add_text(const plot *p, double x, double y, const char *anchor, const char *colour,
                     const char *text)
{
    mt_text_addf(p->out,
                 "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" fill=\"%s\" "
                 "stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">",
                 x, y, anchor, colour);
    mt_html_escape(text, p->out);
    mt_text_add(p->out, "</text>\n");
}

static bool is_sideband(const mt_result_order *o)
{
    return strpbrk(o->label, "+-") != NULL;
}

/* Its end: at the right edge or at the top. (A result file may hold an order of 0, too.) */
static double end_of(const plot *p, const mt_result_order *o)
{
    return p->y_most < o->order * p->x_most ? p->y_most / o->order : p->x_most;
}

static void name_order(plot *p, const mt_result_order *o)
{
    const double speed = end_of(p, o);
    const double x = place_x(p, speed);
    const double y = place_y(p, speed * o->order);
    if (speed == p->x_most) {
        if (take_label(p, y)) {
            add_text(p, RIGHT + 6, y + 4.0, "start", "#b2182b", o->label);
        }
        return;
    }
    const int row = take_top(p, x, strlen(o->label));
    if (row >= 0) {
        add_text(p, x, TOP - 7 - (row * LABEL_GAP), "middle", "#b2182b", o->label);
    }
}

/* All lines, then their names where there is room: those of sidebands last. */
static void add_orders(plot *p)
{
    p->n_labels = 0;
    for (int i = 0; i < p->e->n_orders; i++) {
        const mt_result_order *const o = &p->e->orders[i];
        const double speed = end_of(p, o);
        mt_text_addf(p->out,
                     "<line x1=\"%d\" y1=\"%d\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#b2182b\" "
                     "stroke-width=\"%s\"/>\n",
                     LEFT, BOTTOM, place_x(p, speed), place_y(p, speed * o->order),
                     is_sideband(o) ? "0.6" : "1.2");
    }
    for (int i = 0; i < 2 * p->e->n_orders; i++) {
        const mt_result_order *const o = &p->e->orders[i % p->e->n_orders];
        if (is_sideband(o) == (i >= p->e->n_orders)) {
            name_order(p, o);
        }
    }
}

static void add_mode(const plot *p, double hz, bool after)
{
    if (isfinite(hz) && hz <= p->y_most) {
        mt_text_addf(p->out,
                     "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\" stroke=\"%s\" "
                     "stroke-width=\"%s\"%s/>\n",
                     LEFT, place_y(p, hz), RIGHT, place_y(p, hz), after ? "#2166ac" : "#777",
                     after ? "2" : "1.5", after ? "" : " stroke-dasharray=\"6 4\"");
    }
}

static void name_mode(plot *p, const mt_result_frequency *f, double hz, bool after)
{
    char text[TEXT_SIZE];
    const double y = place_y(p, hz) - 5.0;
    const double from = place_x(p, p->e->speed_lower_hz);
    const bool left = from < 0.5 * (LEFT + RIGHT); /* room behind the lower speed, or before */
    if (!isfinite(hz) || hz > p->y_most || !take_label(p, y)) {
        return;
    }
    (void)mt_snprintf(text, sizeof text, "%.40s%smode %d, %.4g Hz",
                      p->e->n_configurations > 1 ? f->configuration : "",
                      p->e->n_configurations > 1 ? " " : "", f->mode, hz);
    add_text(p, left ? from + 6.0 : from - 6.0, y, left ? "start" : "end",
             after ? "#2166ac" : "#555", text);
}

/* Where an order meets the mode within the operating range. */
static void add_crossings(const plot *p, const mt_result_frequency *f, double hz, bool after)
{
    const mt_result_excitation *const e = p->e;
    for (int i = 0; i < e->n_orders && isfinite(hz); i++) {
        const double order = e->orders[i].order;
        if (!(order > 0.0) || hz < order * e->speed_lower_hz ||
            hz > order * e->speed_upper_hz) {
            continue;
        }
        const double speed = hz / order;
        mt_text_addf(p->out,
                     "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.5\" fill=\"%s\" stroke=\"%s\" "
                     "stroke-width=\"1.5\"><title>",
                     place_x(p, speed), place_y(p, hz), after ? "#b2182b" : "#fff",
                     after ? "#b2182b" : "#555");
        mt_html_escape(e->orders[i].label, p->out);
        mt_text_addf(p->out, " meets mode %d %s at %.5g/min</title></circle>\n", f->mode,
                     after ? "after" : "before", speed * RPM_PER_HZ);
    }
}

static void add_modes(plot *p)
{
    p->n_labels = 0;
    for (int pass = 0; pass < 3; pass++) { /* lines, then marks, then names */
        for (int k = 0; k < 2 * p->rec->n_frequencies; k++) {
            const bool after = k < p->rec->n_frequencies;
            const mt_result_frequency *const f =
                &p->rec->frequencies[k % p->rec->n_frequencies];
            const double hz = after ? f->recommended_hz : f->original_hz;
            if (!concerns(p, f) || !(after || p->before)) {
                continue;
            }
            if (pass == 0) {
                add_mode(p, hz, after);
            } else if (pass == 1) {
                add_crossings(p, f, hz, after);
            } else {
                name_mode(p, f, hz, after);
            }
        }
    }
}

/* "2 modes lie higher" */
static void add_hidden(const plot *p)
{
    int n = 0;
    for (int i = 0; i < p->rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &p->rec->frequencies[i];
        n += concerns(p, f) && f->recommended_hz > p->y_most ? 1 : 0;
    }
    if (n > 0) {
        char text[TEXT_SIZE];
        (void)mt_snprintf(text, sizeof text, "%d mode%s higher", n, n == 1 ? " lies" : "s lie");
        add_text(p, LEFT + 8, TOP + 15, "start", "#2166ac", text);
    }
}

static void add_legend(const plot *p)
{
    const mt_result_excitation *const e = p->e;
    const int y = BOTTOM + 62;
    const int below = y + 22;
    const char *const now = p->before ? "after" : "as they are";
    mt_text_addf(p->out,
                 "<rect x=\"%d\" y=\"%d\" width=\"24\" height=\"11\" fill=\"#eef3f8\" "
                 "stroke=\"#c5d3e0\"/>"
                 "<text x=\"%d\" y=\"%d\">operating range, %.5g to %.5g/min</text>\n",
                 LEFT, y - 9, LEFT + 30, y, e->speed_lower_hz * RPM_PER_HZ,
                 e->speed_upper_hz * RPM_PER_HZ);
    mt_text_addf(p->out,
                 "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"#b2182b\" "
                 "stroke-width=\"1.2\"/><text x=\"%d\" y=\"%d\">orders",
                 LEFT + 300, y - 4, LEFT + 324, y - 4, LEFT + 330, y);
    if (e->margin_percent > 0.0) {
        mt_text_addf(p->out, ", shaded: with their margin of %.3g %%", e->margin_percent);
    }
    mt_text_addf(p->out,
                 "</text>\n<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"#2166ac\" "
                 "stroke-width=\"2\"/><text x=\"%d\" y=\"%d\">modes %s</text>\n",
                 LEFT, below - 4, LEFT + 24, below - 4, LEFT + 30, below, now);
    mt_text_addf(p->out,
                 "<circle cx=\"%d\" cy=\"%d\" r=\"4.5\" fill=\"#b2182b\"/><text x=\"%d\" "
                 "y=\"%d\">resonances %s</text>\n",
                 LEFT + 312, below - 4, LEFT + 330, below, now);
    if (p->before) {
        mt_text_addf(p->out,
                     "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"#777\" "
                     "stroke-width=\"1.5\" stroke-dasharray=\"6 4\"/><text x=\"%d\" "
                     "y=\"%d\">modes before</text>\n",
                     LEFT + 150, below - 4, LEFT + 174, below - 4, LEFT + 180, below);
        mt_text_addf(p->out,
                     "<circle cx=\"%d\" cy=\"%d\" r=\"4.5\" fill=\"#fff\" stroke=\"#555\" "
                     "stroke-width=\"1.5\"/><text x=\"%d\" y=\"%d\">resonances before</text>\n",
                     LEFT + 472, below - 4, LEFT + 484, below);
    }
}

void mt_report_svg_campbell(const mt_result *result, mt_text *out)
{
    const bool found = result->n_recommendations > 0;
    for (int i = 0; i < result->n_excitations; i++) {
        plot p = {.e = &result->excitations[i],
                  .rec = found ? &result->recommendations[0] : &result->baseline,
                  .before = found,
                  .which = i,
                  .out = out};
        set_scales(&p);
        if (!(p.x_most > 0.0) || !(p.y_most > 0.0) || !isfinite(p.y_most)) {
            continue;
        }
        mt_text_add(out, "<h2>Campbell diagram: ");
        mt_html_escape(p.e->name, out);
        mt_text_addf(
            out,
            "</h2>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "width=\"%d\" height=\"%d\" role=\"img\"><title>Campbell diagram: frequency "
            "over speed, orders through the origin, modes horizontal</title>\n"
            "<clipPath id=\"campbell%d\"><rect x=\"%d\" y=\"%d\" width=\"%d\" "
            "height=\"%d\"/></clipPath>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT, p.which, LEFT, TOP, RIGHT - LEFT, BOTTOM - TOP);
        add_shades(&p);
        add_axes(&p);
        add_orders(&p);
        add_modes(&p);
        mt_text_addf(out, "<path d=\"M%d %dV%dH%d\" fill=\"none\" stroke=\"#333\"/>\n", LEFT,
                     TOP, BOTTOM, RIGHT);
        add_hidden(&p);
        add_legend(&p);
        mt_text_add(out, "</svg>\n");
    }
}
