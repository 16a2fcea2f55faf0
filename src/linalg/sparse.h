/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_SPARSE_H
#define LINALG_SPARSE_H

#include <math.h>

#include "base/arena.h"

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

#endif
