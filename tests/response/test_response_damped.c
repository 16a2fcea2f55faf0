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
             MT_TEST(damped__ratios_are_diagonal))
