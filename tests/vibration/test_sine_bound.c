/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the search for the largest response calls a bound of an interval, tried as one: no
 * frequency of it has more, in 113 bits, rising, falling or with its top within; and it is
 * close where the interval is short. The search itself finds the largest response mostly
 * without it.
 */
#include "exact_sum.h"
#include "mt_test.h"
#include "vibration/sine.c" /* NOLINT(bugprone-suspicious-include) */

enum { SUMS = 40, PLACES = 12, CUTS = 6 };

static double exact_square(const rig *g, const mt_panel *p, double part)
{
    const double t = fmin(fmax(p->a + (part * (p->b - p->a)), p->a), p->b);
    const quad w = (quad)p->anchor + (quad)t;
    const quad_complex h = exact_value(g, w);
    return (double)((h.re * h.re) + (h.im * h.im));
}

/* The bound of one interval against places within, and its tightness: *above. */
static void check(mt_test *t, mt_random *random, const rig *g, const mt_frf *h,
                  const mt_panel *p, double *above)
{
    const double most = bound(h, p, centre_of(p), &(double){0.0});
    double seen = 0.0;
    for (int k = 0; k <= PLACES; k++) {
        const double part = k < 2 ? k : mt_random_in(random, 0.0, 1.0);
        seen = fmax(seen, exact_square(g, p, part));
    }
    CHECK(t, most >= seen * (1.0 - (4.0 * DBL_EPSILON)));
    *above = (most / seen) - 1.0;
}

static void bound__is_above_every_frequency_of_an_interval(mt_test *t)
{
    mt_random random = mt_random_seed(112);
    mt_arena mem = {0};
    int panels = 0;
    int close = 0;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < SUMS; i++) {
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        rig g;
        mt_frf h;
        mt_panels walk;
        mt_panel p;
        any_sum(&random, &g);
        mt_test_row(t, "sum %d", i);
        if (!CHECK_INT(t, mt_frf_init(&h, &g.sum, &mem, NULL), MT_OK)) {
            break;
        }
        const double lower = pow(10.0, mt_random_in(&random, -2.0, 1.0));
        mt_panels_begin(&walk, &h, lower, 10.0 * lower, 0.0);
        while (mt_panels_next(&walk, &p)) {
            double above = 0.0;
            for (int cut = 0; cut < CUTS && p.a < p.b; cut++) {
                check(t, &random, &g, &h, &p, &above);
                const double middle = 0.5 * (p.a + p.b);
                p = mt_random_int(&random, 2) == 0 ? (mt_panel){p.anchor, p.a, middle}
                                                   : (mt_panel){p.anchor, middle, p.b};
            }
            panels++;
            close += above < 0.01 ? 1 : 0;
        }
        mt_arena_rewind(&mem, mark);
    }
    mt_arena_free(&mem);
    mt_test_row(t, "all");
    CHECK(t, panels > SUMS);
    CHECK(t, 10 * close > 9 * panels);
}

/* Where the summands cancel to rounding, no halving proves more: the search ends, long before
 * it has looked at all intervals that it may, and what it says to have proven is true. */
static void search__ends_where_only_rounding_is_left(mt_test *t)
{
    static const double parts[] = {1.0, 0.3, -1.3};
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int damped = 0; damped < 2; damped++) {
        double complex pole[6];
        double complex residue[6];
        for (int i = 0; i < 3; i++) {
            const ptrdiff_t at = 2 * (ptrdiff_t)i;
            pole[at] = mt_frf_complex(-0.1 * damped, 9.0);
            pole[at + 1] = conj(pole[at]);
            residue[at] = mt_frf_complex(0.0, parts[i]);
            residue[at + 1] = conj(residue[at]);
        }
        const mt_pole_sum sum = {.n = 6, .s = pole, .residue = residue};
        mt_frf h;
        mt_test_row(t, "damped %d", damped);
        REQUIRE(t, mt_frf_init(&h, &sum, &mem, NULL) == MT_OK);
        search s = {.h = &h, .lower = 1.0, .upper = 8.0, .f = -1.0, .left = MOST_INTERVALS};
        find_first_maximum(&s);
        climb(&s);
        prove(&s);
        CHECK(t, s.left > MOST_INTERVALS / 20 * 19);
        CHECK(t, s.f >= 0.0 && s.f < 1e-29 && s.proven >= s.f && s.proven < 1e-26);
    }
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(bound__is_above_every_frequency_of_an_interval),
             MT_TEST(search__ends_where_only_rounding_is_left))
