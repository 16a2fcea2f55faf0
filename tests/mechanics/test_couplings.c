/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Joints that keep one coordinate, or couple two, against closed forms:
 *   bead on a plane inclined by a, hung on a cord of length l in it
 *       omega^2 = g sin a / l
 *   bead on a plane of normal n, springs k_x k_y k_z to the ground
 *       the two eigenvalues of P diag(k) P / m with P = I - n n^T
 *   two bodies that turn together
 *       omega^2 = (k_1 + k_2)/(J_1 + J_2), translations apart
 *   two shafts, angle of the second N times the first
 *       omega^2 = (k_1 + N^2 k_2)/(J_1 + N^2 J_2)
 *   planet of ratio N on an arm of length l around a sun that does not turn
 *       omega^2 = k/(J_arm + m l^2 + J_planet (1 - N)^2)
 *   rack of mass m on a pinion of pitch radius r
 *       omega^2 = (k + c r^2)/(J + m r^2)
 */
#include "mechanics/mech.h"

#define HEAD(dimension, parameters)                                 \
    "{\"format\": \"modetune-model/1\", \"dimension\": " #dimension \
    ", \"parameters\": {" parameters "},"

/* A few freedoms each: only rounding, and what equilibrium leaves. */
static const double TOL = 1e-11;

static void plane__a_bead_on_an_incline_is_a_pendulum_in_it(mt_test *t)
{
    static const char model[] = HEAD(
        3, "\"a\": 0.4, \"l\": 0.7") " \"gravity_m_per_s2\": [0, 0, -9.81],"
                                     " \"points\": {\"top\": [0, 0, 0], \"bead\": "
                                     "[\"l*cos(a)\", 0, \"-l*sin(a)\"]},"
                                     " \"bodies\": [{\"name\": \"bead\", \"mass_kg\": 2, "
                                     "\"centre\": \"bead\"}],"
                                     " \"joints\": ["
                                     "  {\"name\": \"incline\", \"type\": \"point-on-plane\", "
                                     "\"bodies\": [\"ground\", \"bead\"], "
                                     "\"at\": [\"top\", \"bead\"], \"axis\": [\"sin(a)\", 0, "
                                     "\"cos(a)\"]},"
                                     "  {\"name\": \"cord\", \"type\": \"distance\", "
                                     "\"bodies\": [\"ground\", \"bead\"], "
                                     "\"at\": [\"top\", \"bead\"]}]}";
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        const double hz = sqrt(9.81 * sin(0.4) / 0.7) / (2.0 * MECH_PI);
        mech_expect(t, &s, 1, &hz, 0, TOL);
    }
    mech_free(&s);
}

/* Normal (2, -1, 2)/3, springs 900, 400, 100: P K P has trace 1400 - n.Kn and second invariant
 * sum k_i k_j n_k^2. */
static void plane__takes_the_direction_along_its_normal(mt_test *t)
{
    static const char model[] =
        HEAD(3, "\"m\": 2") " \"bodies\": [{\"name\": \"bead\", \"mass_kg\": \"m\", "
                            "\"centre\": [0.1, 0.2, 0.3]}],"
                            " \"joints\": [{\"name\": \"plane\", \"type\": \"point-on-plane\", "
                            "\"bodies\": [\"ground\", "
                            "\"bead\"], \"at\": [0.1, 0.2, 0.3], \"axis\": [2, -1, 2]}],"
                            " \"springs\": ["
                            "  {\"name\": \"x\", \"type\": \"axial\", \"bodies\": [\"ground\", "
                            "\"bead\"], \"at\": "
                            "[[0, 0.2, 0.3], [0.1, 0.2, 0.3]], \"stiffness_n_per_m\": 900},"
                            "  {\"name\": \"y\", \"type\": \"axial\", \"bodies\": [\"ground\", "
                            "\"bead\"], \"at\": "
                            "[[0.1, 0, 0.3], [0.1, 0.2, 0.3]], \"stiffness_n_per_m\": 400},"
                            "  {\"name\": \"z\", \"type\": \"axial\", \"bodies\": [\"ground\", "
                            "\"bead\"], \"at\": "
                            "[[0.1, 0.2, 0], [0.1, 0.2, 0.3]], \"stiffness_n_per_m\": 100}]}";
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        const double trace = 1400.0 - ((900.0 * 4.0) + 400.0 + (100.0 * 4.0)) / 9.0;
        const double product =
            ((900.0 * 400.0 * 4.0) + (900.0 * 100.0) + (400.0 * 100.0 * 4.0)) / 9.0;
        const double root = sqrt((0.25 * trace * trace) - product);
        const double hz[2] = {sqrt((0.5 * trace - root) / 2.0) / (2.0 * MECH_PI),
                              sqrt((0.5 * trace + root) / 2.0) / (2.0 * MECH_PI)};
        mech_expect(t, &s, 2, hz, 0, TOL);
    }
    mech_free(&s);
}

static void orientation__bodies_turn_together_and_move_apart(mt_test *t)
{
    static const char space[] =
        HEAD(3, "\"k\": 8") " \"bodies\": ["
                            "  {\"name\": \"a\", \"mass_kg\": 2, \"inertia_kg_m2\": [0.01, "
                            "0.02, 0.03], \"centre\": [0, 0, 0]},"
                            "  {\"name\": \"b\", \"mass_kg\": 3, \"inertia_kg_m2\": [0.04, "
                            "0.05, 0.01], \"centre\": [1, 0, 0]}],"
                            " \"joints\": [{\"name\": \"level\", \"type\": \"orientation\", "
                            "\"bodies\": [\"a\", \"b\"]}],"
                            " \"springs\": ["
                            "  {\"name\": \"ka\", \"type\": \"bushing\", \"bodies\": "
                            "[\"ground\", \"a\"], \"at\": [0, 0, 0],"
                            "   \"stiffness_n_per_m\": [200, 300, 500], "
                            "\"stiffness_n_m_per_rad\": [\"k\", \"k\", \"k\"]},"
                            "  {\"name\": \"kb\", \"type\": \"bushing\", \"bodies\": "
                            "[\"ground\", \"b\"], \"at\": [1, 0, 0],"
                            "   \"stiffness_n_per_m\": [700, 1100, 1300], "
                            "\"stiffness_n_m_per_rad\": [1, 2, 40]}]}";
    static const double lambda[] = {200.0 / 2.0,  300.0 / 2.0,  9.0 / 0.05,
                                    700.0 / 3.0,  10.0 / 0.07,  500.0 / 2.0,
                                    1100.0 / 3.0, 1300.0 / 3.0, 48.0 / 0.04};
    static const int order[] = {0, 4, 1, 2, 3, 5, 6, 7, 8};
    double hz[MT_COUNT(lambda)];
    mech s;
    for (int i = 0; i < MT_COUNT(lambda); i++) {
        hz[i] = sqrt(lambda[order[i]]) / (2.0 * MECH_PI);
    }
    if (mech_must(t, mech_parse(t, space), NULL, "", &s)) {
        mech_expect(t, &s, MT_COUNT(lambda), hz, 0, TOL);
    }
    mech_free(&s);
    static const char plane[] =
        HEAD(2, "\"k\": 8") " \"bodies\": [{\"name\": \"a\", \"mass_kg\": 2, "
                            "\"inertia_kg_m2\": 0.01, \"centre\": [0, 0]}],"
                            " \"joints\": [{\"name\": \"level\", \"type\": \"orientation\", "
                            "\"bodies\": [\"ground\", \"a\"]}],"
                            " \"springs\": [{\"name\": \"ka\", \"type\": \"bushing\", "
                            "\"bodies\": [\"ground\", \"a\"], "
                            "\"at\": [0.3, 0.1], \"stiffness_n_per_m\": [200, 300], "
                            "\"stiffness_n_m_per_rad\": \"k\"}]}";
    if (mech_must(t, mech_parse(t, plane), NULL, "", &s)) {
        mech_expect(t, &s, 2, (const double[2]){hz[0], hz[2]}, 0, TOL);
    }
    mech_free(&s);
}

static const char CHAIN[] = HEAD(
    2, "\"N\": -3, \"to\": 0.5") " \"bodies\": ["
                                 "  {\"name\": \"first\", \"mass_kg\": 1, \"inertia_kg_m2\": "
                                 "0.02, \"centre\": [0, 0]},"
                                 "  {\"name\": \"second\", \"mass_kg\": 1, \"inertia_kg_m2\": "
                                 "0.003, \"centre\": [0.2, 0]}],"
                                 " \"joints\": ["
                                 "  {\"name\": \"s1\", \"type\": \"revolute\", \"bodies\": "
                                 "[\"ground\", \"first\"], \"at\": [0, 0]},"
                                 "  {\"name\": \"s2\", \"type\": \"revolute\", \"bodies\": "
                                 "[\"ground\", \"second\"], \"at\": [0.2, 0]},"
                                 "  {\"name\": \"mesh\", \"type\": \"gear\", \"joints\": "
                                 "[\"s1\", \"s2\"], \"ratio\": \"N\"}],"
                                 " \"springs\": ["
                                 "  {\"name\": \"k1\", \"type\": \"torsion\", \"joint\": "
                                 "\"s1\", \"stiffness_n_m_per_rad\": 50},"
                                 "  {\"name\": \"k2\", \"type\": \"torsion\", \"bodies\": "
                                 "[\"ground\", \"second\"], "
                                 "\"stiffness_n_m_per_rad\": 7}],"
                                 " \"configurations\": {\"still\": {}, \"turned\": {\"drive\": "
                                 "{\"joint\": \"s1\", "
                                 "\"position_rad\": \"to\", \"hold\": {\"trim\": \"k1\"}}},"
                                 "  \"around\": {\"like\": \"turned\", \"parameters\": "
                                 "{\"to\": -3}}}}";

static void gear__in_the_plane_reduces_inertia_and_stiffness(mt_test *t)
{
    static const char *const names[] = {"still", "turned", "around"};
    const double hz = sqrt((50.0 + (9.0 * 7.0)) / (0.02 + (9.0 * 0.003))) / (2.0 * MECH_PI);
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_parse(t, CHAIN), names[i], "", &s)) {
            mech_expect(t, &s, 1, &hz, 0, TOL);
        }
        mech_free(&s);
    }
}

static void gear__a_planet_rolls_around_a_sun_that_does_not_turn(mt_test *t)
{
    static const char model[] = HEAD(
        2, "\"N\": -2.5, \"l\": 0.2") " \"bodies\": ["
                                      "  {\"name\": \"arm\", \"mass_kg\": 1, "
                                      "\"inertia_kg_m2\": 0.01, \"centre\": [0, 0]},"
                                      "  {\"name\": \"sun\", \"mass_kg\": 1, "
                                      "\"inertia_kg_m2\": 0.1, \"centre\": [0, 0]},"
                                      "  {\"name\": \"planet\", \"mass_kg\": 0.6, "
                                      "\"inertia_kg_m2\": 0.002, \"centre\": [\"l\", 0]}],"
                                      " \"joints\": ["
                                      "  {\"name\": \"pivot\", \"type\": \"revolute\", "
                                      "\"bodies\": [\"ground\", \"arm\"], \"at\": [0, 0]},"
                                      "  {\"name\": \"hub\", \"type\": \"revolute\", "
                                      "\"bodies\": [\"arm\", \"sun\"], \"at\": [0, 0]},"
                                      "  {\"name\": \"axle\", \"type\": \"revolute\", "
                                      "\"bodies\": [\"arm\", \"planet\"], \"at\": [\"l\", 0]},"
                                      "  {\"name\": \"mesh\", \"type\": \"gear\", \"joints\": "
                                      "[\"hub\", \"axle\"], \"ratio\": \"N\"},"
                                      "  {\"name\": \"held\", \"type\": \"orientation\", "
                                      "\"bodies\": [\"ground\", \"sun\"]}],"
                                      " \"springs\": [{\"name\": \"k\", \"type\": \"torsion\", "
                                      "\"joint\": \"pivot\", "
                                      "\"stiffness_n_m_per_rad\": 30}]}";
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        const double inertia = 0.01 + (0.6 * 0.04) + (0.002 * 3.5 * 3.5);
        const double hz = sqrt(30.0 / inertia) / (2.0 * MECH_PI);
        mech_expect(t, &s, 1, &hz, 0, TOL);
    }
    mech_free(&s);
}

static const char RACK[] = HEAD(
    2,
    "\"r\": -0.025, \"to\": 0.04") " \"bodies\": ["
                                   "  {\"name\": \"pinion\", \"mass_kg\": 1, "
                                   "\"inertia_kg_m2\": 0.0004, \"centre\": [0, 0]},"
                                   "  {\"name\": \"rack\", \"mass_kg\": 0.9, "
                                   "\"inertia_kg_m2\": 0.001, \"centre\": [0.1, 0.025]}],"
                                   " \"joints\": ["
                                   "  {\"name\": \"shaft\", \"type\": \"revolute\", "
                                   "\"bodies\": [\"ground\", \"pinion\"], \"at\": [0, 0]},"
                                   "  {\"name\": \"guide\", \"type\": \"prismatic\", "
                                   "\"bodies\": [\"ground\", \"rack\"], "
                                   "\"at\": [0, 0.025], \"axis\": [3, 1]},"
                                   "  {\"name\": \"teeth\", \"type\": \"rack\", \"joints\": "
                                   "[\"shaft\", \"guide\"], "
                                   "\"ratio_m_per_rad\": \"r\"}],"
                                   " \"springs\": ["
                                   "  {\"name\": \"coil\", \"type\": \"torsion\", \"joint\": "
                                   "\"shaft\", \"stiffness_n_m_per_rad\": 5},"
                                   "  {\"name\": \"push\", \"type\": \"bushing\", \"bodies\": "
                                   "[\"ground\", \"rack\"], "
                                   "\"stiffness_n_per_m\": [800, 800], "
                                   "\"stiffness_n_m_per_rad\": 0}],"
                                   " \"configurations\": {\"still\": {}, \"moved\": "
                                   "{\"drive\": {\"joint\": \"guide\", "
                                   "\"position_m\": \"to\", \"hold\": {\"trim\": \"coil\"}}},"
                                   "  \"turns\": {\"like\": \"moved\", \"parameters\": "
                                   "{\"to\": 0.3}}}}";

/* 0.3 m are twelve radians of the pinion, nearly two turns. */
static void rack__couples_a_turn_and_a_displacement(mt_test *t)
{
    static const char *const names[] = {"still", "moved", "turns"};
    const double r2 = 0.025 * 0.025;
    const double hz = sqrt((5.0 + (800.0 * r2)) / (0.0004 + (0.9 * r2))) / (2.0 * MECH_PI);
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_parse(t, RACK), names[i], "", &s)) {
            mech_expect(t, &s, 1, &hz, 0, TOL);
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(plane__a_bead_on_an_incline_is_a_pendulum_in_it),
             MT_TEST(plane__takes_the_direction_along_its_normal),
             MT_TEST(orientation__bodies_turn_together_and_move_apart),
             MT_TEST(gear__in_the_plane_reduces_inertia_and_stiffness),
             MT_TEST(gear__a_planet_rolls_around_a_sun_that_does_not_turn),
             MT_TEST(rack__couples_a_turn_and_a_displacement))
