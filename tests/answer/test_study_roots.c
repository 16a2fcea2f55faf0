/* SPDX-License-Identifier: GPL-3.0-or-later */
/* As many target frequencies as variables: all designs that have them, ranked by change. */
#include "analysis/analysis.h"
#include "study_fixture.h"

/* Targets are met to 1e-6 relative (the default tolerance), roots are polished far beyond. */
static const double ROOT_TOL = 1e-9;

#define TWO_SPRINGS                                                 \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10}," \
    " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"

/* k1, k2 with both eigenvalues of (3, 1): trace k1 + 2 k2 = 5, determinant k1 k2 = 3, so k1 = 3
 * or 2. */
static void springs_in_a_row__both_designs_are_found_and_ranked_by_change(mt_test *t)
{
    study_case c;
    const char *const starts[] = {"'k1': 2.9, 'k2': 1.05, 'm': 1",
                                  "'k1': 2.1, 'k2': 1.4, 'm': 1"};
    for (int i = 0; i < 2; i++) {
        char model[4096];
        (void)snprintf(model, sizeof model, "%s%s%s",
                       "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {",
                       starts[i], "}," STUDY_TWO_MASSES_ROW "}");
        mt_test_row(t, "original design %d", i);
        if (study_solve(t, model,
                        TWO_SPRINGS "'goals': [{'type': 'frequency', 'mode': 1,"
                                    " 'target_hz': 'sqrt((5 - sqrt(13))/2)/(2*pi)'},"
                                    "{'type': 'frequency', 'mode': 2,"
                                    " 'target_hz': 'sqrt((5 + sqrt(13))/2)/(2*pi)'}]",
                        &c)) {
            const int near = i == 0 ? 1 : 2; /* rank of (3, 1) */
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_INT(t, c.result->n_recommendations, 2);
            CHECK_NEAR(t, study_value(&c, near, "k1"), 3.0, ROOT_TOL);
            CHECK_NEAR(t, study_value(&c, near, "k2"), 1.0, ROOT_TOL);
            CHECK_NEAR(t, study_value(&c, 3 - near, "k1"), 2.0, ROOT_TOL);
            CHECK_NEAR(t, study_value(&c, 3 - near, "k2"), 1.5, ROOT_TOL);
            CHECK(t, !c.result->recommendations[0].singular);
            CHECK(t, c.result->recommendations[0].change < c.result->recommendations[1].change);
            const double k1 = i == 0 ? 2.9 : 2.1;
            const double k2 = i == 0 ? 1.05 : 1.4;
            const double first[2] = {i == 0 ? 3.0 : 2.0, i == 0 ? 1.0 : 1.5};
            CHECK_NEAR(t, c.result->recommendations[0].change,
                       hypot(log(first[0] / k1), log(first[1] / k2)), ROOT_TOL);
            CHECK_INT(t, c.result->n_warnings, 0);
        }
        study_free(&c);
    }
}

/* At (2, 1) both roots coincide: dk/dlambda is infinite, so that a target error e moves the
 * design by sqrt(e); targets are held to far less. */
static void springs_in_a_row__double_root_is_one_singular_design(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 2.6, 'k2': 0.8, 'm': 1", ""),
                    TWO_SPRINGS "'goals': [{'type': 'frequency', 'mode': 1,"
                                " 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)'},"
                                "{'type': 'frequency', 'mode': 2,"
                                " 'target_hz': 'sqrt(2 + sqrt(2))/(2*pi)'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 1);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "k1"), 2.0, 1e-4);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "k2"), 1.0, 1e-4);
        CHECK(t, c.result->recommendations[0].singular);
        CHECK(t, study_reasons(&c, 1, "double solution"));
    }
    study_free(&c);
}

/* Frequency of the loaded four-bar with a crank of length a, from an analysis opened there. */
static double four_bar_hz(const mt_model *model, double a)
{
    mt_analysis *analysis = NULL;
    const int input = mt_model_find_parameter(model, "a");
    double hz = nan("");
    if (mt_analysis_new(model, mt_model_find_configuration(model, "loaded"), 1, &input, &a,
                        &analysis, NULL) == MT_OK) {
        hz = mt_modal_hz(&analysis->modes, mt_modal_flexible(&analysis->modes, 1));
    }
    mt_analysis_delete(analysis);
    return hz;
}

/* A closed loop under gravity: every evaluation closes the loop with the position solver and
 * finds the equilibrium. */
static void four_bar__crank_length_is_solved_for_and_verified(mt_test *t)
{
    study_case c;
    if (study_solve(t, "four_bar",
                    "'variables': [{'parameter': 'a', 'lower': 0.1, 'upper': 0.2}],"
                    "'goals': [{'type': 'frequency', 'configuration': 'loaded',"
                    " 'mode': 1, 'target_hz': 2.05}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK(t, c.result->n_recommendations >= 1);
        for (int k = 1; k <= c.result->n_recommendations; k++) {
            const double a = study_value(&c, k, "a");
            mt_test_row(t, "crank %g", a);
            CHECK(t, a > 0.1 && a < 0.2);
            CHECK_NEAR(t, four_bar_hz(c.study->model, a), 2.05, ROOT_TOL);
            CHECK_NEAR(t, study_frequency(&c, k, "loaded", 1), 2.05, ROOT_TOL);
        }
        /* the drawing's own crank is the baseline */
        CHECK_NEAR(t, study_frequency(&c, 0, "loaded", 1), four_bar_hz(c.study->model, 0.15),
                   ROOT_TOL);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(springs_in_a_row__both_designs_are_found_and_ranked_by_change),
             MT_TEST(springs_in_a_row__double_root_is_one_singular_design),
             MT_TEST(four_bar__crank_length_is_solved_for_and_verified))
