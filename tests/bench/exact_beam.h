/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The free-free lumped beam once more, in long double and by other means than the library: what
 * both sides of the benchmark are measured against. Coordinates: height of the left end, angles
 * theta_1..9; e_i = height of the centre of element i,
 *     e_i = y + L_e (theta_1 + ... + theta_{i-1}) + L_e theta_i / 2,
 *     M = sum m_e e_i e_i^T + I_e d_i d_i^T,   K = sum K_i (d_{i+1} - d_i)(d_{i+1} - d_i)^T,
 *         d_i picks theta_i,
 * M = L L^T, and cyclic Jacobi rotations on L^-1 K L^-T. df/dK_i = (theta_{i+1} - theta_i)^2 /
 * (8 pi^2 f) for a shape of unit modal mass.
 */
#ifndef TESTS_BENCH_EXACT_BEAM_H
#define TESTS_BENCH_EXACT_BEAM_H

#include <math.h>
#include <string.h>

enum { XB_N = 10, XB_ELEMENTS = 9, XB_SPRINGS = 8, XB_MODES = 4, XB_SWEEPS = 30 };

typedef long double xb_matrix[XB_N][XB_N];

typedef struct xb_modes {
    long double hz[XB_MODES];
    long double gradient[XB_MODES][XB_SPRINGS]; /* [Hz/(N m/rad)] */
} xb_modes;

static const long double XB_PI = 3.14159265358979323846264338327950288L;

static inline void xb_add(xb_matrix m, long double factor, const long double *v)
{
    for (int i = 0; i < XB_N; i++) {
        for (int j = 0; j < XB_N; j++) {
            m[i][j] += factor * v[i] * v[j];
        }
    }
}

/* Beam of 1 kg, 2 sqrt 2 m. */
static inline void xb_matrices(const long double *spring, xb_matrix k, xb_matrix m)
{
    const long double le = 2.0L * sqrtl(2.0L) / XB_ELEMENTS;
    const long double me = 1.0L / XB_ELEMENTS;
    memset(k, 0, sizeof(xb_matrix));
    memset(m, 0, sizeof(xb_matrix));
    for (int i = 1; i <= XB_ELEMENTS; i++) {
        long double e[XB_N] = {1.0L};
        long double d[XB_N] = {0.0L};
        for (int j = 1; j < i; j++) {
            e[j] = le;
        }
        e[i] = 0.5L * le;
        d[i] = 1.0L;
        xb_add(m, me, e);
        xb_add(m, me * le * le / 12.0L, d);
        if (i < XB_ELEMENTS) {
            d[i] = -1.0L;
            d[i + 1] = 1.0L;
            xb_add(k, spring[i - 1], d);
        }
    }
}

/* m becomes its Cholesky factor (lower), k becomes L^-1 K L^-T. */
static inline void xb_standard(xb_matrix k, xb_matrix m)
{
    for (int j = 0; j < XB_N; j++) {
        for (int i = j; i < XB_N; i++) {
            long double s = m[i][j];
            for (int c = 0; c < j; c++) {
                s -= m[i][c] * m[j][c];
            }
            m[i][j] = i == j ? sqrtl(s) : s / m[j][j];
        }
    }
    for (int side = 0; side < 2;
         side++) { /* L^-1 on the columns, then on the transposed result */
        for (int c = 0; c < XB_N; c++) {
            for (int i = 0; i < XB_N; i++) {
                long double s = k[i][c];
                for (int j = 0; j < i; j++) {
                    s -= m[i][j] * k[j][c];
                }
                k[i][c] = s / m[i][i];
            }
        }
        for (int i = 0; i < XB_N; i++) {
            for (int j = 0; j < i; j++) {
                const long double t = k[i][j];
                k[i][j] = k[j][i];
                k[j][i] = t;
            }
        }
    }
}

/* One rotation that makes a[p][q] zero; v collects the eigenvectors as columns. */
static inline void xb_rotate(xb_matrix a, xb_matrix v, int p, int q)
{
    if (fabsl(a[p][q]) == 0.0L) {
        return;
    }
    const long double h = (a[q][q] - a[p][p]) / (2.0L * a[p][q]);
    const long double t = (h < 0.0L ? -1.0L : 1.0L) / (fabsl(h) + sqrtl(1.0L + (h * h)));
    const long double c = 1.0L / sqrtl(1.0L + (t * t));
    const long double s = t * c;
    for (int i = 0; i < XB_N; i++) {
        const long double x = a[i][p];
        const long double y = a[i][q];
        a[i][p] = (c * x) - (s * y);
        a[i][q] = (s * x) + (c * y);
    }
    for (int i = 0; i < XB_N; i++) {
        const long double x = a[p][i];
        const long double y = a[q][i];
        a[p][i] = (c * x) - (s * y);
        a[q][i] = (s * x) + (c * y);
        const long double vx = v[i][p];
        const long double vy = v[i][q];
        v[i][p] = (c * vx) - (s * vy);
        v[i][q] = (s * vx) + (c * vy);
    }
}

/* The first four vibration modes: eigenvalues 3 to 6, two are rigid-body motions. */
static inline void xb_solve(const long double *spring, xb_modes *out)
{
    xb_matrix k;
    xb_matrix m;
    xb_matrix v = {{0.0L}};
    int order[XB_N] = {0};
    xb_matrices(spring, k, m);
    xb_standard(k, m);
    for (int i = 0; i < XB_N; i++) {
        v[i][i] = 1.0L;
    }
    for (int sweep = 0; sweep < XB_SWEEPS; sweep++) {
        for (int p = 0; p < XB_N; p++) {
            for (int q = p + 1; q < XB_N; q++) {
                xb_rotate(k, v, p, q);
            }
        }
    }
    for (int i = 0; i < XB_N; i++) { /* ascending, by insertion */
        int at = i;
        for (; at > 0 && k[order[at - 1]][order[at - 1]] > k[i][i]; at--) {
            order[at] = order[at - 1];
        }
        order[at] = i;
    }
    for (int mode = 0; mode < XB_MODES; mode++) {
        const int j = order[mode + 2];
        long double phi[XB_N] = {0.0L};
        out->hz[mode] = sqrtl(k[j][j]) / (2.0L * XB_PI);
        for (int i = XB_N - 1; i >= 0; i--) { /* L^T phi = v */
            long double s = v[i][j];
            for (int c = i + 1; c < XB_N; c++) {
                s -= m[c][i] * phi[c];
            }
            phi[i] = s / m[i][i];
        }
        for (int i = 0; i < XB_SPRINGS; i++) {
            const long double bend = phi[i + 2] - phi[i + 1];
            out->gradient[mode][i] = bend * bend / (8.0L * XB_PI * XB_PI * out->hz[mode]);
        }
    }
}

/* Solve the 4 x 4 system a x = b in place by elimination with row exchange; x replaces b. */
static inline void xb_linear(long double a[XB_MODES][XB_MODES], long double *b)
{
    for (int j = 0; j < XB_MODES; j++) {
        int best = j;
        for (int i = j; i < XB_MODES; i++) {
            best = fabsl(a[i][j]) > fabsl(a[best][j]) ? i : best;
        }
        for (int c = 0; c < XB_MODES; c++) {
            const long double t = a[j][c];
            a[j][c] = a[best][c];
            a[best][c] = t;
        }
        const long double t = b[j];
        b[j] = b[best];
        b[best] = t;
        for (int i = j + 1; i < XB_MODES; i++) {
            const long double f = a[i][j] / a[j][j];
            for (int c = j; c < XB_MODES; c++) {
                a[i][c] -= f * a[j][c];
            }
            b[i] -= f * b[j];
        }
    }
    for (int i = XB_MODES - 1; i >= 0; i--) {
        for (int c = i + 1; c < XB_MODES; c++) {
            b[i] -= a[i][c] * b[c];
        }
        b[i] /= a[i][i];
    }
}

/* The mirror-symmetric springs with these four frequencies, by Newton from spring[8]. */
static inline void xb_identify(const long double *target_hz, long double *spring)
{
    enum { STEPS = 20 };
    for (int step = 0; step < STEPS; step++) {
        xb_modes now;
        long double a[XB_MODES][XB_MODES];
        long double b[XB_MODES];
        xb_solve(spring, &now);
        for (int r = 0; r < XB_MODES; r++) {
            b[r] = target_hz[r] - now.hz[r];
            for (int c = 0; c < XB_MODES; c++) {
                a[r][c] = now.gradient[r][c] + now.gradient[r][XB_SPRINGS - 1 - c];
            }
        }
        xb_linear(a, b);
        for (int c = 0; c < XB_MODES; c++) {
            spring[c] += b[c];
            spring[XB_SPRINGS - 1 - c] = spring[c];
        }
    }
}

#endif
