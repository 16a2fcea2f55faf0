/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_LDL_H
#define LINALG_LDL_H

#include "base/arena.h"

/* Pattern of a sparse symmetric matrix: row i is stored from column first[i] to the diagonal.
 * Entry (i, j), first[i] <= j <= i, is value[row[i] + j]. */
typedef struct mt_envelope {
    int n;
    int *first;     /* [n] */
    int *last;      /* [n] last row with an entry in column j */
    ptrdiff_t *row; /* [n] */
    size_t count;   /* number of values */
    int front;      /* greatest number of rows open at a time if no pivot is delayed */
} mt_envelope;

/* P A P^T = L D L^T, D in blocks of order one and two. */
typedef struct mt_ldl_pivot {
    int at[2];   /* rows of A; at[1] is -1 in a block of order one */
    double d[3]; /* d11, d21, d22 */
    int n;
    int *index;   /* [n] rows of A below the pivot */
    double *l[2]; /* [n] */
} mt_ldl_pivot;

typedef struct mt_ldl {
    int n;
    bool whole;   /* false: stopped, as more than `room` open rows were needed */
    int rank;     /* the remaining rows have no entry above tol */
    int negative; /* number of negative eigenvalues (Sylvester's law) */
    int n_pivots;
    mt_ldl_pivot *pivot;
    int n_rest;
    int *rest; /* [n_rest] rows of A that gave no pivot */
} mt_ldl;

/*
 * Factor a symmetric, possibly indefinite matrix of entries of about size one, possibly with
 * zeros on the diagonal. Rows enter a dense front in order and leave it as pivots of order one
 * or two as soon as all of their entries are assembled and no entry of L exceeds 10; other
 * pivots are delayed to a later front. room: greatest number of open rows. The factor is in
 * mem; O(n room^2). Fails: MT_E_DOMAIN (an entry is not finite), MT_E_MEMORY. Method: Duff and
 * Reid, ACM Trans. Math. Softw. 9 (1983) 302-325, with one front.
 */
mt_status mt_ldl_factor(const mt_envelope *p, const double *value, double tol, int room,
                        mt_arena *mem, mt_ldl *out, mt_err *err);
/* x [n] := A^-1 x. Singular A: a solution with 0 in the rows without a pivot, if x is in the
 * range. */
void mt_ldl_solve(const mt_ldl *f, double *x);
/* *norm: lower estimate of |A^-1| in the 1-norm, seldom more than 3 times too small (dlacn2);
 * infinite where A is singular. Costs a few solutions. Fails: MT_E_MEMORY. */
mt_status mt_ldl_inverse_norm(const mt_ldl *f, mt_arena *scratch, double *norm, mt_err *err);

#endif
