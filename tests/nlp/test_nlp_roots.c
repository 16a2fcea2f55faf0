/* SPDX-License-Identifier: GPL-3.0-or-later */
/* As many equalities as variables: all roots, double roots, dependent equalities. */
#include "nlp_problem.h"

/*
 * Two unit masses in a row on springs k1 (to ground) and k2 (between): K = [[k1+k2, -k2], [-k2,
 * k2]], lambda = (a -+ s)/2, a = k1 + 2 k2, s = sqrt(a^2 - 4 k1 k2). t = ln k, eq_i =
 * ln(lambda_i/target_i)/2, the logarithm of a frequency ratio. sum a and product k1 k2 give a
 * quadratic for k1: two designs have the same frequencies.
 */
static void chain(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const double k1 = exp(t[0]);
    const double k2 = exp(t[1]);
    const double a = k1 + 2 * k2;
    const double s = sqrt(k1 * k1 + 4 * k2 * k2); /* a^2 - 4 k1 k2 */
    const double hi = 0.5 * (a + s);
    const double lo = k1 * k2 / hi; /* no cancellation */
    const double ds[2] = {k1 * k1 / s, 4 * k2 * k2 / s};
    const double da[2] = {k1, 2 * k2};
    const ptrdiff_t n_eq = c->nlp.n_eq;
    change(c, t, out);
    out->eq[0] = 0.5 * log(lo / c->target[0]);
    out->eq[1] = 0.5 * log(hi / c->target[1]);
    for (int j = 0; j < 2; j++) {
        const double dhi = 0.25 * (da[j] + ds[j]) / hi;
        out->deq[1 + j * n_eq] = dhi;
        out->deq[j * n_eq] = 0.5 - dhi;
    }
    for (int j = 2; j < c->nlp.n; j++) { /* variables without influence */
        out->deq[j * n_eq] = 0;
        out->deq[1 + j * n_eq] = 0;
    }
    for (int i = 2; i < n_eq; i++) { /* repeated equalities */
        out->eq[i] = out->eq[i - 2];
        for (int j = 0; j < c->nlp.n; j++) {
            out->deq[i + j * n_eq] = out->deq[i - 2 + j * n_eq];
        }
    }
}

static void chain_case(nlp_case *c, double target_lo, double target_hi)
{
    case_begin(c, 2, chain, log(0.1), log(20.0));
    c->nlp.n_eq = 2;
    c->target[0] = target_lo;
    c->target[1] = target_hi;
    c->origin[0] = log(2.8); /* nearer to (3, 1) than to (2, 1.5) */
    c->origin[1] = log(0.9);
}

static void nlp_roots__chain_finds_both_spring_pairs_ranked(mt_test *t)
{
    nlp_case c = {0};
    chain_case(&c, 0.6972243623, 4.3027756377);
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_solutions, 2);
    CHECK(t, !c.result.compromise);
    CHECK_INT(t, c.result.n_unidentifiable, 0);
    CHECK_INT(t, c.result.stop, MT_STOP_DONE);
    CHECK_INT(t, c.result.evals, c.calls);
    static const double want[2][2] = {{3, 1}, {2, 1.5}};
    for (int i = 0; i < 2 && i < c.result.n_solutions; i++) {
        const mt_nlp_solution *const s = &c.result.solutions[i];
        mt_test_row(t, "solution %d", i + 1);
        /* the targets have 10 digits, the sensitivity of the roots is about 10 */
        CHECK_NEAR(t, exp(s->t[0]), want[i][0], 1e-8);
        CHECK_NEAR(t, exp(s->t[1]), want[i][1], 1e-8);
        CHECK(t, s->feasible && s->violation < 1e-6 && !s->singular);
        CHECK(t, isnan(s->kkt));
        CHECK_INT(t, s->bound[0], 0);
    }
    mt_arena_free(&c.mem);
}

static void nlp_roots__double_root_is_one_singular_solution(mt_test *t)
{
    nlp_case c = {0};
    chain_case(&c, 2 - sqrt(2), 2 + sqrt(2));
    for (unsigned long seed = 1; seed < 6; seed++) {
        mt_test_row(t, "seed %lu", seed);
        mt_nlp_options opt = mt_nlp_options_default();
        opt.seed = seed;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK_INT(t, c.result.n_solutions, 1);
        CHECK_INT(t, c.result.n_unidentifiable, 0);
        if (c.result.n_solutions > 0) {
            const mt_nlp_solution *const s = &c.result.solutions[0];
            CHECK_NEAR(t, exp(s->t[0]), 2, 1e-4);
            CHECK_NEAR(t, exp(s->t[1]), 1, 1e-4);
            CHECK(t, s->singular);
        }
    }
    mt_arena_free(&c.mem);
}

/* Just below and just above the fold: no root, or two roots 2 sqrt(d) apart. */
static void nlp_roots__near_the_fold_roots_are_told_apart_or_absent(mt_test *t)
{
    nlp_case c = {0};
    chain_case(&c, (2 - sqrt(2)) * 1.001, (2 + sqrt(2)) / 1.001 * 0.999);
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK(t, c.result.n_solutions >= 1 && !c.result.solutions[0].feasible);
    chain_case(&c, (2 - sqrt(2)) * 0.999, (2 + sqrt(2)) * 1.001);
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_solutions, 2);
    CHECK(t, !c.result.solutions[0].singular);
    mt_arena_free(&c.mem);
}

static void nlp_roots__repeated_equalities_change_nothing(mt_test *t)
{
    nlp_case c = {0};
    chain_case(&c, 0.6972243623, 4.3027756377);
    c.nlp.n_eq = 4;
    c.target[2] = c.target[0];
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_solutions, 2);
    CHECK(t, !c.result.solutions[0].singular);
    CHECK_NEAR(t, exp(c.result.solutions[0].t[0]), 3, 1e-8);
    CHECK(t, isnan(c.result.solutions[0].mult_eq[0])); /* shared with equality 2: not unique */
    mt_arena_free(&c.mem);
}

static void nlp_roots__variable_without_influence_stays_exactly(mt_test *t)
{
    nlp_case c = {0};
    for (int row = 0; row < 2; row++) {
        /* 4 equalities >= 3 variables: least squares; 2 equalities: SLSQP */
        mt_test_row(t, "%s", row == 0 ? "least squares" : "SLSQP");
        chain_case(&c, 0.6972243623, 4.3027756377);
        c.nlp.n = 3;
        c.nlp.n_eq = row == 0 ? 4 : 2;
        c.origin[2] = 0.123;
        REQUIRE(t, case_solve(&c, NULL) == MT_OK);
        CHECK_INT(t, c.result.n_solutions, 2);
        CHECK_INT(t, c.result.n_unidentifiable, 1);
        for (int i = 0; i < c.result.n_solutions; i++) {
            CHECK(t, c.result.solutions[i].t[2] == 0.123);
            CHECK(t, !c.result.solutions[i].singular);
        }
        if (c.result.n_unidentifiable == 1) {
            CHECK(t, c.result.unidentifiable[0] == 0 && c.result.unidentifiable[1] == 0 &&
                         c.result.unidentifiable[2] == 1);
            CHECK(t, c.result.unidentifiable_effect[0] == 0);
        }
        CHECK_NEAR(t, exp(c.result.solutions[0].t[0]), 3, 1e-8);
    }
    mt_arena_free(&c.mem);
}

/* A root at a bound is found there, and bounds cut the other one off. */
static void nlp_roots__bounds_are_respected(mt_test *t)
{
    nlp_case c = {0};
    chain_case(&c, 0.6972243623, 4.3027756377);
    c.upper[0] = log(2.5);
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK_NEAR(t, exp(c.result.solutions[0].t[0]), 2, 1e-8);
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_roots__chain_finds_both_spring_pairs_ranked),
             MT_TEST(nlp_roots__double_root_is_one_singular_solution),
             MT_TEST(nlp_roots__near_the_fold_roots_are_told_apart_or_absent),
             MT_TEST(nlp_roots__repeated_equalities_change_nothing),
             MT_TEST(nlp_roots__variable_without_influence_stays_exactly),
             MT_TEST(nlp_roots__bounds_are_respected))
