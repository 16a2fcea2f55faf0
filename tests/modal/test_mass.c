/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Directions without mass. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/chain.h"
#include "modal/modal.h"
#include "support/mt_random.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

static const double TOL = 1e-12;
static const double RATIO = 20.0;

static mt_arena mem;

/* wall - k - (no mass) - k - m - k - (no mass) - k - m: each pair of springs acts as k/2, so
 * this is a chain of two masses on springs of k/2. */
static void with_massless_joints(chain *s, double nothing)
{
    chain_line(s, 4, 2.0, 300.0, 1);
    s->m[0] = nothing;
    s->m[2 + 2 * 4] = nothing;
}

static void check_two_masses(mt_test *t, const chain *s, double tol)
{
    mt_modes modes;
    mt_err err = {.text = ""};
    if (!CHECK(t, solve_pair(s->n, s->k, s->m, NULL, NULL, &mem, &modes, &err) == MT_OK)) {
        return;
    }
    CHECK_INT(t, modes.n_condensed, 2);
    CHECK_INT(t, modes.count, 2);
    CHECK(t, modes.massless == NULL);
    const double unit = 150.0 / 2.0;
    CHECK_NEAR(t, modes.lambda[0], unit * (3.0 - sqrt(5.0)) / 2.0, tol);
    CHECK_NEAR(t, modes.lambda[1], unit * (3.0 + sqrt(5.0)) / 2.0, tol);
    for (int i = 0; i < 2; i++) {
        CHECK(t, modes.residual[i] <= RATIO * t->tol_scale);
        CHECK(t, modes.orthogonality[i] <= RATIO * t->tol_scale);
    }
}

static void mass__coordinates_without_mass_are_condensed(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_test_row(t, "exact zero");
    with_massless_joints(&s, 0.0);
    check_two_masses(t, &s, TOL);
    /* the massless point moves half as far as the mass behind it */
    REQUIRE(t, solve_pair(4, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    CHECK_NEAR(t, modes.y[0], 0.5 * modes.y[1], TOL);
    CHECK_NEAR(t, modes.y[2], 0.5 * (modes.y[1] + modes.y[3]), TOL);
    mt_test_row(t, "the square of rounding");
    with_massless_joints(&s, 2.0 * DBL_EPSILON * DBL_EPSILON);
    check_two_masses(t, &s, TOL);
}

/* A random X that is conditioned up to ten or so. */
static void oblique(mt_random *g, chain *s, double *x)
{
    memset(x, 0, (size_t)s->n * (size_t)s->n * sizeof *x);
    mt_random_fill(g, s->n * s->n, x);
    for (int i = 0; i < s->n; i++) {
        x[i + i * s->n] += 3.0;
    }
    chain_oblique(s, x);
}

static void mass__oblique_directions_without_mass_are_condensed(mt_test *t)
{
    mt_random g = mt_random_seed(31);
    for (int trial = 0; trial < 50; trial++) {
        chain s;
        double x[16];
        mt_test_row(t, "trial %d", trial);
        with_massless_joints(&s, 0.0);
        oblique(&g, &s, x);
        check_two_masses(t, &s, 10.0 * TOL); /* X is conditioned up to ten or so */
    }
}

/* They are the high end of a spread of 1e10 in stiffness per mass: the spring factors keep the
 * low end. */
static void mass__light_masses_are_masses(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_modal_options opt = mt_modal_options_default();
    const double first_order = 1e-8; /* effect of a mass ratio of 1e-9 */
    const double want = 75.0 * (3.0 - sqrt(5.0)) / 2.0;
    with_massless_joints(&s, 2e-9);
    chain_factor(&s);
    const mt_stiffness_factor factor = {.rows = s.springs, .b = s.b, .c = s.c};
    REQUIRE(t, solve_pair(4, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    CHECK_INT(t, modes.n_condensed, 0);
    CHECK_NEAR_ABS(t, modes.lambda[0], want, modes.error_bound + first_order * want);
    CHECK_NEAR(t, modes.lambda[3], 600.0 / 2e-9, first_order);
    opt.accuracy = MT_MODAL_ACCURACY;
    REQUIRE(t, solve_pair(4, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK);
    CHECK(t, modes.from_factor);
    CHECK_NEAR(t, modes.lambda[0], want, first_order);
}

static void mass__no_mass_and_no_stiffness_names_the_direction(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_err err;
    mt_random g = mt_random_seed(32);
    chain_start(&s, 3, 1.0);
    chain_spring(&s, GROUND, 0, 10.0);
    chain_spring(&s, 0, 1, 10.0);
    s.m[8] = 0.0;
    CHECK_INT(t, solve_pair(3, s.k, s.m, NULL, NULL, &mem, &modes, &err), MT_E_MASSLESS);
    CHECK_STR(t, err.text, "a direction (mostly coordinate 3) has neither mass nor stiffness");
    REQUIRE(t, modes.massless != NULL);
    CHECK_NEAR_ABS(t, modes.massless[0], 0.0, 1e-15);
    CHECK_NEAR(t, modes.massless[2], 1.0, 0.0);

    mt_test_row(t, "oblique: X times the direction is the third coordinate");
    double x[9];
    double back[3];
    oblique(&g, &s, x);
    CHECK_INT(t, solve_pair(3, s.k, s.m, NULL, NULL, &mem, &modes, &err), MT_E_MASSLESS);
    REQUIRE(t, modes.massless != NULL);
    mt_gemv(false, 3, 3, 1.0, x, 3, modes.massless, 0.0, back);
    CHECK_NEAR_ABS(t, back[0] / back[2], 0.0, 1e-13);
    CHECK_NEAR_ABS(t, back[1] / back[2], 0.0, 1e-13);

    mt_test_row(t, "the two ends of a spring without mass float together");
    chain_start(&s, 3, 1.0);
    chain_spring(&s, GROUND, 0, 10.0);
    chain_spring(&s, 1, 2, 10.0);
    s.m[4] = 0.0;
    s.m[8] = 0.0;
    CHECK_INT(t, solve_pair(3, s.k, s.m, NULL, NULL, &mem, &modes, &err), MT_E_MASSLESS);
    REQUIRE(t, modes.massless != NULL);
    CHECK_NEAR(t, modes.massless[1], 1.0, 1e-13);
    CHECK_NEAR(t, modes.massless[2], 1.0, 1e-13);
}

static void mass__negative_stiffness_without_mass_is_unstable(mt_test *t)
{
    chain s;
    mt_modes modes;
    chain_line(&s, 2, 1.0, 100.0, 0);
    s.m[3] = 0.0;
    s.k[3] = -50.0;
    REQUIRE(t, solve_pair(2, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    CHECK_INT(t, modes.count, 1);
    CHECK_INT(t, modes.n_unstable_condensed, 1);
    CHECK_INT(t, modes.n_unstable, 1);
    CHECK_NEAR(t, modes.lambda[0], 100.0 + 100.0 * 100.0 / 50.0, TOL);
    CHECK_INT(t, mt_modal_flexible(&modes, 1), -1);
}

static void mass__all_without_mass_leaves_no_mode(mt_test *t)
{
    chain s;
    mt_modes modes;
    chain_line(&s, 2, 0.0, 100.0, 2);
    REQUIRE(t, solve_pair(2, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    CHECK_INT(t, modes.count, 0);
    CHECK_INT(t, modes.n_condensed, 2);
    CHECK_INT(t, mt_modal_flexible(&modes, 1), -1);
}

static void mass__negative_masses_are_errors(mt_test *t)
{
    const double nil = nan("");
    static const char *const texts[] = {
        "mass matrix: negative mass -1 at coordinate 2",
        "mass matrix: a direction has negative mass (-1 of its own)",
        "mass matrix: coordinate 2 or 1 has no mass but is coupled (0.5)",
        "mass matrix: coordinate 2 or 1 has no mass but is coupled (-0.5)",
        "mass matrix: coordinate 2 or 1 has no mass but is coupled (1e-06)",
        "mass matrix: coordinate 2 or 1 has no mass but is coupled (-1e-06)",
    };
    const double m[][4] = {
        {1.0, 0.0, nil, -1.0}, {1.0, 2.0, nil, 1.0},  {1.0, 0.5, nil, 0.0},
        {1.0, -0.5, nil, 0.0}, {0.0, 1e-6, nil, 1.0}, {0.0, -1e-6, nil, 1.0},
    };
    const double k[4] = {1.0, 0.0, nil, 1.0};
    for (int r = 0; r < MT_COUNT(m); r++) {
        mt_modes modes;
        mt_err err;
        mt_test_row(t, "%s", texts[r]);
        CHECK_INT(t, solve_pair(2, k, m[r], NULL, NULL, &mem, &modes, &err), MT_E_NOT_SPD);
        CHECK_STR(t, err.text, texts[r]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(mass__coordinates_without_mass_are_condensed),
        MT_TEST(mass__oblique_directions_without_mass_are_condensed),
        MT_TEST(mass__light_masses_are_masses),
        MT_TEST(mass__no_mass_and_no_stiffness_names_the_direction),
        MT_TEST(mass__negative_stiffness_without_mass_is_unstable),
        MT_TEST(mass__all_without_mass_leaves_no_mode),
        MT_TEST(mass__negative_masses_are_errors),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
