/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The largest response over a range of frequencies: closed forms, bounds that hold, edges. */
#include <float.h>
#include <stdlib.h>

#include "mt_random.h"
#include "mt_slope.h"
#include "mt_test.h"
#include "reference.h"
#include "vibration/sine.h"

static mt_sine_peak peak_of(mt_test *t, const mt_pole_sum *sum, double lower, double upper)
{
    mt_arena mem = {0};
    mt_frf h;
    mt_sine_peak p = {.value = nan("")};
    if (CHECK_INT(t, mt_frf_init(&h, sum, &mem, NULL), MT_OK)) {
        p = mt_sine_peak_find(&h, lower, upper);
    }
    mt_arena_free(&mem);
    return p;
}

static const double ZETAS[] = {0.7, 0.5, 0.1, 1e-2, 1e-3, 1e-5, 1e-7};

/* Displacement by a force: 1/(2 zeta sqrt(1 - zeta^2) w^2) at w sqrt(1 - 2 zeta^2). */
static void sine__receptance_of_one_mass(mt_test *t)
{
    const double w = 138.8;
    for (int i = 0; i < MT_COUNT(ZETAS); i++) {
        const double zeta = ZETAS[i];
        double complex s[2];
        double complex r[2];
        const mt_pole_sum h = ref_one_mass(w, zeta, REF_FORCE, s, r);
        const mt_sine_peak p = peak_of(t, &h, 1e-3, 1e6);
        mt_test_row(t, "zeta %g", zeta);
        CHECK_INT(t, p.end, MT_FORCED_FINITE);
        CHECK_NEAR(t, p.value, 1.0 / (2.0 * zeta * sqrt(1.0 - zeta * zeta) * w * w), 1e-14);
        CHECK_NEAR(t, p.omega, w * sqrt(1.0 - 2.0 * zeta * zeta), 1e-7);
        CHECK(t, p.excess >= 0.0 && p.excess <= 1e-10 && !p.at_edge);
    }
}

/* Absolute acceleration by that of the base. With x = (w / w_n)^2 the square of it is
 * (1 + a x)/((1 - x)^2 + a x), a = 4 zeta^2, and is largest where a x^2 + 2 x - 2 = 0. */
static void sine__transmissibility_of_one_mass(mt_test *t)
{
    const double w = 676.0;
    for (int i = 0; i < MT_COUNT(ZETAS); i++) {
        const double a = 4.0 * ZETAS[i] * ZETAS[i];
        const double x = 2.0 / (1.0 + sqrt(1.0 + 2.0 * a));
        const double less =
            2.0 * a / ((1.0 + sqrt(1.0 + 2.0 * a)) * (1.0 + sqrt(1.0 + 2.0 * a)));
        double complex s[2];
        double complex r[2];
        const mt_pole_sum h = ref_one_mass(w, ZETAS[i], REF_ABSOLUTE, s, r);
        const mt_sine_peak p = peak_of(t, &h, 1e-2, 1e5);
        mt_test_row(t, "zeta %g", ZETAS[i]);
        CHECK_NEAR(t, p.value, sqrt((1.0 + a * x) / (less * less + a * x)), 1e-13);
        CHECK_NEAR(t, p.omega, w * sqrt(x), 1e-7);
        CHECK(t, p.excess <= 1e-10);
    }
}

static void sine__range_beside_the_resonance_ends_at_its_edge(mt_test *t)
{
    static const struct {
        const char *name;
        double lower;
        double upper;
        double at;
    } rows[] = {
        {"below", 20.0, 90.0, 90.0},
        {"above", 120.0, 4000.0, 120.0},
        {"one frequency", 99.0, 99.0, 99.0},
        {"up to the flank", 1.0, 99.9, 99.9},
        {"as narrow as rounding", 120.0, 120.0 * (1.0 + DBL_EPSILON), 120.0},
    };
    double complex s[2];
    double complex r[2];
    const mt_pole_sum h = ref_one_mass(100.0, 1e-4, REF_FORCE, s, r);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double x = rows[i].at / 100.0;
        const double want = 1e-4 / hypot((1.0 - x) * (1.0 + x), 2.0 * 1e-4 * x);
        const mt_sine_peak p = peak_of(t, &h, rows[i].lower, rows[i].upper);
        mt_test_row(t, "%s", rows[i].name);
        CHECK_NEAR(t, p.value, want, 1e-12);
        CHECK(t, p.omega == rows[i].at);
        CHECK(t, p.at_edge == (rows[i].lower < rows[i].upper));
        CHECK(t, p.excess <= 1e-10);
    }
}

enum { MODES = 12 };

static mt_pole_sum any_sum(mt_random *rng, double complex *s, double complex *r)
{
    mt_pole_sum h = {.s = s, .residue = r};
    const int n = 1 + mt_random_int(rng, MODES);
    for (int i = 0; i < n; i++) {
        const double w = 10.0 * pow(200.0, mt_random_in(rng, 0.0, 1.0));
        const double zeta = pow(10.0, mt_random_in(rng, -4.0, -0.5));
        s[h.n] = w * (-zeta + (sqrt(1.0 - zeta * zeta) * REF_I));
        r[h.n] = mt_random_in(rng, -0.2, 0.2) + (mt_random_in(rng, -1.0, 1.0) * REF_I);
        s[h.n + 1] = conj(s[h.n]);
        r[h.n + 1] = conj(r[h.n]);
        h.n += 2;
    }
    h.d[0] = mt_random_in(rng, -1e-3, 1e-3);
    return h;
}

/* No sample is above the bound, those next to the resonances least of all, and the value is
 * that of a frequency. */
static void sine__no_sample_is_above_the_bound(mt_test *t)
{
    const int rounds = getenv("MT_EVERY") != NULL ? 1000 : 60;
    mt_random rng = mt_random_seed(4);
    for (int i = 0; i < rounds; i++) {
        double complex s[2 * MODES];
        double complex r[2 * MODES];
        const mt_pole_sum h = any_sum(&rng, s, r);
        const double lower = mt_random_in(&rng, 5.0, 500.0);
        const double upper = lower * pow(10.0, mt_random_in(&rng, 0.0, 1.0));
        const mt_sine_peak p = peak_of(t, &h, lower, upper);
        const double most = p.value * (1.0 + p.excess) * (1.0 + 1e-12);
        mt_test_row(t, "system %d", i);
        CHECK(t, p.excess <= 1e-10);
        CHECK(t, p.omega >= lower && p.omega <= upper);
        CHECK_NEAR(t, p.value, ref_size(&h, p.omega), 1e-10);
        double seen = 0.0;
        for (int k = 0; k <= 2000; k++) {
            const double w = lower + ((upper - lower) * k / 2000.0);
            seen = fmax(seen, ref_size(&h, w));
        }
        for (int k = 0; k < h.n; k++) {
            for (int q = -60; q <= 60; q++) {
                const double w = cimag(s[k]) + (creal(s[k]) * q / 20.0);
                if (w >= lower && w <= upper) {
                    seen = fmax(seen, ref_size(&h, w));
                }
            }
        }
        CHECK(t, seen <= most && seen >= 0.9 * p.value);
    }
}

static void sine__what_has_no_number_says_why(mt_test *t)
{
    const double complex r[] = {1.0, 1.0};
    const double complex s[] = {60.0 * REF_I, -60.0 * REF_I};
    const double complex growing[] = {1.0 + (60.0 * REF_I), 1.0 - (60.0 * REF_I)};
    const mt_pole_sum h = {.n = 2, .s = s, .residue = r};
    const mt_pole_sum grows = {.n = 2, .s = growing, .residue = r};
    CHECK_INT(t, peak_of(t, &h, 50.0, 70.0).end, MT_FORCED_INFINITE);
    CHECK(t, peak_of(t, &h, 50.0, 70.0).value != peak_of(t, &h, 50.0, 70.0).value);
    CHECK_INT(t, peak_of(t, &h, 61.0, 70.0).end, MT_FORCED_FINITE);
    CHECK_NEAR(t, peak_of(t, &h, 61.0, 70.0).value, 122.0 / 121.0, 1e-14);
    CHECK_INT(t, peak_of(t, &grows, 61.0, 70.0).end, MT_FORCED_UNSTABLE);
    CHECK_STR(t, mt_forced_end_name(MT_FORCED_UNSTABLE), "unstable");
    CHECK_STR(t, mt_forced_end_name(MT_FORCED_INFINITE), "infinite");
    CHECK_STR(t, mt_forced_end_name(MT_FORCED_FINITE), "finite");
}

static void sine__plain_responses(mt_test *t)
{
    const mt_pole_sum none = {.n = 0};
    const mt_pole_sum flat = {.n = 0, .d = {0.0, 0.0, 0.0}};
    mt_pole_sum line = {.n = 0, .d = {3.0, 0.5, 0.0}};
    CHECK(t, peak_of(t, &none, 1.0, 2.0).value == 0.0);
    CHECK(t, peak_of(t, &flat, 1.0, 2.0).excess == 0.0);
    CHECK_NEAR(t, peak_of(t, &line, 1.0, 8.0).value, 5.0, 1e-15);
    CHECK(t, peak_of(t, &line, 1.0, 8.0).at_edge);
    line.d[1] = 0.0;
    CHECK_NEAR(t, peak_of(t, &line, 1.0, 8.0).value, 3.0, 1e-15);
    line.d[2] = 1.0; /* |3 - w^2| */
    CHECK_NEAR(t, peak_of(t, &line, 0.5, 2.0).value, 2.75, 1e-14);
}

/* |H| is 1 everywhere, or almost: no frequency can be left out for being lower. */
static void sine__flat_responses_are_proven(mt_test *t)
{
    static const double widths[] = {30.0, 1.0, 1e-3, 1e-6};
    for (int i = 0; i < MT_COUNT(widths); i++) {
        /* (s^2 - 2 d s + w^2)/(s^2 + 2 d s + w^2) = 1 - 4 d s/(...) */
        const double complex a = -widths[i] + (100.0 * REF_I);
        const double complex s[] = {a, conj(a)};
        const double complex one = 4.0 * creal(a) * a / (a - conj(a));
        const double complex r[] = {one, conj(one)};
        const mt_pole_sum h = {.n = 2, .s = s, .residue = r, .d = {1.0}};
        const mt_sine_peak p = peak_of(t, &h, 1.0, 1e4);
        mt_test_row(t, "all-pass, %g", widths[i]);
        CHECK_NEAR(t, p.value, 1.0, 1e-13 + (DBL_EPSILON * 100.0 / widths[i]));
        CHECK(t, p.excess <= 1e-10);
    }
    const double complex s[] = {-1.0 + (100.0 * REF_I), -1.0 - (100.0 * REF_I)};
    const double complex r[] = {-1e-9 * REF_I, 1e-9 * REF_I};
    const mt_pole_sum h = {.n = 2, .s = s, .residue = r, .d = {1.0}};
    const mt_sine_peak p = peak_of(t, &h, 1.0, 1000.0);
    mt_test_row(t, "a ripple of 5e-10");
    CHECK_NEAR_ABS(t, p.value, 1.0 + 5e-10, 1e-11);
    CHECK(t, p.excess <= 1e-10);
    CHECK_NEAR(t, p.omega, 99.0, 1e-3); /* half its width below the pole */
}

/* The envelope theorem, through a peak that moves. */
static double peak_by(const void *ctx, int n, const double *x)
{
    double complex s[2];
    double complex r[2];
    mt_arena mem = {0};
    mt_frf h;
    (void)ctx;
    (void)n;
    const mt_pole_sum sum = ref_one_mass(x[0], x[1], REF_ABSOLUTE, s, r);
    const double value = mt_frf_init(&h, &sum, &mem, NULL) == MT_OK
                             ? mt_sine_peak_find(&h, 80.0, 120.0).value
                             : nan("");
    mt_arena_free(&mem);
    return value;
}

static void sine__slope_is_that_at_a_fixed_frequency(mt_test *t)
{
    static const double at[][2] = {{100.0, 0.05}, {100.0, 1e-3}, {70.0, 0.02}, {140.0, 0.3}};
    for (int i = 0; i < MT_COUNT(at); i++) {
        double x[] = {at[i][0], at[i][1]};
        double complex s[2];
        double complex r[2];
        const mt_pole_sum h = ref_one_mass(x[0], x[1], REF_ABSOLUTE, s, r);
        const mt_sine_peak p = peak_of(t, &h, 80.0, 120.0);
        /* H = (w^2 + 2 zeta w i o)/(w^2 - o^2 + 2 zeta w i o) */
        const double complex io = p.omega * REF_I;
        const double complex up = x[0] * x[0] + 2.0 * x[1] * x[0] * io;
        const double complex down = up + io * io;
        const double complex by[] = {(2.0 * x[0] + 2.0 * x[1] * io) * (1.0 - up / down) / down,
                                     2.0 * x[0] * io * (1.0 - up / down) / down};
        for (int k = 0; k < 2; k++) {
            mt_test_row(t, "case %d, unknown %d", i, k);
            CHECK(t, mt_slope_agrees(peak_by, NULL, 2, x, k, creal(p.direction * by[k]),
                                     0.02 * x[1] * (k == 0 ? x[0] : 1.0), 1e-14));
        }
    }
}

MT_TEST_MAIN(MT_TEST(sine__receptance_of_one_mass), MT_TEST(sine__transmissibility_of_one_mass),
             MT_TEST(sine__range_beside_the_resonance_ends_at_its_edge),
             MT_TEST(sine__no_sample_is_above_the_bound),
             MT_TEST(sine__what_has_no_number_says_why), MT_TEST(sine__plain_responses),
             MT_TEST(sine__flat_responses_are_proven),
             MT_TEST(sine__slope_is_that_at_a_fixed_frequency))
