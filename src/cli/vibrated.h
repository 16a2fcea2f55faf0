/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_VIBRATED_H
#define CLI_VIBRATED_H

#include "io/write_json.h"
#include "report/table.h"
#include "vibration/respond.h"

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
