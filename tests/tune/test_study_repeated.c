/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The best design has a repeated mode: a mass of 1 kg in a plane, held by springs k_i in the directions n_i, K = sum k_i n_i n_i^T. The cheapest
 * K with its lowest eigenvalue at least 1 is K = 1, where no single mode has a slope.
 */
#include "study_fixture.h"

/* Springs to ground at (cos, sin) of the angle; one across the plane holds the rest. */
#define SPRING(name, x, y)                                                                   \
    "{'name': 's" name "', 'type': 'axial', 'bodies': ['ground', 'm'], 'at': [['" x "', '" y \
    "', 0], [0, 0, 0]], 'stiffness_n_per_m': 'k" name "'}"
#define MODEL(parameters, springs)                                                       \
    "{'format': 'modetune-model/1', 'dimension': 3, 'parameters': {" parameters "},"     \
    "'bodies': [{'name': 'm', 'mass_kg': 1, 'centre': [0, 0, 0]}], 'springs': [" springs \
    ", {'name': 'across', 'type': 'axial', 'bodies': ['ground', 'm'],"                   \
    " 'at': [[0, 0, 1], [0, 0, 0]], 'stiffness_n_per_m': 100}]}"
#define VARIABLE(name) "{'parameter': 'k" name "', 'lower': 0.01, 'upper': 20}"
#define GOAL           "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': '1/(2*pi)'}],"

static void shown(mt_test *t, const study_case *c)
{
    const mt_recommendation *const best = &c->result->recommendations[0];
    CHECK_INT(t, c->result->status, MT_RESULT_SOLVED);
    CHECK_INT(t, c->result->n_recommendations, 1);
    CHECK(t, best->kkt_residual <= 1e-6);
    CHECK(t, strstr(c->result->status_text, "not shown") == NULL);
    CHECK_NEAR(t, study_frequency(c, 1, best->frequencies[0].configuration, 2),
               1.0 / (2.0 * STUDY_PI), 1e-6);
}

/* Three directions: K = 1 needs k = 2/3 each, whatever they cost (in bounds for which the multiplier is positive definite). */
static void repeated__three_springs_come_to_the_one_design(mt_test *t)
{
    study_case c;
    if (study_solve(t,
                    MODEL("'ka': 1, 'kb': 3, 'kc': 5",
                          SPRING("a", "1", "0") "," SPRING("b", "0.5", "sqrt(0.75)") "," SPRING(
                              "c", "-0.5", "sqrt(0.75)")),
                    "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE(
                        "c") "]," GOAL "'objective': {'minimise': 'ka + 1.3*kb + 0.8*kc'}",
                    &c)) {
        shown(t, &c);
        CHECK_NEAR(t, study_value(&c, 1, "ka"), 2.0 / 3.0, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kb"), 2.0 / 3.0, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kc"), 2.0 / 3.0, 1e-5);
    }
    study_free(&c);
}

/* Two crosses of springs: K = 1 by either, and by every mixture; the cheaper cross wins, the other stays at its bounds. */
static void repeated__the_cheaper_cross_wins(mt_test *t)
{
    study_case c;
    if (study_solve(
            t,
            MODEL(
                "'ka': 1, 'kb': 3, 'kc': 5, 'kd': 2",
                SPRING("a", "1", "0") "," SPRING("b", "0", "1") "," SPRING(
                    "c", "sqrt(0.5)", "sqrt(0.5)") "," SPRING("d", "-sqrt(0.5)", "sqrt(0.5)")),
            "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE("c") "," VARIABLE(
                "d") "]," GOAL "'objective': {'minimise': 'ka + kb + 1.1*kc + 1.2*kd'}",
            &c)) {
        shown(t, &c);
        CHECK_NEAR(t, study_value(&c, 1, "ka"), 0.99, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kb"), 0.99, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kc"), 0.01, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kd"), 0.01, 1e-5);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(repeated__three_springs_come_to_the_one_design),
             MT_TEST(repeated__the_cheaper_cross_wins))
