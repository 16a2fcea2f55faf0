/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the change of a variable counts: ln(new/original), smoothly down to 0 where 0 is allowed;
 * what else it is, is told. */
#include "mt_random.h"
#include "problem/workspace.h"
#include "study_fixture.h"

/* Kept equations hold to 1e-6 relative; an optimum of a smooth change is then good to about
 * that. */
static const double SAME = 1e-9;
static const double ROUNDING = 1e-14;

#define ORIGINAL   "'k1': 2, 'k2': 1, 'm': 1, 'z': 0, 'n': -3"
#define FIRST_MODE "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.13}]"

static void coordinates__are_smooth_and_invert(mt_test *t)
{
    static const double rows[] = {0.0,  1e-9, 1e-3, 1.999e-3, 2e-3, 2.001e-3,
                                  0.01, 1.0,  1.9,  2.0,      4.0};
    study_case c;
    mt_problem *p = NULL;
    if (study_load(t, STUDY_TWO_MASSES(ORIGINAL, ""),
                   "'variables': [{'parameter': 'k1', 'lower': 0, 'upper': 4}]," FIRST_MODE,
                   &c) &&
        CHECK(t, mt_problem_new(c.study, NULL, &p, &c.err) == MT_OK)) {
        double before = -HUGE_VAL;
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const double x = rows[i];
            const double at = mt_problem_t(p, 0, x);
            const double h = 1e-7 * fmax(x, p->floor[0]);
            double back = nan("");
            mt_test_row(t, "x = %g", x);
            mt_subproblem_x(&p->whole, &at, &back);
            CHECK_NEAR_ABS(t, back, x, ROUNDING * fmax(x, p->floor[0]));
            CHECK(t, at > before);
            /* a difference across the floor is wrong by the jump of the curvature,
             * h/floor^2/2 */
            CHECK_NEAR(t, (mt_problem_t(p, 0, x + h) - mt_problem_t(p, 0, x - h)) / (2.0 * h),
                       1.0 / mt_problem_dx_dt_at(p, 0, x), 2e-7);
            before = at;
        }
        mt_test_row(t, "ends");
        CHECK_NEAR(t, mt_problem_t(p, 0, 2.0) - p->whole.lower_t[0], log(1e3) + 1.0, ROUNDING);
    }
    mt_problem_delete(p);
    study_free(&c);
}

/* The least change for a frequency, with a lower bound that does nothing: the answer is one, to
 * rounding, and between random problems never another. */
static void inactive_lower_bound__changes_nothing(mt_test *t)
{
    static const char *const lower[] = {"0.3", "1e-3", "1e-12", "0"};
    mt_random random = mt_random_seed(9);
    for (int k = 0; k < 12; k++) {
        const double hz = 0.1217 * mt_random_in(&random, 0.8, 1.25);
        const double weight = mt_random_in(&random, 0.3, 3.0);
        double k1 = nan("");
        double k2 = nan("");
        double change = nan("");
        for (int i = 0; i < 4; i++) {
            study_case c;
            char members[512];
            (void)snprintf(members, sizeof members,
                           "'variables': [{'parameter': 'k1', 'lower': %s, 'upper': 40,"
                           " 'weight': %.6f}, {'parameter': 'k2', 'lower': %s, 'upper': 40}],"
                           "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': %.9f}]",
                           lower[i], weight, lower[i], hz);
            mt_test_row(t, "%.6f Hz from %s", hz, lower[i]);
            if (study_solve(t, STUDY_TWO_MASSES(ORIGINAL, ""), members, &c)) {
                const mt_recommendation *const r = &c.result->recommendations[0];
                CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
                k1 = i == 0 ? study_value(&c, 1, "k1") : k1;
                k2 = i == 0 ? study_value(&c, 1, "k2") : k2;
                change = i == 0 ? r->change : change;
                CHECK_NEAR(t, study_value(&c, 1, "k1"), k1, SAME);
                CHECK_NEAR(t, study_value(&c, 1, "k2"), k2, SAME);
                CHECK_NEAR(t, r->change, change, SAME);
                CHECK_NEAR(t, r->change,
                           sqrt((weight * pow(log(k1 / 2.0), 2.0)) + pow(log(k2), 2.0)), 1e-5);
            }
            study_free(&c);
        }
    }
}

/* A mass that may go: the frequency asks for less of it than there is, the objective for
 * none. */
static void zero__is_reached_where_it_is_best(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'extra': 0.5, 'm': '1 + extra'", ""),
                    "'variables': [{'parameter': 'extra', 'lower': 0, 'upper': 4},"
                    " {'parameter': 'k1', 'lower': 0, 'upper': 8}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.05}],"
                    "'objective': {'minimise': 'extra'}",
                    &c)) {
        const mt_result_parameter *const p = &c.result->recommendations[0].parameters[0];
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR_ABS(t, p->recommended, 0.0, 0.0);
        CHECK_STR(t, p->at_bound, "lower");
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, 1e-6);
        CHECK_NEAR(t, c.result->recommendations[0].change, log(1e3) + 1.0, 1e-6);
    }
    study_free(&c);
}

/* A variable's part of the change by what the result says of its measure. */
static double counted(const mt_result_parameter *p)
{
    const double least = p->measure_floor;
    if (p->measure_scale > 0.0) {
        return (p->recommended - p->original) / p->measure_scale;
    }
    return p->recommended < least ? log(least / p->original) + (p->recommended / least) - 1.0
                                  : log(p->recommended / p->original);
}

static void measure__is_told_and_makes_the_change(mt_test *t)
{
    static const struct {
        const char *parameter;
        const char *range;
        double scale;
        double least;
    } rows[] = {
        {"k1", "'lower': 0.1, 'upper': 9", 0.0, 0.0},
        {"k1", "'lower': 0, 'upper': 9", 0.0, 2e-3},
        {"k1", "'lower': -1, 'upper': 9", 10.0, 0.0},
        {"k1", "'lower': 0.1, 'upper': 9, 'scale': 3", 3.0, 0.0},
        {"k1", "'lower': 0, 'upper': 9, 'scale': 3", 3.0, 0.0},
        {"k1", "'catalogue': [0, 1, 2.5, 3, 3.5, 4]", 0.0, 2e-3},
        {"k1", "'catalogue': [1, 2.5, 3, 3.5]", 0.0, 0.0},
        {"z", "'lower': 0, 'upper': 5", 5.0, 0.0},
        {"n", "'lower': -8, 'upper': -1", 7.0, 0.0},
        {"n", "'lower': -8, 'upper': -1, 'scale': 0.5", 0.5, 0.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        study_case c;
        char members[512];
        const bool other = strcmp(rows[i].parameter, "k1") != 0;
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': '%s', %s}%s],"
                       "'goals': [{'type': 'limit', 'expression': 'k1 + z + n', 'at_least': "
                       "0.75}]",
                       rows[i].parameter, rows[i].range,
                       other ? ", {'parameter': 'k2', 'lower': 0.5, 'upper': 5}" : "");
        mt_test_row(t, "%s %s", rows[i].parameter, rows[i].range);
        if (study_solve(t, STUDY_TWO_MASSES(ORIGINAL, ""), members, &c) &&
            CHECK(t, c.result->n_recommendations > 0)) {
            const mt_recommendation *const r = &c.result->recommendations[0];
            double sum = 0.0;
            const mt_result_parameter *const p = &r->parameters[0];
            CHECK_STR(t, p->measure,
                      rows[i].scale > 0.0   ? "linear"
                      : rows[i].least > 0.0 ? "logarithmic with floor"
                                            : "logarithmic");
            CHECK(t, rows[i].scale > 0.0 ? p->measure_scale == rows[i].scale
                                         : isnan(p->measure_scale));
            CHECK(t, rows[i].least > 0.0 ? fabs(p->measure_floor - rows[i].least) <= 1e-18
                                         : isnan(p->measure_floor));
            for (int k = 0; k < r->n_parameters; k++) {
                sum += pow(counted(&r->parameters[k]), 2.0);
            }
            CHECK(t, r->change > 0.0);
            CHECK_NEAR(t, r->change, sqrt(sum), 1e-12);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(coordinates__are_smooth_and_invert),
             MT_TEST(inactive_lower_bound__changes_nothing),
             MT_TEST(zero__is_reached_where_it_is_best),
             MT_TEST(measure__is_told_and_makes_the_change))
