/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objectives in order: what the first leaves open the next decides, and the first stays where
 * it was. */
#include "study_fixture.h"

static const double TOL = 1e-6;

/* k1 = a b: a frequency settles the product, and the second objective where on that curve. */
#define PRODUCT                                                                              \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                         \
    "'parameters': {'a': 1.5, 'b': 1.2, 'k1': 'a*b', 'k2': 1, 'm': 1}," STUDY_TWO_MASSES_ROW \
    "}"
#define A_AND_B                                                   \
    "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 5}," \
    " {'parameter': 'b', 'lower': 0.5, 'upper': 5}],"
#define FIRST_MODE \
    "{'type': 'frequency', 'mode': 1, 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)', 'weight': 1}"

static void exact_misfit__leaves_the_rest_to_the_next_objective(mt_test *t)
{
    static const struct {
        const char *next;
        double a; /* with a b = 2 */
    } rows[] = {
        /* sqrt(6) */
        {"{'minimise': 'a + 3*b'}", 2.449489742783178},
        {"{'minimise': 'a'}", 0.5},
        {"{'minimise': 'b'}", 4.0},
        {"{'minimise': 'change'}",
         /* a/b = 1.25 as at the original design */
         1.5811388300841898},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        study_case c;
        char members[1024];
        (void)snprintf(members, sizeof members,
                       "%s'goals': [%s], 'objective': [{'minimise': 'misfit'}, %s]", A_AND_B,
                       FIRST_MODE, rows[i].next);
        mt_test_row(t, "%s", rows[i].next);
        if (study_solve(t, PRODUCT, members, &c)) {
            const double a = study_value(&c, 1, "a");
            CHECK_INT(t, c.result->status, MT_RESULT_FITTED);
            CHECK_INT(t, c.result->n_recommendations, 1);
            CHECK_NEAR(t, a, rows[i].a, 1e-4);
            CHECK_NEAR(t, a * study_value(&c, 1, "b"), 2.0, 1e-5);
            CHECK(t, c.result->recommendations[0].misfit <= 1.1e-6);
            CHECK_NEAR_ABS(t, c.result->recommendations[0].score,
                           c.result->recommendations[0].misfit, 0.0);
            CHECK(t, study_reasons(&c, 1, "With the least misfit held, it has the least "));
        }
        study_free(&c);
    }
}

/* The least "a*b" is a whole curve, on which the change then decides. */
static void flat_optimum__is_settled_by_the_next_objective(mt_test *t)
{
    study_case c;
    if (study_solve(t, PRODUCT,
                    A_AND_B "'goals': [{'type': 'frequency', 'mode': 1,"
                            " 'at_least_hz': 'sqrt(2 - sqrt(2))/(2*pi)'}],"
                            "'objective': [{'minimise': 'a*b'}, {'minimise': 'change'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_INT(t, c.result->n_recommendations, 1); /* many points of the curve, one design */
        CHECK_NEAR(t, study_value(&c, 1, "a"), sqrt(2.0 * 1.25), 1e-4);
        CHECK_NEAR(t, study_value(&c, 1, "b"), sqrt(2.0 / 1.25), 1e-4);
        CHECK_NEAR(t, c.result->recommendations[0].score, 2.0, 4e-6);
        CHECK_INT(t, c.result->n_warnings, 0);
    }
    study_free(&c);
}

/* Two goals ask the one frequency for different values: the least misfit is at the weighted
 * mean of the logarithms, and stays there. */
static void inexact_misfit__is_held(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, STUDY_TWO_MASSES("'k1': 2, 'k2': 1, 'm': 1", ""),
            "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10},"
            " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"
            "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.12, 'weight': 1},"
            "{'type': 'frequency', 'mode': 1, 'target_hz': 0.13, 'weight': 2}],"
            "'objective': [{'minimise': 'misfit'}, {'minimise': 'k1 + k2'}]",
            &c)) {
        const double hz = exp((log(0.12) + (2.0 * log(0.13))) / 3.0);
        const double lambda = pow(2.0 * STUDY_PI * hz, 2.0);
        CHECK_INT(t, c.result->status, MT_RESULT_FITTED);
        CHECK_NEAR(t, c.result->recommendations[0].misfit, sqrt(2.0 / 3.0) * log(0.13 / 0.12),
                   TOL);
        CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), hz, 4e-6);
        /* lambda^2 - lambda (k1 + 2 k2) + k1 k2 = 0 gives k1(k2); the least sum has d k1/d k2 =
         * -1, which is k1 k2: (k2 - lambda)^2 = lambda^2 */
        const double k2 = 2.0 * lambda;
        const double k1 = ((2.0 * lambda * k2) - (lambda * lambda)) / (k2 - lambda);
        CHECK_NEAR(t, study_value(&c, 1, "k2"), k2, 1e-3);
        CHECK_NEAR(t, study_value(&c, 1, "k1") + study_value(&c, 1, "k2"), k1 + k2, 1e-5);
    }
    study_free(&c);
}

/* k1 falls and rises again with a: two designs near the frequencies that are asked for, of
 * which k2 makes one worse. The misfits that are told are those of the first and of the
 * last. */
static void misfits__are_told_from_the_least_to_the_greatest(mt_test *t)
{
    study_case c;
    if (study_solve(
            t,
            "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'a': 1.2, 'k1': '1 "
            "+ "
            "(a - 2)^2', 'k2': '1 + 0.05*a', 'm': 1}," STUDY_TWO_MASSES_ROW "}",
            "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 4}], 'goals': [{'type': "
            "'limit', 'expression': 'a', 'at_least': 0.6}, {'type': 'frequency', 'mode': 1, "
            "'target_hz': 0.115, 'weight': 1}, {'type': 'frequency', 'mode': 2, 'target_hz': "
            "0.28, 'weight': 1}], 'objective': {'minimise': 'misfit'}",
            &c)) {
        const mt_recommendation *const r = c.result->recommendations;
        const char *const from = strstr(c.result->status_text, "misfits from ");
        double told[2] = {nan(""), nan("")};
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        REQUIRE(t, c.result->n_recommendations == 2 && from != NULL);
        char *end = NULL;
        told[0] = strtod(from + strlen("misfits from "), &end);
        REQUIRE(t, strncmp(end, " to ", 4) == 0);
        told[1] = strtod(end + 4, &end);
        CHECK_NEAR(t, told[0], r[0].misfit, 1e-3);
        CHECK_NEAR(t, told[1], r[1].misfit, 1e-3);
        CHECK(t, r[1].misfit > 1.1 * r[0].misfit);
    }
    study_free(&c);
}

/* Weighted goals beside another first objective are residuals that the first stage does not
 * see. */
static void misfit_as_second_objective__follows_the_first(mt_test *t)
{
    study_case c;
    if (study_solve(t, PRODUCT,
                    A_AND_B
                    "'goals': [{'type': 'limit', 'expression': 'a', 'at_least': 1}," FIRST_MODE
                    "], 'objective': [{'minimise': 'a'}, {'minimise': 'misfit'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&c, 1, "a"), 1.0, 3e-6);
        CHECK_NEAR(t, study_value(&c, 1, "b"), 2.0, 1e-5);
        CHECK_NEAR(t, c.result->recommendations[0].score, study_value(&c, 1, "a"), 1e-15);
    }
    study_free(&c);
}

/* Least change first: it is zero at an original design that meets its goals, and nothing may
 * move any more. */
static void change_as_first_objective__is_held_at_the_original(mt_test *t)
{
    study_case c;
    if (study_solve(t, PRODUCT,
                    A_AND_B "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}],"
                            "'objective': [{'minimise': 'change'}, {'minimise': 'a'}]",
                    &c)) {
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, study_value(&c, 1, "a"), 1.5, 2e-6);
        CHECK_NEAR(t, study_value(&c, 1, "b"), 1.2, 2e-6);
    }
    study_free(&c);
}

/* Two pairs of stiffnesses give both frequencies, (3, 1) and (2, 1.5), and one product, 3: the
 * second objective alone decides their order. */
static void equal_first_objective__the_second_decides_the_order(mt_test *t)
{
    static const struct {
        const char *second;
        double k1[2]; /* by rank */
    } rows[] = {
        {"k1", {2.0, 3.0}},
        {"-k1", {3.0, 2.0}},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        char members[1024];
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10},"
                       " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"
                       "'goals': [{'type': 'frequency', 'mode': 1,"
                       " 'target_hz': 'sqrt((5 - sqrt(13))/2)/(2*pi)'},"
                       "{'type': 'frequency', 'mode': 2,"
                       " 'target_hz': 'sqrt((5 + sqrt(13))/2)/(2*pi)'}],"
                       "'objective': [{'minimise': 'k1*k2'}, {'minimise': '%s'}]",
                       rows[i].second);
        mt_test_row(t, "%s", rows[i].second);
        if (study_solve(t, STUDY_TWO_MASSES("'k1': 2.4, 'k2': 1.3, 'm': 1", ""), members, &c)) {
            CHECK_INT(t, c.result->n_recommendations, 2);
            CHECK_NEAR(t, study_value(&c, 1, "k1"), rows[i].k1[0], TOL);
            CHECK_NEAR(t, study_value(&c, 2, "k1"), rows[i].k1[1], TOL);
            CHECK_NEAR(t, c.result->recommendations[1].score, 3.0, TOL);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(misfits__are_told_from_the_least_to_the_greatest),
             MT_TEST(equal_first_objective__the_second_decides_the_order),
             MT_TEST(exact_misfit__leaves_the_rest_to_the_next_objective),
             MT_TEST(flat_optimum__is_settled_by_the_next_objective),
             MT_TEST(inexact_misfit__is_held),
             MT_TEST(misfit_as_second_objective__follows_the_first),
             MT_TEST(change_as_first_objective__is_held_at_the_original))
