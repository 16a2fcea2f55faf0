/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_DISCRETE_H
#define DESCRIBE_DESCRIBE_DISCRETE_H

#include "search/discrete.h"

/* What of the search is proven. *infeasible: that no combination meets the goals is. */
mt_status mt_describe_discrete_certificate(const mt_discrete_report *report,
                                           const mt_nlp_result *found, mt_result *result,
                                           bool *infeasible, mt_err *err);
/* Why a design has its rank, as a sentence; NULL: no memory. objective: with its direction,
 * "least change". */
const char *mt_discrete_rank_text(const mt_discrete_report *report, const mt_nlp_result *found,
                                  int rank, const char *objective, mt_arena *mem);

#endif
