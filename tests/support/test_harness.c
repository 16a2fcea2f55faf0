/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The harness must be able to fail: an inner, quiet record is given what has to be refused. */
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mt_refusals.h"
#include "mt_writer.h"

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

/* How a process ends that writes two pieces into eight bytes. */
static int written(const char *first, const char *second)
{
    int status = 0;
    (void)fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        char text[8];
        mt_writer w = {text, sizeof text, 0};
        (void)dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
        mt_write(&w, "%s", first);
        mt_write(&w, "%s", second);
        _exit(strcmp(text + strlen(first), second) == 0 && w.used == strlen(text) ? 0 : 1);
    }
    return waitpid(child, &status, 0) == child ? status : -1;
}

static void harness__a_text_that_does_not_fit_ends_the_program(mt_test *t)
{
    CHECK_INT(t, written("1234", "567"), 0);
    CHECK_INT(t, written("1234567", ""), 0);
    int status = written("1234", "5678");
    CHECK(t, WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    status = written("12345678", "");
    CHECK(t, WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

static void *kept;

/* Two allocations; the second one, where it is refused, is hidden or the first one kept. */
static mt_status allocate_badly(mt_test *t, const void *context)
{
    void *const one = malloc(16);
    void *const two = one != NULL ? malloc(16) : NULL;
    const bool hides = *(const char *)context == 'h';
    const bool keeps = *(const char *)context == 'k';
    const mt_status rc = two == NULL && !(one != NULL && hides) ? MT_E_MEMORY : MT_OK;
    (void)t;
    free(two);
    if (one != NULL && two == NULL && keeps) {
        kept = one;
    } else {
        free(one);
    }
    return rc;
}

static void harness__refused_allocations_are_counted_and_told(mt_test *t)
{
    mt_test inner = quiet_record();
    if (mt_alloc_works()) {
        CHECK_INT(t, mt_refuse_each(&inner, "right", allocate_badly, "", MT_OK), 2);
        CHECK_INT(t, inner.failures, 0);
        CHECK_INT(t, mt_refuse_each(&inner, "hidden", allocate_badly, "h", MT_OK), 1);
        (void)mt_refuse_each(&inner, "kept", allocate_badly, "k", MT_OK);
        CHECK_INT(t, inner.failures, 1);
        free(kept);
    }
    inner.failures = 0;
    (void)mt_refuse_each(&inner, "unexpected", allocate_badly, "", MT_E_INPUT);
    CHECK(t, inner.failures > 0);
}

MT_TEST_MAIN(MT_TEST(harness__near_fails_on_nan_and_infinity),
             MT_TEST(harness__near_is_relative_to_the_wanted_value),
             MT_TEST(harness__a_failure_does_not_stop_the_rows),
             MT_TEST(harness__no_check_is_no_pass),
             MT_TEST(harness__text_and_integers_can_differ),
             MT_TEST(harness__require_ends_the_function),
             MT_TEST(harness__tolerance_scale_zero_wants_exactness),
             MT_TEST(harness__a_text_that_does_not_fit_ends_the_program),
             MT_TEST(harness__refused_allocations_are_counted_and_told))
