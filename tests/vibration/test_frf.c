/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sums over poles at real frequencies against 113 bits: the value is off by a few roundings of
 * the size that is told with it, and that size is the sum of what is added, also where parts
 * of a pair cancel.
 */
#include <float.h>

#include "exact_sum.h"
#include "mt_test.h"

enum { SUMS = 400, PLACES = 8 };

/* n + 8 units in the last place of the size, as frf.h says. */
static const double ROUNDINGS = ((2 * PAIRS) + ALONE + 8) * DBL_EPSILON;

/* What is added up: of a pair 2 (Re r Re s + Im r Im s - i w Re r) / ((w - w1) (w - w2)), part
 * by part, of others the whole term. */
static quad exact_size(const rig *g, double w)
{
    quad sum = size_of(exactly(g->sum.d[0])) + ((quad)w * size_of(exactly(g->sum.d[1]))) +
               ((quad)w * (quad)w * size_of(exactly(g->sum.d[2])));
    for (int k = 0; k < g->n; k += k < 2 * PAIRS ? 2 : 1) {
        const quad_complex below = {-(quad)creal(g->s[k]), (quad)w - (quad)cimag(g->s[k])};
        if (k >= 2 * PAIRS) {
            sum += size_of(over(exactly(g->r[k]), below));
            continue;
        }
        const quad_complex mirror = {-(quad)creal(g->s[k]), (quad)w + (quad)cimag(g->s[k])};
        const quad a = quad_abs((quad)creal(g->r[k]) * (quad)creal(g->s[k]));
        const quad b = quad_abs((quad)cimag(g->r[k]) * (quad)cimag(g->s[k]));
        const quad slope = (quad)w * quad_abs((quad)creal(g->r[k]));
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
            const quad_complex want = exact_value(&g, (quad)w);
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
