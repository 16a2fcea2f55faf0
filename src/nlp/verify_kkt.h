/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_VERIFY_KKT_H
#define NLP_VERIFY_KKT_H

#include "nlp/solution_pool.h"

/* Ranks, merges and verifies the ends: *out in mem (nlp.h). */
void mt_nlp_verify_kkt(mt_nlp_engine *e, mt_nlp_solution_pool *all, mt_arena *mem,
                       mt_nlp_result *out);

#endif
