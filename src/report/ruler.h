/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_RULER_H
#define REPORT_RULER_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/*
 * The frequencies of a design as one line of characters per configuration, on one linear scale
 * that ends a little above the study's requirements: digits are the recommended modes, "o" the
 * original ones, "#" a band, "-" its margin, "|" a target, "[" and "]" limits. No text where no
 * goal concerns frequencies. width: of the terminal; 0: none.
 */
void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out);

/* Curves of all designs (rank 0: the original one), one row per frequency, for a spreadsheet:
 * curves.csv. */
mt_table mt_report_curves(const mt_result *result);
/* Peaks, resonances and antiresonances of the original design and of at most `most` recommended
 * ones. */
mt_table mt_report_extremes(const mt_result *result, int most);
/* Append response k of the result as a sentence: its highest peaks in the original design and
 * in r, which may be the same. */
void mt_report_curve(const mt_result *result, int k, const mt_recommendation *r, mt_text *out);

#endif
