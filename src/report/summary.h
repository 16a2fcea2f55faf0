/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SUMMARY_H
#define REPORT_SUMMARY_H

#include "base/text.h"
#include "report/section.h"
#include "report/table.h"
#include "result/result.h"

/* Name of the study, status and all sections; published values compared where requested; width
 * as in mt_summary_writer. */
void mt_report_summary(const mt_result *result, bool with_published, int width, mt_text *out);

/* The summary as the body of a page in which a script draws figures: the main sections first,
 * tables last, each recommendation in its own parts. */
void mt_write_page(mt_text *out, const mt_result *result);
/* The uncertainty left by the goals: directions that are not identifiable, and the sensitivity
 * to the weights. */
void mt_write_uncertainty(const mt_summary_writer *to, const mt_result *result);

/* Tables of a result; the caller frees them. */

/* One row per recommendation, below that of the original design. */
mt_table mt_report_alternatives(const mt_result *result);
/* label, published, computed, difference, role, source, verdict. */
mt_table mt_report_published(const mt_result *result);
/* All members of all designs, one row each (rank 0: the original design), for a spreadsheet:
 * recommendations.csv. */
mt_table mt_report_designs(const mt_result *result);
/* True where every comparable published entry holds. *judged (may be NULL): the number of
 * these. */
bool mt_report_verified(const mt_result *result, int *judged);
/* One row per point of the trade study: varied quantities, status, objectives, change,
 * clearance, parameters; the caller frees it. No columns without a trade study. */
mt_table mt_report_trade(const mt_result *result);
/* Curves of all designs (rank 0: the original one), one row per frequency, for a spreadsheet:
 * curves.csv. */
mt_table mt_report_curves(const mt_result *result);

#endif
