/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Better starts than a point has of its own: a hint of the caller's, and the designs of the
 * neighbours in a trade study. */
#include "study_fixture.h"

#define MODEL STUDY_TWO_MASSES("'k1': {'value': 0.9, 'unit': 'N/m'}, 'k2': 1, 'm': 1", "")
/* Minima of -cos(20 k1) - k1/10 at k1 = (2 pi j + asin(1/200)) / 20, each deeper than the one
 * before: a single start stays in the valley that it begins in. */
#define VALLEYS                                                         \
    "'search': {'starts': 2, 'max_evaluations': 400},"                  \
    "'goals': [{'type': 'frequency', 'mode': 2, 'at_least_hz': 0.01}]," \
    "'objective': {'minimise': '-cos(20*k1) - k1/10'}"

static double valley(int j)
{
    return ((2.0 * STUDY_PI * j) + asin(1.0 / 200.0)) / 20.0;
}

static double depth(double k1)
{
    return -cos(20.0 * k1) - (k1 / 10.0);
}

static void hint__is_one_more_start(mt_test *t)
{
    study_case c;
    if (!study_load(t, MODEL,
                    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5}]," VALLEYS,
                    &c)) {
        study_free(&c);
        return;
    }
    for (int j = 2; j <= 15;
         j++) { /* the valleys between the bounds, but for the bounds' own */
        const double hint = valley(j) + 0.02;
        const mt_solve_options opt = {.size = sizeof opt, .threads = 1, .hint = &hint};
        mt_test_row(t, "valley %d", j);
        if (!CHECK_INT(t, mt_study_solve(c.study, &opt, &c.result, &c.err), MT_OK)) {
            break;
        }
        /* the other start is the original design, in valley 3 */
        CHECK_NEAR(t, study_value(&c, 1, "k1"), valley(j > 3 ? j : 3), 1e-4);
        mt_result_delete(c.result);
        c.result = NULL;
    }
    study_free(&c);
}

static void trade__a_neighbour_improves_a_point(mt_test *t)
{
    study_case c;
    if (!study_solve(t, MODEL,
                     "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5}],"
                     "'trade': {'vary': [{'variable': 'k1', 'bound': 'lower', 'values': [0.5, "
                     "4.6]}]}," VALLEYS,
                     &c)) {
        study_free(&c);
        return;
    }
    const mt_trade_result *const trade = c.result->trade;
    if (CHECK(t, trade != NULL) && CHECK_INT(t, trade->n_points, 2)) {
        const double narrow = trade->points[1].best.parameters[0].recommended;
        const double wide = trade->points[0].best.parameters[0].recommended;
        /* the deepest valley of all is the only one of the narrow range; the wide one has it,
         * too, and does not begin in it */
        CHECK_NEAR(t, narrow, valley(15), 1e-4);
        CHECK_NEAR(t, wide, valley(15), 1e-4);
        CHECK_NEAR(t, trade->points[0].best.score, depth(valley(15)), 1e-6);
    }
    study_free(&c);
    /* by itself it ends in another */
    if (study_solve(t, MODEL,
                    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5}]," VALLEYS,
                    &c)) {
        CHECK(t, study_value(&c, 1, "k1") < valley(14));
    }
    study_free(&c);
}

/* Starts of a point are not all made where the first ones end at one design: fewer evaluations,
 * and the same designs. A study that says how many has as many. */
static void trade__starts_of_a_point_end_where_all_agree(mt_test *t)
{
#define CHANGE                                                                              \
    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.11}], 'objective': "       \
    "{'minimise': 'change'}, 'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5}, " \
    "{'parameter': 'k2', 'lower': 0.5, 'upper': 5}, {'parameter': 'm', 'lower': 0.5, "      \
    "'upper': 2}]"
#define GRID                                                                             \
    ", 'trade': {'vary': [{'goal': 0, 'member': 'at_least_hz', 'values': [0.11, 0.115, " \
    "0.12]}]}"
    static const char *const starts[] = {"", ", 'search': {'starts': 20}"};
    long evaluations[2] = {0};
    double change[2] = {0.0};
    for (int i = 0; i < 2; i++) {
        char text[2048];
        study_case c;
        (void)snprintf(text, sizeof text, "%s%s%s", CHANGE, GRID, starts[i]);
        if (study_solve(t, MODEL, text, &c) && CHECK(t, c.result->trade != NULL)) {
            evaluations[i] = c.result->run.spent.trade;
            change[i] = c.result->trade->points[2].best.score;
            CHECK(t, c.result->trade->points[2].best.feasible);
        }
        study_free(&c);
    }
    CHECK(t, evaluations[0] > 0 && 3 * evaluations[0] < 2 * evaluations[1]);
    CHECK_NEAR(t, change[0], change[1], 1e-9);
}

/* Points of a large grid begin where the one before them ended, and those that ask for more
 * than one without a design are not proven again: status, sentence and objective are those of
 * the point's own study, with fewer evaluations. */
static void trade__points_in_a_row_are_studies_of_their_own(mt_test *t)
{
#define ROW                                                                                  \
    "'objective': {'minimise': 'change'}, 'recommendations': 1, 'variables': [{'parameter'"  \
    ": 'k1', 'lower': 0.5, 'upper': 2}, {'parameter': 'k2', 'lower': 0.5, 'upper': 2}], "    \
    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': %.17g}, {'type': 'frequency'" \
    ", 'mode': 2, 'at_most_hz': 0.25}]"
    enum { POINTS = 136, STEP = 9, ROOM = 8192 };
    char text[ROOM];
    study_case all;
    long own = 0;
    int n_own = 0;
    int at = snprintf(text, sizeof text,
                      ROW ", 'trade': {'vary': [{'goal': 0, 'member': "
                          "'at_least_hz', 'values': [",
                      0.1);
    for (int k = 0; k < POINTS; k++) {
        at += snprintf(text + at, sizeof text - (size_t)at, "%s%.17g", k > 0 ? ", " : "",
                       0.095 + (0.0002 * k));
    }
    (void)snprintf(text + at, sizeof text - (size_t)at, "]}]}");
    if (!study_solve(t, MODEL, text, &all) ||
        !CHECK_INT(t, all.result->trade->n_points, POINTS)) {
        study_free(&all);
        return;
    }
    int statuses[2] = {0};
    for (int k = STEP - 1; k < POINTS; k += STEP) {
        const mt_trade_point *const point = &all.result->trade->points[k];
        study_case one;
        mt_test_row(t, "point %d", k);
        (void)snprintf(text, sizeof text, ROW, point->values[0]);
        if (study_solve(t, MODEL, text, &one) && CHECK(t, one.result->n_recommendations > 0)) {
            const mt_recommendation *const best = &one.result->recommendations[0];
            CHECK_INT(t, point->status, one.result->status);
            CHECK_STR(t, point->status_text, one.result->status_text);
            CHECK_NEAR(t, point->best.change, best->change, 1e-6);
            CHECK(t, point->best.feasible == best->feasible);
            statuses[best->feasible ? 1 : 0]++;
            own += one.result->run.evaluations;
            n_own++;
        }
        study_free(&one);
    }
    CHECK(t, statuses[0] >= 3 && statuses[1] >= 3);
    CHECK(t, 2 * all.result->run.spent.trade * n_own < own * POINTS);
    study_free(&all);
}

/* The same of a grid in which both numbers take designs away, one along its lines, the other
 * across them. */
static void trade__points_of_a_grid_are_studies_of_their_own(mt_test *t)
{
#define GRID_OF(least, most)                                                                \
    "'objective': {'minimise': 'change'}, 'recommendations': 1, 'variables': [{'parameter'" \
    ": 'k1', 'lower': 0.5, 'upper': 2}, {'parameter': 'k2', 'lower': 0.5, 'upper': 2}], "   \
    "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': " least                      \
    "}, {'type': 'frequency', 'mode': 2, 'at_most_hz': " most "}]"
    enum { SIDE = 18, STEP = 11, ROOM = 8192 };
    char text[ROOM];
    study_case all;
    long own = 0;
    int n_own = 0;
    int at = snprintf(text, sizeof text,
                      GRID_OF("0.1", "0.25") ", 'trade': {'vary': [{'goal': 1, 'member': "
                                             "'at_most_hz', 'values': [");
    for (int k = 0; k < SIDE; k++) {
        at += snprintf(text + at, sizeof text - (size_t)at, "%s%.17g", k > 0 ? ", " : "",
                       0.27 - (0.002 * k));
    }
    at += snprintf(text + at, sizeof text - (size_t)at,
                   "]}, {'goal': 0, 'member': 'at_least_hz', 'values': [");
    for (int k = 0; k < SIDE; k++) {
        at += snprintf(text + at, sizeof text - (size_t)at, "%s%.17g", k > 0 ? ", " : "",
                       0.095 + (0.001 * k));
    }
    (void)snprintf(text + at, sizeof text - (size_t)at, "]}]}");
    if (!study_solve(t, MODEL, text, &all) ||
        !CHECK_INT(t, all.result->trade->n_points, SIDE * SIDE)) {
        study_free(&all);
        return;
    }
    int statuses[2] = {0};
    for (int k = 5; k < SIDE * SIDE; k += STEP) {
        const mt_trade_point *const point = &all.result->trade->points[k];
        study_case one;
        mt_test_row(t, "point %d", k);
        (void)snprintf(text, sizeof text, GRID_OF("%.17g", "%.17g"), point->values[1],
                       point->values[0]);
        if (study_solve(t, MODEL, text, &one) && CHECK(t, one.result->n_recommendations > 0)) {
            const mt_recommendation *const best = &one.result->recommendations[0];
            CHECK_INT(t, point->status, one.result->status);
            CHECK_STR(t, point->status_text, one.result->status_text);
            CHECK_NEAR(t, point->best.change, best->change, 1e-6);
            CHECK_NEAR(t, 1.0 + point->best.violation_percent, 1.0 + best->violation_percent,
                       1e-6);
            CHECK(t, point->best.feasible == best->feasible);
            statuses[best->feasible ? 1 : 0]++;
            own += one.result->run.evaluations;
            n_own++;
        }
        study_free(&one);
    }
    CHECK(t, statuses[0] >= 8 && statuses[1] >= 8);
    CHECK(t, 5 * all.result->run.spent.trade * n_own < 2 * own * SIDE * SIDE);
    study_free(&all);
}

MT_TEST_MAIN(MT_TEST(hint__is_one_more_start), MT_TEST(trade__a_neighbour_improves_a_point),
             MT_TEST(trade__starts_of_a_point_end_where_all_agree),
             MT_TEST(trade__points_in_a_row_are_studies_of_their_own),
             MT_TEST(trade__points_of_a_grid_are_studies_of_their_own))
