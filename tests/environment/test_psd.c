/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Densities of straight lines in log-log scales: integrals in closed form, slopes, steps. */
#include <math.h>

#include "base/base.h"
#include "environment/vibration.h"
#include "mt_test.h"

static void psd__overall_rms_agrees_with_what_documents_print(mt_test *t)
{
    static const struct {
        const char *name;
        int n;
        double hz[8];
        double level[8];
        double rms;
        double digit; /* half of the last one printed */
    } rows[] = {
        {"GEVS, qualification", 4, {20, 50, 800, 2000}, {0.026, 0.16, 0.16, 0.026}, 14.1, 0.05},
        {"minimum integrity", 3, {20, 1000, 2000}, {0.04, 0.04, 0.01}, 7.7, 0.05},
        {"truck, vertical", 3, {10, 40, 500}, {0.015, 0.015, 0.00015}, 1.04, 0.005},
        {"truck, transverse",
         7,
         {10, 20, 30, 78, 79, 120, 500},
         {0.00013, 0.00065, 0.00065, 0.00002, 0.00019, 0.00019, 0.00001},
         0.204,
         0.0005},
        {"truck, longitudinal",
         8,
         {10, 20, 120, 121, 200, 240, 340, 500},
         {0.0065, 0.0065, 0.0002, 0.003, 0.003, 0.0015, 0.00003, 0.00015},
         0.740,
         0.0005},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        double hz[8];
        double level[8];
        for (int k = 0; k < 8; k++) {
            hz[k] = rows[i].hz[k];
            level[k] = rows[i].level[k];
        }
        const mt_psd g = {.n = rows[i].n, .hz = hz, .level = level};
        mt_test_row(t, "%s", rows[i].name);
        CHECK_NEAR_ABS(t, sqrt(mt_psd_mean_square(&g)), rows[i].rms, rows[i].digit);
    }
}

/* From 2 to 6 Hz, 3 at 2 Hz; the integral of 3 (f/2)^b. */
static void psd__segments_have_their_closed_forms(mt_test *t)
{
    static const double exponents[] = {0.0,  1.0,  -1.0,        2.0,   -2.0,  0.5,
                                       -3.0, 40.0, -1.0 + 1e-9, 300.0, -300.0};
    for (int i = 0; i < MT_COUNT(exponents); i++) {
        const double b = exponents[i];
        double hz[] = {2.0, 6.0};
        double level[] = {3.0, 3.0 * pow(3.0, b)};
        const mt_psd g = {.n = 2, .hz = hz, .level = level};
        const long double e = (long double)b + 1.0L;
        const double want =
            (double)(e == 0.0L ? 6.0L * logl(3.0L) : 6.0L * (expm1l(e * logl(3.0L)) / e));
        mt_test_row(t, "exponent %g", b);
        CHECK_NEAR(t, mt_psd_exponent(&g, 0), b, 1e-14 + (b != 0.0 ? 1e-15 / fabs(b) : 0.0));
        CHECK_NEAR(t, mt_psd_mean_square(&g), want, 1e-15 * (8.0 + fabs(b)));
        CHECK_NEAR(t, mt_psd_at(&g, 3.0), 3.0 * pow(1.5, b), 1e-15 * (8.0 + fabs(b)));
        CHECK_NEAR(t, mt_psd_slope_db(&g, 0), 10.0 * log10(pow(2.0, b)), 1e-14);
    }
}

static void psd__steps_and_ends(mt_test *t)
{
    double hz[] = {1.0, 2.0, 2.0, 4.0};
    double level[] = {1.0, 1.0, 5.0, 5.0};
    const mt_psd g = {.n = 4, .hz = hz, .level = level};
    CHECK(t, mt_psd_at(&g, 0.999) == 0.0 && mt_psd_at(&g, 4.001) == 0.0);
    CHECK(t, mt_psd_at(&g, 1.0) == 1.0 && mt_psd_at(&g, 4.0) == 5.0);
    CHECK(t, mt_psd_at(&g, 2.0) == 5.0);
    CHECK(t, mt_psd_at(&g, 1.999) == 1.0 && mt_psd_at(&g, 2.001) == 5.0);
    CHECK(t, mt_psd_exponent(&g, 1) == 0.0);
    CHECK_NEAR(t, mt_psd_mean_square(&g), 11.0, 1e-15);
}

static void psd__logarithms_of_close_numbers(mt_test *t)
{
    static const double steps[] = {1e-15, 1e-12, 1e-6, 0.3, 0.99, 1.5, 1e6};
    for (int i = 0; i < MT_COUNT(steps); i++) {
        const double b = 7.0 * (1.0 + steps[i]);
        mt_test_row(t, "%g", steps[i]);
        CHECK_NEAR(t, mt_psd_log_ratio(7.0, b), (double)log1pl(((long double)b - 7.0L) / 7.0L),
                   4e-16);
        CHECK_NEAR(t, mt_psd_log_ratio(b, 7.0), -(double)log1pl(((long double)b - 7.0L) / 7.0L),
                   4e-16);
    }
}

MT_TEST_MAIN(MT_TEST(psd__overall_rms_agrees_with_what_documents_print),
             MT_TEST(psd__segments_have_their_closed_forms), MT_TEST(psd__steps_and_ends),
             MT_TEST(psd__logarithms_of_close_numbers))
