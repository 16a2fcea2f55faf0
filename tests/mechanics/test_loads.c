/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Dead loads against closed forms.
 *   pendulum m, l, dead force F down at its bob
 *       omega^2 = (m g + F)/(m l); a force that follows the rod: g/l
 *   the same force towards an anchor D below the bob
 *       omega^2 = g/l + F (1 + l/D)/(m l), whose limit is the dead force
 *   spherical body, inertia J about its pivot, force at a
 *       omega^2 = F a/J about both axes
 *   column of two rigid links, springs k, dead tip load P
 *       buckles at P l/k = (3 - sqrt 5)/2 (Ziegler 1968; the load that follows never does)
 *   pendulum with a moment M
 *       m g l sin theta = M, omega^2 = g cos theta/l
 *   motor of torque M between a pendulum and a flywheel
 *       the pendulum leans by -M
 *   slider under F against a spring of free length L0 at the distance h
 *       F = k (L - L0) x/L, K = k (1 - L0/L) + k (L0/L)(x/L)^2
 */
#include "mechanics/mech.h"

#define HEAD(dimension, parameters)                                 \
    "{\"format\": \"modetune-model/1\", \"dimension\": " #dimension \
    ", \"parameters\": {" parameters "},"

/* One or two freedoms: rounding, and what equilibrium leaves. */
static const double TOL = 1e-11;

static const char PENDULUM[] = HEAD(2, "\"g\": 9.81, \"m\": 2, \"l\": 0.7, \"F\": 5, \"D\": "
                                       "1e5") " \"gravity_m_per_s2\": [0, \"-g\"],"
                                              " \"bodies\": [{\"name\": \"rod\", "
                                              "\"inertia_kg_m2\": 0, \"centre\": [0, 0]},"
                                              "  {\"name\": \"bob\", \"mass_kg\": \"m\", "
                                              "\"centre\": [0, \"-l\"]}],"
                                              " \"joints\": [{\"name\": \"pivot\", \"type\": "
                                              "\"revolute\", \"bodies\": [\"ground\", "
                                              "\"rod\"], \"at\": [0, 0]},"
                                              "  {\"name\": \"weld\", \"type\": \"revolute\", "
                                              "\"bodies\": [\"rod\", \"bob\"], \"at\": [0, "
                                              "\"-l\"]}],"
                                              " \"springs\": ["
                                              "  {\"name\": \"rope\", \"type\": \"axial\", "
                                              "\"bodies\": [\"ground\", \"bob\"], \"at\": [[0, "
                                              "\"-l - D\"], "
                                              "[0, \"-l\"]], \"stiffness_n_per_m\": 0, "
                                              "\"preload_n\": \"F\", \"in\": [\"anchored\"]},"
                                              "  {\"name\": \"follower\", \"type\": \"axial\", "
                                              "\"bodies\": [\"rod\", \"bob\"], \"at\": [[0, "
                                              "\"-l - 1\"], "
                                              "[0, \"-l\"]], \"stiffness_n_per_m\": 0, "
                                              "\"preload_n\": \"F\", \"in\": [\"following\"]}],"
                                              " \"loads\": [{\"name\": \"weight\", \"on\": "
                                              "\"bob\", \"force_n\": [0, \"-F\"], \"in\": "
                                              "[\"dead\"]},"
                                              "  {\"name\": \"same\", \"on\": \"rod\", \"at\": "
                                              "[0, \"-l\"], \"force_n\": [0, \"-F\"], \"in\": "
                                              "[\"on_rod\"]}],"
                                              " \"configurations\": {\"bare\": {}, \"dead\": "
                                              "{}, \"on_rod\": {}, \"anchored\": {}, "
                                              "\"following\": {}}}";

static double hz_of(double lambda)
{
    return sqrt(lambda) / (2.0 * MECH_PI);
}

static void load__a_dead_force_stiffens_a_pendulum_and_a_following_one_does_not(mt_test *t)
{
    const double still = 9.81 / 0.7;
    const double dead = still + (5.0 / (2.0 * 0.7));
    const struct {
        const char *name;
        double lambda;
    } rows[] = {
        {"bare", still},      {"dead", dead},
        {"on_rod", dead},     {"anchored", still + (5.0 * (1.0 + (0.7 / 1e5)) / (2.0 * 0.7))},
        {"following", still},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].name);
        if (mech_must(t, mech_parse(t, PENDULUM), rows[i].name, "", &s)) {
            mech_expect(t, &s, 1, (const double[1]){hz_of(rows[i].lambda)}, 0, TOL);
        }
        mech_free(&s);
    }
}

static void load__a_force_in_space_turns_its_body_towards_it(mt_test *t)
{
    static const char model[] = HEAD(
        3,
        "\"F\": 30, \"a\": 0.2") " \"bodies\": [{\"name\": \"body\", \"mass_kg\": 1, "
                                 "\"inertia_kg_m2\": [0.04, 0.05, 0.06], \"centre\": [0, 0, "
                                 "0]}],"
                                 " \"joints\": [{\"name\": \"ball\", \"type\": \"spherical\", "
                                 "\"bodies\": [\"ground\", \"body\"], \"at\": [0, 0, 0]}],"
                                 " \"springs\": [{\"name\": \"k\", \"type\": \"bushing\", "
                                 "\"bodies\": [\"ground\", \"body\"], \"at\": [0, 0, 0], "
                                 "\"stiffness_n_per_m\": [0, 0, 0], \"stiffness_n_m_per_rad\": "
                                 "[0, 0, 9]}],"
                                 " \"loads\": [{\"name\": \"pull\", \"on\": \"body\", \"at\": "
                                 "[0, 0, \"-a\"], \"force_n\": [0, 0, \"-F\"]}]}";
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        const double hz[3] = {hz_of(6.0 / 0.05), hz_of(6.0 / 0.04), hz_of(9.0 / 0.06)};
        mech_expect(t, &s, 3, (const double[3]){hz[0], hz[1], hz[2]}, 0, TOL);
    }
    mech_free(&s);
}

/* Links of 0.5 m, springs of 10 N m/rad at the foot and between: P_cr = 20 (3 - sqrt 5)/2 N. */
static void load__a_column_of_two_links_buckles_under_a_dead_load(mt_test *t)
{
    static const char model[] = HEAD(
        2,
        "\"P\": 0") " \"links\": [{\"name\": \"column\", \"from\": [0, 0], \"to\": [0, 1], "
                    "\"elements\": 2, \"mass_kg\": 1, "
                    "\"stiffness_n_m_per_rad\": 10}],"
                    " \"joints\": [{\"name\": \"foot\", \"type\": \"revolute\", \"bodies\": "
                    "[\"ground\", \"column.start\"], \"at\": [0, 0]}],"
                    " \"springs\": [{\"name\": \"base\", \"type\": \"torsion\", \"joint\": "
                    "\"foot\", \"stiffness_n_m_per_rad\": 10}],"
                    " \"loads\": [{\"name\": \"tip\", \"on\": \"column.end\", \"force_n\": [0, "
                    "\"-P\"]}],"
                    " \"configurations\": {\"below\": {\"parameters\": {\"P\": \"20*(3 - "
                    "sqrt(5))/2*(1 - 1e-6)\"}},"
                    "  \"above\": {\"parameters\": {\"P\": \"20*(3 - sqrt(5))/2*(1 + 1e-6)\"}},"
                    "  \"half\": {\"parameters\": {\"P\": 4}}}}";
    mech s;
    if (mech_must(t, mech_parse(t, model), "below", "", &s)) {
        CHECK_INT(t, s.a->modes.n_unstable, 0);
    }
    mech_free(&s);
    if (mech_must(t, mech_parse(t, model), "above", "", &s)) {
        CHECK_INT(t, s.a->modes.n_unstable, 1);
    }
    mech_free(&s);
    /* angles of the two links: K = [20 - P/2, -10; -10, 10 - P/2], M = m l^2 [4/3, 1/2; 1/2,
     * 1/3], m = 1/2, l = 1/2 */
    if (mech_must(t, mech_parse(t, model), "half", "", &s)) {
        const double k11 = 20.0 - 2.0;
        const double k22 = 10.0 - 2.0;
        const double ml2 = 0.125;
        const double a = ml2 * ml2 * ((4.0 / 9.0) - 0.25);
        const double b = ml2 * ((k11 / 3.0) + (4.0 * k22 / 3.0) + 10.0);
        const double c = (k11 * k22) - 100.0;
        const double root = sqrt((b * b) - (4.0 * a * c));
        const double hz[2] = {hz_of(2.0 * c / (b + root)), hz_of((b + root) / (2.0 * a))};
        mech_expect(t, &s, 2, hz, 0, TOL);
    }
    mech_free(&s);
}

#define LEANING(dimension, vector, inertia, origin, low, axis, load)                        \
    HEAD(dimension, "\"M\": 3")                                                             \
    " \"gravity_m_per_s2\": " vector ","                                                    \
    " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 1, \"inertia_kg_m2\": " inertia         \
    ", \"centre\": " low "}],"                                                              \
    " \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", \"bodies\": [\"ground\", " \
    "\"bob\"], \"at\": " origin axis "}],"                                                  \
    " \"loads\": [{\"name\": \"turn\", " load ", \"moment_n_m\": \"M\"}]}"

static void load__a_moment_leans_a_pendulum(mt_test *t)
{
    static const struct {
        const char *name;
        const char *text;
    } rows[] = {
        {"on the body",
         LEANING(2, "[0, -9.81]", "0.02", "[0, 0]", "[0, -0.5]", "", "\"on\": \"bob\"")},
        {"on the joint",
         LEANING(2, "[0, -9.81]", "0.02", "[0, 0]", "[0, -0.5]", "", "\"joint\": \"pivot\"")},
        {"on the joint, in space",
         LEANING(3, "[0, -9.81, 0]", "[1, 1, 0.02]", "[0, 0, 0]", "[0, -0.5, 0]",
                 ", \"axis\": [0, 0, 2]", "\"joint\": \"pivot\"")},
    };
    const double mgl = 9.81 * 0.5;
    const double hz = hz_of(mgl * sqrt(1.0 - (9.0 / (mgl * mgl))) / (0.02 + 0.25));
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].name);
        if (mech_must(t, mech_parse(t, rows[i].text), NULL, "", &s)) {
            mech_expect(t, &s, 1, &hz, 0, TOL);
            /* positive: counter-clockwise, as the axis points */
            const double lean = creal(mt_linear_position(s.a->lin)->at.pose[0].x[0]);
            CHECK_NEAR(t, lean, 0.5 * 3.0 / mgl, TOL);
        }
        mech_free(&s);
    }
}

/* The reaction of the motor leans the pendulum the other way; the flywheel's own spring takes
 * the torque. */
static void load__of_a_joint_has_its_reaction_on_the_first_body(mt_test *t)
{
    static const char model[] =
        HEAD(2, "\"M\": 3") " \"gravity_m_per_s2\": [0, -9.81],"
                            " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 1, "
                            "\"inertia_kg_m2\": 0.02, \"centre\": [0, -0.5]},"
                            "  {\"name\": \"wheel\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.01, "
                            "\"centre\": [0, 0]}],"
                            " \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", "
                            "\"bodies\": [\"ground\", \"bob\"], \"at\": [0, 0]},"
                            "  {\"name\": \"shaft\", \"type\": \"revolute\", \"bodies\": "
                            "[\"bob\", \"wheel\"], \"at\": [0, 0]}],"
                            " \"springs\": [{\"name\": \"coil\", \"type\": \"torsion\", "
                            "\"bodies\": [\"ground\", \"wheel\"], "
                            "\"stiffness_n_m_per_rad\": 40}],"
                            " \"loads\": [{\"name\": \"motor\", \"joint\": \"shaft\", "
                            "\"moment_n_m\": \"M\"}]}";
    const double mgl = 9.81 * 0.5;
    const double hz[2] = {hz_of(mgl * sqrt(1.0 - (9.0 / (mgl * mgl))) / 0.27),
                          hz_of(40.0 / 0.01)};
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        mech_expect(t, &s, 2, hz, 0, TOL);
        CHECK_NEAR(t, creal(mt_linear_position(s.a->lin)->at.pose[0].x[0]), -0.5 * 3.0 / mgl,
                   TOL);
        CHECK_NEAR(t, asin(creal(mt_linear_position(s.a->lin)->at.pose[1].r[1])), 3.0 / 40.0,
                   TOL);
    }
    mech_free(&s);
}

/* h = 0.3, x = 0.4, L = 0.5, L0 = 0.35: drawn at x = 0.3 it slides on to 0.4. */
static void load__along_a_guide_pushes_a_slider_to_its_place(mt_test *t)
{
    static const char model[] = HEAD(
        2, "\"k\": 200") " \"bodies\": [{\"name\": \"slider\", \"mass_kg\": 2, "
                         "\"inertia_kg_m2\": 1, \"centre\": [0.3, 0]}],"
                         " \"joints\": [{\"name\": \"guide\", \"type\": \"prismatic\", "
                         "\"bodies\": [\"ground\", \"slider\"], "
                         "\"at\": [0.3, 0], \"axis\": [5, 0]}],"
                         " \"springs\": [{\"name\": \"coil\", \"type\": \"axial\", \"bodies\": "
                         "[\"ground\", \"slider\"], \"at\": [[0, 0.3], "
                         "[0.3, 0]], \"stiffness_n_per_m\": \"k\", \"free_length_m\": 0.35}],"
                         " \"loads\": [{\"name\": \"ram\", \"joint\": \"guide\", \"force_n\": "
                         "\"k*0.15*0.8\"}]}";
    const double hz = hz_of(200.0 * ((1.0 - 0.7) + (0.7 * 0.64)) / 2.0);
    mech s;
    if (mech_must(t, mech_parse(t, model), NULL, "", &s)) {
        mech_expect(t, &s, 1, &hz, 0, TOL);
        CHECK_NEAR(t, creal(mt_linear_position(s.a->lin)->at.pose[0].x[0]), 0.4, TOL);
    }
    mech_free(&s);
}

/* Held at 0.4 rad: the lock carries m g l sin theta - M. */
static void load__is_carried_by_what_holds_a_driven_joint(mt_test *t)
{
    static const char model[] =
        HEAD(2, "\"M\": 3") " \"gravity_m_per_s2\": [0, -9.81],"
                            " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 1, "
                            "\"inertia_kg_m2\": 0.02, \"centre\": [0, -0.5]},"
                            "  {\"name\": \"ball\", \"mass_kg\": 1, \"centre\": [0, -0.8]}],"
                            " \"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\", "
                            "\"bodies\": [\"ground\", \"bob\"], \"at\": [0, 0]},"
                            "  {\"name\": \"rod\", \"type\": \"distance\", \"bodies\": "
                            "[\"bob\", \"ball\"], \"at\": [[0, -0.5], [0, -0.8]]}],"
                            " \"loads\": [{\"name\": \"turn\", \"on\": \"bob\", "
                            "\"moment_n_m\": \"M\"}],"
                            " \"configurations\": {\"held\": {\"drive\": {\"joint\": "
                            "\"pivot\", \"position_rad\": 0.4}}}}";
    mech s;
    if (mech_must(t, mech_parse(t, model), "held", "", &s)) {
        const mt_linear *const lin = s.a->lin;
        const double hold =
            -mt_linear_position(lin)
                 ->equilibrium.lambda[mt_linear_system(lin)->drives[0].constraint];
        CHECK_NEAR(t, hold, (2.0 * 9.81 * 0.5 * sin(0.4)) - 3.0, TOL);
        mech_expect(t, &s, 1, (const double[1]){hz_of(9.81 / 0.3)}, 0, TOL);
    }
    mech_free(&s);
}

/* A load of no size is no load: nothing is balanced, and proofs stay possible. */
static void load__of_zero_loads_nothing(mt_test *t)
{
    static const char model[] = HEAD(
        2,
        "\"k\": 200") " \"bodies\": [{\"name\": \"a\", \"mass_kg\": 2, \"inertia_kg_m2\": 1, "
                      "\"centre\": [0, 0]}],"
                      " \"springs\": [{\"name\": \"b\", \"type\": \"bushing\", \"bodies\": "
                      "[\"ground\", \"a\"], "
                      "\"stiffness_n_per_m\": [\"k\", \"k\"], \"stiffness_n_m_per_rad\": 5}],"
                      " \"loads\": [{\"name\": \"none\", \"on\": \"a\", \"force_n\": [0, 0], "
                      "\"moment_n_m\": 0},"
                      "  {\"name\": \"some\", \"on\": \"a\", \"force_n\": [1, 0], \"in\": "
                      "[\"loaded\"]}],"
                      " \"configurations\": {\"free\": {}, \"loaded\": {}}}";
    mech s;
    if (mech_must(t, mech_parse(t, model), "free", "", &s)) {
        CHECK(t, !s.a->sys->loaded);
        CHECK(t, !mt_linear_reduced(s.a->lin).loaded);
    }
    mech_free(&s);
    if (mech_must(t, mech_parse(t, model), "loaded", "", &s)) {
        CHECK(t, s.a->sys->loaded);
        CHECK_INT(t, s.a->sys->n_loads, 1);
        CHECK_NEAR(t, creal(mt_linear_position(s.a->lin)->at.pose[0].x[0]), 1.0 / 200.0, TOL);
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(load__a_dead_force_stiffens_a_pendulum_and_a_following_one_does_not),
             MT_TEST(load__a_force_in_space_turns_its_body_towards_it),
             MT_TEST(load__a_column_of_two_links_buckles_under_a_dead_load),
             MT_TEST(load__a_moment_leans_a_pendulum),
             MT_TEST(load__of_a_joint_has_its_reaction_on_the_first_body),
             MT_TEST(load__along_a_guide_pushes_a_slider_to_its_place),
             MT_TEST(load__is_carried_by_what_holds_a_driven_joint),
             MT_TEST(load__of_zero_loads_nothing))
