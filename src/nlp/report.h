/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_REPORT_H
#define NLP_REPORT_H

#include "nlp/engine.h"

/* Fill the record of a solution from a point (copies; no evaluation). kkt excludes the part of
 * the residual along the unidentifiable directions of `all`, which were not searched. False:
 * memory or linear algebra, as mt_nlp_ok. */
bool mt_nlp_report(mt_nlp_engine *e, const mt_nlp_point *p, const mt_nlp_result *all,
                   mt_arena *mem, mt_nlp_solution *out);

#endif
