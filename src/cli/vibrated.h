/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_VIBRATED_H
#define CLI_VIBRATED_H

#include "cli/cli.h"
#include "report/table.h"
#include "vibration/respond.h"

/* The profile in the file of that name, or, where there is none, the one of the name that is
 * part of the program, with its catalogue. Fails and messages as mt_vibration_load. */
mt_status mt_vibrated_load(const mt_args *args, const char *name, mt_vibration **out,
                           mt_diagnostics *messages, mt_err *err);
const char *mt_vibrated_axis(const mt_vibration *v); /* "z"; NULL: any */
const char *mt_vibrated_name(const mt_vibration *v); /* what it says, or its path */
/* "the peak is 3 times the RMS and the sum of all tones" */
void mt_vibrated_rule(const mt_vibration *v, mt_text *out);
/* What of it is assumed, or unconfirmed; nothing where all is known. */
void mt_vibrated_marks(const mt_vibration *v, mt_text *out);
/* The rule as members of an open object, and the profile's marks. */
void mt_vibrated_rule_json(mt_json_writer *w, const mt_vibration *v);

/* What a profile does to responses, as tables and JSON: a row each. What is not an acceleration
 * has no values in g. */
typedef struct mt_vibrated {
    const mt_vibration *profile;
    const mt_vibration_response *response;
    bool is_acceleration; /* [m/s^2], else in `unit` */
    const char *unit;     /* "m", "N" */
} mt_vibrated;

/* RMS, largest tones and combined peak. The caller's own columns stand before these. */
void mt_vibrated_columns(mt_table *t);
void mt_vibrated_row(mt_table *t, const mt_vibrated *v);
/* Each tone: where within its range the response is largest, and how large. */
void mt_vibrated_tone_columns(mt_table *t);
/* One row of these cells. */
void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone);
/* Members of an open object. */
void mt_vibrated_json(mt_json_writer *w, const mt_vibrated *v);

#endif
