/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closing by the smallest steps, against Newton with multipliers, and the walks of a drive with
 * either. */
#include "mechanics/mech.h"
#include "mechanics/position.h"
#include "support/mt_random.h"

enum { STATES = 64, BODIES = 16, TRIES = 100 };

static const char PEDAL[] = "../bench/studies/models/pedal";

/* Rounding of positions of half a metre, by what stiffnesses 1:100 may enlarge it. */
static const double SAME = 1e-11;
/* The ends lie no further apart than the start was moved off: smallest is meant by another
 * weight of turns. */
static const double APART = 1.0;
static const double CLOSED = 1e-14;

typedef struct closing {
    mech s;
    mt_arena mem;
    mt_data data;
    mt_placement at; /* as drawn, the drive in its place */
    mt_newton_problem p;
    double *value; /* of the program */
} closing;

static bool open_closing(mt_test *t, mt_model *model, const char *configuration,
                         const char *inputs, closing *c)
{
    mt_err err = {.text = ""};
    *c = (closing){.data = {.sys = NULL}};
    if (!mech_must(t, model, configuration, inputs, &c->s) ||
        !CHECK(t, mt_arena_init(&c->mem, 0, &err) == MT_OK)) {
        return false;
    }
    const mt_system *const sys = c->s.a->sys;
    double *const value = mt_arena_f64(&c->mem, (size_t)sys->program.count, 1);
    const mt_status rc = mt_data_init(&c->data, sys, &c->mem, &err);
    if (!CHECK(t, rc == MT_OK && mt_placement_init(&c->at, sys, &c->mem, &err) == MT_OK) ||
        !CHECK(t, mt_program_eval(&sys->program, c->s.at, value, NULL, &err) == MT_OK)) {
        return false;
    }
    c->value = value;
    c->data.value = value;
    c->data.input = -1;
    mt_data_vecs(&c->data);
    mt_data_targets(&c->data);
    mt_data_drawn(&c->data, c->at.pose);
    mt_data_rest(&c->data, c->at.pose);
    c->p = (mt_newton_problem){.data = &c->data,
                               .energy = MT_ENERGY_ANCHOR,
                               .drawn = c->at.pose,
                               .m = sys->n_constraints,
                               .trim = false};
    return true;
}

static void close_closing(closing *c)
{
    mt_arena_free(&c->mem);
    mech_free(&c->s);
}

static void close__comes_next_to_the_point_that_newton_finds(mt_test *t)
{
    closing c;
    mt_err err = {.text = ""};
    mt_random r = mt_random_seed(7);
    double way[STATES] = {0.0};
    mt_pose drawn[BODIES];
    int alike = 0;
    if (!open_closing(t, mech_load(t, PEDAL), "left", "", &c)) {
        close_closing(&c);
        return;
    }
    const mt_system *const sys = c.s.a->sys;
    memcpy(drawn, c.at.pose, (size_t)sys->n_bodies * sizeof *drawn);
    for (int i = 0; i < TRIES; i++) {
        mt_placement one;
        mt_placement two;
        mt_stage stage = {.active = false};
        const double enough = i % 2 == 0 ? 0.0 : 1e-6;
        const double far = pow(10.0, -1.0 - (i % 5));
        double gap = 1.0;
        int steps = 0;
        bool closed = false;
        mt_test_row(t, "try %d", i);
        memcpy(c.at.pose, drawn, (size_t)sys->n_bodies * sizeof *drawn);
        for (int j = 0; j < sys->nq; j++) {
            way[j] = far * mt_random_in(&r, -0.2, 0.2);
        }
        mt_poses_move(sys, c.at.pose, way);
        c.at.drive[0] = far * mt_random_in(&r, -0.5, 0.5);
        REQUIRE(t, mt_placement_init(&one, sys, &c.mem, &err) == MT_OK);
        REQUIRE(t, mt_placement_init(&two, sys, &c.mem, &err) == MT_OK);
        mt_placement_copy(sys, &c.at, &one);
        mt_placement_copy(sys, &c.at, &two);
        CHECK_INT(t, mt_newton_close(&c.p, enough, &one, &steps, &closed, &c.mem, &err), MT_OK);
        if (!CHECK(t, closed)) {
            continue;
        }
        CHECK_INT(t, mt_newton_gap(&c.p, &one, &c.mem, &gap, &err), MT_OK);
        CHECK(t, gap <= fmax(enough * sys->length_m, CLOSED));
        CHECK_INT(t, mt_newton_solve(&c.p, &two, &c.mem, &stage, &err), MT_OK);
        CHECK(t, enough > 0.0 || steps <= stage.iterations);
        CHECK(t, mt_poses_distance(sys, one.pose, two.pose) <= (APART * far) + SAME + enough);
        alike++;
    }
    CHECK_INT(t, alike, TRIES);
    close_closing(&c);
}

/* The brief walk comes to the equilibrium of the exact one; *fewer: of iterations. */
static void compare_walks(mt_test *t, closing *c, double same, bool *fewer)
{
    const mt_system *const sys = c->s.a->sys;
    mt_state brief;
    mt_state exact;
    mt_err err = {.text = ""};
    const mt_status rc =
        mt_position_solve(sys, &c->data, NULL, MT_POSITION_QUICK, &c->mem, &brief, &err);
    CHECK_INT(t,
              mt_position_solve(sys, &c->data, NULL, MT_POSITION_EXACT, &c->mem, &exact, &err),
              rc);
    if (rc == MT_OK) {
        CHECK(t, mt_poses_distance(sys, brief.at.pose, exact.at.pose) <= same);
        *fewer = brief.iterations < exact.iterations;
    }
}

static void close__a_brief_walk_ends_in_the_equilibrium_of_the_exact_one(mt_test *t)
{
    static const char *const CONFIGURATION[] = {"left", "right"};
    mt_random r = mt_random_seed(11);
    mt_err err = {.text = ""};
    for (int k = 0; k < 2; k++) {
        closing c;
        if (open_closing(t, mech_load(t, PEDAL), CONFIGURATION[k], "arm k_rod k_act", &c)) {
            for (int i = 0; i < TRIES; i++) {
                const double x[3] = {mt_random_in(&r, 0.05, 0.2), mt_random_in(&r, 8e4, 6e5),
                                     mt_random_in(&r, 1e5, 9e5)};
                const mt_arena_mark mark = mt_arena_get_mark(&c.mem);
                bool fewer = false;
                mt_test_row(t, "%s, design %d", CONFIGURATION[k], i);
                CHECK_INT(t, mt_program_eval(&c.s.a->sys->program, x, c.value, NULL, &err),
                          MT_OK);
                mt_data_vecs(&c.data);
                compare_walks(t, &c, SAME, &fewer);
                CHECK(t, fewer);
                mt_arena_rewind(&c.mem, mark);
            }
        }
        close_closing(&c);
    }
}

/* Newton comes to a saddle there, and which way is down depends on where the drive stopped. */
static void close__what_settles_far_off_is_found_by_the_exact_walk(mt_test *t)
{
    closing c;
    bool fewer = false;
    if (open_closing(t, mech_load(t, "downhill"), "driven", "", &c)) {
        compare_walks(t, &c, SAME, &fewer);
    }
    close_closing(&c);
}

/* A trimmed servo, a rotor that turns 38 times as far as the stick, and a rod whose spin
 * between ball joints nothing holds: by the drawing alone it is known where that stays, to the
 * square root of what the pull to the drawing leaves. */
static void close__trims_gears_and_spins_are_walked_briefly(mt_test *t)
{
    static const char *const CONFIGURATION[] = {"stick_plus_10", "stick_minus_10"};
    static const double SPUN = 1e-8;
    for (int k = 0; k < MT_COUNT(CONFIGURATION); k++) {
        closing c;
        bool fewer = false;
        mt_test_row(t, "%s", CONFIGURATION[k]);
        if (open_closing(t, mech_load(t, "../../problems/inceptor"), CONFIGURATION[k], "",
                         &c)) {
            compare_walks(t, &c, SPUN, &fewer);
            CHECK(t, fewer);
        }
        close_closing(&c);
    }
}

MT_TEST_MAIN(MT_TEST(close__comes_next_to_the_point_that_newton_finds),
             MT_TEST(close__a_brief_walk_ends_in_the_equilibrium_of_the_exact_one),
             MT_TEST(close__what_settles_far_off_is_found_by_the_exact_walk),
             MT_TEST(close__trims_gears_and_spins_are_walked_briefly))
