/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_CATALOGUE_SEARCH_H
#define DESCRIBE_DESCRIBE_CATALOGUE_SEARCH_H

#include "search/catalogue_search.h"

/* What of the search is proven. *infeasible: that no combination meets the goals is. */
mt_status mt_describe_catalogue_certificate(const mt_catalogue_search_report *report,
                                            const mt_nlp_result *found, mt_result *result,
                                            bool *infeasible, mt_err *err);
/* Why a design has its rank, as a sentence; NULL: no memory. objective: with its direction,
 * "least change". */
const char *mt_describe_rank_text(const mt_catalogue_search_report *report,
                                  const mt_nlp_result *found, int rank, const char *objective,
                                  mt_arena *mem);

#endif
