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
 * "objective mass [kg]") and, if it is none of them, the size of the redesign ("change"); and
 * their cells of one design. */
void mt_report_objective_columns(mt_table *t, const mt_result *result);
void mt_report_objective_cells(mt_table *t, const mt_result *result,
                               const mt_recommendation *r);
/* It is one of the result's objectives. */
bool mt_report_has_objective(const mt_result *result, const char *text);
/* An objective's value without what rounding has made of it, where that is known: of objectives
 * without a unit, and of percentages. */
double mt_report_objective_value(const char *unit, double value);
/* A cell of an objective's column. */
void mt_report_objective_cell(mt_table *t, const char *unit, double value);
/* The column of the least clearance from the bands without their margin, beside an objective
 * that is the one with it. */
void mt_report_clearance_column(mt_table *t, const mt_result *result);
/* A column for each variable in the unit that people see (which it is at this design, the same
 * for all; NULL: there is none), which machines find in the heading, people where it is not SI;
 * and their cells of one design. */
void mt_report_variable_columns(mt_table *t, const mt_result *result,
                                const mt_recommendation *of);
void mt_report_variable_cells(mt_table *t, const mt_result *result, const mt_recommendation *r);
/* name, unit, original, recommended, change, bound. */
mt_table mt_report_parameters(const mt_recommendation *r);
/* How the change of a parameter counts, as a sentence; false (and nothing) where it is the
 * plain logarithm. */
bool mt_report_measure(const mt_result_parameter *p, mt_text *out);
/* Each mode beside its neighbouring bands, one line per mode: the band below it and the band
 * above it with the distance to each. */
mt_table mt_report_clearances(const mt_recommendation *r);
/* One row for each drive with several positions: where the motion between them comes nearest to
 * a band. */
mt_table mt_report_motions(const mt_recommendation *r);
/* Bands and how many modes lie below each. */
mt_table mt_report_placements(const mt_recommendation *r);
/* One line per recommendation, below that of the original design. */
mt_table mt_report_alternatives(const mt_result *result);
/* Under other weights: parameter, unit, value, low, high, change of both, and what takes them
 * there. */
mt_table mt_report_weight_sensitivity(const mt_result *result);
/* label, published, computed, difference, role, source, verdict. */
mt_table mt_report_published(const mt_result *result);
/* The whole of all designs, one row each (rank 0: the baseline), for a spreadsheet:
 * recommendations.csv. */
mt_table mt_report_designs(const mt_result *result);

/* True where every published entry that can be compared holds. *judged (may be NULL): how many
 * of them there are. */
bool mt_report_verified(const mt_result *result, int *judged);

#endif
