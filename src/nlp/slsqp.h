/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_SLSQP_H
#define NLP_SLSQP_H

#include "nlp/engine.h"

/* One local search from p; the equalities are only those in rows[n_rows]. close: as near as
 * SLSQP comes, where Newton's method did not serve from where it stops else. last: where it
 * ended; p: the best point it met by mt_nlp_better. */
void mt_nlp_slsqp(mt_nlp_engine *e, int n_rows, const int *rows, bool close, mt_nlp_point *p,
                  mt_nlp_point *last);

#endif
