/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Derivation. With B = A h:  F = B + B^2/2! + B^3/3! + ...
 *     d/dt (z^T P z) = z^T (A^T P + P A) z,  so  Q = h (P + P_1/2! + P_2/3! + ...),
 *     P_(k+1) = B^T P_k + P_k B.
 * With |B| <= 1/2 in the 1-norm and in that of B^T the terms of F are below 2^-k/k!, those of Q
 * below |P| 2^0/(k+1)!: what follows TERMS of them is below eps. Doubling squares 1 + F without
 * forming it (Higham, Functions of Matrices, 2008, ch. 10, has the method and its errors: about
 * 2^s eps of rounding, relative to each F by the way it is done here).
 */
#include "linalg/exponential.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

static const double LARGEST = 0.5;
enum { TERMS = 20, HALVINGS_MOST = 100 };

/* The larger of the 1-norms of A and A^T. */
static double norm_of(int n, const double *a)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        double column = 0.0;
        double row = 0.0;
        for (ptrdiff_t k = 0; k < n; k++) {
            column += fabs(a[k + (i * n)]);
            row += fabs(a[i + (k * n)]);
        }
        most = fmax(most, fmax(column, row));
    }
    return most;
}

static void add_scaled_matrix(size_t n2, double factor, const double *x, double *y)
{
    for (size_t i = 0; i < n2; i++) {
        y[i] += factor * x[i];
    }
}

/* out := Q's series, out starts as 0; p[2]: work. */
static void sum_integral(int n, const double *b, double h, double *p[2], double *out)
{
    const size_t n2 = (size_t)n * (size_t)n;
    double factor = h;
    add_scaled_matrix(n2, factor, p[0], out);
    for (int k = 1; k <= TERMS; k++) {
        /* P is symmetric: B^T P + P B = X + X^T, X = P B */
        mt_gemm(false, false, n, n, n, 1.0, p[0], n, b, n, 0.0, p[1], n);
        for (ptrdiff_t j = 0; j < n; j++) {
            for (ptrdiff_t i = 0; i < n; i++) {
                p[0][i + (j * n)] = p[1][i + (j * n)] + p[1][j + (i * n)];
            }
        }
        factor /= k + 1;
        add_scaled_matrix(n2, factor, p[0], out);
    }
}

static void sum_exponential(int n, const double *b, double *term[2], double *out)
{
    const size_t n2 = (size_t)n * (size_t)n;
    memcpy(term[0], b, n2 * sizeof *b);
    memcpy(out, b, n2 * sizeof *b);
    for (int k = 2; k <= TERMS; k++) {
        mt_gemm(false, false, n, n, n, 1.0 / k, b, n, term[0], n, 0.0, term[1], n);
        double *const swap = term[0];
        term[0] = term[1];
        term[1] = swap;
        add_scaled_matrix(n2, 1.0, term[0], out);
    }
}

/* One step: F and Q, NULL without P. */
typedef struct interval {
    double *f;
    double *q;
} interval;

static interval new_interval(size_t n, bool has_q, mt_arena *mem)
{
    return (interval){mt_arena_f64(mem, n, n), has_q ? mt_arena_f64(mem, n, n) : NULL};
}

/* to := the step of twice the length of `from`. */
static void double_up(int n, const interval *from, const interval *to, double *work[2])
{
    const size_t n2 = (size_t)n * (size_t)n;
    const double *const f = from->f;
    memcpy(to->f, f, n2 * sizeof *f);
    mt_gemm(false, false, n, n, n, 1.0, f, n, f, n, 2.0, to->f, n);
    if (from->q == NULL) {
        return;
    }
    /* Q + (1 + F)^T Q (1 + F) = 2 Q + X + X^T + F^T X, X = Q F */
    const double *const q = from->q;
    double *const x = work[0];
    double *const y = work[1];
    mt_gemm(false, false, n, n, n, 1.0, q, n, f, n, 0.0, x, n);
    mt_gemm(true, false, n, n, n, 1.0, f, n, x, n, 0.0, y, n);
    for (ptrdiff_t k = 0; k < n; k++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            to->q[i + (k * n)] = (2.0 * q[i + (k * n)]) + x[i + (k * n)] + x[k + (i * n)] +
                                 (0.5 * (y[i + (k * n)] + y[k + (i * n)]));
        }
    }
}

/* Halvings until |A h| is small. */
static mt_status count_halvings(int n, const double *a, double h, int least, int *out,
                                mt_err *err)
{
    const double norm = norm_of(n, a) * fabs(h);
    if (!mt_all_finite((ptrdiff_t)n * n, a) || !isfinite(norm)) {
        return mt_fail(err, MT_E_DOMAIN, "a matrix to be exponentiated is not finite");
    }
    *out = least;
    while (*out <= HALVINGS_MOST && ldexp(norm, -*out) > LARGEST) {
        ++*out;
    }
    return *out <= HALVINGS_MOST
               ? MT_OK
               : mt_fail(err, MT_E_DOMAIN, "a matrix is too large to be exponentiated");
}

mt_status mt_exponential_make(const mt_exponential_of *of, int least, bool all, mt_arena *mem,
                              mt_exponential *out, mt_err *err)
{
    const int n = of->n;
    const double *const a = of->a;
    const double *const p = of->p;
    const double h = of->h;
    const size_t order = (size_t)n;
    const size_t n2 = order * order;
    int s = 0;
    *out = (mt_exponential){.n = n, .h = h};
    MT_TRY(count_halvings(n, a, h, least, &s, err));
    out->kept = all ? s : least;
    out->f = mt_arena_alloc(mem, (size_t)out->kept + 1, sizeof *out->f);
    out->q = p == NULL ? NULL : mt_arena_alloc(mem, (size_t)out->kept + 1, sizeof *out->q);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j <= out->kept; j++) {
        const interval own = new_interval(order, p != NULL, mem);
        out->f[j] = own.f;
        if (p != NULL) {
            out->q[j] = own.q;
        }
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *work[2] = {mt_arena_f64(mem, order, order), mt_arena_f64(mem, order, order)};
    double *const b = mt_arena_f64(mem, order, order);
    const interval spare[2] = {new_interval(order, p != NULL, mem),
                               new_interval(order, p != NULL, mem)};
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n2; i++) {
        b[i] = a[i] * ldexp(h, -s);
    }
    interval last = {NULL, NULL};
    for (int j = s; j >= 0; j--) {
        const interval own =
            j > out->kept ? spare[j % 2] : (interval){out->f[j], p == NULL ? NULL : out->q[j]};
        if (j < s) {
            double_up(n, &last, &own, work);
        } else {
            sum_exponential(n, b, work, own.f);
        }
        if (j == s && p != NULL) {
            memcpy(work[0], p, n2 * sizeof *p);
            sum_integral(n, b, ldexp(h, -s), work, own.q);
        }
        last = own;
    }
    mt_arena_rewind(mem, mark);
    return mt_all_finite((ptrdiff_t)n2, out->f[0])
               ? MT_OK
               : mt_fail(err, MT_E_DOMAIN, "the exponential of a matrix is not finite");
}

void mt_exponential_step(const mt_exponential *e, int j, double *z, double *work)
{
    mt_gemv(false, e->n, e->n, 1.0, e->f[j], e->n, z, 0.0, work);
    for (int i = 0; i < e->n; i++) {
        z[i] += work[i];
    }
}

double mt_exponential_integral(const mt_exponential *e, int j, const double *z, double *work)
{
    mt_gemv(false, e->n, e->n, 1.0, e->q[j], e->n, z, 0.0, work);
    return mt_dot(e->n, z, work);
}
