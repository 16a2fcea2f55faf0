/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A slow wave is integrated by Gauss and Legendre's rule, whose nodes are enough for
 * FAST_WAVE/(2 pi) periods and the polynomial; a fast one by parts, a finite sum whose terms
 * fall as (derivatives of l_j)/x^k.
 */
#include "simulate/filon.h"

#include <math.h>

#include "linalg/kernels.h"

enum { DEGREE = MT_FILON_DEGREE, POINTS = MT_FILON_POINTS, GAUSS = MT_FILON_GAUSS };
static const double PI = 3.14159265358979323846;
static const double FAST_WAVE = 50.0;
enum { NEWTON_STEPS = 8 };

/* Legendre's polynomial of degree GAUSS: nodes and weights on [0, 1]. */
static void make_quadrature(mt_filon *q)
{
    for (int i = 0; i < GAUSS; i++) {
        double x = cos(PI * (i + 0.75) / (GAUSS + 0.5));
        double slope = 1.0;
        for (int round = 0; round < NEWTON_STEPS; round++) {
            double p0 = 1.0;
            double p1 = x;
            for (int k = 2; k <= GAUSS; k++) {
                const double p2 = (((2 * k) - 1) * x * p1 - ((k - 1) * p0)) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = GAUSS * ((x * p1) - p0) / ((x * x) - 1.0);
            x -= p1 / slope;
        }
        q->node[i] = 0.5 * (1.0 + x);
        q->gauss[i] = 1.0 / ((1.0 - (x * x)) * slope * slope);
    }
}

/* l_j at x. */
static double lagrange(const mt_filon *q, int j, double x)
{
    double value = 1.0;
    for (int k = 0; k < POINTS; k++) {
        value *= k == j ? 1.0 : (x - q->point[k]) / (q->point[j] - q->point[k]);
    }
    return value;
}

static void make_derivatives(mt_filon *q)
{
    double *const d = q->derivative[1];
    for (int i = 0; i < POINTS; i++) {
        q->derivative[0][i + (i * POINTS)] = 1.0;
        double sum = 0.0;
        for (int j = 0; j < POINTS; j++) {
            if (j != i) {
                d[i + (j * POINTS)] = q->last[j] / q->last[i] / (q->point[i] - q->point[j]);
                sum += d[i + (j * POINTS)];
            }
        }
        d[i + (i * POINTS)] = -sum;
    }
    for (int k = 2; k < POINTS; k++) {
        mt_gemm(false, false, POINTS, POINTS, POINTS, 1.0, d, POINTS, q->derivative[k - 1],
                POINTS, 0.0, q->derivative[k], POINTS);
    }
}

void mt_filon_make(mt_filon *q)
{
    for (int i = 0; i < POINTS; i++) {
        q->point[i] = 0.5 * (1.0 - cos(PI * i / DEGREE));
        q->last[i] = (i % 2 == 0 ? 1.0 : -1.0) * (i == 0 || i == DEGREE ? 0.5 : 1.0) / DEGREE;
    }
    make_quadrature(q);
    for (int i = 0; i < POINTS; i++) {
        for (int g = 0; g < GAUSS; g++) {
            for (int j = 0; j < POINTS; j++) {
                q->basis[j + (POINTS * (g + (GAUSS * i)))] =
                    lagrange(q, j, q->point[i] * q->node[g]);
            }
        }
    }
    make_derivatives(q);
}

double mt_filon_sine_over(double x, double c)
{
    return x > 0.0 ? sin(x * c) / x : c;
}

/* int_0^c e^(i x (c - s)) l_j ds by parts: sum_k (i x)^-(k+1) (e^(i x c) l_j^(k)(0) -
 * l_j^(k)(c)). */
static void weigh_fast(const mt_filon *q, int i, mt_filon_weights *w)
{
    const double c = w->c[i];
    const double s = w->s[i];
    for (int j = 0; j < POINTS; j++) {
        double re = 0.0;
        double im = 0.0;
        double power = 1.0 / w->x;
        for (int k = 0; k < POINTS; k++) {
            const double *const d = q->derivative[k] + ((ptrdiff_t)j * POINTS);
            const double from = d[0];
            const double a = (c * from) - d[i];
            const double b = s * from;
            /* times i^-(k+1) */
            const double turned[4][2] = {{b, -a}, {-a, -b}, {-b, a}, {a, b}};
            re += power * turned[k % 4][0];
            im += power * turned[k % 4][1];
            power /= w->x;
        }
        w->nc[i + (j * POINTS)] = re;
        w->ns[i + (j * POINTS)] = im;
        w->nd[i + (j * POINTS)] = im / w->x;
    }
}

static void weigh_slow(const mt_filon *q, int i, mt_filon_weights *w)
{
    const double c = q->point[i];
    for (int g = 0; g < GAUSS; g++) {
        const double left = c * (1.0 - q->node[g]);
        const double cosine = c * q->gauss[g] * cos(w->x * left);
        const double sine = c * q->gauss[g] * sin(w->x * left);
        const double over = c * q->gauss[g] * mt_filon_sine_over(w->x, left);
        const double *const l = q->basis + ((ptrdiff_t)POINTS * (g + (GAUSS * i)));
        for (int j = 0; j < POINTS; j++) {
            w->nc[i + (j * POINTS)] += cosine * l[j];
            w->ns[i + (j * POINTS)] += sine * l[j];
            w->nd[i + (j * POINTS)] += over * l[j];
        }
    }
}

void mt_filon_weigh(const mt_filon *q, double x, mt_filon_weights *w)
{
    if (w->x == x) {
        return;
    }
    *w = (mt_filon_weights){.x = x};
    for (int i = 0; i < POINTS; i++) {
        w->c[i] = cos(x * q->point[i]);
        w->s[i] = sin(x * q->point[i]);
        if (x > FAST_WAVE && i > 0) {
            weigh_fast(q, i, w);
        } else {
            weigh_slow(q, i, w);
        }
    }
}
