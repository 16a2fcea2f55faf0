/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_UNIDENTIFIABLE_DIRECTIONS_H
#define NLP_UNIDENTIFIABLE_DIRECTIONS_H

#include "nlp/engine.h"

bool mt_nlp_unidentifiable(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                           mt_nlp_result *out);
/* Remove directions along which the bounds leave p, the reported solution, no way to move. */
void mt_nlp_drop_roomless(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out);
/* Move p to the origin along the unidentifiable directions where requirements, objective and
 * stationarity stay as good. */
void mt_nlp_pull_back(mt_nlp_engine *e, const mt_nlp_result *unidentifiable, mt_nlp_point *p);

#endif
