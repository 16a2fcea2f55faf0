/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The writer: the bytes it must give, and doubles that come back bit for bit. */
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/json.h"
#include "io/write_json.h"
#include "mt_test.h"

static uint64_t bits_of(double x)
{
    uint64_t bits = 0;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double double_of(uint64_t bits)
{
    double x = 0.0;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* xorshift64*: any bit pattern may come. */
static uint64_t next_random(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717ULL;
}

static void write_json__objects_and_lists_are_indented(mt_test *t)
{
    mt_text text = {0};
    mt_json_writer w = mt_json_writer_default(&text);
    mt_json_open(&w, NULL, '{');
    mt_json_put_integer(&w, "n", -3);
    mt_json_open(&w, "empty", '[');
    mt_json_close(&w);
    mt_json_open(&w, "list", '[');
    mt_json_put_number(&w, NULL, 0.1);
    mt_json_put_null(&w, NULL);
    mt_json_open(&w, NULL, '{');
    mt_json_put_bool(&w, "yes", true);
    mt_json_close(&w);
    mt_json_close(&w);
    mt_json_open_flat(&w, "row", '[');
    mt_json_put_number(&w, NULL, 1.0);
    mt_json_open(&w, NULL, '[');
    mt_json_put_number(&w, NULL, -2.5);
    mt_json_close(&w);
    mt_json_close(&w);
    mt_json_put_string(&w, "none", NULL);
    mt_json_close(&w);
    CHECK(t, mt_json_done(&w));
    CHECK_STR(t, text.s,
              "{\n  \"n\": -3,\n  \"empty\": [],\n  \"list\": [\n    0.10000000000000001,\n    "
              "null,\n    {\n      \"yes\": true\n    }\n  ],\n  \"row\": [1, [-2.5]],\n  "
              "\"none\": null\n}\n");
    mt_text_free(&text);
}

/* The same calls, with and without white space. */
static void write_json__is_tight_where_programs_read_it(mt_test *t)
{
    static const char *const want[] = {
        ("{\n  \"a b\": [\n    1,\n    \"c, d\"\n  ],\n"
         "  \"e\": [1, {\"f\": true}],\n  \"g\": {}\n}\n"),
        "{\"a b\":[1,\"c, d\"],\"e\":[1,{\"f\":true}],\"g\":{}}"};
    for (int tight = 0; tight < 2; tight++) {
        mt_text text = {.s = NULL};
        mt_json_writer w = mt_json_writer_default(&text);
        w.tight = tight == 1;
        mt_json_open(&w, NULL, '{');
        mt_json_open(&w, "a b", '[');
        mt_json_put_integer(&w, NULL, 1);
        mt_json_put_string(&w, NULL, "c, d");
        mt_json_close(&w);
        mt_json_open_flat(&w, "e", '[');
        mt_json_put_number(&w, NULL, 1.0);
        mt_json_open(&w, NULL, '{');
        mt_json_put_bool(&w, "f", true);
        mt_json_close(&w);
        mt_json_close(&w);
        mt_json_open(&w, "g", '{');
        mt_json_close(&w);
        mt_json_close(&w);
        CHECK(t, mt_json_done(&w));
        CHECK_STR(t, text.s, want[tight]);
        mt_text_free(&text);
    }
}

static void write_json__misuse_is_remembered(mt_test *t)
{
    static const struct {
        const char *name;
        const char *calls; /* { [ open, } close, n value with a name, v without */
    } rows[] = {
        {"nothing written", ""},         {"left open", "{"},
        {"closed twice", "{}}"},         {"no name in an object", "{v}"},
        {"a name in a list", "[n]"},     {"a name at the top", "n"},
        {"two values at the top", "vv"}, {"two objects at the top", "{}{}"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        mt_text text = {0};
        mt_json_writer w = mt_json_writer_default(&text);
        for (const char *c = rows[i].calls; *c != '\0'; c++) {
            if (*c == '}') {
                mt_json_close(&w);
            } else if (*c == '{' || *c == '[') {
                mt_json_open(&w, NULL, *c);
            } else {
                mt_json_put_integer(&w, *c == 'n' ? "n" : NULL, 1);
            }
        }
        CHECK(t, !mt_json_done(&w));
        mt_text_free(&text);
    }
}

static void write_json__nesting_is_limited(mt_test *t)
{
    mt_text text = {0};
    mt_json_writer w = mt_json_writer_default(&text);
    for (int i = 0; i < MT_JSON_WRITER_DEPTH; i++) {
        mt_json_open(&w, NULL, '[');
    }
    CHECK(t, !w.misused);
    mt_json_open(&w, NULL, '[');
    CHECK(t, w.misused);
    mt_text_free(&text);
}

static void write_json__strings_are_escaped(mt_test *t)
{
    static const struct {
        const char *name;
        const char *text;
        const char *want;
    } rows[] = {
        {"plain", "K_T1 = 3", "\"K_T1 = 3\"\n"},
        {"quote and backslash", "\"a\\b\"", "\"\\\"a\\\\b\\\"\"\n"},
        {"short escapes", "\b\f\n\r\t", "\"\\b\\f\\n\\r\\t\"\n"},
        {"control characters", "\x01\x1f\x7f", "\"\\u0001\\u001f\\u007f\"\n"},
        {"slash stays", "a/b", "\"a/b\"\n"},
        {"two, three and four bytes", "\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80",
         "\"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\"\n"},
        {"C1, turns, tags", "\xC2\x9B\xE2\x80\xAE\xF3\xA0\x81\x81",
         "\"\\u009b\\u202e\\udb40\\udc41\"\n"},
        {"lone continuation", "a\x80z", "\"a\xEF\xBF\xBDz\"\n"},
        {"overlong", "\xC0\xAF", "\"\xEF\xBF\xBD\xEF\xBF\xBD\"\n"},
        {"surrogate", "\xED\xA0\x80", "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\"\n"},
        {"cut off at the end", "\xE2\x82", "\"\xEF\xBF\xBD\xEF\xBF\xBD\"\n"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        mt_text text = {0};
        mt_json_writer w = mt_json_writer_default(&text);
        mt_json_put_string(&w, NULL, rows[i].text);
        CHECK(t, mt_json_done(&w));
        CHECK_STR(t, text.s, rows[i].want);
        mt_text_free(&text);
    }
}

/* Write a number, read the text with our own reader, compare the bits; -0 is written as 0. */
static void check_round_trip(mt_test *t, double x)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    mt_json *doc = NULL;
    const char *const text = mt_json_format_number(x, buffer);
    const mt_status rc = mt_json_parse(text, strlen(text), &doc, NULL);
    if (CHECK_INT(t, rc, MT_OK) &&
        CHECK_INT(t, mt_json_type_of(doc, MT_JSON_ROOT), MT_JSON_NUMBER)) {
        CHECK(t, bits_of(mt_json_number(doc, MT_JSON_ROOT)) == bits_of(x == 0.0 ? 0.0 : x));
    }
    mt_json_delete(doc);
}

static void write_json__doubles_come_back_bit_for_bit(mt_test *t)
{
    static const double rows[] = {0.0,
                                  -0.0,
                                  0.1,
                                  1.0 / 3.0,
                                  1e22,
                                  1e23,
                                  9007199254740993.0,
                                  DBL_MIN,
                                  DBL_MAX,
                                  DBL_EPSILON,
                                  5e-324,
                                  2.8284271247461903,
                                  17.678};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%.17g", rows[i]);
        check_round_trip(t, rows[i]);
        check_round_trip(t, -rows[i]);
    }
    enum { SAMPLES = 20000 };
    uint64_t state = 20240229;
    for (int i = 0; i < SAMPLES; i++) {
        const double x = double_of(next_random(&state));
        if (isfinite(x)) {
            mt_test_row(t, "%.17g", x);
            check_round_trip(t, x);
        }
    }
}

static void write_json__what_is_not_finite_is_null(mt_test *t)
{
    char buffer[MT_JSON_NUMBER_SIZE];
    CHECK_STR(t, mt_json_format_number(nan(""), buffer), "null");
    CHECK_STR(t, mt_json_format_number(HUGE_VAL, buffer), "null");
    CHECK_STR(t, mt_json_format_number(-HUGE_VAL, buffer), "null");
}

/* No locale's decimal point gets into the file. */
static void write_json__the_locale_does_not_matter(mt_test *t)
{
    static const char *const locales[] = {"C", "de_DE.UTF-8", "tr_TR.UTF-8", "ps_AF.UTF-8"};
    for (int i = 0; i < MT_COUNT(locales); i++) {
        char buffer[MT_JSON_NUMBER_SIZE];
        mt_test_row(t, "%s", locales[i]);
        CHECK(t, setlocale(LC_NUMERIC, locales[i]) != NULL);
        CHECK(t, (strcmp(localeconv()->decimal_point, ".") == 0) == (i == 0));
        CHECK_STR(t, mt_json_format_number(1.5e-300, buffer), "1.5000000000000001e-300");
    }
    (void)setlocale(LC_NUMERIC, "C");
}

MT_TEST_MAIN(MT_TEST(write_json__objects_and_lists_are_indented),
             MT_TEST(write_json__is_tight_where_programs_read_it),
             MT_TEST(write_json__misuse_is_remembered), MT_TEST(write_json__nesting_is_limited),
             MT_TEST(write_json__strings_are_escaped),
             MT_TEST(write_json__doubles_come_back_bit_for_bit),
             MT_TEST(write_json__what_is_not_finite_is_null),
             MT_TEST(write_json__the_locale_does_not_matter))
