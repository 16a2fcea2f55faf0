/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_SPARSE_H
#define LINALG_SPARSE_H

#include <math.h>

#include "base/arena.h"
#include "base/base.h"

/*
 * Sparse rows: the nonzero entries of each row by ascending index. Entries of row i are
 * start[i] .. start[i + 1] - 1; an empty row is 0.
 */
typedef struct mt_rows {
    int n_rows;
    int *start; /* [n_rows + 1] */
    int *index;
    double *value;
} mt_rows;

/* sum_i c_i b_i b_i^T over the rows b_i. */
typedef struct mt_squares {
    mt_rows row;
    const double *c; /* [row.n_rows] */
} mt_squares;

/* Allocate n_rows rows of at most `most` entries in all; then call mt_rows_push for the entries
 * of each row and mt_rows_end after it. A failure is the arena's. */
void mt_rows_begin(mt_rows *s, int n_rows, size_t most, mt_arena *mem);

static inline void mt_rows_push(mt_rows *s, int row, int index, double value)
{
    const int at = s->start[row + 1]++;
    s->index[at] = index;
    s->value[at] = value;
}

/* Ends row `row`. */
static inline void mt_rows_end(mt_rows *s, int row)
{
    if (row + 1 < s->n_rows) {
        s->start[row + 2] = s->start[row + 1];
    }
}

static inline bool mt_rows_empty(const mt_rows *s, int row)
{
    return s->start[row] == s->start[row + 1];
}

static inline double mt_rows_dot(const mt_rows *s, int row, const double *x)
{
    double sum = 0.0;
    for (int k = s->start[row]; k < s->start[row + 1]; k++) {
        sum += s->value[k] * x[s->index[k]];
    }
    return sum;
}

/* mt_rows_dot; *size: the sum of the magnitudes of its terms. */
static inline double mt_rows_dot_size(const mt_rows *s, int row, const double *x, double *size)
{
    double sum = 0.0;
    *size = 0.0;
    for (int q = s->start[row]; q < s->start[row + 1]; q++) {
        const double part = s->value[q] * x[s->index[q]];
        sum += part;
        *size += fabs(part);
    }
    return sum;
}

/* y += alpha times row `row`. */
static inline void mt_rows_axpy(const mt_rows *s, int row, double alpha, double *y)
{
    for (int k = s->start[row]; k < s->start[row + 1]; k++) {
        y[s->index[k]] += alpha * s->value[k];
    }
}

/* The n columns of a as rows. A failure is the arena's. */
void mt_rows_transpose(const mt_rows *a, int n, mt_arena *mem, mt_rows *out);
/* The columns of a dense matrix, n x count, as `count` rows. A failure is the arena's. */
void mt_rows_of_columns(int n, int count, const double *dense, mt_arena *mem, mt_rows *out);
/* out (n x n, lower triangle) += c a a^T of row a. */
void mt_rows_square(const mt_rows *s, int a, double c, int n, double *out);
/* out (n x n, lower triangle) += c (a b^T + b a^T)/2 of rows a and b. */
void mt_rows_pair(const mt_rows *s, int a, int b, double c, int n, double *out);

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

struct mt_factor_pattern {
    int n;
    int n_super;
    int *to;          /* [n] index of a row in the order of P */
    int *first;       /* [n_super + 1] first column of a supernode */
    int *row_at;      /* [n_super + 1] start of its rows in `row`, its own columns first */
    int *row;         /* ascending, in the order of P */
    ptrdiff_t *at;    /* [n_super + 1] start of its block in l: rows x columns */
    int *super_of;    /* [n] supernode that has the column */
    size_t most_rows; /* largest number of rows of a supernode */
    size_t most_columns;
};

#endif
