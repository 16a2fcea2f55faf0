/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_COUPLINGS_H
#define MECHANICS_COUPLINGS_H

#include "mechanics/linear.h"

/* Coupling of the spring of a term of K: none; its matrix (a bushing's) couples its measures;
 * and some of its terms depend on an input. */
typedef enum mt_coupling {
    MT_COUPLING_NONE,
    MT_COUPLING_WHOLE,
    MT_COUPLING_VARIES
} mt_coupling;

/* coupling[n_terms] of the stiffness terms. */
void mt_couplings_find(const mt_linear *lin, mt_coupling *coupling);
/*
 * The springs with couplings of one kind as sums of squares at the present values, where they
 * are some (lin->squared): fills factor_b (with factor_noise) and factor_c from the first row
 * of each spring on, 0 in the remaining rows; the rows of an indefinite matrix are those of the
 * measures.
 */
void mt_couplings_square(mt_linear *lin, mt_coupling kind);
/* k (n x n, lower) += the squares of the spring's rows of term t, after mt_couplings_square. */
void mt_couplings_add(const mt_linear *lin, const mt_term *t, double *k);

#endif
