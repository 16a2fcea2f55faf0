/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_DESCRIBE_H
#define TUNE_DESCRIBE_H

#include "tune/problem.h"
#include "tune/result.h"

/*
 * From a design to what is reported of it. Every number is recomputed here from scratch: systems, analyses and memory are new, made at that design, and compared with what the
 * search used (a difference beyond rounding becomes a warning).
 */

/* What the search knew of a design; zeroed for the original one. */
typedef struct mt_design {
    const double *t;              /* [n] coordinates */
    const mt_nlp_solution *found; /* NULL: the original design */
    int rank;
    bool interrupted;
} mt_design;

/* Fill rec (texts and lists in result->mem). baseline: NULL while the baseline itself is described. */
mt_status mt_describe_design(mt_problem *p, const mt_design *design,
                             const mt_recommendation *baseline, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* Sentences why a recommendation is what it is (reasons.c). */
mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err);
/* Judge the published list: x_recommended NULL where there is none (then the original design stands in) (published.c). */
mt_status mt_describe_published(mt_problem *p, const double *x_original,
                                const double *x_recommended, mt_result *result, mt_err *err);
/* Add a warning (formatted) to the result. */
mt_status mt_describe_warn(mt_result *result, mt_err *err, const char *fmt, ...)
    MT_PRINTF(3, 4);

#endif
