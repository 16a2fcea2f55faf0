/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_CATALOGUE_SEARCH_H
#define DESCRIBE_DESCRIBE_CATALOGUE_SEARCH_H

#include "search/catalogue_search.h"

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

#endif
