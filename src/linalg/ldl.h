/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LDL_H
#define LINALG_LDL_H

#include "base/arena.h"

/* Where the entries of a sparse symmetric matrix may stand: in row i from column first[i] to
 * the diagonal. Entry (i, j), first[i] <= j <= i, is value[row[i] + j]. */
typedef struct mt_envelope {
    int n;
    int *first;     /* [n] */
    int *last;      /* [n] the last row with an entry in column j; entries below it are 0 */
    ptrdiff_t *row; /* [n] */
    size_t count;   /* of values */
    int front;      /* most rows that are open at a time, where none is put off */
} mt_envelope;

/* P A P^T = L D L^T, D in blocks of order one and two. */
typedef struct mt_ldl_pivot {
    int at[2];   /* rows of A; at[1] is -1 in a block of order one */
    double d[3]; /* d11, d21, d22 */
    int n;
    int *index;   /* [n] rows of A below */
    double *l[2]; /* [n] */
} mt_ldl_pivot;

typedef struct mt_ldl {
    int n;
    bool whole;   /* false: it took more than `room` open rows, and was given up */
    int rank;     /* what is left of the other rows is no larger than tol */
    int negative; /* eigenvalues below 0 (inertia, Sylvester) */
    int n_pivots;
    mt_ldl_pivot *pivot;
    int n_rest;
    int *rest; /* [n_rest] rows of A that gave no pivot */
} mt_ldl;

/*
 * Factor a symmetric, possibly indefinite matrix of entries of about size one, zeros on the
 * diagonal included. Rows enter a dense front in their order and leave it as pivots of order
 * one or two as soon as all of their entries are there, where no entry of L gets larger than
 * 10; those that would have to are put off to be pivots of a later front. room: how many rows
 * may be open at most. The factor is in mem; O(n room^2). Fails: MT_E_DOMAIN (an entry is not
 * finite), MT_E_MEMORY.
 * Method: Duff and Reid, ACM Trans. Math. Softw. 9 (1983) 302-325, with one front.
 */
mt_status mt_ldl_factor(const mt_envelope *p, const double *value, double tol, int room,
                        mt_arena *mem, mt_ldl *out, mt_err *err);
/* x [n] := A^-1 x; of a singular A a solution that is 0 in the rows without a pivot, where x is
 * in the range. */
void mt_ldl_solve(const mt_ldl *f, double *x);
/* *norm: an estimate from below of |A^-1| in the 1-norm, seldom more than 3 times too small
 * (dlacn2); infinite where A is singular. A few solutions. Fails: MT_E_MEMORY. */
mt_status mt_ldl_inverse_norm(const mt_ldl *f, mt_arena *scratch, double *norm, mt_err *err);

#endif
