/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_COUPLINGS_H
#define MECHANICS_COUPLINGS_H

#include "mechanics/linear.h"

/* Whether the spring that a term of K comes from couples its measures (a bushing's matrix), and
 * whether any of its terms depends on an input. */
typedef enum mt_coupling {
    MT_COUPLING_NONE,
    MT_COUPLING_WHOLE,
    MT_COUPLING_VARIES
} mt_coupling;

/* coupling[n_terms] of the stiffness terms. */
void mt_couplings_find(const mt_linear *lin, mt_coupling *coupling);
/*
 * The terms `first` .. `end` - 1 of one such spring as a sum of squares at the present values:
 * rows of factor_b (with factor_noise) and factor_c from the first row of the spring on, 0 in
 * the rows beyond. False, and the rows are those of the measures, where they are none: an
 * indefinite matrix. O(6 n).
 */
bool mt_couplings_square(mt_linear *lin, int first, int end);
/* k (n x n, lower) += what stands in the rows of term t after that. */
void mt_couplings_add(const mt_linear *lin, const mt_term *t, double *k);
/* End of the spring that begins with term `first`. */
int mt_couplings_end(const mt_linear *lin, int first);

#endif
