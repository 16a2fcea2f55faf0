/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trade studies: every point against a study of its own, the front against its definition. */
#include "six.h"

/* Two searches of one optimum end within the tolerance of the bands (1e-6) of each other, some
 * times a slope of order one. */
static const double SAME_OPTIMUM = 1e-5;

static void vary_margin(six *s, int n, double *margins)
{
    mt_vary v = mt_vary_default(MT_VARY_GOAL, 0);
    v.goal = 0;
    v.member = "margin_percent";
    v.slot = MT_SLOT_MARGIN;
    v.n_values = n;
    v.values = margins;
    v.text = "margin_percent of /goals/0";
    s->study->trade = (mt_trade){.n_vary = 1,
                                 .vary = {v},
                                 .n_objectives = 2,
                                 .objectives = {MT_OBJECTIVE_CHANGE, MT_OBJECTIVE_CLEARANCE}};
}

/* The study with other bands, put in by hand. */
static double change_with_margin(mt_test *t, six *s, double percent)
{
    mt_err err = {.text = ""};
    mt_avoid *const avoid = s->study->goals[0].avoid;
    avoid->source.margin_percent = percent;
    CHECK(t,
          mt_bands_make(&avoid->source, nan(""), &s->study->mem, &avoid->bands, &err) == MT_OK);
    mt_result *const r = six_solve(t, s->study, 1);
    const bool found = r != NULL && r->n_recommendations > 0 && r->recommendations[0].feasible;
    const double change = found ? r->recommendations[0].change : nan("");
    mt_result_delete(r);
    return change;
}

/* On the front is what no point beats in both. */
static void check_front(mt_test *t, const mt_trade_result *trade)
{
    for (int i = 0; i < trade->n_points; i++) {
        const mt_trade_point *const p = &trade->points[i];
        bool beaten = !p->best.feasible;
        for (int k = 0; k < trade->n_points; k++) {
            const mt_recommendation *const other = &trade->points[k].best;
            beaten = beaten || (other->feasible && other->change < p->best.change - 1e-3 &&
                                other->clearance_percent > p->best.clearance_percent + 1e-3);
        }
        mt_test_row(t, "margin of %g %%", p->values[0]);
        CHECK(t, p->pareto == !beaten);
    }
}

static void trade__each_point_is_a_study_of_its_own(mt_test *t)
{
    double margins[] = {0.0, 1.0, 3.0, 8.0, 20.0};
    enum { LAST = MT_COUNT(margins) - 1 };
    six s;
    REQUIRE(t, six_begin(t, &s));
    vary_margin(&s, MT_COUNT(margins), margins);
    mt_result *const r = six_solve(t, s.study, 2);
    s.study->trade.n_vary = 0;
    if (r != NULL && CHECK(t, r->trade != NULL && r->trade->n_points == MT_COUNT(margins))) {
        check_front(t, r->trade);
        for (int i = 0; i < LAST; i++) {
            const mt_trade_point *const p = &r->trade->points[i];
            double x[SIX];
            for (int k = 0; k < SIX; k++) {
                x[k] = p->best.parameters[k].recommended;
            }
            mt_test_row(t, "margin of %g %%", margins[i]);
            CHECK_NEAR(t, p->values[0], margins[i], 0.0);
            CHECK_INT(t, p->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, p->best.change, change_with_margin(t, &s, margins[i]), SAME_OPTIMUM);
            CHECK(t, six_clear(&s, x, margins[i] / 100.0));
        }
        mt_test_row(t, "a margin that cannot be kept");
        CHECK_INT(t, r->trade->points[LAST].status, MT_RESULT_INFEASIBLE);
    }
    mt_result_delete(r);
    six_end(&s);
}

/* k_6 as a parameter that varies, the other five as variables: the same as closing its
 * bounds. */
static void trade__a_parameter_varies(mt_test *t)
{
    double values[] = {7000.0, 10000.0, 14000.0};
    six s;
    REQUIRE(t, six_begin(t, &s));
    mt_vary v = mt_vary_default(MT_VARY_PARAMETER, 0);
    v.parameter = s.study->variables[SIX - 1].parameter;
    v.name.s = "k_6";
    v.n_values = MT_COUNT(values);
    v.values = values;
    v.text = "k_6";
    s.study->trade = (mt_trade){.n_vary = 1, .vary = {v}};
    s.study->n_variables = SIX - 1;
    mt_result *const r = six_solve(t, s.study, 2);
    s.study->trade.n_vary = 0;
    s.study->n_variables = SIX;
    for (int i = 0; r != NULL && r->trade != NULL && i < MT_COUNT(values); i++) {
        mt_variable *const last = &s.study->variables[SIX - 1];
        last->lower = values[i];
        last->upper = values[i];
        last->weight = 1e-300; /* what is given does not count as a change */
        mt_result *const alone = six_solve(t, s.study, 1);
        mt_test_row(t, "k_6 = %g", values[i]);
        if (alone != NULL && CHECK(t, alone->n_recommendations > 0)) {
            CHECK_NEAR(t, r->trade->points[i].best.change, alone->recommendations[0].change,
                       SAME_OPTIMUM);
            CHECK_INT(t, r->trade->points[i].status, alone->status);
        }
        mt_result_delete(alone);
    }
    CHECK(t, r != NULL && r->trade != NULL && r->trade->n_points == MT_COUNT(values));
    mt_result_delete(r);
    six_end(&s);
}

static void trade__a_bound_and_a_margin_make_a_grid_in_order(mt_test *t)
{
    double margins[] = {0.0, 4.0};
    double bounds[] = {36000.0, 45000.0, 70000.0};
    six s;
    REQUIRE(t, six_begin(t, &s));
    vary_margin(&s, MT_COUNT(margins), margins);
    mt_vary v = mt_vary_default(MT_VARY_BOUND, 0);
    v.variable = 1;
    v.upper = true;
    v.n_values = MT_COUNT(bounds);
    v.values = bounds;
    v.text = "upper bound of k_2";
    s.study->trade.vary[1] = v;
    s.study->trade.n_vary = 2;
    mt_result *const r = six_solve(t, s.study, 2);
    if (r != NULL && CHECK(t, r->trade != NULL && r->trade->n_points == 6)) {
        for (int i = 0; i < 6; i++) {
            const mt_trade_point *const p = &r->trade->points[i];
            mt_test_row(t, "point %d", i);
            CHECK_NEAR(t, p->values[0], margins[i / 3], 0.0);
            CHECK_NEAR(t, p->values[1], bounds[i % 3], 0.0);
            CHECK(t, p->best.feasible);
            CHECK(t, p->best.parameters[1].recommended <= bounds[i % 3]);
            /* more room never costs more */
            CHECK(t, i % 3 == 0 ||
                         p->best.change <= r->trade->points[i - 1].best.change + SAME_OPTIMUM);
        }
    }
    mt_result_delete(r);
    s.study->trade.n_vary = 1; /* enough to share out, and quick */
    mt_result_delete(six_same_bytes(t, s.study));
    six_end(&s);
}

MT_TEST_MAIN(MT_TEST(trade__each_point_is_a_study_of_its_own),
             MT_TEST(trade__a_parameter_varies),
             MT_TEST(trade__a_bound_and_a_margin_make_a_grid_in_order))
