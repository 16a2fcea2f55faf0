/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preferred numbers and steps: sizes, known values, bounds, limits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mt_test.h"
#include "study/variables.h"

enum { ROOM = MT_MAX_CATALOGUE };

static int series(const char *name)
{
    for (int i = 0; i < MT_SERIES_COUNT; i++) {
        if (strcmp(mt_series_names[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

static void catalogue__every_series_has_its_number_of_values(mt_test *t)
{
    double *const v = calloc(ROOM, sizeof *v);
    CHECK_INT(t, MT_SERIES_COUNT, 7);
    for (int i = 0; i < MT_SERIES_COUNT && v != NULL; i++) {
        mt_test_row(t, "%s", mt_series_names[i]);
        const int per_decade = (int)strtol(mt_series_names[i] + 1, NULL, 10);
        CHECK_INT(t, mt_catalogue_series(i, 1.0, 9.999, ROOM, v), per_decade);
        CHECK(t, v[0] == 1.0);
        for (int k = 1; k < per_decade; k++) {
            CHECK(t, v[k] > v[k - 1]);
            /* a rule-made value is within half of the last digit of the power, a historical one
             * within 5 % */
            const double exact = pow(10.0, (double)k / (double)per_decade);
            CHECK_NEAR_ABS(t, v[k], exact, per_decade > 24 ? 0.0062 : 0.05 * exact);
        }
        CHECK_INT(t, mt_catalogue_series(i, 1.0, 10.0, 0, NULL), per_decade + 1);
    }
    free(v);
}

static void catalogue__coarse_series_are_parts_of_fine_ones(mt_test *t)
{
    static const char *const pairs[][2] = {
        {"E3", "E6"}, {"E6", "E12"}, {"E12", "E24"}, {"E48", "E96"}, {"E96", "E192"},
    };
    double coarse[192];
    double fine[192];
    for (int i = 0; i < MT_COUNT(pairs); i++) {
        const int n = mt_catalogue_series(series(pairs[i][0]), 1.0, 9.999, 192, coarse);
        mt_test_row(t, "%s and %s", pairs[i][0], pairs[i][1]);
        CHECK_INT(t, mt_catalogue_series(series(pairs[i][1]), 1.0, 9.999, 192, fine), 2 * n);
        for (int k = 0; k < n; k++) {
            const int same = 2 * k;
            CHECK(t, coarse[k] == fine[same]);
        }
    }
}

/* IEC 60063, values that a wrong rule would miss. */
static void catalogue__known_values_are_there(mt_test *t)
{
    static const struct {
        const char *name;
        double value;
        bool is;
    } rows[] = {
        {"E3", 4.7, true},    {"E3", 4.6, false},  {"E6", 6.8, true},     {"E12", 2.7, true},
        {"E12", 2.6, false},  {"E24", 2.7, true},  {"E24", 3.3, true},    {"E24", 8.2, true},
        {"E24", 8.3, false},  {"E48", 1.05, true}, {"E48", 9.53, true},   {"E96", 1.02, true},
        {"E96", 9.76, true},  {"E192", 9.2, true}, {"E192", 9.19, false}, {"E192", 1.01, true},
        {"E192", 9.88, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        double v = nan("");
        mt_test_row(t, "%s, %g", rows[i].name, rows[i].value);
        const int n =
            mt_catalogue_series(series(rows[i].name), rows[i].value, rows[i].value, 1, &v);
        CHECK_INT(t, n, rows[i].is ? 1 : 0);
        CHECK(t, !rows[i].is || v == rows[i].value);
    }
}

static void catalogue__values_are_the_nearest_doubles_in_any_decade(mt_test *t)
{
    static const double want[] = {1e-3, 2.2e-3, 4.7e-3, 1e-2, 2.2e-2, 4.7e-2, 0.1, 0.22, 0.47,
                                  1.0,  2.2,    4.7,    10.0, 22.0,   47.0,   1e2, 220.0};
    double v[MT_COUNT(want)];
    CHECK_INT(t, mt_catalogue_series(series("E3"), 1e-3, 220.0, MT_COUNT(want), v),
              MT_COUNT(want));
    for (int i = 0; i < MT_COUNT(want); i++) {
        CHECK(t, v[i] == want[i]);
    }
    CHECK_INT(t, mt_catalogue_series(series("E3"), 4.7e9, 4.7e9, 1, v), 1);
    CHECK(t, v[0] == 4.7e9);
}

static void catalogue__bounds_are_included_despite_rounding(mt_test *t)
{
    double v[4];
    const double three_tenths_more = 3.0 * 1.1; /* 3.3000000000000003 */
    CHECK_INT(t, mt_catalogue_series(series("E24"), three_tenths_more, 3.7, 4, v), 2);
    CHECK(t, v[0] == 3.3 && v[1] == 3.6);
    CHECK_INT(t, mt_catalogue_series(series("E24"), 3.31, 3.59, 4, v), 0);
    CHECK_INT(t, mt_catalogue_series(series("E24"), 0.0, 3.0, 4, v), 0);
    CHECK_INT(t, mt_catalogue_series(series("E24"), -1.0, 3.0, 4, v), 0);
    CHECK_INT(t, mt_catalogue_series(series("E24"), 5.0, 3.0, 4, v), 0);
    CHECK_INT(t, mt_catalogue_series(series("E24"), nan(""), 3.0, 4, v), 0);
    CHECK_INT(t, mt_catalogue_series(series("E24"), 1.0, HUGE_VAL, 4, v), 0);
}

static void catalogue__steps_reach_the_upper_bound(mt_test *t)
{
    double v[32];
    CHECK_INT(t, mt_catalogue_steps(0.5, 1.0, 3.0, 32, v), 5);
    CHECK(t, v[0] == 1.0 && v[1] == 1.5 && v[4] == 3.0);
    CHECK_INT(t, mt_catalogue_steps(0.1, 0.0, 0.3, 32, v), 4); /* 3 * 0.1 > 0.3 */
    CHECK(t, v[3] == 0.3);
    CHECK_INT(t, mt_catalogue_steps(0.4, -1.0, 1.0, 32, v), 6);
    CHECK_INT(t, mt_catalogue_steps(0.4, -1.0, 0.9, 32, v), 5);
    CHECK_INT(t, mt_catalogue_steps(2.0, 1.0, 1.0, 32, v), 1);
    CHECK_INT(t, mt_catalogue_steps(2.0, 1.0, 0.0, 32, v), 0);
    CHECK_INT(t, mt_catalogue_steps(0.0, 1.0, 2.0, 32, v), 0);
    CHECK_INT(t, mt_catalogue_steps(-1.0, 1.0, 2.0, 32, v), 0);
    CHECK_INT(t, mt_catalogue_steps(nan(""), 1.0, 2.0, 32, v), 0);
}

static void catalogue__too_many_values_are_counted_no_further(mt_test *t)
{
    CHECK_INT(t, mt_catalogue_steps(1.0, 1.0, 10000.0, 0, NULL), MT_MAX_CATALOGUE);
    CHECK_INT(t, mt_catalogue_steps(1.0, 0.0, 10000.0, 0, NULL), MT_MAX_CATALOGUE + 1);
    CHECK_INT(t, mt_catalogue_steps(1e-300, 0.0, 1e300, 0, NULL), MT_MAX_CATALOGUE + 1);
    CHECK_INT(t, mt_catalogue_series(series("E192"), 1e-100, 1e100, 0, NULL),
              MT_MAX_CATALOGUE + 1);
    CHECK_INT(t, mt_catalogue_series(series("E192"), 1e-25, 9.99e26, 0, NULL), 52 * 192);
    CHECK_INT(t, mt_catalogue_series(series("E3"), 5e-324, 1e-300, 0, NULL) > 0, 1);
    CHECK_INT(t, mt_catalogue_series(series("E3"), 1e300, 1.7e308, 0, NULL), 8 * 3 + 1);
}

MT_TEST_MAIN(MT_TEST(catalogue__every_series_has_its_number_of_values),
             MT_TEST(catalogue__coarse_series_are_parts_of_fine_ones),
             MT_TEST(catalogue__known_values_are_there),
             MT_TEST(catalogue__values_are_the_nearest_doubles_in_any_decade),
             MT_TEST(catalogue__bounds_are_included_despite_rounding),
             MT_TEST(catalogue__steps_reach_the_upper_bound),
             MT_TEST(catalogue__too_many_values_are_counted_no_further))
