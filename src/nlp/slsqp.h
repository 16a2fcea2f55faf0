/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_SLSQP_H
#define NLP_SLSQP_H

#include "nlp/engine.h"

/* One local search from p; the equalities are rows[n_rows]. close: tolerances of a hundredth,
 * where Newton's method failed from the usual stop. last: the final point; p: the best point
 * met, by mt_nlp_better. */
void mt_nlp_slsqp(mt_nlp_engine *e, int n_rows, const int *rows, bool close, mt_nlp_point *p,
                  mt_nlp_point *last);

#endif
