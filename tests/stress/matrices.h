/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric matrices of given spectra (as LAPACK's DLATMS makes them) and of a name. */
#ifndef STRESS_MATRICES_H
#define STRESS_MATRICES_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "stress/quad.h"
#include "support/mt_random.h"

enum { MOST = 14 };

typedef enum spectrum {
    ALL_EQUAL,  /* 1 1 1 ... */
    ONE_LARGE,  /* 1 e e e ... */
    ONE_SMALL,  /* 1 1 1 ... e */
    GEOMETRIC,  /* 1 ... e */
    ARITHMETIC, /* 1 ... e */
    DECADES,    /* anything between, evenly in the logarithm */
    UNIFORM,    /* anything in (-1, 1) */
    PAIRS,      /* 1 and its neighbour, e and its neighbour */
    SPECTRA
} spectrum;

static const char *const spectrum_names[SPECTRA] = {"all equal", "one large",  "one small",
                                                    "geometric", "arithmetic", "decades",
                                                    "uniform",   "pairs"};

/* d[n], from 1 to e. */
static inline void make_spectrum(spectrum kind, int n, double e, bool signs, mt_random *r,
                                 quad *d)
{
    const double last = n > 1 ? (double)(n - 1) : 1.0;
    for (int i = 0; i < n; i++) {
        const double part = (double)i / last;
        double x = 1.0;
        switch (kind) {
        case ALL_EQUAL:
            break;
        case ONE_LARGE:
            x = i == 0 ? 1.0 : e;
            break;
        case ONE_SMALL:
            x = i == n - 1 ? e : 1.0;
            break;
        case GEOMETRIC:
            x = pow(e, part);
            break;
        case ARITHMETIC:
            x = 1.0 - (part * (1.0 - e));
            break;
        case DECADES:
            x = pow(e, mt_random_in(r, 0.0, 1.0));
            break;
        case UNIFORM:
            x = mt_random_in(r, -1.0, 1.0);
            break;
        case PAIRS:
            x = (i < n / 2 ? 1.0 : e) * (1.0 + (DBL_EPSILON * (i % 2)));
            break;
        case SPECTRA:
            break;
        }
        d[i] = (quad)(signs && mt_random_int(r, 2) == 0 ? -x : x);
    }
}

/* x := H x H for random reflections H, as many as there are coordinates. */
static inline void mix(int n, mt_random *r, quad *x)
{
    quad v[MOST];
    for (int k = 0; k < n; k++) {
        quad norm = 0;
        for (int i = 0; i < n; i++) {
            v[i] = (quad)mt_random_in(r, -1.0, 1.0);
            norm += v[i] * v[i];
        }
        for (int side = 0; side < 2; side++) {
            for (int j = 0; j < n; j++) {
                const int step = side == 0 ? 1 : n;
                quad *const at = x + (side == 0 ? (ptrdiff_t)j * n : j);
                quad dot = 0;
                for (int i = 0; i < n; i++) {
                    dot += v[i] * at[(ptrdiff_t)i * step];
                }
                for (int i = 0; i < n; i++) {
                    at[(ptrdiff_t)i * step] -= 2 * dot / norm * v[i];
                }
            }
        }
    }
}

/* a: the matrix of that spectrum, rounded to doubles, times scale; exact: the same. */
static inline void make_matrix(int n, const quad *d, double scale, mt_random *r, double *a,
                               quad *exact)
{
    quad x[MOST * MOST] = {0};
    for (int i = 0; i < n; i++) {
        x[i + (i * n)] = d[i];
    }
    mix(n, r, x);
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            const int at = i >= j ? i + (j * n) : j + (i * n);
            a[i + (j * n)] = (double)x[at] * scale;
            exact[i + (j * n)] = (quad)a[i + (j * n)];
        }
    }
}

/* Entry i, j of matrices of a name, far = i - j >= 0. */
static inline double wilkinson(int n, int i, int far)
{
    return far == 0 ? abs((n / 2) - i) : far == 1 ? 1.0 : 0.0;
}

static inline double second_difference(int n, int i, int far)
{
    (void)n;
    (void)i;
    return far == 0 ? 2.0 : far == 1 ? -1.0 : 0.0;
}

/* -n + 1, -n + 3 ... n - 1. */
static inline double kac(int n, int i, int far)
{
    return far == 1 ? sqrt((double)i * (n - i)) : 0.0;
}

static inline double hilbert(int n, int i, int far)
{
    (void)n;
    return 1.0 / (i + (i - far) + 1);
}

static inline double almost_equal(int n, int i, int far)
{
    (void)n;
    (void)i;
    return far == 0 ? 1.0 : far == 1 ? 1e-9 : 0.0;
}

static inline double graded_down(int n, int i, int far)
{
    (void)n;
    return pow(10.0, far - (2 * i)) * (far == 0 ? 1.0 : 0.3);
}

static inline double graded_up(int n, int i, int far)
{
    return pow(10.0, (2 * (i - n)) - far) * (far == 0 ? 1.0 : 0.3);
}

/* Two of Wilkinson's, tied by 1e-8. */
static inline double glued(int n, int i, int far)
{
    const int half = (n / 2) + 1;
    const double tie = i == half ? 1e-8 : 1.0;
    return far == 0 ? abs((half / 2) - (i % half)) : far == 1 ? tie : 0.0;
}

static inline double arrow(int n, int i, int far)
{
    return far == 0 ? 1.0 : i == n - 1 ? 1e-3 : 0.0;
}

static inline double nothing(int n, int i, int far)
{
    (void)n;
    (void)i;
    (void)far;
    return 0.0;
}

static const struct {
    const char *name;
    double (*entry)(int n, int i, int far);
} named[] = {{"nothing", nothing},
             {"Wilkinson's W+", wilkinson},
             {"second difference", second_difference},
             {"Kac", kac},
             {"Hilbert", hilbert},
             {"almost equal", almost_equal},
             {"graded down", graded_down},
             {"graded up", graded_up},
             {"glued W+", glued},
             {"arrow", arrow}};

#endif
