/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/curves.h"

/* What each record holds, in the order of result.json. */

#define THIS mt_curve_points
static const mt_field DRAWN_FIELDS[] = {
    MT_F_NUMBERS_ROUNDED("frequency_hz", hz, n_hz, MT_CURVE_HZ_DIGITS, "Ascending."),
    MT_F_NUMBERS_ROUNDED("magnitude", magnitude, n_magnitude, MT_CURVE_DIGITS, "As many."),
    MT_F_NUMBERS_ROUNDED("phase_deg", phase_deg, n_phase, MT_CURVE_DIGITS,
                         "As many, above -180 up to 180."),
    MT_F_NUMBERS_ROUNDED("psd", psd, n_psd, MT_CURVE_DIGITS,
                         "As many densities of the output, in the square of its unit per Hz, "
                         "null where the profile has none; none without a profile."),
};
static const mt_record DRAWN = MT_F_RECORD_OF(
    DRAWN_FIELDS, "drawn",
    "The response at as many frequencies as a picture needs, extremes among them, where it is "
    "finite and not 0. Between them the logarithm of the magnitude, and the phase, are "
    "straight over the logarithm of the frequency, to about 2 % of the magnitude. The density "
    "of the output under a profile is the square of the magnitude times the sum of the "
    "profile's densities. Rounded to six digits, frequencies to eight.");
#undef THIS

#define THIS mt_result_limit
static const mt_field LIMIT_FIELDS[] = {
    MT_F_TEXT("pointer", pointer, "The goal, as JSON pointer into the study."),
    MT_F_NUMBER("lower_hz", lower_hz, "From here on it holds."),
    MT_F_NUMBER("upper_hz", upper_hz, "Up to here; equal: at one frequency."),
    MT_F_NUMBER_OR_NULL("target", target, "In the curve's unit; null: not asked for."),
    MT_F_NUMBER_OR_NULL("at_least", at_least, "Likewise."),
    MT_F_NUMBER_OR_NULL("at_most", at_most, "Likewise."),
};
static const mt_record LIMIT = MT_F_RECORD_OF(LIMIT_FIELDS, NULL, "A limit of a goal.");
#undef THIS

#define THIS mt_result_density
static const mt_field DENSITY_FIELDS[] = {
    MT_F_NUMBERS("frequency_hz", hz, n_hz,
                 "Breakpoints, between which log-log scales show straight lines."),
    MT_F_NUMBERS("level", level, n_level, "There [(m/s^2)^2/Hz]."),
};
static const mt_record DENSITY = MT_F_RECORD_OF(DENSITY_FIELDS, NULL, "A density.");
#undef THIS

#define THIS mt_result_tone
static const mt_field TONE_FIELDS[] = {
    MT_F_TEXT("tone", label, "What it is."),
    MT_F_NUMBER("lower_hz", lower_hz, "From here."),
    MT_F_NUMBER("upper_hz", upper_hz, "To here."),
    MT_F_NUMBER("level", level, "Amplitude [m/s^2]."),
};
static const mt_record TONE = MT_F_RECORD_OF(TONE_FIELDS, NULL, "A sine.");
#undef THIS

#define THIS mt_result_profile
static const mt_field PROFILE_FIELDS[] = {
    MT_F_TEXT("file", file, "As the study names it."),
    MT_F_TEXT_OR_NULL("name", name, "What it calls itself; null: nothing."),
    MT_F_NUMBER_OR_NULL("rms", rms, "Of its random parts [m/s^2]."),
    MT_F_NUMBER("sigma", sigma, "So many times the RMS are part of a peak."),
    MT_F_TEXT("rule", rule,
              "How peaks of tones add up: \"sum\", \"largest\", \"root_sum_square\"."),
    MT_F_LIST("densities", densities, n_densities, mt_result_density, DENSITY,
              "Power spectral densities, which add up; none below and above."),
    MT_F_LIST("tones", tones, n_tones, mt_result_tone, TONE,
              "Sines whose frequencies lie anywhere within their ranges."),
};
static const mt_record PROFILE =
    MT_F_RECORD_OF(PROFILE_FIELDS, "profile", "A profile of vibration.");
#undef THIS

#define THIS mt_result_curve
static const mt_field CURVE_FIELDS[] = {
    MT_F_TEXT("pointer", pointer, "What asks for it, as JSON pointer into the study."),
    MT_F_TEXT("configuration", configuration, "Name of the configuration."),
    MT_F_TEXT("input", input, "What causes it, in full: \"base.y:acceleration\"."),
    MT_F_TEXT("output", output, "What it is seen in, in full."),
    MT_F_TEXT("unit", unit, "Of its magnitude: of the output per unit of the input."),
    MT_F_TEXT("output_unit", output_unit, "Of the output."),
    MT_F_NUMBER("lower_hz", lower_hz, "From here on it is shown."),
    MT_F_NUMBER("upper_hz", upper_hz, "Up to here."),
    MT_F_TEXT_OR_NULL("description", description, "As in the study; null: none."),
    MT_F_TEXT_OR_NULL("source", source, "As in the study; null: none."),
    MT_F_LIST("limits", limits, n_limits, mt_result_limit, LIMIT,
              "What goals of type \"response\" ask of it."),
    MT_F_OPTION("profile", profile, mt_result_profile, PROFILE,
                "The vibration profile of the ground; null: none is given."),
    MT_F_RECORD("measured", measured, mt_curve_points, DRAWN,
                "What a goal of type \"frequency_response\" compares it with, at its lines, of "
                "more than 400 at some; no points: nothing."),
};
const mt_record mt_curve_record =
    MT_F_RECORD_OF(CURVE_FIELDS, "curve", "A frequency response that is shown.");
#undef THIS

#define THIS mt_result_extreme
static const char *const EXTREMES[] = {"peak", "resonance", "antiresonance", "minimum"};
static const mt_field EXTREME_FIELDS[] = {
    MT_F_CHOICE("kind", kind, EXTREMES,
                "\"resonance\": an undamped peak, of infinite height; \"antiresonance\": a "
                "minimum next to a zero."),
    MT_F_NUMBER("frequency_hz", hz, "Where."),
    MT_F_NUMBER_OR_NULL("magnitude", magnitude, "How large; null: infinite."),
    MT_F_NUMBER_OR_NULL("phase_deg", phase_deg,
                        "Of output before input, above -180 up to 180; null: it has none."),
    MT_F_NUMBER_OR_NULL("natural_hz", natural_hz,
                        "Of a peak or resonance: natural frequency of the pole that is nearest "
                        "to it; null of others."),
    MT_F_NUMBER_OR_NULL("damping_ratio", damping_ratio, "Damping ratio of that pole."),
};
static const mt_record EXTREME =
    MT_F_RECORD_OF(EXTREME_FIELDS, NULL, "A maximum or a minimum.");
#undef THIS

#define THIS mt_result_forced_response_tone
static const mt_field FORCED_RESPONSE_TONE_FIELDS[] = {
    MT_F_TEXT("tone", label, "What it is."),
    MT_F_NUMBER_OR_NULL("frequency_hz", hz, "Where in its range the response is largest."),
    MT_F_NUMBER_OR_NULL("peak", peak, "Amplitude there."),
    MT_F_NUMBER_OR_NULL("excess_at_most", excess_at_most,
                        "No frequency of the range has more than the peak and this part of it: "
                        "proven; null: not proven."),
    MT_F_FLAG("at_edge", at_edge, "It is an end of the range."),
};
static const mt_record FORCED_RESPONSE_TONE =
    MT_F_RECORD_OF(FORCED_RESPONSE_TONE_FIELDS, NULL, "A tone.");
#undef THIS

#define THIS mt_result_forced_response
static const char *const VIBRATION_ENDS[] = {"finite", "infinite", "unstable"};
static const mt_field VIBRATION_FIELDS[] = {
    MT_F_CHOICE("end", end, VIBRATION_ENDS,
                "\"infinite\": an undamped motion is excited at its natural frequency; "
                "\"unstable\": a motion grows by itself. Then numbers are null."),
    MT_F_FLAG("proven", proven,
              "Errors are bounds; false: the response is not a sum over poles, and they are "
              "estimates."),
    MT_F_NUMBER_OR_NULL("rms", rms,
                        "Of the response to the random parts, in the output's unit."),
    MT_F_NUMBER_OR_NULL("rms_error_at_most", rms_error_at_most, "Bound of its error."),
    MT_F_NUMBER_OR_NULL("sine", sine, "Of the tones by the profile's rule."),
    MT_F_NUMBER_OR_NULL("peak", peak, "Sigma times the RMS, and the tones."),
    MT_F_LIST("tones", tones, n_tones, mt_result_forced_response_tone, FORCED_RESPONSE_TONE,
              "One by one."),
};
static const mt_record VIBRATION =
    MT_F_RECORD_OF(VIBRATION_FIELDS, "shaken", "What a profile does to an output.");
#undef THIS

#define THIS mt_design_curve
static const mt_field DESIGN_CURVE_FIELDS[] = {
    MT_F_TEXT("pointer", pointer, "As in the result's curves."),
    MT_F_TEXT("configuration", configuration, "Likewise."),
    MT_F_TEXT_OR_NULL("trouble", trouble, "Why there is no curve; null: there is."),
    MT_F_LIST("extremes", extremes, n_extremes, mt_result_extreme, EXTREME,
              "Maxima and minima of the magnitude within the band, all of them, by ascending "
              "frequency."),
    MT_F_OPTION("vibration", vibration, mt_result_forced_response, VIBRATION,
                "What the whole profile does; null: there is none, or no number."),
    MT_F_RECORD("drawn", drawn, mt_curve_points, DRAWN, NULL),
};
const mt_record mt_design_curve_record =
    MT_F_RECORD_OF(DESIGN_CURVE_FIELDS, "design_curve", "A response of one design.");
#undef THIS
