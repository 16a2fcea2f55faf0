/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/curves.h"

/* What each record holds, in the order of result.json. */

#define THIS mt_curve_points
static const mt_field DRAWN_FIELDS[] = {
    MT_F_NUMBERS_ROUNDED("frequency_hz", hz, n_hz, MT_CURVE_HZ_DIGITS),
    MT_F_NUMBERS_ROUNDED("magnitude", magnitude, n_magnitude, MT_CURVE_DIGITS),
    MT_F_NUMBERS_ROUNDED("phase_deg", phase_deg, n_phase, MT_CURVE_DIGITS),
    MT_F_NUMBERS_ROUNDED("psd", psd, n_psd, MT_CURVE_DIGITS),
};
static const mt_record DRAWN = MT_F_RECORD_OF(DRAWN_FIELDS);
#undef THIS

#define THIS mt_result_limit
static const mt_field LIMIT_FIELDS[] = {
    MT_F_TEXT("pointer", pointer),
    MT_F_NUMBER("lower_hz", lower_hz),
    MT_F_NUMBER("upper_hz", upper_hz),
    MT_F_NUMBER_OR_NULL("target", target),
    MT_F_NUMBER_OR_NULL("at_least", at_least),
    MT_F_NUMBER_OR_NULL("at_most", at_most),
};
static const mt_record LIMIT = MT_F_RECORD_OF(LIMIT_FIELDS);
#undef THIS

#define THIS mt_result_density
static const mt_field DENSITY_FIELDS[] = {
    MT_F_NUMBERS("frequency_hz", hz, n_hz),
    MT_F_NUMBERS("level", level, n_level),
};
static const mt_record DENSITY = MT_F_RECORD_OF(DENSITY_FIELDS);
#undef THIS

#define THIS mt_result_tone
static const mt_field TONE_FIELDS[] = {
    MT_F_TEXT("tone", label),
    MT_F_NUMBER("lower_hz", lower_hz),
    MT_F_NUMBER("upper_hz", upper_hz),
    MT_F_NUMBER("level", level),
};
static const mt_record TONE = MT_F_RECORD_OF(TONE_FIELDS);
#undef THIS

#define THIS mt_result_profile
static const mt_field PROFILE_FIELDS[] = {
    MT_F_TEXT("file", file),
    MT_F_TEXT_OR_NULL("name", name),
    MT_F_NUMBER_OR_NULL("rms", rms),
    MT_F_NUMBER("sigma", sigma),
    MT_F_TEXT("rule", rule),
    MT_F_LIST("densities", densities, n_densities, mt_result_density, DENSITY),
    MT_F_LIST("tones", tones, n_tones, mt_result_tone, TONE),
};
static const mt_record PROFILE = MT_F_RECORD_OF(PROFILE_FIELDS);
#undef THIS

#define THIS mt_result_curve
static const mt_field CURVE_FIELDS[] = {
    MT_F_TEXT("pointer", pointer),
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT("input", input),
    MT_F_TEXT("output", output),
    MT_F_TEXT("unit", unit),
    MT_F_TEXT("output_unit", output_unit),
    MT_F_NUMBER("lower_hz", lower_hz),
    MT_F_NUMBER("upper_hz", upper_hz),
    MT_F_TEXT_OR_NULL("description", description),
    MT_F_TEXT_OR_NULL("source", source),
    MT_F_LIST("limits", limits, n_limits, mt_result_limit, LIMIT),
    MT_F_OPTION("profile", profile, mt_result_profile, PROFILE),
    MT_F_RECORD("measured", measured, mt_curve_points, DRAWN),
};
const mt_record mt_curve_record = MT_F_RECORD_OF(CURVE_FIELDS);
#undef THIS

#define THIS mt_result_extreme
static const char *const EXTREMES[] = {"peak", "resonance", "antiresonance", "minimum"};
static const mt_field EXTREME_FIELDS[] = {
    MT_F_CHOICE("kind", kind, EXTREMES),
    MT_F_NUMBER("frequency_hz", hz),
    MT_F_NUMBER_OR_NULL("magnitude", magnitude),
    MT_F_NUMBER_OR_NULL("phase_deg", phase_deg),
    MT_F_NUMBER_OR_NULL("natural_hz", natural_hz),
    MT_F_NUMBER_OR_NULL("damping_ratio", damping_ratio),
};
static const mt_record EXTREME = MT_F_RECORD_OF(EXTREME_FIELDS);
#undef THIS

#define THIS mt_result_forced_response_tone
static const mt_field FORCED_RESPONSE_TONE_FIELDS[] = {
    MT_F_TEXT("tone", label),          MT_F_NUMBER_OR_NULL("frequency_hz", hz),
    MT_F_NUMBER_OR_NULL("peak", peak), MT_F_NUMBER_OR_NULL("excess_at_most", excess_at_most),
    MT_F_FLAG("at_edge", at_edge),
};
static const mt_record FORCED_RESPONSE_TONE = MT_F_RECORD_OF(FORCED_RESPONSE_TONE_FIELDS);
#undef THIS

#define THIS mt_result_forced_response
static const char *const VIBRATION_ENDS[] = {"finite", "infinite", "unstable"};
static const mt_field VIBRATION_FIELDS[] = {
    MT_F_CHOICE("end", end, VIBRATION_ENDS),
    MT_F_FLAG("proven", proven),
    MT_F_NUMBER_OR_NULL("rms", rms),
    MT_F_NUMBER_OR_NULL("rms_error_at_most", rms_error_at_most),
    MT_F_NUMBER_OR_NULL("sine", sine),
    MT_F_NUMBER_OR_NULL("peak", peak),
    MT_F_LIST("tones", tones, n_tones, mt_result_forced_response_tone, FORCED_RESPONSE_TONE),
};
static const mt_record VIBRATION = MT_F_RECORD_OF(VIBRATION_FIELDS);
#undef THIS

#define THIS mt_design_curve
static const mt_field DESIGN_CURVE_FIELDS[] = {
    MT_F_TEXT("pointer", pointer),
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT_OR_NULL("trouble", trouble),
    MT_F_LIST("extremes", extremes, n_extremes, mt_result_extreme, EXTREME),
    MT_F_OPTION("vibration", vibration, mt_result_forced_response, VIBRATION),
    MT_F_RECORD("drawn", drawn, mt_curve_points, DRAWN),
};
const mt_record mt_design_curve_record = MT_F_RECORD_OF(DESIGN_CURVE_FIELDS);
#undef THIS
