/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_POLISH_H
#define NLP_POLISH_H

#include "nlp/engine.h"

/* Newton on the KKT conditions from p, which is replaced where the result is better. saddle
 * (may be NULL): [n] a direction of negative curvature, all zero where none was found. */
void mt_nlp_polish(mt_nlp_engine *e, mt_nlp_stage stage, mt_nlp_point *p, double *saddle);

#endif
