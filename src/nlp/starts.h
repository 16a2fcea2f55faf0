/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_STARTS_H
#define NLP_STARTS_H

#include "nlp/nlp.h"

/*
 * Starting points of `starts` local searches: t, column-major n x starts, in mem. Start 0 is
 * the origin clamped to the bounds, the next the hint where given; the others fill the bounds
 * evenly for any number of starts. seed 0 and 1: the sequence without a shift. NULL: out of
 * memory.
 */
double *mt_nlp_starts(const mt_nlp *nlp, unsigned long seed, int starts, mt_arena *mem);

#endif
