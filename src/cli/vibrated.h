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
/* The rule as members of an open object, and the profile's marks. */
void mt_vibrated_rule_json(mt_json_writer *w, const mt_vibration *v);

/* The vibration of a response under a profile, as a row of tables and JSON. Quantities other
 * than accelerations have no values in g. */
typedef struct mt_vibrated {
    const mt_vibration *profile;
    const mt_vibration_response *response;
    bool is_acceleration; /* [m/s^2], else in `unit` */
    const char *unit;     /* "m", "N" */
} mt_vibrated;

/* Columns and row: RMS, largest tones and combined peak, after the caller's own columns. */
void mt_vibrated_columns(mt_table *t);
void mt_vibrated_row(mt_table *t, const mt_vibrated *v);
/* Columns for each tone: frequency in its range of the largest response, and this response. */
void mt_vibrated_tone_columns(mt_table *t);
/* The cells of one tone. */
void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone);
/* Members of an open object. */
void mt_vibrated_json(mt_json_writer *w, const mt_vibrated *v);

#endif
