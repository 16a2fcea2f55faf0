/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Stiff springs: steps in which their vibrations are solved beforehand lead where the explicit
 * pair's many small ones do; and the stiffer a hinge is, the more two links swing as one body,
 * however far, which no explicit steps could show.
 */
#include <stdlib.h>

#include "simulate/motions.h"

enum { TEXT = 4000 };

/* Two links, a metre each, that hang from a pivot; the hinge between them has a spring, or
 * there is none and they are one (stiffness 0). */
static mt_model *two_links(mt_test *t, double stiffness)
{
    char text[TEXT];
    char hinge[TEXT / 4];
    if (stiffness > 0.0) {
        (void)snprintf(hinge, sizeof hinge,
                       "{\"name\": \"hinge\", \"type\": \"revolute\", \"bodies\": [\"a\", "
                       "\"b\"], \"at\": [0, -1]}], \"springs\": [{\"name\": \"k\", \"type\": "
                       "\"torsion\", \"joint\": \"hinge\", \"stiffness_n_m_per_rad\": %.17g}]",
                       stiffness);
    } else {
        (void)snprintf(hinge, sizeof hinge,
                       "{\"name\": \"weld\", \"type\": \"fixed\", \"bodies\": [\"a\", \"b\"], "
                       "\"at\": [0, -1]}]");
    }
    (void)snprintf(
        text, sizeof text,
        "{\"format\": \"modetune-model/1\", \"name\": \"two links\", \"dimension\": 2, "
        "\"gravity_m_per_s2\": [0, -9.81], \"bodies\": [{\"name\": \"a\", \"mass_kg\": 2, "
        "\"inertia_kg_m2\": 0.2, \"centre\": [0, -0.5]}, {\"name\": \"b\", \"mass_kg\": 1, "
        "\"inertia_kg_m2\": 0.1, \"centre\": [0, -1.5]}], \"joints\": [{\"name\": \"pivot\", "
        "\"type\": \"revolute\", \"bodies\": [\"ground\", \"a\"], \"at\": [0, 0]}, %s, "
        "\"sensors\": [{\"name\": \"tip\", \"on\": \"b\", \"at\": [0, -2], \"directions\": "
        "[\"x\", \"y\"]}]}",
        hinge);
    return mech_parse(t, text);
}

static void check_same(mt_test *t, const mt_sim_result *got, const mt_sim_result *want,
                       double tol)
{
    double most = 0.0;
    double off = 0.0;
    REQUIRE(t, got->n == want->n && got->n_gauges == want->n_gauges);
    for (ptrdiff_t i = 0; i < (ptrdiff_t)got->n * got->n_gauges; i++) {
        const double d = fabs(got->value[i] - want->value[i]);
        off = !(d <= off) ? d : off;
        most = fmax(most, fabs(want->value[i]));
    }
    CHECK(t, off <= tol * most);
    if (getenv("MT_TOL_SCALE") != NULL) {
        (void)fprintf(stderr,
                      "    off by %.1e of %.3g; %ld steps (%ld) of %ld evaluations, "
                      "explicit %ld of %ld; energy %.1e (%.1e) of %.3g J\n",
                      off, most, got->steps, got->stiff_steps, got->evaluations, want->steps,
                      want->evaluations, got->energy_error_j, want->energy_error_j,
                      got->energy_scale_j);
    }
}

/* The links in a line, at rest, turned by so much. */
static bool turn_line(mt_test *t, motion *m, double angle)
{
    const mt_sim_joint joints[] = {motion_joint(m, "pivot", angle),
                                   motion_joint(m, "hinge", 0.0)};
    const int n = joints[1].joint >= 0 ? 2 : 1;
    return motion_done(t, m, mt_start_joints(m->lin, n, joints, &m->mem, &m->start, &m->err));
}

/* Both ways, from where m is. */
static void both_ways(mt_test *t, motion *m, double duration, double tol, long times)
{
    if (!motion_run(t, m, duration, 0.1 * duration)) {
        return;
    }
    const mt_sim_result got = m->r;
    CHECK(t, got.stiff_steps == got.steps);
    CHECK(t, got.energy_error_j <= 1e-7 * got.energy_scale_j);
    m->opt.explicit_steps = true;
    if (motion_run(t, m, duration, 0.1 * duration)) {
        CHECK_INT(t, m->r.stiff_steps, 0);
        check_same(t, &got, &m->r, tol);
        CHECK(t, times * got.evaluations < m->r.evaluations);
    }
}

static void stiff__steps_lead_where_explicit_ones_do(mt_test *t)
{
    motion m;
    mt_test_row(t, "two links, pivot turned far");
    if (motion_open(t, two_links(t, 1e7), NULL, &m)) {
        motion_watch(t, &m, "tip.x");
        motion_watch(t, &m, "tip.y");
        motion_watch(t, &m, "hinge");
        if (turn_line(t, &m, 2.0)) {
            both_ways(t, &m, 0.05, 1e-8, 4);
        }
    }
    motion_free(&m);
    const mt_sine sine = {.amplitude = 10.0, .hz = 20.0};
    const mt_signal signal = {.kind = MT_SIGNAL_SINES, .n = 1, .sines = &sine};
    mt_test_row(t, "the inceptor under a sine");
    if (motion_open(t, mech_load(t, "../../problems/inceptor"), "installed", &m)) {
        const mt_sim_input in = {.push = MT_SIM_FORCE,
                                 .at = mt_system_find_channel(m.sys, "grip.y"),
                                 .signal = &signal};
        m.opt.n_inputs = 1;
        m.opt.inputs = &in;
        motion_watch(t, &m, "pivot");
        motion_watch(t, &m, "grip.y");
        both_ways(t, &m, 0.01, 1e-8, 4);
    }
    motion_free(&m);
}

/* The spring gives way by a torque over its stiffness: that part of the motion. */
static void stiff__a_stiff_hinge_is_no_hinge(mt_test *t)
{
    static const double stiffness[] = {1e8};
    motion m;
    motion one;
    REQUIRE(t, motion_open(t, two_links(t, 0.0), NULL, &one));
    motion_watch(t, &one, "tip.x");
    motion_watch(t, &one, "tip.y");
    CHECK(t, turn_line(t, &one, 2.5) && motion_run(t, &one, 0.2, 0.02));
    for (int i = 0; i < MT_COUNT(stiffness); i++) {
        mt_test_row(t, "stiffness %g", stiffness[i]);
        if (motion_open(t, two_links(t, stiffness[i]), NULL, &m)) {
            motion_watch(t, &m, "tip.x");
            motion_watch(t, &m, "tip.y");
            m.opt.tolerance = 1e-9;
            if (turn_line(t, &m, 2.5) && motion_run(t, &m, 0.2, 0.02)) {
                CHECK(t, m.r.stiff_steps == m.r.steps);
                CHECK(t, m.r.steps < 20000);
                check_same(t, &m.r, &one.r, (200.0 / stiffness[i]) + 1e-7);
            }
        }
        motion_free(&m);
    }
    motion_free(&one);
}

/* What is not stiff, or vibrates all the time, is left to the pair. */
static void stiff__other_motions_are_explicit(mt_test *t)
{
    motion m;
    mt_test_row(t, "a soft hinge");
    if (motion_open(t, two_links(t, 100.0), NULL, &m) && turn_line(t, &m, 0.5) &&
        motion_run(t, &m, 0.1, 0.1)) {
        CHECK_INT(t, m.r.stiff_steps, 0);
    }
    motion_free(&m);
    mt_test_row(t, "a stiff hinge that was bent");
    if (motion_open(t, two_links(t, 1e7), NULL, &m)) {
        motion_watch(t, &m, "tip.x");
        if (motion_put(t, &m, "hinge", 0.5) && motion_run(t, &m, 0.005, 0.001)) {
            const mt_sim_result got = m.r;
            CHECK(t, got.stiff_steps < got.steps);
            m.opt.explicit_steps = true;
            if (motion_run(t, &m, 0.005, 0.001)) {
                check_same(t, &got, &m.r, 1e-7);
            }
        }
    }
    motion_free(&m);
}

MT_TEST_MAIN(MT_TEST(stiff__steps_lead_where_explicit_ones_do),
             MT_TEST(stiff__a_stiff_hinge_is_no_hinge),
             MT_TEST(stiff__other_motions_are_explicit))
