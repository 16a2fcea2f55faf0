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
/* In tables of designs: a column for each objective of the result ("mass [kg]", for machines
 * "objective mass [kg]") and for the total change ("change"), where it is not an objective; and
 * their cells for one design. */
void mt_report_objective_columns(mt_table *t, const mt_result *result);
void mt_report_objective_cells(mt_table *t, const mt_result *result,
                               const mt_recommendation *r);
/* True where the text is one of the result's objectives. */
bool mt_report_has_objective(const mt_result *result, const char *text);
/* An objective's value with rounding noise set to 0 where its size is known: for objectives
 * without a unit, and percentages. */
double mt_report_objective_value(const char *unit, double value);
/* A cell of an objective's column. */
void mt_report_objective_cell(mt_table *t, const char *unit, double value);
/* The column of the least clearance from the bands without their margin, named so as to differ
 * from the objective "clearance". */
void mt_report_clearance_column(mt_table *t, const mt_result *result);
/* A column for each variable in its displayed unit (as of design `of`, the same for all; NULL:
 * no design), which the heading gives for machines always and for people where it is not SI;
 * and their cells for one design. */
void mt_report_variable_columns(mt_table *t, const mt_result *result,
                                const mt_recommendation *of);
void mt_report_variable_cells(mt_table *t, const mt_result *result, const mt_recommendation *r);
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

#endif
