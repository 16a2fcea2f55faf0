/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_STARTS_H
#define NLP_STARTS_H

#include "nlp/nlp.h"

/*
 * Where local searches from `starts` starts begin: t column-major n x starts in mem. Start 0 is
 * the origin within the bounds, the next the hint where there is one, the others fill the
 * bounds evenly, however many they are; seed 0 and 1: the sequence as it is. NULL where memory
 * is out.
 */
double *mt_nlp_starts(const mt_nlp *nlp, unsigned long seed, int starts, mt_arena *mem);

#endif
