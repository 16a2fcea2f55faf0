/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What must not matter: where a model stands, in which order its parts are listed. And a closed
 * loop whose crank length is a variable. */
#include "mechanics/info.h"
#include "mechanics/mech.h"
#include "mt_writer.h"

enum { TEXT = 4000, MODES = 8 };

static const double TOL = 1e-10;

static const char *const FOUR_BAR[] = {"still", "loaded", "trimmed"};

static void invariance__turned_and_moved_four_bar(mt_test *t)
{
    for (int c = 0; c < MT_COUNT(FOUR_BAR); c++) {
        mech s;
        mt_test_row(t, "%s", FOUR_BAR[c]);
        if (mech_must(t, mech_load(t, "four_bar"), FOUR_BAR[c], "turn dx dy", &s)) {
            const double before = mech_hz(&s, 1);
            const mt_analysis_options opt = mt_analysis_options_default();
            for (int i = 1; i <= 6; i++) {
                const double x[3] = {(double)i, 0.3 * i, -0.7 * i};
                mt_test_row(t, "%s, turned by %d rad", FOUR_BAR[c], i);
                CHECK(t, mt_analysis_solve(s.a, x, &opt, &s.err) == MT_OK);
                CHECK_NEAR(t, mech_hz(&s, 1), before, TOL);
            }
        }
        mech_free(&s);
    }
}

/* A chain of four bodies on springs and hinges, its parts listed in a given order. */
static mt_model *chain(mt_test *t, const int order[4])
{
    char text[TEXT];
    mt_writer w = {text, sizeof text, 0};
    mt_write(&w, "{\"format\": \"modetune-model/1\", \"dimension\": 2, "
                 "\"gravity_m_per_s2\": [0, -9.81], \"bodies\": [");
    for (int i = 0; i < 4; i++) {
        const int b = order[i];
        mt_write(&w,
                 "%s{\"name\": \"b%d\", \"mass_kg\": %d, \"inertia_kg_m2\": "
                 "0.0%d, \"centre\": [%g, %g]}",
                 i == 0 ? "" : ", ", b, b + 1, b + 1, 0.1 + 0.2 * b, -0.1 * b);
    }
    mt_write(&w, "], \"joints\": [");
    for (int i = 3; i >= 0; i--) {
        const int b = order[i];
        static const char *const carrier[4] = {"ground", "b0", "b1", "b2"};
        mt_write(&w,
                 "%s{\"name\": \"j%d\", \"type\": \"revolute\", \"bodies\": "
                 "[\"%s\", \"b%d\"], \"at\": [%g, %g]}",
                 i == 3 ? "" : ", ", b, carrier[b], b, 0.2 * b, -0.1 * b + 0.05);
    }
    mt_write(&w, "], \"springs\": [");
    for (int i = 0; i < 4; i++) {
        mt_write(&w,
                 "%s{\"name\": \"k%d\", \"type\": \"torsion\", \"joint\": "
                 "\"j%d\", \"stiffness_n_m_per_rad\": %d}",
                 i == 0 ? "" : ", ", order[i], order[i], 100 + 20 * order[i]);
    }
    mt_write(&w, "]}");
    return mech_parse(t, text);
}

static void invariance__order_of_bodies_joints_and_springs(mt_test *t)
{
    static const int orders[][4] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {2, 0, 3, 1}, {1, 3, 0, 2}};
    double first[4] = {0.0};
    for (int o = 0; o < MT_COUNT(orders); o++) {
        mech s;
        mt_test_row(t, "order %d", o);
        if (mech_must(t, chain(t, orders[o]), NULL, "", &s)) {
            CHECK_INT(t, s.a->modes.count, 4);
            for (int i = 0; i < 4; i++) {
                first[i] = o == 0 ? mech_hz(&s, i + 1) : first[i];
                CHECK_NEAR(t, mech_hz(&s, i + 1), first[i], TOL);
            }
        }
        mech_free(&s);
    }
}

static double distance(const mt_pose *a, const mt_pose *b)
{
    return hypot(creal(a->x[0] - b->x[0]), creal(a->x[1] - b->x[1]));
}

/* The crank is drawn for 0.15 m; at other lengths the loop closes and the bodies keep their
 * size. */
static void loop__closes_for_other_crank_lengths(mt_test *t)
{
    mech s;
    if (mech_must(t, mech_load(t, "four_bar"), "loaded", "a", &s)) {
        const mt_analysis_options opt = mt_analysis_options_default();
        const double at_drawn = mech_hz(&s, 1);
        for (int i = 0; i < 8; i++) {
            const double a = 0.10 + 0.012 * i;
            mt_test_row(t, "crank of %g m", a);
            CHECK(t, mt_analysis_solve(s.a, &a, &opt, &s.err) == MT_OK);
            const mt_state *const p = mt_linear_position(s.a->lin);
            const mt_pose ground = mt_pose_ground();
            CHECK(t, p->gap_m <= 1e-14);
            CHECK_NEAR(t, distance(&p->at.pose[0], &ground), a / 2.0, 1e-12);
            CHECK(t, fabs(mech_hz(&s, 1) / at_drawn - 1.0) > 1e-4);
        }
        const double too_long = 1.2; /* 0.4 + 0.296 + 0.255 m reach */
        CHECK(t, mt_analysis_solve(s.a, &too_long, &opt, &s.err) == MT_E_ASSEMBLY);
        CHECK(t, mt_analysis_solve(s.a, s.at, &opt, &s.err) == MT_OK); /* and back */
        CHECK_NEAR(t, mech_hz(&s, 1), at_drawn, 1e-12);
    }
    mech_free(&s);
}

static void info__masses_of_plane_and_space(mt_test *t)
{
    mech s;
    mt_info info;
    if (mech_must(t, mech_load(t, "pendulum"), "twice", "", &s)) {
        CHECK(t, mt_info_fill(s.a->lin, &info, &s.err) == MT_OK);
        CHECK_INT(t, info.states, 3);
        CHECK_INT(t, info.equations, 4);
        CHECK_INT(t, info.freedoms, 1);
        CHECK_INT(t, info.redundant, 2);
        CHECK_NEAR(t, info.mass_kg, 1.0, 1e-14);
        CHECK_NEAR_ABS(t, info.centre_m[0], 0.0, 1e-14);
        CHECK_NEAR(t, info.centre_m[1], -0.5, 1e-14);
        CHECK_NEAR(t, info.inertia_kg_m2[2], (1.0 + 0.0025) / 12.0, 1e-13);
        CHECK_NEAR_ABS(t, info.inertia_kg_m2[0], 0.0, 0.0);
    }
    mech_free(&s);
    if (mech_must(t, mech_load(t, "space_four_bar"), "loaded", "", &s)) {
        CHECK(t, mt_info_fill(s.a->lin, &info, &s.err) == MT_OK);
        CHECK_NEAR(t, info.mass_kg, 3.8, 1e-14);
        CHECK_INT(t, info.freedoms, 1);
        CHECK_INT(t, info.redundant, 3);
        CHECK(t, info.residual <= 1e-11);
        /* all in the plane z = 0: zz = xx + yy of the points plus the bodies' own tensors */
        CHECK_NEAR_ABS(t, info.centre_m[2], 0.0, 1e-15);
        double own = 0.0;
        double moved = 0.0;
        static const double M[3] = {1.0, 2.0, 0.8};
        static const double ZZ[3] = {0.15 * 0.15 / 12.0, 0.02, 0.005};
        for (int b = 0; b < 3; b++) {
            const mt_pose *const p = &mt_linear_position(s.a->lin)->at.pose[b];
            own += ZZ[b];
            moved += M[b] * (pow(creal(p->x[0]) - info.centre_m[0], 2.0) +
                             pow(creal(p->x[1]) - info.centre_m[1], 2.0));
        }
        CHECK_NEAR(t, info.inertia_kg_m2[2], own + moved, 1e-12);
        CHECK_NEAR_ABS(t, info.inertia_kg_m2[4], 0.0, 1e-15);
    }
    mech_free(&s);
    if (mech_must(t, mech_load(t, "space_frame"), "weightless", "", &s)) {
        const double length = sqrt(0.81 + 0.09 + 0.04);
        const double bar = sqrt(0.16 + 0.81 + 0.01) * 1e-6 * 2700.0;
        CHECK(t, mt_info_fill(s.a->lin, &info, &s.err) == MT_OK);
        CHECK_NEAR(t, info.mass_kg, 0.4 + 2700.0 * 0.1 * 0.08 * length + bar, 1e-12);
    }
    mech_free(&s);
}

/* One body: its own tensor comes back, products of inertia included. */
static void info__tensor_of_one_body(mt_test *t)
{
    mech s;
    mt_info info;
    mt_model *const model = mech_parse(
        t, "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"bodies\": [{\"name\": "
           "\"b\", \"mass_kg\": 2,"
           "\"inertia_kg_m2\": [1, 2, 2.5, 0.1, -0.2, 0.3], \"centre\": [0.3, -0.4, 0.5]}]}");
    static const double want[6] = {1.0, 2.0, 2.5, 0.1, -0.2, 0.3};
    if (mech_must(t, model, NULL, "", &s)) {
        CHECK(t, mt_info_fill(s.a->lin, &info, &s.err) == MT_OK);
        CHECK_NEAR(t, info.centre_m[0], 0.3, 1e-14);
        CHECK_NEAR(t, info.centre_m[1], -0.4, 1e-14);
        CHECK_NEAR(t, info.centre_m[2], 0.5, 1e-14);
        for (int k = 0; k < 6; k++) {
            CHECK_NEAR(t, info.inertia_kg_m2[k], want[k], 1e-13);
        }
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(invariance__turned_and_moved_four_bar),
             MT_TEST(invariance__order_of_bodies_joints_and_springs),
             MT_TEST(loop__closes_for_other_crank_lengths),
             MT_TEST(info__masses_of_plane_and_space), MT_TEST(info__tensor_of_one_body))
