/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Three dimensions: closed forms of one body, planar mechanisms in space. */
#include "linalg/dense.h"
#include "mechanics/linear.h"
#include "mechanics/mech.h"

enum { TEXT = 4000 };

static const double TOL = 1e-9;

static void space__one_body_on_bushings(mt_test *t)
{
    static const struct {
        const char *configuration;
        double hz[3];
        int n;
        int rigid;
    } rows[] = {
        {"translation", {5.03292121, 10.06584242, 15.09876363}, 3, 3},
        {"rotation", {5.03292121, 7.11762543, 8.71727525}, 3, 3},
        {"ball", {3.55881272, 5.81151683, 8.71727525}, 3, 0},
        {"hinge", {5.81151683, 0, 0}, 1, 0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mech s;
        mt_test_row(t, "%s", rows[i].configuration);
        if (mech_must(t, mech_load(t, "space_body"), rows[i].configuration, "", &s)) {
            mech_expect(t, &s, rows[i].n, rows[i].hz, rows[i].rigid, 1e-8);
        }
        mech_free(&s);
    }
}

/* xdd = -M^-1 (K x + C xd) as a first-order system: eigenvalues -zeta w +- i w sqrt(1 -
 * zeta^2). */
static bool damped_roots(mt_linear *lin, mt_arena *mem, double *wr, double *wi, mt_err *err)
{
    const int n = mt_linear_freedoms(lin);
    const size_t size = (size_t)n;
    double *const a = mt_arena_f64(mem, 2 * size, 2 * size);
    double *const m = mt_arena_f64(mem, size, size);
    double *const kc = mt_arena_f64(mem, size, 2 * size); /* K beside C, then M^-1 of both */
    memcpy(m, mt_linear_reduced(lin).m, size * size * sizeof *m);
    memcpy(kc, mt_linear_reduced(lin).k, size * size * sizeof *kc);
    mt_linear_damping(lin, kc + size * size);
    if (mt_lu_solve(n, m, 2 * n, kc, NULL, mem, err) != MT_OK) {
        return false;
    }
    for (size_t j = 0; j < 2 * size; j++) {
        for (size_t i = 0; i < size; i++) {
            a[i + 2 * size * j] = j == i + size ? 1.0 : 0.0;
            a[size + i + 2 * size * j] = -kc[i + size * j];
        }
    }
    return mt_eig_general(2 * n, a, wr, wi, NULL, mem, err) == MT_OK;
}

static void space__dampers_enter_the_damping_matrix(mt_test *t)
{
    static const double HZ[3] = {3.53650019, 5.71383732, 8.38400687};
    static const double PERCENT[3] = {11.180339887, 18.257418584, 27.386127875};
    mt_arena mem;
    mech s;
    mt_err err = {.text = ""};
    REQUIRE(t, mt_arena_init(&mem, 0, &err) == MT_OK);
    if (mech_must(t, mech_load(t, "space_body"), "damped", "", &s)) {
        double wr[6];
        double wi[6];
        CHECK_INT(t, mt_linear_freedoms(s.a->lin), 3);
        CHECK(t, damped_roots(s.a->lin, &mem, wr, wi, &s.err));
        for (int k = 0; k < 3; k++) {
            double nearest = HUGE_VAL;
            double percent = 0.0;
            for (int i = 0; i < 6; i++) {
                const double off = fabs(wi[i] / (2.0 * MECH_PI) / HZ[k] - 1.0);
                if (off < nearest) {
                    nearest = off;
                    percent = -100.0 * wr[i] / hypot(wr[i], wi[i]);
                }
            }
            mt_test_row(t, "mode %d", k + 1);
            CHECK(t, nearest <= 1e-8);
            CHECK_NEAR(t, percent, PERCENT[k], 1e-9);
        }
    }
    mech_free(&s);
    mt_arena_free(&mem);
}

/* Stiffness from the constraint force alone: the body hangs on a string at its centre. */
static void space__body_hangs_on_a_string(mt_test *t)
{
    const double hz = sqrt(9.81) / (2.0 * MECH_PI);
    mech s;
    CHECK_NEAR(t, hz, 0.49848792, 1e-8);
    if (mech_must(t, mech_load(t, "space_body"), "hanging", "", &s)) {
        mech_expect(t, &s, 2, (const double[]){hz, hz}, 3, TOL);
    }
    mech_free(&s);
}

static void space__planar_four_bar_with_redundant_hinges(mt_test *t)
{
    static const char *const names[] = {"loaded", "trimmed"};
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech plane;
        mech space;
        mt_test_row(t, "%s", names[i]);
        const bool both = mech_must(t, mech_load(t, "four_bar"), names[i], "", &plane) &&
                          mech_must(t, mech_load(t, "space_four_bar"), names[i], "", &space);
        if (both) {
            mt_joint_names joints = {.text = ""};
            CHECK_INT(t, mt_linear_redundant(space.a->lin), 3);
            CHECK(t, mt_linear_redundant_set(space.a->lin, 0, &space.a->mem, &joints,
                                             &space.err) == MT_OK);
            CHECK(t, strstr(joints.text, "\"jA\"") != NULL &&
                         strstr(joints.text, "\"jC\"") != NULL);
            CHECK_INT(t, space.a->modes.count, 1);
            CHECK_NEAR(t, mech_hz(&space, 1), mech_hz(&plane, 1), TOL);
            mech_free(&space);
        }
        mech_free(&plane);
    }
}

/* The same link in the plane and in space, pinned at its start. */
static mt_model *link_model(mt_test *t, int dimension, const char *kind, const char *extra)
{
    char text[TEXT];
    const bool space = dimension == 3;
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": %d,"
        "\"points\": {\"a\": [0.1, 0.2%s], \"b\": [0.9, 0.8%s]},"
        "\"links\": [{\"name\": \"l\", \"kind\": \"%s\", \"from\": \"a\", \"to\": \"b\", "
        "\"elements\": 4,"
        "\"youngs_modulus_pa\": 7e10, %s \"density_kg_per_m3\": 2700,"
        "\"section\": {\"shape\": \"rectangle\", \"width_m\": 0.03, \"height_m\": 0.02}}],"
        "\"joints\": [{\"name\": \"p\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
        "\"l.start\"], \"at\": \"a\"%s}]}",
        dimension, space ? ", 0" : "", space ? ", 0" : "", kind, extra,
        space ? ", \"axis\": [0, 0, 1]" : "");
    return mech_parse(t, text);
}

static void space__planar_links_keep_their_frequencies(mt_test *t)
{
    static const char *const kinds[] = {"rigid_elements", "beam"};
    for (int k = 0; k < MT_COUNT(kinds); k++) {
        const bool beam = k == 1;
        mech plane;
        mech space;
        mt_test_row(t, "%s", kinds[k]);
        const bool both =
            mech_must(t, link_model(t, 2, kinds[k], ""), NULL, "", &plane) &&
            mech_must(
                t,
                link_model(t, 3, kinds[k],
                           beam ? "\"hinge_axis\": [0, 0, 1], \"shear_modulus_pa\": 2.6e10,"
                                : "\"hinge_axis\": [0, 0, 1], \"radius_of_gyration_m\": 0.01,"),
                NULL, "", &space);
        if (both) {
            const int n = plane.a->modes.count - plane.a->modes.n_rigid;
            const int more = space.a->modes.count - space.a->modes.n_rigid;
            CHECK_INT(t, plane.a->modes.n_rigid, 1);
            CHECK_INT(t, space.a->modes.n_rigid, 1);
            CHECK(t, beam ? more > n : more == n);
            for (int i = 1; i <= n; i++) {
                double nearest = HUGE_VAL;
                for (int j = 1; j <= more; j++) {
                    nearest =
                        fmin(nearest, fabs(mech_hz(&space, j) / mech_hz(&plane, i) - 1.0));
                }
                CHECK(t, nearest <= TOL);
            }
            mech_free(&space);
        }
        mech_free(&plane);
    }
}

/* Clamped oblique beam in space: bending about both axes and torsion, against Euler-Bernoulli
 * and Saint-Venant. */
static void space__clamped_beam_bends_both_ways_and_twists(mt_test *t)
{
    static const double L = 1.3;
    static const double A = 6e-4;
    static const double I3 = 2e-8;
    static const double I2 = 4.5e-8;
    static const double J = 5e-8;
    char text[TEXT];
    mech s;
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 3,"
        "\"points\": {\"a\": [0.1, 0.2, 0.3], \"b\": [\"0.1 + 1.3*2/3\", \"0.2 + 1.3/3\", "
        "\"0.3 - 1.3*2/3\"]},"
        "\"links\": [{\"name\": \"l\", \"kind\": \"beam\", \"from\": \"a\", \"to\": \"b\", "
        "\"elements\": 16,"
        "\"youngs_modulus_pa\": 7e10, \"shear_modulus_pa\": 2.6e10, \"density_kg_per_m3\": "
        "2700, \"hinge_axis\": [1, 0, 1],"
        "\"section\": {\"shape\": \"general\", \"area_m2\": %g, \"second_moment_m4\": %g, "
        "\"second_moment_other_m4\": %g, \"torsion_constant_m4\": %g}}],"
        "\"joints\": [{\"name\": \"p\", \"type\": \"fixed\", \"bodies\": [\"ground\", "
        "\"l.start\"], \"at\": \"a\"}]}",
        A, I3, I2, J);
    if (mech_must(t, mech_parse(t, text), NULL, "", &s)) {
        const double root2 = 1.8751040687119611 * 1.8751040687119611;
        const double about3 =
            root2 * sqrt(7e10 * I3 / (2700.0 * A)) / (L * L) / (2.0 * MECH_PI);
        const double about2 =
            root2 * sqrt(7e10 * I2 / (2700.0 * A)) / (L * L) / (2.0 * MECH_PI);
        const double twist = sqrt(2.6e10 * J / (2700.0 * (I2 + I3))) / (4.0 * L);
        double nearest = HUGE_VAL;
        CHECK_NEAR(t, mech_hz(&s, 1), about3, 2e-7); /* (1.875/16)^4/1440 */
        CHECK_NEAR(t, mech_hz(&s, 2), about2, 2e-7);
        for (int i = 1; i <= s.a->modes.count; i++) {
            nearest = fmin(nearest, fabs(mech_hz(&s, i) / twist - 1.0));
        }
        CHECK(t, nearest < 1e-3); /* linear elements: (pi/32)^2/24 */
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(space__one_body_on_bushings), MT_TEST(space__body_hangs_on_a_string),
             MT_TEST(space__dampers_enter_the_damping_matrix),
             MT_TEST(space__planar_four_bar_with_redundant_hinges),
             MT_TEST(space__planar_links_keep_their_frequencies),
             MT_TEST(space__clamped_beam_bends_both_ways_and_twists))
