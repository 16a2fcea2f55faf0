/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random sums over poles, and what they are at a real frequency in 113 bits. */
#ifndef VIBRATION_EXACT_SUM_H
#define VIBRATION_EXACT_SUM_H

#include <complex.h>
#include <math.h>

#include "stress/quad.h"
#include "support/mt_random.h"
#include "vibration/frf.h"

enum { PAIRS = 3, ALONE = 2 };

typedef struct rig {
    int n;
    double complex s[(2 * PAIRS) + ALONE];
    double complex r[(2 * PAIRS) + ALONE];
    mt_pole_sum sum;
} rig;

/* Pairs of any damping; the two products of which a pair's constant is made cancel in every
 * second one to some digits. Poles that stand alone have no partner. */
static inline void any_sum(mt_random *random, rig *g)
{
    g->n = 0;
    for (int k = 0; k < PAIRS; k++) {
        const double zeta = pow(10.0, mt_random_in(random, -9.0, -1e-3));
        const double size = pow(10.0, mt_random_in(random, -1.0, 2.0));
        const double complex s =
            mt_frf_complex(-zeta * size, sqrt((1.0 - zeta) * (1.0 + zeta)) * size);
        const double re = mt_random_in(random, -1.0, 1.0);
        const double near = 1.0 + pow(10.0, mt_random_in(random, -15.0, 0.0));
        const double im =
            k % 2 == 0 ? -re * creal(s) / cimag(s) * near : mt_random_in(random, -1.0, 1.0);
        g->s[g->n] = s;
        g->r[g->n++] = mt_frf_complex(re, im);
        g->s[g->n] = conj(s);
        g->r[g->n++] = mt_frf_complex(re, -im);
    }
    for (int k = 0; k < ALONE; k++) {
        g->s[g->n] =
            mt_frf_complex(-mt_random_in(random, 0.1, 9.0), mt_random_in(random, 0.0, 9.0));
        g->r[g->n++] =
            mt_frf_complex(mt_random_in(random, -1.0, 1.0), mt_random_in(random, -1.0, 1.0));
    }
    g->sum = (mt_pole_sum){.n = g->n, .s = g->s, .residue = g->r};
    g->sum.d[0] = mt_frf_complex(mt_random_in(random, -1.0, 1.0), 0.5);
    g->sum.d[1] = mt_frf_complex(0.1, mt_random_in(random, -1.0, 1.0));
    g->sum.d[2] = mt_frf_complex(mt_random_in(random, -0.1, 0.1), 0.0);
}

typedef struct quad_complex {
    quad re;
    quad im;
} quad_complex;

static inline quad_complex times(quad_complex a, quad_complex b)
{
    return (quad_complex){(a.re * b.re) - (a.im * b.im), (a.re * b.im) + (a.im * b.re)};
}

static inline quad_complex over(quad_complex a, quad_complex b)
{
    const quad norm = (b.re * b.re) + (b.im * b.im);
    const quad_complex c = times(a, (quad_complex){b.re, -b.im});
    return (quad_complex){c.re / norm, c.im / norm};
}

static inline quad size_of(quad_complex a)
{
    return quad_root((a.re * a.re) + (a.im * a.im));
}

static inline quad_complex exactly(double complex a)
{
    return (quad_complex){(quad)creal(a), (quad)cimag(a)};
}

/* H(i w) = sum r / (i w - s) + d0 + d1 i w + d2 (i w)^2 */
static inline quad_complex exact_value(const rig *g, quad w)
{
    const quad_complex at = {0, w};
    quad_complex sum = exactly(g->sum.d[0]);
    quad_complex power = {1, 0};
    for (int j = 1; j < 3; j++) {
        power = times(power, at);
        const quad_complex term = times(exactly(g->sum.d[j]), power);
        sum = (quad_complex){sum.re + term.re, sum.im + term.im};
    }
    for (int k = 0; k < g->n; k++) {
        const quad_complex below = {-(quad)creal(g->s[k]), w - (quad)cimag(g->s[k])};
        const quad_complex term = over(exactly(g->r[k]), below);
        sum = (quad_complex){sum.re + term.re, sum.im + term.im};
    }
    return sum;
}

#endif
