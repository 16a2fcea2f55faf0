/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One front that walks along the matrix. It holds, dense, the rows that are open: entered, but
 * not eliminated. A row that has all its entries may be a pivot. With f the front, c a column
 * of it and F_c its entries but the diagonal, a pivot
 *     of order one    d = f_cc,            l = F_c / d,               f <- f - l F_c^T
 *     of order two    D = [f_cc f_cr; f_cr f_rr],  [l_c l_r] = [F_c F_r] D^-1,
 *                                          f <- f - [l_c l_r] [F_c F_r]^T
 * is stable where |l| <= 1/THRESHOLD. Else it waits: later rows bring partners. In the last
 * front all rows are whole, and the largest entry leads (Bunch and Parlett, SIAM J. Numer.
 * Anal. 8 (1971) 639-655): nothing waits there but what is no larger than tol.
 */
#include "linalg/ldl.h"

#include <lapacke.h>

#include <math.h>
#include <string.h>

#include "linalg/complex.h"
#include "linalg/dense.h"

/* Entries of L stay below the inverse: MA27's and MUMPS's habit, between growth and delay. */
static const double THRESHOLD = 0.1;
/* Bunch and Parlett's (1 + sqrt 17)/8: the pivot that bounds growth in two steps of order one
 * as in one of order two. */
static const double ALPHA = 0.6403882032022076;

typedef struct front {
    int n;       /* open rows */
    int room;    /* leading dimension */
    int *row;    /* [room] of A */
    bool *whole; /* [room] all of its entries are there */
    double *f;   /* room x room, both triangles */
    int *place;  /* [n of A] in the front; -1: not there */
    double *l[2];
    int *head; /* [n of A] first column, + 1, of those whose last row this is; 0: none */
    int *next; /* [n of A] the next one */
} front;

static double *column(const front *w, int c)
{
    return w->f + ((ptrdiff_t)c * w->room);
}

static void enter(front *w, const mt_envelope *p, const double *value, int row)
{
    const int at = w->n++;
    double *const own = column(w, at);
    memset(own, 0, (size_t)w->n * sizeof *own);
    for (int c = 0; c < w->n; c++) {
        column(w, c)[at] = 0.0;
    }
    w->row[at] = row;
    w->whole[at] = false;
    w->place[row] = at;
    for (int j = p->first[row]; j <= row; j++) {
        const double v = value[p->row[row] + j];
        if (v != 0.0) {
            own[w->place[j]] = v;
            column(w, w->place[j])[at] = v;
        }
    }
}

/* Remove a row; the last row takes its place. */
static void leave(front *w, int at)
{
    const int from = --w->n;
    w->place[w->row[at]] = -1;
    if (at == from) {
        return;
    }
    w->row[at] = w->row[from];
    w->whole[at] = w->whole[from];
    w->place[w->row[at]] = at;
    double *const to = column(w, at);
    memcpy(to, column(w, from), (size_t)(from + 1) * sizeof *to);
    to[at] = to[from];
    for (int c = 0; c < w->n; c++) {
        column(w, c)[at] = to[c];
    }
}

/* Without the NaN rules of fmax, which took a tenth of a factorisation. */
static double larger(double most, double x)
{
    return fabs(x) > most ? fabs(x) : most;
}

/* Largest |entry| of a column but the diagonal; *where: among whole rows, -1: none. */
static double largest_off_diagonal(const front *w, int c, int *where)
{
    const double *const f = column(w, c);
    double most = 0.0;
    double most_whole = 0.0;
    *where = -1;
    for (int i = 0; i < w->n; i++) {
        const double size = i == c ? 0.0 : fabs(f[i]);
        most = larger(most, size);
        if (w->whole[i] && size > most_whole) {
            most_whole = size;
            *where = i;
        }
    }
    return most;
}

/* Columns of L of the pivot (c, r) into w->l, r < 0: of order one; returns their largest entry,
 * infinite where the pivot is singular. */
static double compute_pivot_columns(const front *w, int c, int r, double d[3])
{
    const double *const x = column(w, c);
    double most = 0.0;
    d[0] = x[c];
    if (r < 0) {
        for (int i = 0; i < w->n; i++) {
            w->l[0][i] = i == c ? 0.0 : x[i] / d[0];
            most = larger(most, w->l[0][i]);
        }
        return most;
    }
    const double *const y = column(w, r);
    d[1] = x[r];
    d[2] = y[r];
    const double d11 = d[2] / d[1];
    const double d22 = d[0] / d[1];
    const double det = (d11 * d22) - 1.0;
    if (det == 0.0) {
        return HUGE_VAL;
    }
    const double t = 1.0 / det / d[1];
    for (int i = 0; i < w->n; i++) {
        const bool own = i == c || i == r;
        w->l[0][i] = own ? 0.0 : t * ((d11 * x[i]) - y[i]);
        w->l[1][i] = own ? 0.0 : t * ((d22 * y[i]) - x[i]);
        most = larger(larger(most, w->l[0][i]), w->l[1][i]);
    }
    return most;
}

static void append_pivot(const front *w, int c, int r, const double d[3], mt_arena *mem,
                         mt_ldl *out)
{
    mt_ldl_pivot *const p = &out->pivot[out->n_pivots++];
    const int columns = r < 0 ? 1 : 2;
    *p = (mt_ldl_pivot){.at = {w->row[c], r < 0 ? -1 : w->row[r]}};
    p->index = mt_arena_int(mem, (size_t)w->n);
    p->l[0] = mt_arena_f64(mem, (size_t)w->n, (size_t)columns);
    p->l[1] = p->l[0] == NULL ? NULL : p->l[0] + (columns == 2 ? w->n : 0);
    for (int i = 0; i < w->n && !mt_arena_failed(mem); i++) {
        if (w->l[0][i] != 0.0 || (r >= 0 && w->l[1][i] != 0.0)) {
            p->index[p->n] = w->row[i];
            for (int k = 0; k < columns; k++) {
                p->l[k][p->n] = w->l[k][i];
            }
            p->n++;
        }
    }
    memcpy(p->d, d, sizeof p->d);
    out->rank += columns;
    if (r < 0) {
        out->negative += d[0] < 0.0 ? 1 : 0;
    } else if (d[2] / d[1] * (d[0] / d[1]) < 1.0) {
        out->negative += 1;
    } else {
        out->negative += d[0] < 0.0 ? 2 : 0;
    }
}

/* Subtract the pivot's contribution, computed by compute_pivot_columns, from the front. */
static void eliminate_pivot(front *w, int c, int r, const double d[3], mt_arena *mem,
                            mt_ldl *out)
{
    const double *const x = column(w, c);
    const double *const y = r < 0 ? NULL : column(w, r);
    append_pivot(w, c, r, d, mem, out);
    for (int j = 0; j < w->n; j++) {
        double *const f = column(w, j);
        if (j == c || j == r) {
            continue;
        }
        if (x[j] != 0.0) {
            mt_axpy(w->n, -x[j], w->l[0], f);
        }
        if (r >= 0 && y[j] != 0.0) {
            mt_axpy(w->n, -y[j], w->l[1], f);
        }
    }
    leave(w, c > r ? c : r);
    if (r >= 0) {
        leave(w, c < r ? c : r);
    }
}

/* Eliminate the whole row c where that is stable: alone, or with the whole row of its largest
 * entry. */
static bool try_pivot(front *w, int c, double tol, mt_arena *mem, mt_ldl *out)
{
    double d[3] = {0.0, 0.0, 0.0};
    int r = -1;
    const double most = largest_off_diagonal(w, c, &r);
    const double own = fabs(column(w, c)[c]);
    if (own > tol && own >= THRESHOLD * most) {
        (void)compute_pivot_columns(w, c, -1, d);
        eliminate_pivot(w, c, -1, d, mem, out);
        return true;
    }
    if (r < 0 || !(fabs(column(w, c)[r]) > tol) ||
        !(compute_pivot_columns(w, c, r, d) * THRESHOLD <= 1.0)) {
        return false;
    }
    eliminate_pivot(w, c, r, d, mem, out);
    return true;
}

static void try_all(front *w, double tol, mt_arena *mem, mt_ldl *out)
{
    for (int c = w->n - 1; c >= 0; c--) {
        if (c < w->n && w->whole[c] && try_pivot(w, c, tol, mem, out)) {
            c = w->n; /* those that had to wait may go now */
        }
    }
}

/* Eliminate the last front, by its largest entries. */
static void eliminate_last_front(front *w, double tol, mt_arena *mem, mt_ldl *out)
{
    for (;;) {
        double d[3] = {0.0, 0.0, 0.0};
        double off = 0.0;
        double diagonal = 0.0;
        int at[3] = {-1, -1, -1};
        for (int c = 0; c < w->n; c++) {
            for (int r = 0; r <= c; r++) {
                const double size = fabs(column(w, c)[r]);
                if (r == c && size > diagonal) {
                    diagonal = size;
                    at[2] = c;
                } else if (r < c && size > off) {
                    off = size;
                    at[0] = r;
                    at[1] = c;
                }
            }
        }
        if (!(fmax(diagonal, off) > tol)) {
            return;
        }
        const bool one = diagonal >= ALPHA * off;
        const int c = one ? at[2] : at[0];
        const int r = one ? -1 : at[1];
        (void)compute_pivot_columns(w, c, r, d);
        eliminate_pivot(w, c, r, d, mem, out);
    }
}

mt_status mt_ldl_factor(const mt_envelope *p, const double *value, double tol, int room,
                        mt_arena *mem, mt_ldl *out, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t most = (size_t)(room < p->n ? room : p->n);
    *out = (mt_ldl){.n = p->n};
    front w = {.room = (int)most};
    if (!mt_all_finite((ptrdiff_t)p->count, value)) {
        return mt_lapack_not_finite("LDL", err);
    }
    out->pivot = mt_arena_alloc(mem, n, sizeof *out->pivot);
    out->rest = mt_arena_int(mem, most);
    w.row = mt_arena_int(mem, most);
    w.whole = mt_arena_alloc(mem, most, sizeof *w.whole);
    w.place = mt_arena_int(mem, n);
    w.head = mt_arena_int(mem, n);
    w.next = mt_arena_int(mem, n);
    w.f = mt_arena_f64(mem, most, most);
    w.l[0] = mt_arena_f64(mem, most, 1);
    w.l[1] = mt_arena_f64(mem, most, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = p->n - 1; j >= 0; j--) { /* columns by their last row */
        w.next[j] = w.head[p->last[j]];
        w.head[p->last[j]] = j + 1;
    }
    for (int row = 0; row < p->n; row++) {
        if (w.n == w.room) {
            return MT_OK; /* not whole */
        }
        enter(&w, p, value, row);
        for (int j = w.head[row]; j > 0; j = w.next[j - 1]) {
            w.whole[w.place[j - 1]] = true;
        }
        if (w.head[row] > 0) {
            try_all(&w, tol, mem, out);
        }
        MT_TRY(mt_arena_check(mem, err));
    }
    eliminate_last_front(&w, tol, mem, out);
    MT_TRY(mt_arena_check(mem, err));
    out->whole = true;
    out->n_rest = w.n;
    memcpy(out->rest, w.row, (size_t)w.n * sizeof *out->rest);
    return MT_OK;
}

void mt_ldl_solve(const mt_ldl *f, double *x)
{
    for (int i = 0; i < f->n_pivots; i++) {
        const mt_ldl_pivot *const p = &f->pivot[i];
        const double a = x[p->at[0]];
        const double b = p->at[1] < 0 ? 0.0 : x[p->at[1]];
        for (int k = 0; k < p->n; k++) {
            x[p->index[k]] -=
                p->at[1] < 0 ? p->l[0][k] * a : (p->l[0][k] * a) + (p->l[1][k] * b);
        }
        if (p->at[1] < 0) {
            x[p->at[0]] = a / p->d[0];
            continue;
        }
        const double d11 = p->d[2] / p->d[1];
        const double d22 = p->d[0] / p->d[1];
        const double t = 1.0 / ((d11 * d22) - 1.0) / p->d[1];
        x[p->at[0]] = t * ((d11 * a) - b);
        x[p->at[1]] = t * ((d22 * b) - a);
    }
    for (int i = 0; i < f->n_rest; i++) {
        x[f->rest[i]] = 0.0;
    }
    for (int i = f->n_pivots - 1; i >= 0; i--) {
        const mt_ldl_pivot *const p = &f->pivot[i];
        double a = 0.0;
        double b = 0.0;
        for (int k = 0; k < p->n; k++) {
            a += p->l[0][k] * x[p->index[k]];
            b += p->at[1] < 0 ? 0.0 : p->l[1][k] * x[p->index[k]];
        }
        x[p->at[0]] -= a;
        if (p->at[1] >= 0) {
            x[p->at[1]] -= b;
        }
    }
}

mt_status mt_ldl_inverse_norm(const mt_ldl *f, mt_arena *scratch, double *norm, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const v = mt_arena_f64(scratch, (size_t)f->n, 1);
    double *const x = mt_arena_f64(scratch, (size_t)f->n, 1);
    lapack_int *const sign = mt_arena_alloc(scratch, (size_t)f->n, sizeof *sign);
    MT_TRY(mt_arena_check(scratch, err));
    lapack_int kase = 0;
    lapack_int save[3] = {0, 0, 0};
    *norm = f->rank < f->n ? HUGE_VAL : 0.0;
    while (f->n > 0 && f->rank == f->n) {
        (void)LAPACKE_dlacn2_work(f->n, v, x, sign, norm, &kase, save);
        if (kase == 0) {
            break;
        }
        mt_ldl_solve(f, x); /* A is its own transpose */
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* A response of few freedoms is solved at hundreds of frequencies a design: up to SMALL rows
 * LAPACK's calls cost more than the work, which is done here with the pivots and in the format
 * of zsytf2. */

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
