/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where optimisers go wrong: bad starts, missing values, budgets, failing callbacks, equal
 * bytes. */
#include "nlp/merit.h"
#include "nlp_problem.h"

enum { TUTORIAL_SIDE = 5 };

/*
 * NLopt's tutorial: min sqrt(y) subject to y >= (2 x)^3, y >= (1 - x)^3; optimum (1/3, 8/27).
 * sqrt has no gradient at y = 0 and no value below.
 */
static mt_status tutorial(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    nlp_case *const c = context;
    (void)with_gradient;
    c->calls++;
    if (t[1] < 0) {
        return mt_fail(err, MT_E_DOMAIN, "root of %g", t[1]);
    }
    const double u = 2 * t[0];
    const double v = 1 - t[0];
    out->f = sqrt(t[1]);
    out->df[0] = 0;
    out->df[1] = 0.5 / sqrt(t[1]); /* infinite at 0: not a finite value */
    out->in[0] = t[1] - u * u * u;
    out->in[1] = t[1] - v * v * v;
    out->din[0] = -6 * u * u;
    out->din[1] = 3 * v * v;
    out->din[2] = 1;
    out->din[3] = 1;
    return MT_OK;
}

static void nlp_robust__tutorial_is_solved_from_every_start(mt_test *t)
{
    nlp_case c = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.starts = 1;
    opt.least_change = false;
    for (int k = 0; k < TUTORIAL_SIDE * TUTORIAL_SIDE; k++) {
        case_begin(&c, 2, NULL, -10, 10);
        c.nlp.eval = tutorial;
        c.nlp.n_in = 2;
        c.origin[0] = -8 + 4 * (k % TUTORIAL_SIDE);
        c.origin[1] = 0.01 + 2.4 * (k - k % TUTORIAL_SIDE) / TUTORIAL_SIDE;
        mt_test_row(t, "from %g, %g", c.origin[0], c.origin[1]);
        if (!CHECK(t, case_solve(&c, &opt) == MT_OK && c.result.n_solutions == 1)) {
            continue;
        }
        const mt_nlp_solution *const s = &c.result.solutions[0];
        CHECK_NEAR(t, s->t[0], 1.0 / 3, 1e-9);
        CHECK_NEAR(t, s->t[1], 8.0 / 27, 1e-9);
        CHECK(t, s->feasible && s->mult_in[0] > 0 && s->mult_in[1] > 0);
    }
    mt_arena_free(&c.mem);
}

/* Values only inside a ring around the circle that is asked for; the origin is inside it. */
static void ring(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const double rr = t[0] * t[0] + t[1] * t[1];
    change(c, t, out);
    out->eq[0] = log(rr - 0.5) - log(0.5); /* rr = 1; NaN inside rr < 1/2 */
    out->deq[0] = 2 * t[0] / (rr - 0.5);
    out->deq[1] = 2 * t[1] / (rr - 0.5);
    if (rr > 2) {
        out->f = nan("");
    }
}

static void nlp_robust__regions_without_values_are_left(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, ring, -3, 3);
    c.nlp.n_eq = 1;
    c.origin[0] = -1.3;
    c.origin[1] = 0.1;
    for (int starts = 1; starts <= 9; starts += 8) {
        mt_test_row(t, "%d starts", starts);
        mt_nlp_options opt = mt_nlp_options_default();
        opt.starts = starts;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_solutions >= 1);
        const double r = hypot(1.3, 0.1);
        CHECK_NEAR(t, c.result.solutions[0].t[0], -1.3 / r, 1e-9);
        CHECK_NEAR(t, c.result.solutions[0].t[1], 0.1 / r, 1e-9);
    }
    mt_arena_free(&c.mem);
}

static mt_status nowhere(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                         mt_err *err)
{
    nlp_case *const c = context;
    (void)t;
    (void)with_gradient;
    (void)out;
    c->calls++;
    return mt_fail(err, MT_E_EQUILIBRIUM, "no equilibrium here");
}

static void nlp_robust__no_value_anywhere_is_the_callbacks_error(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, NULL, -1, 1);
    c.nlp.eval = nowhere;
    c.nlp.n_eq = 1;
    REQUIRE(t, mt_arena_init(&c.mem, 0, NULL) == MT_OK);
    const mt_nlp_options opt = mt_nlp_options_default();
    mt_err err = {MT_OK, ""};
    CHECK_INT(t, mt_nlp_solve(&c.nlp, &opt, &c.mem, &c.result, &err), MT_E_EQUILIBRIUM);
    CHECK_STR(t, err.text, "no start of the search has a value: no equilibrium here");
    mt_arena_free(&c.mem);
}

/* A valley with several minima under an equality: enough work for budgets and failures. */
static mt_status fatal_rc;
static long fatal_call;

static mt_status bumps(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                       mt_err *err)
{
    nlp_case *const c = context;
    (void)with_gradient;
    if (++c->calls == fatal_call) {
        return mt_fail(err, fatal_rc, "planted");
    }
    out->f = 0;
    out->eq[0] = -0.5;
    for (int j = 0; j < c->nlp.n; j++) {
        out->f += 0.1 * t[j] * t[j] + cos(3 * t[j] + j);
        out->df[j] = 0.2 * t[j] - 3 * sin(3 * t[j] + j);
        out->eq[0] += t[j] * t[j] * 0.2;
        out->deq[j] = 0.4 * t[j];
    }
    return MT_OK;
}

static void bumps_case(nlp_case *c, int n)
{
    case_begin(c, n, NULL, -3, 3);
    c->nlp.eval = bumps;
    c->nlp.n_eq = 1;
    for (int j = 0; j < n; j++) {
        c->origin[j] = 0.1 * j;
    }
    fatal_call = -1;
}

/* Every start has an even share of the budget, so a start that ends early leaves some
 * unused. */
static void nlp_robust__budget_is_never_exceeded(mt_test *t)
{
    nlp_case c = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    bumps_case(&c, 4);
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    const long all = c.calls;
    CHECK_INT(t, c.result.evals, all);
    CHECK_INT(t, c.result.stop, MT_STOP_DONE);
    for (long most = 1; most < all; most += 1 + most / 3) {
        mt_test_row(t, "%ld of %ld evaluations", most, all);
        bumps_case(&c, 4);
        opt.max_evals = most;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        CHECK(t, c.calls <= most);
        CHECK_INT(t, c.result.evals, c.calls);
        CHECK_INT(t, c.result.stop, MT_STOP_MAX_EVALS);
        CHECK(t, c.result.n_solutions >= 1);
    }
    mt_arena_free(&c.mem);
}

static void nlp_robust__failures_of_the_callback_end_the_search(mt_test *t)
{
    nlp_case c = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    static const mt_status codes[] = {MT_E_MEMORY, MT_E_INTERNAL, MT_E_INTERRUPTED};
    bumps_case(&c, 4);
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    const long all = c.calls;
    for (long call = 1; call <= all; call += 1 + call / 2) {
        for (int k = 0; k < 3; k++) {
            mt_test_row(t, "%s at call %ld", mt_status_name(codes[k]), call);
            bumps_case(&c, 4);
            fatal_call = call;
            fatal_rc = codes[k];
            const mt_status rc = case_solve(&c, &opt);
            CHECK_INT(t, rc, k < 2 ? codes[k] : MT_OK);
            CHECK_INT(t, c.calls, call); /* not one more */
            CHECK(t, k < 2 || c.result.stop == MT_STOP_USER);
        }
    }
    fatal_call = -1;
    mt_arena_free(&c.mem);
}

static void nlp_robust__two_runs_are_bitwise_equal(mt_test *t)
{
    nlp_case a = {0};
    nlp_case b = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    bumps_case(&a, 6);
    bumps_case(&b, 6);
    REQUIRE(t, case_solve(&a, &opt) == MT_OK && case_solve(&b, &opt) == MT_OK);
    REQUIRE(t, a.result.n_solutions == b.result.n_solutions && a.result.n_solutions > 1);
    CHECK_INT(t, a.result.evals, b.result.evals);
    for (int i = 0; i < a.result.n_solutions; i++) {
        const mt_nlp_solution *const x = &a.result.solutions[i];
        const mt_nlp_solution *const y = &b.result.solutions[i];
        CHECK(t, same_bytes(x->t, y->t, 6 * sizeof *x->t) &&
                     same_bytes(&x->f, &y->f, sizeof x->f));
        CHECK(t, same_bytes(x->mult_eq, y->mult_eq, sizeof *x->mult_eq));
    }
    /* all are local minima: stationary, in order; mirrors of each other are equal */
    for (int i = 0; i < a.result.n_solutions; i++) {
        CHECK(t, a.result.solutions[i].kkt < 1e-8 && a.result.solutions[i].violation < 1e-3);
        CHECK(t, i == 0 || mt_compare(a.result.solutions[i].f, a.result.solutions[i - 1].f,
                                      MT_EQUAL_FOUND) >= 0);
    }
    mt_arena_free(&a.mem);
    mt_arena_free(&b.mem);
}

/* Four minima of equal depth, (-1 or 1, -1 or 2), and as another processor would have it. */
static void wells(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const double x = (t[0] * t[0]) - 1.0;
    const double y = (t[1] + 1.0) * (t[1] - 2.0);
    out->f = 1.0 + (x * x) + (y * y) + (c->target[0] * sin(1e6 * (t[0] + t[1])));
    out->df[0] = 4.0 * t[0] * x;
    out->df[1] = 2.0 * y * ((2.0 * t[1]) - 1.0);
}

/* By the change from the origin, with its weights, then by the first coordinate. */
static void nlp_robust__equal_solutions_are_in_an_order_without_rounding(mt_test *t)
{
    static const double weight[] = {1.0, 1.0};
    static const double far_weight[] = {3.0, 0.25};
    static const struct {
        const char *name;
        double rounding;
        double origin_y;
        const double *weight;
        double y; /* of the nearer two */
    } rows[] = {
        {"exact", 0.0, 0.0, NULL, -1.0},
        {"rounding", 1e-13, 0.0, NULL, -1.0},
        {"other rounding", -1e-13, 0.0, weight, -1.0},
        {"from elsewhere", 1e-13, 0.9, weight, 2.0},
        {"other weights", 1e-13, 0.9, far_weight, 2.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        nlp_case c = {0};
        mt_nlp_options opt = mt_nlp_options_default();
        mt_test_row(t, "%s", rows[i].name);
        case_begin(&c, 2, wells, -3.0, 3.0);
        c.target[0] = rows[i].rounding;
        c.origin[1] = rows[i].origin_y;
        c.nlp.change_weight = rows[i].weight;
        opt.least_change = false;
        REQUIRE(t, case_solve(&c, &opt) == MT_OK && c.result.n_solutions >= 4);
        for (int k = 0; k < 4; k++) {
            const double y = k < 2 ? rows[i].y : 1.0 - rows[i].y;
            CHECK_NEAR(t, c.result.solutions[k].t[0], k % 2 == 0 ? -1.0 : 1.0, 1e-5);
            CHECK_NEAR(t, c.result.solutions[k].t[1], y, 1e-5);
        }
        mt_arena_free(&c.mem);
    }
}

static void nlp_robust__fixed_variables_do_not_move(mt_test *t)
{
    nlp_case c = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    bumps_case(&c, 4);
    c.lower[1] = c.upper[1] = 0.75;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions >= 1);
    CHECK(t, c.result.solutions[0].t[1] == 0.75);
    CHECK(t, c.result.solutions[0].kkt < 1e-8);
    for (int j = 0; j < 4; j++) {
        c.lower[j] = c.upper[j] = c.origin[j];
    }
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK(t, c.result.compromise);
    c.lower[0] = 1;
    c.upper[0] = 0;
    CHECK_INT(t, case_solve(&c, &opt), MT_E_USAGE);
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_robust__tutorial_is_solved_from_every_start),
             MT_TEST(nlp_robust__regions_without_values_are_left),
             MT_TEST(nlp_robust__no_value_anywhere_is_the_callbacks_error),
             MT_TEST(nlp_robust__budget_is_never_exceeded),
             MT_TEST(nlp_robust__failures_of_the_callback_end_the_search),
             MT_TEST(nlp_robust__two_runs_are_bitwise_equal),
             MT_TEST(nlp_robust__equal_solutions_are_in_an_order_without_rounding),
             MT_TEST(nlp_robust__fixed_variables_do_not_move))
