/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A moving ground and what hangs on it by its own mass. A bar of mass b and a body of mass m,
 * at whose ends the velocities are u (the ground's) and v, have the kinetic energy
 *     T = m v^2/2 + b (v^2 + v u + u^2)/6,
 * so that with v = u + r', along a spring of stiffness k,
 *     (m + b/3) r'' + k r = -(m + b/2) u'.
 * And whatever moves a table, the motions and forces on it over its acceleration are the
 * response to a ground that moves.
 */
#include "response/response_fixture.h"

static const double TOL = 1e-10;

/* A rod between ball joints that swings, and one that is elastic. */
static const char ROD[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"r\", \"dimension\": 2,"
    "  \"parameters\": { \"m\": 2, \"b\": 6, \"k\": 1000, \"l\": 1 },"
    "  \"bodies\": [ { \"name\": \"m\", \"mass_kg\": \"m\", \"centre\": [\"l\", 0] } ],"
    "  \"joints\": [ { \"name\": \"rod\", \"type\": \"distance\", \"bodies\": [\"ground\","
    "    \"m\"], \"at\": [[0, 0], [\"l\", 0]], \"mass_kg\": \"b\", \"in\": [\"swings\"] } ],"
    "  \"springs\": [ { \"name\": \"bar\", \"type\": \"bar\", \"bodies\": [\"ground\", \"m\"],"
    "    \"at\": [[0, 0], [\"l\", 0]], \"youngs_modulus_pa\": \"1e4*l\", \"area_m2\": 0.1,"
    "    \"density_kg_per_m3\": \"10*b/l\", \"in\": [\"stretches\"] },"
    "  { \"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", \"m\"],"
    "    \"at\": [[\"l\", 1], [\"l\", 0]], \"stiffness_n_per_m\": \"k\" } ],"
    "  \"sensors\": [ { \"name\": \"s\", \"on\": \"m\", \"directions\": [\"x\", \"y\"] } ],"
    "  \"configurations\": { \"swings\": {}, \"stretches\": {} } }";

static void moving_ground__drives_half_of_a_bars_mass(mt_test *t)
{
    static const char *const NAMES[2][2] = {{"base.y", "s.y:relative_displacement spring.k"},
                                            {"base.x", "s.x:relative_displacement spring.bar"}};
    for (int i = 0; i < 2; i++) {
        asked q = {.rc = MT_OK};
        if (mech_must(t, mech_parse(t, ROD), i == 0 ? "swings" : "stretches", "", &q.m) &&
            ask(t, &q, NAMES[i][0], NAMES[i][1])) {
            for (int i_w = 0; i_w < 9; i_w++) {
                const double w = 0.5 * pow(2.3, i_w);
                const double want = -(2.0 + 3.0) / (1000.0 - ((2.0 + 2.0) * w * w));
                mt_test_row(t, "%s, w = %g", NAMES[i][0], w);
                response_at(t, &q, w);
                CHECK_NEAR_ABS(t, cabs(q.s.h[0] - want), 0.0, TOL * fabs(want));
                CHECK_NEAR_ABS(t, cabs(q.s.h[1]), fabs(1000.0 * want), 1e3 * TOL * fabs(want));
            }
        }
        done(&q);
    }
}

/* What a joint holds still against the ground it carries along: m + b/2 of the rod, at the
 * body; all of a slider's mass. */
static const char SLIDER[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"s\", \"dimension\": 2,"
    "  \"parameters\": { \"m\": 2, \"k\": 500, \"turn\": 0 },"
    "  \"bodies\": [ { \"name\": \"b\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 1, \"centre\":"
    "    [1, 0.5] } ],"
    "  \"joints\": [ { \"name\": \"rail\", \"type\": \"prismatic\", \"bodies\": [\"ground\","
    "    \"b\"], \"at\": [1, 0], \"axis\": [\"sin(turn)\", \"cos(turn)\"] } ],"
    "  \"springs\": [ { \"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", \"b\"],"
    "    \"at\": [[1, 2], [1, 0.5]], \"stiffness_n_per_m\": \"k\" } ],"
    "  \"sensors\": [ { \"name\": \"s\", \"on\": \"b\", \"directions\": [\"y\"] } ],"
    "  \"configurations\": { \"c\": {} } }";

static void moving_ground__joints_carry_what_they_block(mt_test *t)
{
    asked rod = {.rc = MT_OK};
    asked slider = {.rc = MT_OK};
    if (mech_must(t, mech_parse(t, ROD), "swings", "", &rod.m) &&
        mech_must(t, mech_parse(t, SLIDER), "c", "", &slider.m) &&
        ask(t, &rod, "base.x", "joint.rod.x joint.rod.y") &&
        ask(t, &slider, "base.x", "joint.rail.x joint.rail.y s.y")) {
        for (int i = 0; i < 4; i++) {
            const double w = 2.0 + (11.0 * i);
            response_at(t, &rod, w);
            response_at(t, &slider, w);
            CHECK_NEAR_ABS(t, cabs(rod.s.h[0] - 5.0), 0.0, TOL);
            CHECK_NEAR_ABS(t, cabs(rod.s.h[1]), 0.0, TOL);
            CHECK_NEAR_ABS(t, cabs(slider.s.h[0] - 2.0), 0.0, TOL);
            CHECK_NEAR_ABS(t, cabs(slider.s.h[1]), 0.0, TOL);
            CHECK_NEAR_ABS(t, cabs(slider.s.h[2]), 0.0, TOL);
        }
    }
    done(&rod);
    done(&slider);
}

/* A linkage, a slider across and bars, on the ground or a table. */
static const char TABLE[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"t\", \"dimension\": %d,"
    "  \"bodies\": ["
    "  { \"name\": \"table\", \"mass_kg\": 3, \"inertia_kg_m2\": %s, \"centre\": [0.2, 0%s],"
    "    \"in\": [\"stands\"] },"
    "  { \"name\": \"arm\", \"mass_kg\": 1, \"inertia_kg_m2\": %s, \"centre\": [0.1, 0.2%s]},"
    "  { \"name\": \"cart\", \"mass_kg\": 2, \"inertia_kg_m2\": %s, \"centre\": [0.6, 0.1%s] }"
    "  ], \"joints\": ["
    "  { \"name\": \"rail\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"table\"],"
    "    \"at\": [0, 0%s], \"axis\": [1, 0%s], \"in\": [\"stands\"] },"
    "%s"
    "  \"springs\": [ %s"
    "  { \"name\": \"link\", \"type\": \"bar\", \"bodies\": [\"arm\", \"cart\"],"
    "    \"at\": [[0.2, 0.4%s], [0.6, 0.2%s]], \"youngs_modulus_pa\": 3e3, \"area_m2\": 0.1,"
    "    \"density_kg_per_m3\": 7 } ],"
    "  \"sensors\": ["
    "  { \"name\": \"a\", \"on\": \"arm\", \"at\": [0.2, 0.4%s], \"directions\": [\"x\", \"y\"]"
    "  }, { \"name\": \"c\", \"on\": \"cart\", \"directions\": [\"x\", \"y\"] },"
    "  { \"name\": \"t\", \"on\": \"table\", \"directions\": [\"x\"] } ],"
    "  \"configurations\": { \"fixed\": {}, \"stands\": {} } }";

/* What is held by `ground`, in configuration `in`. */
static void held(char *joints, char *springs, size_t size, const char *prefix,
                 const char *ground, const char *in, const char *z, const char *axis)
{
    char joint[1024];
    char spring[1024];
    (void)snprintf(joint, sizeof joint,
                   "{ \"name\": \"%sp\", \"type\": \"revolute\", \"bodies\": [\"%s\", \"arm\"],"
                   " \"at\": [0, 0%s]%s, \"in\": [\"%s\"] },"
                   "{ \"name\": \"%sq\", \"type\": \"prismatic\", \"bodies\": [\"%s\","
                   " \"cart\"], \"at\": [0.6, 0%s], \"axis\": [0, 1%s], \"in\": [\"%s\"] }",
                   prefix, ground, z, axis, in, prefix, ground, z, z, in);
    (void)snprintf(spring, sizeof spring,
                   "{ \"name\": \"%sb\", \"type\": \"bar\", \"bodies\": [\"%s\", \"arm\"],"
                   " \"at\": [[-0.3, 0.3%s], [0.2, 0.4%s]], \"youngs_modulus_pa\": 2e3,"
                   " \"area_m2\": 0.1, \"density_kg_per_m3\": 30, \"in\": [\"%s\"] },"
                   "{ \"name\": \"%sd\", \"type\": \"bar\", \"bodies\": [\"cart\", \"%s\"],"
                   " \"at\": [[0.6, 0.2%s], [0.9, 0.8%s]], \"youngs_modulus_pa\": 4e3,"
                   " \"area_m2\": 0.1, \"density_kg_per_m3\": 20, \"in\": [\"%s\"] },",
                   prefix, ground, z, z, in, prefix, ground, z, z, in);
    (void)snprintf(joints + strlen(joints), size - strlen(joints), "%s%s", joint,
                   joints[0] == '\0' ? "," : "],");
    (void)snprintf(springs + strlen(springs), size - strlen(springs), "%s", spring);
}

static void table_text(bool space, char *text, size_t size)
{
    char joints[2048] = "";
    char springs[2048] = "";
    const char *const z = space ? ", 0" : "";
    const char *const j = space ? "[0.1, 0.2, 0.3]" : "0.05";
    const char *const axis = space ? ", \"axis\": [0, 0, 1]" : "";
    held(joints, springs, sizeof joints, "g", "ground", "fixed", z, axis);
    held(joints, springs, sizeof joints, "t", "table", "stands", z, axis);
    (void)snprintf(text, size, TABLE, space ? 3 : 2, j, z, j, z, j, z, z, z, joints, springs, z,
                   z, z);
}

static void on_a_table(mt_test *t, bool space)
{
    char text[6144];
    asked base = {.rc = MT_OK};
    asked table = {.rc = MT_OK};
    table_text(space, text, sizeof text);
    if (mech_must(t, mech_parse(t, text), "fixed", "", &base.m) &&
        mech_must(t, mech_parse(t, text), "stands", "", &table.m) &&
        ask(t, &base, "base.x",
            "a.x:acceleration a.y:acceleration c.y:acceleration spring.link spring.gb "
            "spring.gd "
            "joint.gp.x joint.gp.y joint.gq.x") &&
        ask(t, &table, "t.x",
            "a.x:acceleration a.y:acceleration c.y:acceleration spring.link spring.tb "
            "spring.td "
            "joint.tp.x joint.tp.y joint.tq.x t.x:acceleration")) {
        for (int i_w = 0; i_w < 14; i_w++) {
            const double w = 1.0 * pow(1.7, i_w);
            response_at(t, &base, w);
            response_at(t, &table, w);
            for (int o = 0; o < 9; o++) {
                mt_test_row(t, "w = %g, %s", w, base.r.ports.out[o].name);
                const double complex want = table.s.h[o] / table.s.h[9];
                CHECK(t, cabs(want) > 0.0);
                CHECK_NEAR_ABS(t, cabs(base.s.h[o] - want), 0.0, TOL * cabs(want));
            }
        }
    }
    done(&base);
    done(&table);
}

static void moving_ground__is_a_table_that_carries_bars(mt_test *t)
{
    on_a_table(t, false);
    on_a_table(t, true);
}

/* Of bars that turn with a parameter, and of what a rail blocks in the reference position only:
 * base.x moves nothing there, and turns into motion as the rail does. */
static void moving_ground__derivatives_are_slopes(mt_test *t)
{
    static const double W[] = {6.0, 17.0, 90.0};
    slopes_agree(t,
                 &(const sloped){ROD, NULL, "swings", "m b k l", "base.x base.y",
                                 "s.y:relative_displacement spring.k joint.rod.x joint.rod.y"},
                 W, 3);
    slopes_agree(t,
                 &(const sloped){ROD, NULL, "stretches", "m b k l", "base.x base.y",
                                 "s.x:acceleration s.y spring.bar spring.k"},
                 W, 3);
    slopes_agree(t,
                 &(const sloped){SLIDER, NULL, "c", "m k turn", "base.x base.y",
                                 "s.y:relative_displacement spring.k joint.rail.y"},
                 W, 3);
}

MT_TEST_MAIN(MT_TEST(moving_ground__drives_half_of_a_bars_mass),
             MT_TEST(moving_ground__joints_carry_what_they_block),
             MT_TEST(moving_ground__is_a_table_that_carries_bars),
             MT_TEST(moving_ground__derivatives_are_slopes))
