/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_CURVES_H
#define REPORT_CURVES_H

#include "report/table.h"
#include "result/result.h"

/* Curves of all designs (rank 0: the original one), a row for each frequency, for a
 * spreadsheet: curves.csv. */
mt_table mt_report_curves(const mt_result *result);
/* Peaks, resonances and antiresonances of a design's responses. */
mt_table mt_report_extremes(const mt_result *result, const mt_recommendation *r);
/* Response k of the result: its highest peaks in the original design and in r (which may be that
 * one), in a sentence. */
void mt_report_curve(const mt_result *result, int k, const mt_recommendation *r, mt_text *out);

#endif
