/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A linearised system's eigenvalues in long double: K and M as the sums of their terms, M =
 * L L^T, cyclic Jacobi rotations on L^-1 K L^-T. What the reduced rows and the positions lost
 * before is not seen here.
 */
#ifndef TESTS_BENCH_EXACT_H
#define TESTS_BENCH_EXACT_H

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "mechanics/linear.h"

enum { EXACT_SWEEPS = 40 };

/* out (n x n) = the matrix of one kind. */
static inline void exact_matrix(const mt_linear *lin, mt_term_kind kind, long double *out)
{
    const ptrdiff_t n = mt_linear_freedoms(lin);
    const mt_term_list *const list = mt_linear_terms(lin, kind);
    const double *const fixed = mt_linear_fixed(lin, kind);
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            out[i + (j * n)] = (long double)fixed[i + (j * n)];
            out[j + (i * n)] = (long double)fixed[i + (j * n)];
        }
    }
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        if (!t->varies) {
            continue;
        }
        const int other = t->pair ? (2 * t->first) + 1 - i : i;
        const double *const a = mt_linear_row(lin, kind, i);
        const double *const b = mt_linear_row(lin, kind, other);
        const long double c =
            (t->pair ? 0.5L : 1.0L) * (long double)mt_linear_value(lin, t->coefficient);
        for (ptrdiff_t col = 0; col < n; col++) {
            for (ptrdiff_t row = 0; row < n; row++) {
                out[row + (col * n)] += c * (long double)a[row] * (long double)b[col];
            }
        }
    }
}

/* m := its Cholesky factor, k := L^-1 K L^-T. */
static inline void exact_reduce(ptrdiff_t n, long double *m, long double *k)
{
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            long double s = m[i + (j * n)];
            for (ptrdiff_t c = 0; c < j; c++) {
                s -= m[i + (c * n)] * m[j + (c * n)];
            }
            m[i + (j * n)] = i == j ? sqrtl(s) : s / m[j + (j * n)];
        }
    }
    for (int side = 0; side < 2; side++) { /* L^-1 on the columns, then on the transposed */
        for (ptrdiff_t c = 0; c < n; c++) {
            for (ptrdiff_t i = 0; i < n; i++) {
                long double s = k[i + (c * n)];
                for (ptrdiff_t j = 0; j < i; j++) {
                    s -= m[i + (j * n)] * k[j + (c * n)];
                }
                k[i + (c * n)] = s / m[i + (i * n)];
            }
        }
        for (ptrdiff_t i = 0; i < n; i++) {
            for (ptrdiff_t j = 0; j < i; j++) {
                const long double t = k[i + (j * n)];
                k[i + (j * n)] = k[j + (i * n)];
                k[j + (i * n)] = t;
            }
        }
    }
}

/* L^-1 K L^-T, n x n, the caller's; NULL: no memory. Regular M only. */
static inline long double *exact_standard(const mt_linear *lin)
{
    const size_t n = (size_t)mt_linear_freedoms(lin);
    long double *const k = calloc(n * n, sizeof *k);
    long double *const m = calloc(n * n, sizeof *m);
    if (k != NULL && m != NULL) {
        exact_matrix(lin, MT_TERM_STIFFNESS, k);
        exact_matrix(lin, MT_TERM_MASS, m);
        exact_reduce((ptrdiff_t)n, m, k);
        free(m);
        return k;
    }
    free(k);
    free(m);
    return NULL;
}

static inline void exact_rotate(ptrdiff_t n, long double *a, ptrdiff_t p, ptrdiff_t q)
{
    const long double apq = a[p + (q * n)];
    const long double app = a[p + (p * n)];
    const long double aqq = a[q + (q * n)];
    if (fabsl(apq) <= LDBL_EPSILON * LDBL_EPSILON * (fabsl(app) + fabsl(aqq))) {
        return;
    }
    const long double h = (aqq - app) / (2.0L * apq);
    const long double t = (h < 0.0L ? -1.0L : 1.0L) / (fabsl(h) + sqrtl(1.0L + (h * h)));
    const long double c = 1.0L / sqrtl(1.0L + (t * t));
    const long double s = t * c;
    for (ptrdiff_t i = 0; i < n; i++) {
        const long double x = a[i + (p * n)];
        const long double y = a[i + (q * n)];
        a[i + (p * n)] = (c * x) - (s * y);
        a[i + (q * n)] = (s * x) + (c * y);
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        const long double x = a[p + (i * n)];
        const long double y = a[q + (i * n)];
        a[p + (i * n)] = (c * x) - (s * y);
        a[q + (i * n)] = (s * x) + (c * y);
    }
}

/* The diagonal of a becomes its eigenvalues, ascending. */
static inline void exact_eigenvalues(int order, long double *a)
{
    const ptrdiff_t n = order;
    for (int sweep = 0; sweep < EXACT_SWEEPS; sweep++) {
        for (ptrdiff_t p = 0; p < n; p++) {
            for (ptrdiff_t q = p + 1; q < n; q++) {
                exact_rotate(n, a, p, q);
            }
        }
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        const long double x = a[i * (n + 1)];
        ptrdiff_t at = i;
        for (; at > 0 && a[(at - 1) * (n + 1)] > x; at--) {
            a[at * (n + 1)] = a[(at - 1) * (n + 1)];
        }
        a[at * (n + 1)] = x;
    }
}

#endif
