/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State spaces: closed forms, the responses of random problems, and what modes that are left
 * out leave. */
#include <limits.h>

#include "response/response_fixture.h"
#include "response/state_space.h"

static const double TOL = 1e-9;

/* 2 kg on 800 N/m along x. */
#define ONE(spring, damping)                                                                   \
    "{ \"format\": \"modetune-model/1\", \"name\": \"m\", \"dimension\": 2,"                   \
    "  \"bodies\": [ { \"name\": \"m\", \"mass_kg\": 2, \"inertia_kg_m2\": 1,"                 \
    "    \"centre\": [0, 0] } ],"                                                              \
    "  \"joints\": [ { \"name\": \"slide\", \"type\": \"prismatic\", \"bodies\": [\"ground\"," \
    " \"m\"], \"at\": [0, 0], \"axis\": [1, 0] } ],"                                           \
    "  \"springs\": [ { \"name\": \"k\", \"type\": \"axial\", \"bodies\": [\"ground\", "       \
    "\"m\"], \"at\": [[-1, 0], [0, 0]], \"stiffness_n_per_m\": 800" spring " } ],"             \
    "  \"sensors\": [ { \"name\": \"s\", \"on\": \"m\", \"directions\": [\"x\"] } ]" damping   \
    "}"

/* A, B, C and D of (s^2 2 + s c + 800) x = u in mass-normalised form, read off. */
static void state_space__one_mass_has_the_matrices_of_its_equation(mt_test *t)
{
    asked q = {.rc = MT_OK};
    mt_state_space s;
    mt_err err = {.text = ""};
    if (mech_must(t, mech_parse(t, ONE("", ", \"damping\": {\"mass_per_s\": 0.3}")), NULL, "",
                  &q.m) &&
        ask(t, &q, "s.x base.x", "s.x s.x:acceleration s.x:relative_displacement spring.k") &&
        CHECK(t, mt_state_space_make(&q.r.basis, INT_MAX, &q.r.mem, &s, &err) == MT_OK) &&
        CHECK_INT(t, s.n, 4) && CHECK_INT(t, s.integrals, 2)) {
        const double *const a = s.a;
        CHECK_NEAR_ABS(t, a[0 + (1 * 4)], 1.0, 0.0);
        CHECK_NEAR(t, a[1 + (0 * 4)], -400.0, TOL);
        CHECK_NEAR(t, a[1 + (1 * 4)], -0.3, TOL);
        CHECK_NEAR_ABS(t, a[3 + (2 * 4)], 1.0, 0.0); /* displacement of the ground */
        CHECK_NEAR(t, s.c[0] * s.b[1], 0.5, TOL);    /* 1/m */
        CHECK_NEAR(t, s.d[1], 0.5, TOL);             /* acceleration by force, at once */
        CHECK_NEAR_ABS(t, s.d[1 + 4], 0.0, TOL);     /* -1 of the frame, 1 of the ground */
        CHECK_NEAR(t, s.c[0 + (3 * 4)], 1.0, TOL);   /* in space: with the ground */
        CHECK_NEAR_ABS(t, s.c[2 + (3 * 4)], 0.0, TOL);
        CHECK(t, !s.lossy);
    }
    done(&q);
}

/* The viscous damping of a loss factor takes as much energy at the mode's own frequency. */
static void state_space__loss_factors_are_right_where_the_mode_is(mt_test *t)
{
    asked q = {.rc = MT_OK};
    mt_state_space s;
    mt_err err = {.text = ""};
    double complex h[2];
    if (mech_must(t, mech_parse(t, ONE(", \"loss_factor\": 0.07", "")), NULL, "", &q.m) &&
        ask(t, &q, "s.x", "s.x spring.k") &&
        CHECK(t, mt_state_space_make(&q.r.basis, INT_MAX, &q.r.mem, &s, &err) == MT_OK) &&
        CHECK(t, s.lossy) &&
        CHECK(t, mt_state_space_at(&s, 20.0, h, &q.r.mem, &err) == MT_OK)) {
        const double complex k = 800.0 * mt_complex(1.0, 0.07);
        CHECK_NEAR_ABS(t, cabs(h[0] - (1.0 / (k - 800.0))), 0.0, TOL * cabs(h[0]));
        CHECK_NEAR_ABS(t, cabs(h[1] - (k / (k - 800.0))), 0.0, TOL * cabs(h[1]));
    }
    done(&q);
}

/* With all modes a state space has the responses of the matrices themselves; in every second
 * round with directions without mass, which dampers hold or not. */
static void state_space__has_the_responses_of_random_problems(mt_test *t)
{
    mt_random r = mt_random_seed(7);
    int massless = 0;
    for (int round = 0; round < 60; round++) {
        const int n = 1 + mt_random_int(&r, FORCED_MOST);
        forced p;
        mt_state_space s;
        forced_random(&r, &p, n, mt_random_int(&r, 4) > 0);
        p.f.h = NULL;
        for (int i = 0; n > 2 && round % 2 == 1 && i < 1 + (n / 4); i++) {
            const int at = 1 + mt_random_int(&r, n - 1);
            p.m[at + (at * n)] = 0.0;
            forced_between(p.k, n, at, -1, 1000.0);
        }
        mt_test_row(t, "round %d, n = %d%s", round, n, p.f.c ? ", viscous" : "");
        if (!forced_make(t, &p, 0) ||
            !CHECK(t, mt_state_space_make(&p.basis, INT_MAX, &p.mem, &s, &p.err) == MT_OK)) {
            (void)fprintf(stderr, "%s\n", p.err.text);
            mt_arena_free(&p.mem);
            continue;
        }
        massless += s.massless > 0;
        CHECK_INT(t, s.n, (2 * s.modes) + s.massless);
        mt_sample a = forced_sample(&p, &p.mem);
        double complex *const h = mt_arena_alloc(&p.mem, (size_t)n * (size_t)n, sizeof *h);
        for (int i_w = 0; i_w < 25; i_w++) {
            const double w = 0.37 * pow(1.47, i_w);
            double largest = 0.0;
            CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
            CHECK(t, mt_state_space_at(&s, w, h, &p.mem, &p.err) == MT_OK);
            for (int i = 0; i < n * n; i++) {
                largest = fmax(largest, cabs(a.h[i]));
            }
            for (int i = 0; i < n * n; i++) {
                CHECK_NEAR_ABS(t, cabs(a.h[i] - h[i]), 0.0, 1e-8 * largest);
            }
        }
        mt_arena_free(&p.mem);
    }
    CHECK(t, massless > 5);
}

/* Few modes: at rest the response is that of all modes, and the difference grows with the
 * fourth power of the frequency where the force acts at the point that is looked at. */
static void state_space__is_statically_exact_with_few_modes(mt_test *t)
{
    mt_random r = mt_random_seed(8);
    int steep = 0;
    for (int round = 0; round < 30; round++) {
        const int n = 8 + mt_random_int(&r, FORCED_MOST - 7);
        forced p;
        mt_state_space s;
        forced_random(&r, &p, n, true);
        p.f.c = NULL;
        p.f.h = NULL;
        p.f.n_in = 1;
        p.f.n_out = 1;
        mt_test_row(t, "round %d, n = %d", round, n);
        if (forced_make(t, &p, 0) &&
            CHECK(t, mt_state_space_make(&p.basis, 3, &p.mem, &s, &p.err) == MT_OK)) {
            const double w_left = sqrt(p.basis.lambda[3]);
            double off[2];
            double rounding = 0.0;
            CHECK_INT(t, s.residual, 1);
            for (int k = 0; k < 2; k++) {
                const double w = w_left * (k == 0 ? 0.04 : 0.08);
                double complex h[1];
                mt_sample a = forced_sample(&p, &p.mem);
                CHECK(t, mt_transfer_at(&p.direct, w, &a, &p.mem, &p.err) == MT_OK);
                CHECK(t, mt_state_space_at(&s, w, h, &p.mem, &p.err) == MT_OK);
                off[k] = cabs(a.h[0] - h[0]);
                rounding = fmax(rounding, 1e-11 * cabs(a.h[0]));
                CHECK(t, off[k] < 1e-3 * cabs(a.h[0]));
            }
            /* the series of b^2 / (lambda - w^2) in w^2 is right in its first two terms */
            CHECK(t, off[1] < 100.0 * rounding || fabs(log2(off[1] / off[0]) - 4.0) < 0.2);
            steep += off[1] >= 100.0 * rounding;
        }
        mt_arena_free(&p.mem);
    }
    CHECK(t, steep > 10);
}

static void state_space__what_has_none_is_refused_with_the_reason(mt_test *t)
{
    asked q = {.rc = MT_OK};
    mt_state_space s;
    mt_err err = {.text = ""};
    if (mech_must(t, mech_parse(t, ONE("", "")), NULL, "", &q.m) &&
        ask(t, &q, "s.x base.x:displacement", "s.x")) {
        CHECK_INT(t, mt_state_space_make(&q.r.basis, INT_MAX, &q.r.mem, &s, &err), MT_E_USAGE);
        CHECK_INT(t, s.refused_input, 1);
        CHECK(t, strstr(err.text, "acceleration of the ground") != NULL);
    }
    done(&q);
    /* two masses with a point between them, which a damper and a spring hold */
    forced p;
    forced_all(&p, 3);
    forced_between(p.k, 3, 0, -1, 100.0);
    forced_between(p.k, 3, 1, 0, 100.0);
    forced_between(p.k, 3, 2, 1, 100.0);
    forced_between(p.c, 3, 1, -1, 2.0);
    p.m[0] = 1.0;
    p.m[8] = 1.0;
    p.f.c = p.c;
    p.f.s[0] = NULL;
    p.f.s[2] = p.s;
    if (forced_make(t, &p, 0)) {
        CHECK_INT(t, mt_state_space_make(&p.basis, INT_MAX, &p.mem, &s, &p.err), MT_E_USAGE);
        CHECK_INT(t, s.refused_output, 1);
        CHECK_INT(t, s.refused_input, 1);
        p.f.n_in = 1; /* the force on the first mass alone */
        mt_arena_free(&p.mem);
        double complex h[3];
        if (forced_make(t, &p, 0) &&
            CHECK(t, mt_state_space_make(&p.basis, INT_MAX, &p.mem, &s, &p.err) == MT_OK)) {
            mt_sample a = forced_sample(&p, &p.mem);
            CHECK(t, mt_transfer_at(&p.direct, 7.0, &a, &p.mem, &p.err) == MT_OK);
            CHECK(t, mt_state_space_at(&s, 7.0, h, &p.mem, &p.err) == MT_OK);
            for (int o = 0; o < 3; o++) {
                CHECK_NEAR_ABS(t, cabs(a.h[o] - h[o]), 0.0, TOL * cabs(a.h[o]));
            }
        }
    }
    mt_arena_free(&p.mem);
}

MT_TEST_MAIN(MT_TEST(state_space__one_mass_has_the_matrices_of_its_equation),
             MT_TEST(state_space__loss_factors_are_right_where_the_mode_is),
             MT_TEST(state_space__has_the_responses_of_random_problems),
             MT_TEST(state_space__is_statically_exact_with_few_modes),
             MT_TEST(state_space__what_has_none_is_refused_with_the_reason))
