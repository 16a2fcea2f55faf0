/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A = Q T Q^T by reflections (Martin, Reinsch and Wilkinson 1968: tred2), T = S diag(w) S^T by
 * implicit QL steps with Wilkinson's shift (Dubrulle, Martin and Wilkinson 1968: imtql2), the
 * vectors Q S on the way. Normwise error n eps |A|, as any such algorithm.
 *
 * Graded matrices keep more where large entries are met first. A reflection that zeroes entries
 * of the last column beside the last diagonal entry mixes small rows with large ones only where
 * the large ones do not come last; a QL step works its way from the lower end up. So rows and
 * columns are put into ascending order of their diagonal entries before. LAPACK takes the order
 * that it finds.
 *
 * An entry e beside the diagonal of T is dropped where e^2 <= eps^2 |d d'|, d and d' beside it
 * (dsteqr): relative to what stands there, not to |A|.
 */
#include "linalg/eig_small.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

enum { MOST = MT_EIG_SMALL, STEPS = 30 }; /* QL steps for an eigenvalue, as dsteqr has them */

/* T, and the transformation to it. */
typedef struct reduced {
    int n;
    double d[MOST]; /* diagonal */
    double e[MOST]; /* e[i] beside d[i] and d[i + 1] */
    double q[MOST * MOST];
} reduced;

/* The upper triangle of A in ascending order of |a_ii|: row i was row place[i]. */
static void take_sorted(reduced *t, const double *a, int *place)
{
    const int n = t->n;
    for (int i = 0; i < n; i++) {
        const double size = fabs(a[i + (ptrdiff_t)i * n]);
        int at = i;
        for (; at > 0 && t->d[at - 1] > size; at--) {
            t->d[at] = t->d[at - 1];
            place[at] = place[at - 1];
        }
        t->d[at] = size;
        place[at] = i;
    }
    for (int j = 0; j < n; j++) {
        const int c = place[j];
        for (int i = 0; i <= j; i++) {
            const int r = place[i];
            t->q[i + j * n] = a[r > c ? r + (ptrdiff_t)c * n : c + (ptrdiff_t)r * n];
        }
    }
}

/* x[n] becomes u with (I - u u^T / h) x = (0, ..., 0, *beside); returns h, 0 where x has that
 * form already. */
static double reflect(int n, double *x, double *beside)
{
    double others = 0.0;
    for (int k = 0; k < n - 1; k++) {
        others += fabs(x[k]);
    }
    *beside = x[n - 1];
    if (others < DBL_MIN) {
        return 0.0;
    }
    int exponent = 0;
    (void)frexp(others + fabs(x[n - 1]), &exponent);
    const double scale = ldexp(1.0, -exponent);
    double h = 0.0;
    for (int k = 0; k < n; k++) {
        x[k] *= scale;
        h += x[k] * x[k];
    }
    const double g = -copysign(sqrt(h), x[n - 1]);
    h -= x[n - 1] * g;
    x[n - 1] -= g;
    *beside = g / scale;
    return h;
}

/* B := H B H, B n x n, upper triangle, columns ld apart; H = I - u u^T / h. With p = B u / h
 * and q = p - u (u^T p) / (2 h) that is B - u q^T - q u^T. */
static void turn_both_sides(int n, int ld, double *restrict b, const double *restrict u,
                            double h)
{
    double q[MOST];
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        const double *const bj = b + (ptrdiff_t)j * ld;
        double own = bj[j] * u[j];
        for (int k = 0; k < j; k++) {
            q[k] += bj[k] * u[j];
            own += bj[k] * u[k];
        }
        q[j] = own;
    }
    for (int j = 0; j < n; j++) {
        q[j] /= h;
        sum += q[j] * u[j];
    }
    sum /= 2.0 * h;
    for (int j = 0; j < n; j++) {
        q[j] -= sum * u[j];
    }
    for (int j = 0; j < n; j++) {
        double *const bj = b + (ptrdiff_t)j * ld;
        for (int k = 0; k <= j; k++) {
            bj[k] -= u[k] * q[j] + q[k] * u[j];
        }
    }
}

/* u of reflection i stays in column i. */
static void reduce_to_tridiagonal(reduced *t, double *h)
{
    const int n = t->n;
    h[0] = 0.0;
    for (int i = n - 1; i > 0; i--) {
        double *const u = t->q + (ptrdiff_t)i * n;
        h[i] = reflect(i, u, &t->e[i - 1]);
        if (h[i] > 0.0) {
            turn_both_sides(i, n, t->q, u, h[i]);
        }
    }
    for (int i = 0; i < n; i++) {
        t->d[i] = t->q[i + (ptrdiff_t)i * n];
    }
}

/* Q, the product of the reflections: the first i of them concern i rows. */
static void accumulate(reduced *t, const double *h)
{
    const int n = t->n;
    for (int i = 0; i < n; i++) {
        double *restrict const u = t->q + (ptrdiff_t)i * n;
        for (int j = 0; j < i && h[i] > 0.0; j++) {
            double *restrict const qj = t->q + (ptrdiff_t)j * n;
            double g = 0.0;
            for (int k = 0; k < i; k++) {
                g += u[k] * qj[k];
            }
            g /= h[i];
            for (int k = 0; k < i; k++) {
                qj[k] -= g * u[k];
            }
        }
        for (int j = 0; j < i; j++) {
            u[j] = 0.0;
            t->q[i + (ptrdiff_t)j * n] = 0.0;
        }
        u[i] = 1.0;
    }
}

/* sqrt(x^2 + y^2), also where squares underflow. */
static double safe_hypot(double x, double y)
{
    static const double LEAST = 1e-280; /* from here on squares have all of their digits */
    const double square = x * x + y * y;
    if (square >= LEAST) {
        return sqrt(square);
    }
    const double most = fmax(fabs(x), fabs(y));
    const double ratio = most > 0.0 ? fmin(fabs(x), fabs(y)) / most : 0.0;
    return most * sqrt(1.0 + ratio * ratio);
}

static void rotate_pair(int n, double c, double s, double *restrict low, double *restrict high)
{
    for (int k = 0; k < n; k++) {
        const double x = low[k];
        const double y = high[k];
        high[k] = s * x + c * y;
        low[k] = c * x - s * y;
    }
}

/* The end of the block that begins at l, behind which the off-diagonal entry of T is zero to
 * rounding. */
static int block_end(const reduced *t, int l)
{
    int m = l;
    while (m < t->n - 1) {
        const double square = t->e[m] * t->e[m];
        if (square <= DBL_EPSILON * DBL_EPSILON * fabs(t->d[m]) * fabs(t->d[m + 1]) + DBL_MIN) {
            break;
        }
        m++;
    }
    return m;
}

/* One QL step on the rows l to m of T, and the same rotations of Q's columns. */
static void ql_step(reduced *t, int l, int m, bool vectors)
{
    double *const d = t->d;
    double *const e = t->e;
    double shift = (d[l + 1] - d[l]) / (2.0 * e[l]);
    double r = sqrt(shift * shift + 1.0); /* infinite: the shift is d[l] */
    double g = d[m] - d[l] + e[l] / (shift + copysign(r, shift));
    double s = 1.0;
    double c = 1.0;
    double p = 0.0;
    int i = m - 1;
    for (; i >= l; i--) {
        const double f = s * e[i];
        const double b = c * e[i];
        r = safe_hypot(f, g);
        if (i + 1 < m) {
            e[i + 1] = r;
        }
        if (r == 0.0) { /* T comes apart here */
            break;
        }
        s = f / r;
        c = g / r;
        g = d[i + 1] - p;
        const double v = (d[i] - g) * s + 2.0 * c * b;
        p = s * v;
        d[i + 1] = g + p;
        g = c * v - b;
        if (vectors) {
            rotate_pair(t->n, c, s, t->q + (ptrdiff_t)i * t->n,
                        t->q + (ptrdiff_t)(i + 1) * t->n);
        }
    }
    if (i >= l) {
        d[i + 1] -= p;
    } else {
        d[l] -= p;
        e[l] = g;
    }
}

static bool diagonalise(reduced *t, bool vectors)
{
    int left = STEPS * t->n;
    for (int l = 0; l < t->n; l++) {
        for (int m = block_end(t, l); m > l; m = block_end(t, l)) {
            if (left-- == 0) {
                return false;
            }
            if (m < t->n - 1) {
                t->e[m] = 0.0;
            }
            ql_step(t, l, m, vectors);
        }
    }
    return true;
}

bool mt_eig_small(int n, double *a, double *w, bool vectors)
{
    reduced t;
    double h[MOST];
    int place[MOST];
    int rank[MOST];
    t.n = n;
    take_sorted(&t, a, place);
    reduce_to_tridiagonal(&t, h);
    if (vectors) {
        accumulate(&t, h);
    }
    if (!diagonalise(&t, vectors)) {
        return false;
    }
    for (int i = 0; i < n; i++) {
        int at = i;
        for (; at > 0 && t.d[rank[at - 1]] > t.d[i]; at--) {
            rank[at] = rank[at - 1];
        }
        rank[at] = i;
    }
    for (int j = 0; j < n; j++) {
        const double *const own = t.q + (ptrdiff_t)rank[j] * n;
        w[j] = t.d[rank[j]];
        for (int i = 0; i < n && vectors; i++) {
            a[place[i] + (ptrdiff_t)j * n] = own[i];
        }
    }
    return true;
}
