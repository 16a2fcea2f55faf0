/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/vibrated.h"

#include <math.h>
#include <string.h>

static const double TWO_PI = 6.28318530717958647693;

enum { DIGITS = 5, HZ_DIGITS = 6, BOUND_DIGITS = 2 };

/* "m/s^2" of a response is in g as well. */
static double in_g(const mt_vibrated *v, double value)
{
    return v->is_acceleration ? value / MT_STANDARD_GRAVITY : nan("");
}

static const char *vibrated_unit(const mt_vibrated *v)
{
    return v->is_acceleration ? "m/s^2" : v->unit;
}

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
    mt_table_number(t, random ? in_g(v, r->rms) : none, DIGITS);
    mt_table_number(t, tones ? in_g(v, r->sine) : none, DIGITS);
    mt_table_number(t, in_g(v, r->peak), DIGITS);
    mt_table_number(t, random ? r->rms : none, DIGITS);
    mt_table_number(t, random ? r->rms_bound : none, BOUND_DIGITS);
    mt_table_number(t, tones ? r->sine : none, DIGITS);
    mt_table_number(t, r->peak, DIGITS);
    mt_table_text(t, vibrated_unit(v));
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
    mt_table_number(t, in_g(v, value), DIGITS);
    mt_table_number(t, value, DIGITS);
    mt_table_number(t, p->excess, BOUND_DIGITS);
    mt_table_text(t, vibrated_unit(v));
    mt_table_text(t, where(p));
}

#define THIS mt_vibrated_tone
static const mt_field tone_fields[] = {
    MT_F_TEXT("tone", tone, "Its name."),
    MT_F_ENUM("end", end, mt_forced_end, mt_forced_end_names,
              "Why there is no finite number; \"finite\": there is one."),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz,
                        "Where in its range the response is largest."),
    MT_F_NUMBER_OR_NULL("peak", peak, "Peak there, in the unit of the response."),
    MT_F_NUMBER_OR_NULL("excess_at_most", excess_at_most,
                        "Part of the peak by which it may be larger elsewhere in the range."),
    MT_F_FLAG("at_edge", at_edge, "It is largest at an end of the range."),
};
const mt_record mt_vibrated_tone_record =
    MT_F_RECORD_OF(tone_fields, "vibrated_tone", "The response to one tone.");
#undef THIS

#define THIS mt_combine_row
static const mt_field combine_fields[] = {
    MT_F_NUMBER("sigma", sigma, "Peak of the random parts, in their RMS."),
    MT_F_ENUM("tones", tones, mt_vibration_sum, mt_vibration_sum_names,
              "How the peaks of the tones add up."),
};
const mt_record mt_combine_record =
    MT_F_RECORD_OF(combine_fields, NULL, "How the peak follows from the parts.");
#undef THIS

mt_rule_row mt_rule_row_of(const mt_vibration *v)
{
    return (mt_rule_row){.combine = {.sigma = v->sigma, .tones = v->rule},
                         .marks = v->marks,
                         .n_marks = v->n_marks};
}

mt_status mt_vibrated_values_of(const mt_vibrated *v, mt_arena *mem, mt_vibrated_values *out,
                                mt_err *err)
{
    const mt_vibration_response *const r = v->response;
    *out = (mt_vibrated_values){
        .end = r->end,
        .unit = vibrated_unit(v),
        .rms = r->rms,
        .rms_error_at_most = r->rms_bound,
        .sine = r->sine,
        .peak = r->peak,
        .in_g = v->is_acceleration,
        .rms_g = in_g(v, r->rms),
        .sine_g = in_g(v, r->sine),
        .peak_g = in_g(v, r->peak),
        .tones = mt_arena_alloc(mem, (size_t)r->n_tones, sizeof *out->tones),
    };
    for (int i = 0; i < r->n_tones && out->tones != NULL; i++) {
        const mt_sine_peak *const p = &r->tones[i];
        out->tones[out->n_tones++] = (mt_vibrated_tone){
            .tone = v->profile->tones[i].label,
            .end = p->end,
            .frequency_hz = p->omega / TWO_PI,
            .peak = mt_vibration_respond_tone(v->profile, r, i),
            .excess_at_most = p->excess,
            .at_edge = p->at_edge,
        };
    }
    return mt_arena_check(mem, err);
}

const char *mt_vibrated_axis(const mt_vibration *v)
{
    static const char *const names[] = {"x", "y", "z"};
    return v->axis == MT_ABSENT ? NULL : names[v->axis];
}

const char *mt_vibrated_name(const mt_vibration *v)
{
    return v->name == NULL ? v->path : v->name;
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
