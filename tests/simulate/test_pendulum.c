/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Swings of any amplitude. A pendulum released at theta0 has the period
 *     T = 4 sqrt(J/(m g s)) K(sin(theta0/2)),   K(k) = pi/(2 AGM(1, sqrt(1 - k^2))),
 * J about the pivot, s from it to the centre (a point mass on a string: J/(m s) = L).
 */
#include "simulate/motions.h"

static const double G = 9.81;

/* 4 K(sin(theta0/2)) = 2 pi/AGM(1, cos(theta0/2)). */
static double quarter_periods(double theta0)
{
    double a = 1.0;
    double b = cos(0.5 * theta0);
    for (int i = 0; i < 12; i++) {
        const double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    return 2.0 * MECH_PI / a;
}

static const char STRING[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"string\", \"dimension\": 2,"
    " \"gravity_m_per_s2\": [0, -9.81],"
    " \"points\": {\"top\": [0, 0], \"bob\": [0, -0.7]},"
    " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 2, \"inertia_kg_m2\": 0, \"centre\": "
    "\"bob\"}],"
    " \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"bob\"], \"at\": \"top\"}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"bob\"}],"
    " \"configurations\": {\"c\": {}}}";
static const char ROD[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"rod\", \"dimension\": 3,"
    " \"gravity_m_per_s2\": [0, 0, -9.81],"
    " \"points\": {\"top\": [0.1, 0.2, 0.3], \"centre\": [0.1, 0.2, 0]},"
    " \"bodies\": [{\"name\": \"rod\", \"mass_kg\": 1.5, \"inertia_kg_m2\": [0.05, 0.04, 0.03],"
    " \"centre\": \"centre\"}],"
    " \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"rod\"], \"at\": \"top\", \"axis\": [3, 4, 0]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"rod\"}],"
    " \"configurations\": {\"c\": {}}}";

static void periods(mt_test *t, const char *text, double factor)
{
    static const double degrees[] = {1e-3, 1.0, 30.0, 90.0, 150.0, 170.0, 179.0};
    for (int i = 0; i < MT_COUNT(degrees); i++) {
        const double theta0 = degrees[i] * MECH_PI / 180.0;
        const double period = factor * quarter_periods(theta0);
        motion m;
        mt_test_row(t, "%g degrees", degrees[i]);
        if (motion_open(t, mech_parse(t, text), NULL, &m)) {
            motion_watch(t, &m, "pivot");
            m.opt.turning = true;
            if (motion_put(t, &m, "pivot", theta0) &&
                motion_run(t, &m, 10.5 * period, 0.1 * period)) {
                const mt_ring ring = mt_ring_read(&m.r.turnings[0]);
                CHECK_INT(t, ring.periods, 9);
                CHECK_NEAR(t, ring.hz * period, 1.0, 1e-8);
                CHECK_NEAR(t, ring.amplitude / theta0, 1.0, 1e-9);
                CHECK(t, ring.spread < 1e-8);
                CHECK(t, fabs(ring.damping) < 1e-10);
                /* eps of the model's length lifts the weight */
                CHECK(t, m.r.energy_error_j <= (1e-9 * m.r.energy_scale_j) + 1e-14);
                CHECK(t, m.r.gap_m < 1e-10);
                CHECK(t, m.r.left_m < 1e-14);
                motion_tell(&m);
            }
        }
        motion_free(&m);
    }
}

static void simulate__pendulum_has_the_periods_of_the_elliptic_integral(mt_test *t)
{
    periods(t, STRING, sqrt(0.7 / G));
}

static void simulate__physical_pendulum_in_space_too(mt_test *t)
{
    /* about the axis (0.6, 0.8, 0) */
    const double j = (0.36 * 0.05) + (0.64 * 0.04) + (1.5 * 0.09);
    periods(t, ROD, sqrt(j / (1.5 * G * 0.3)));
}

MT_TEST_MAIN(MT_TEST(simulate__pendulum_has_the_periods_of_the_elliptic_integral),
             MT_TEST(simulate__physical_pendulum_in_space_too))
