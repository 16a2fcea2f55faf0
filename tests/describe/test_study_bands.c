/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What results say of bands: two unit masses in a row, whose frequencies have a closed form
 * (study_fixture.h). */
#include <stdlib.h>

#include "study_fixture.h"

#define ROW STUDY_TWO_MASSES("'k1': 3, 'k2': 1, 'm': 1", "")

/* Frequencies at the original design: sqrt((5 -+ sqrt(13)) / 2) / 2 pi = 0.1329, 0.3301 Hz. */
static const double FIRST = 0.697224362268005;
static const double SECOND = 4.302775637731995;

static void bands__are_goals_with_clearance_and_margin(mt_test *t)
{
    study_case c;
    REQUIRE(t, study_solve(t, ROW,
                           "'name': 'inside', 'goals': [{'type': 'avoid', 'bands_hz':"
                           " [[0.12, 0.13], [0.3, 0.34]], 'margin_percent': 5}]",
                           &c));
    const mt_recommendation *const r = &c.result->baseline;
    const double f1 = study_hz(FIRST);
    const double f2 = study_hz(SECOND);
    REQUIRE(t, r->n_goals == 1 && r->n_clearances == 3 && r->n_placements == 2);
    CHECK_STR(t, r->goals[0].text, "default clear of 2 bands up to 0.34 Hz");
    CHECK(t, !r->goals[0].met && !r->feasible);
    /* mode 2 inside the second band: to its upper edge it is 2.9 %, and 5 % more are asked */
    CHECK_NEAR(t, r->goals[0].value, 100.0 * (f2 - 0.34) / f2, 1e-9);
    CHECK_NEAR(t, r->goals[0].at_least, 5.0, 1e-9);
    CHECK_NEAR(t, r->goals[0].violation_percent, 100.0 * (0.34 * 1.05 - f2) / 0.34, 1e-9);
    CHECK_NEAR(t, r->clearance_percent, 100.0 * (f2 - 0.34) / f2, 1e-9);
    CHECK_STR(t, r->clearances[0].side, "above");
    CHECK_NEAR(t, r->clearances[0].percent, 100.0 * (f1 - 0.13) / 0.13, 1e-9);
    CHECK_STR(t, r->clearances[1].side, "below");
    CHECK_NEAR(t, r->clearances[1].percent, 100.0 * (0.3 - f1) / f1, 1e-9);
    CHECK_STR(t, r->clearances[2].side, "inside");
    CHECK_INT(t, r->placements[0].modes_below, 0);
    CHECK_INT(t, r->placements[1].modes_below, 1);
    CHECK_NEAR(t, r->placements[1].margin_lower_hz, 0.285, 1e-12);
    CHECK_NEAR(t, r->placements[1].margin_upper_hz, 0.357, 1e-12);
    study_free(&c);
}

static const char *reason_with(const mt_recommendation *r, const char *part)
{
    for (int i = 0; i < r->n_reasons; i++) {
        if (strstr(r->reasons[i].text, part) != NULL) {
            return r->reasons[i].text;
        }
    }
    return NULL;
}

static double best_change(mt_test *t, const char *lower_edge, double *price)
{
    char members[512];
    study_case c;
    double change = nan("");
    (void)snprintf(members, sizeof members,
                   "'name': 'edge', 'variables': [{'parameter': 'k1', 'lower': 1, 'upper': 3},"
                   " {'parameter': 'k2', 'lower': 0.2, 'upper': 1}],"
                   "'goals': [{'type': 'avoid', 'bands_hz': [['%s', 0.34]]}]",
                   lower_edge);
    if (study_solve(t, ROW, members, &c) && c.result->n_recommendations > 0) {
        const mt_recommendation *const r = &c.result->recommendations[0];
        const char *const s = reason_with(r, "by 1 % would reduce the total change");
        change = r->change;
        CHECK(t, r->feasible && r->goals[0].met);
        CHECK(t, reason_with(r, "mode 2 stands on the lower edge") != NULL);
        CHECK(t, reason_with(r, "In default, 2 modes lie below ") != NULL);
        if (price != NULL && CHECK(t, s != NULL)) {
            static const char by[] = "change by ";
            *price = 0.01 * change * strtod(strstr(s, by) + strlen(by), NULL);
        }
    }
    study_free(&c);
    return change;
}

/* Mode 2 must come down to the edge: what the sentence says of the edge is the difference
 * between two studies, up to the second order of a 1 % step and three digits. */
static void bands__edge_costs_what_its_price_says(mt_test *t)
{
    double price = nan("");
    const double at = best_change(t, "0.3", &price);
    const double eased = best_change(t, "0.3*1.005", NULL);
    const double tight = best_change(t, "0.3/1.005", NULL);
    CHECK_NEAR(t, price, tight - eased, 0.01);
    CHECK(t, at > eased);
}

/* One variable, one mode between two bands: best in the middle, where both ratios are equal. */
static void bands__greatest_clearance_is_the_middle(mt_test *t)
{
    study_case c;
    REQUIRE(t, study_solve(t, ROW,
                           "'name': 'middle', 'variables': [{'parameter': 'm', 'lower': 0.5,"
                           " 'upper': 2}], 'objective': {'maximise': 'clearance'},"
                           "'goals': [{'type': 'avoid', 'bands_hz': [[0.2, 0.25],"
                           " [0.42, 0.5]]}]",
                           &c));
    REQUIRE(t, c.result->n_recommendations > 0);
    const mt_recommendation *const r = &c.result->recommendations[0];
    /* mode 2 between 0.25 and 0.42, mode 1 (0.4025 of it) below 0.2: the geometric mean */
    const double want = sqrt(0.25 * 0.42);
    CHECK_NEAR(t, r->parameters[0].recommended, SECOND / pow(2.0 * STUDY_PI * want, 2.0), 1e-6);
    CHECK_NEAR(t, r->score, 100.0 * (sqrt(0.42 / 0.25) - 1.0), 1e-6);
    CHECK_INT(t, r->n_objectives, 1);
    CHECK_STR(t, r->objectives[0].text, "clearance");
    CHECK_STR(t, r->objectives[0].unit, "%");
    CHECK_NEAR(t, r->objectives[0].recommended, r->score, 0.0);
    CHECK_INT(t, c.result->n_warnings, 0); /* the fresh objective agrees */
    study_free(&c);
}

static double middle_score(mt_test *t, const char *upper_edge, double *price)
{
    char members[512];
    study_case c;
    double score = nan("");
    (void)snprintf(members, sizeof members,
                   "'name': 'middle', 'variables': [{'parameter': 'm', 'lower': 0.5,"
                   " 'upper': 2}], 'objective': {'maximise': 'clearance'},"
                   "'goals': [{'type': 'avoid', 'bands_hz': [[0.2, 0.25], ['%s', 0.7]]}]",
                   upper_edge);
    if (study_solve(t, ROW, members, &c) && CHECK(t, c.result->n_recommendations > 0)) {
        const mt_recommendation *const r = &c.result->recommendations[0];
        const char *const s = reason_with(r, "which holds default mode 2, by 1 % would raise");
        score = r->score;
        if (price != NULL && CHECK(t, s != NULL && strstr(s, "percentage points") != NULL)) {
            *price = strtod(strstr(s, "clearance by ") + strlen("clearance by "), NULL);
        }
    }
    study_free(&c);
    return score;
}

/* The clearance is a ratio, its price is in points of its percentage: the difference between
 * two studies, wherever the optimum lies. */
static void bands__clearance_costs_what_its_price_says(mt_test *t)
{
    static const double edges[] = {0.3, 0.35, 0.42, 0.47};
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        char text[3][32];
        double price = nan("");
        (void)snprintf(text[0], sizeof text[0], "%g", edges[i]);
        (void)snprintf(text[1], sizeof text[1], "%g*1.005", edges[i]);
        (void)snprintf(text[2], sizeof text[2], "%g/1.005", edges[i]);
        mt_test_row(t, "edge at %s Hz", text[0]);
        const double score = middle_score(t, text[0], &price);
        const double gain = middle_score(t, text[1], NULL) - middle_score(t, text[2], NULL);
        CHECK_NEAR(t, price, gain, 0.01); /* three digits, third order of the step */
        CHECK(t, score > 0.0);
    }
}

/* A missed target at an active bound: what more room would buy, to first order. */
static void bounds__say_what_more_room_buys(mt_test *t)
{
    study_case c;
    REQUIRE(t, study_solve(t, ROW,
                           "'name': 'short', 'variables': [{'parameter': 'k1', 'lower': 1,"
                           " 'upper': 4}], 'goals': [{'type': 'frequency', 'mode': 1,"
                           " 'target_hz': 0.145}]",
                           &c));
    REQUIRE(t, c.result->n_recommendations > 0);
    const char *const s = reason_with(&c.result->recommendations[0],
                                      "An upper bound of k1 that is 0.1 higher would bring");
    if (CHECK(t, s != NULL)) {
        const double hz = strtod(strstr(s, "goal by ") + strlen("goal by "), NULL);
        const double rise = study_hz(study_two_lambda(4.05, 1.0, 1.0, -1)) -
                            study_hz(study_two_lambda(3.95, 1.0, 1.0, -1));
        CHECK_NEAR(t, hz, rise, 0.01); /* three digits, third order of the step */
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(bands__are_goals_with_clearance_and_margin),
             MT_TEST(bands__edge_costs_what_its_price_says),
             MT_TEST(bands__greatest_clearance_is_the_middle),
             MT_TEST(bands__clearance_costs_what_its_price_says),
             MT_TEST(bounds__say_what_more_room_buys))
