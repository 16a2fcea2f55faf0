/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The harness must be able to fail: an inner, quiet record is given what has to be refused. */
#include <math.h>
#include <stdlib.h>

#include "mt_test.h"

static mt_test quiet_record(void)
{
    mt_test inner = mt_test_begin();
    inner.tol_scale = 1.0; /* independent of the environment */
    inner.quiet = true;
    return inner;
}

static void harness__near_fails_on_nan_and_infinity(mt_test *t)
{
    const double bad = nan("");
    const double inf = HUGE_VAL;
    const struct {
        const char *name;
        double got;
        double want;
        double tol;
    } rows[] = {
        {"got is NaN", bad, 1.0, 1.0},          {"want is NaN", 1.0, bad, 1.0},
        {"both are NaN", bad, bad, 1.0},        {"tolerance is NaN", 1.0, 1.0, bad},
        {"got is infinite", inf, 1.0, 1.0},     {"both are infinite", inf, inf, 1.0},
        {"negative tolerance", 1.0, 1.0, -1.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        mt_test_row(t, "%s", rows[i].name);
        mt_test inner = quiet_record();
        CHECK(t, !CHECK_NEAR_ABS(&inner, rows[i].got, rows[i].want, rows[i].tol));
        CHECK_INT(t, inner.failures, 1);
        CHECK(t, !CHECK_NEAR(&inner, rows[i].got, rows[i].want, rows[i].tol));
        CHECK_INT(t, inner.failures, 2);
    }
}

static void harness__near_is_relative_to_the_wanted_value(mt_test *t)
{
    mt_test inner = quiet_record();
    CHECK(t, CHECK_NEAR(&inner, 1000.5, 1000.0, 1e-3));
    CHECK(t, CHECK_NEAR(&inner, -1000.5, -1000.0, 1e-3));
    CHECK(t, !CHECK_NEAR(&inner, 1002.0, 1000.0, 1e-3));
    CHECK(t, !CHECK_NEAR(&inner, 1e-300, 0.0, 1e-3));
    CHECK(t, CHECK_NEAR(&inner, 0.0, 0.0, 1e-3));
    CHECK(t, CHECK_NEAR_ABS(&inner, 1e-4, 0.0, 1e-3));
    CHECK_INT(t, inner.checks, 6);
    CHECK_INT(t, inner.failures, 2);
}

static void harness__a_failure_does_not_stop_the_rows(mt_test *t)
{
    mt_test inner = quiet_record();
    for (int i = 0; i < 5; i++) {
        CHECK(&inner, i != 2);
    }
    CHECK_INT(t, inner.checks, 5);
    CHECK_INT(t, inner.failures, 1);
    CHECK(t, !mt_test_passed(&inner));
}

static void harness__no_check_is_no_pass(mt_test *t)
{
    mt_test inner = quiet_record();
    CHECK(t, !mt_test_passed(&inner));
    CHECK(&inner, true);
    CHECK(t, mt_test_passed(&inner));
}

static void harness__text_and_integers_can_differ(mt_test *t)
{
    mt_test inner = quiet_record();
    CHECK(t, CHECK_STR(&inner, "a", "a"));
    CHECK(t, CHECK_STR(&inner, NULL, NULL));
    CHECK(t, !CHECK_STR(&inner, "a", "b"));
    CHECK(t, !CHECK_STR(&inner, NULL, ""));
    CHECK(t, !CHECK_STR(&inner, "", NULL));
    CHECK(t, CHECK_INT(&inner, 3, 3));
    CHECK(t, !CHECK_INT(&inner, 3, 4));
    CHECK_INT(t, inner.failures, 4);
}

static void stops_at_require(mt_test *t)
{
    REQUIRE(t, false);
    CHECK(t, true);
}

static void harness__require_ends_the_function(mt_test *t)
{
    mt_test inner = quiet_record();
    stops_at_require(&inner);
    CHECK_INT(t, inner.checks, 1);
    CHECK_INT(t, inner.failures, 1);
}

static void harness__tolerance_scale_zero_wants_exactness(mt_test *t)
{
    mt_test inner = quiet_record();
    inner.tol_scale = 0.0;
    CHECK(t, CHECK_NEAR(&inner, 1.0, 1.0, 1e-9));
    CHECK(t, !CHECK_NEAR(&inner, 1.0 + 1e-12, 1.0, 1e-9));
}

MT_TEST_MAIN(MT_TEST(harness__near_fails_on_nan_and_infinity),
             MT_TEST(harness__near_is_relative_to_the_wanted_value),
             MT_TEST(harness__a_failure_does_not_stop_the_rows),
             MT_TEST(harness__no_check_is_no_pass),
             MT_TEST(harness__text_and_integers_can_differ),
             MT_TEST(harness__require_ends_the_function),
             MT_TEST(harness__tolerance_scale_zero_wants_exactness))
