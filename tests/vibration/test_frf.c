/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sums over poles at real frequencies against 113 bits: the value is off by a few roundings of
 * the size that is told with it, and that size is the sum of what is added, also where parts
 * of a pair cancel.
 */
#include <complex.h>
#include <float.h>
#include <math.h>

#include "mt_test.h"
#include "stress/quad.h"
#include "support/mt_random.h"
#include "vibration/frf.h"

enum { PAIRS = 3, ALONE = 2, SUMS = 400, PLACES = 8 };

/* n + 8 units in the last place of the size, as frf.h says. */
static const double ROUNDINGS = ((2 * PAIRS) + ALONE + 8) * DBL_EPSILON;

typedef struct rig {
    int n;
    double complex s[(2 * PAIRS) + ALONE];
    double complex r[(2 * PAIRS) + ALONE];
    mt_pole_sum sum;
} rig;

/* Pairs of any damping; the two products of which a pair's constant is made cancel in every
 * second one to some digits. Poles that stand alone have no partner. */
static void any_sum(mt_random *random, rig *g)
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

static quad_complex times(quad_complex a, quad_complex b)
{
    return (quad_complex){(a.re * b.re) - (a.im * b.im), (a.re * b.im) + (a.im * b.re)};
}

static quad_complex over(quad_complex a, quad_complex b)
{
    const quad norm = (b.re * b.re) + (b.im * b.im);
    const quad_complex c = times(a, (quad_complex){b.re, -b.im});
    return (quad_complex){c.re / norm, c.im / norm};
}

static quad size_of(quad_complex a)
{
    return quad_root((a.re * a.re) + (a.im * a.im));
}

static quad_complex exactly(double complex a)
{
    return (quad_complex){creal(a), cimag(a)};
}

/* H(i w) = sum r / (i w - s) + d0 + d1 i w + d2 (i w)^2 */
static quad_complex exact_value(const rig *g, double w)
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
        const quad_complex below = {-creal(g->s[k]), (quad)w - (quad)cimag(g->s[k])};
        const quad_complex term = over(exactly(g->r[k]), below);
        sum = (quad_complex){sum.re + term.re, sum.im + term.im};
    }
    return sum;
}

/* What is added up: of a pair 2 (Re r Re s + Im r Im s - i w Re r) / ((w - w1) (w - w2)), part
 * by part, of others the whole term. */
static quad exact_size(const rig *g, double w)
{
    quad sum = size_of(exactly(g->sum.d[0])) + ((quad)w * size_of(exactly(g->sum.d[1]))) +
               ((quad)w * (quad)w * size_of(exactly(g->sum.d[2])));
    for (int k = 0; k < g->n; k += k < 2 * PAIRS ? 2 : 1) {
        const quad_complex below = {-creal(g->s[k]), (quad)w - (quad)cimag(g->s[k])};
        if (k >= 2 * PAIRS) {
            sum += size_of(over(exactly(g->r[k]), below));
            continue;
        }
        const quad_complex mirror = {-creal(g->s[k]), (quad)w + (quad)cimag(g->s[k])};
        const quad a = quad_abs((quad)creal(g->r[k]) * (quad)creal(g->s[k]));
        const quad b = quad_abs((quad)cimag(g->r[k]) * (quad)cimag(g->s[k]));
        const quad slope = (quad)w * quad_abs(creal(g->r[k]));
        sum += 2 * (a + b + slope) / size_of(times(below, mirror));
    }
    return sum;
}

static void frf__is_off_by_roundings_of_the_size_it_tells(mt_test *t)
{
    mt_random random = mt_random_seed(77);
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < SUMS; i++) {
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        rig g;
        mt_frf h;
        any_sum(&random, &g);
        mt_test_row(t, "sum %d", i);
        if (!CHECK_INT(t, mt_frf_init(&h, &g.sum, &mem, NULL), MT_OK)) {
            break;
        }
        CHECK_INT(t, h.n_pairs, PAIRS);
        for (int k = 0; k < PLACES; k++) {
            const double w = k == 0 ? 0.0 : pow(10.0, mt_random_in(&random, -3.0, 3.0));
            double size = nan("");
            const double complex got = mt_frf_value(&h, (mt_near){.anchor = w}, &size);
            const quad_complex want = exact_value(&g, w);
            const quad_complex off = {(quad)creal(got) - want.re, (quad)cimag(got) - want.im};
            CHECK(t, (double)size_of(off) <= ROUNDINGS * size);
            CHECK_NEAR(t, size, (double)exact_size(&g, w), 1e-12);
            CHECK(t, creal(got) == creal(mt_frf_value(&h, (mt_near){.anchor = w}, NULL)));
        }
        mt_arena_rewind(&mem, mark);
    }
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(frf__is_off_by_roundings_of_the_size_it_tells))
