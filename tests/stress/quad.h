/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Eigenvalues and singular values in 113 bits by Jacobi's rotations, for tests: the same under
 * valgrind, which has no long double of 64 bits. Column-major.
 */
#ifndef STRESS_QUAD_H
#define STRESS_QUAD_H

#include <stdbool.h>
#include <stddef.h>

typedef __float128 quad;

static inline quad quad_abs(quad x)
{
    return x < 0 ? -x : x;
}

/* Newton from the double, of x scaled to [1, 4). */
static inline quad quad_root(quad x)
{
    quad size = 1;
    if (!(x > 0)) {
        return 0;
    }
    while (x >= 4) {
        x /= 4;
        size *= 2;
    }
    while (x < 1) {
        x *= 4;
        size /= 2;
    }
    quad y = (quad)1.5;
    for (int i = 0; i < 8; i++) {
        y = (y + x / y) / 2;
    }
    return y * size;
}

/* tan of the rotation that makes [p q; q r] diagonal. */
static inline quad quad_tangent(quad p, quad q, quad r)
{
    const quad theta = (r - p) / (2 * q);
    const quad t = 1 / (quad_abs(theta) + quad_root((theta * theta) + 1));
    return theta < 0 ? -t : t;
}

static inline void quad_rotate(int n, quad t, ptrdiff_t step, quad *x, quad *y)
{
    const quad c = 1 / quad_root((t * t) + 1);
    const quad s = t * c;
    for (ptrdiff_t k = 0; k < n; k++) {
        const quad a = x[k * step];
        const quad b = y[k * step];
        x[k * step] = (c * a) - (s * b);
        y[k * step] = (s * a) + (c * b);
    }
}

static inline void quad_sort(int n, quad *w)
{
    for (int i = 1; i < n; i++) {
        for (int k = i; k > 0 && w[k] < w[k - 1]; k--) {
            const quad kept = w[k];
            w[k] = w[k - 1];
            w[k - 1] = kept;
        }
    }
}

/* w[n]: eigenvalues of symmetric a (full, destroyed), ascending, to 1e-30 of the largest. */
static inline void quad_eigenvalues(int n, quad *a, quad *w)
{
    quad size = 0;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)n * n; i++) {
        size = quad_abs(a[i]) > size ? quad_abs(a[i]) : size;
    }
    bool on = true;
    for (int sweep = 0; on && sweep < 40; sweep++) {
        on = false;
        for (ptrdiff_t p = 0; p < n; p++) {
            for (ptrdiff_t q = p + 1; q < n; q++) {
                if (quad_abs(a[p + (q * n)]) <= size * (quad)1e-33) {
                    continue;
                }
                on = true;
                const quad t = quad_tangent(a[p + (p * n)], a[p + (q * n)], a[q + (q * n)]);
                quad_rotate(n, t, 1, a + (p * n), a + (q * n));
                quad_rotate(n, t, n, a + p, a + q);
            }
        }
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        w[i] = a[i + (i * n)];
    }
    quad_sort(n, w);
}

/* s[n]: squares of the singular values of a (m x n, m >= n, destroyed), ascending, each to
 * 1e-28 of itself where columns of length one are independent to a few digits (Hestenes), to
 * 1e-33 of the largest where they are not. */
static inline void quad_squares(int m, int n, quad *a, quad *s)
{
    bool on = true;
    quad most = 0;
    for (ptrdiff_t k = 0; k < (ptrdiff_t)m * n; k++) {
        most += a[k] * a[k];
    }
    /* what is left of a column that depends on others */
    const quad nothing = most * (quad)1e-80;
    for (int sweep = 0; on && sweep < 60; sweep++) {
        on = false;
        for (ptrdiff_t p = 0; p < n; p++) {
            for (ptrdiff_t q = p + 1; q < n; q++) {
                quad pp = 0;
                quad pq = 0;
                quad qq = 0;
                for (ptrdiff_t k = 0; k < m; k++) {
                    pp += a[k + (p * m)] * a[k + (p * m)];
                    pq += a[k + (p * m)] * a[k + (q * m)];
                    qq += a[k + (q * m)] * a[k + (q * m)];
                }
                if (pq * pq <= pp * qq * (quad)1e-62 || pp <= nothing || qq <= nothing) {
                    continue;
                }
                on = true;
                quad_rotate(m, quad_tangent(pp, pq, qq), 1, a + (p * m), a + (q * m));
            }
        }
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        s[j] = 0;
        for (ptrdiff_t k = 0; k < m; k++) {
            s[j] += a[k + (j * m)] * a[k + (j * m)];
        }
    }
    quad_sort(n, s);
}

#endif
