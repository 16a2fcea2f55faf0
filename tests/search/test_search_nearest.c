/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Flat optima, whose design of least change is known in closed form. a b >= 2 makes a b = 2 the
 * least product, by every a and b = 2/a; of these with weights v of a and w of b
 *
 *     ln a = ln 2 w / (v + w),   ln b = ln 2 v / (v + w).
 */
#include "study_fixture.h"

#define MODEL STUDY_TWO_MASSES("'a': 1, 'b': 1, 'k1': 1, 'k2': 'a*b', 'm': 1", "")
#define VARIABLES                                                              \
    "'variables': [{'parameter': 'a', 'lower': 0.2, 'upper': 5, 'weight': 3}," \
    " {'parameter': 'b', 'lower': 0.1, 'upper': 6}],"
#define LIMIT   "{'type': 'limit', 'expression': 'a*b', 'at_least': 2}"
#define FAR     "{'type': 'avoid', 'bands_hz': [[100, 200]]}"
#define PRODUCT "{'minimise': 'a*b'}"

static const double A = 1.1892071150027210667; /* 2^(1/4) */
static const double B = 1.6817928305074290861; /* 2^(3/4) */
/* Limits are met within 1e-6. */
static const double MET = 2e-6;

static const struct {
    const char *name;
    const char *members;
} rows[] = {
    {"an expression", VARIABLES "'objective': " PRODUCT ", 'goals': [" LIMIT "]"},
    {"in a gap", VARIABLES "'objective': " PRODUCT ", 'goals': [" LIMIT "," FAR "]"},
    {"a constant after it",
     VARIABLES "'objective': [" PRODUCT ", {'minimise': '(a*b)^2'}], 'goals': [" LIMIT "]"},
    {"in a gap, a constant after it", VARIABLES
     "'objective': [" PRODUCT ", {'minimise': '(a*b)^2'}], 'goals': [" LIMIT "," FAR "]"},
    {"the change is asked for",
     VARIABLES "'objective': [" PRODUCT ", {'minimise': 'change'}], 'goals': [" LIMIT "]"},
};

static void flat_optimum__is_the_one_of_least_change(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        double first = nan("");
        mt_test_row(t, "%s", rows[i].name);
        for (int threads = 1; study_load(t, MODEL, rows[i].members, &c) && threads <= 8;
             threads *= 2) {
            if (!study_solve_threads(t, rows[i].name, threads, &c)) {
                break;
            }
            const double a = study_value(&c, 1, "a");
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, a / A, 1.0, MET);
            CHECK_NEAR(t, study_value(&c, 1, "b") / B, 1.0, MET);
            CHECK(t, c.result->recommendations[0].kkt_residual <= 1e-6);
            first = threads == 1 ? a : first;
            CHECK(t, a == first);
            study_free(&c);
        }
        study_free(&c);
    }
}

/* A budget is not exceeded, wherever it ends; what it has is told. */
static void budget__is_kept(mt_test *t)
{
    static const char *const kinds[] = {
        VARIABLES "'objective': " PRODUCT ", 'goals': [" LIMIT "]",
        VARIABLES "'objective': {'minimise': 'a'}, 'goals': ["
                  "{'type': 'limit', 'expression': 'a', 'at_least': 2},"
                  "{'type': 'limit', 'expression': 'b', 'at_least': 1.5}]",
        VARIABLES "'objective': {'minimise': 'misfit'}, 'goals': ["
                  "{'type': 'frequency', 'mode': 1, 'target_hz': 0.13, 'weight': 1}]",
    };
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        for (long most = 1; most <= 4096;
             most = most < 300 ? most + (most / 8) + 1 : 2 * most) {
            study_case c;
            char members[600];
            (void)snprintf(members, sizeof members, "%s, 'search': {'max_evaluations': %ld}",
                           kinds[i], most);
            mt_test_row(t, "%d: %ld evaluations", i, most);
            if (study_solve(t, MODEL, members, &c)) {
                CHECK(t, c.result->run.spent.search <= most);
            }
            study_free(&c);
        }
    }
}

/* What is determined is not asked again. */
static void determined_optimum__costs_nothing(mt_test *t)
{
    study_case c;
    study_case again;
    long evaluations[2] = {0, 0};
    if (study_solve(t, MODEL,
                    VARIABLES "'objective': {'minimise': 'a+b'}, 'goals': [" LIMIT "]", &c)) {
        CHECK_NEAR(t, study_value(&c, 1, "a") / sqrt(2.0), 1.0, MET);
        evaluations[0] = c.result->run.spent.search;
    }
    study_free(&c);
    if (study_solve(t, MODEL,
                    VARIABLES "'objective': [{'minimise': 'a+b'}, {'minimise': 'change'}],"
                              " 'goals': [" LIMIT "]",
                    &again)) {
        evaluations[1] = again.result->run.spent.search;
    }
    study_free(&again);
    CHECK(t, evaluations[0] < evaluations[1]);
}

/* a >= 2 makes a = 2 the least; c is felt by limits alone, which hold it where they begin. */
static const struct {
    const char *name;
    const char *limit;
    double c;
} idle[] = {
    {"its own limit", "{'type': 'limit', 'expression': 'c', 'at_least': 1.5}", 1.5},
    {"a limit of both", "{'type': 'limit', 'expression': 'a*c', 'at_least': 2.4}", 1.2},
    {"from above", "{'type': 'limit', 'expression': 'a*c', 'at_most': 1}", 0.5},
    {"no limit in the way", "{'type': 'limit', 'expression': 'a*c', 'at_least': 1}", 1.0},
};

static void idle_variable__is_at_the_nearest_that_limits_let(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(idle); i++) {
        study_case c;
        char members[600];
        (void)snprintf(members, sizeof members,
                       "'variables': [{'parameter': 'a', 'lower': 0.2, 'upper': 5},"
                       " {'parameter': 'c', 'lower': 0.1, 'upper': 6}],"
                       "'objective': {'minimise': 'a'}, 'goals': ["
                       "{'type': 'limit', 'expression': 'a', 'at_least': 2}, %s]",
                       idle[i].limit);
        mt_test_row(t, "%s", idle[i].name);
        if (study_solve(t, STUDY_TWO_MASSES("'a': 1, 'c': 1, 'k1': 1, 'k2': 'a', 'm': 1", ""),
                        members, &c)) {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, study_value(&c, 1, "a") / 2.0, 1.0, MET);
            CHECK_NEAR(t, study_value(&c, 1, "c") / idle[i].c, 1.0, MET);
            CHECK(t, c.result->recommendations[0].kkt_residual <= 1e-6);
        }
        study_free(&c);
    }
}

/* Every combination that is listed is the nearest of its equal designs. */
static void combinations__are_listed_at_their_nearest(mt_test *t)
{
    for (int threads = 1; threads <= 4; threads *= 2) {
        study_case c;
        mt_test_row(t, "%d threads", threads);
        if (study_load(
                t, STUDY_TWO_MASSES("'a': 1, 'b': 1, 'd': 1, 'k1': 1, 'k2': 'a*b', 'm': 1", ""),
                "'variables': [{'parameter': 'a', 'lower': 0.2, 'upper': 5, 'weight': 3},"
                " {'parameter': 'b', 'lower': 0.1, 'upper': 6},"
                " {'parameter': 'd', 'catalogue': [1, 1.5, 2]}],"
                "'objective': {'minimise': 'a*b + d'}, 'goals': [" LIMIT "],"
                "'recommendations': 2",
                &c) &&
            study_solve_threads(t, "listed", threads, &c)) {
            CHECK_INT(t, c.result->n_recommendations, 2);
            for (int rank = 1; rank <= c.result->n_recommendations; rank++) {
                CHECK_NEAR(t, study_value(&c, rank, "a") / A, 1.0, MET);
                CHECK_NEAR(t, study_value(&c, rank, "b") / B, 1.0, MET);
                CHECK_NEAR(t, study_value(&c, rank, "d"), rank == 1 ? 1.0 : 1.5, 1e-15);
            }
        }
        study_free(&c);
    }
}

/* One frequency and two springs: the exact fits lie on a curve, of which the nearest stands. */
static void curve_of_fits__is_one_design(mt_test *t)
{
    study_case c;
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 1, 'k2': 1, 'm': 1", ""),
                    "'variables': [{'parameter': 'k1', 'lower': 0.05, 'upper': 20},"
                    " {'parameter': 'k2', 'lower': 0.05, 'upper': 20}],"
                    "'objective': {'minimise': 'misfit'}, 'recommendations': 30, 'goals': ["
                    "{'type': 'frequency', 'mode': 1, 'target_hz': 0.13, 'weight': 1}]",
                    &c)) {
        CHECK_INT(t, c.result->n_recommendations, 1);
        CHECK(t, strstr(c.result->status_text, "a continuum of designs has it") != NULL);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(flat_optimum__is_the_one_of_least_change), MT_TEST(budget__is_kept),
             MT_TEST(determined_optimum__costs_nothing),
             MT_TEST(idle_variable__is_at_the_nearest_that_limits_let),
             MT_TEST(combinations__are_listed_at_their_nearest),
             MT_TEST(curve_of_fits__is_one_design))
