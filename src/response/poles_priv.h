/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_POLES_PRIV_H
#define RESPONSE_POLES_PRIV_H

#include "response/poles.h"

/* Work of mt_response_poles. */
typedef struct mt_poles {
    const mt_basis *b;
    mt_arena *mem;
    ptrdiff_t n;     /* coordinates */
    ptrdiff_t pairs; /* n_in n_out */
    int *coupled;    /* [n_coupled] coordinates */
    int n_coupled;
    int count; /* poles so far */
    double complex *s;
    double complex *residue; /* pairs x most, one column per pole */
    double complex *d;       /* pairs x 3 */
    /* of the coupled coordinates */
    int order;
    int *x_of; /* [n] row of coordinate i's displacement; -1: none */
    int *v_of; /* [n] row of its velocity (displacement where it has no mass); -1: none */
    double *omega;
} mt_poles;

mt_status mt_poles_refuse(const char *why, mt_err *err);
double mt_poles_damping(const mt_poles *k, ptrdiff_t i, ptrdiff_t j);
/* s[2]: both roots of s^2 + c s + g. The small real part of a lightly damped pair keeps its
 * relative accuracy: that of the discriminant's root is computed from its imaginary part. */
void mt_poles_roots(double c, double complex g, double complex s[2]);
/* Add the poles of coordinate j, which is coupled to no other. */
mt_status mt_poles_without_partner(mt_poles *k, ptrdiff_t j, mt_err *err);
/* Add to d the polynomial part that the sum over the poles of the coupled coordinates lacks. */
mt_status mt_poles_add_polynomials(mt_poles *k, mt_err *err);

#endif
