/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a constraint is met, and which design is the better one. */
#include <math.h>

#include "base/base.h"
#include "mt_test.h"
#include "nlp/merit.h"

static void merit__met_within_the_tolerance_and_its_rounding(mt_test *t)
{
    const struct {
        const char *name;
        double violation;
        double tolerance;
        bool met;
    } rows[] = {
        {"nothing missed", 0.0, 1e-6, true},
        {"on the tolerance", 1e-6, 1e-6, true},
        {"over it by rounding", 1e-6 * (1.0 + 1e-9), 1e-6, true},
        {"over it", 1e-6 * (1.0 + 1e-5), 1e-6, false},
        {"room left", -1.0, 1e-6, true},
        {"no value", nan(""), 1e-6, false},
        {"missed by far", HUGE_VAL, 1e-6, false},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        CHECK(t, mt_is_met(rows[i].violation, rows[i].tolerance) == rows[i].met);
    }
}

static void merit__numbers_compare_relatively(mt_test *t)
{
    const struct {
        const char *name;
        double a;
        double b;
        double equal;
        int order;
    } rows[] = {
        {"less", 1.0, 2.0, MT_EQUAL_FOUND, -1},
        {"more", 2.0, 1.0, MT_EQUAL_FOUND, 1},
        {"near", 1.0, 1.0 + 3e-6, MT_EQUAL_FOUND, 0},
        {"near, negative", -1.0, -1.0 - 3e-6, MT_EQUAL_FOUND, 0},
        {"not near enough", 1.0, 1.0 + 5e-6, MT_EQUAL_FOUND, -1},
        {"near, judged alike", 1.0, 1.0 + 1e-9, MT_EQUAL_JUDGED, -1},
        {"rounding", 1.0, 1.0 + 4e-13, MT_EQUAL_JUDGED, 0},
        {"exactly", 1.0, 1.0 + 3e-16, 0.0, -1},
        {"both next to nothing", 0.0, 1e-12, MT_EQUAL_FOUND, 0},
        {"infinite", 1.0, HUGE_VAL, MT_EQUAL_FOUND, -1},
        {"both infinite", HUGE_VAL, HUGE_VAL, MT_EQUAL_FOUND, 0},
        {"no number", nan(""), 1.0, MT_EQUAL_FOUND, 0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        CHECK_INT(t, mt_compare(rows[i].a, rows[i].b, rows[i].equal), rows[i].order);
        CHECK_INT(t, mt_compare(rows[i].b, rows[i].a, rows[i].equal), -rows[i].order);
    }
}

static void merit__ranks_designs(mt_test *t)
{
    static const double light[] = {1.0, 5.0};
    static const double light_too[] = {1.0 + 1e-6, 4.0};
    static const double heavy[] = {2.0, 1.0};
    const struct {
        const char *name;
        mt_merit better;
        mt_merit worse;
        double equal;
    } rows[] = {
        {"goals before objectives", {true, 0.0, 2, heavy}, {false, 1e-9, 2, light}, 0.0},
        {"missing less", {false, 1.0, 2, heavy}, {false, 2.0, 2, light}, 0.0},
        {"missing as much, by objective", {false, 1.0, 2, light}, {false, 1.0, 2, heavy}, 0.0},
        {"first objective", {true, 0.0, 2, light}, {true, 0.0, 2, heavy}, MT_EQUAL_FOUND},
        {"then the second", {true, 0.0, 2, light_too}, {true, 0.0, 2, light}, MT_EQUAL_FOUND},
        {"exactly, the first", {true, 0.0, 2, light}, {true, 0.0, 2, light_too}, 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        CHECK(t, mt_merit_before(&rows[i].better, &rows[i].worse, rows[i].equal));
        CHECK(t, !mt_merit_before(&rows[i].worse, &rows[i].better, rows[i].equal));
        CHECK(t, !mt_merit_before(&rows[i].better, &rows[i].better, rows[i].equal));
    }
}

MT_TEST_MAIN(MT_TEST(merit__met_within_the_tolerance_and_its_rounding),
             MT_TEST(merit__numbers_compare_relatively), MT_TEST(merit__ranks_designs))
