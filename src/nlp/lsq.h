/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_LSQ_H
#define NLP_LSQ_H

#include "nlp/engine.h"

/* Bounded Levenberg-Marquardt on residuals or violations, from *p; *p becomes the end. */
void mt_nlp_least_squares(mt_nlp_engine *e, mt_nlp_stage stage, mt_nlp_point *p);

#endif
