/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_RESULT_TABLES_H
#define REPORT_RESULT_TABLES_H

#include "report/table.h"
#include "result/result.h"

/* Tables of a result; the caller frees them. Frequencies have 6 significant digits, changes
 * 3. */

/* configuration, mode, name, original, recommended, target or limits, error, MAC with the
 * reference. */
mt_table mt_report_frequencies(const mt_recommendation *r);
/* text, unit, original, recommended of every objective. */
mt_table mt_report_objectives(const mt_recommendation *r);
/* An objective's value with rounding noise set to 0 where its size is known: for objectives
 * without a unit, and percentages. */
double mt_report_objective_value(const char *unit, double value);
/* name, unit, original, recommended, change, bound. */
mt_table mt_report_parameters(const mt_recommendation *r);
/* The measure of a parameter's change as a sentence; false (and no text) where it is the plain
 * logarithm. */
bool mt_report_measure(const mt_result_parameter *p, mt_text *out);
/* One row per mode with its neighbouring bands: the band below it and the band above it, with
 * the distance to each. */
mt_table mt_report_clearances(const mt_recommendation *r);
/* One row per drive with several positions: the least distance from a band between them. */
mt_table mt_report_motions(const mt_recommendation *r);
/* Bands and the number of modes below each. */
mt_table mt_report_placements(const mt_recommendation *r);
/* One row per recommendation, below that of the original design. */
mt_table mt_report_alternatives(const mt_result *result);
/* Sensitivity to the weights: parameter, unit, value, low, high, change of both, and the
 * weights that cause them. */
mt_table mt_report_weight_sensitivity(const mt_result *result);
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
/* The rows of the selected points of a large grid (mt_trade_select), and a sentence about their
 * number; of any other grid all rows, and no sentence. The result must have a trade study. */
mt_table mt_report_trade_selected(const mt_result *result);
void mt_report_trade_left(const mt_result *result, mt_text *line);

#endif
