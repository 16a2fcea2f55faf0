/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Numbers shown in another unit are those that were meant, and no digit more: n / 10^k in a
 * unit of d / 10^m as it is read from a file in that unit (times the factor), or, where the
 * unit has few digits, in SI: n d / 10^(k + m), whole numbers below 2^53, which one division
 * rounds correctly. (A factor as long as 0.0254 is off by half an epsilon itself, and may need
 * a digit more for the number of SI.)
 */
#include <math.h>

#include "result/result.h"
#include "support/mt_test.h"

static const struct {
    const char *name;
    double digits; /* the unit is digits / 10^places of SI */
    int places;
    bool few; /* digits */
} units[] = {{"mm", 1.0, 3, true},         {"cm", 1.0, 2, true},    {"in", 254.0, 4, false},
             {"ft", 3048.0, 4, true},      {"g", 1.0, 3, true},     {"g mm^2", 1.0, 9, true},
             {"lb", 45359237.0, 8, false}, {"a half", 5.0, 1, true}};

static double ten_to(int k)
{
    double power = 1.0;
    for (int i = 0; i < k; i++) {
        power *= 10.0;
    }
    return power; /* exact up to 10^22 */
}

static void shown__is_what_was_meant(mt_test *t)
{
    static const double most = 9007199254740992.0; /* 2^53 */
    for (int u = 0; u < MT_COUNT(units); u++) {
        const double factor = units[u].digits / ten_to(units[u].places);
        for (int k = 0; k <= 6; k++) {
            mt_test_row(t, "%s, %d decimals", units[u].name, k);
            int wrong = 0;
            for (int i = 1; i < 4000 && i * units[u].digits < most; i++) {
                const double n = i;
                const double x = n * units[u].digits / ten_to(units[u].places + k);
                const double meant = n / ten_to(k);
                wrong += mt_result_shown(meant * factor, factor) != meant;
                wrong += mt_result_shown(-meant * factor, factor) != -meant;
                wrong += units[u].few && mt_result_shown(x, factor) != meant;
                wrong += units[u].few && mt_result_shown(-x, factor) != -meant;
            }
            CHECK_INT(t, wrong, 0);
        }
    }
}

/* Halves, down to 2^-20: there the last place is widest beside the number. */
static void shown__powers_of_two_are_what_was_meant(mt_test *t)
{
    static const double few = 1e14; /* numbers that fewer than fifteen digits are enough for */
    for (int u = 0; u < MT_COUNT(units); u++) {
        const double factor = units[u].digits / ten_to(units[u].places);
        double x = 1.0;
        for (int k = 0; k <= 20; k++) {
            const double number = x * ten_to(units[u].places) / units[u].digits;
            const double told = mt_result_shown(x, factor);
            mt_test_row(t, "2^-%d in %s", k, units[u].name);
            if (number * few == floor(number * few) && number < few) {
                CHECK(t, told == number);
            }
            CHECK(t, fabs((told * factor) - x) <= 2.3e-16 * x);
            x *= 0.5;
        }
    }
}

/* SI, and what has no unit, is shown as it is; neither is there a digit for what is none. */
static void shown__without_a_factor_is_the_number_itself(mt_test *t)
{
    static const double numbers[] = {0.1, 1.0 / 3.0, 0.07 / 0.001, -4e-300, 0.0};
    static const double factors[] = {1.0, 0.0, -1.0};
    for (int i = 0; i < MT_COUNT(numbers); i++) {
        for (int k = 0; k < MT_COUNT(factors); k++) {
            CHECK(t, mt_result_shown(numbers[i], factors[k]) == numbers[i]);
        }
        CHECK(t, mt_result_shown(numbers[i], (double)NAN) == numbers[i]);
    }
    CHECK(t, isnan(mt_result_shown((double)NAN, 0.001)));
    CHECK(t, mt_result_shown(0.0, 0.001) == 0.0);
    CHECK(t, isinf(mt_result_shown(HUGE_VAL, 0.001)));
}

MT_TEST_MAIN(MT_TEST(shown__is_what_was_meant),
             MT_TEST(shown__powers_of_two_are_what_was_meant),
             MT_TEST(shown__without_a_factor_is_the_number_itself))
