/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_JUDGE_H
#define NLP_JUDGE_H

#include "nlp/ends.h"

/* The ends as a ranked result in mem. */
void mt_nlp_judge(mt_nlp_engine *e, mt_nlp_ends *all, mt_arena *mem, mt_nlp_result *out);

#endif
