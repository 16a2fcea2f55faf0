/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A whole profile on one response: parts, tones and rules put together, and their slopes. */
#include <stdio.h>

#include "mt_slope.h"
#include "mt_test.h"
#include "reference.h"
#include "vibration/profile_response.h"

static double hz_a[] = {5.0, 80.0, 500.0};
static double level_a[] = {1e-2, 4.0, 1e-1};
static double hz_b[] = {12.0, 14.0};
static double level_b[] = {20.0, 20.0};
static mt_vibration_random PARTS[] = {{.psd = {.n = 3, .hz = hz_a, .level = level_a}},
                                      {.psd = {.n = 2, .hz = hz_b, .level = level_b}}};
static mt_vibration_tone TONES[] = {
    {.label = "a", .lower_hz = 4.0, .upper_hz = 5.0, .level = 2.0},
    {.label = "b", .lower_hz = 16.0, .upper_hz = 19.0, .level = 9.0},
    {.label = "c", .lower_hz = 34.4, .upper_hz = 34.4, .level = 7.0}};

static mt_vibration profile_of(int parts, int tones, double sigma, mt_vibration_sum rule)
{
    return (mt_vibration){.n_random = parts,
                          .random = PARTS,
                          .n_tones = tones,
                          .tones = TONES,
                          .sigma = sigma,
                          .rule = rule};
}

static void respond__adds_parts_and_tones_by_the_rule(mt_test *t)
{
    static const mt_vibration_sum rules[] = {MT_TONES_SUM, MT_TONES_LARGEST, MT_TONES_ROOT};
    double complex s[2];
    double complex r[2];
    const mt_pole_sum h = mt_vibration_respond_one_mass(17.5, 0.03, s, r);
    const double square = (double)(ref_mean_square(&h, &PARTS[0].psd, true) +
                                   ref_mean_square(&h, &PARTS[1].psd, true));
    for (int i = 0; i < MT_COUNT(rules); i++) {
        const mt_vibration v = profile_of(2, 3, 2.5, rules[i]);
        mt_arena mem = {0};
        mt_vibration_response a;
        mt_test_row(t, "%s", mt_vibration_sum_names[i]);
        if (!CHECK_INT(t, mt_vibration_respond(&v, &h, &mem, &a, NULL), MT_OK)) {
            continue;
        }
        double peak[3];
        for (int k = 0; k < 3; k++) {
            peak[k] = mt_vibration_respond_tone(&v, &a, k);
            CHECK_NEAR(t, peak[k], TONES[k].level * ref_size(&h, a.tones[k].omega), 1e-13);
        }
        const double sines[] = {
            peak[0] + peak[1] + peak[2], fmax(peak[0], fmax(peak[1], peak[2])),
            sqrt((peak[0] * peak[0]) + (peak[1] * peak[1]) + (peak[2] * peak[2]))};
        CHECK_NEAR(t, a.rms, sqrt(square), 1e-12);
        CHECK(t, fabs(a.rms - sqrt(square)) <= a.rms_bound + (1e-15 * a.rms));
        CHECK_NEAR(t, a.sine, sines[i], 1e-15);
        CHECK_NEAR(t, a.peak, (2.5 * a.rms) + a.sine, 1e-15);
        CHECK(t, !a.tones[1].at_edge && a.tones[0].at_edge && !a.tones[2].at_edge);
        mt_arena_free(&mem);
    }
}

static void respond__densities_of_parts_add_up(mt_test *t)
{
    double complex s[2];
    double complex r[2];
    mt_arena mem = {0};
    mt_spectral of;
    const mt_vibration v = profile_of(2, 0, 3.0, MT_TONES_SUM);
    const mt_pole_sum h = mt_vibration_respond_one_mass(17.5, 0.03, s, r);
    REQUIRE(t, mt_spectral_init(&of, &h, &mem, NULL) == MT_OK);
    const double size = ref_size(&h, 2.0 * (double)REF_PI * 13.0);
    const double a = 1e-2 * pow(13.0 / 5.0, log(400.0) / log(16.0));
    CHECK_NEAR(t, mt_vibration_respond_psd(&v, &of, 13.0), size * size * (a + 20.0), 1e-13);
    CHECK(t, mt_vibration_respond_psd(&v, &of, 501.0) == 0.0);
    mt_arena_free(&mem);
}

/* Random parts or tones alone, and neither. */
static void respond__of_what_there_is(mt_test *t)
{
    double complex s[2];
    double complex r[2];
    const mt_pole_sum h = mt_vibration_respond_one_mass(17.5, 0.03, s, r);
    for (int parts = 0; parts <= 2; parts += 2) {
        for (int tones = 0; tones <= 3; tones += 3) {
            const mt_vibration v = profile_of(parts, tones, 3.0, MT_TONES_LARGEST);
            mt_arena mem = {0};
            mt_vibration_response a;
            mt_test_row(t, "%d parts, %d tones", parts, tones);
            CHECK_INT(t, mt_vibration_respond(&v, &h, &mem, &a, NULL), MT_OK);
            CHECK(t, (a.rms > 0.0) == (parts > 0));
            CHECK(t, (a.sine > 0.0) == (tones > 0));
            CHECK(t, a.end == MT_FORCED_FINITE && a.pole == -1);
            mt_arena_free(&mem);
        }
    }
}

/* An undamped pole takes away what acts on it, and no more. */
static void respond__infinite_is_said(mt_test *t)
{
    static const struct {
        const char *name;
        double hz;
        bool random;
        bool tones;
    } rows[] = {
        {"within the random part", 100.0, false, true},
        {"within a tone's range", 4.5, true, false},
        {"within both", 17.0, false, false},
        {"beyond all", 900.0, true, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double w = 2.0 * (double)REF_PI * rows[i].hz;
        const double complex s[] = {w * REF_I, -w * REF_I};
        const double complex r[] = {-0.5 * w * REF_I, 0.5 * w * REF_I};
        const mt_pole_sum h = {.n = 2, .s = s, .residue = r};
        const mt_vibration v = profile_of(2, 3, 3.0, MT_TONES_SUM);
        mt_arena mem = {0};
        mt_vibration_response a;
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_vibration_respond(&v, &h, &mem, &a, NULL), MT_OK);
        CHECK(t, (a.rms == a.rms) == rows[i].random);
        CHECK(t, (a.sine == a.sine) == rows[i].tones);
        CHECK_INT(t, a.end,
                  rows[i].random && rows[i].tones ? MT_FORCED_FINITE : MT_FORCED_INFINITE);
        CHECK_INT(t, a.pole, a.end == MT_FORCED_FINITE ? -1 : 0);
        mt_arena_free(&mem);
    }
}

typedef struct case_of {
    mt_vibration_sum rule;
} case_of;

static double peak_by(const void *ctx, int n, const double *x)
{
    const case_of *const c = ctx;
    const mt_vibration v = profile_of(2, 3, 2.5, c->rule);
    double complex s[2];
    double complex r[2];
    mt_arena mem = {0};
    mt_vibration_response a;
    (void)n;
    const mt_pole_sum h = mt_vibration_respond_one_mass(x[0], x[1], s, r);
    const double peak =
        mt_vibration_respond(&v, &h, &mem, &a, NULL) == MT_OK ? a.peak : nan("");
    mt_arena_free(&mem);
    return peak;
}

static void respond__slopes_of_the_combined_peak(mt_test *t)
{
    static const mt_vibration_sum rules[] = {MT_TONES_SUM, MT_TONES_LARGEST, MT_TONES_ROOT};
    for (int i = 0; i < MT_COUNT(rules); i++) {
        const case_of c = {rules[i]};
        const mt_vibration v = profile_of(2, 3, 2.5, rules[i]);
        double x[] = {17.3, 0.04};
        double complex s[2];
        double complex r[2];
        double complex by_s[2];
        double complex by_r[2];
        double complex by_d[3];
        mt_arena mem = {0};
        mt_vibration_response a;
        const mt_pole_sum h = mt_vibration_respond_one_mass(x[0], x[1], s, r);
        REQUIRE(t, mt_vibration_respond(&v, &h, &mem, &a, NULL) == MT_OK);
        REQUIRE(t,
                mt_vibration_respond_slopes(&v, &h, &a, &mem, by_s, by_r, by_d, NULL) == MT_OK);
        /* s = w (-z + i q), q = sqrt(1 - z^2); r = (w^2 + 2 z w s)/(2 i w q) = w g(z) */
        const double w = 2.0 * (double)REF_PI * x[0];
        const double q = sqrt(1.0 - (x[1] * x[1]));
        const double complex unit = s[0] / w;
        const double complex du = -1.0 - (x[1] / q * REF_I);
        const double complex up = 1.0 + (2.0 * x[1] * unit);
        const double complex dg =
            ((2.0 * unit) + (2.0 * x[1] * du) + (up * x[1] / (q * q))) / (2.0 * q * REF_I);
        const double complex ds[] = {s[0] / x[0], w * du};
        const double complex dr[] = {r[0] / x[0], w * dg};
        for (int k = 0; k < 2; k++) {
            mt_test_row(t, "%s, unknown %d", mt_vibration_sum_names[i], k);
            const double by = creal((by_s[0] * ds[k]) + (by_s[1] * conj(ds[k])) +
                                    (by_r[0] * dr[k]) + (by_r[1] * conj(dr[k])));
            CHECK(t, mt_slope_agrees(peak_by, &c, 2, x, k, by, k == 0 ? 0.02 : 1e-3, 1e-13));
        }
        mt_arena_free(&mem);
    }
}

MT_TEST_MAIN(MT_TEST(respond__adds_parts_and_tones_by_the_rule),
             MT_TEST(respond__densities_of_parts_add_up), MT_TEST(respond__of_what_there_is),
             MT_TEST(respond__infinite_is_said), MT_TEST(respond__slopes_of_the_combined_peak))
