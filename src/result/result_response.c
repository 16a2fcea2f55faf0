/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goals of forced vibration find: two tables of those of result.c. */
#include "result/result.h"

#define THIS mt_result_response
static const char *const FORCED_RESPONSE[] = {"response", "rms", "sine", "peak"};
static const char *const FORCED_RESPONSE_ENDS[] = {"finite", "infinite", "unstable", "none"};
static const char *const SURETIES[] = {"proven", "sampled"};
static const mt_field RESPONSE_FIELDS[] = {
    MT_F_TEXT("goal", pointer),
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT("input", input),
    MT_F_TEXT("output", output),
    MT_F_TEXT_OR_NULL("profile", profile),
    MT_F_CHOICE("quantity", quantity, FORCED_RESPONSE),
    MT_F_TEXT("unit", unit),
    MT_F_NUMBER_OR_NULL("value", value),
    MT_F_NUMBER_OR_NULL("error_at_most", error),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz),
    MT_F_FLAG("at_edge", at_edge),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS),
    MT_F_CHOICE("grade", grade, SURETIES),
    MT_F_TEXT("text", text),
};
const mt_record mt_response_record = MT_F_RECORD_OF(RESPONSE_FIELDS);
#undef THIS

#define THIS mt_result_between
static const char *const DRIVE_UNITS[] = {"rad", "m"};
static const char *const GRADES[] = {"sampled", "sampled coarsely", "incomplete", "unstable"};
static const mt_field BETWEEN_FIELDS[] = {
    MT_F_TEXT("goal", pointer),
    MT_F_TEXT("drive", drive),
    MT_F_CHOICE("unit", unit, DRIVE_UNITS),
    MT_F_NUMBER_OR_NULL("from", from),
    MT_F_NUMBER_OR_NULL("to", to),
    MT_F_COUNT("positions", positions, 0),
    MT_F_NUMBER_OR_NULL("at", at),
    MT_F_FLAG("named", named),
    MT_F_NUMBER_OR_NULL("value", value),
    MT_F_TEXT("value_unit", value_unit),
    MT_F_NUMBER_OR_NULL("error_at_most", error),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent),
    MT_F_FLAG("holds", holds),
    MT_F_CHOICE("grade", grade, GRADES),
    MT_F_TEXT("text", text),
};
const mt_record mt_between_record = MT_F_RECORD_OF(BETWEEN_FIELDS);
#undef THIS
