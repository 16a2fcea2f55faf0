/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configurations: overrides, inheritance, shared variables; configurations that are unstable or
 * lack the mode. */
#include "study_fixture.h"

static const double TOL = 1e-6;

/* "loaded" doubles m, "held" inherits that and fixes k2 whatever the study says. */
#define CONFIGURED                                                                 \
    STUDY_TWO_MASSES(                                                              \
        "'k1': 2.5, 'k2': 1.2, 'm': 1, 'c': 1",                                    \
        ", 'configurations': {'free': {}, 'loaded': {'parameters': {'m': '2*c'}}," \
        " 'held': {'like': 'loaded', 'parameters': {'k2': 3}}}")

static void two_configurations__share_their_variables(mt_test *t)
{
    study_case c;
    /* k1 = 2, k2 = 1: free has m = 1, loaded m = 2 with c = 1 */
    if (study_solve(t, CONFIGURED,
                    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10},"
                    " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"
                    "'goals': [{'type': 'frequency', 'configuration': 'free', 'mode': 1,"
                    " 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)'},"
                    "{'type': 'frequency', 'configuration': 'loaded', 'mode': 2,"
                    " 'target_hz': 'sqrt((2 + sqrt(2))/2)/(2*pi)'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        /* the same two eigenvalues as at a double root: sqrt of the goal's tolerance */
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, 1e-4);
        CHECK_NEAR(t, study_value(&c, 1, "k2"), 1.0, 1e-4);
    }
    study_free(&c);
}

static void override__wins_over_a_variable_and_like_inherits(mt_test *t)
{
    study_case c;
    /* held: k2 = 3 whatever the variable, m = 2 from loaded; free settles k2 */
    const double held = study_hz(study_two_lambda(2.0, 3.0, 2.0, -1));
    const double loose = study_hz(study_two_lambda(2.0, 1.5, 1.0, -1));
    char members[1024];
    (void)snprintf(members, sizeof members,
                   "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10},"
                   " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"
                   "'goals': [{'type': 'frequency', 'configuration': 'held', 'mode': 1,"
                   " 'target_hz': %.17g}, {'type': 'frequency', 'configuration': 'free',"
                   " 'mode': 1, 'target_hz': %.17g}]",
                   held, loose);
    if (study_solve(t, CONFIGURED, members, &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 1);
        CHECK_NEAR(t, study_value(&c, 1, "k1"), 2.0, TOL);
        CHECK_NEAR(t, study_value(&c, 1, "k2"), 1.5, TOL);
        const mt_result_frequency *const f = study_row(&c, 1, "held", 1);
        if (CHECK(t, f != NULL)) {
            CHECK_NEAR_ABS(t, f->sensitivity[1], 0.0, 0.0); /* k2 is overridden there */
            CHECK(t, f->sensitivity[0] > 0.0);
        }
    }
    study_free(&c);
}

/* One goal over several configurations is one requirement in each. */
static void goal_over_several_configurations__holds_in_each(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, CONFIGURED,
            "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}],"
            "'goals': [{'type': 'frequency', 'configurations': ['free', 'loaded', 'held'],"
            " 'mode': 1, 'at_least_hz': 0.1}]",
            &c)) {
        const mt_recommendation *const r = &c.result->recommendations[0];
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, r->n_goals, 3);
        for (int i = 0; i < r->n_goals; i++) {
            CHECK(t, r->goals[i].met);
            CHECK_STR(t, r->goals[i].pointer, "/goals/0");
        }
        /* the heavy one with the weaker k2 decides */
        CHECK_NEAR(t, study_frequency(&c, 1, "loaded", 1), 0.1, TOL);
        CHECK(t, study_frequency(&c, 1, "free", 1) > 0.1);
    }
    study_free(&c);
}

#define INVERTED                                                                         \
    "{'format': 'modetune-model/1', 'dimension': 2, 'gravity_m_per_s2': [0, -9.81],"     \
    "'parameters': {'k': 5},"                                                            \
    "'bodies': [{'name': 'rod', 'mass_kg': 1, 'inertia_kg_m2': 0.1, 'centre': [0, 1]}]," \
    "'joints': [{'name': 'pivot', 'type': 'revolute', 'bodies': ['ground', 'rod'],"      \
    " 'at': [0, 0]}],"                                                                   \
    "'springs': [{'name': 's', 'type': 'torsion', 'joint': 'pivot',"                     \
    " 'stiffness_n_m_per_rad': 'k'}],"                                                   \
    "'modes': {'upright': {'configuration': 'default', 'index': 1}}}"

/* k - m g l < 0: the pendulum stands on its head and falls. The search may still find a spring
 * that holds it. */
static void unstable_original__leaves_its_goals_unmet_and_is_left(mt_test *t)
{
    study_case c;
    if (study_solve(t, INVERTED,
                    "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 100}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.5}]",
                    &c)) {
        const double want = 9.81 + (1.1 * pow(2.0 * STUDY_PI * 0.5, 2.0));
        CHECK(t, !c.result->baseline.feasible);
        CHECK(t, !c.result->baseline.goals[0].met);
        CHECK(t, !(c.result->baseline.goals[0].value == c.result->baseline.goals[0].value));
        CHECK(t,
              study_warns(&c, "at the original design: configuration \"default\" is unstable"));
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&c, 1, "k"), want, TOL);
    }
    study_free(&c);
}

static void configuration_that_stays_unstable__is_no_failure(mt_test *t)
{
    study_case c;
    if (study_solve(t, INVERTED,
                    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}]", &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_COMPROMISE);
        CHECK_STR(t, c.result->status_text, "The original design does not meet all goals.");
    }
    study_free(&c);
    if (study_solve(t, INVERTED,
                    "'variables': [{'parameter': 'k', 'lower': 1, 'upper': 9}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.5}]",
                    &c)) {
        CHECK(t, c.result->status != MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 0);
        CHECK_STR(t, c.result->status_text, "No design that was tried could be evaluated.");
    }
    study_free(&c);
}

static void absent_modes__are_errors_that_name_the_goal(mt_test *t)
{
    static const struct {
        const char *model;
        const char *parameter;
        const char *goal;
        const char *text;
    } rows[] = {
        {STUDY_TWO_MASSES("'k1': 3, 'k2': 1, 'm': 1", ""), "k1",
         "{'type': 'frequency', 'mode': 3, 'target_hz': 1}",
         "/goals/1: configuration \"default\" has no vibration mode 3 (it has 2)"},
        {INVERTED, "k", "{'type': 'frequency', 'mode': 'upright', 'target_hz': 1}",
         "/goals/1: mode \"upright\" is vibration mode 1 of configuration \"default\", which "
         "has none at the original design (it is unstable there)"},
        {STUDY_TWO_MASSES("'k1': 3, 'k2': 1, 'm': 1",
                          ", 'configurations': {'a': {}, 'b': {}},"
                          "'modes': {'low': {'configuration': 'a', 'index': 1}}"),
         "k1", "{'type': 'frequency', 'configuration': 'b', 'mode': 'low', 'target_hz': 1}",
         "/goals/1: mode \"low\" is named in configuration \"a\", not in \"b\""},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        study_case c;
        char members[1024];
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': '%s', 'lower': 1, 'upper': 9}],"
                       "'goals': [{'type': 'limit', 'expression': '%s', 'at_least': 1}, %s]",
                       rows[i].parameter, rows[i].parameter, rows[i].goal);
        mt_test_row(t, "%s", rows[i].goal);
        CHECK(t, !study_try(t, rows[i].model, members, &c));
        CHECK_INT(t, c.rc, MT_E_INPUT);
        CHECK_STR(t, c.err.text, rows[i].text);
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(two_configurations__share_their_variables),
             MT_TEST(override__wins_over_a_variable_and_like_inherits),
             MT_TEST(goal_over_several_configurations__holds_in_each),
             MT_TEST(unstable_original__leaves_its_goals_unmet_and_is_left),
             MT_TEST(configuration_that_stays_unstable__is_no_failure),
             MT_TEST(absent_modes__are_errors_that_name_the_goal))
