/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of text: rulers of frequencies, and responses. */
#include "report/ruler.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "report/table.h"

/* Rulers. */

enum { INDENT = 2, LEAST = 30, USUAL = 64, MOST = 96, ROOM = MOST + 16, NUMBER = 24 };
static const double ABOVE = 1.12; /* what is shown above the last thing asked for */
static const double NEAR = 1.6;   /* a band that begins farther above the modes is not shown */

typedef struct ruler {
    double top;    /* Hz at its end */
    int length;    /* columns */
    int label;     /* of the longest name */
    bool has[256]; /* marks that were drawn */
    mt_text *out;
} ruler;

static void raise_top_frequency(double *top, double hz)
{
    *top = isfinite(hz) && hz > *top ? hz : *top;
}

/* The highest mode that no band lies wholly below; 0: none. */
static double highest_mode(const mt_recommendation *r)
{
    double bands = 0.0;
    double top = 0.0;
    for (int i = 0; i < r->n_placements; i++) {
        raise_top_frequency(&bands, r->placements[i].margin_upper_hz);
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        raise_top_frequency(&top, f->original_hz <= bands ? f->original_hz : 0.0);
        raise_top_frequency(&top, f->recommended_hz <= bands ? f->recommended_hz : 0.0);
    }
    return top;
}

/* Widen the range by the required modes, recommended and original, that are not far above all
 * requirements. */
static void widen_asked(double *top, const mt_recommendation *r)
{
    const double near = NEAR * *top;
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        const bool asked =
            isfinite(f->target_hz) || isfinite(f->at_least_hz) || isfinite(f->at_most_hz);
        raise_top_frequency(top, asked && f->original_hz <= near ? f->original_hz : 0.0);
        raise_top_frequency(top, asked && f->recommended_hz <= near ? f->recommended_hz : 0.0);
    }
}

/* The highest frequency of interest: what is asked for, and the bands beside modes; 0: none. */
static double highest(const mt_recommendation *r)
{
    double top = highest_mode(r);
    for (int i = 0; i < r->n_frequencies; i++) {
        raise_top_frequency(&top, r->frequencies[i].target_hz);
        raise_top_frequency(&top, r->frequencies[i].at_least_hz);
        raise_top_frequency(&top, r->frequencies[i].at_most_hz);
    }
    widen_asked(&top, r);
    const double near = top > 0.0 ? NEAR * top : HUGE_VAL;
    for (int i = 0; i < r->n_placements; i++) {
        if (r->placements[i].margin_lower_hz <= near) {
            raise_top_frequency(&top, fmin(r->placements[i].margin_upper_hz, near));
        }
    }
    return top;
}

/* The column of a frequency; one in the middle of two columns, but for rounding, gets the right
 * one. */
static int frequency_column(const ruler *u, double hz)
{
    return (int)floor((hz / u->top * (u->length - 1)) + 0.5 + MT_TIE);
}

/* Put a mark on the line where it is in range and no mark of higher priority is there. */
static void mark_frequency(ruler *u, char *line, double hz, char sign, const char *over)
{
    if (!(hz >= 0.0) || hz > u->top) {
        return;
    }
    char *const at = &line[frequency_column(u, hz)];
    if (strchr(over, *at) != NULL) {
        *at = sign;
        u->has[(unsigned char)sign] = true;
    }
}

static void shade(ruler *u, char *line, double from, double to, char sign)
{
    if (!(from <= to) || to < 0.0 || from > u->top) {
        return;
    }
    const int last = frequency_column(u, fmin(to, u->top));
    for (int i = frequency_column(u, fmax(from, 0.0)); i <= last; i++) {
        line[i] = sign;
        u->has[(unsigned char)sign] = true;
    }
}

static bool is_same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

static void draw_bands(ruler *u, const mt_recommendation *r, const char *of, char *line)
{
    for (int i = 0; i < r->n_placements; i++) {
        if (is_same_name(r->placements[i].configuration, of)) {
            shade(u, line, r->placements[i].margin_lower_hz, r->placements[i].margin_upper_hz,
                  '-');
        }
    }
    for (int i = 0; i < r->n_placements; i++) {
        if (is_same_name(r->placements[i].configuration, of)) {
            shade(u, line, r->placements[i].lower_hz, r->placements[i].upper_hz, '#');
        }
    }
}

/* Draw requirements, then the original modes, then the recommended ones over them. */
static int draw_modes(ruler *u, const mt_recommendation *r, const char *of, char *line)
{
    static const char digits[] = "0123456789";
    int beyond = 0;
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of)) {
            mark_frequency(u, line, f->at_least_hz, '[', " -#");
            mark_frequency(u, line, f->at_most_hz, ']', " -#");
            mark_frequency(u, line, f->target_hz, '|', " -#[]");
        }
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of) && r->rank > 0) {
            mark_frequency(u, line, f->original_hz, 'o', " -#[]|");
        }
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (is_same_name(f->configuration, of)) {
            beyond += f->recommended_hz > u->top ? 1 : 0;
            const char sign = (char)(f->mode < 10 ? digits[f->mode] : '+');
            mark_frequency(u, line, f->recommended_hz, sign, " -#[]|o");
        }
    }
    return beyond;
}

static void add_ruler_line(ruler *u, const mt_recommendation *r, const char *of)
{
    char line[ROOM];
    const char *const name = of == NULL ? "" : of;
    memset(line, ' ', (size_t)u->length);
    line[u->length] = '\0';
    draw_bands(u, r, of, line);
    const int beyond = draw_modes(u, r, of, line);
    mt_text_addf(u->out, "  %s%*s  %s", name, u->label - mt_text_width(name), "", line);
    if (beyond > 0) {
        mt_text_addf(u->out, " >%d", beyond);
    }
    while (!u->out->failed && u->out->s[u->out->length - 1] == ' ') {
        u->out->s[--u->out->length] = '\0';
    }
    mt_text_add(u->out, "\n");
}

/* Distance of marks on a scale of this length: 1, 2 or 5 times a power of ten, about six. */
static double step_of(double length)
{
    const double raw = length / 6.0;
    const double power = pow(10.0, floor(log10(raw)));
    const double lead = raw / power;
    if (!(power > 0.0)) {
        return length; /* next to nothing: one mark */
    }
    return power * (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0);
}

static void add_scale(const ruler *u)
{
    char line[ROOM];
    char number[NUMBER];
    const double step = step_of(u->top);
    int end = 0; /* of what stands there so far */
    memset(line, ' ', sizeof line);
    for (int k = 0; k * step <= u->top; k++) {
        (void)mt_snprintf(number, sizeof number, "%.6g", k * step);
        const int length = (int)strlen(number);
        const int at = frequency_column(u, k * step);
        if (at >= end && at + length < ROOM) {
            memcpy(line + at, number, (size_t)length);
            end = at + length + 1;
        }
    }
    line[end > 0 ? end - 1 : 0] = '\0';
    mt_text_addf(u->out, "  %*s  %s Hz\n", u->label, "", line);
}

static void add_legend(const ruler *u)
{
    static const struct {
        char sign;
        const char *text;
    } signs[] = {{'o', "o: before"},    {'#', "#: band"},        {'-', "-: its margin"},
                 {'|', "|: target"},    {'[', "[: lower limit"}, {']', "]: upper limit"},
                 {'+', "+: from 10 on"}};
    mt_text_add(u->out, "  digits: modes");
    for (int i = 0; i < MT_COUNT(signs); i++) {
        if (u->has[(unsigned char)signs[i].sign]) {
            mt_text_addf(u->out, ", %s", signs[i].text);
        }
    }
    mt_text_add(u->out, "\n");
}

/* True for the first row of its configuration. */
static bool is_first(const mt_recommendation *r, int i)
{
    for (int k = 0; k < i; k++) {
        if (is_same_name(r->frequencies[k].configuration, r->frequencies[i].configuration)) {
            return false;
        }
    }
    return true;
}

void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out)
{
    ruler u = {.top = highest(r) * ABOVE, .length = USUAL, .out = out};
    if (!(u.top > 0.0) || !isfinite(u.top)) {
        return;
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        const char *const name = r->frequencies[i].configuration;
        const int own = name == NULL ? 0 : mt_text_width(name);
        u.label = own > u.label ? own : u.label;
    }
    if (width > 0) {
        const int room = width - u.label - (2 * INDENT) - (int)sizeof " >99";
        u.length = room < LEAST ? LEAST : room > MOST ? MOST : room;
    }
    for (int i = 0; i < r->n_frequencies; i++) {
        if (is_first(r, i)) {
            add_ruler_line(&u, r, r->frequencies[i].configuration);
        }
    }
    add_scale(&u);
    add_legend(&u);
}

/* Frequency responses of designs, as tables and sentences. */

enum { DIGITS = 6, TOLD_DIGITS = 4, HIGHEST = 3 };

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

static void add_curve(mt_table *t, const mt_result_curve *of, int rank,
                      const mt_design_curve *r)
{
    for (int i = 0; r != NULL && i < curve_point_count(&r->drawn); i++) {
        mt_table_integer(t, rank);
        name_cells(t, of);
        mt_table_rounded(t, r->drawn.hz[i], MT_CURVE_HZ_DIGITS);
        mt_table_rounded(t, r->drawn.magnitude[i], MT_CURVE_DIGITS);
        mt_table_rounded(t, r->drawn.phase_deg[i], MT_CURVE_DIGITS);
        mt_table_text(t, of->unit);
        mt_table_rounded(t, i < r->drawn.n_psd ? r->drawn.psd[i] : nan(""), MT_CURVE_DIGITS);
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
        mt_table_number(t, x->hz, DIGITS);
        mt_table_number(t, x->magnitude, TOLD_DIGITS);
        mt_table_text(t, of->unit);
        mt_table_number(t, x->phase_deg, TOLD_DIGITS);
        mt_table_number(t, x->natural_hz, DIGITS);
        mt_table_number(t, x->damping_ratio, TOLD_DIGITS);
    }
}

mt_table mt_report_extremes(const mt_result *result, int most)
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

void mt_report_curve(const mt_result *result, int k, const mt_recommendation *r, mt_text *out)
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
