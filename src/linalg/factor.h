/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_FACTOR_H
#define LINALG_FACTOR_H

#include "base/arena.h"

/*
 * P H P^T = L D L^T of a large sparse symmetric matrix, L unit lower triangular in dense blocks
 * of columns (supernodes), D diagonal with entries of either sign. There is no pivoting by
 * size, which is stable where H is positive definite; otherwise mt_factor.least measures the
 * cancellation of the pivots afterwards. By Sylvester's law H has as many negative eigenvalues
 * as D has negative entries. (Order and pattern of L: CHOLMOD; Chen, Davis, Hager and
 * Rajamanickam, ACM TOMS 35, 2008.)
 */
typedef struct mt_factor_pattern mt_factor_pattern;

/* A symmetric matrix: the lower triangle by columns, rows ascending, every diagonal entry
 * stored. */
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
    int columns;  /* columns solved at a time */
    int negative; /* entries of D below 0 */
    /* least |d| relative to the sum of magnitudes of the terms of d: what cancellation leaves.
     * At a few roundings the sign of d is not reliable. */
    double least;
} mt_factor;

/**
 * Order and pattern of L, in mem, for every H with this pattern. Deterministic; one caller at a
 * time.
 * @param[in] part  [n] ascending numbers 0, 1, ...: rows of one part (the states of a body)
 *                  have the same pattern and are ordered as one; NULL: every row is a part
 * Fails: MT_E_MEMORY, also where the pattern has 2^31 entries.
 */
mt_status mt_factor_analyse(const mt_lower *h, const int *part, mt_arena *mem,
                            mt_factor_pattern **out, mt_err *err);
/* Allocate in mem a factor of such matrices that solves `columns` columns at a time; a shortage
 * is the arena's. */
void mt_factor_init(const mt_factor_pattern *p, int columns, mt_arena *mem, mt_factor *f);
/* Factor H = h + c other (other NULL: h); their entries must be in the analysed pattern.
 * Scratch from mem is returned. Fails: MT_E_DOMAIN (not finite, or a pivot is exactly 0),
 * MT_E_MEMORY. */
mt_status mt_factor_make(mt_factor *f, const mt_lower *h, double c, const mt_lower *other,
                         mt_arena *mem, mt_err *err);
/* X := H^-1 X, n x count. L is read twice per f->columns columns, which is the cost where L is
 * large. */
void mt_factor_solve(const mt_factor *f, int count, double *x);

#endif
