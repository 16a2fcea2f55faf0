/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals under equalities: min 1/2 |r|^2 subject to eq = 0. */
#include "nlp_problem.h"

/*
 * Linear: r = J t - b, eq = sum t - 1. Closed form with J diagonal d:
 * d_i (d_i t_i - b_i) = lambda, so t_i = (lambda/d_i + b_i)/d_i and sum t_i = 1 gives lambda.
 */
enum { LINEAR_N = 4 };
static const double DIAGONAL[LINEAR_N] = {1, 2, 4, 0.5};
static const double RHS[LINEAR_N] = {0.3, -0.2, 0.5, 0.1};

static void linear(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = nan(""); /* must be ignored */
    if (c->nlp.n_eq > 0) {
        out->eq[0] = -1;
    }
    for (int i = 0; i < LINEAR_N; i++) {
        out->r[i] = DIAGONAL[i] * t[i] - RHS[i];
        for (int j = 0; j < LINEAR_N; j++) {
            out->dr[i + j * LINEAR_N] = i == j ? DIAGONAL[i] : 0;
        }
        if (c->nlp.n_eq > 0) {
            out->eq[0] += t[i];
            out->deq[i] = 1;
        }
    }
}

static void nlp_identification__linear_matches_closed_form(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, LINEAR_N, linear, -5, 5);
    c.nlp.n_eq = 1;
    c.nlp.n_res = LINEAR_N;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    double inverse = 0;
    double sum = 0;
    for (int i = 0; i < LINEAR_N; i++) {
        inverse += 1 / (DIAGONAL[i] * DIAGONAL[i]);
        sum += RHS[i] / DIAGONAL[i];
    }
    const double lambda = (1 - sum) / inverse;
    const mt_nlp_solution *const s = &c.result.solutions[0];
    for (int i = 0; i < LINEAR_N; i++) {
        const double want = (lambda / DIAGONAL[i] + RHS[i]) / DIAGONAL[i];
        CHECK_NEAR_ABS(t, s->t[i], want, 1e-9);
    }
    CHECK_NEAR(t, s->mult_eq[0], lambda, 1e-9);
    CHECK(t, s->kkt < 1e-9 && s->feasible);
    CHECK_INT(t, c.result.n_unidentifiable, 0);
    mt_arena_free(&c.mem);
}

static void nlp_identification__without_equalities_is_least_squares(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, LINEAR_N, linear, -5, 5);
    c.nlp.n_res = LINEAR_N;
    c.upper[2] = 0.1; /* free optimum 0.125 */
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1);
    for (int i = 0; i < LINEAR_N; i++) {
        const double want = i == 2 ? 0.1 : RHS[i] / DIAGONAL[i];
        CHECK_NEAR_ABS(t, c.result.solutions[0].t[i], want, 1e-12);
    }
    CHECK_NEAR(t, c.result.solutions[0].mult_bound[2], 4 * (4 * 0.1 - 0.5), 1e-9);
    mt_arena_free(&c.mem);
}

/*
 * Nonlinear, residual not zero: the point of the parabola t1 = t0^2 nearest to (p, q) in curved
 * coordinates r = (sinh(t0) - sinh(p), t1 - q). Along the parabola, with x = t0:
 * (sinh x - sinh p) cosh x + 2 x (x^2 - q) = 0, solved by bisection here.
 */
static const double P = 1.0;
static const double Q = 2.0;

static void parabola(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    (void)c;
    out->r[0] = sinh(t[0]) - sinh(P);
    out->r[1] = t[1] - Q;
    out->dr[0] = cosh(t[0]);
    out->dr[1] = 0;
    out->dr[2] = 0;
    out->dr[3] = 1;
    out->eq[0] = t[1] - t[0] * t[0];
    out->deq[0] = -2 * t[0];
    out->deq[1] = 1;
}

static double parabola_slope(double x)
{
    return (sinh(x) - sinh(P)) * cosh(x) + 2 * x * (x * x - Q);
}

static void nlp_identification__nonlinear_converges_to_1e9(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, parabola, -3, 9);
    c.nlp.n_eq = 1;
    c.nlp.n_res = 2;
    c.upper[0] = 3;
    c.origin[0] = 0.5;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions >= 1);
    double low = 1;
    double high = 1.5;
    REQUIRE(t, parabola_slope(low) < 0 && parabola_slope(high) > 0);
    for (int i = 0; i < 60; i++) {
        const double mid = 0.5 * (low + high);
        *(parabola_slope(mid) < 0 ? &low : &high) = mid;
    }
    const mt_nlp_solution *const s = &c.result.solutions[0];
    CHECK_NEAR_ABS(t, s->t[0], low, 1e-9);
    CHECK_NEAR_ABS(t, s->t[1], low * low, 1e-9);
    CHECK(t, s->f > 0.01 && s->violation < 1e-6 && s->kkt < 1e-9);
    mt_arena_free(&c.mem);
}

/* Parameter estimation like a misfit of shapes: y_k = a exp(-b x_k) sampled with a known error,
 * a, b in logarithms; the gradient of 1/2 |r|^2 at the end must vanish, by the callback
 * itself. */
enum { SAMPLES = 12 };
static void decay(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    (void)c;
    const double a = exp(t[0]);
    const double b = exp(t[1]);
    for (int k = 0; k < SAMPLES; k++) {
        const double x = 0.25 * k;
        const double y = 2 * exp(-0.7 * x) + 0.05 * cos(5 * x);
        const double m = a * exp(-b * x);
        out->r[k] = m - y;
        out->dr[k] = m;
        out->dr[k + SAMPLES] = -m * b * x;
        out->dr[k + 2 * SAMPLES] = 0; /* t2 is not seen */
    }
}

static void nlp_identification__misfit_with_an_unseen_parameter(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 3, decay, -3, 3);
    c.nlp.n_res = SAMPLES;
    c.origin[2] = -0.25;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK_INT(t, c.result.n_unidentifiable, 1);
    REQUIRE(t, c.result.n_solutions == 1);
    const mt_nlp_solution *const s = &c.result.solutions[0];
    CHECK(t, s->t[2] == -0.25);
    double r[SAMPLES];
    double dr[3 * SAMPLES];
    mt_nlp_values v = {.r = r, .dr = dr};
    decay(&c, s->t, &v);
    for (int j = 0; j < 2; j++) {
        double g = 0;
        for (int k = 0; k < SAMPLES; k++) {
            g += r[k] * dr[k + j * SAMPLES];
        }
        CHECK_NEAR_ABS(t, g, 0, 1e-12);
    }
    CHECK_NEAR(t, exp(s->t[0]), 2, 0.1);
    CHECK(t, s->kkt < 1e-9 && !s->singular);
    mt_arena_free(&c.mem);
}

/* No residual is left, and only t0 + t1 is seen: all starts end at one design, the nearest to
 * the origin of those without misfit. */
static void product(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->r[0] = log(sqrt(exp(t[0]) * exp(t[1])) / c->target[0]); /* as of a frequency */
    out->r[1] = sinh(t[2]) - 0.7;
    memset(out->dr, 0, 6 * sizeof *out->dr);
    out->dr[0] = 0.5;
    out->dr[2] = 0.5;
    out->dr[5] = cosh(t[2]);
}

static void nlp_identification__what_an_exact_fit_does_not_see_stays_at_the_origin(mt_test *t)
{
    for (int k = 0; k < 20; k++) { /* it is a matter of rounding what is left of a misfit */
        const double y = 2 + 0.1 * k;
        nlp_case c = {0};
        case_begin(&c, 3, product, -3, 3);
        c.nlp.n_res = 2;
        c.target[0] = y;
        c.origin[0] = 0.3;
        c.origin[1] = -0.2;
        REQUIRE(t, case_solve(&c, NULL) == MT_OK);
        CHECK_INT(t, c.result.n_unidentifiable, 1);
        CHECK_INT(t, c.result.n_solutions, 1);
        CHECK_NEAR(t, c.result.solutions[0].t[0], log(y) + 0.25, 1e-12);
        CHECK_NEAR(t, c.result.solutions[0].t[1], log(y) - 0.25, 1e-12);
        CHECK_NEAR(t, c.result.solutions[0].t[2], asinh(0.7), 1e-12);
        mt_arena_free(&c.mem);
    }
}

MT_TEST_MAIN(MT_TEST(nlp_identification__linear_matches_closed_form),
             MT_TEST(nlp_identification__without_equalities_is_least_squares),
             MT_TEST(nlp_identification__nonlinear_converges_to_1e9),
             MT_TEST(nlp_identification__misfit_with_an_unseen_parameter),
             MT_TEST(nlp_identification__what_an_exact_fit_does_not_see_stays_at_the_origin))
