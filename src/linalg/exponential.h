/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_EXPONENTIAL_H
#define LINALG_EXPONENTIAL_H

#include "base/arena.h"

/*
 * Propagation of z' = A z over a step h and over its halvings:
 *     z(t + h 2^-j) = z(t) + F_j z(t),   F_j = exp(A h 2^-j) - 1,
 *     integral of z^T P z over the step = z(t)^T Q_j z(t).
 */
typedef struct mt_exponential {
    int n;
    int kept; /* halvings stored: 0 .. kept */
    double h;
    double **f; /* [kept + 1] n x n */
    double **q; /* [kept + 1] n x n, symmetric; NULL without P */
} mt_exponential;

/* A n x n, P n x n symmetric (both triangles) or NULL. */
typedef struct mt_exponential_of {
    int n;
    const double *a;
    const double *p;
    double h;
} mt_exponential_of;

/* Results in mem. least: halvings stored at least; all: also those down to the finest step, |A
 * h 2^-kept| < 1/2. Taylor series for the finest step, then doubling, F := 2 F + F^2, which
 * keeps the digits of F that are small beside 1; Q := Q + (1 + F)^T Q (1 + F). Fails:
 * MT_E_DOMAIN (not finite, or more than 100 halvings), MT_E_MEMORY. */
mt_status mt_exponential_make(const mt_exponential_of *of, int least, bool all, mt_arena *mem,
                              mt_exponential *out, mt_err *err);
/* z := z + F_j z. work[n]. */
void mt_exponential_step(const mt_exponential *e, int j, double *z, double *work);
/* z^T Q_j z. work[n]. */
double mt_exponential_integral(const mt_exponential *e, int j, const double *z, double *work);

#endif
