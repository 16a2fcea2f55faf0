/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double mt_test_abs(double x)
{
    return fabs(x);
}

mt_test mt_test_begin(void)
{
    mt_test t = {.tol_scale = 1.0};
    const char *text = getenv("MT_TOL_SCALE");
    if (text != NULL) {
        char *end = NULL;
        t.tol_scale = strtod(text, &end);
        if (end == text || *end != '\0' || !(t.tol_scale >= 0.0)) {
            (void)fprintf(stderr, "MT_TOL_SCALE: \"%s\" is not a number >= 0\n", text);
            exit(2);
        }
    }
    return t;
}

bool mt_test_passed(const mt_test *t)
{
    return t->checks > 0 && t->failures == 0;
}

void mt_test_row(mt_test *t, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (vsnprintf(t->row, sizeof t->row, format, args) < 0) {
        t->row[0] = '\0';
    }
    va_end(args);
}

/* Counts one check; the caller prints the details when this returns true. */
static bool record(mt_test *t, bool holds, bool always, const char *file, int line)
{
    t->checks++;
    t->failures += holds ? 0 : 1;
    if (t->quiet || (holds && !always)) {
        return false;
    }
    (void)fprintf(stderr, "%s:%d: %s", file, line, holds ? "note: " : "failed: ");
    if (t->row[0] != '\0') {
        (void)fprintf(stderr, "[%s] ", t->row);
    }
    return true;
}

void mt_test_note(mt_test *t, bool holds, const char *text, const char *file, int line)
{
    if (record(t, holds, false, file, line)) {
        (void)fprintf(stderr, "%s\n", text);
    }
}

bool mt_test_near(mt_test *t, double got, double want, double tol_abs, const char *text,
                  const char *file, int line)
{
    const double residual = fabs(got - want);
    const double tol = t->tol_scale * tol_abs;
    /* false for NaN in any of the three; equal infinities have a NaN residual and fail as
     * well */
    const bool holds = residual <= tol;
    if (record(t, holds, t->tol_scale <= 0.0, file, line)) {
        (void)fprintf(stderr, "%s is %.17g, want %.17g, off by %.3g, tolerance %.3g\n", text,
                      got, want, residual, tol);
    }
    return holds;
}

bool mt_test_int(mt_test *t, long long got, long long want, const char *text, const char *file,
                 int line)
{
    if (record(t, got == want, false, file, line)) {
        (void)fprintf(stderr, "%s is %lld, want %lld\n", text, got, want);
    }
    return got == want;
}

bool mt_test_str(mt_test *t, const char *got, const char *want, const char *text,
                 const char *file, int line)
{
    const bool both = got != NULL && want != NULL;
    const bool holds = both ? strcmp(got, want) == 0 : got == want;
    if (record(t, holds, false, file, line)) {
        (void)fprintf(stderr, "%s is\n    \"%s\", want\n    \"%s\"\n", text,
                      got ? got : "(null)", want ? want : "(null)");
    }
    return holds;
}

void mt_test_run_case(void **state)
{
    const mt_test_case *const test = (const mt_test_case *)*state;
    mt_test t = mt_test_begin();
    test->run(&t);
    if (!mt_test_passed(&t)) {
        fail_msg("%d of %d checks failed%s", t.failures, t.checks,
                 t.checks == 0 ? ": a test without a check proves nothing" : "");
    }
}
