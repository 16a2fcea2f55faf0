/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A response of few freedoms is solved at hundreds of frequencies a design: up to SMALL rows
 * LAPACK's calls cost more than the work, which is done here with the pivots and in the format
 * of zsytf2. */
#include "linalg/complex_ldl.h"

#include "linalg/lapack_priv.h"

#include <math.h>

enum { SMALL = 24 };

/* (1 + sqrt(17)) / 8: bounds the growth of entries (Bunch and Kaufman, Math. Comp. 31 (1977)
 * 163-179). */
static const double GROWTH = 0.64038820320220756873;

_Static_assert(sizeof(lapack_int) == sizeof(int), "pivots are ints");

/* Both parts of n complex numbers. */
static bool all_finite(ptrdiff_t n, const double complex *x)
{
    return mt_all_finite(2 * n, (const double *)x);
}

/* A work array of complex numbers, as mt_lapack_work. */
static mt_status work_of(mt_arena *scratch, double query, double minimum, double complex **work,
                         lapack_int *lwork, mt_err *err)
{
    double *room = NULL;
    MT_TRY(mt_lapack_work(scratch, 2.0 * query, 2.0 * minimum, &room, lwork, err));
    *lwork /= 2;
    *work = (double complex *)room;
    return MT_OK;
}

static double complex_size(double complex z)
{
    return fabs(creal(z)) + fabs(cimag(z));
}

/* Entry (i, j) of the symmetric matrix whose lower triangle is there. */
static double complex *entry(ptrdiff_t n, double complex *a, ptrdiff_t i, ptrdiff_t j)
{
    return i >= j ? &a[i + (j * n)] : &a[j + (i * n)];
}

static void swap_entries(double complex *x, double complex *y)
{
    const double complex z = *x;
    *x = *y;
    *y = z;
}

/* Column of the largest off-diagonal entry in row i, from column k on. */
static ptrdiff_t largest_in_row(ptrdiff_t n, double complex *a, ptrdiff_t i, ptrdiff_t k)
{
    ptrdiff_t best = i == k ? k + 1 : k;
    for (ptrdiff_t j = best + 1; j < n; j++) {
        if (j != i && complex_size(*entry(n, a, i, j)) > complex_size(*entry(n, a, i, best))) {
            best = j;
        }
    }
    return best;
}

/* The row that becomes the pivot of step k, or with *pair the second row of it. */
static ptrdiff_t choose_pivot_row(ptrdiff_t n, double complex *a, ptrdiff_t k, bool *pair)
{
    *pair = false;
    if (k == n - 1) {
        return k;
    }
    const ptrdiff_t row = largest_in_row(n, a, k, k);
    const double own = complex_size(a[k + (k * n)]);
    const double column = complex_size(*entry(n, a, row, k));
    if (own >= GROWTH * column) {
        return k;
    }
    const double other = complex_size(*entry(n, a, row, largest_in_row(n, a, row, k)));
    if (own >= GROWTH * column * (column / other)) {
        return k;
    }
    *pair = complex_size(a[row + (row * n)]) < GROWTH * other;
    return row;
}

/* Swap rows and columns `to` and `from` > to in the part that is not factored, from step k
 * on. */
static void interchange(ptrdiff_t n, double complex *a, ptrdiff_t k, ptrdiff_t to,
                        ptrdiff_t from)
{
    swap_entries(&a[to + (to * n)], &a[from + (from * n)]);
    for (ptrdiff_t i = k; i < n; i++) {
        if (i != to && i != from) {
            swap_entries(entry(n, a, i, to), entry(n, a, i, from));
        }
    }
}

static void eliminate_one(ptrdiff_t n, double complex *a, ptrdiff_t k, double complex inverse)
{
    double complex *const l = a + (k * n);
    for (ptrdiff_t j = k + 1; j < n; j++) {
        const double complex by = mt_times(inverse, l[j]);
        for (ptrdiff_t i = j; i < n; i++) {
            a[i + (j * n)] -= mt_times(l[i], by);
        }
        l[j] = by;
    }
}

/* D^-1 (x, y) of the block at k. */
static void solve_pair(ptrdiff_t n, const double complex *a, ptrdiff_t k, double complex *x,
                       double complex *y)
{
    const double complex between = 1.0 / a[k + 1 + (k * n)];
    const double complex first = mt_times(a[k + (k * n)], between);
    const double complex second = mt_times(a[k + 1 + ((k + 1) * n)], between);
    const double complex scale = between / (mt_times(first, second) - 1.0);
    const double complex was = *x;
    *x = mt_times(scale, mt_times(second, was) - *y);
    *y = mt_times(scale, mt_times(first, *y) - was);
}

static void eliminate_two(ptrdiff_t n, double complex *a, ptrdiff_t k)
{
    double complex *const l = a + (k * n);
    double complex *const r = l + n;
    for (ptrdiff_t j = k + 2; j < n; j++) {
        double complex x = l[j];
        double complex y = r[j];
        solve_pair(n, a, k, &x, &y);
        for (ptrdiff_t i = j; i < n; i++) {
            a[i + (j * n)] -= mt_times(l[i], x) + mt_times(r[i], y);
        }
        l[j] = x;
        r[j] = y;
    }
}

static void factor_small(mt_complex_ldl *f)
{
    const ptrdiff_t n = f->n;
    double complex *const a = f->a;
    for (ptrdiff_t k = 0; k < n;) {
        bool pair = false;
        const ptrdiff_t row = choose_pivot_row(n, a, k, &pair);
        const ptrdiff_t to = k + (pair ? 1 : 0);
        if (row != to) {
            interchange(n, a, k, to, row);
        }
        f->pivot[k] = pair ? -(int)(row + 1) : (int)(row + 1);
        f->pivot[to] = f->pivot[k];
        if (pair) {
            eliminate_two(n, a, k);
        } else if (a[k + (k * n)] != 0.0) {
            f->inverse[k] = 1.0 / a[k + (k * n)];
            eliminate_one(n, a, k, f->inverse[k]);
        } else {
            f->singular = true;
        }
        k = to + 1;
    }
}

/* b -= the column k of L below row `from`, times x. */
static void subtract(ptrdiff_t n, const double complex *a, ptrdiff_t k, ptrdiff_t from,
                     double complex x, double complex *b)
{
    for (ptrdiff_t i = from; i < n; i++) {
        b[i] -= mt_times(a[i + (k * n)], x);
    }
}

/* Column k of L below row `from`, times b. */
static double complex column_product(ptrdiff_t n, const double complex *a, ptrdiff_t k,
                                     ptrdiff_t from, const double complex *b)
{
    double complex sum = 0.0;
    for (ptrdiff_t i = from; i < n; i++) {
        sum += mt_times(a[i + (k * n)], b[i]);
    }
    return sum;
}

static void solve_small(const mt_complex_ldl *f, double complex *b)
{
    const ptrdiff_t n = f->n;
    const double complex *const a = f->a;
    for (ptrdiff_t k = 0; k < n; k++) {
        if (f->pivot[k] > 0) {
            swap_entries(&b[k], &b[f->pivot[k] - 1]);
            subtract(n, a, k, k + 1, b[k], b);
            b[k] = mt_times(f->inverse[k], b[k]);
        } else {
            swap_entries(&b[k + 1], &b[-f->pivot[k] - 1]);
            subtract(n, a, k, k + 2, b[k], b);
            subtract(n, a, k + 1, k + 2, b[k + 1], b);
            solve_pair(n, a, k, &b[k], &b[k + 1]);
            k++;
        }
    }
    for (ptrdiff_t k = n - 1; k >= 0; k--) {
        b[k] -= column_product(n, a, k, k + 1, b);
        if (f->pivot[k] > 0) {
            swap_entries(&b[k], &b[f->pivot[k] - 1]);
        } else {
            b[k - 1] -= column_product(n, a, k - 1, k + 1, b);
            swap_entries(&b[k], &b[-f->pivot[k] - 1]);
            k--;
        }
    }
}

double mt_complex_norm(int n, double complex *a)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (ptrdiff_t j = 0; j < n; j++) {
            sum += complex_size(*entry(n, a, i, j));
        }
        most = fmax(most, sum);
    }
    return most;
}

mt_status mt_complex_factor(int n, double complex *a, mt_arena *mem, mt_complex_ldl *out,
                            mt_err *err)
{
    *out = (mt_complex_ldl){.n = n, .a = a, .pivot = mt_arena_int(mem, (size_t)n)};
    MT_TRY(mt_arena_check(mem, err));
    if (n == 0) {
        return MT_OK;
    }
    if (!all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("zsytrf", err);
    }
    if (n <= SMALL) {
        out->inverse = mt_arena_alloc(mem, (size_t)n, sizeof *out->inverse);
        MT_TRY(mt_arena_check(mem, err));
        factor_small(out);
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double complex query = 1.0;
    double complex *work = NULL;
    lapack_int lwork = 1;
    if (n > MT_LAPACK_UNBLOCKED) {
        (void)LAPACKE_zsytrf_work(LAPACK_COL_MAJOR, 'L', n, a, n, out->pivot, &query, -1);
    }
    MT_TRY(work_of(mem, creal(query), 1.0, &work, &lwork, err));
    const lapack_int info =
        LAPACKE_zsytrf_work(LAPACK_COL_MAJOR, 'L', n, a, n, out->pivot, work, lwork);
    mt_arena_rewind(mem, mark);
    out->singular = info > 0;
    return info < 0 ? mt_lapack_bug("zsytrf", info, err) : MT_OK;
}

mt_status mt_complex_solve(const mt_complex_ldl *f, int nrhs, double complex *b, mt_err *err)
{
    if (f->n == 0 || nrhs == 0) {
        return MT_OK;
    }
    if (!all_finite((ptrdiff_t)f->n * nrhs, b)) {
        return mt_lapack_not_finite("zsytrs", err);
    }
    for (ptrdiff_t c = 0; c < nrhs && f->inverse != NULL; c++) {
        solve_small(f, b + (c * f->n));
    }
    if (f->inverse != NULL) {
        return MT_OK;
    }
    const lapack_int info =
        LAPACKE_zsytrs_work(LAPACK_COL_MAJOR, 'L', f->n, nrhs, f->a, f->n, f->pivot, b, f->n);
    return info < 0 ? mt_lapack_bug("zsytrs", info, err) : MT_OK;
}

mt_status mt_complex_rcond(const mt_complex_ldl *f, double norm, double *rcond,
                           mt_arena *scratch, mt_err *err)
{
    *rcond = f->n == 0 ? 1.0 : 0.0;
    if (f->n == 0 || f->singular) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const work = mt_arena_alloc(scratch, 2 * (size_t)f->n, sizeof *work);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info = LAPACKE_zsycon_work(LAPACK_COL_MAJOR, 'L', f->n, f->a, f->n,
                                                f->pivot, norm, rcond, work);
    mt_arena_rewind(scratch, mark);
    return info < 0 ? mt_lapack_bug("zsycon", info, err) : MT_OK;
}
