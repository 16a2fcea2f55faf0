/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_UNIDENTIFIABLE_DIRECTIONS_H
#define NLP_UNIDENTIFIABLE_DIRECTIONS_H

#include "nlp/engine.h"

bool mt_nlp_unidentifiable(mt_nlp_engine *e, const mt_nlp_point *p, mt_arena *mem,
                           mt_nlp_result *out);
/* Forget those along which p, the solution that they are told of, has no room. */
void mt_nlp_drop_roomless(const mt_nlp_engine *e, const mt_nlp_point *p, mt_nlp_result *out);
/* Put p back to the origin along the undetermined directions, where that costs nothing. */
void mt_nlp_pull_back(mt_nlp_engine *e, const mt_nlp_result *unidentifiable, mt_nlp_point *p);

#endif
