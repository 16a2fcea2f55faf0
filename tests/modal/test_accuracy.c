/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Stiffnesses far apart. The oracle is Holzer's method in long double: walk along the chain
 * with displacement x and force F,
 *     F_{i+1} = F_i - lambda m_i x_i,   x_{i+1} = x_i + F_{i+1} / k_{i+1},
 * which never adds a stiff spring to a soft one, so its relative accuracy does not depend on
 * their ratio. Up to the lowest flexible mode the force keeps its sign all along the chain;
 * beyond, it does not: bisection on that.
 */
#include <float.h>
#include <math.h>

#include "modal/chain.h"
#include "modal/modal.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

/* What is asked of the lowest mode, whatever the ratio. */
static const double WANTED = 1e-10;

static mt_arena mem;

enum { N = 8 };

/* Does the force keep its sign for lambda? k[0] is the spring to the wall; 0: free. */
static bool below_first(const double *k, const double *m, long double lambda)
{
    long double x = k[0] > 0.0 ? 1.0L / (long double)k[0] : 1.0L;
    long double force = k[0] > 0.0 ? 1.0L : 0.0L;
    for (int i = 0; i < N; i++) {
        force -= lambda * (long double)m[i] * x;
        if (k[0] > 0.0 ? force <= 0.0L : force >= 0.0L) {
            return false;
        }
        x += i + 1 < N ? force / (long double)k[i + 1] : 0.0L;
    }
    return true;
}

static double holzer(const double *k, const double *m)
{
    long double low = 0.0L;
    long double high = 1e30L;
    for (int i = 0; i < 400; i++) {
        const long double mid = 0.5L * (low + high);
        if (below_first(k, m, mid)) {
            low = mid;
        } else {
            high = mid;
        }
    }
    return (double)low;
}

static void build(chain *s, const double *k, const double *m)
{
    chain_start(s, N, 0.0);
    for (int i = 0; i < N; i++) {
        s->m[i + i * N] = m[i];
        if (i > 0 || k[0] > 0.0) {
            chain_spring(s, i - 1, i, k[i]);
        }
    }
    chain_factor(s);
}

static const double masses[N] = {1.0, 2.0, 1.5, 0.7, 1.1, 3.0, 0.9, 1.3};

static const struct {
    const char *name;
    double k[N];
    int rigid;
    bool plain_fails;
} rows[] = {
    {"one size, on a wall", {9.0, 5.0, 3.0, 7.0, 2.0, 4.0, 6.0, 8.0}, 0, false},
    {"stiff and soft by turns", {1e12, 1.0, 1e12, 3.0, 1e12, 1e12, 2.0, 5e11}, 0, true},
    {"soft at the wall, stiff behind",
     {1.0, 1e12, 2e12, 3e12, 1e12, 1e12, 2e12, 5e12},
     0,
     true},
    {"every decade", {1.0, 1e2, 1e4, 1e6, 1e7, 1e9, 1e11, 1e12}, 0, true},
    {"free, one soft spring", {0.0, 1e12, 1e12, 1.0, 1e12, 1e12, 1e12, 1e12}, 1, true},
    {"free, ratio 1e20", {0.0, 1e20, 1.0, 1e20, 1e10, 1e20, 1e20, 1e20}, 1, true},
};

static void accuracy__spring_factors_keep_the_lowest_mode(mt_test *t)
{
    for (int r = 0; r < MT_COUNT(rows); r++) {
        chain s;
        mt_modes modes;
        mt_modal_options opt = mt_modal_options_default();
        mt_test_row(t, "%s", rows[r].name);
        build(&s, rows[r].k, masses);
        const mt_stiffness_factor factor = {.rows = s.springs, .b = s.b, .c = s.c};
        const double want = holzer(rows[r].k, masses);
        opt.accuracy = MT_MODAL_ACCURACY;
        if (!CHECK(t, solve_pair(N, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK)) {
            continue;
        }
        CHECK_INT(t, modes.n_rigid, rows[r].rigid);
        CHECK_INT(t, modes.n_unstable, 0);
        const int first = mt_modal_flexible(&modes, 1);
        if (!CHECK(t, first == rows[r].rigid)) {
            continue;
        }
        CHECK_NEAR(t, modes.lambda[first], want, WANTED);
        CHECK(t, modes.error_relative * want + modes.error_bound <= WANTED * want);
        CHECK_INT(t, modes.from_factor, rows[r].plain_fails);
        for (int i = 0; i < N; i++) {
            CHECK(t, modes.residual[i] <= 10.0 && modes.orthogonality[i] <= 10.0);
        }
    }
}

/* The test above says something only where the plain path does not get there. */
static void accuracy__the_plain_path_loses_it(mt_test *t)
{
    for (int r = 0; r < MT_COUNT(rows); r++) {
        chain s;
        mt_modes modes;
        mt_test_row(t, "%s", rows[r].name);
        build(&s, rows[r].k, masses);
        const double want = holzer(rows[r].k, masses);
        if (!CHECK(t, solve_pair(N, s.k, s.m, NULL, NULL, &mem, &modes, NULL) == MT_OK)) {
            continue;
        }
        const double error = fabs(modes.lambda[rows[r].rigid] - want);
        CHECK_INT(t, error > WANTED * want, rows[r].plain_fails);
        CHECK(t, error <= modes.error_bound + modes.error_relative * want);
    }
}

/* The caller says what the lowest mode may lose: a soft spring at the wall, k1 of the stiffness
 * of the others, makes eps s / lambda some eps 10 / k1. */
static void accuracy__the_factor_is_used_from_there_on_only(mt_test *t)
{
    static const double soft[] = {1e-2, 3e-4, 1e-6};
    static const double accuracies[] = {0.0, 1e-10, MT_MODAL_ACCURACY};
    static const bool used[][MT_COUNT(accuracies)] = {
        {false, false, false}, {false, false, true}, {false, true, true}};
    for (int r = 0; r < MT_COUNT(soft); r++) {
        const double k[N] = {soft[r], 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
        const double want = holzer(k, masses);
        chain s;
        build(&s, k, masses);
        const mt_stiffness_factor factor = {.rows = s.springs, .b = s.b, .c = s.c};
        for (int a = 0; a < MT_COUNT(accuracies); a++) {
            mt_modes modes;
            mt_modal_options opt = mt_modal_options_default();
            mt_test_row(t, "spring of %g, accuracy %g", soft[r], accuracies[a]);
            opt.accuracy = accuracies[a];
            REQUIRE(t, solve_pair(N, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK);
            CHECK_INT(t, modes.from_factor, used[r][a]);
            CHECK(t, fabs(modes.lambda[0] - want) <= modes.error[0]);
            CHECK(t, a == 0 || fabs(modes.lambda[0] - want) <= accuracies[a] * want);
        }
    }
}

/* Redundant springs in parallel, springs of no stiffness, more rows than freedoms: rank is that
 * of the active rows. */
static void accuracy__rank_of_the_factor_counts_rigid_body_modes(mt_test *t)
{
    static const struct {
        const char *name;
        double closing; /* of the ring */
        double support;
        int rigid;
    } cases[] = {
        {"ring", 1e-8, 0.0, 1}, {"open ring", 0.0, 0.0, 1}, {"held ring", 1e4, 1e-6, 0}};
    for (int r = 0; r < MT_COUNT(cases); r++) {
        chain s;
        mt_modes modes;
        mt_modal_options opt = mt_modal_options_default();
        mt_test_row(t, "%s", cases[r].name);
        chain_line(&s, 6, 1.0, 1e4, 0);
        chain_spring(&s, 5, 0, cases[r].closing);
        chain_spring(&s, GROUND, 0, cases[r].support);
        chain_spring(&s, 0, 1, 1e4); /* parallel to the first */
        chain_factor(&s);
        const mt_stiffness_factor factor = {.rows = s.springs, .b = s.b, .c = s.c};
        opt.accuracy = MT_MODAL_ACCURACY;
        if (!CHECK(t, solve_pair(6, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK)) {
            continue;
        }
        CHECK(t, modes.from_factor);
        CHECK_INT(t, modes.n_rigid, cases[r].rigid);
        CHECK_NEAR_ABS(t, modes.lambda[0], cases[r].rigid ? 0.0 : 1e-6 / 6.0, 1e-15);
    }
}

static void accuracy__factor_of_no_stiffness_is_all_rigid(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_modal_options opt = mt_modal_options_default();
    chain_start(&s, 3, 2.0);
    chain_spring(&s, GROUND, 0, 0.0);
    chain_factor(&s);
    mt_stiffness_factor factor = {.rows = 1, .b = s.b, .c = s.c};
    opt.accuracy = MT_MODAL_ACCURACY;
    REQUIRE(t, solve_pair(3, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK);
    CHECK_INT(t, modes.n_rigid, 3);
    for (int i = 0; i < 3; i++) {
        CHECK(t, modes.orthogonality[i] <= 10.0);
        CHECK(t, modes.residual[i] <= 10.0);
    }
    s.c[0] = -1.0;
    CHECK_INT(t, solve_pair(3, s.k, s.m, &factor, &opt, &mem, &modes, NULL), MT_E_DOMAIN);
    s.c[0] = 1.0;
    s.b[1] = nan("");
    CHECK_INT(t, solve_pair(3, s.k, s.m, &factor, &opt, &mem, &modes, NULL), MT_E_DOMAIN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(accuracy__spring_factors_keep_the_lowest_mode),
        MT_TEST(accuracy__the_plain_path_loses_it),
        MT_TEST(accuracy__the_factor_is_used_from_there_on_only),
        MT_TEST(accuracy__rank_of_the_factor_counts_rigid_body_modes),
        MT_TEST(accuracy__factor_of_no_stiffness_is_all_rigid),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
