/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_VIBRATED_H
#define CLI_VIBRATED_H

#include "cli/cli.h"
#include "report/table.h"
#include "vibration/profile_response.h"

const char *mt_vibrated_axis(const mt_vibration *v); /* "z"; NULL: any */
const char *mt_vibrated_name(const mt_vibration *v); /* its name, or its path */
/* "the peak is 3 times the RMS and the sum of all tones" */
void mt_vibrated_rule(const mt_vibration *v, mt_text *out);
/* Append what is assumed or unconfirmed in the profile; nothing where all is confirmed. */
void mt_vibrated_marks(const mt_vibration *v, mt_text *out);

/* The vibration of a response under a profile, as a row of tables and JSON. Quantities other
 * than accelerations have no values in g. */
typedef struct mt_vibrated {
    const mt_vibration *profile;
    const mt_vibration_response *response;
    bool is_acceleration; /* [m/s^2], else in `unit` */
    const char *unit;     /* "m", "N" */
} mt_vibrated;

/* One tone of it. */
typedef struct mt_vibrated_tone {
    const char *tone;
    mt_forced_end end;
    double frequency_hz;
    double peak;
    double excess_at_most;
    bool at_edge;
} mt_vibrated_tone;

/* Its members as a record has them. */
typedef struct mt_vibrated_values {
    mt_forced_end end;
    const char *unit;
    double rms;
    double rms_error_at_most;
    double sine;
    double peak;
    bool in_g;
    double rms_g;
    double sine_g;
    double peak_g;
    mt_vibrated_tone *tones;
    int n_tones;
} mt_vibrated_values;
extern const mt_record mt_vibrated_tone_record;
mt_status mt_vibrated_values_of(const mt_vibrated *v, mt_arena *mem, mt_vibrated_values *out,
                                mt_err *err);

/* The members of a record THIS with an mt_vibrated_values m. */
/* NOLINTBEGIN(bugprone-macro-parentheses): members of a struct */
#define MT_VIBRATED_FIELDS(m)                                                                \
    MT_F_ENUM("end", m.end, mt_forced_end, mt_forced_end_names,                              \
              "Why there is no finite number: an undamped mode within the profile, or an "   \
              "unstable one; \"finite\": there is one."),                                    \
        MT_F_TEXT("unit", m.unit, "Unit of rms, sine and peak."),                            \
        MT_F_NUMBER_OR_NULL("rms", m.rms,                                                    \
                            "RMS under the random parts, in the unit that `unit` names."),   \
        MT_F_NUMBER_OR_NULL("rms_error_at_most", m.rms_error_at_most,                        \
                            "Bound of its error, in the same unit."),                        \
        MT_F_NUMBER_OR_NULL("sine", m.sine, "Peak under the tones, in the same unit."),      \
        MT_F_NUMBER_OR_NULL("peak", m.peak,                                                  \
                            "Peak by the rule that combines both, in the same unit."),       \
        MT_F_NUMBER_OR_NULL("rms_g", m.rms_g, "rms of an acceleration.", MT_F_WHEN(m.in_g)), \
        MT_F_NUMBER_OR_NULL("sine_g", m.sine_g, "sine of an acceleration.",                  \
                            MT_F_WHEN(m.in_g)),                                              \
        MT_F_NUMBER_OR_NULL("peak_g", m.peak_g, "peak of an acceleration.",                  \
                            MT_F_WHEN(m.in_g)),                                              \
        MT_F_LIST("tones", m.tones, m.n_tones, mt_vibrated_tone, mt_vibrated_tone_record,    \
                  "The tones, each where it shakes most.", .flat = true)

/* The rule and the marks of a profile. */
typedef struct mt_combine_row {
    double sigma;
    mt_vibration_sum tones;
} mt_combine_row;
typedef struct mt_rule_row {
    mt_combine_row combine;
    const char **marks;
    int n_marks;
} mt_rule_row;
extern const mt_record mt_combine_record;
mt_rule_row mt_rule_row_of(const mt_vibration *v);

/* The members of a record THIS with an mt_rule_row m. */
#define MT_RULE_FIELDS(m)                                                \
    MT_F_RECORD("combine", m.combine, mt_combine_row, mt_combine_record, \
                "How the peak follows from the parts."),                 \
        MT_F_TEXTS("marks", m.marks, m.n_marks,                          \
                   "What is assumed or unconfirmed in the profile.")
/* NOLINTEND(bugprone-macro-parentheses) */

/* Columns and row: RMS, largest tones and combined peak, after the caller's own columns. */
void mt_vibrated_columns(mt_table *t);
void mt_vibrated_row(mt_table *t, const mt_vibrated *v);
/* Columns for each tone: frequency in its range of the largest response, and this response. */
void mt_vibrated_tone_columns(mt_table *t);
/* The cells of one tone. */
void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone);

#endif
