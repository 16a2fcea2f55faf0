/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The equations themselves: accelerations are those of the fundamental equation, at any place
 * and with any velocities; velocity terms are those of Lagrange, which leave the energy of
 * every mechanism alone (also of bars and beams, whose masses follow their frames); steps have
 * the order of the method.
 */
#include "modetune/dynamics.h"

#include <stdlib.h>

#include "simulate/motions.h"
#include "simulate/step.h"

/* A start with something moving in every direction: a pseudo-random velocity, projected. */
static bool shove(mt_test *t, motion *m, double size)
{
    const size_t nq = (size_t)m->sys->nq;
    unsigned state = 7;
    mt_motion o;
    double *const any = mt_arena_f64(&m->mem, nq, 1);
    double *const b = mt_arena_f64(&m->mem, nq, 1);
    if (mt_motion_init(&o, m->lin, &m->mem, &m->err) != MT_OK) {
        return false;
    }
    mt_motion_eval(&o, &m->start.at, any);
    for (size_t i = 0; i < nq; i++) {
        state = (state * 1103515245U) + 12345U;
        any[i] = size * (((double)(state >> 16 & 0x7fffU) / 16384.0) - 1.0);
    }
    /* the nearest in the sense of energy: M v = M any + A^T lambda, A v = 0 */
    mt_gemv(false, (int)nq, (int)nq, 1.0, o.mass, (int)nq, any, 0.0, b);
    double *const zero = mt_arena_f64(&m->mem, (size_t)o.m, 1);
    const mt_gauss g = {.m = o.m, .mass = o.mass, .force = b, .a = o.a, .b = zero};
    return motion_done(t, m,
                       mt_gauss_solve(m->sys, &g, m->start.v, NULL, NULL, &m->mem, &m->err));
}

static void check_accelerations(mt_test *t, motion *m, bool singular)
{
    const int n = m->sys->nq;
    mt_motion o;
    double *const want = mt_arena_f64(&m->mem, (size_t)n, 1);
    double *const got = mt_arena_f64(&m->mem, (size_t)n, 1);
    CHECK(t, mt_motion_init(&o, m->lin, &m->mem, &m->err) == MT_OK);
    mt_motion_eval(&o, &m->start.at, m->start.v);
    const mt_gauss g = {.m = o.m, .mass = o.mass, .force = o.force, .a = o.a, .b = o.b};
    CHECK(t, mt_gauss_solve(m->sys, &g, got, NULL, NULL, &m->mem, &m->err) == MT_OK);
    CHECK(t, (singular
                  ? mt_udwadia_phohomsiri(n, o.m, o.mass, o.force, o.a, o.b, want, NULL)
                  : mt_udwadia_kalaba(n, o.m, o.mass, o.force, o.a, o.b, want, NULL)) == MT_OK);
    const double size = mt_max_abs(n, want);
    for (int i = 0; i < n; i++) {
        CHECK_NEAR_ABS(t, got[i], want[i], 1e-9 * size);
    }
}

static void simulate__accelerations_are_those_of_the_fundamental_equation(mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        bool singular;
    } rows[] = {
        {"four_bar", "loaded", false},     {"space_four_bar", "loaded", false},
        {"double_pendulum", "rods", true}, {"space_couplings", "loaded", false},
        {"couplings", "planet", false},    {"driven_rod", "sprung", false},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        motion m;
        mt_test_row(t, "%s, %s", rows[i].file, rows[i].configuration);
        if (motion_open(t, mech_load(t, rows[i].file), rows[i].configuration, &m) &&
            shove(t, &m, 1.0)) {
            check_accelerations(t, &m, rows[i].singular);
        }
        motion_free(&m);
    }
}

/* One solution by the inverse of an earlier position beside one by elimination. */
static void compare_solutions(mt_test *t, motion *m, mt_gauss_near *near, mt_motion *o,
                              double tolerance)
{
    const int n = m->sys->nq;
    double *const want = mt_arena_f64(&m->mem, (size_t)n, 1);
    double *const got = mt_arena_f64(&m->mem, (size_t)n, 1);
    double *const lambda = mt_arena_f64(&m->mem, (size_t)o->m, 1);
    double *const left = mt_arena_f64(&m->mem, (size_t)n, 1);
    mt_motion_eval(o, &m->start.at, m->start.v);
    const mt_gauss g = {.m = o->m, .mass = o->mass, .force = o->force, .a = o->a, .b = o->b};
    CHECK(t, mt_gauss_solve(m->sys, &g, want, NULL, NULL, &m->mem, &m->err) == MT_OK);
    CHECK(t, mt_gauss_solve_near(near, m->sys, &g, got, lambda, &m->mem, &m->err) == MT_OK);
    const double size = mt_max_abs(n, want);
    for (int i = 0; i < n; i++) {
        CHECK_NEAR_ABS(t, got[i], want[i], tolerance * size);
    }
    /* M x = f + A^T lambda */
    memcpy(left, o->force, (size_t)n * sizeof *left);
    mt_gemv(false, n, n, 1.0, o->mass, n, got, -1.0, left);
    mt_gemv(true, o->m, n, -1.0, o->a, o->m, lambda, 1.0, left);
    CHECK_NEAR_ABS(t, mt_max_abs(n, left), 0.0,
                   tolerance * mt_max_abs((ptrdiff_t)n * n, o->mass) * size);
}

/* Along a motion, and after leaps that no inverse survives. */
static void simulate__accelerations_by_an_earlier_inverse_are_those_of_an_elimination(
    mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        bool inverse; /* else masses are 0, equations repeat, or unknowns are few */
    } rows[] = {
        {"four_bar", "loaded", true},      {"space_four_bar", "loaded", false},
        {"double_pendulum", "rods", true}, {"space_couplings", "loaded", true},
        {"couplings", "planet", true},     {"driven_rod", "sprung", false},
    };
    enum { STEPS = 60, LEAP = 20 };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        motion m;
        mt_motion o;
        mt_gauss_near near = {.n = 0};
        long served = 0;
        mt_test_row(t, "%s, %s", rows[i].file, rows[i].configuration);
        if (motion_open(t, mech_load(t, rows[i].file), rows[i].configuration, &m) &&
            shove(t, &m, 1.0)) {
            double *const way = mt_arena_f64(&m.mem, (size_t)m.sys->nq, 1);
            CHECK(t, mt_motion_init(&o, m.lin, &m.mem, &m.err) == MT_OK);
            CHECK(t, mt_gauss_near_init(&near, m.sys, o.m, &m.mem, &m.err) == MT_OK);
            for (int step = 0; step < STEPS; step++) {
                mt_axpy(m.sys->nq, step % LEAP == LEAP - 1 ? 0.5 : 1e-4, m.start.v, way);
                mt_poses_move(m.sys, m.start.at.pose, way);
                memset(way, 0, (size_t)m.sys->nq * sizeof *way);
                compare_solutions(t, &m, &near, &o, 1e-10);
                served += near.known && near.served > 0 ? 1 : 0;
            }
            CHECK(t, rows[i].inverse == (served > STEPS / 2));
        }
        motion_free(&m);
    }
}

/* Wild motions of every kind of mass keep their energy, a quarter of the time or, with
 * MT_EVERY=1, all of it. */
static void simulate__every_kind_of_mass_keeps_its_energy(mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        double seconds;
        double size;
    } rows[] = {
        {"rods", "bodies", 2.0, 2.0},
        {"rods", "distances", 2.0, 2.0},
        {"double_pendulum", "rods", 5.0, 5.0},
        {"four_bar", "loaded", 5.0, 5.0},
        {"space_couplings", "loaded", 1.0, 2.0},
        {"couplings", "planet", 2.0, 2.0},
        {"space_stick", "plain", 0.3, 1.0},
        {"loaded_frame", "loaded", 0.05, 1.0},
        {"space_shear", NULL, 0.002, 1.0},
    };
    const double part = getenv("MT_EVERY") != NULL ? 1.0 : 0.25;
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double seconds = part * rows[i].seconds;
        motion m;
        mt_test_row(t, "%s", rows[i].file);
        if (motion_open(t, mech_load(t, rows[i].file), rows[i].configuration, &m) &&
            shove(t, &m, rows[i].size)) {
            if (motion_run(t, &m, seconds, 0.25 * seconds)) {
                CHECK(t, m.r.energy_scale_j > 0.0);
                CHECK(t, m.r.energy_error_j < 1e-8 * m.r.energy_scale_j);
                CHECK(t, m.r.gap_m < 1e-10 * m.sys->length_m);
                CHECK(t, m.r.left_m < 1e-13 * m.sys->length_m);
                motion_tell(&m);
            }
        }
        motion_free(&m);
    }
}

static void simulate__hundred_periods_drift_below_1e_8(mt_test *t)
{
    motion m;
    if (motion_open(t, mech_load(t, "double_pendulum"), "distances", &m)) {
        const double lowest = mech_hz(&m.mech, 1);
        if (shove(t, &m, 3.0) && motion_run(t, &m, 100.0 / lowest, 10.0 / lowest)) {
            CHECK(t, m.r.energy_error_j < 1e-8 * m.r.energy_scale_j);
            CHECK(t, m.r.gap_m < 1e-10);
            motion_tell(&m);
        }
    }
    motion_free(&m);
}

static double swung_to(mt_test *t, double step, double tolerance)
{
    motion m;
    double angle = nan("");
    if (motion_open(t, mech_load(t, "pendulum"), "hanging", &m) &&
        motion_put(t, &m, "pivot", 2.0)) {
        motion_watch(t, &m, "pivot");
        m.opt.step_s = step;
        m.opt.tolerance = tolerance;
        if (motion_run(t, &m, 3.2, 3.2)) {
            angle = motion_value(&m, 0, m.r.n - 1);
        }
    }
    motion_free(&m);
    return angle;
}

/* Halving the step divides the error by 2^8; a tighter tolerance about as it says. */
static void simulate__errors_fall_with_the_order_of_the_method(mt_test *t)
{
    const double exact = swung_to(t, 0.005, 1e-13);
    const double first = fabs(swung_to(t, 0.16, 1e-11) - exact);
    const double second = fabs(swung_to(t, 0.08, 1e-11) - exact);
    const double third = fabs(swung_to(t, 0.04, 1e-11) - exact);
    CHECK(t, log2(first / second) > 7.0 && log2(first / second) < 10.0);
    CHECK(t, log2(second / third) > 7.0 && log2(second / third) < 10.0);
    const double loose = fabs(swung_to(t, 0.0, 1e-5) - exact);
    const double tight = fabs(swung_to(t, 0.0, 1e-8) - exact);
    const double tightest = fabs(swung_to(t, 0.0, 1e-11) - exact);
    CHECK(t, tight < 0.05 * loose);
    CHECK(t, tightest < 0.05 * tight);
    CHECK(t, tightest < 1e-10);
}

MT_TEST_MAIN(MT_TEST(simulate__accelerations_are_those_of_the_fundamental_equation),
             MT_TEST(simulate__accelerations_by_an_earlier_inverse_are_those_of_an_elimination),
             MT_TEST(simulate__every_kind_of_mass_keeps_its_energy),
             MT_TEST(simulate__hundred_periods_drift_below_1e_8),
             MT_TEST(simulate__errors_fall_with_the_order_of_the_method))
