/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Least mass, least expression, limits. A point mass on two bars (areas A1, A2, from (0, 0) and
 * (4, 0) to (1, 2)), bars with consistent mass:
 *     K = sum E A_i / L_i d_i d_i^T,   M = (m + sum rho A_i L_i / 3) I,
 * so that the frequencies are roots of a quadratic, and the least mass for f_1 >= f is found by
 * bisection in A2 inside a golden section in A1.
 */
#include "study_fixture.h"

static const double E = 7e10;
static const double RHO = 2700.0;
static const double POINT_MASS = 50.0;
static const double LEAST_HZ = 40.0;

#define TRUSS                                                                                \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                         \
    "'parameters': {'A1': {'value': 1e-4, 'unit': 'm^2'}, 'A2': {'value': 1e-4, 'unit': "    \
    "'m^2'},"                                                                                \
    " 'E': 7e10, 'rho': 2700},"                                                              \
    "'bodies': [{'name': 'node', 'mass_kg': 50, 'centre': [1, 2]}],"                         \
    "'springs': ["                                                                           \
    "{'name': 'bar_1', 'type': 'bar', 'bodies': ['ground', 'node'], 'at': [[0, 0], [1, 2]]," \
    " 'youngs_modulus_pa': 'E', 'area_m2': 'A1', 'density_kg_per_m3': 'rho'},"               \
    "{'name': 'bar_2', 'type': 'bar', 'bodies': ['ground', 'node'], 'at': [[4, 0], [1, 2]]," \
    " 'youngs_modulus_pa': 'E', 'area_m2': 'A2', 'density_kg_per_m3': 'rho'}]}"
#define AREAS(lower, upper)                                                      \
    "'variables': [{'parameter': 'A1', 'lower': " lower ", 'upper': " upper "}," \
    " {'parameter': 'A2', 'lower': " lower ", 'upper': " upper "}],"

static double bar_length(int i)
{
    return i == 0 ? sqrt(5.0) : sqrt(13.0);
}

static double mass_of(double a1, double a2)
{
    return RHO * ((a1 * bar_length(0)) + (a2 * bar_length(1)));
}

/* Lowest (sign -1) or highest frequency in Hz. */
static double truss_hz(double a1, double a2, int sign)
{
    const double direction[2][2] = {{1.0 / bar_length(0), 2.0 / bar_length(0)},
                                    {-3.0 / bar_length(1), 2.0 / bar_length(1)}};
    const double area[2] = {a1, a2};
    double k[3] = {0.0, 0.0, 0.0}; /* xx, xy, yy */
    for (int i = 0; i < 2; i++) {
        const double s = E * area[i] / bar_length(i);
        k[0] += s * direction[i][0] * direction[i][0];
        k[1] += s * direction[i][0] * direction[i][1];
        k[2] += s * direction[i][1] * direction[i][1];
    }
    const double half = 0.5 * (k[0] + k[2]);
    const double root = hypot(0.5 * (k[0] - k[2]), k[1]);
    return study_hz((half + (sign * root)) / (POINT_MASS + (mass_of(a1, a2) / 3.0)));
}

/* Least A2 with which the lower frequency reaches hz; infinite where it never does. */
static double second_area(double a1, double hz)
{
    double low = 1e-9;
    double high = 5e-4; /* beyond, its mass begins to tell */
    if (!(truss_hz(a1, high, -1) >= hz)) {
        return HUGE_VAL;
    }
    for (int i = 0; i < 200; i++) {
        const double middle = 0.5 * (low + high);
        *(truss_hz(a1, middle, -1) >= hz ? &high : &low) = middle;
    }
    return high;
}

/* Least mass for f_1 >= hz; the areas in a1, a2. */
static double least_mass(double hz, double *a1, double *a2)
{
    const double ratio = 0.5 * (sqrt(5.0) - 1.0);
    double low = 1e-6;
    double high = 5e-3;
    for (int i = 0; i < 200; i++) {
        const double p = high - (ratio * (high - low));
        const double q = low + (ratio * (high - low));
        if (mass_of(p, second_area(p, hz)) < mass_of(q, second_area(q, hz))) {
            high = q;
        } else {
            low = p;
        }
    }
    *a1 = 0.5 * (low + high);
    *a2 = second_area(*a1, hz);
    return mass_of(*a1, *a2);
}

/* Number after a phrase of the reasons; NaN where no reason holds it. */
static double number_after(const study_case *c, const char *phrase)
{
    const mt_recommendation *const r = &c->result->recommendations[0];
    for (int i = 0; i < r->n_reasons; i++) {
        const char *const at = strstr(r->reasons[i].text, phrase);
        if (at != NULL) {
            return strtod(at + strlen(phrase), NULL);
        }
    }
    return nan("");
}

static const char *const LEAST =
    AREAS("1e-6", "5e-3") "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 40}],"
                          "'objective': {'minimise': 'mass', 'of': ['bar_*']}";

/* Golden section knows A1 to sqrt(eps); the mass, flat there, to far better. The goal's
 * tolerance is 1e-6. */
static const double MASS_TOL = 2e-6;
static const double AREA_TOL = 1e-4;

static void least_mass__agrees_with_an_independent_optimum(mt_test *t)
{
    study_case c;
    double a1 = 0.0;
    double a2 = 0.0;
    const double mass = least_mass(LEAST_HZ, &a1, &a2);
    if (study_solve(t, TRUSS, LEAST, &c)) {
        const mt_recommendation *const r = &c.result->recommendations[0];
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, r->score, mass, MASS_TOL);
        CHECK_STR(t, r->objectives[0].unit, "kg");
        CHECK_NEAR(t, study_value(&c, 1, "A1"), a1, AREA_TOL);
        CHECK_NEAR(t, study_value(&c, 1, "A2"), a2, AREA_TOL);
        CHECK_NEAR(t, study_frequency(&c, 1, "default", 1), LEAST_HZ, 1e-6);
        CHECK(t, r->kkt_residual <= 1e-6);
        /* the price of the goal is the slope of the optimum: printed with three digits */
        double u = 0.0;
        double v = 0.0;
        const double slope =
            (least_mass(LEAST_HZ * 1.001, &u, &v) - least_mass(LEAST_HZ * 0.999, &u, &v)) /
            0.002;
        CHECK_NEAR(t, number_after(&c, "by 1 % would reduce the mass by "), 0.01 * slope, 0.01);
    }
    study_free(&c);
}

static void least_mass__is_stopped_by_a_bound_and_names_it(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, TRUSS,
            AREAS("1e-6",
                  "5e-3") "'goals': [{'type': 'frequency', 'mode': 1, 'at_most_hz': 40}],"
                          "'objective': {'minimise': 'mass', 'of': ['bar_1', 'bar_2']}",
            &c)) {
        /* nothing asks for stiffness: both areas fall to their lower bounds, exactly */
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "A1"), 1e-6, 0.0);
        CHECK_NEAR_ABS(t, study_value(&c, 1, "A2"), 1e-6, 0.0);
        CHECK_STR(t, c.result->recommendations[0].parameters[0].at_bound, "lower");
        CHECK(t, study_reasons(&c, 1, "A1 stands at its lower bound"));
        /* the sentence speaks of a round amount: of 1e-6 m^2, a tenth */
        CHECK_NEAR(t, number_after(&c, "1e-07 m^2 lower would reduce the mass by "),
                   mass_of(1e-7, 0.0), 0.01);
    }
    study_free(&c);
}

/* The same optimum asked for as an expression, between limits that do not matter; then with one
 * that does. */
static void least_expression__obeys_its_limits(mt_test *t)
{
    study_case c;
    double a1 = 0.0;
    double a2 = 0.0;
    const double mass = least_mass(LEAST_HZ, &a1, &a2);
    if (study_solve(
            t, TRUSS,
            AREAS("1e-6",
                  "5e-3") "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 40},"
                          "{'type': 'limit', 'expression': 'A1/A2', 'at_least': 0.01, "
                          "'at_most': 100}],"
                          "'objective': {'minimise': 'rho*(A1*sqrt(5) + A2*sqrt(13))'}",
            &c)) {
        CHECK_NEAR(t, c.result->recommendations[0].score, mass, MASS_TOL);
        CHECK_NEAR(t, study_value(&c, 1, "A1"), a1, AREA_TOL);
        CHECK_STR(t, c.result->recommendations[0].goals[1].text, "A1/A2 from 0.01 to 100");
    }
    study_free(&c);
    char members[1024];
    (void)snprintf(members, sizeof members,
                   "%s'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 40},"
                   "{'type': 'limit', 'expression': 'A1/A2', 'at_least': %.17g}],"
                   "'objective': {'minimise': 'mass'}",
                   AREAS("1e-6", "5e-3"), 2.0 * a1 / a2);
    if (study_solve(t, TRUSS, members, &c)) {
        const double p = study_value(&c, 1, "A1");
        const double q = study_value(&c, 1, "A2");
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, p / q, 2.0 * a1 / a2, 1e-5);
        CHECK_NEAR(t, truss_hz(p, q, -1), LEAST_HZ, 1e-5);
        /* without patterns the point mass counts as well */
        CHECK_NEAR(t, c.result->recommendations[0].score, POINT_MASS + mass_of(p, q), 1e-9);
    }
    study_free(&c);
}

static void equal_limit__is_met(mt_test *t)
{
    study_case c;
    if (study_solve(
            t, TRUSS,
            AREAS("1e-5",
                  "5e-3") "'goals': [{'type': 'limit', 'expression': 'A1 - 3*A2', 'equals': 0,"
                          " 'tolerance_percent': 1e-7},"
                          "{'type': 'frequency', 'mode': 2, 'target_hz': 100}]",
            &c)) {
        const double p = study_value(&c, 1, "A1");
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, p, 3.0 * study_value(&c, 1, "A2"), 1e-4); /* 1e-9 m^2 of some 3e-5 */
        CHECK_NEAR(t, truss_hz(p, study_value(&c, 1, "A2"), 1), 100.0, 1e-5);
    }
    study_free(&c);
}

static void mass_objective__says_where_nothing_counts(mt_test *t)
{
    study_case c;
    CHECK(t,
          !study_try(
              t,
              "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k': 3, 'm': 1},"
              "'configurations': {'plain': {}, 'loaded': {}},"
              "'bodies': [{'name': 'm1', 'mass_kg': 'm', 'centre': [1, 0]},"
              " {'name': 'extra', 'mass_kg': 'm', 'centre': [3, 0], 'in': ['loaded']}],"
              "'joints': [{'name': 'r1', 'type': 'pin-in-slot', 'bodies': ['ground', 'm1'],"
              " 'at': [1, 0], 'axis': [1, 0]}],"
              "'springs': [{'name': 's1', 'type': 'axial', 'bodies': ['ground', 'm1'],"
              " 'at': [[0, 0], [1, 0]], 'stiffness_n_per_m': 'k'}]}",
              "'variables': [{'parameter': 'm', 'lower': 0.5, 'upper': 2}],"
              "'goals': [{'type': 'frequency', 'configuration': 'plain', 'mode': 1,"
              " 'at_least_hz': 0.1}],"
              "'objective': {'minimise': 'mass', 'of': ['extra']}",
              &c));
    CHECK_INT(t, c.rc, MT_E_INPUT);
    CHECK_STR(t, c.err.text,
              "objective \"mass\": nothing that is meant is part of configuration \"plain\", "
              "the first that a goal names");
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(least_mass__agrees_with_an_independent_optimum),
             MT_TEST(least_mass__is_stopped_by_a_bound_and_names_it),
             MT_TEST(least_expression__obeys_its_limits), MT_TEST(equal_limit__is_met),
             MT_TEST(mass_objective__says_where_nothing_counts))
