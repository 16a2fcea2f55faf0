/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_VIBRATED_H
#define CLI_VIBRATED_H

#include "cli/cli.h"
#include "inspect/response.h"
#include "report/table.h"

/* "the peak is 3 times the RMS and the sum of all tones" */
void mt_vibrated_rule(const mt_vibration *v, mt_text *out);
/* Append what is assumed or unconfirmed in the profile; nothing where all is confirmed. */
void mt_vibrated_marks(const mt_vibration *v, mt_text *out);

/* Columns and row: RMS, largest tones and combined peak, after the caller's own columns. */
void mt_vibrated_columns(mt_table *t);
void mt_vibrated_row(mt_table *t, const mt_vibrated *v);
/* Columns for each tone: frequency in its range of the largest response, and this response. */
void mt_vibrated_tone_columns(mt_table *t);
/* The cells of one tone. */
void mt_vibrated_tone_row(mt_table *t, const mt_vibrated *v, int tone);
/* Print the vibration of each output of a response under its profile, with its notes. */
void mt_vibrated_print(const mt_response_view *v, mt_text *out);

#endif
