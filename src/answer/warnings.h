/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_WARNINGS_H
#define ANSWER_WARNINGS_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "base/diagnostics.h"

/**
 * Notes and warnings about a configuration: its numbers and reference position (mt_model_lint),
 * its degrees of freedom (free motions, unstable directions, redundant joints), its mass and
 * its lowest frequency.
 * @param[in]  a           solved, with vectors
 * @param[in]  inputs, at  [n_inputs] parameters with values other than the file's, and these
 *   values
 * @param[out] out         notes and warnings, the largest deviation first; an entry that
 *   several configurations share is listed once, without a configuration
 * Fails: MT_E_INPUT (an invalid input, such as one that makes a mass negative), MT_E_MEMORY, as
 * mt_linear_redundant_set.
 */
mt_status mt_warnings_of_analysis(mt_analysis *a, int n_inputs, const int *inputs,
                                  const double *at, mt_warning_list *out, mt_err *err);

/* The same from the lowest modes of a tree alone. */
mt_status mt_warnings_of_lowest(const mt_lowest *l, int n_inputs, const int *inputs,
                                const double *at, mt_warning_list *out, mt_err *err);

/* True for the warning that the equilibrium is more than ten degrees, or a tenth of the model,
 * from the reference position. It is the first line of any answer. */
bool mt_warnings_settles_far(const mt_warning *d);

/* Limit of work for checking configurations where no analysis was requested (`check`), in
 * operations: some three seconds. */
#define MT_WARNINGS_WORK 2e9
/* Approximate operations of an analysis: the cube and the square of its coordinates and
 * equations, and every number of the model. */
double mt_warnings_work(const mt_model *model, int configuration);
/* Add a note that `left` configurations were not checked because that takes too long. */
void mt_warnings_left_out(int left, mt_warning_list *out);

#endif
