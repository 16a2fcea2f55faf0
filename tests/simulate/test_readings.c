/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is read from records that are sums of known tones. */
#include <math.h>
#include <stdlib.h>

#include "simulate/reading.h"
#include "support/mt_test.h"

static const double PI = 3.14159265358979323846;
enum { SAMPLES = 400 };

static double decaying(double t, double hz, double zeta, double amplitude, double phase)
{
    const double w = 2.0 * PI * hz;
    return amplitude * exp(-zeta / sqrt(1.0 - (zeta * zeta)) * w * t) * cos((w * t) + phase);
}

static void simulate__tones_are_found_beside_each_other(mt_test *t)
{
    static const struct {
        const char *name;
        double hz[3];
        double zeta[3];
        double amplitude[3];
        double mean;
    } rows[] = {
        {"one, undamped", {5.0, 1.0, 1.0}, {0.0, 0.0, 0.0}, {1e-6, 0.0, 0.0}, 0.0},
        {"one about a mean", {5.0, 1.0, 1.0}, {0.02, 0.0, 0.0}, {1.0, 0.0, 0.0}, 3.0},
        {"three, one heavily damped",
         {5.0, 7.0, 31.0},
         {0.01, 0.3, 0.001},
         {1.0, 0.5, 0.02},
         0.2},
        {"a beat, half of it in the record",
         {5.0, 5.25, 1.0},
         {0.0, 0.0, 0.0},
         {1.0, 0.7, 0.0},
         0.0},
    };
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double x[2 * SAMPLES];
        const double dt = 0.005;
        mt_tones tones;
        mt_test_row(t, "%s", rows[k].name);
        for (int i = 0; i < SAMPLES; i++) {
            double *const at = x + ((ptrdiff_t)2 * i);
            at[0] = rows[k].mean;
            at[1] = nan("");
            for (int j = 0; j < 3; j++) {
                at[0] += decaying(dt * i, rows[k].hz[j], rows[k].zeta[j], rows[k].amplitude[j],
                                  0.3 + j);
            }
        }
        CHECK(t, mt_tones_read(SAMPLES, dt, x, 2, &mem, &tones, NULL) == MT_OK);
        CHECK(t, tones.residual < 1e-8);
        for (int j = 0; j < 3 && rows[k].amplitude[j] > 0.0; j++) {
            CHECK(t, tones.n > j);
            CHECK_NEAR(t, tones.tone[j].hz, rows[k].hz[j], 1e-9);
            CHECK_NEAR_ABS(t, tones.tone[j].damping, rows[k].zeta[j], 1e-9);
            CHECK_NEAR(t, tones.tone[j].amplitude, rows[k].amplitude[j], 1e-8);
            CHECK_NEAR_ABS(t, tones.tone[j].phase, remainder(0.3 + j, 2.0 * PI), 1e-7);
        }
    }
    mt_arena_free(&mem);
}

/* A pole that grows over the record, as one of rounding may, has powers beyond what a number
 * holds: they are told by their end. */
static void simulate__a_record_of_any_growth_is_read(mt_test *t)
{
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int growth = 1; growth <= 4; growth++) {
        double x[SAMPLES];
        mt_tones tones;
        mt_err err = {.text = ""};
        mt_test_row(t, "growth %d", growth);
        for (int i = 0; i < SAMPLES; i++) {
            x[i] = exp(growth * (i + 1.0 - SAMPLES)) * cos(0.4 * i);
        }
        CHECK_INT(t, mt_tones_read(SAMPLES, 0.005, x, 1, &mem, &tones, &err), MT_OK);
        CHECK(t, tones.residual < 1e-6);
        for (int k = 0; k < tones.n; k++) {
            CHECK(t, isfinite(tones.tone[k].hz) && isfinite(tones.tone[k].damping));
            CHECK(t, tones.tone[k].amplitude >= 0.0 && tones.tone[k].amplitude < 1e-100);
        }
    }
    mt_arena_free(&mem);
}

static void simulate__a_ring_down_is_read_from_its_turnings(mt_test *t)
{
    const double hz = 3.0;
    const double zeta = 0.04;
    mt_turning at[12];
    for (int i = 0; i < 12; i++) {
        /* cos(w t + phase) with the decay's own phase turns where its derivative is 0 */
        const double time = 0.1 + (0.5 * i / hz);
        const double d = PI * zeta / sqrt(1.0 - (zeta * zeta));
        at[i] = (mt_turning){.t = time,
                             .value = 7.0 + ((i % 2 == 0 ? 1.0 : -1.0) * exp(-d * i)),
                             .highest = i % 2 == 0};
    }
    mt_turnings turnings = {.at = at, .n = 12};
    const mt_ring r = mt_ring_read(&turnings);
    CHECK_INT(t, r.periods, 5);
    CHECK_NEAR(t, r.hz, hz, 1e-14);
    CHECK_NEAR(t, r.damping, zeta, 1e-13);
    CHECK(t, r.spread < 1e-14);
    turnings.n = 1;
    CHECK(t, isnan(mt_ring_read(&turnings).hz));
    CHECK(t, isnan(mt_ring_read(&turnings).damping));
}

static void simulate__steady_motion_is_read_with_its_harmonics(mt_test *t)
{
    double time[SAMPLES];
    double x[SAMPLES];
    mt_steady s;
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < SAMPLES; i++) {
        const double w = 2.0 * PI * 4.0;
        time[i] = 0.01 * i;
        x[i] = 0.5 + (2.0 * sin((w * time[i]) + 0.7)) + (0.1 * sin((3.0 * w * time[i]) - 2.0));
        x[i] += time[i] < 2.0 ? 100.0 : 0.0; /* not steady yet */
    }
    const mt_samples samples = {.n = SAMPLES, .stride = 1, .t = time, .x = x};
    CHECK(t, mt_steady_read(&samples, 4.0, 6, &mem, &s, NULL) == MT_OK);
    CHECK_INT(t, s.periods, 6);
    CHECK_NEAR(t, s.mean, 0.5, 1e-12);
    CHECK_NEAR(t, s.amplitude[0], 2.0, 1e-12);
    CHECK_NEAR(t, s.phase[0], 0.7, 1e-12);
    CHECK_NEAR(t, s.amplitude[2], 0.1, 1e-12);
    CHECK_NEAR(t, s.phase[2], -2.0, 1e-11);
    CHECK(t, s.amplitude[1] < 1e-12 && s.residual < 1e-12);
    CHECK(t, mt_steady_read(&samples, 0.1, 6, &mem, &s, NULL) == MT_OK);
    CHECK_INT(t, s.periods, 0);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(simulate__tones_are_found_beside_each_other),
             MT_TEST(simulate__a_record_of_any_growth_is_read),
             MT_TEST(simulate__a_ring_down_is_read_from_its_turnings),
             MT_TEST(simulate__steady_motion_is_read_with_its_harmonics))
