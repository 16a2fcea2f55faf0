/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_DOUBTS_H
#define ANSWER_DOUBTS_H

#include "analysis/analysis.h"
#include "base/doubt.h"
#include "study/study.h"

/**
 * What is to be said of a configuration before any number: of its numbers and its drawing
 * (mt_model_judge), of its freedoms (free motions, unstable directions, redundant joints), of
 * its mass and its lowest frequency.
 * @param[in]  a    solved, with vectors
 * @param[in] inputs, at parameters that have other values than in the file [n_inputs] A list
 *   that several configurations are added to has what they share once, without a configuration.
 *   Facts and doubts, the greatest distance first. Fails: MT_E_INPUT (a fault: a mass below 0
 *   by an input), MT_E_MEMORY, as mt_linear_redundant_set.
 */
mt_status mt_doubts_of_analysis(mt_analysis *a, int n_inputs, const int *inputs,
                                const double *at, mt_doubt_list *out, mt_err *err);

/* What looking at configurations may cost where nobody asked for an analysis (`check`), in
 * operations: some three seconds. */
#define MT_DOUBTS_WORK 2e9
/* About what the analysis of a configuration takes: the cube and the square of its coordinates
 * and equations, and every number of the model. */
double mt_doubts_work(const mt_model *model, int configuration);
/* Does looking at what a study asks about take more? */
bool mt_study_takes_more(const mt_study *study, double most_work);
/* Tell that `left` configurations were not looked at, since that takes too long. */
void mt_doubts_left_out(int left, mt_doubt_list *out);

/**
 * The same of a study at its original design: its own numbers (study->doubts), every
 * configuration that a goal names, targets far from the original frequencies, bands that no
 * mode comes near. Names of files are those that the study knows (no folders). One analysis per
 * configuration, and 2 n + 3 where bands are to be avoided; none, and a fact that tells, where
 * that would take more than most_work (as mt_doubts_work counts). Fails: as mt_analysis_new.
 */
mt_status mt_study_examine(const mt_study *study, double most_work, mt_doubt_list *out,
                           mt_err *err);

#endif
