/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_CURVES_H
#define REPORT_CURVES_H

#include "report/table.h"
#include "result/result.h"

/* Curves of all designs (rank 0: the original one), a row for each frequency, for a
 * spreadsheet: curves.csv. */
mt_table mt_report_curves(const mt_result *result);
/* Peaks, resonances and antiresonances of the original design and of at most so many that are
 * recommended. */
mt_table mt_report_extremes(const mt_result *result, int most);
/* Response k of the result in a sentence: its highest peaks in the original design and in r,
 * which may be that one. */
void mt_report_curve(const mt_result *result, int k, const mt_recommendation *r, mt_text *out);

#endif
