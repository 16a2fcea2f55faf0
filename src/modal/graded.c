/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Singular values of D C where D spreads far or rows of C are almost parallel. Householder's
 * method leaves eps of its length in every entry of a row, also in those that are 0 or small
 * and have digits of their own: two springs from a light body to heavy ones are parallel but
 * for the small entries of the heavy ones. Gaussian elimination with complete pivoting keeps
 * them (Demmel et al., Linear Algebra Appl. 299 (1999), algorithm 3.1):
 *     Pr C^T Pc = L U,         L, U up to a scaling of the rows of U well conditioned,
 *     D C = Y L^T Pr,          Y = D Pc U^T,
 *     L = Q1 R1,   Y P2 = Q2 R2   (rows of Y sorted),
 *     D C = Q2 (R2 P2^T R1^T) Q1^T Pr,
 * where the product in parentheses has rows graded by R2 and one-sided Jacobi does the rest.
 * Every factor is found to high relative accuracy for matrices that are well conditioned up to
 * a scaling of rows and columns; for others the error is no larger than before.
 */
#include "modal/modal_priv.h"

#include <math.h>
#include <string.h>

static void swap_rows(int n, int columns, int a, int b, double *x)
{
    for (ptrdiff_t j = 0; j < columns && a != b; j++) {
        const double kept = x[a + j * n];
        x[a + j * n] = x[b + j * n];
        x[b + j * n] = kept;
    }
}

static void swap_columns(int n, int a, int b, double *x)
{
    for (ptrdiff_t i = 0; i < n && a != b; i++) {
        const double kept = x[i + (ptrdiff_t)a * n];
        x[i + (ptrdiff_t)a * n] = x[i + (ptrdiff_t)b * n];
        x[i + (ptrdiff_t)b * n] = kept;
    }
}

static void swap_places(int a, int b, int *place)
{
    const int kept = place[a];
    place[a] = place[b];
    place[b] = kept;
}

/* x (n x columns) := L below the diagonal, U above it, for `rank` steps; fewer where the work
 * is interrupted. most[columns]: where the largest entry of each column that is left stands,
 * looked up while the column is in the cache. */
static void eliminate_columns(const mt_graded *g, int *column, ptrdiff_t *most)
{
    const int n = g->n;
    const int columns = g->rows;
    double *const x = g->ct;
    int *const row = g->place;
    for (ptrdiff_t j = 0; j < columns; j++) {
        most[j] = j * n + mt_max_index(n, x + j * n);
    }
    for (ptrdiff_t k = 0; k < g->rank; k++) {
        if (n >= MT_INTERRUPT_ORDER && mt_interrupted(g->interrupt)) {
            return;
        }
        ptrdiff_t at = most[k];
        for (ptrdiff_t j = k + 1; j < columns; j++) {
            at = fabs(x[most[j]]) > fabs(x[at]) ? most[j] : at;
        }
        swap_places((int)k, (int)(at % n), row);
        swap_places((int)k, (int)(at / n), column);
        swap_rows(n, columns, (int)k, (int)(at % n), x);
        swap_columns(n, (int)k, (int)(at / n), x);
        double *const own = x + k * n;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            own[i] /= own[k];
        }
        const int left = n - 1 - (int)k;
        for (ptrdiff_t j = k + 1; j < columns && left > 0; j++) {
            const double factor = x[k + j * n];
            double *const rest = x + j * n + k + 1;
            if (factor != 0.0) {
                mt_axpy(left, -factor, own + k + 1, rest);
            }
            most[j] = (rest - x) + mt_max_index(left, rest);
        }
    }
}

/* Rows of y (rows x r) in descending order of their largest entry: swapped, smallest last. */
static void sort_rows(int rows, int r, double *y, double *size)
{
    for (ptrdiff_t i = 0; i < rows; i++) {
        size[i] = 0.0;
        for (ptrdiff_t j = 0; j < r; j++) {
            size[i] = fmax(size[i], fabs(y[i + j * rows]));
        }
    }
    for (int i = 0; i < rows; i++) {
        int most = i;
        for (int k = i + 1; k < rows; k++) {
            most = size[k] > size[most] ? k : most;
        }
        swap_rows(rows, r, i, most, y);
        size[most] = size[i];
    }
}

/* w (r x r) := R2 P2^T P1 R1^T, with L P1 = Q1 R1; at[r]: work. */
static void product_of_factors(int r, const mt_qr *l, const mt_qr *y, int *at, double *w)
{
    for (int b = 0; b < r; b++) {
        at[l->perm[b]] = b;
    }
    for (ptrdiff_t a = 0; a < r; a++) {
        const ptrdiff_t b = at[y->perm[a]]; /* the same column of L and Y */
        for (ptrdiff_t j = 0; j <= b; j++) {
            mt_axpy((int)a + 1, l->qr[j + b * l->m], y->qr + a * y->m, w + j * r);
        }
    }
}

mt_status mt_modal_graded(mt_graded *g, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = g->n;
    const ptrdiff_t rows = g->rows;
    const size_t rank = (size_t)g->rank;
    int *const column = mt_arena_int(mem, (size_t)rows);
    ptrdiff_t *const most = mt_arena_alloc(mem, (size_t)rows, sizeof *most);
    double *const l = mt_arena_f64(mem, (size_t)n, rank);
    double *const y = mt_arena_f64(mem, (size_t)rows, rank);
    double *const size = mt_arena_f64(mem, (size_t)rows, 1);
    mt_qr yq;
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < rows; j++) {
        column[j] = j;
    }
    eliminate_columns(g, column, most);
    MT_TRY(mt_interrupt_check(g->interrupt, err));
    for (ptrdiff_t k = 0; k < g->rank; k++) {
        l[k + k * n] = 1.0;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            l[i + k * n] = g->ct[i + k * n];
        }
        for (ptrdiff_t j = k; j < rows; j++) {
            y[j + k * rows] = g->d[column[j]] * g->ct[k + j * n];
        }
    }
    sort_rows(g->rows, g->rank, y, size);
    MT_TRY(mt_qr_factor(g->n, g->rank, l, g->n, 0.0, mem, &g->q, err));
    MT_TRY(mt_qr_factor(g->rows, g->rank, y, g->rows, 0.0, mem, &yq, err));
    product_of_factors(g->rank, &g->q, &yq, column, g->w);
    return MT_OK;
}
