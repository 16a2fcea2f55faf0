/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Demands that cannot be met: the least sum of squares within the bounds, and it says so. */
#include "nlp_problem.h"

/* eq_i = t_0 - target_i (i < n_eq), f = change; further variables are not seen. */
static void same_variable(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    for (int i = 0; i < c->nlp.n_eq; i++) {
        out->eq[i] = t[0] - c->target[i];
        for (int j = 0; j < c->nlp.n; j++) {
            out->deq[i + j * c->nlp.n_eq] = j == 0;
        }
    }
}

static void nlp_compromise__contradicting_targets_are_averaged(mt_test *t)
{
    nlp_case c = {0};
    for (int n = 1; n <= 4; n += 3) { /* as many equalities as variables or more; then fewer */
        mt_test_row(t, "%d variables", n);
        case_begin(&c, n, same_variable, -2, 2);
        c.nlp.n_eq = 3;
        c.target[0] = 0.1;
        c.target[1] = 0.2;
        c.target[2] = 0.6;
        c.origin[3] = 0.5;
        REQUIRE(t, case_solve(&c, NULL) == MT_OK);
        CHECK(t, c.result.compromise);
        CHECK_INT(t, c.result.n_solutions, 1);
        CHECK_INT(t, c.result.n_unidentifiable, n - 1);
        const mt_nlp_solution *const s = &c.result.solutions[0];
        CHECK_NEAR(t, s->t[0], 0.3, 1e-10);
        CHECK_NEAR(t, s->squares, 0.04 + 0.01 + 0.09, 1e-10);
        CHECK_NEAR(t, s->violation, 0.3 / 1e-6, 1e-8);
        CHECK(t, !s->feasible && isnan(s->mult_eq[0]));
        if (n == 4) {
            CHECK(t, s->t[1] == 0 && s->t[2] == 0 && s->t[3] == 0.5);
        }
    }
    mt_arena_free(&c.mem);
}

static void nlp_compromise__bounds_are_respected(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, same_variable, -2, 2);
    c.nlp.n_eq = 1;
    c.target[0] = 3;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK(t, c.result.solutions[0].t[0] == 2 && c.result.solutions[0].t[1] == 0);
    CHECK_INT(t, c.result.solutions[0].bound[0], 1);
    mt_arena_free(&c.mem);
}

/* Two local compromises: cos(t) = 1.5 has the nearest values at every multiple of 2 pi; with
 * the second equality t = 1 in weak form they differ, and are ranked by their squares. */
static void wave(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = cos(t[0]) - 1.5;
    out->eq[1] = 0.01 * (t[0] - 1);
    out->deq[0] = -sin(t[0]);
    out->deq[1] = 0.01;
}

static void nlp_compromise__local_ones_are_kept_and_ranked_by_squares(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 1, wave, -8, 8);
    c.nlp.n_eq = 2;
    c.origin[0] = 6; /* near the worse one: rank does not follow the change */
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    REQUIRE(t, c.result.n_solutions == 3);
    double previous = 0;
    for (int i = 0; i < 3; i++) {
        const mt_nlp_solution *const s = &c.result.solutions[i];
        static const double near[3] = {0, 1, -1};
        mt_test_row(t, "compromise %d", i + 1);
        CHECK(t, s->squares >= previous);
        previous = s->squares;
        const double x = s->t[0];
        const double slope = -sin(x) * (cos(x) - 1.5) + 1e-4 * (x - 1);
        CHECK_NEAR_ABS(t, slope, 0, 1e-10);
        CHECK_NEAR_ABS(t, x, near[i] * 2 * acos(-1.0), 0.01);
    }
    mt_arena_free(&c.mem);
}

/* Inequalities that exclude each other: t0 >= 1 and t0 <= 0 (as 0 - t0 >= 0). */
static void apart(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->in[0] = t[0] - 1;
    out->in[1] = -t[0];
    out->din[0] = 1;
    out->din[1] = -1;
}

static void nlp_compromise__excluding_inequalities_meet_half_way(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 1, apart, -2, 2);
    c.nlp.n_in = 2;
    c.origin[0] = -1.5;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK_NEAR(t, c.result.solutions[0].t[0], 0.5, 1e-10);
    mt_arena_free(&c.mem);
}

/* Within a circle of radius 1, and outside of a curve about it that comes as near as 2 in
 * `lobes` directions: nothing is, and half way in these is the least. At it the slopes of both
 * rows are opposite: steps by slopes alone come near slowly. */
typedef struct ring {
    nlp_case c; /* first: what the callback gets */
    int lobes;
    int asked;
    bool none; /* what is said to be proven */
} ring;

static mt_status rings(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                       mt_err *err)
{
    ring *const r = context;
    const double radius = hypot(t[0], t[1]);
    if (radius == 0.0) {
        return mt_fail(err, MT_E_DOMAIN, "the middle has no direction");
    }
    const double turn = (double)r->lobes * atan2(t[1], t[0]);
    const double slope = (double)r->lobes * sin(turn) / (radius * radius);
    (void)with_gradient;
    r->c.calls++;
    change(&r->c, t, out);
    out->in[0] = 1.0 - radius;
    out->in[1] = radius - 2.0 + 0.5 * (cos(turn) - 1.0);
    out->din[0] = -t[0] / radius;
    out->din[2] = -t[1] / radius;
    out->din[1] = (t[0] / radius) + 0.5 * slope * t[1];
    out->din[3] = (t[1] / radius) - 0.5 * slope * t[0];
    return MT_OK;
}

static mt_status prove(void *context, bool *none, mt_err *err)
{
    ring *const r = context;
    (void)err;
    r->asked++;
    *none = r->none;
    return MT_OK;
}

static mt_status ring_solve(ring *r, int lobes, bool none, int starts)
{
    case_begin(&r->c, 2, NULL, -4, 4);
    r->c.nlp.eval = rings;
    r->c.nlp.n_in = 2;
    r->c.nlp.context = r;
    r->c.origin[0] = 2.0;
    r->c.origin[1] = 0.7;
    r->lobes = lobes;
    r->none = none;
    r->asked = 0;
    mt_nlp_options opt = mt_nlp_options_default();
    opt.starts = starts;
    opt.prove_none = prove;
    opt.prove_context = r;
    return case_solve(&r->c, &opt);
}

/* One place: the first starts are enough where nothing is feasible, and find what all find. */
static void nlp_compromise__first_starts_are_enough_where_a_proof_says_so(mt_test *t)
{
    ring r = {.asked = 0};
    enum { STARTS = 20, FIRST = 8 };
    for (int proven = 0; proven < 2; proven++) {
        mt_test_row(t, "proven %d", proven);
        REQUIRE(t, ring_solve(&r, 1, proven == 1, STARTS) == MT_OK);
        CHECK_INT(t, r.asked, 1);
        CHECK(t, r.c.result.compromise);
        CHECK_INT(t, r.c.result.starts, proven == 1 ? FIRST : STARTS);
        CHECK_NEAR(t, r.c.result.solutions[0].t[0], 1.5, 1e-10);
        CHECK_NEAR_ABS(t, r.c.result.solutions[0].t[1], 0.0, 1e-10);
        CHECK_NEAR(t, r.c.result.solutions[0].squares, 0.5, 1e-10);
    }
    mt_arena_free(&r.c.mem);
}

/* Three places as good: the first starts do not end at one, so that all are made. */
static void nlp_compromise__all_starts_are_made_where_the_first_do_not_agree(mt_test *t)
{
    ring r = {.asked = 0};
    REQUIRE(t, ring_solve(&r, 3, true, 20) == MT_OK);
    CHECK_INT(t, r.asked, 1);
    CHECK_INT(t, r.c.result.starts, 20);
    CHECK(t, r.c.result.n_solutions == 3);
    mt_arena_free(&r.c.mem);
}

/* Fewer starts than the first ones are all made, and nothing is asked. */
static void nlp_compromise__few_starts_ask_for_no_proof(mt_test *t)
{
    ring r = {.asked = 0};
    REQUIRE(t, ring_solve(&r, 1, true, 8) == MT_OK);
    CHECK_INT(t, r.asked, 0);
    CHECK_INT(t, r.c.result.starts, 8);
    mt_arena_free(&r.c.mem);
}

/* A least of squares that is no root is left where R stands upright on the columns, instead of
 * after dozens of refused steps. */
static void nlp_compromise__least_squares_end_where_nothing_is_left(mt_test *t)
{
    ring r = {.asked = 0};
    REQUIRE(t, ring_solve(&r, 1, false, 8) == MT_OK);
    CHECK(t, r.c.calls <= 8L * 70);
    mt_arena_free(&r.c.mem);
}

/* One requirement is out of reach (t0 <= 2 < 3), the other, t1 + 2 t2 = 1, leaves a line: of
 * all equal compromises the one of least change, t = (2, 1/5, 2/5), and only that. */
static void line(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = t[0] - 3;
    out->eq[1] = sinh(t[1] + 2 * t[2] - 1);
    const double slope = cosh(t[1] + 2 * t[2] - 1);
    const double jacobian[6] = {1, 0, 0, slope, 0, 2 * slope};
    memcpy(out->deq, jacobian, sizeof jacobian);
}

static void nlp_compromise__of_equal_ones_the_least_change_is_taken(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 3, line, -2, 2);
    c.nlp.n_eq = 2;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK_INT(t, c.result.n_unidentifiable, 1); /* (0, 2, -1)/sqrt 5 */
    const mt_nlp_solution *const s = &c.result.solutions[0];
    CHECK(t, s->t[0] == 2 && s->start == 0);
    CHECK_NEAR(t, s->t[1], 0.2, 1e-9);
    CHECK_NEAR(t, s->t[2], 0.4, 1e-9);
    CHECK_NEAR(t, s->squares, 1, 1e-9);
    mt_arena_free(&c.mem);
}

/* The same on a circle, where no straight direction is undetermined. */
static void circle(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = t[0] - 3;
    out->eq[1] = 0.5 * (t[1] * t[1] + t[2] * t[2] - 1);
    const double jacobian[6] = {1, 0, 0, t[1], 0, t[2]};
    memcpy(out->deq, jacobian, sizeof jacobian);
}

static void nlp_compromise__least_change_also_on_a_curve(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 3, circle, -2, 2);
    c.nlp.n_eq = 2;
    c.origin[1] = 0.3;
    c.origin[2] = 0.4;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK_INT(t, c.result.n_solutions, 1);
    CHECK_INT(t, c.result.n_unidentifiable, 0);
    CHECK_NEAR(t, c.result.solutions[0].t[1], 0.6, 1e-8);
    CHECK_NEAR(t, c.result.solutions[0].t[2], 0.8, 1e-8);
    mt_arena_free(&c.mem);
}

/* t_0 = 0 and t_0 = 0.1 - 1e-4 t_1: t_1 at its bound would miss by 7e-5 less, which is less
 * than the requirements' tolerance of 1e-3. */
static void weakly_seen(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    static const double weak = 1e-4;
    change(c, t, out);
    out->eq[0] = t[0];
    out->eq[1] = t[0] - 0.1 + (weak * t[1]);
    out->deq[0] = 1;
    out->deq[1] = 1;
    out->deq[2] = 0;
    out->deq[3] = weak;
}

static void nlp_compromise__what_requirements_do_not_see_stays_at_the_origin(mt_test *t)
{
    nlp_case c = {0};
    case_begin(&c, 2, weakly_seen, -1, 1);
    c.nlp.n_eq = 2;
    c.origin[1] = 0.3;
    c.eq_tol[0] = 1e-3;
    c.eq_tol[1] = 1e-3;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    CHECK(t, c.result.compromise);
    CHECK_INT(t, c.result.n_unidentifiable, 1);
    CHECK(t, c.result.solutions[0].t[1] == 0.3);
    CHECK_NEAR(t, c.result.solutions[0].t[0], 0.05 - (0.5e-4 * 0.3), 1e-6);
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_compromise__contradicting_targets_are_averaged),
             MT_TEST(nlp_compromise__bounds_are_respected),
             MT_TEST(nlp_compromise__local_ones_are_kept_and_ranked_by_squares),
             MT_TEST(nlp_compromise__excluding_inequalities_meet_half_way),
             MT_TEST(nlp_compromise__first_starts_are_enough_where_a_proof_says_so),
             MT_TEST(nlp_compromise__all_starts_are_made_where_the_first_do_not_agree),
             MT_TEST(nlp_compromise__few_starts_ask_for_no_proof),
             MT_TEST(nlp_compromise__least_squares_end_where_nothing_is_left),
             MT_TEST(nlp_compromise__of_equal_ones_the_least_change_is_taken),
             MT_TEST(nlp_compromise__least_change_also_on_a_curve),
             MT_TEST(nlp_compromise__what_requirements_do_not_see_stays_at_the_origin))
