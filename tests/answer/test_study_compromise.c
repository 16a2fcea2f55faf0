/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where goals cannot be met, or do not settle the design; and originals and bounds of every
 * sign. */
#include "study_fixture.h"

static const double TOL = 1e-6;

#define STIFF(extra) "'variables': [{'parameter': 'k1', 'lower': 1, 'upper': 4}" extra "],"

/* Wanted: far more than k1 = 4 can give. */
static void unreachable_target__gives_the_nearest_design_at_its_bound(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2, 'k2': 100, 'm': 1", ""),
                    STIFF("") "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 1}]",
                    &c)) {
        const double nearest = study_hz(study_two_lambda(4.0, 100.0, 1.0, -1));
        const mt_recommendation *const r = &c.result->recommendations[0];
        CHECK(t, c.result->status != MT_RESULT_SOLVED); /* a compromise, or proven infeasible */
        CHECK_NEAR_ABS(t, study_value(&c, 1, "k1"), 4.0, 0.0);
        CHECK_STR(t, r->parameters[0].at_bound, "upper");
        CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), nearest, TOL);
        CHECK(t, !r->feasible);
        CHECK(t, !(r->score == r->score)); /* NaN: none */
        CHECK_NEAR(t, r->violation_percent, 100.0 * (1.0 - nearest), TOL);
        CHECK(t, !r->goals[0].met);
        CHECK(t, study_reasons(&c, 1, "k1 stands at its upper bound"));
        const mt_certificate *const proof = &c.result->certificates[0];
        CHECK_INT(t, c.result->n_certificates, 1);
        CHECK(t, proof->proven);
        CHECK_STR(t, proof->kind, "infeasible");
        CHECK_STR(t, proof->pointer, "/goals/0");
        CHECK_NEAR(t, proof->reachable_upper_hz, nearest, TOL);
        CHECK_NEAR(t, proof->reachable_lower_hz,
                   study_hz(study_two_lambda(1.0, 100.0, 1.0, -1)), TOL);
        CHECK(t, study_reasons(&c, 1, "Goal /goals/0 (default mode 1 at 1 Hz) is missed by"));
    }
    study_free(&c);
}

/* A parameter that nothing depends on stays exactly where it was, whatever rounding logarithms
 * bring. */
static void undetermined_parameter__keeps_its_value_and_is_named(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1, 'idle': 0.1234567890123456", ""),
            STIFF(
                ", {'parameter': 'idle', 'lower': 0.01, 'upper': 7}") "'goals': [{'type': "
                                                                      "'frequency', 'mode': 1, "
                                                                      "'target_hz': 0.12}]",
            &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "idle"), 0.1234567890123456, 0.0);
        CHECK_INT(t, c.result->n_unidentifiable, 1);
        CHECK_STR(t, c.result->unidentifiable[0].text, "idle");
        CHECK(t, c.result->unidentifiable[0].effect_percent <= 1e-4);
        CHECK(t, study_reasons(&c, 1, "Not identifiable: idle"));
        CHECK(t, study_reasons(&c, 1, "idle keeps its original value."));
    }
    study_free(&c);
}

/* Only the product a b counts (it is k1): the difference of the logarithms is open, and the
 * change least along the sum. */
static void undetermined_direction__is_named_as_a_combination(mt_test *t)
{
    study_case c;
    const char *const model =
        "{'format': 'modetune-model/1', 'dimension': 2,"
        "'parameters': {'a': 1.5, 'b': 1.2, 'k1': 'a*b', 'k2': 1, 'm': 1}," STUDY_TWO_MASSES_ROW
        "}";
    if (study_solve(t, model,
                    "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 5},"
                    " {'parameter': 'b', 'lower': 0.5, 'upper': 5}],"
                    "'goals': [{'type': 'frequency', 'mode': 1,"
                    " 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)'}]",
                    &c)) {
        const double a = study_value(&c, 1, "a");
        const double b = study_value(&c, 1, "b");
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, a * b, 2.0, TOL);
        CHECK_NEAR(t, a / b, 1.5 / 1.2, TOL);
        CHECK_INT(t, c.result->n_unidentifiable, 1);
        const char *const text = c.result->unidentifiable[0].text;
        CHECK(t, strcmp(text, "0.71 ln a - 0.71 ln b") == 0 ||
                     strcmp(text, "-0.71 ln a + 0.71 ln b") == 0);
        CHECK(t, study_reasons(&c, 1, text));
    }
    study_free(&c);
}

/* The baseline is the original design, although the search may not go there. */
static void original_outside_its_bounds__is_described_where_it_is(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 8, 'k2': 1, 'm': 1", ""),
                    STIFF("") "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': "
                              "'sqrt(2 - sqrt(2))/(2*pi)'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR_ABS(t, study_value(&c, 0, "k1"), 8.0, 0.0);
        CHECK_NEAR(t, study_frequency(&c, 0, "default", 1),
                   study_hz(study_two_lambda(8.0, 1.0, 1.0, -1)), 1e-12);
        CHECK(t, c.result->baseline.parameters[0].at_bound == NULL);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, TOL);
        CHECK_NEAR(t, c.result->recommendations[0].parameters[0].original, 8.0, 0.0);
        CHECK_NEAR(t, c.result->recommendations[0].change, log(8.0 / 2.0), TOL);
        CHECK(t,
              study_warns(&c, "the original value of k1, 8, lies outside its bounds (1 to 4)"));
    }
    study_free(&c);
}

/* Bounds below zero: the change is (new - original)/scale, the scale the range where none is
 * given; a bound of zero keeps the logarithm. */
static void bounds_at_and_below_zero__set_the_measure(mt_test *t)
{
    static const struct {
        const char *parameters;
        const char *variable;
        double want; /* of x, where k1 = 2 */
        double change;
    } rows[] = {
        {"'x': 0.5, 'k1': '1 + x', 'k2': 1, 'm': 1", "'lower': 0, 'upper': 4", 1.0,
         0.69314718055994529},
        {"'x': 0, 'k1': '1 + x', 'k2': 1, 'm': 1", "'lower': -0.5, 'upper': 4", 1.0, 1.0 / 4.5},
        {"'x': -0.5, 'k1': '3 + x', 'k2': 1, 'm': 1", "'lower': -2, 'upper': 2, 'scale': 0.1",
         -1.0, 5.0},
        {"'x': 0.5, 'k1': '4 - x', 'k2': 1, 'm': 1", "'lower': 0, 'upper': 2, 'weight': 4", 2.0,
         2.7725887222397811},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        study_case c;
        char model[4096];
        char members[1024];
        (void)snprintf(model, sizeof model,
                       "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {%s},"
                       "%s}",
                       rows[i].parameters, STUDY_TWO_MASSES_ROW);
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'x', %s}], 'goals': [{'type': 'frequency',"
                       " 'mode': 1, 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)'}]",
                       rows[i].variable);
        mt_test_row(t, "%s", rows[i].variable);
        if (study_solve(t, model, members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_INT(t, c.result->n_recommendations, 1);
            CHECK_NEAR(t, study_value(&c, 1, "x"), rows[i].want, TOL);
            CHECK_NEAR(t, c.result->recommendations[0].change, rows[i].change, TOL);
        }
        study_free(&c);
    }
}

/* A stiffness whose lower bound is zero: at zero the mode is not there, and the search goes
 * around that. */
static void lower_bound_zero_of_a_stiffness__is_no_obstacle(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 1.5, 'k2': 1.2, 'm': 1", ""),
                    "'variables': [{'parameter': 'k1', 'lower': 0, 'upper': 4},"
                    " {'parameter': 'k2', 'lower': 0, 'upper': 4}],"
                    "'goals': [{'type': 'frequency', 'mode': 1,"
                    " 'target_hz': 'sqrt((5 - sqrt(13))/2)/(2*pi)'},"
                    "{'type': 'frequency', 'mode': 2,"
                    " 'target_hz': 'sqrt((5 + sqrt(13))/2)/(2*pi)'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 2);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, TOL);
        CHECK_NEAR(t, study_value(&c, 2, "k1"), 3.0, TOL);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(unreachable_target__gives_the_nearest_design_at_its_bound),
             MT_TEST(undetermined_parameter__keeps_its_value_and_is_named),
             MT_TEST(undetermined_direction__is_named_as_a_combination),
             MT_TEST(original_outside_its_bounds__is_described_where_it_is),
             MT_TEST(bounds_at_and_below_zero__set_the_measure),
             MT_TEST(lower_bound_zero_of_a_stiffness__is_no_obstacle))
