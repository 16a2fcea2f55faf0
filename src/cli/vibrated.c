/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vibrations under a profile as tables and text. */
#include "cli/vibrated.h"

#include <math.h>
#include <string.h>

static const double TWO_PI = 6.28318530717958647693;

enum { DIGITS = 5, HZ_DIGITS = 6, BOUND_DIGITS = 2 };

/* The text in place of a missing number. */
static const char *end_of(const mt_vibration_response *r)
{
    return r->end == MT_FORCED_FINITE ? NULL : mt_forced_end_name(r->end);
}

void mt_vibrated_columns(mt_table *t)
{
    mt_table_column(t, "random [g RMS]", "rms_g", MT_ALIGN_POINT);
    mt_table_column(t, "tones [g]", "sine_g", MT_ALIGN_POINT);
    mt_table_column(t, "peak [g]", "peak_g", MT_ALIGN_POINT);
    mt_table_column(t, "random RMS", "rms", MT_ALIGN_POINT);
    mt_table_column(t, "error at most", "rms_error_at_most", MT_ALIGN_POINT);
    mt_table_column(t, "tones", "sine", MT_ALIGN_POINT);
    mt_table_column(t, "peak", "peak", MT_ALIGN_POINT);
    mt_table_column(t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(t, "no number", "end", MT_ALIGN_LEFT);
}

void mt_vibrated_row(mt_table *t, const mt_vibrated *v)
{
    const mt_vibration_response *const r = v->response;
    const bool random = v->profile->n_random > 0;
    const bool tones = v->profile->n_tones > 0;
    const double none = nan("");
    mt_table_number(t, random ? mt_vibrated_in_g(v, r->rms) : none, DIGITS);
    mt_table_number(t, tones ? mt_vibrated_in_g(v, r->sine) : none, DIGITS);
    mt_table_number(t, mt_vibrated_in_g(v, r->peak), DIGITS);
    mt_table_number(t, random ? r->rms : none, DIGITS);
    mt_table_number(t, random ? r->rms_bound : none, BOUND_DIGITS);
    mt_table_number(t, tones ? r->sine : none, DIGITS);
    mt_table_number(t, r->peak, DIGITS);
    mt_table_text(t, mt_vibrated_unit(v));
    mt_table_text(t, end_of(r));
}

void mt_vibrated_tone_columns(mt_table *t)
{
    mt_table_column(t, "tone", "tone", MT_ALIGN_LEFT);
    mt_table_column(t, "at [Hz]", "frequency_hz", MT_ALIGN_POINT);
    mt_table_column(t, "peak [g]", "peak_g", MT_ALIGN_POINT);
    mt_table_column(t, "peak", "peak", MT_ALIGN_POINT);
    mt_table_column(t, "more at most", "excess_at_most", MT_ALIGN_POINT);
    mt_table_column(t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(t, "where", "where", MT_ALIGN_LEFT);
}

static const char *where(const mt_sine_peak *p)
{
    return p->end != MT_FORCED_FINITE ? mt_forced_end_name(p->end)
           : p->at_edge               ? "end of the range"
                                      : "within";
}

void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone)
{
    const mt_sine_peak *const p = &v->response->tones[tone];
    const double value = mt_vibration_respond_tone(v->profile, v->response, tone);
    mt_table_text(t, v->profile->tones[tone].label);
    mt_table_number(t, p->omega / TWO_PI, HZ_DIGITS);
    mt_table_number(t, mt_vibrated_in_g(v, value), DIGITS);
    mt_table_number(t, value, DIGITS);
    mt_table_number(t, p->excess, BOUND_DIGITS);
    mt_table_text(t, mt_vibrated_unit(v));
    mt_table_text(t, where(p));
}

void mt_vibrated_rule(const mt_vibration *v, mt_text *out)
{
    static const char *const rules[MT_TONES_RULES] = {
        "the sum of all tones", "the largest tone", "the root of the tones' sum of squares"};
    mt_text_add(out, "the peak is ");
    if (v->n_random > 0) {
        mt_text_addf(out, "%.4g times the RMS", v->sigma);
        mt_text_add(out, v->n_tones > 0 ? "\nand " : "");
    }
    mt_text_add(out, v->n_tones > 0 ? rules[v->rule] : "");
}

void mt_vibrated_marks(const mt_vibration *v, mt_text *out)
{
    mt_text_add(out, v->n_marks > 0 ? "  Of the profile is assumed, or unconfirmed:\n" : "");
    for (int i = 0; i < v->n_marks; i++) {
        mt_text_addf(out, "  - %s\n", v->marks[i]);
    }
    mt_text_add(out, v->n_marks > 0 ? "\n" : "");
}

/* Of a response. */

/* Columns that identify the pair, before its values. */
static void pair_columns(const mt_response_view *v, mt_table *t)
{
    if (v->response.ports.n_in > 1) {
        mt_table_column(t, "input", "input", MT_ALIGN_LEFT);
    }
    mt_table_column(t, "output", "output", MT_ALIGN_LEFT);
}

static void pair_cells(const mt_response_view *v, int pair, mt_table *t)
{
    if (v->response.ports.n_in > 1) {
        mt_table_text(t, mt_response_view_input(v, pair)->name);
    }
    mt_table_text(t, mt_response_view_output(v, pair)->name);
}

static void print_rows(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_columns(&t);
    for (int p = 0; p < v->profiled.n_pairs; p++) {
        const mt_vibrated row = mt_response_view_vibrated(v, p);
        pair_cells(v, p, &t);
        mt_vibrated_row(&t, &row);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

static void print_tones(const mt_response_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    pair_columns(v, &t);
    mt_vibrated_tone_columns(&t);
    for (int p = 0; p < v->profiled.n_pairs; p++) {
        const mt_vibrated row = mt_response_view_vibrated(v, p);
        for (int i = 0; i < v->question->profile->n_tones; i++) {
            pair_cells(v, p, &t);
            mt_vibrated_tone_row(&t, &row, i);
        }
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_text_add(out, v->profiled.no_sums == NULL
                         ? "  Each is the largest within its range, proven up to that part of "
                           "it.\n\n"
                         : "\n");
    mt_table_free(&t);
}

/* Print the reason for a pair without a value; *said: the pole named last, so that pairs with
 * the same pole are reported once. */
static void print_end(const mt_response_view *v, int pair, int *said, mt_text *out)
{
    const mt_vibration_response *const a = &v->profiled.answers[pair];
    if (a->end == MT_FORCED_FINITE || a->pole < 0 || a->pole == *said) {
        return;
    }
    const double complex pole = v->profiled.poles[a->pole];
    const int mode = mt_response_view_mode(v, pole);
    const char *const name =
        mode > 0 ? mt_mode_name(v->s, v->response.sys->configuration, mode) : NULL;
    *said = a->pole;
    mt_text_addf(out, "  Vibration mode %d%s%s%s, %.6g Hz, ", mode, name == NULL ? "" : " \"",
                 name == NULL ? "" : name, name == NULL ? "" : "\"", cabs(pole) / TWO_PI);
    mt_text_add(out, a->end == MT_FORCED_INFINITE
                         ? "has no damping, and the profile acts there: what it shakes is "
                           "infinite.\n"
                         : "grows by itself: there is no steady response.\n");
}

void mt_vibrated_print(const mt_response_view *v, mt_text *out)
{
    const mt_vibration *const p = v->profiled.v;
    const char *const axis = mt_vibrated_axis(p);
    int said = -1;
    mt_text_addf(out, "  Under %s%s%s", mt_vibrated_name(p), axis == NULL ? "" : ", along ",
                 axis == NULL ? "" : axis);
    if (p->n_random > 0) {
        mt_text_addf(out, " (%.5g g RMS)", mt_vibration_rms(p) / MT_STANDARD_GRAVITY);
    }
    mt_text_add(out, "; ");
    mt_vibrated_rule(p, out);
    mt_text_add(out, ":\n");
    print_rows(v, out);
    for (int k = 0; k < v->profiled.n_pairs; k++) {
        print_end(v, k, &said, out);
    }
    mt_text_add(out, said >= 0 ? "\n" : "");
    if (p->n_tones > 0) {
        print_tones(v, out);
    }
    if (v->profiled.no_sums != NULL) {
        mt_text_addf(out,
                     "  %s. The numbers are therefore by quadrature: errors are estimates, and "
                     "of tones nothing is proven.\n\n",
                     v->profiled.no_sums);
    }
    mt_vibrated_marks(p, out);
}
