/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Catalogues where many combinations have one value of the first objective, which the next one
 * decides between, and where the first combinations that are looked at meet nothing: by
 * enumeration, and by branch and bound beside a continuous variable. In closed form: the sum of
 * two whole numbers, or their product, is limited.
 */
#include "study_fixture.h"

enum { TEXT = 2048, VALUES = 12 };

typedef struct row {
    const char *limit; /* of k1 and k2 */
    double at_least;
    const char *objectives;
    double k1; /* NaN: there is no design */
    double k2;
} row;

/* Each with k1 and k2 from 1 to 12 in steps of 1. */
static const row rows[] = {
    {"k1 + k2", 13, "{'minimise': 'k1 + k2'}, {'minimise': 'k1'}", 1, 12},
    {"k1 + k2", 13, "{'minimise': 'k1 + k2'}, {'minimise': 'k2'}", 12, 1},
    {"k1 + k2", 13, "{'minimise': 'k1 + k2'}, {'minimise': '(k1 - 5)^2'}", 5, 8},
    {"k1 + k2", 13, "{'minimise': '(k1 - 5)^2'}, {'minimise': 'k1 + k2'}", 5, 8},
    {"k1 + k2", 13, "{'minimise': '(k2 - 2.6)^2'}, {'minimise': 'k1'}", 10, 3},
    {"k1*k2", 143.5, "{'minimise': 'k1 + k2'}, {'minimise': 'k1'}", 12, 12},
    {"k1*k2", 131.5, "{'minimise': 'k1 + k2'}, {'minimise': 'k1'}", 11, 12},
    {"k1*k2", 131.5, "{'minimise': 'k1 + k2'}, {'minimise': 'k2'}", 12, 11},
    {"k1*k2", 131.5, "{'minimise': '2*k1 + k2'}, {'minimise': 'k2'}", 11, 12},
    {"k1*k2", 144.5, "{'minimise': 'k1 + k2'}, {'minimise': 'k2'}", (double)NAN, (double)NAN},
    {"-k1*k2", -1.5, "{'minimise': '-k1 - k2'}, {'minimise': 'k2'}", 1, 1},
};

/* continuous: the mass is a variable, too, and the last objective. turned: k2 comes first. */
static void put_study(const row *r, bool continuous, bool turned, char *text)
{
    static const char values[] = "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]";
    (void)snprintf(
        text, TEXT,
        "'variables': [{'parameter': '%s', 'catalogue': %s}, {'parameter': '%s', "
        "'catalogue': %s}%s], 'goals': [{'type': 'limit', 'expression': '%s', "
        "'at_least': %.17g}, {'type': 'frequency', 'mode': 1, 'at_least_hz': 1e-3}], "
        "'objective': [%s%s], 'search': {'starts': 2}",
        turned ? "k2" : "k1", values, turned ? "k1" : "k2", values,
        continuous ? ", {'parameter': 'm', 'lower': 0.5, 'upper': 2}" : "", r->limit,
        r->at_least, r->objectives, continuous ? ", {'minimise': 'm'}" : "");
}

static void check(mt_test *t, const row *r, bool continuous, bool turned)
{
    char text[TEXT];
    study_case c;
    put_study(r, continuous, turned, text);
    mt_test_row(t, "%s at least %g, %s%s%s", r->limit, r->at_least, r->objectives,
                continuous ? ", beside m" : "", turned ? ", turned" : "");
    if (study_solve(t, STUDY_TWO_MASSES("'k1': 3, 'k2': 4, 'm': 1", ""), text, &c)) {
        if (isnan(r->k1)) {
            CHECK_INT(t, c.result->status, MT_RESULT_INFEASIBLE);
        } else {
            CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
            CHECK_NEAR(t, study_value(&c, 1, "k1"), r->k1, 0.0);
            CHECK_NEAR(t, study_value(&c, 1, "k2"), r->k2, 0.0);
            CHECK(t, !continuous || fabs(study_value(&c, 1, "m") - 0.5) <= 1e-6);
        }
    }
    study_free(&c);
}

static void ties__are_decided_by_the_next_objective(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(rows); i++) {
        for (int turned = 0; turned < 2; turned++) {
            check(t, &rows[i], false, turned != 0);
            check(t, &rows[i], true, turned != 0);
        }
    }
}

MT_TEST_MAIN(MT_TEST(ties__are_decided_by_the_next_objective))
