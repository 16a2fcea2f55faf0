/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses of mechanisms: the ground that moves, forces of springs and joints, derivatives. */
#include "response/response_fixture.h"

static const double TOL = 1e-10;

static const char MASS[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"m\", \"dimension\": 2,"
    "  \"bodies\": [ { \"name\": \"m\", \"mass_kg\": 2, \"inertia_kg_m2\": 1,"
    " \"centre\": [0, 0] } ],"
    "  \"joints\": [ { \"name\": \"slide\", \"type\": \"prismatic\", \"bodies\": [\"ground\","
    " \"m\"], \"at\": [0, 0], \"axis\": [1, 0] } ],"
    "  \"springs\": [ { \"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m\"],"
    " \"at\": [[-1, 0], [0, 0]], \"stiffness_n_per_m\": 800 } ],"
    "  \"dampers\": [ { \"name\": \"c\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m\"],"
    " \"at\": [[-1, 0], [0, 0]], \"damping_n_s_per_m\": 6 } ],"
    "  \"sensors\": [ { \"name\": \"s\", \"on\": \"m\", \"directions\": [\"x\"] } ],"
    "  \"configurations\": { \"c\": {} } }";

/* Absolute and relative motion of a mass on a moving ground, in all motions. */
static void response__moving_ground_matches_its_closed_form(mt_test *t)
{
    static const char *const MOTIONS[3] = {"displacement", "velocity", "acceleration"};
    for (int in = 0; in < 3; in++) {
        asked q = {.rc = MT_OK};
        char input[64];
        (void)snprintf(input, sizeof input, "base.x:%s", MOTIONS[in]);
        if (!mech_must(t, mech_parse(t, MASS), NULL, "", &q.m) ||
            !ask(t, &q, input,
                 "s.x s.x:velocity s.x:acceleration s.x:relative_displacement spring.k "
                 "damper.c joint.slide.x joint.slide.y")) {
            done(&q);
            continue;
        }
        for (int i_w = 0; i_w < 9; i_w++) {
            const double w = 0.5 * pow(2.3, i_w);
            mt_test_row(t, "ground %s, w = %g", MOTIONS[in], w);
            const double complex s = mt_complex(0.0, w);
            const double complex d = 800.0 + (6.0 * s) + (2.0 * s * s);
            const double complex moved = 1.0 / cpow(s, in); /* the ground's displacement */
            const double complex relative = -2.0 * s * s * moved / d;
            const double complex space = relative + moved;
            const double complex want[8] = {
                space, s * space, s * s * space, relative, 800.0 * relative, 6.0 * s * relative,
                0.0,   0.0};
            response_at(t, &q, w);
            for (int o = 0; o < 8; o++) {
                CHECK_NEAR_ABS(t, cabs(q.s.h[o] - want[o]), 0.0,
                               TOL * fmax(cabs(want[o]), 1e-6 * cabs(relative)));
            }
        }
        done(&q);
    }
}

/* A four-bar linkage on a table: H of what stands on it over the motion of the table, whatever
 * moves the table, is the response to a moving ground. */
static const char TABLE[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"t\", \"dimension\": 2,"
    "  \"gravity_m_per_s2\": [0, -9.81], \"bodies\": ["
    "  { \"name\": \"table\", \"mass_kg\": 3, \"inertia_kg_m2\": 1, \"centre\": [0.2, 0],"
    "    \"in\": [\"stands\"] },"
    "  { \"name\": \"crank\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.002, \"centre\": [0.04, "
    "0.06]},"
    "  { \"name\": \"coupler\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.02, \"centre\": [0.2, "
    "0.2]},"
    "  { \"name\": \"rocker\", \"mass_kg\": 0.8, \"inertia_kg_m2\": 0.005,"
    "    \"centre\": [0.37, 0.12] } ],"
    "  \"joints\": ["
    "  { \"name\": \"rail\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"table\"],"
    "    \"at\": [0, 0], \"axis\": [1, 0], \"in\": [\"stands\"] },"
    "  { \"name\": \"jA\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"crank\"],"
    "    \"at\": [0, 0], \"in\": [\"fixed\"] },"
    "  { \"name\": \"kA\", \"type\": \"revolute\", \"bodies\": [\"table\", \"crank\"],"
    "    \"at\": [0, 0], \"in\": [\"stands\"] },"
    "  { \"name\": \"jB\", \"type\": \"revolute\", \"bodies\": [\"crank\", \"coupler\"],"
    "    \"at\": [0.08, 0.12] },"
    "  { \"name\": \"jC\", \"type\": \"revolute\", \"bodies\": [\"coupler\", \"rocker\"],"
    "    \"at\": [0.35, 0.25] },"
    "  { \"name\": \"jD\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"rocker\"],"
    "    \"at\": [0.4, 0], \"in\": [\"fixed\"] },"
    "  { \"name\": \"kD\", \"type\": \"revolute\", \"bodies\": [\"table\", \"rocker\"],"
    "    \"at\": [0.4, 0], \"in\": [\"stands\"] } ],"
    "  \"springs\": ["
    "  { \"name\": \"servo\", \"type\": \"torsion\", \"joint\": \"jB\","
    "    \"stiffness_n_m_per_rad\": 80 } ],"
    "  \"dampers\": ["
    "  { \"name\": \"oil\", \"type\": \"torsion\", \"joint\": \"jC\","
    "    \"damping_n_m_s_per_rad\": 0.3 } ],"
    "  \"sensors\": [ { \"name\": \"c\", \"on\": \"coupler\", \"directions\": [\"x\", \"y\","
    " \"r\"] }, { \"name\": \"t\", \"on\": \"table\", \"directions\": [\"x\"] } ],"
    "  \"configurations\": { \"fixed\": {}, \"stands\": {} } }";

static void response__moving_ground_is_a_table_that_moves(mt_test *t)
{
    asked base = {.rc = MT_OK};
    asked table = {.rc = MT_OK};
    if (mech_must(t, mech_parse(t, TABLE), "fixed", "", &base.m) &&
        mech_must(t, mech_parse(t, TABLE), "stands", "", &table.m) &&
        ask(t, &base, "base.x",
            "c.x:acceleration c.y:acceleration c.r:acceleration spring.servo damper.oil "
            "joint.jB.x joint.jB.y joint.jD.x joint.jD.y") &&
        ask(t, &table, "t.x",
            "c.x:acceleration c.y:acceleration c.r:acceleration spring.servo damper.oil "
            "joint.jB.x joint.jB.y joint.kD.x joint.kD.y t.x:acceleration")) {
        for (int i_w = 0; i_w < 14; i_w++) {
            const double w = 1.0 * pow(1.7, i_w);
            response_at(t, &base, w);
            response_at(t, &table, w);
            for (int o = 0; o < 9; o++) {
                mt_test_row(t, "w = %g, %s", w, base.r.ports.out[o].name);
                const double complex want = table.s.h[o] / table.s.h[9];
                CHECK_NEAR_ABS(t, cabs(base.s.h[o] - want), 0.0, TOL * cabs(want));
            }
        }
    }
    done(&base);
    done(&table);
}

/* Cut free, the coupler of the standing linkage: mass times acceleration is the sum of the
 * forces on it, in all directions, with the weight that hangs in the joints. */
static void check_cut(mt_test *t, const asked *q)
{
    for (int at_h = 0; at_h < 4; at_h++) {
        const int axis = at_h % 2;
        const double complex *const h = q->s.h + ((ptrdiff_t)(at_h / 2) * 10);
        const double complex crank = h[8 + axis] - h[2 + axis];
        CHECK_NEAR_ABS(t, cabs((1.0 * h[6 + axis]) - crank), 0.0,
                       TOL * (cabs(h[8 + axis]) + cabs(h[2 + axis])));
    }
}

static void response__joints_hold_a_body_in_equilibrium(mt_test *t)
{
    static const char *const CONFIGURATIONS[2] = {"loaded", "still"};
    for (int c = 0; c < 2; c++) {
        asked q = {.rc = MT_OK};
        const bool ready =
            mech_must(t, mech_load(t, "four_bar"), CONFIGURATIONS[c], "", &q.m) &&
            ask(t, &q, "tip.x crank.r",
                "mid.x:acceleration mid.y:acceleration joint.jB.x joint.jB.y joint.jC.x "
                "joint.jC.y crank.x:acceleration crank.y:acceleration joint.jA.x joint.jA.y");
        for (int i_w = 0; i_w < 8 && ready; i_w++) {
            const double w = 2.0 * pow(2.1, i_w);
            mt_test_row(t, "%s, w = %g", CONFIGURATIONS[c], w);
            response_at(t, &q, w);
            check_cut(t, &q);
        }
        done(&q);
    }
}

/* A pendulum in its weight: the same, where all that the joint carries is known. */
static void response__a_standing_force_turns_with_its_body(mt_test *t)
{
    asked q = {.rc = MT_OK};
    if (mech_must(t, mech_load(t, "pendulum"), "hanging", "", &q.m) &&
        ask(t, &q, "tip.x", "tip.x:acceleration joint.pivot.x joint.pivot.y")) {
        for (int i_w = 0; i_w < 8; i_w++) {
            const double w = 1.0 * pow(1.9, i_w);
            response_at(t, &q, w);
            /* centre half way: m a_c = 1 + F_x */
            CHECK_NEAR_ABS(t, cabs((0.5 * q.s.h[0]) - 1.0 - q.s.h[1]), 0.0, TOL);
            CHECK_NEAR_ABS(t, cabs(q.s.h[2]), 0.0, TOL);
        }
    }
    done(&q);
}

static void response__unclear_forces_are_refused(mt_test *t)
{
    static const struct {
        const char *model;
        const char *configuration;
        const char *input;
        const char *output;
        const char *says;
    } rows[] = {
        {"pendulum", "twice", "tip.x", "joint.pivot.x", "redundant"},
        {"pendulum", "hanging", "tip.q", "tip.x", "no input is called"},
        {"pendulum", "hanging", "base.z", "tip.x", "did you mean \"base.x\""},
        {"pendulum", "hanging", "tip.x", "tip.x:speed", "is not displacement"},
        {"pendulum", "hanging", "tip.x:velocity", "tip.x", "is its force"},
        {"pendulum", "upside_down", "tip.x", "tip.x", "unstable"},
        {"four_bar", "still", "tip.x", "spring.servi", "did you mean \"spring.servo\""},
        {"space_stick", "geared", "tip.x", "joint.gears.x", "no bodies of its own"},
        {"space_stick", "weightless", "tip.x", "spring.mount", "several forces"},
        {"space_stick", "weightless", "tip.x", "spring.mount.q", "no output is called"},
        {"four_bar", "still", "tip.x", "spring.servo.x", "no output is called"},
        {"four_bar", "still", "tip.x", "spring.", "no output is called"},
    };
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
        mt_test_row(t, "%s, %s, %s", rows[r].model, rows[r].input, rows[r].output);
        asked q = {.rc = MT_OK};
        if (mech_must(t, mech_load(t, rows[r].model), rows[r].configuration, "", &q.m)) {
            mt_err err = {.text = ""};
            const mt_response_request request = {
                .n_in = 1, .inputs = &rows[r].input, .n_out = 1, .outputs = &rows[r].output};
            CHECK(t, mt_response_open(q.m.a, &request, &q.r, &err) != MT_OK);
            if (!CHECK(t, strstr(err.text, rows[r].says) != NULL)) {
                (void)fprintf(stderr, "%s\n", err.text);
            }
        }
        done(&q);
    }
}

static void response__derivatives_are_slopes(mt_test *t)
{
    static const double W[] = {6.0, 17.0, 90.0};
    slopes_agree(t,
                 &(const sloped){
                     NULL, "four_bar", "still", "a k m_c alpha", "tip.x base.y crank.r",
                     "tip.y mid.x:acceleration spring.servo spring.coil joint.jB.x joint.jD.y"},
                 W, 3);
    slopes_agree(
        t,
        &(const sloped){NULL, "four_bar", "loaded", "a k m_c g alpha", "tip.x base.x",
                        "tip.y mid.x:velocity spring.servo spring.coil joint.jA.x joint.jB.y "
                        "joint.jC.x joint.jD.y"},
        W, 3);
    slopes_agree(t,
                 &(const sloped){NULL, "four_bar", "trimmed", "a k m_c", "tip.x",
                                 "tip.y spring.coil joint.jA.x joint.jC.y"},
                 W, 2);
    slopes_agree(t,
                 &(const sloped){NULL, "pendulum", "hanging", "m L w g", "tip.x base.y",
                                 "tip.x joint.pivot.x joint.pivot.y"},
                 W, 3);
    slopes_agree(t,
                 &(const sloped){NULL, "space_loads", "heavy", "F T P a k", "sled.x base.z",
                                 "joint.ball.x joint.ball.z joint.shaft.x joint.shaft.y "
                                 "joint.guide.x joint.guide.z joint.foot.x joint.cord.z"},
                 W, 2);
    slopes_agree(t,
                 &(const sloped){NULL, "space_stick", "geared", "k tilt l m ratio kb", "tip.x",
                                 "s.x tip.y:acceleration"},
                 W, 2);
    slopes_agree(t,
                 &(const sloped){NULL, "space_stick", "geared", "k tilt l m ratio kb", "base.z",
                                 "s.x plate.y wheel.rz"},
                 W, 2);
}

/* With a damper in it, through a peak. */
static const char DAMPED[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"d\", \"dimension\": 2,"
    "  \"parameters\": { \"m\": 2, \"k\": 60, \"c\": 0.3, \"l\": 0.5, \"u\": 0.1 },"
    "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 0.02,"
    "                  \"centre\": [\"l/2\", \"u\"] },"
    "                { \"name\": \"b\", \"mass_kg\": 0.5, \"inertia_kg_m2\": 0.01,"
    "                  \"centre\": [\"l + 0.1\", 0.2] } ],"
    "  \"joints\": [ { \"name\": \"p\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"a\"],"
    "                  \"at\": [0, 0] },"
    "                { \"name\": \"q\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"],"
    "                  \"at\": [\"l\", \"u\"] } ],"
    "  \"springs\": [ { \"name\": \"s\", \"type\": \"torsion\", \"joint\": \"p\","
    "                   \"stiffness_n_m_per_rad\": \"k\" },"
    "                 { \"name\": \"v\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"],"
    "                   \"at\": [[\"l\", 0.3], [\"l + 0.3\", \"u\"]],"
    "                   \"stiffness_n_per_m\": 400 } ],"
    "  \"dampers\": [ { \"name\": \"d\", \"type\": \"axial\", \"bodies\": [\"ground\", \"b\"],"
    "                   \"at\": [[\"l\", -0.4], [\"l + 0.2\", 0.1]],"
    "                   \"damping_n_s_per_m\": \"c\" } ],"
    "  \"sensors\": [ { \"name\": \"e\", \"on\": \"b\", \"at\": [\"l + 0.2\", \"2*u\"] } ],"
    "  \"configurations\": { \"c\": {} } }";

static void response__derivatives_hold_through_a_peak(mt_test *t)
{
    asked q = {.rc = MT_OK};
    double w[3] = {0.0};
    if (mech_must(t, mech_parse(t, DAMPED), "c", "", &q.m)) {
        const double peak = 2.0 * MECH_PI * mech_hz(&q.m, 1);
        w[0] = 0.99 * peak;
        w[1] = 1.003 * peak;
        w[2] = 1.02 * peak;
    }
    done(&q);
    slopes_agree(t,
                 &(const sloped){DAMPED, NULL, "c", "m k c l u", "e.x base.y",
                                 "e.y:acceleration spring.v damper.d joint.p.x joint.q.y"},
                 w, 3);
}

MT_TEST_MAIN(MT_TEST(response__moving_ground_matches_its_closed_form),
             MT_TEST(response__moving_ground_is_a_table_that_moves),
             MT_TEST(response__joints_hold_a_body_in_equilibrium),
             MT_TEST(response__a_standing_force_turns_with_its_body),
             MT_TEST(response__unclear_forces_are_refused),
             MT_TEST(response__derivatives_are_slopes),
             MT_TEST(response__derivatives_hold_through_a_peak))
