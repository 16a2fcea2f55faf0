/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/linear.h"
#include "mechanics/mech.h"

/* Eigenvalues of a few well-scaled freedoms: rounding is 1e-14, the printed references have ten
 * digits. */
static const double TOL = 1e-9;

static void closed_form__physical_pendulum_swings(mt_test *t)
{
    static const char *const names[] = {"hanging", "drawn_horizontal", "twice"};
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_load(t, "pendulum"), names[i], "", &s)) {
            mech_expect(t, &s, 1, (const double[]){0.6103298209}, 0, TOL);
        }
        mech_free(&s);
    }
}

static void closed_form__pendulum_upside_down_is_unstable(mt_test *t)
{
    mech s;
    if (mech_must(t, mech_load(t, "pendulum"), "upside_down", "", &s)) {
        const mt_modes *const m = &s.a->modes;
        const double omega = 2.0 * MECH_PI * 0.6103298209;
        CHECK_INT(t, m->n_unstable, 1);
        CHECK_INT(t, mt_modal_flexible(m, 1), -1);
        CHECK(t, isnan(mt_modal_hz(m, 0)));
        CHECK_NEAR(t, m->lambda[0], -omega * omega, TOL);
    }
    mech_free(&s);
}

static void closed_form__a_hinge_given_twice_is_named(mt_test *t)
{
    mech s;
    if (mech_must(t, mech_load(t, "pendulum"), "twice", "", &s)) {
        mt_joint_names joints = {.text = ""};
        CHECK_INT(t, mt_linear_redundant(s.a->lin), 2);
        for (int k = 0; k < mt_linear_redundant(s.a->lin); k++) {
            CHECK(t, mt_linear_redundant_set(s.a->lin, k, &s.a->mem, &joints, &s.err) == MT_OK);
            CHECK_STR(t, joints.text, "\"pivot\", \"pivot_again\"");
        }
    }
    mech_free(&s);
}

static void closed_form__double_pendulum_on_massless_links(mt_test *t)
{
    static const char *const names[] = {"distances", "rods"};
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_load(t, "double_pendulum"), names[i], "", &s)) {
            mech_expect(t, &s, 2, (const double[]){0.3815261337, 0.9210855665}, 0, TOL);
        }
        mech_free(&s);
    }
}

static void closed_form__eight_masses_on_an_oblique_line(mt_test *t)
{
    double hz[8];
    mech s;
    for (int k = 1; k <= 8; k++) {
        hz[k - 1] = sqrt(1e5 / 10.0) / MECH_PI * sin(k * MECH_PI / 18.0);
    }
    CHECK_NEAR(t, hz[0], 5.5273931669, TOL);
    CHECK_NEAR(t, hz[7], 31.3474043774, TOL);
    if (mech_must(t, mech_load(t, "eight_masses"), "guided", "", &s)) {
        mech_expect(t, &s, 8, hz, 0, TOL);
    }
    mech_free(&s);
    /* nothing holds the masses across the line */
    if (mech_must(t, mech_load(t, "eight_masses"), "loose", "", &s)) {
        mech_expect(t, &s, 8, hz, 8, TOL);
    }
    mech_free(&s);
}

static void closed_form__nine_discs_have_one_zero_mode(mt_test *t)
{
    double hz[8];
    mech s;
    for (int k = 1; k <= 8; k++) {
        hz[k - 1] = sqrt(50.0 / 0.02) / MECH_PI * sin(k * MECH_PI / 18.0);
    }
    if (mech_must(t, mech_load(t, "nine_discs"), NULL, "", &s)) {
        mech_expect(t, &s, 8, hz, 1, TOL);
    }
    mech_free(&s);
}

static void closed_form__ring_of_six_has_double_modes(mt_test *t)
{
    static const double hz[] = {15.9154943092, 15.9154943092, 27.5664447711, 27.5664447711,
                                31.8309886184};
    mech s;
    if (mech_must(t, mech_load(t, "ring"), NULL, "k", &s)) {
        double slope = 0.0;
        bool repeated = false;
        mt_analysis_options opt = mt_analysis_options_default();
        opt.gradient = true;
        mech_expect(t, &s, MT_COUNT(hz), hz, 1, TOL);
        REQUIRE(t, mt_analysis_solve(s.a, s.at, &opt, &s.err) == MT_OK);
        for (int pos = 0; pos < 6; pos++) {
            const bool pair = pos >= 1 && pos <= 4;
            mt_test_row(t, "mode %d", pos);
            CHECK(t, mt_analysis_dlambda(s.a, pos, &slope, &repeated, &s.err) == MT_OK);
            CHECK(t, repeated == pair);
            CHECK(t, isnan(slope) == pair);
        }
    }
    mech_free(&s);
}

static void closed_form__taut_string_is_stiff_across(mt_test *t)
{
    static const char *const names[] = {"preload", "free_length"};
    const double hz[] = {sqrt(2.0 * 50.0 / 0.5 / 0.2) / (2.0 * MECH_PI),
                         sqrt(2.0 * 2000.0 / 0.2) / (2.0 * MECH_PI)};
    for (int i = 0; i < MT_COUNT(names); i++) {
        mech s;
        mt_test_row(t, "%s", names[i]);
        if (mech_must(t, mech_load(t, "taut_string"), names[i], "", &s)) {
            mech_expect(t, &s, 2, hz, 0, TOL);
        }
        mech_free(&s);
    }
}

/* M = diag(..) and K of rod and disc (absolute angles), rod at angle a from hanging, its servo
 * stiffness k in force. */
static void driven_rod_pair(double k, double a, double hz[2])
{
    const double m = 2.0;
    const double l = 0.8;
    const double md = 0.5;
    const double jd = 0.004;
    const double kd = 3.0;
    const double inertia = m * l * l / 3.0 + md * l * l;
    const double k11 = k + kd + (0.5 * m + md) * l * 9.81 * cos(a);
    const double b = k11 / inertia + kd / jd;
    const double c = (k11 * kd - kd * kd) / (inertia * jd);
    const double high = 0.5 * (b + sqrt(b * b - 4.0 * c));
    hz[0] = sqrt(c / high) / (2.0 * MECH_PI);
    hz[1] = sqrt(high) / (2.0 * MECH_PI);
}

static void closed_form__driven_rod_is_locked_or_trimmed(mt_test *t)
{
    const double angle = MECH_PI / 6.0;
    double hz[2];
    mech s;
    if (mech_must(t, mech_load(t, "driven_rod"), "locked", "", &s)) {
        hz[0] = sqrt(3.0 / 0.004) / (2.0 * MECH_PI);
        mech_expect(t, &s, 1, hz, 0, TOL);
    }
    mech_free(&s);
    if (mech_must(t, mech_load(t, "driven_rod"), "trimmed", "", &s)) {
        driven_rod_pair(40.0, angle, hz);
        mech_expect(t, &s, 2, hz, 0, TOL);
        /* the servo carries the weight's moment */
        CHECK_NEAR(t, fabs(mt_linear_position(s.a->lin)->equilibrium.trim_force.of[0]),
                   (1.0 + 0.5) * 0.8 * 9.81 * sin(angle), TOL);
    }
    mech_free(&s);
    if (mech_must(t, mech_load(t, "driven_rod"), "sprung", "", &s)) {
        driven_rod_pair(40.0, 0.0, hz);
        mech_expect(t, &s, 2, hz, 0, TOL);
    }
    mech_free(&s);
}

/* The arm of driven_arm.json in its posture, in absolute angles of its three links. */
typedef struct arm {
    double m[3][3];
    double k[3][3];
    double moment[3]; /* dV/dphi of the weights */
} arm;

static arm arm_at(double s, double e)
{
    const double big = 0.5;
    const double little = 0.4;
    const double r = 0.1;
    const double upper = 2.0;
    const double fore = 1.2;
    const double hand = 0.5;
    const double spring[3] = {900.0, 400.0, 60.0};
    double wrist = 0.0; /* k w + g h r cos(s + e + w) = 0 */
    for (int i = 0; i < 60; i++) {
        wrist = -9.81 * hand * r * cos(s + e + wrist) / spring[2];
    }
    const double phi[3] = {s, s + e, s + e + wrist};
    const double arms[3] = {big * (0.5 * upper + fore + hand), little * (0.5 * fore + hand),
                            r * hand};
    arm a = {.m = {{upper * big * big / 3.0 + (fore + hand) * big * big,
                    arms[1] * big * cos(phi[0] - phi[1]), arms[2] * big * cos(phi[0] - phi[2])},
                   {0.0, fore * little * little / 3.0 + hand * little * little,
                    arms[2] * little * cos(phi[1] - phi[2])},
                   {0.0, 0.0, hand * r * r + 0.002}}};
    for (int i = 0; i < 3; i++) {
        a.moment[i] = 9.81 * arms[i] * cos(phi[i]);
        a.k[i][i] = spring[i] + (i < 2 ? spring[i + 1] : 0.0) - 9.81 * arms[i] * sin(phi[i]);
        for (int j = 0; j < i; j++) {
            a.m[i][j] = a.m[j][i];
            a.k[i][j] = j == i - 1 ? -spring[i] : 0.0;
            a.k[j][i] = a.k[i][j];
        }
    }
    return a;
}

/* det(K - lambda M) of the links from `first` on; the others are locked. */
static double arm_det(const arm *a, int first, double lambda)
{
    double b[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int i = first; i < 3; i++) {
        for (int j = first; j < 3; j++) {
            b[i][j] = a->k[i][j] - lambda * a->m[i][j];
        }
    }
    return b[0][0] * (b[1][1] * b[2][2] - b[1][2] * b[2][1]) -
           b[0][1] * (b[1][0] * b[2][2] - b[1][2] * b[2][0]) +
           b[0][2] * (b[1][0] * b[2][1] - b[1][1] * b[2][0]);
}

/* Each frequency is between two places of opposite sign of the determinant. */
static void check_arm(mt_test *t, const mech *s, int first)
{
    const arm a = arm_at(0.4, 0.9);
    CHECK_INT(t, mt_modal_vibrations(&s->a->modes), 3 - first);
    for (int i = 1; i <= 3 - first; i++) {
        const double lambda = pow(2.0 * MECH_PI * mech_hz(s, i), 2.0);
        const double below = arm_det(&a, first, lambda * (1.0 - TOL));
        const double above = arm_det(&a, first, lambda * (1.0 + TOL));
        CHECK(t, below * above < 0.0);
    }
}

static void closed_form__driven_arm_in_a_posture_of_two_joints(mt_test *t)
{
    static const struct {
        const char *posture;
        int locked; /* links, from the shoulder */
        int trims;
    } rows[] = {{"locked", 2, 0}, {"mixed", 1, 1}, {"trimmed", 0, 2}};
    const double drawn[] = {0.0, 0.3};
    for (int r = 0; r < 2 * MT_COUNT(rows); r++) {
        const arm a = arm_at(0.4, 0.9);
        const double hold[] = {a.moment[0] + a.moment[1] + a.moment[2],
                               a.moment[1] + a.moment[2]};
        const int trims = rows[r / 2].trims;
        mech s;
        mt_test_row(t, "%s, drawn at %g", rows[r / 2].posture, drawn[r % 2]);
        if (mech_must(t, mech_load(t, "driven_arm"), rows[r / 2].posture, "a b", &s)) {
            mt_analysis_options opt = mt_analysis_options_default();
            s.at[0] = drawn[r % 2];
            s.at[1] = -2.0 * drawn[r % 2];
            if (CHECK(t, mt_analysis_solve(s.a, s.at, &opt, &s.err) == MT_OK)) {
                check_arm(t, &s, rows[r / 2].locked);
            }
            const mt_state *const at = mt_linear_position(s.a->lin);
            CHECK_INT(t, s.a->sys->n_trims, trims);
            for (int i = 0; i < trims; i++) {
                CHECK_NEAR(t, -at->equilibrium.trim_force.of[i], hold[2 - trims + i], TOL);
            }
        }
        mech_free(&s);
    }
}

static void closed_form__massless_coordinate_is_condensed(mt_test *t)
{
    mech s;
    if (mech_must(t, mech_load(t, "massless"), "sprung", "", &s)) {
        const double k = 300.0 * 700.0 / 1000.0;
        CHECK_INT(t, s.a->modes.n_condensed, 1);
        mech_expect(t, &s, 1, (const double[]){sqrt(k / 2.0) / (2.0 * MECH_PI)}, 0, TOL);
    }
    mech_free(&s);
}

static void refused__massless_body_that_nothing_holds(mt_test *t)
{
    mech s;
    CHECK(t, !mech_open(t, mech_load(t, "massless"), "loose", "", &s));
    CHECK(t, s.rc == MT_E_MASSLESS);
    CHECK_STR(t, s.err.text,
              "configuration \"loose\": neither mass nor stiffness holds \"knot\" (along x): "
              "give it a mass, a spring, or a joint");
    mech_free(&s);
}

static void refused__free_fall_has_no_equilibrium(mt_test *t)
{
    mech s;
    CHECK(t, !mech_open(t, mech_load(t, "falling"), NULL, "", &s));
    CHECK(t, s.rc == MT_E_EQUILIBRIUM);
    CHECK(t, strstr(s.err.text, "free to move under load?") != NULL);
    CHECK(t, strstr(s.err.text, "\"block\" (along y)") != NULL);
    mech_free(&s);
}

static void refused__contradictory_distances_are_named(mt_test *t)
{
    mech s;
    CHECK(t, !mech_open(t, mech_load(t, "apart"), "contradiction", "", &s));
    CHECK(t, s.rc == MT_E_ASSEMBLY);
    CHECK(t, strstr(s.err.text, "joints \"near\", \"far\" contradict each other") != NULL);
    mech_free(&s);
}

static void refused__gap_is_named_by_its_joint(mt_test *t)
{
    mech s;
    CHECK(t, !mech_open(t, mech_load(t, "apart"), "gap", "", &s));
    CHECK(t, s.rc == MT_E_ASSEMBLY);
    CHECK(t, strstr(s.err.text, "wrist") != NULL);
    CHECK(t, strstr(s.err.text, "0.5 m") != NULL);
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(closed_form__physical_pendulum_swings),
             MT_TEST(closed_form__pendulum_upside_down_is_unstable),
             MT_TEST(closed_form__a_hinge_given_twice_is_named),
             MT_TEST(closed_form__double_pendulum_on_massless_links),
             MT_TEST(closed_form__eight_masses_on_an_oblique_line),
             MT_TEST(closed_form__nine_discs_have_one_zero_mode),
             MT_TEST(closed_form__ring_of_six_has_double_modes),
             MT_TEST(closed_form__taut_string_is_stiff_across),
             MT_TEST(closed_form__driven_rod_is_locked_or_trimmed),
             MT_TEST(closed_form__driven_arm_in_a_posture_of_two_joints),
             MT_TEST(closed_form__massless_coordinate_is_condensed),
             MT_TEST(refused__massless_body_that_nothing_holds),
             MT_TEST(refused__free_fall_has_no_equilibrium),
             MT_TEST(refused__contradictory_distances_are_named),
             MT_TEST(refused__gap_is_named_by_its_joint))
