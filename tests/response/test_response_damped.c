/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses with all that damps: closed forms, a moving ground as a table, derivatives. */
#include "response/response_fixture.h"

static const double TOL = 1e-10;

/* 2 kg on 800 N/m along x. */
#define ONE(spring, damping)                                                                   \
    "{ \"format\": \"modetune-model/1\", \"name\": \"m\", \"dimension\": 2,"                   \
    "  \"bodies\": [ { \"name\": \"m\", \"mass_kg\": 2, \"inertia_kg_m2\": 1,"                 \
    "    \"centre\": [0, 0] } ],"                                                              \
    "  \"joints\": [ { \"name\": \"slide\", \"type\": \"prismatic\", \"bodies\": [\"ground\"," \
    " \"m\"], \"at\": [0, 0], \"axis\": [1, 0] } ],"                                           \
    "  \"springs\": [ { \"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", "       \
    "\"m\"],"                                                                                  \
    " \"at\": [[-1, 0], [0, 0]], \"stiffness_n_per_m\": 800" spring " } ],"                    \
    "  \"sensors\": [ { \"name\": \"s\", \"on\": \"m\", \"directions\": [\"x\"] } ]" damping   \
    "}"

static void damped__one_mass_matches_its_closed_form(mt_test *t)
{
    /* s^2 2 + s c + 800 (1 + i eta) */
    static const struct {
        const char *name;
        const char *text;
        double c;
        double eta;
    } rows[] = {
        {"ratio", ONE("", ", \"damping\": {\"ratio\": 0.04}"), 2.0 * 0.04 * 40.0, 0.0},
        {"proportional", ONE("", ", \"damping\": {\"mass_per_s\": 0.3, \"stiffness_s\": 0.01}"),
         0.6 + 8.0, 0.0},
        {"loss factor", ONE(", \"loss_factor\": 0.07", ""), 0.0, 0.07},
        {"all", ONE(", \"loss_factor\": 0.07", ", \"damping\": {\"ratio\": 0.04}"),
         2.0 * 0.04 * 40.0, 0.07},
    };
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
        asked q = {.rc = MT_OK};
        const bool ready = mech_must(t, mech_parse(t, rows[r].text), NULL, "", &q.m) &&
                           ask(t, &q, "s.x base.x", "s.x s.x:acceleration spring.k");
        for (int i = 0; i < 12 && ready; i++) {
            const double w = 3.0 * pow(1.7, i);
            const double complex s = mt_complex(0.0, w);
            const double complex k = 800.0 * mt_complex(1.0, rows[r].eta);
            const double complex d = k + (rows[r].c * s) + (2.0 * s * s);
            const double complex want[6] = {1.0 / d,
                                            s * s / d,
                                            k / d,
                                            (-2.0 / d) + (1.0 / (s * s)),
                                            1.0 - (2.0 * s * s / d),
                                            -2.0 * k / d};
            mt_test_row(t, "%s, w = %g", rows[r].name, w);
            response_at(t, &q, w);
            for (int o = 0; o < 6; o++) {
                CHECK_NEAR_ABS(t, cabs(q.s.h[o] - want[o]), 0.0, TOL * cabs(want[o]));
            }
        }
        done(&q);
    }
}

/* A linkage on a table, its springs lossy and damped in proportion: what stands on it does not
 * know what moves the table. */
#define TABLE                                                                               \
    "{ \"format\": \"modetune-model/1\", \"name\": \"t\", \"dimension\": 2, \"bodies\": ["  \
    "  { \"name\": \"table\", \"mass_kg\": 3, \"inertia_kg_m2\": 1, \"centre\": [0.2, 0],"  \
    "    \"in\": [\"stands\"] },"                                                           \
    "  { \"name\": \"arm\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.002, \"centre\": [0.1, "   \
    "0.1]},"                                                                                \
    "  { \"name\": \"hand\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.02,"                      \
    "    \"centre\": [0.2, 0.3]} ], \"joints\": ["                                          \
    "  { \"name\": \"rail\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"table\"]," \
    "    \"at\": [0, 0], \"axis\": [1, 0], \"in\": [\"stands\"] },"                         \
    "  { \"name\": \"jA\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"arm\"],"      \
    "    \"at\": [0, 0], \"in\": [\"fixed\"] },"                                            \
    "  { \"name\": \"kA\", \"type\": \"revolute\", \"bodies\": [\"table\", \"arm\"],"       \
    "    \"at\": [0, 0], \"in\": [\"stands\"] },"                                           \
    "  { \"name\": \"jB\", \"type\": \"revolute\", \"bodies\": [\"arm\", \"hand\"],"        \
    "    \"at\": [0.2, 0.1] } ], \"springs\": ["                                            \
    "  { \"name\": \"a\", \"type\": \"torsion\", \"joint\": \"jA\", \"loss_factor\": 0.1,"  \
    "    \"stiffness_n_m_per_rad\": 50, \"in\": [\"fixed\"] },"                             \
    "  { \"name\": \"b\", \"type\": \"torsion\", \"joint\": \"kA\", \"loss_factor\": 0.1,"  \
    "    \"stiffness_n_m_per_rad\": 50, \"in\": [\"stands\"] },"                            \
    "  { \"name\": \"c\", \"type\": \"torsion\", \"joint\": \"jB\", \"loss_factor\": 0.02," \
    "    \"stiffness_n_m_per_rad\": 20 } ], \"damping\": {\"stiffness_s\": 0.003},"         \
    "  \"sensors\": [ { \"name\": \"h\", \"on\": \"hand\" }, { \"name\": \"t\","            \
    "    \"on\": \"table\", \"directions\": [\"x\"] } ],"                                   \
    "  \"configurations\": { \"fixed\": {}, \"stands\": {} } }"

static void damped__moving_ground_is_a_table_that_moves(mt_test *t)
{
    asked base = {.rc = MT_OK};
    asked table = {.rc = MT_OK};
    const bool ready =
        mech_must(t, mech_parse(t, TABLE), "fixed", "", &base.m) &&
        mech_must(t, mech_parse(t, TABLE), "stands", "", &table.m) &&
        ask(t, &base, "base.x",
            "h.x:acceleration h.y:acceleration spring.a spring.c joint.jA.x joint.jA.y "
            "joint.jB.x") &&
        ask(t, &table, "t.x",
            "h.x:acceleration h.y:acceleration spring.b spring.c joint.kA.x joint.kA.y "
            "joint.jB.x t.x:acceleration");
    for (int i = 0; i < 14 && ready; i++) {
        const double w = 1.0 * pow(1.7, i);
        response_at(t, &base, w);
        response_at(t, &table, w);
        for (int o = 0; o < 7; o++) {
            const double complex want = table.s.h[o] / table.s.h[7];
            mt_test_row(t, "w = %g, %s", w, base.r.ports.out[o].name);
            CHECK_NEAR_ABS(t, cabs(base.s.h[o] - want), 0.0, TOL * cabs(want));
        }
    }
    done(&base);
    done(&table);
}

/* A link and a body on it, all numbers of the damping expressions. */
#define ALL(damping)                                                                         \
    "{ \"format\": \"modetune-model/1\", \"name\": \"d\", \"dimension\": 2,"                 \
    "  \"parameters\": { \"m\": 2, \"k\": 60, \"l\": 0.5, \"eta\": 0.05, \"p\": 0.004,"      \
    "    \"z\": 0.02, \"c\": 0.3 },"                                                         \
    "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": \"m\", \"inertia_kg_m2\": 0.02,"        \
    "                  \"centre\": [\"l/2\", 0.1] },"                                        \
    "                { \"name\": \"b\", \"mass_kg\": 0.5, \"inertia_kg_m2\": 0.01,"          \
    "                  \"centre\": [\"l + 0.1\", 0.2] } ],"                                  \
    "  \"joints\": [ { \"name\": \"p\", \"type\": \"revolute\", \"bodies\": [\"ground\","    \
    "                  \"a\"], \"at\": [0, 0] },"                                            \
    "                { \"name\": \"q\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"]," \
    "                  \"at\": [\"l\", 0.1] } ],"                                            \
    "  \"springs\": [ { \"name\": \"s\", \"type\": \"torsion\", \"joint\": \"p\","           \
    "                   \"stiffness_n_m_per_rad\": \"k\", \"loss_factor\": \"eta\" },"       \
    "                 { \"name\": \"v\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"],"   \
    "                   \"at\": [[\"l\", 0.3], [\"l + 0.3\", 0.1]],"                         \
    "                   \"stiffness_n_per_m\": 400 } ],"                                     \
    "  \"dampers\": [ { \"name\": \"d\", \"type\": \"axial\", \"bodies\": [\"ground\", "     \
    "\"b\"],"                                                                                \
    "                   \"at\": [[\"l\", -0.4], [\"l + 0.2\", 0.1]],"                        \
    "                   \"damping_n_s_per_m\": \"c\" } ],"                                   \
    "  \"sensors\": [ { \"name\": \"e\", \"on\": \"b\", \"at\": [\"l + 0.2\", 0.2] } ],"     \
    "  \"damping\": {" damping "}, \"configurations\": { \"c\": {} } }"

static void damped__derivatives_are_slopes(mt_test *t)
{
    static const double W[] = {7.0, 11.8, 12.4, 60.0};
    slopes_agree(t,
                 &(const sloped){ALL("\"mass_per_s\": \"10*p\", \"stiffness_s\": \"p\""), NULL,
                                 "c", "m k l eta p c", "e.x base.y",
                                 "e.y:acceleration spring.s damper.d joint.p.x joint.q.y"},
                 W, 4);
    slopes_agree(t,
                 &(const sloped){ALL("\"ratio\": \"z\", \"ratios\": [\"2*z\"]"), NULL, "c",
                                 "m k l eta z", "e.x base.y",
                                 "e.y:velocity spring.s joint.p.x joint.q.y"},
                 W, 4);
}

/* Every kind of damping at once, loaded, and driven. */
static void damped__derivatives_hold_in_a_linkage_with_everything(mt_test *t)
{
    static const char *const CONFIGURATIONS[2] = {"all", "driven"};
    static const double W[] = {9.0, 40.0};
    for (int c = 0; c < 2; c++) {
        slopes_agree(t,
                     &(const sloped){
                         NULL, "damped_linkage", CONFIGURATIONS[c],
                         "a k m_c alpha c eta zeta rate lag", "base.x base.y",
                         "spring.coil damper.strut damper.oil joint.jA.x joint.jB.y joint.jC.x "
                         "joint.jS.y joint.jW.x"},
                     W, 2);
    }
}

/* A body on a bushing with a stiffness between all directions and loss, and on dampers. */
static const char ON_BUSHING[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"b\", \"dimension\": 3,"
    "  \"parameters\": { \"k\": 900, \"q\": 40, \"eta\": 0.06, \"c\": 0.8, \"h\": 0.1 },"
    "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": 2,"
    "                  \"inertia_kg_m2\": [0.02, 0.03, 0.04, 0.001, 0.002, -0.003],"
    "                  \"centre\": [0.05, 0.02, \"h\"] } ],"
    "  \"springs\": [ { \"name\": \"mount\", \"type\": \"bushing\","
    "                   \"bodies\": [\"ground\", \"a\"], \"at\": [0, 0, 0],"
    "                   \"loss_factor\": \"eta\", \"stiffness_matrix\": ["
    "                     [\"k\", 30, 5, 2, \"q\", 1], [30, 800, 7, -3, 4, 6],"
    "                     [5, 7, 700, 8, -2, 3], [2, -3, 8, 20, 1, 0.5],"
    "                     [\"q\", 4, -2, 1, 25, 0.7], [1, 6, 3, 0.5, 0.7, 30]] } ],"
    "  \"dampers\": [ { \"name\": \"oil\", \"type\": \"bushing\","
    "                   \"bodies\": [\"ground\", \"a\"], \"at\": [0, 0, 0],"
    "                   \"damping_n_s_per_m\": [\"c\", 0.5, \"2*c\"],"
    "                   \"damping_n_m_s_per_rad\": [0.02, 0.01, \"c/50\"] } ],"
    "  \"sensors\": [ { \"name\": \"o\", \"on\": \"a\", \"at\": [0, 0, 0],"
    "                   \"directions\": [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"] },"
    "                 { \"name\": \"t\", \"on\": \"a\", \"at\": [0.1, 0.2, 0.3] } ],"
    "  \"configurations\": { \"c\": {} } }";

/* Components are (1 + i eta) K, or s C, times the motion of the end that moves. */
static void damped__bushings_forces_are_stiffness_times_motion(mt_test *t)
{
    static const double K[6][6] = {{900, 30, 5, 2, 40, 1},  {30, 800, 7, -3, 4, 6},
                                   {5, 7, 700, 8, -2, 3},   {2, -3, 8, 20, 1, 0.5},
                                   {40, 4, -2, 1, 25, 0.7}, {1, 6, 3, 0.5, 0.7, 30}};
    static const double C[6] = {0.8, 0.5, 1.6, 0.02, 0.01, 0.016};
    static const double W[] = {9.0, 31.0, 80.0};
    asked q = {.rc = MT_OK};
    const bool ready =
        mech_must(t, mech_parse(t, ON_BUSHING), "c", "", &q.m) &&
        ask(t, &q, "t.x t.z",
            "o.x o.y o.z o.rx spring.mount.x spring.mount.y spring.mount.z spring.mount.rx "
            "damper.oil.x damper.oil.y damper.oil.z damper.oil.rz o.ry o.rz spring.mount.ry "
            "spring.mount.rz");
    static const int MOTION[6] = {0, 1, 2, 3, 12, 13};
    static const int FORCE[6] = {4, 5, 6, 7, 14, 15};
    static const int DAMPER[6] = {8, 9, 10, -1, -1, 11};
    for (int at = 0; at < 3 * 2 * 6 && ready; at++) {
        const double w = W[at / 12];
        const int c = at % 6;
        mt_test_row(t, "w = %g, input %d, component %d", w, at / 6 % 2, c);
        response_at(t, &q, w);
        const double complex *const h = q.s.h + ((ptrdiff_t)(at / 6 % 2) * 16);
        double complex want = 0.0;
        double size = 0.0;
        for (int j = 0; j < 6; j++) {
            want += mt_complex(K[c][j], 0.06 * K[c][j]) * h[MOTION[j]];
            size += fabs(K[c][j]) * cabs(h[MOTION[j]]);
        }
        CHECK_NEAR_ABS(t, cabs(h[FORCE[c]] - want), 0.0, TOL * size);
        if (DAMPER[c] >= 0) {
            CHECK_NEAR_ABS(t, cabs(h[DAMPER[c]] - (mt_complex(0.0, w * C[c]) * h[MOTION[c]])),
                           0.0, TOL * w * C[c] * cabs(h[MOTION[c]]));
        }
    }
    done(&q);
    slopes_agree(t,
                 &(const sloped){ON_BUSHING, NULL, "c", "k q eta c h", "t.x base.y",
                                 "spring.mount.x spring.mount.ry spring.mount.z damper.oil.rz"},
                 W, 3);
}

/* In the plane, and a turn about z alone. */
static void damped__bushings_have_three_components_in_the_plane(mt_test *t)
{
    static const char *const no_turns[2] = {"spring.m.rz", "spring.m.z"};
    static const char plane[] =
        "{ \"format\": \"modetune-model/1\", \"name\": \"p\", \"dimension\": 2,"
        "  \"bodies\": [ { \"name\": \"a\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.1,"
        "                  \"centre\": [0.1, 0.2] } ],"
        "  \"springs\": [ { \"name\": \"m\", \"type\": \"bushing\","
        "                   \"bodies\": [\"ground\", \"a\"], \"at\": [0, 0],"
        "                   \"stiffness_n_per_m\": [800, 900],"
        "                   \"stiffness_n_m_per_rad\": 30 } ],"
        "  \"sensors\": [ { \"name\": \"o\", \"on\": \"a\", \"at\": [0, 0],"
        "                   \"directions\": [\"x\", \"y\", \"r\"] } ],"
        "  \"configurations\": { \"c\": {} } }";
    static const double K[3] = {800, 900, 30};
    asked q = {.rc = MT_OK};
    if (mech_must(t, mech_parse(t, plane), "c", "", &q.m) &&
        ask(t, &q, "o.x", "o.x o.y o.r spring.m.x spring.m.y spring.m.r")) {
        response_at(t, &q, 25.0);
        for (int c = 0; c < 3; c++) {
            CHECK_NEAR_ABS(t, cabs(q.s.h[3 + c] - (K[c] * q.s.h[c])), 0.0,
                           TOL * K[c] * cabs(q.s.h[c]));
        }
        for (int i = 0; i < 2; i++) {
            mt_port port;
            CHECK(t, mt_port_output(q.m.a->sys, no_turns[i], &q.r.mem, &port, &q.m.err) ==
                         MT_E_USAGE);
        }
    }
    done(&q);
}

/* Ratios of modes leave the modes what they are: still diagonal, each alone. */
static void damped__ratios_are_diagonal(mt_test *t)
{
    static const char *const DAMPING[2] = {ALL("\"ratio\": 0.03"),
                                           ALL("\"mass_per_s\": 0.1, \"stiffness_s\": 1e-4")};
    for (int i = 0; i < 2; i++) {
        asked q = {.rc = MT_OK};
        if (mech_must(t, mech_parse(t, DAMPING[i]), "c", "c eta", &q.m)) {
            const double none[2] = {0.0, 0.0};
            const mt_analysis_options opt = all_modes(false);
            CHECK(t, mt_analysis_solve(q.m.a, none, &opt, &q.m.err) == MT_OK);
            CHECK(t, ask(t, &q, "e.x", "e.y joint.p.x") && q.r.basis.t.diagonal);
            response_at(t, &q, 11.0);
        }
        done(&q);
    }
}

MT_TEST_MAIN(MT_TEST(damped__one_mass_matches_its_closed_form),
             MT_TEST(damped__moving_ground_is_a_table_that_moves),
             MT_TEST(damped__derivatives_are_slopes),
             MT_TEST(damped__derivatives_hold_in_a_linkage_with_everything),
             MT_TEST(damped__bushings_forces_are_stiffness_times_motion),
             MT_TEST(damped__bushings_have_three_components_in_the_plane),
             MT_TEST(damped__ratios_are_diagonal))
