/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rods between ball joints, stated in every way: a distance joint, with or without mass_kg, or
 * a body between two spherical joints whose inertia about its own axis is 0.
 *   bob M on a uniform rod m, l                       omega^2 = g (M + m/2)/(l (M + m/3))
 *   a plate hung on four rods, any direction          the same frequencies however the rods are
 *                                                     stated
 * The spin of a thin body about its axis is idle: not a freedom, whatever else the body carries
 * on its axis.
 */
#include "mechanics/mech.h"
#include "mt_writer.h"

/* Different elimination, the same mechanism: rounding of some 30 states, and what equilibrium
 * leaves of soft freedoms. */
static const double TOL = 1e-10;

enum { RODS = 4, TEXT = 8000 };

static const double LOW[RODS][3] = {
    {0.3, 0.2, 0.0}, {-0.3, 0.25, 0.02}, {-0.25, -0.3, 0.0}, {0.28, -0.2, -0.03}};
static const double HIGH[RODS][3] = {
    {0.32, 0.18, 0.71}, {-0.21, 0.27, 0.64}, {-0.2, -0.33, 0.58}, {0.2, -0.27, 0.6}};

typedef enum rod_kind { DISTANCE, DISTANCE_MASS, BODY, THIN_BODY, SOLID_BODY } rod_kind;

static void add_body(mt_writer *w, rod_kind kind, int i)
{
    double d[3];
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        d[k] = HIGH[i][k] - LOW[i][k];
        square += d[k] * d[k];
    }
    mt_write(w, ", {\"name\": \"rod%d\", \"centre\": [%.17g, %.17g, %.17g], ", i,
             0.5 * (HIGH[i][0] + LOW[i][0]), 0.5 * (HIGH[i][1] + LOW[i][1]),
             0.5 * (HIGH[i][2] + LOW[i][2]));
    if (kind == BODY) {
        mt_write(w, "\"inertia_kg_m2\": [0, 0, 0]}");
        return;
    }
    const double spin = kind == SOLID_BODY ? 1e-3 : 0.0; /* s a a^T */
    mt_write(w, "\"mass_kg\": \"m\", \"inertia_kg_m2\": [");
    for (int k = 0; k < 6; k++) {
        static const int AT[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
        const int p = AT[k][0];
        const int q = AT[k][1];
        mt_write(w, "%s\"m/12*%.17g + %.17g\"", k == 0 ? "" : ", ",
                 (p == q ? square : 0.0) - (d[p] * d[q]), spin * d[p] * d[q] / square);
    }
    mt_write(w, "]}");
}

static void add_joint(mt_writer *w, rod_kind kind, int i)
{
    const double *const a = LOW[i];
    const double *const b = HIGH[i];
    const char *const comma = i == 0 ? "" : ", ";
    if (kind <= DISTANCE_MASS) {
        mt_write(w,
                 "%s{\"name\": \"r%d\", \"type\": \"distance\", \"bodies\": [\"plate\", "
                 "\"ground\"], "
                 "\"at\": [[%.17g, %.17g, %.17g], [%.17g, %.17g, %.17g]]%s}",
                 comma, i, a[0], a[1], a[2], b[0], b[1], b[2],
                 kind == DISTANCE ? "" : ", \"mass_kg\": \"m\"");
        return;
    }
    mt_write(
        w,
        "%s{\"name\": \"low%d\", \"type\": \"spherical\", \"bodies\": [\"plate\", \"rod%d\"], "
        "\"at\": [%.17g, "
        "%.17g, %.17g]}, {\"name\": \"high%d\", \"type\": \"spherical\", \"bodies\": "
        "[\"rod%d\", \"ground\"], "
        "\"at\": [%.17g, %.17g, %.17g]}",
        comma, i, i, a[0], a[1], a[2], i, i, b[0], b[1], b[2]);
}

static mt_model *hung_plate(mt_test *t, rod_kind kind, double g)
{
    static char text[TEXT];
    mt_writer w = {.text = text, .room = TEXT};
    mt_write(
        &w,
        "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"gravity_m_per_s2\": [0, 0, "
        "%g], "
        "\"parameters\": {\"m\": 0.3}, \"bodies\": [{\"name\": \"plate\", \"mass_kg\": 5, "
        "\"inertia_kg_m2\": [0.3, 0.4, 0.6], \"centre\": [0.01, -0.02, -0.05]}",
        -g);
    for (int i = 0; i < RODS && kind >= BODY; i++) {
        add_body(&w, kind, i);
    }
    mt_write(&w, "], \"joints\": [");
    for (int i = 0; i < RODS; i++) {
        add_joint(&w, kind, i);
    }
    mt_write(&w,
             "], \"springs\": [{\"name\": \"k\", \"type\": \"bushing\", \"bodies\": "
             "[\"ground\", \"plate\"], \"at\": "
             "[0, 0, 0], \"stiffness_n_per_m\": [300, 500, 2000], \"stiffness_n_m_per_rad\": "
             "[0, 0, 20]}]}");
    return mech_parse(t, w.text);
}

static void rods__of_every_kind_give_one_mechanism(mt_test *t)
{
    static const struct {
        const char *name;
        rod_kind kind;
        rod_kind reference;
        int free_spins;
        int rigid;
    } rows[] = {
        {"without mass", BODY, DISTANCE, RODS, 0},
        {"thin", THIN_BODY, DISTANCE_MASS, RODS, 0},
        {"with inertia about the axis", SOLID_BODY, DISTANCE_MASS, 0, RODS},
    };
    for (int i = 0; i < 2 * MT_COUNT(rows); i++) {
        const double g = i % 2 == 0 ? 0.0 : 9.81;
        mech s;
        mech reference;
        mt_test_row(t, "%s, g = %g", rows[i / 2].name, g);
        if (mech_must(t, hung_plate(t, rows[i / 2].reference, g), NULL, "", &reference) &&
            mech_must(t, hung_plate(t, rows[i / 2].kind, g), NULL, "", &s)) {
            const double hz[2] = {mech_hz(&reference, 1), mech_hz(&reference, 2)};
            CHECK_INT(t, mt_linear_free_spins(s.a->lin, NULL), rows[i / 2].free_spins);
            mech_expect(t, &s, 2, hz, rows[i / 2].rigid, TOL);
            mech_free(&s);
        }
        mech_free(&reference);
    }
}

static void rods__with_mass_swing_as_rods_do(mt_test *t)
{
    static const char *const models[] = {
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.81],"
        " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 2, \"centre\": [0, -0.7]}],"
        " \"joints\": [{\"name\": \"rod\", \"type\": \"distance\", \"bodies\": [\"ground\", "
        "\"bob\"], "
        "\"at\": [[0, 0], [0, -0.7]], \"mass_kg\": 1.5}]}",
        "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"gravity_m_per_s2\": [0, 0, "
        "-9.81],"
        " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 2, \"centre\": [0, 0, -0.7]}],"
        " \"joints\": [{\"name\": \"rod\", \"type\": \"distance\", \"bodies\": [\"bob\", "
        "\"ground\"], "
        "\"at\": [[0, 0, -0.7], [0, 0, 0]], \"mass_kg\": 1.5}]}"};
    const double hz = sqrt(9.81 * 2.75 / (0.7 * 2.5)) / (2.0 * MECH_PI);
    for (int i = 0; i < MT_COUNT(models); i++) {
        mech s;
        if (mech_must(t, mech_parse(t, models[i]), NULL, "", &s)) {
            mech_expect(t, &s, i + 1, (const double[2]){hz, hz}, 0, TOL);
        }
        mech_free(&s);
    }
}

/* All elements of a straight link between two ball joints turn together; a hinge, a spring at
 * the side or a mass off the axis ends that. */
static void rods__spin_idly_as_a_whole_or_not_at_all(mt_test *t)
{
    static const char model[] =
        "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"parameters\": {\"r\": 0},"
        " \"bodies\": [{\"name\": \"pin\", \"inertia_kg_m2\": [0, 0, 0], \"centre\": [0.4, 0, "
        "0], \"in\": [\"pinned\"]}],"
        " \"links\": [{\"name\": \"rod\", \"from\": [0, 0, 0], \"to\": [0.9, 0, 0], "
        "\"elements\": 3, \"mass_kg\": 2, "
        "\"stiffness_n_m_per_rad\": 50, \"hinge_axis\": [0, 0, 1], \"radius_of_gyration_m\": "
        "\"r\"}],"
        " \"joints\": [{\"name\": \"a\", \"type\": \"spherical\", \"bodies\": [\"ground\", "
        "\"rod.start\"], \"at\": [0, 0, 0]},"
        "  {\"name\": \"b\", \"type\": \"point-on-line\", \"bodies\": [\"ground\", "
        "\"rod.end\"], \"at\": [0.9, 0, 0], \"axis\": [1, 0, 0]},"
        "  {\"name\": \"c\", \"type\": \"fixed\", \"bodies\": [\"rod.2\", \"pin\"], \"at\": "
        "[0.4, 0, 0], \"in\": [\"pinned\"]}],"
        " \"springs\": [{\"name\": \"side\", \"type\": \"bushing\", \"bodies\": [\"ground\", "
        "\"rod.2\"], \"at\": [0.45, 0, 0.1], "
        "\"stiffness_n_per_m\": [0, 0, 0], \"stiffness_n_m_per_rad\": [4, 0, 0], \"in\": "
        "[\"held\"]},"
        "  {\"name\": \"centre\", \"type\": \"axial\", \"bodies\": [\"ground\", \"rod.2\"], "
        "\"at\": [[0.45, 0.3, 0.2], "
        "[0.45, 0, 0]], \"stiffness_n_per_m\": 70, \"in\": [\"sprung\"]}],"
        " \"configurations\": {\"idle\": {}, \"thick\": {\"parameters\": {\"r\": 0.01}}, "
        "\"pinned\": {}, \"sprung\": {}, "
        "\"held\": {}}}";
    static const struct {
        const char *name;
        int free_spins;
        int rigid;
    } rows[] = {
        {"idle", 1, 0},
        {"thick", 0, 1},
        {"pinned", 1, 0},
    };
    double hz[3] = {0.0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].name);
        if (mech_must(t, mech_parse(t, model), rows[i].name, "", &s)) {
            CHECK_INT(t, mt_linear_free_spins(s.a->lin, NULL), rows[i].free_spins);
            for (int k = 0; k < 2 && i == 0; k++) {
                hz[k] = mech_hz(&s, k + 1);
            }
            CHECK_INT(t, s.a->modes.n_rigid, rows[i].rigid);
            for (int k = 0; k < 2; k++) {
                CHECK_NEAR(t, mech_hz(&s, k + 1), hz[k], TOL);
            }
        }
        mech_free(&s);
    }
    mech s;
    mt_test_row(t, "sprung: a spring to a point of the axis leaves it idle");
    if (mech_must(t, mech_parse(t, model), "sprung", "", &s)) {
        CHECK_INT(t, mt_linear_free_spins(s.a->lin, NULL), 1);
    }
    mech_free(&s);
    mt_test_row(t, "held: a torsional spring holds it, and it is condensed");
    if (mech_must(t, mech_parse(t, model), "held", "", &s)) {
        CHECK_INT(t, mt_linear_free_spins(s.a->lin, NULL), 0);
        CHECK_INT(t, s.a->modes.n_condensed, 1);
    }
    mech_free(&s);
}

#define CRANKS                                                                           \
    "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"gravity_m_per_s2\": [0, 0, " \
    "-9.81], \"parameters\": "                                                           \
    "{\"m\": 0.4}, \"bodies\": ["                                                        \
    " {\"name\": \"crank\", \"mass_kg\": 1, \"inertia_kg_m2\": [0.01, 0.01, 0.01], "     \
    "\"centre\": [0.05, 0, 0.02]},"                                                      \
    " {\"name\": \"rocker\", \"mass_kg\": 1.5, \"inertia_kg_m2\": [0.02, 0.02, 0.02], "  \
    "\"centre\": [0.5, 0.3, 0.1]}"
#define TURNS                                                                             \
    "\"joints\": ["                                                                       \
    " {\"name\": \"in\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"crank\"], "   \
    "\"at\": [0, 0, 0], \"axis\": [0, 0.2, 1]},"                                          \
    " {\"name\": \"out\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"rocker\"], " \
    "\"at\": [0.5, 0.3, 0], \"axis\": [0, 1, 0]},"
#define HELD                                                                                \
    "], \"springs\": [{\"name\": \"k\", \"type\": \"torsion\", \"joint\": \"out\", "        \
    "\"stiffness_n_m_per_rad\": 12},"                                                       \
    " {\"name\": \"servo\", \"type\": \"torsion\", \"joint\": \"in\", "                     \
    "\"stiffness_n_m_per_rad\": 30}],"                                                      \
    " \"configurations\": {\"free\": {}, \"forward\": {\"drive\": {\"joint\": \"in\", "     \
    "\"position_rad\": 1.5, \"hold\": "                                                     \
    "{\"trim\": \"servo\"}}}, \"back\": {\"drive\": {\"joint\": \"in\", \"position_rad\": " \
    "-1.5}}}}"

/* A spatial four-bar, crank and rocker joined by a thin rod between ball joints, over three
 * radians of its crank. The rod goes from (0.1, 0, 0.05) to (0.5, 0.3, 0.25). */
static void rods__couple_crank_and_rocker_in_every_position(mt_test *t)
{
    static const char distance[] = CRANKS
        "], " TURNS
        "{\"name\": \"rod\", \"type\": \"distance\", \"bodies\": [\"crank\", \"rocker\"], "
        "\"at\": [[0.1, 0, 0.05], [0.5, 0.3, 0.25]], \"mass_kg\": \"m\"}" HELD;
    static const char body[] = CRANKS
        ", {\"name\": \"rod\", \"mass_kg\": \"m\", \"centre\": [0.3, 0.15, 0.15], "
        "\"inertia_kg_m2\": "
        "[\"m/12*0.13\", \"m/12*0.2\", \"m/12*0.25\", \"-m/12*0.12\", \"-m/12*0.08\", "
        "\"-m/12*0.06\"]}], " TURNS "{\"name\": \"a\", \"type\": \"spherical\", \"bodies\": "
        "[\"crank\", \"rod\"], \"at\": [0.1, 0, 0.05]}, "
        "{\"name\": \"b\", \"type\": \"spherical\", \"bodies\": [\"rod\", \"rocker\"], \"at\": "
        "[0.5, 0.3, 0.25]}" HELD;
    static const char *const names[] = {"free", "forward", "back"};
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mech reference;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_parse(t, distance), names[i], "", &reference) &&
            mech_must(t, mech_parse(t, body), names[i], "", &s)) {
            const double hz = mech_hz(&reference, 1);
            CHECK_INT(t, mt_linear_free_spins(s.a->lin, NULL), 1);
            mech_expect(t, &s, i < 2 ? 1 : 0, &hz, 0, TOL);
            for (int k = 0; k < 2; k++) {
                CHECK_NEAR_ABS(t, creal(mt_linear_position(s.a->lin)->at.pose[k].x[2]),
                               creal(mt_linear_position(reference.a->lin)->at.pose[k].x[2]),
                               TOL);
            }
            mech_free(&s);
        }
        mech_free(&reference);
    }
}

/* A rod that dangles, and a lever on a hinge: something was forgotten. */
static void rods__that_nothing_holds_are_errors(mt_test *t)
{
    static const char *const joints[] = {
        "{\"name\": \"a\", \"type\": \"spherical\", \"bodies\": [\"ground\", \"rod\"], \"at\": "
        "[0, 0, 0]}",
        "{\"name\": \"a\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"rod\"], \"at\": "
        "[0, 0, 0], \"axis\": [0, 1, 0]}"};
    for (int i = 0; i < MT_COUNT(joints); i++) {
        char text[TEXT];
        mech s;
        mt_test_row(t, "%d", i);
        (void)snprintf(text, sizeof text,
                       "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"bodies\": "
                       "[{\"name\": \"rod\", "
                       "\"inertia_kg_m2\": [0, 0, 0], \"centre\": [0.2, 0, 0]}, {\"name\": "
                       "\"ball\", \"mass_kg\": 1, "
                       "\"centre\": [1, 0, 0]}], \"joints\": [%s]}",
                       joints[i]);
        CHECK(t, !mech_open(t, mech_parse(t, text), NULL, "", &s));
        CHECK_INT(t, s.rc, MT_E_MASSLESS);
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(rods__of_every_kind_give_one_mechanism),
             MT_TEST(rods__with_mass_swing_as_rods_do),
             MT_TEST(rods__spin_idly_as_a_whole_or_not_at_all),
             MT_TEST(rods__couple_crank_and_rocker_in_every_position),
             MT_TEST(rods__that_nothing_holds_are_errors))
