/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Test harness over cmocka: checks are soft (a failing one is recorded and the test goes on, so
 * that every row of a table runs), fail on NaN, and say file, line, row and both values.
 *
 *     static void modal__chain_matches_closed_form(mt_test *t)
 *     {
 *         mt_test_row(t, "two masses, n = %d", 2);
 *         CHECK_NEAR(t, got, want, CHAIN_TOL);
 *     }
 *     MT_TEST_MAIN(MT_TEST(modal__chain_matches_closed_form))
 *
 * A test that checked nothing fails. The environment variable MT_TOL_SCALE multiplies every
 * tolerance; at 0 every residual is printed, and all but exact ones fail: a way to see margins.
 */
#ifndef MT_TEST_H
#define MT_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
/* clang-format off: cmocka wants the five above first */
#include <cmocka.h>
/* clang-format on */

enum { MT_TEST_ROW_LENGTH = 160 };

typedef struct mt_test {
    char row[MT_TEST_ROW_LENGTH]; /* name of the current row, "" before the first */
    int checks;                   /* done so far */
    int failures;                 /* of them */
    double tol_scale;             /* multiplies tolerances, from MT_TOL_SCALE, 1 without it */
    bool quiet;                   /* print nothing: for tests of the harness itself */
} mt_test;

typedef struct mt_test_case {
    void (*run)(mt_test *t);
} mt_test_case;

/* A fresh record: no checks, no failures, tolerances scaled by MT_TOL_SCALE. */
mt_test mt_test_begin(void);

/* True when at least one check was made and none failed. */
bool mt_test_passed(const mt_test *t);

/* Name the row that the following checks belong to. */
void mt_test_row(mt_test *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Each records one check and returns whether it held, so that a caller can stop where going on
 * makes no sense. */
void mt_test_note(mt_test *t, bool holds, const char *text, const char *file, int line);
bool mt_test_near(mt_test *t, double got, double want, double tol_abs, const char *text,
                  const char *file, int line);
bool mt_test_int(mt_test *t, long long got, long long want, const char *text, const char *file,
                 int line);
bool mt_test_str(mt_test *t, const char *got, const char *want, const char *text,
                 const char *file, int line);

/* Inline, so that compilers and analysers see that what was checked holds where this returned
 * true. */
static inline bool mt_test_true(mt_test *t, bool holds, const char *text, const char *file,
                                int line)
{
    mt_test_note(t, holds, text, file, line);
    return holds;
}

/* The condition holds. */
#define CHECK(t, cond) mt_test_true((t), (cond), #cond, __FILE__, __LINE__)
/* |got - want| <= rel_tol |want|; with want = 0 only an exact zero passes. */
#define CHECK_NEAR(t, got, want, rel_tol) \
    mt_test_near((t), (got), (want), (rel_tol)*mt_test_abs(want), #got, __FILE__, __LINE__)
/* |got - want| <= abs_tol, in the unit of the two. */
#define CHECK_NEAR_ABS(t, got, want, abs_tol) \
    mt_test_near((t), (got), (want), (abs_tol), #got, __FILE__, __LINE__)
/* Equal integers (enums, counts, indices). */
#define CHECK_INT(t, got, want) \
    mt_test_int((t), (long long)(got), (long long)(want), #got, __FILE__, __LINE__)
/* Equal text; NULL equals only NULL. */
#define CHECK_STR(t, got, want) mt_test_str((t), (got), (want), #got, __FILE__, __LINE__)
/* Like CHECK, and ends the test function where the rest could not run. Only before anything is
 * owned. */
#define REQUIRE(t, cond)       \
    do {                       \
        if (!CHECK(t, cond)) { \
            return;            \
        }                      \
    } while (0)

/* |x|; NaN stays NaN, so that a tolerance made of it fails. */
double mt_test_abs(double x);

/* cmocka's side: runs one mt_test_case and fails the cmocka test when a check failed. */
void mt_test_run_case(void **state);

#define MT_TEST(fn)                                        \
    {                                                      \
#        fn, mt_test_run_case, NULL, NULL, &(mt_test_case) \
        {                                                  \
            fn                                             \
        }                                                  \
    }
#define MT_TEST_MAIN(...)                                                     \
    int main(void)                                                            \
    {                                                                         \
        const struct CMUnitTest tests[] = {__VA_ARGS__};                      \
        return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL) != 0; \
    }

#endif
