/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The best design has a repeated mode: a mass of 1 kg in a plane, held by springs k_i in the
 * directions n_i, K = sum k_i n_i n_i^T. The cheapest K with its lowest eigenvalue at least 1
 * is K = 1, where no single mode has a slope.
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

/* Three directions: K = 1 needs k = 2/3 each, whatever they cost (in bounds for which the
 * multiplier is positive definite). */
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

/* Two crosses of springs: K = 1 by either, and by every mixture; the cheaper cross wins, the
 * other stays at its bounds. */
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

#define THREE                                                                                \
    MODEL("'ka': 1, 'kb': 3, 'kc': 5",                                                       \
          SPRING("a", "1", "0") "," SPRING("b", "0.5", "sqrt(0.75)") "," SPRING("c", "-0.5", \
                                                                                "sqrt(0.75)"))
#define THREE_VARIABLES "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE("c") "],"
#define COST            "'objective': {'minimise': 'ka + 1.3*kb + 0.8*kc'}"
/* From 0 Hz to where omega = 1. */
#define BAND "{'type': 'avoid', 'bands_hz': [[0, '1/(2*pi)']], 'margin_percent': 0}"

static void equal_springs(mt_test *t, const study_case *c, double k)
{
    const mt_recommendation *const best = &c->result->recommendations[0];
    CHECK_INT(t, c->result->status, MT_RESULT_SOLVED);
    CHECK_INT(t, c->result->n_recommendations, 1);
    CHECK(t, best->kkt_residual <= 1e-6);
    CHECK_NEAR(t, study_value(c, 1, "ka"), k, 1e-5);
    CHECK_NEAR(t, study_value(c, 1, "kb"), k, 1e-5);
    CHECK_NEAR(t, study_value(c, 1, "kc"), k, 1e-5);
}

/* The same as an upper edge of a band. */
static void repeated__a_band_is_kept_by_a_cluster(mt_test *t)
{
    study_case c;
    if (study_solve(t, THREE, THREE_VARIABLES "'goals': [" BAND "]," COST, &c)) {
        equal_springs(t, &c, 2.0 / 3.0);
    }
    study_free(&c);
}

/* trace K = sum k: of all with the sum 3 the lowest frequency is highest where K = 1.5. */
static void repeated__the_greatest_clearance_is_a_clusters(mt_test *t)
{
    study_case c;
    if (study_solve(t, THREE,
                    THREE_VARIABLES "'goals': [" BAND
                                    ", {'type': 'limit', 'expression': 'ka + kb + kc',"
                                    " 'at_most': 3}], 'objective': {'maximise': 'clearance'}",
                    &c)) {
        equal_springs(t, &c, 1.0);
        CHECK_NEAR(t, c.result->recommendations[0].score, 100.0 * (sqrt(1.5) - 1.0), 1e-3);
    }
    study_free(&c);
}

/* All springs 10 % too soft: 0.9 K = 1. */
#define LOOSE(name) \
    "{'parameter': 'k" name "', 'lower': 0.01, 'upper': 20, 'tolerance_percent': 10}"
static void repeated__the_worst_corner_is_a_clusters(mt_test *t)
{
    study_case c;
    if (study_solve(t, THREE,
                    "'variables': [" LOOSE("a") "," LOOSE("b") "," LOOSE("c") "]," GOAL COST,
                    &c)) {
        equal_springs(t, &c, 2.0 / 2.7);
    }
    study_free(&c);
}

/* A target on the lowest mode of the cluster; and on the highest, where as much spring as
 * possible is wanted. */
static void repeated__a_target_is_kept_by_the_cluster_beyond_it(mt_test *t)
{
    study_case c;
    if (study_solve(t, THREE,
                    THREE_VARIABLES "'goals': [{'type': 'frequency', 'mode': 1,"
                                    " 'target_hz': '1/(2*pi)'}]," COST,
                    &c)) {
        equal_springs(t, &c, 2.0 / 3.0);
    }
    study_free(&c);
    if (study_solve(t, THREE,
                    THREE_VARIABLES "'goals': [{'type': 'frequency', 'mode': 2,"
                                    " 'target_hz': '1/(2*pi)'}],"
                                    "'objective': {'minimise': '-(ka + 1.3*kb + 0.8*kc)'}",
                    &c)) {
        equal_springs(t, &c, 2.0 / 3.0);
    }
    study_free(&c);
}

#define CROSSES                                                       \
    MODEL("'ka': 1, 'kb': 3, 'kc': 5, 'kd': 2",                       \
          SPRING("a", "1", "0") "," SPRING("b", "0", "1") "," SPRING( \
              "c", "sqrt(0.5)", "sqrt(0.5)") "," SPRING("d", "-sqrt(0.5)", "sqrt(0.5)"))
/* Both modes at one target: K = 1, three equations where two are asked, and the cheaper cross
 * as far as it goes. */
static void repeated__two_targets_are_three_equations(mt_test *t)
{
    study_case c;
    if (study_solve(t, CROSSES,
                    "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE(
                        "c") "," VARIABLE("d") "],"
                                               "'goals': [{'type': 'frequency', 'mode': 1,"
                                               " 'target_hz': '1/(2*pi)'},"
                                               " {'type': 'frequency', 'mode': 2,"
                                               " 'target_hz': '1/(2*pi)'}],"
                                               "'objective': {'minimise':"
                                               " 'ka + kb + 1.1*kc + 1.2*kd'}",
                    &c)) {
        shown(t, &c);
        CHECK_NEAR(t, study_value(&c, 1, "ka"), 0.99, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kc"), 0.01, 1e-5);
    }
    study_free(&c);
}

/* One more spring beside the first, from a catalogue: every value of it has its own design with
 * K = 1, and no other. */
static void repeated__each_value_of_a_catalogue_has_one_design(mt_test *t)
{
    study_case c;
    if (study_solve(t,
                    MODEL("'ka': 1, 'kb': 3, 'kc': 5, 'kd': 0.1",
                          SPRING("a", "1", "0") "," SPRING("b", "0.5", "sqrt(0.75)") "," SPRING(
                              "c", "-0.5", "sqrt(0.75)") "," SPRING("d", "-1", "0")),
                    "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE(
                        "c") ", {'parameter': 'kd', 'catalogue': [0.1, 0.3, 0.6]}]," GOAL
                             "'objective': {'minimise': 'ka + 1.3*kb + 0.8*kc + 0.5*kd'}",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 3);
        for (int i = 1; i <= c.result->n_recommendations; i++) {
            const double d = study_value(&c, i, "kd");
            CHECK_NEAR(t, d, i == 1 ? 0.6 : i == 2 ? 0.3 : 0.1, 1e-12);
            CHECK_NEAR(t, study_value(&c, i, "ka"), (2.0 / 3.0) - d, 1e-5);
            CHECK_NEAR(t, study_value(&c, i, "kb"), 2.0 / 3.0, 1e-5);
            CHECK(t, c.result->recommendations[i - 1].kkt_residual <= 1e-6);
        }
    }
    study_free(&c);
}

/* Every mixture of both crosses has the same sum of springs: the second objective chooses among
 * them, and what it leaves where the search stalls is no design. */
static void repeated__a_second_objective_comes_to_one_design(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, CROSSES,
            "'variables': [" VARIABLE("a") "," VARIABLE("b") "," VARIABLE("c") "," VARIABLE(
                "d") "]," GOAL "'objective': [{'minimise': 'ka + kb + kc + kd'},"
                     " {'minimise': '1.2*ka + kb + 1.1*kc + 1.3*kd'}],"
                     "'recommendations': 9",
            &c)) {
        shown(t, &c);
        CHECK_NEAR(t, study_value(&c, 1, "ka"), 0.99, 1e-5);
        CHECK_NEAR(t, study_value(&c, 1, "kc"), 0.01, 1e-5);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(repeated__three_springs_come_to_the_one_design),
             MT_TEST(repeated__the_cheaper_cross_wins),
             MT_TEST(repeated__a_band_is_kept_by_a_cluster),
             MT_TEST(repeated__the_greatest_clearance_is_a_clusters),
             MT_TEST(repeated__the_worst_corner_is_a_clusters),
             MT_TEST(repeated__a_target_is_kept_by_the_cluster_beyond_it),
             MT_TEST(repeated__two_targets_are_three_equations),
             MT_TEST(repeated__a_second_objective_comes_to_one_design),
             MT_TEST(repeated__each_value_of_a_catalogue_has_one_design))
