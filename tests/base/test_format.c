/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/format.h"
#include "base/number.h"
#include "base/text.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { SIZE = 1024 };

/* The C library is the oracle wherever the door does nothing of its own. */
static void format__is_printf_where_nothing_is_hidden(mt_test *t)
{
    static const char *const reals[] = {"%g",   "%.0e", "%.17g",  "%.6g",  "%+.3g",  "%.1f",
                                        "%.0f", "%12g", "%-12g|", "%#.6g", "%+#.3g", "%012.4f"};
    static const double values[] = {0.0,  1.0,     -1.0,    0.1,      -2.5e-9, 123456789.0,
                                    1e17, DBL_MAX, DBL_MIN, -DBL_MAX, 5e-324,  2.0 / 3.0};
    static const char *const integers[] = {"%d", "%5d", "%-5d|", "%+d", "%05d", "%02d", "%i"};
    static const int whole[] = {0, 1, -1, 42, INT_MAX, INT_MIN};
    char got[SIZE];
    char want[SIZE];
    for (int i = 0; i < MT_COUNT(reals); i++) {
        for (int k = 0; k < MT_COUNT(values); k++) {
            mt_test_row(t, "%s of %g", reals[i], values[k]);
/* the formats are the rows */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
            const int n = snprintf(want, sizeof want, reals[i], values[k]);
            CHECK_INT(t, mt_snprintf(got, sizeof got, reals[i], values[k]), n);
#pragma GCC diagnostic pop
            CHECK_STR(t, got, want);
        }
    }
    for (int i = 0; i < MT_COUNT(integers); i++) {
        for (int k = 0; k < MT_COUNT(whole); k++) {
            mt_test_row(t, "%s of %d", integers[i], whole[k]);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
            const int n = snprintf(want, sizeof want, integers[i], whole[k]);
            CHECK_INT(t, mt_snprintf(got, sizeof got, integers[i], whole[k]), n);
#pragma GCC diagnostic pop
            CHECK_STR(t, got, want);
        }
    }
}

/* A decimal comma, and a decimal point of two bytes. */
static void format__numbers_are_the_same_in_every_locale(mt_test *t)
{
    static const char *const locales[] = {"C", "de_DE.UTF-8", "tr_TR.UTF-8", "ps_AF.UTF-8"};
    for (int i = 0; i < MT_COUNT(locales); i++) {
        char got[SIZE];
        mt_test_row(t, "%s", locales[i]);
        CHECK(t, setlocale(LC_NUMERIC, locales[i]) != NULL);
        CHECK(t, (strcmp(localeconv()->decimal_point, ".") == 0) == (i == 0));
        const int n = mt_snprintf(got, sizeof got, "%.1f %+.3e %#.6g|%8.3g|%-8.2f|%08.3f %g %g",
                                  75.7, -1234.5, 3.0, 0.125, 2.5, -1.25, 1e300, nan(""));
        CHECK_STR(t, got,
                  "75.7 -1.234e+03 3.00000|   0.125|2.50    |-001.250 1e+300 undefined");
        CHECK_INT(t, n, (int)strlen(got));
    }
    (void)setlocale(LC_NUMERIC, "C");
}

/* Numbers of every size and of few digits, among them ties, powers of ten and their neighbours:
 * the C library has the same text. */
static void decimal__is_printf_wherever_it_answers(mt_test *t)
{
    enum { ROUNDS = 20000 };
    mt_random random = mt_random_seed(1);
    int answered = 0;
    for (int i = 0; i < ROUNDS; i++) {
        const double power = pow(10.0, floor(mt_random_in(&random, -6.0, 19.0)));
        const double few = floor(mt_random_in(&random, 0.0, 2e4)) / 8.0;
        const double rows[] = {few,
                               -few * 4096.0,
                               power,
                               nextafter(power, 0.0),
                               nextafter(power, HUGE_VAL),
                               -power * mt_random_in(&random, 0.9999999, 1.0),
                               power * mt_random_in(&random, 1.0, 10.0)};
        const int digits = (int)mt_random_in(&random, 1.0, 18.0);
        for (int k = 0; k < MT_COUNT(rows); k++) {
            char got[MT_DECIMAL_TEXT];
            char want[SIZE];
            const size_t n = mt_decimal(rows[k], digits, got);
            const size_t length = (size_t)snprintf(want, sizeof want, "%.*g", digits, rows[k]);
            mt_test_row(t, "%.17g with %d digits", rows[k], digits);
            const bool plain = strchr(want, 'e') == NULL && fabs(rows[k]) >= 1e-4;
            CHECK(t, n == (plain || rows[k] == 0.0 ? length : 0));
            if (n > 0) {
                CHECK_STR(t, got, want);
                answered++;
            }
        }
    }
    CHECK(t, answered > ROUNDS);
    char got[MT_DECIMAL_TEXT];
    CHECK(t, mt_decimal(1.0, 0, got) == 0 && mt_decimal(1.0, MT_DECIMAL_DIGITS + 1, got) == 0);
    CHECK(t, mt_decimal(nan(""), 6, got) == 0 && mt_decimal(-HUGE_VAL, 6, got) == 0);
    CHECK(t, mt_decimal(-0.0, 6, got) == 2);
    CHECK_STR(t, got, "-0");
}

static void format__knows_every_length_and_width(mt_test *t)
{
    char got[SIZE];
    char want[SIZE];
    const long l = LONG_MIN;
    const long long ll = LLONG_MIN;
    const unsigned long ul = ULONG_MAX;
    const size_t z = SIZE_MAX;
    (void)snprintf(want, sizeof want, "%ld %lld %lu %zu %04x %02X %c %%", l, ll, ul, z, 0x1bU,
                   0xAU, 'c');
    (void)mt_snprintf(got, sizeof got, "%ld %lld %lu %zu %04x %02X %c %%", l, ll, ul, z, 0x1bU,
                      0xAU, 'c');
    CHECK_STR(t, got, want);
    (void)snprintf(want, sizeof want, "%.*s|%*d|%-12s|%5s|%.*g", 3, "abcdef", 6, 42, "left",
                   "r", 4, 1.0 / 3.0);
    (void)mt_snprintf(got, sizeof got, "%.*s|%*d|%-12s|%5s|%.*g", 3, "abcdef", 6, 42, "left",
                      "r", 4, 1.0 / 3.0);
    CHECK_STR(t, got, want);
    const char unended[3] = {'a', 'b', 'c'};
    (void)mt_snprintf(got, sizeof got, "%.*s", 3, unended);
    CHECK_STR(t, got, "abc");
    CHECK_INT(t, mt_snprintf(NULL, 0, "%d and %s", 12, "more"), 11);
}

static void format__says_what_is_not_finite_in_words(mt_test *t)
{
    char got[SIZE];
    (void)mt_snprintf(got, sizeof got, "%g %.3f %+.3e %g", nan(""), HUGE_VAL, -HUGE_VAL, -0.0);
    CHECK_STR(t, got, "undefined infinite -infinite 0");
    (void)mt_snprintf(got, sizeof got, "%012g", HUGE_VAL);
    CHECK_STR(t, got, "    infinite");
}

static void format__makes_arguments_visible_and_nothing_else(mt_test *t)
{
    char got[SIZE];
    (void)mt_snprintf(got, sizeof got, "\"%s\"\n%c\xC2\x9B",
                      "\033]0;x\a\n\xC2\x9B\xE2\x80\xAE\xFF\xC3\xA9", '\r');
    CHECK_STR(t, got,
              "\"\\u001b]0;x\\u0007\\u000a\\u009b\\u202e\\xff\xC3\xA9\"\n\\u000d\xC2\x9B");
}

/* For every size, what is kept is the longest beginning of the whole that is UTF-8. */
static void format__cuts_between_characters(mt_test *t)
{
    /* 1, 2, 3, 4, 1 bytes */
    static const char text[] = "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80z";
    static const int whole[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11};
    for (int n = 0; n < MT_COUNT(whole); n++) {
        char got[SIZE];
        mt_test_row(t, "%d bytes", n);
        (void)mt_snprintf(got, (size_t)n + 1, "%s", text);
        CHECK_INT(t, strlen(got), whole[n]);
        (void)mt_snprintf(got, sizeof got, "%.*s", n, text);
        CHECK_INT(t, strlen(got), whole[n]);
        CHECK(t, strncmp(got, text, strlen(got)) == 0);
    }
}

static void visible__escapes_what_cannot_be_seen(mt_test *t)
{
    static const struct {
        const char *text;
        const char *want;
    } rows[] = {
        {"", ""},
        {"gr\xC3\xB6\xC3\x9F"
         "e \xE2\x82\xAC \xF0\x9F\x98\x80",
         "gr\xC3\xB6\xC3\x9F"
         "e \xE2\x82\xAC \xF0\x9F\x98\x80"},
        {"\x01\t\x7F", "\\u0001\\u0009\\u007f"},
        {"\xC2\x80\xC2\x9F", "\\u0080\\u009f"},
        /* a blank is a blank */
        {"\xC2\xA0", "\xC2\xA0"},
        {"\xE2\x80\xAA\xE2\x81\xA9", "\\u202a\\u2069"},
        {"\xE2\x80\xA8\xE2\x80\x8B", "\\u2028\\u200b"},
        {"\xEF\xBB\xBF", "\\ufeff"},
        {"\xF3\xA0\x81\x81", "\\udb40\\udc41"},
        /* no UTF-8 */
        {"\xC0\xAF\x80\xC3", "\\xc0\\xaf\\x80\\xc3"},
        /* a surrogate */
        {"\xED\xA0\x80", "\\xed\\xa0\\x80"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text out = {.s = NULL};
        mt_test_row(t, "row %d", i);
        mt_text_add_visible(&out, rows[i].text);
        CHECK_STR(t, out.s == NULL ? "" : out.s, rows[i].want);
        mt_text_free(&out);
    }
    CHECK_INT(t, mt_visible_run("a\tb\r\nc\rd", 8, true), 6);
    CHECK_INT(t, mt_visible_run("a\tb", 3, false), 1);
}

/* Random bytes: what comes out is UTF-8 without control characters, and to make it visible
 * again changes nothing. */
static void visible__leaves_no_control_character_of_any_bytes(mt_test *t)
{
    mt_random random = mt_random_seed(7);
    for (int row = 0; row < 2000; row++) {
        char bytes[24];
        mt_text once = {.s = NULL};
        mt_text twice = {.s = NULL};
        const int n = mt_random_int(&random, (int)sizeof bytes);
        for (int i = 0; i < n; i++) {
            bytes[i] = (char)(1 + mt_random_int(&random, 255));
        }
        bytes[n] = '\0';
        mt_test_row(t, "row %d", row);
        mt_text_add(&once, "");
        mt_text_add(&twice, "");
        mt_text_add_visible(&once, bytes);
        mt_text_add_visible(&twice, once.s);
        CHECK_STR(t, twice.s, once.s);
        for (size_t at = 0; at < once.length;) {
            const size_t length = mt_utf8_length(once.s + at, once.length - at);
            CHECK(t, length > 0);
            const unsigned code = length == 0 ? 0U : mt_utf8_code(once.s + at, length);
            CHECK(t, code >= 0x20U && (code < 0x7FU || code > 0x9FU));
            at += length == 0 ? 1 : length;
        }
        mt_text_free(&once);
        mt_text_free(&twice);
    }
}

MT_TEST_MAIN(MT_TEST(format__is_printf_where_nothing_is_hidden),
             MT_TEST(format__numbers_are_the_same_in_every_locale),
             MT_TEST(decimal__is_printf_wherever_it_answers),
             MT_TEST(format__knows_every_length_and_width),
             MT_TEST(format__says_what_is_not_finite_in_words),
             MT_TEST(format__makes_arguments_visible_and_nothing_else),
             MT_TEST(format__cuts_between_characters),
             MT_TEST(visible__escapes_what_cannot_be_seen),
             MT_TEST(visible__leaves_no_control_character_of_any_bytes))
