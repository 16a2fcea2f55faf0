/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fewer equalities than variables, inequalities, objectives: minima, multipliers, ranking. */
#include "nlp_problem.h"

/* Distance of the origin from the ellipse-like curve t0^2/4 + t1^2 = 1; t2 (if any) is free. */
static void ellipse(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = 0.25 * t[0] * t[0] + t[1] * t[1] - 1;
    for (int j = 0; j < c->nlp.n; j++) {
        out->deq[j] = 0;
    }
    out->deq[0] = 0.5 * t[0];
    out->deq[1] = 2 * t[1];
}

/*
 * From (d, 0), 0 < d < 3/2, the distance has minima at (4 d/3, +-sqrt(1 - 4 d^2/9));
 * the vertices (2, 0) and (-2, 0) are maxima along the curve.
 */
static void nlp_change__both_minima_are_kept_and_vertices_are_not(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 3, ellipse, -3, 3);
    c.nlp.n_eq = 1;
    c.origin[0] = 0.3;
    c.origin[2] = 0.7;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 2);
    CHECK_INT(t, c.result.n_unidentifiable, 1);
    for (int i = 0; i < 2; i++) {
        const mt_nlp_solution *const s = &c.result.solutions[i];
        CHECK_NEAR(t, s->t[0], 0.4, 1e-11);
        CHECK_NEAR(t, fabs(s->t[1]), sqrt(1 - 0.04), 1e-11);
        CHECK(t, s->t[2] == 0.7);
        /* grad f = (0.1, t1) = lambda (t0/2, 2 t1) */
        CHECK_NEAR(t, s->mult_eq[0], 0.5, 1e-9);
        CHECK(t, s->kkt < 1e-9 && s->violation < 1e-6 && !s->singular);
    }
    CHECK(t, c.result.solutions[0].t[1] * c.result.solutions[1].t[1] < 0);
    mt_arena_free(&c.mem);
}

static void nlp_change__minima_are_ranked_by_change(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, ellipse, -3, 3);
    c.nlp.n_eq = 1;
    c.origin[1] = 0.2; /* minima (0, 1) and (0, -1), changes 0.8 and 1.2 */
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 2);
    CHECK_NEAR(t, c.result.solutions[0].t[1], 1, 1e-11);
    CHECK_NEAR(t, c.result.solutions[0].f, 0.5 * 0.8 * 0.8, 1e-10);
    CHECK_NEAR(t, c.result.solutions[1].t[1], -1, 1e-11);
    CHECK_NEAR_ABS(t, c.result.solutions[1].t[0], 0, 1e-10);
    mt_arena_free(&c.mem);
}

/* The start at the origin, on the axis of symmetry, leads to the saddle (0, 1): one start
 * only. */
static void nlp_change__saddle_is_left(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, ellipse, -3, 3);
    c.nlp.n_eq = 1;
    /* towards the vertex (2, 0), a maximum of the distance along the curve: 4/3 < 2 */
    c.origin[0] = 1.0;
    mt_nlp_options opt = mt_nlp_options_default();
    opt.starts = 1;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    CHECK_NEAR(t, c.result.solutions[0].t[0], 4.0 / 3, 1e-10);
    mt_arena_free(&c.mem);
}

/* Many variables, of which the first two lie on the ellipse: two minima, and a Hessian costs
 * MANY - 1 gradients. */
enum { MANY = 24 };
static void many(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    ellipse(c, t, out);
    out->f = 0;
    for (int j = 0; j < MANY; j++) {
        out->f += cosh(t[j] - 0.1);
        out->df[j] = sinh(t[j] - 0.1);
    }
}

/* Newton's method is done once for each minimum, however many starts lead there: a start more
 * costs much less than a Hessian. */
static void nlp_change__a_minimum_is_polished_once(mt_test *t)
{
    static const int starts[] = {16, 56};
    long evals[MT_COUNT(starts)];
    for (int k = 0; k < MT_COUNT(starts); k++) {
        nlp_case c = {0};
        case_begin(&c, MANY, many, -2, 2);
        c.nlp.n_eq = 1;
        mt_nlp_options opt = mt_nlp_options_default();
        opt.starts = starts[k];
        opt.least_change = false;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK_INT(t, c.result.n_solutions, 2);
        CHECK(t, c.result.solutions[1].kkt < 1e-12);
        evals[k] = c.result.evals;
        mt_arena_free(&c.mem);
    }
    CHECK(t, evals[1] - evals[0] < (starts[1] - starts[0]) * (MANY - 1) * 3 / 4);
}

/*
 * Truss-like: n bars of area exp(t_i), weight sum exp(t_i), stress a_i exp(-t_i) <= 1 as
 * in_i = t_i - ln a_i >= 0, and one displacement, sum b_i exp(-t_i) <= D as in_n = 1 - sum/D.
 * With only the displacement active: exp(t_i) = sqrt(b_i) sum_j sqrt(b_j) / D.
 */
enum { BARS = 5 };
static const double A[BARS] = {0.1, 0.2, 7.0, 0.1, 0.3};
static const double B[BARS] = {1, 4, 2, 9, 0.25};
static const double D = 2;

static void truss(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    (void)c;
    out->f = 0;
    out->in[BARS] = 1;
    for (int i = 0; i < BARS; i++) {
        out->f += exp(t[i]);
        out->df[i] = exp(t[i]);
        out->in[i] = t[i] - log(A[i]);
        for (int j = 0; j < BARS; j++) {
            out->din[i + j * (BARS + 1)] = i == j;
        }
        out->in[BARS] -= B[i] * exp(-t[i]) / D;
        out->din[BARS + i * (BARS + 1)] = B[i] * exp(-t[i]) / D;
    }
}

static void nlp_change__weight_under_inequalities_from_an_infeasible_start(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, BARS, truss, log(0.01), log(100.0));
    c.nlp.n_in = BARS + 1;
    for (int i = 0; i < BARS; i++) {
        c.origin[i] = log(0.02); /* violates everything */
    }
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    /* bar 2 is held by its stress (area 7), the others by the displacement left, D - 2/5 */
    const double left = D - B[2] / A[2];
    double root = 0;
    for (int i = 0; i < BARS; i++) {
        root += i == 2 ? 0 : sqrt(B[i]);
    }
    const mt_nlp_solution *const s = &c.result.solutions[0];
    for (int i = 0; i < BARS; i++) {
        mt_test_row(t, "bar %d", i);
        CHECK_NEAR(t, exp(s->t[i]), i == 2 ? A[2] : sqrt(B[i]) * root / left, 1e-9);
        if (i != 2) {
            CHECK(t, s->mult_in[i] == 0);
        }
    }
    /* dW/dD scaled: lambda = D root^2 / left^2; bar 2: 5 - lambda B/(A D) */
    const double lambda = D * root * root / (left * left);
    CHECK_NEAR(t, s->mult_in[BARS], lambda, 1e-8);
    CHECK_NEAR(t, s->mult_in[2], A[2] - lambda * B[2] / (A[2] * D), 1e-8);
    CHECK(t, s->feasible && s->kkt < 1e-9);
    mt_arena_free(&c.mem);
}

/* With a bound in place of a stress, its multiplier is the bound's. */
static void nlp_change__active_bound_has_its_multiplier(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, BARS, truss, log(0.01), log(100.0));
    c.nlp.n_in = BARS + 1;
    c.upper[3] = log(8.0); /* free optimum above */
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    const mt_nlp_solution *const s = &c.result.solutions[0];
    CHECK_INT(t, s->bound[3], 1);
    CHECK(t, s->t[3] == c.upper[3]);
    CHECK(t, s->mult_bound[3] < -0.1);
    CHECK_INT(t, s->bound[0], 0);
    CHECK(t, s->mult_bound[0] == 0);
    CHECK(t, s->kkt < 1e-9);
    mt_arena_free(&c.mem);
}

/* t between two limits that meet at 1, where 2 is wished: the first would push the wrong way,
 * and is left out; the second holds. */
static void wall(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->in[0] = t[0] - 1.0;
    out->din[0] = 1.0;
    out->in[1] = 1.0 - t[0];
    out->din[1] = -1.0;
}

static void nlp_change__of_two_limits_the_one_that_holds_has_a_multiplier(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 1, wall, -3, 3);
    c.nlp.n_in = 2;
    c.origin[0] = 2;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    const mt_nlp_solution *const s = &c.result.solutions[0];
    CHECK_NEAR(t, s->t[0], 1.0, 2e-6);
    CHECK_NEAR_ABS(t, s->mult_in[0], 0.0, 1e-9);
    CHECK_NEAR(t, s->mult_in[1], 1.0, 1e-5);
    CHECK(t, s->kkt < 1e-6);
    mt_arena_free(&c.mem);
}

/* r = (t - 1, 2 t + 2): least at t = -3/5, where |r|^2/2 = 8/5. */
static void residuals(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->r[0] = t[0] - 1.0;
    out->r[1] = (2.0 * t[0]) + 2.0;
    out->dr[0] = 1.0;
    out->dr[1] = 2.0;
}

static void nlp_change__a_misfit_is_half_the_sum_of_squares(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 1, residuals, -3, 3);
    c.nlp.n_res = 2;
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    CHECK_NEAR(t, c.result.solutions[0].t[0], -0.6, 1e-9);
    CHECK_NEAR(t, c.result.solutions[0].f, 1.6, 1e-9);
    mt_arena_free(&c.mem);
}

/* Feasible already: nothing changes, exactly. */
static void nlp_change__feasible_origin_is_the_answer(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, ellipse, -3, 3);
    c.nlp.n_eq = 1;
    c.origin[1] = 1;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions >= 1);
    CHECK(t, c.result.solutions[0].t[0] == 0 && c.result.solutions[0].t[1] == 1);
    CHECK(t, c.result.solutions[0].f == 0);
    CHECK(t, c.result.solutions[0].kkt < 1e-9);
    mt_arena_free(&c.mem);
}

/* Only a product is seen: t0 + t1 - s = 0 leaves the least change, and nothing is undetermined
 * for the objective; with an objective that is constant, (1, -1)/sqrt 2 is. */
static void product(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = sin(t[0] + t[1]) - 0.5;
    out->deq[0] = cos(t[0] + t[1]);
    out->deq[1] = out->deq[0];
}

static void nlp_change__combination_without_influence_is_named(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, product, -0.5, 0.5);
    c.nlp.n_eq = 1;
    c.origin[0] = 0.1;
    mt_nlp_options opt = mt_nlp_options_default();
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_unidentifiable == 1);
    CHECK_NEAR(t, c.result.unidentifiable[0], sqrt(0.5), 1e-12);
    CHECK_NEAR(t, c.result.unidentifiable[1], -sqrt(0.5), 1e-12);
    CHECK(t, c.result.unidentifiable_effect[0] < 1e-6);
    REQUIRE(t, c.result.n_solutions == 1);
    const double s = asin(0.5); /* both move by (s - 0.1)/2 */
    CHECK_NEAR(t, c.result.solutions[0].t[0], 0.1 + (s - 0.1) / 2, 1e-9);
    CHECK_NEAR(t, c.result.solutions[0].t[1], (s - 0.1) / 2, 1e-9);
    opt.least_change = false; /* the objective counts: it does see the direction */
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    CHECK_INT(t, c.result.n_unidentifiable, 0);
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_change__both_minima_are_kept_and_vertices_are_not),
             MT_TEST(nlp_change__minima_are_ranked_by_change),
             MT_TEST(nlp_change__saddle_is_left),
             MT_TEST(nlp_change__a_minimum_is_polished_once),
             MT_TEST(nlp_change__weight_under_inequalities_from_an_infeasible_start),
             MT_TEST(nlp_change__active_bound_has_its_multiplier),
             MT_TEST(nlp_change__of_two_limits_the_one_that_holds_has_a_multiplier),
             MT_TEST(nlp_change__a_misfit_is_half_the_sum_of_squares),
             MT_TEST(nlp_change__feasible_origin_is_the_answer),
             MT_TEST(nlp_change__combination_without_influence_is_named))
