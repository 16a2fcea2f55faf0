/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_FACTOR_H
#define LINALG_FACTOR_H

#include "base/arena.h"

/*
 * P H P^T = L D L^T of a large sparse symmetric matrix, L unit lower triangular in dense blocks
 * of columns (supernodes), D diagonal with entries of either sign. No pivot is chosen for its
 * size: that is stable where H is positive definite, and else it is looked at afterwards,
 * pivot by pivot. By Sylvester's law H has as many negative eigenvalues as D has entries.
 * (Order and pattern of L: CHOLMOD; Chen, Davis, Hager and Rajamanickam, ACM TOMS 35, 2008.)
 */
typedef struct mt_factor_pattern mt_factor_pattern;

/* A symmetric matrix: the lower triangle by columns, rows ascending, every diagonal entry
 * there. */
typedef struct mt_lower {
    int n;
    int *start; /* [n + 1] */
    int *row;   /* [start[n]] */
    double *value;
} mt_lower;

typedef struct mt_factor {
    const mt_factor_pattern *pattern;
    double *l; /* blocks */
    double *d; /* [n], in the order of P */
    double *work;
    int columns;  /* that it solves for at a time */
    int negative; /* entries of D below 0 */
    /* Least |d| over the sum of the magnitudes that it is the rest of: what is left of it after
     * cancellation. Below some roundings its sign is by chance. */
    double least;
} mt_factor;

/**
 * Order and pattern of L, in mem; of every H with entries in these places. Deterministic; one
 * caller at a time.
 * @param[in] part  [n] numbers 0, 1, ... that ascend: rows of one part, as the states of a
 *                  body, couple to the same others and are ordered as one; NULL: each by itself
 * Fails: MT_E_MEMORY, also where the pattern has 2^31 entries.
 */
mt_status mt_factor_analyse(const mt_lower *h, const int *part, mt_arena *mem,
                            mt_factor_pattern **out, mt_err *err);
/* Room for a factor of such matrices that solves for so many columns at a time, in mem; a
 * shortage is the arena's. */
void mt_factor_init(const mt_factor_pattern *p, int columns, mt_arena *mem, mt_factor *f);
/* Factors H = h + c other (other NULL: h), whose entries stand in the places of the matrix that
 * was analysed. Scratch from mem is given back. Fails: MT_E_DOMAIN (not finite, or a pivot is 0
 * exactly), MT_E_MEMORY. */
mt_status mt_factor_make(mt_factor *f, const mt_lower *h, double c, const mt_lower *other,
                         mt_arena *mem, mt_err *err);
/* X := H^-1 X, n x count. L is read twice for f->columns of them, where it is large the whole
 * cost of one. */
void mt_factor_solve(const mt_factor *f, int count, double *x);

#endif
