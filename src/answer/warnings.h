/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANSWER_WARNINGS_H
#define ANSWER_WARNINGS_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "base/warning.h"

/**
 * What is to be said of a configuration before any number: of its numbers and its drawing
 * (mt_model_lint), of its freedoms (free motions, unstable directions, redundant joints), of
 * its mass and its lowest frequency.
 * @param[in]  a    solved, with vectors
 * @param[in] inputs, at parameters that have other values than in the file [n_inputs] A list
 *   that several configurations are added to has what they share once, without a configuration.
 *   Facts and doubts, the greatest distance first. Fails: MT_E_INPUT (a fault: a mass below 0
 *   by an input), MT_E_MEMORY, as mt_linear_redundant_set.
 */
mt_status mt_warnings_of_analysis(mt_analysis *a, int n_inputs, const int *inputs,
                                  const double *at, mt_warning_list *out, mt_err *err);

/* The same where the lowest modes of a tree are all that is known. */
mt_status mt_warnings_of_lowest(const mt_lowest *l, int n_inputs, const int *inputs,
                                const double *at, mt_warning_list *out, mt_err *err);

/* Free motions that are no missing joint: rods that spin between their ball joints, beside
 * whatever else is free. Fails: MT_E_MEMORY, MT_E_NO_CONVERGENCE. */
typedef struct mt_warnings_rods {
    int n;
    const char *names; /* of each a body, quoted, separated by commas */
    double *other;     /* shape y of a free motion that is no spin; NULL: there is none */
} mt_warnings_rods;
mt_status mt_warnings_spins(const mt_analysis *a, mt_arena *mem, mt_warnings_rods *out,
                            mt_err *err);

/* True where it is said of a posture that settles more than ten degrees, or a tenth of the
 * model, away. It is the first line of any answer. */
bool mt_warnings_settles_far(const mt_warning *d);

/* What looking at configurations may cost where nobody asked for an analysis (`check`), in
 * operations: some three seconds. */
#define MT_WARNINGS_WORK 2e9
/* About what the analysis of a configuration takes: the cube and the square of its coordinates
 * and equations, and every number of the model. */
double mt_warnings_work(const mt_model *model, int configuration);
/* Tell that `left` configurations were not looked at, since that takes too long. */
void mt_warnings_left_out(int left, mt_warning_list *out);

#endif
