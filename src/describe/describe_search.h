/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_SEARCH_H
#define DESCRIBE_DESCRIBE_SEARCH_H

#include "search/catalogue_search.h"
#include "search/relaxation.h"

/* Add what the search has proven. *infeasible: it is proven that no combination meets the
 * goals. */
mt_status mt_describe_catalogue_certificate(const mt_catalogue_search_report *report,
                                            const mt_nlp_result *found, mt_result *result,
                                            bool *infeasible, mt_err *err);
/* The reason of a design's rank as a sentence; NULL: no memory. objective: with its direction,
 * "least change". */
const char *mt_describe_rank_text(const mt_catalogue_search_report *report,
                                  const mt_nlp_result *found, int rank, const char *objective,
                                  mt_arena *mem);

/* Fill result->relaxations, and add a sentence to the status where a relaxation exists. */
mt_status mt_describe_relaxations(const mt_problem *p, const mt_moves *moves, mt_result *result,
                                  mt_err *err);

#endif
