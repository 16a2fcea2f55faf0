/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goals of forced vibration find: two tables of those of result.c. */
#include "result/result.h"

#define THIS mt_result_response
static const char *const FORCED_RESPONSE[] = {"response", "rms", "sine", "peak"};
static const char *const FORCED_RESPONSE_ENDS[] = {"finite", "infinite", "unstable", "none"};
static const char *const SURETIES[] = {"proven", "sampled"};
static const mt_field RESPONSE_FIELDS[] = {
    MT_F_TEXT("goal", pointer, "JSON pointer of the goal in the study."),
    MT_F_TEXT("configuration", configuration, "Configuration of the model."),
    MT_F_TEXT("input", input, "What shakes, as the study names it."),
    MT_F_TEXT("output", output, "What is looked at."),
    MT_F_TEXT_OR_NULL(
        "profile", profile,
        "The profile of vibration, as the study names it; null: the response itself."),
    MT_F_CHOICE(
        "quantity", quantity, FORCED_RESPONSE,
        "What counts: the response, or of a profile its random parts, its tones, both."),
    MT_F_TEXT("unit", unit, "Of value and error; empty: not known."),
    MT_F_NUMBER_OR_NULL("value", value, "How large it is; null: see end."),
    MT_F_NUMBER_OR_NULL("error_at_most", error,
                        "The value is known to within this, of one that is sampled by an "
                        "estimate; null: there is none, or it is not known."),
    MT_F_NUMBER_OR_NULL(
        "frequency_hz", frequency_hz,
        "Where the response is largest within its range [Hz]; null: not known."),
    MT_F_FLAG("at_edge", at_edge,
              "That is an end of the range: the response still grows there."),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz, "The range [Hz]."),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz, "The range [Hz]."),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS,
                "Whether there is a number: infinite where an undamped resonance is excited, "
                "none where the response could not be computed."),
    MT_F_CHOICE("grade", grade, SURETIES,
                "How it is known that no frequency of the range has more."),
    MT_F_TEXT("text", text, "In words, without a full stop."),
};
const mt_record mt_response_record =
    MT_F_RECORD_OF(RESPONSE_FIELDS, "response", "How large a forced vibration is.");
#undef THIS

#define THIS mt_result_between
static const char *const DRIVE_UNITS[] = {"rad", "m"};
static const char *const GRADES[] = {"sampled", "sampled coarsely", "incomplete", "unstable"};
static const mt_field BETWEEN_FIELDS[] = {
    MT_F_TEXT("goal", pointer, "JSON pointer of the goal in the study."),
    MT_F_TEXT("drive", drive, "The driven joint."),
    MT_F_CHOICE("unit", unit, DRIVE_UNITS, "Of its positions."),
    MT_F_NUMBER_OR_NULL("from", from, "The first position that the goal names."),
    MT_F_NUMBER_OR_NULL("to", to, "The last position that the goal names."),
    MT_F_COUNT("positions", positions, 0,
               "How many positions were looked at, the named ones included; 0: none."),
    MT_F_NUMBER_OR_NULL("at", at,
                        "The position where the limit is missed most, or comes nearest; null: "
                        "no position has a value."),
    MT_F_FLAG("named", named, "That is a position that the goal names."),
    MT_F_NUMBER_OR_NULL("value", value, "The number there; null: see end."),
    MT_F_TEXT("value_unit", value_unit, "Of value and error; empty: not known."),
    MT_F_NUMBER_OR_NULL("error_at_most", error,
                        "At that position the value is known to within this; null: there is "
                        "none, or it is not known."),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz,
                        "Of a forced vibration: where the response is largest within its range "
                        "there [Hz]; null: not known."),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS,
                "Whether there is a number: infinite where an undamped resonance is excited, "
                "or of a mode at infinity, none where no position has one."),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent,
                        "What the limit is missed by there, in percent of it; 0: it is kept; "
                        "null: there is no number.",
                        .rules = "\"minimum\": 0"),
    MT_F_FLAG(
        "holds", holds,
        "The limit is kept, within its tolerance, at all positions that were looked at, and "
        "all of them have a value; these are samples, and no proof of what lies between them."),
    MT_F_CHOICE(
        "grade", grade, GRADES,
        "How the positions between are known: samples where value and neighbours ask for them, "
        "as many as the budget had, not all of them with a value, or some that are unstable."),
    MT_F_TEXT("text", text, "In words, without a full stop."),
};
const mt_record mt_between_record = MT_F_RECORD_OF(
    BETWEEN_FIELDS, "response_between", "The number of a goal over the positions of a drive.");
#undef THIS
