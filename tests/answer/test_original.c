/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An original design that meets all goals is the answer of a study that asks for the least
 * change, without a search; one that only seems to meet them is not. Two masses in a row with
 * modes at 0.134 and 0.330 Hz. */
#include "study_fixture.h"

#define MODEL        STUDY_TWO_MASSES("'k1': 2.9, 'k2': 1.05, 'm': 1", "")
#define K1           "{'parameter': 'k1', 'lower': 0.5, 'upper': 10}"
#define K2           "{'parameter': 'k2', 'lower': 0.5, 'upper': 10}"
#define BOTH         "'variables': [" K1 "," K2 "],"
#define AT_LEAST(hz) "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': " hz "}]"
#define BETWEEN      "'goals': [{'type': 'avoid', 'bands_hz': [[0.2, 0.25]]}]"

static bool is_taken(const study_case *c)
{
    return strstr(c->result->status_text, "the original design meets all goals") != NULL &&
           c->result->run.spent.search == 0;
}

static void good_original__is_the_answer_without_a_search(mt_test *t)
{
    static const struct {
        const char *name;
        const char *members;
    } rows[] = {
        {"a limit", BOTH AT_LEAST("0.13")},
        {"a band", BOTH BETWEEN},
        {"values of catalogues",
         "'variables': [{'parameter': 'k1', 'catalogue': [1.5, 2.9, 4]},"
         " {'parameter': 'k2', 'catalogue': [1.05, 2]}]," AT_LEAST("0.13")},
        {"a catalogue beside a spring, and a band",
         "'variables': [{'parameter': 'k1', 'catalogue': [1.5, 2.9, 4]}," K2 "]," BETWEEN},
        {"tolerances", "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10,"
                       " 'tolerance_percent': 5}]," AT_LEAST("0.13")},
        {"more objectives",
         BOTH AT_LEAST("0.13") ", 'objective':"
                               " [{'minimise': 'change'}, {'minimise': 'k1'}]"},
        {"one design is asked for", BOTH BETWEEN ", 'recommendations': 1"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        mt_test_row(t, "%s", rows[i].name);
        if (study_solve(t, MODEL, rows[i].members, &c)) {
            CHECK(t, is_taken(&c));
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_INT(t, c.result->n_recommendations, 1);
            CHECK(t, c.result->recommendations[0].change == 0.0);
            CHECK(t, study_value(&c, 1, "k1") == 2.9);
            CHECK(t, study_reasons(&c, 1, "no design changes less"));
            CHECK_INT(t, c.result->n_certificates, 1);
            CHECK(t, c.result->certificates[0].proven);
            CHECK_INT(t, c.result->n_relaxations, 0);
        }
        study_free(&c);
    }
}

static void other_original__is_searched(mt_test *t)
{
    static const struct {
        const char *name;
        const char *members;
    } rows[] = {
        {"misses the limit", BOTH AT_LEAST("0.14")},
        {"is outside the bounds",
         "'variables': [{'parameter': 'k1', 'lower': 3, 'upper': 10}]," AT_LEAST("0.13")},
        {"is not in the catalogue",
         "'variables': [{'parameter': 'k1', 'catalogue': [1.5, 3, 4]}]," AT_LEAST("0.13")},
        {"misses it within its tolerances",
         "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10,"
         " 'tolerance_percent': 15}," K2 "]," AT_LEAST("0.13")},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        study_case c;
        mt_test_row(t, "%s", rows[i].name);
        if (study_solve(t, MODEL, rows[i].members, &c)) {
            CHECK(t, !is_taken(&c));
            CHECK(t, c.result->run.spent.search > 0);
            CHECK(t, c.result->n_recommendations > 0 && c.result->recommendations[0].feasible &&
                         c.result->recommendations[0].change > 1e-3);
        }
        study_free(&c);
    }
}

static void another_objective__is_searched(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL, BOTH AT_LEAST("0.13") ", 'objective': {'minimise': 'k1'}", &c)) {
        CHECK(t, !is_taken(&c));
        CHECK(t, study_value(&c, 1, "k1") < 2.0);
    }
    study_free(&c);
}

static void alternatives__are_searched_where_they_are_asked_for(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL, BOTH BETWEEN ", 'recommendations': 3", &c)) {
        CHECK(t, strstr(c.result->status_text, "The original design meets all goals") != NULL);
        CHECK(t, c.result->n_recommendations > 1);
        CHECK(t, c.result->recommendations[0].change == 0.0);
        CHECK(t, c.result->recommendations[1].change > 0.01);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(good_original__is_the_answer_without_a_search),
             MT_TEST(other_original__is_searched), MT_TEST(another_objective__is_searched),
             MT_TEST(alternatives__are_searched_where_they_are_asked_for))
