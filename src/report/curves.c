/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frequency responses of designs, as tables and sentences. */
#include "report/curves.h"

#include <math.h>
#include <string.h>

#include "report/number.h"

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
