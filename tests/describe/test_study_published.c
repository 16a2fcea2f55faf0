/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The published list: each kind of entry, each judgement, at the original and at the
 * recommended design. */
#include "study_fixture.h"

/* Original (2.5, 1.2), solved (2, 1). */
#define SOLVED                                                              \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 10},"         \
    " {'parameter': 'k2', 'lower': 0.5, 'upper': 10}],"                     \
    "'references': {'test': {'modes': [{'frequency_hz': 1,"                 \
    " 'shape': {'p1.x': 1, 'p2.x': 2}}]}},"                                 \
    "'goals': [{'type': 'frequency', 'mode': 'low',"                        \
    " 'target_hz': 'sqrt(2 - sqrt(2))/(2*pi)', 'tolerance_percent': 1e-7}," \
    "{'type': 'limit', 'expression': 'k2', 'equals': 1, 'tolerance_percent': 1e-7}],"
#define MODEL                                        \
    STUDY_TWO_MASSES("'k1': 2.5, 'k2': 1.2, 'm': 1", \
                     ", 'modes': {'low': {'configuration': 'default', 'index': 1}}")

typedef struct row {
    const char *entry;
    double computed; /* NaN: not compared */
    bool holds;
} row;

static double low(double k1, double k2)
{
    return study_hz(study_two_lambda(k1, k2, 1.0, -1));
}

/* MAC of the first mode of (k1, k2) with (1, 2): the shape is (k2, k1 + k2 - lambda). */
static double mac_low(double k1, double k2)
{
    const double b = k1 + k2 - study_two_lambda(k1, k2, 1.0, -1);
    const double dot = k2 + (2.0 * b);
    return dot * dot / (5.0 * ((k2 * k2) + (b * b)));
}

static void check_rows(mt_test *t, int n, const row *rows)
{
    study_case c;
    mt_text members = {0};
    mt_text_add(&members, SOLVED "'published': [");
    for (int i = 0; i < n; i++) {
        mt_text_addf(&members, "%s{%s}", i == 0 ? "" : ",", rows[i].entry);
    }
    mt_text_add(&members, "]");
    if (study_solve(t, MODEL, members.s, &c) && CHECK_INT(t, c.result->n_published, n)) {
        for (int i = 0; i < n; i++) {
            const mt_result_published *const p = &c.result->published[i];
            mt_test_row(t, "%s", rows[i].entry);
            CHECK(t, p->holds == rows[i].holds);
            if (rows[i].computed == rows[i].computed) {
                CHECK_NEAR(t, p->computed, rows[i].computed, 1e-8);
                CHECK_NEAR_ABS(t, p->difference, p->computed - p->published, 0.0);
            }
        }
    }
    study_free(&c);
    mt_text_free(&members);
}

static void parameters_and_quantities__are_judged(mt_test *t)
{
    const double none = nan("");
    const row rows[] = {
        {"'parameter': 'k1', 'value': 2, 'tolerance_percent': 0.01", 2.0, true},
        {"'parameter': 'k1', 'value': 2.5, 'tolerance': 1e-15, 'design': 'original'", 2.5,
         true},
        {"'parameter': 'm', 'value': 1, 'tolerance': 1e-15", 1.0, true},
        {"'quantity': 'k1/k2', 'value': 2.1, 'tolerance_percent': 1", 2.0, false},
        {"'quantity': 'k1/k2', 'value': 2.1, 'tolerance_percent': 5", 2.0, true},
        {"'quantity': 'k1 - 2*k2', 'value': 0, 'tolerance': 1e-6", none, true},
        {"'quantity': 'k1 + k2', 'value': 3.7, 'tolerance': 1e-12, 'design': 'original'", 3.7,
         true},
        /* each of the limits that are given has to hold */
        {"'parameter': 'k1', 'at_least': 1.9, 'at_most': 2.1", none, true},
        {"'parameter': 'k1', 'at_least': 1.8, 'at_most': 1.9", none, false},
        {"'parameter': 'k1', 'at_least': 2.1, 'at_most': 2.2", none, false},
        {"'parameter': 'k1', 'at_least': 1.9", none, true},
        {"'parameter': 'k1', 'at_least': 2.1", none, false},
        {"'parameter': 'k1', 'at_most': 2.1", none, true},
        {"'parameter': 'k1', 'at_most': 1.9", none, false},
        {"'status': 'solved'", none, true},
        {"'status': 'compromise'", none, false},
        {"'parameter': 'k1', 'value': 99, 'tolerance': 1, 'role': 'not_comparable'", 2.0, true},
    };
    check_rows(t, (int)(sizeof rows / sizeof rows[0]), rows);
}

static void frequencies_and_macs__are_judged(mt_test *t)
{
    const row rows[] = {
        {"'frequency': {'mode': 1}, 'value': 0.12, 'tolerance': 0.01", low(2.0, 1.0), true},
        {"'frequency': {'mode': 1}, 'value': 0.12, 'tolerance': 1e-4", low(2.0, 1.0), false},
        {"'frequency': {'mode': 'low'}, 'value': 0.12, 'tolerance': 0.01", low(2.0, 1.0), true},
        {"'frequency': {'mode': 'low'}, 'value': 0.13, 'tolerance': 0.01, 'design': 'original'",
         low(2.5, 1.2), true},
        {"'frequency': {'mode': 1}, 'at_least': 0.12", low(2.0, 1.0), true},
        {"'frequency': {'mode': 1}, 'at_least': 0.122", low(2.0, 1.0), false},
        {"'mac': {'mode': 1, 'reference': 'test'}, 'at_least': 0.9", mac_low(2.0, 1.0), true},
        {"'mac': {'mode': 'low', 'reference': 'test', 'reference_mode': 1},"
         " 'at_least': 0.9999999",
         mac_low(2.0, 1.0), false},
        {"'mac': {'mode': 1, 'reference': 'test'}, 'at_least': 0.9, 'design': 'original'",
         mac_low(2.5, 1.2), true},
    };
    check_rows(t, (int)(sizeof rows / sizeof rows[0]), rows);
}

/* A configuration that falls over has no frequency, and no entry about it holds, whatever its
 * role. */
static void value_that_cannot_be_computed__never_holds(mt_test *t)
{
    study_case c;
    if (study_solve(t,
                    "{'format': 'modetune-model/1', 'dimension': 2,"
                    "'gravity_m_per_s2': [0, 9.81], 'parameters': {'m': 1},"
                    "'bodies': [{'name': 'rod', 'mass_kg': 'm', 'inertia_kg_m2': 0.1,"
                    " 'centre': [0, -1]}],"
                    "'joints': [{'name': 'pivot', 'type': 'revolute',"
                    " 'bodies': ['ground', 'rod'], 'at': [0, 0]}]}",
                    "'published': [{'frequency': {'mode': 1}, 'value': 1, 'tolerance': 100},"
                    "{'frequency': {'mode': 1}, 'at_least': 0},"
                    "{'frequency': {'mode': 1}, 'value': 1, 'tolerance': 1,"
                    " 'role': 'not_comparable'}]",
                    &c)) {
        CHECK_INT(t, c.result->n_published, 3);
        for (int i = 0; i < c.result->n_published; i++) {
            CHECK(t, !c.result->published[i].holds);
            CHECK(t, !(c.result->published[i].computed == c.result->published[i].computed));
        }
    }
    study_free(&c);
}

/* The expected status may be that no design meets the goals; the nearest one is judged. */
static void expected_compromise__holds(mt_test *t)
{
    study_case c;
    if (study_solve(t, MODEL,
                    "'variables': [{'parameter': 'k1', 'lower': 2, 'upper': 3},"
                    " {'parameter': 'k2', 'lower': 1, 'upper': 2}],"
                    "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.15},"
                    " {'type': 'limit', 'expression': 'k1 + k2', 'equals': 3}],"
                    "'published': [{'status': 'compromise'}, {'status': 'solved'}]",
                    &c)) {
        CHECK(t, c.result->published[0].holds);
        CHECK(t, !c.result->published[1].holds);
        CHECK_STR(t, c.result->published[1].computed_text, "compromise");
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(parameters_and_quantities__are_judged),
             MT_TEST(frequencies_and_macs__are_judged),
             MT_TEST(value_that_cannot_be_computed__never_holds),
             MT_TEST(expected_compromise__holds))
