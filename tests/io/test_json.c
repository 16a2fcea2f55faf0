/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/json.h"
#include "mt_refusals.h"

/* What the parser says about a text: all diagnostics, "" where there are none. Owned by the
 * caller. */
static mt_diagnostics said_about(const char *text, size_t length, mt_status *rc)
{
    mt_json *doc = NULL;
    mt_diagnostics said = {.count = 0};
    mt_text_add(&said.lines, "");
    *rc = mt_json_parse(text, length, &doc, NULL);
    if (doc != NULL) {
        mt_json_report(doc, "f", &said);
    }
    mt_json_delete(doc);
    return said;
}

typedef struct syntax_row {
    const char *text;
    const char *said; /* NULL: something */
} syntax_row;

static const syntax_row syntax_rows[] = {
    {"", "f:1:1: error: the text is empty\n"},
    {" \n\t", "f:1:1: error: the text is empty\n"},
    {"{\"a\": 1,}", "f:1:8: error: no comma is allowed behind the last member of an object\n"},
    {"[1, 2,]", "f:1:6: error: no comma is allowed behind the last item of a list\n"},
    {"[1 2]", "f:1:4: error: unexpected \"2\" where \",\" or \"]\" is expected\n"},
    {"[1, 2", "f:1:6: error: the text ends where \",\" or \"]\" is expected\n"},
    {"[1}", "f:1:3: error: unexpected \"}\" where \",\" or \"]\" is expected\n"},
    {"{\"a\" 1}", "f:1:6: error: unexpected \"1\" where \":\" is expected\n"},
    {"{a: 1}", "f:1:2: error: a member name must stand in double quotes\n"},
    {"{\"a\": }", "f:1:7: error: unexpected \"}\" where a value is expected\n"},
    {"1 2", "f:1:3: error: unexpected \"2\" where the end of the text is expected\n"},
    {"[01]", "f:1:2: error: malformed number 01: it must not start with 0\n"},
    {"[.5]", "f:1:2: error: malformed number .5: digits are missing before the point\n"},
    {"[5.]", "f:1:2: error: malformed number 5.: digits are missing after the point\n"},
    {"[1e]", "f:1:2: error: malformed number 1e: digits are missing in the exponent\n"},
    {"[+1]", "f:1:2: error: malformed number +1: it must not start with +\n"},
    {"[-]", "f:1:2: error: malformed number -: digits are missing before the point\n"},
    {"[0x10]", "f:1:2: error: malformed number 0x10: write an expression as a string in "
               "double quotes\n"},
    {"[NaN, -Infinity]",
     "f:1:2: error: NaN is not a number in JSON: numbers must be finite\n"
     "f:1:7: error: -Infinity is not a number in JSON: numbers must be finite\n"},
    {"{\"a\": [True, 'x']}",
     "f:1:8: error: /a: unexpected True: strings are written in double quotes\n"
     "f:1:14: error: /a: strings are written in double quotes\n"},
    {"[\"a\tb\"]", "f:1:4: error: control character U+0009 in a string: write \\u0009\n"},
    {"[\"a\nb\"]",
     "f:1:2: error: the string that begins here has no closing quote on its line\n"},
    {"[\"\\x\"]", "f:1:3: error: unknown escape in a string: write \"\\\\\" for a backslash\n"},
    {"[\"\\u12g4\"]", "f:1:3: error: \\u must be followed by four hexadecimal digits\n"},
    {"[\"\\ud800\"]",
     "f:1:3: error: \\ud800 is half of a surrogate pair without its other half\n"},
    {"[\"\\udc00\\ud800\"]",
     "f:1:3: error: \\udc00 is half of a surrogate pair without its other half\n"
     "f:1:9: error: \\ud800 is half of a surrogate pair without its other half\n"},
    {"[\"\\u0000\"]", "f:1:3: error: the character U+0000 is not allowed in strings\n"},
    {"[\"\xC0\x80\"]", "f:1:3: error: byte 0xC0 is not valid UTF-8\nf:1:4: error: byte "
                       "0x80 is not valid UTF-8\n"},
    {"[\"\xED\xA0\x80\"]", NULL},
    {"[\"\xF4\x90\x80\x80\"]", NULL},
    {"[\"\xE2\x82\"]", NULL},
    {"\xEF\xBB\xBF[1]", "f:1:1: error: the text starts with a byte order mark: save it as "
                        "UTF-8 without one\n"},
    {"\xFF\xFE[", "f:1:1: error: the text is UTF-16: save it as UTF-8\n"},
    {"// x\n[1]",
     "f:1:1: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"},
    {"[1, /* x */ 2]",
     "f:1:5: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"},
    {"{\"a\": 1, \"b\": {\"c\": 1, \"c\": 2}, \"a\": 3}",
     "f:1:24: error: /b: member \"c\" is given twice, first in line 1\n"
     "f:1:33: error: member \"a\" is given twice, first in line 1\n"},
    {"{\"a\": 1, \"\\u0061\": 2}",
     "f:1:10: error: member \"a\" is given twice, first in line 1\n"},
    {"{\"a/b\": {\"~c\": [0, 1e999]}}",
     "f:1:20: error: /a~1b/~0c/1: the number is beyond the range of a double\n"},
    {"{\"\\u001b[2J\": [0, 1e999]}",
     "f:1:19: error: /\\u001b[2J/1: the number is beyond the range of a double\n"},
    {"{\n \"\xC3\xA4\": 1e999}",
     "f:2:7: error: /\xC3\xA4: the number is beyond the range of a double\n"},
    {"[\r\n\r1e999]", "f:3:1: error: /0: the number is beyond the range of a double\n"},
};

static const syntax_row lost_rows[] = {
    {"[1 \"x\"]", "f:1:4: error: unexpected string where \",\" or \"]\" is expected\n"},
    {"[1 \"x\", 2,]", "f:1:4: error: unexpected string where \",\" or \"]\" is expected\n"
                      "f:1:10: error: no comma is allowed behind the last item of a list\n"},
    {"[1 [2], 3,]", "f:1:4: error: unexpected \"[\" where \",\" or \"]\" is expected\n"
                    "f:1:10: error: no comma is allowed behind the last item of a list\n"},
    {"[1 {}, 3,]", "f:1:4: error: unexpected \"{\" where \",\" or \"]\" is expected\n"
                   "f:1:9: error: no comma is allowed behind the last item of a list\n"},
    {"[1 : 3,]", "f:1:4: error: unexpected \":\" where \",\" or \"]\" is expected\n"},
    {"[1 \xC3\xA4, 3,]",
     "f:1:4: error: unexpected byte 0xC3 where \",\" or \"]\" is expected\n"},
    {"[1 \x7F]", "f:1:4: error: unexpected byte 0x7F where \",\" or \"]\" is expected\n"},
    {"[1 / 2]", "f:1:4: error: unexpected \"/\" where \",\" or \"]\" is expected\n"},
    {"[1 /", "f:1:4: error: unexpected \"/\" where \",\" or \"]\" is expected\n"},
    {"{\"a\": 1, }", "f:1:8: error: no comma is allowed behind the last member of an object\n"},
    {"{\"a\": 1, [2]}",
     "f:1:10: error: unexpected \"[\" where a member name in double quotes is expected\n"},
    {"{\"a", "f:1:2: error: the string that begins here has no closing quote on its line\n"},
    {"[\"a\rb\"]",
     "f:1:2: error: the string that begins here has no closing quote on its line\n"},
    {"[\"\\", "f:1:2: error: the string that begins here has no closing quote on its line\n"
              "f:1:3: error: unknown escape in a string: write \"\\\\\" for a backslash\n"},
    {"[\"\\u12", "f:1:2: error: the string that begins here has no closing quote on its line\n"
                 "f:1:3: error: \\u must be followed by four hexadecimal digits\n"},
    {"[\"\\u12G4\"]", "f:1:3: error: \\u must be followed by four hexadecimal digits\n"},
    {"[\"\\u12/4\"]", "f:1:3: error: \\u must be followed by four hexadecimal digits\n"},
    {"[\"\\u12@4\"]", "f:1:3: error: \\u must be followed by four hexadecimal digits\n"},
    {"[\"\\ud83d\\u0041\"]",
     "f:1:3: error: \\ud83d is half of a surrogate pair without its other half\n"},
    {"[\"\\ud83d\\ue000\"]",
     "f:1:3: error: \\ud83d is half of a surrogate pair without its other half\n"},
    {"[\"\\ud83d\\n\"]",
     "f:1:3: error: \\ud83d is half of a surrogate pair without its other half\n"},
    {"[\"\\ud83d",
     "f:1:2: error: the string that begins here has no closing quote on its line\n"
     "f:1:3: error: \\ud83d is half of a surrogate pair without its other half\n"},
    {"[\"\xE0\x9F\xBF\"]", "f:1:3: error: byte 0xE0 is not valid UTF-8\n"
                           "f:1:4: error: byte 0x9F is not valid UTF-8\nf:1:4: error: byte "
                           "0xBF is not valid UTF-8\n"},
    {"[\"\xF0\x8F\xBF\xBF\"]", NULL},
    {"[\"\xF5\x80\x80\x80\"]", NULL},
    {"[\"\xE2", "f:1:2: error: the string that begins here has no closing quote on its line\n"
                "f:1:3: error: byte 0xE2 is not valid UTF-8\n"},
    {"[1] // x",
     "f:1:5: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"},
    {"[1] /* / * x",
     "f:1:5: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"},
    {"[1] /* x *",
     "f:1:5: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"},
    {"[/* * / */ 1,]",
     "f:1:2: error: comments are not allowed in JSON; use \"description\" or \"source\"\n"
     "f:1:13: error: no comma is allowed behind the last item of a list\n"},
    {"['x", "f:1:2: error: strings are written in double quotes\n"
            "f:1:4: error: the text ends where \",\" or \"]\" is expected\n"},
    {"['x\n, 1,]", "f:1:2: error: strings are written in double quotes\n"
                   "f:2:4: error: no comma is allowed behind the last item of a list\n"},
    {"[Infinity]", "f:1:2: error: Infinity is not a number in JSON: numbers must be finite\n"},
    {"[Zero, _a, trues]",
     "f:1:2: error: unexpected Zero: strings are written in double quotes\n"
     "f:1:8: error: unexpected _a: strings are written in double quotes\n"
     "f:1:12: error: unexpected trues: strings are written in double quotes\n"},
    {"[2-1, 1e5-, 1.5.2]", "f:1:2: error: malformed number 2-1: write an expression as a "
                           "string in double quotes\n"
                           "f:1:7: error: malformed number 1e5-: write an expression as a "
                           "string in double quotes\n"
                           "f:1:13: error: malformed number 1.5.2: write an expression as "
                           "a string in double quotes\n"},
    {"[1e+, 1e]", "f:1:2: error: malformed number 1e+: digits are missing in the exponent\n"
                  "f:1:7: error: malformed number 1e: digits are missing in the exponent\n"},
    {"\xFE\xFF[", "f:1:1: error: the text is UTF-16: save it as UTF-8\n"},
    {"\xFE[", "f:1:1: error: unexpected byte 0xFE where a value is expected\n"},
    {"\xFE", "f:1:1: error: unexpected byte 0xFE where a value is expected\n"},
    {"{\"a\": {\"b\\\"c/d~\": [x]}}",
     "f:1:20: error: /a/b\\\"c~1d~0: unexpected x: strings are written in double quotes\n"},
    {"{\"a\": {e/: 1}}", "f:1:8: error: /a: a member name must stand in double quotes\n"
                         "f:1:9: error: /a: unexpected \"/\" where \":\" is expected\n"},
};

static void check_rows(mt_test *t, int n, const syntax_row *rows)
{
    for (int i = 0; i < n; i++) {
        mt_status rc = MT_OK;
        mt_diagnostics said = said_about(rows[i].text, strlen(rows[i].text), &rc);
        mt_test_row(t, "%s", rows[i].text);
        if (rows[i].said != NULL) {
            CHECK_STR(t, said.lines.s, rows[i].said);
        } else {
            CHECK_INT(t, rc, MT_E_INPUT);
        }
        mt_diagnostics_free(&said);
    }
}

static void json__syntax_errors_are_told_exactly(mt_test *t)
{
    check_rows(t, MT_COUNT(syntax_rows), syntax_rows);
}

/* What else may stand, or end, in every place of the grammar. */
static void json__what_stands_wrongly_is_told_exactly(mt_test *t)
{
    check_rows(t, MT_COUNT(lost_rows), lost_rows);
}

static void json__what_the_standard_allows_is_accepted(mt_test *t)
{
    static const char *const rows[] = {
        "0",
        "-0",
        "1e5",
        "1E+5",
        "-0.5e-3",
        "\"\"",
        "[]",
        "{}",
        " [ ] ",
        "\"\\ud83d\\ude00\"",
        "{\"\": 0}",
        "\"\xF0\x9F\x98\x80\"",
        "\"\xED\x9F\xBF\xEE\x80\x80\"",
        "\"\\\"\\\\\\/\\b\\f\\n\\r\\t\"",
        "1e-999",
        "[true, false, null]",
        "\"\x7F\"",
        "\"\\u00E9\\u00AF\\uD83D\\uDE00\\uFFFF\"",
        "\"\xE0\xA0\x80\xEF\xBF\xBF\xF0\x90\x80\x80\xF4\x8F\xBF\xBF\xC2\x80\xDF\xBF\"",
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_status rc = MT_E_INTERNAL;
        mt_diagnostics said = said_about(rows[i], strlen(rows[i]), &rc);
        mt_test_row(t, "%s", rows[i]);
        CHECK_INT(t, rc, MT_OK);
        CHECK_STR(t, said.lines.s, "");
        mt_diagnostics_free(&said);
    }
}

static void json__nesting_and_length_are_limited(mt_test *t)
{
    char deep[2 * MT_JSON_MAX_DEPTH + 3];
    for (int extra = 0; extra < 2; extra++) {
        const size_t depth = (size_t)MT_JSON_MAX_DEPTH + (size_t)extra;
        mt_status rc = MT_OK;
        memset(deep, '[', depth);
        memset(deep + depth, ']', depth);
        mt_diagnostics said = said_about(deep, 2 * depth, &rc);
        CHECK_INT(t, rc, extra == 0 ? MT_OK : MT_E_INPUT);
        CHECK(t, extra == 0 || strstr(said.lines.s, "nested deeper than 64 levels") != NULL);
        mt_diagnostics_free(&said);
    }
    const size_t long_length = (size_t)MT_JSON_MAX_BYTES + 1;
    char *const spaces = calloc(long_length, 1); /* of which nobody reads more than the start */
    REQUIRE(t, spaces != NULL);
    spaces[0] = '1';
    mt_status rc = MT_OK;
    mt_diagnostics said = said_about(spaces, long_length, &rc);
    CHECK_INT(t, rc, MT_E_INPUT);
    CHECK_STR(t, said.lines.s, "f:1:1: error: longer than 536870912 bytes\n");
    mt_diagnostics_free(&said);
    free(spaces);
}

/* Decimal texts and the doubles that are nearest to them, in hexadecimal notation: no decimal
 * conversion of the test's own. */
static void json__numbers_are_the_nearest_doubles(mt_test *t)
{
    static const struct {
        const char *text;
        double value;
    } rows[] = {
        {"0.1", 0x1.999999999999ap-4},
        {"9007199254740993", 0x1p53},
        {"9007199254740993.00000000000000000000000000000000000000000000000000000000000000001",
         0x1.0000000000001p53},
        {"17.678", 0x1.1ad916872b021p+4},
        {"1.7976931348623157e308", 0x1.fffffffffffffp1023},
        {"4.9406564584124654e-324", 0x1p-1074},
        {"-0", -0.0},
        {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022},
        {"0."
         "000000000000000000000000000000000000000000000000000000000000000000000000000000000001e"
         "84",
         1.0},
        {"1.00000000000000011102230246251565404236316680908203125", 1.0},
        {"1.00000000000000011102230246251565404236316680908203126", 0x1.0000000000001p0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_json *doc = NULL;
        mt_test_row(t, "%s", rows[i].text);
        if (CHECK_INT(t, mt_json_parse(rows[i].text, strlen(rows[i].text), &doc, NULL),
                      MT_OK)) {
            const double got = mt_json_number(doc, MT_JSON_ROOT);
            CHECK_NEAR_ABS(t, got, rows[i].value, 0.0);
            CHECK(t, signbit(got) == signbit(rows[i].value));
        }
        mt_json_delete(doc);
    }
}

/* A decimal comma, and a decimal point of two bytes. A long number, which cJSON does not read,
 * among the others. */
static void json__the_locale_changes_nothing(mt_test *t)
{
    static const char text[] =
        "[1.5, 2.25e1, "
        "3.1250000000000000000000000000000000000000000000000000000000000000000001]";
    static const char *const locales[] = {"C", "de_DE.UTF-8", "tr_TR.UTF-8", "ps_AF.UTF-8"};
    static const double numbers[] = {1.5, 22.5, 3.125};
    for (int i = 0; i < MT_COUNT(locales); i++) {
        mt_json *doc = NULL;
        mt_test_row(t, "%s", locales[i]);
        CHECK(t, setlocale(LC_NUMERIC, locales[i]) != NULL);
        CHECK(t, (strcmp(localeconv()->decimal_point, ".") == 0) == (i == 0));
        CHECK_INT(t, mt_json_parse(text, strlen(text), &doc, NULL), MT_OK);
        for (int k = 0; doc != NULL && k < MT_COUNT(numbers); k++) {
            CHECK_NEAR_ABS(t, mt_json_number(doc, 1 + k), numbers[k], 0.0);
        }
        mt_json_delete(doc);
        CHECK_STR(t, setlocale(LC_NUMERIC, NULL), locales[i]);
    }
    (void)setlocale(LC_NUMERIC, "C");
}

static void json__values_and_places_are_found_by_address(mt_test *t)
{
    static const char text[] =
        "{\n  \"a\": [1, \"\\u00e4\\n\", true],\n  \"b\": {\"c\": null}\n}";
    mt_json *doc = NULL;
    REQUIRE(t, mt_json_parse(text, strlen(text), &doc, NULL) == MT_OK);
    int line = 0;
    int column = 0;
    mt_text pointer = {0};
    const mt_addr a = mt_json_member(doc, MT_JSON_ROOT, "a");
    const mt_addr c = mt_json_member(doc, mt_json_member(doc, MT_JSON_ROOT, "b"), "c");
    CHECK_INT(t, a, 1);
    CHECK_INT(t, mt_json_count(doc, MT_JSON_ROOT), 2);
    CHECK_INT(t, mt_json_count(doc, a), 3);
    CHECK_STR(t, mt_json_string(doc, a + 2), "\xC3\xA4\n");
    CHECK(t, mt_json_bool(doc, a + 3));
    CHECK_INT(t, mt_json_next(doc, a + 3), MT_NO_ADDR);
    CHECK_INT(t, mt_json_type_of(doc, c), MT_JSON_NULL);
    CHECK_STR(t, mt_json_name(doc, c), "c");
    CHECK_INT(t, mt_json_member(doc, MT_JSON_ROOT, "c"), MT_NO_ADDR);
    mt_json_locate(doc, c, &line, &column);
    CHECK_INT(t, line, 3);
    CHECK_INT(t, column, 14);
    mt_json_locate(doc, mt_json_name_addr(doc, c), &line, &column);
    CHECK_INT(t, column, 9);
    mt_json_pointer(doc, c, &pointer);
    CHECK_STR(t, pointer.s, "/b/c");
    mt_text_free(&pointer);
    mt_json_pointer(doc, a + 2, &pointer);
    CHECK_STR(t, pointer.s, "/a/1");
    mt_text_free(&pointer);
    mt_json_delete(doc);
}

static void json__more_problems_than_the_limit_are_counted(mt_test *t)
{
    mt_json *doc = NULL;
    mt_diagnostics said = {.count = 0};
    REQUIRE(t, mt_json_parse("[]", 2, &doc, NULL) == MT_OK);
    for (int i = 0; i < MT_DIAG_LIMIT + 3; i++) {
        mt_diag_error(mt_json_diags(doc), MT_JSON_ROOT, "problem %d", i);
    }
    mt_json_report(doc, "f", &said);
    CHECK(t, strstr(said.lines.s, "f:1:1: error: problem 199\nf: 3 more not shown\n") != NULL);
    CHECK(t, strstr(said.lines.s, "problem 200") == NULL);
    mt_diagnostics_free(&said);
    mt_json_delete(doc);
}

/* How often what stands in a text. */
static int count_of(const char *text, const char *what)
{
    int n = 0;
    for (const char *at = strstr(text, what); at != NULL; at = strstr(at + 1, what)) {
        n++;
    }
    return n;
}

/* Forty-nine problems, then a text with two more: the first of them is the fiftieth and the
 * last that is told, wherever it stands. */
static void json__the_scan_ends_with_the_fiftieth_problem(mt_test *t)
{
    enum { MOST = 50 };
    static const struct {
        const char *text;
        const char *last;
    } rows[] = {
        {"// x\n[1,]", "50:1: error: comments"},
        {"[/* x */ 1,]", "50:2: error: comments"},
        {"[1 /* x */, 2,]", "50:4: error: comments"},
        {"[1, /* x */ 2,]", "50:5: error: comments"},
        {"{/* x */ \"a\": 1,}", "50:2: error: comments"},
        {"{\"a\" /* x */ : 1,}", "50:6: error: comments"},
        {"{\"a\": /* x */ 1,}", "50:7: error: comments"},
        {"[1] /* x */ 2", "50:5: error: comments"},
        {"{\"a\": 1, \"\\x\": 1,}", "50:11: error: unknown escape"},
        {"{a: 1,}", "50:2: error: a member name"},
        {"[\"\\x\", 1,]", "50:3: error: unknown escape"},
        {"[\"\\u12g4\", 1,]", "50:3: error: \\u must"},
        {"[\"\\u0000\", 1,]", "50:3: error: the character U+0000"},
        {"[\"\\ud800\", 1,]", "50:3: error: \\ud800"},
        {"[\"\t\", 1,]", "50:3: error: control character"},
        {"[\"\x80\", 1,]", "50:3: error: byte 0x80"},
        {"[1 \"x\", 1,]", "50:4: error: unexpected string"},
        {"[01, 1,]", "50:2: error: malformed"},
        {"[NaN, 1,]", "50:2: error: NaN"},
        {"[x, 1,]", "50:2: error: unexpected x"},
        {"['x', 1,]", "50:2: error: strings"},
        {"[[1,], 1,]", "50:4: error: /0: no comma"},
    };
    char text[1024];
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_status rc = MT_OK;
        size_t at = 0;
        for (int k = 1; k < MOST; k++) {
            at += (size_t)snprintf(text + at, sizeof text - at, "// x\n");
        }
        (void)snprintf(text + at, sizeof text - at, "%s", rows[i].text);
        mt_diagnostics said = said_about(text, strlen(text), &rc);
        mt_test_row(t, "%s", rows[i].text);
        CHECK_INT(t, rc, MT_E_INPUT);
        CHECK_INT(t, count_of(said.lines.s, ": error: "), MOST);
        CHECK(t, strstr(said.lines.s, rows[i].last) != NULL);
        mt_diagnostics_free(&said);
    }
}

static void json__values_are_limited(mt_test *t)
{
    static const char text[] = "[1,1,1,1]"; /* the list is a value, too */
    for (int most = 4; most <= 5; most++) {
        mt_arena mem = {.first = NULL};
        mt_diags diags = mt_diags_default(&mem);
        mt_json_spots spots = {.most = most};
        mt_json_scan(text, sizeof text - 1, &spots, &diags);
        CHECK_INT(t, diags.errors, most == 4 ? 1 : 0);
        if (most == 4 && CHECK_INT(t, diags.count, 1)) {
            CHECK_STR(t, diags.items[0].text, "more than 4 values");
            CHECK_INT(t, spots.items[diags.items[0].addr].start, 7);
        }
        mt_arena_free(&mem);
    }
    CHECK(t, MT_JSON_MAX_VALUES <= MT_JSON_MAX_BYTES / 2);
}

/* What is shown of a long text ends at a character. */
static void json__long_lines_are_cut_between_characters(mt_test *t)
{
    enum { LONGEST = 4096 };
    for (int shift = 0; shift < 3; shift++) {
        mt_json *doc = NULL;
        mt_diagnostics said = {.count = 0};
        mt_text long_one = {0};
        REQUIRE(t, mt_json_parse("[]", 2, &doc, NULL) == MT_OK);
        mt_text_add_n(&long_one, "xxx", (size_t)shift);
        for (int i = 0; i < LONGEST; i++) {
            mt_text_add(&long_one, "\xE2\x82\xAC");
        }
        mt_diag_error(mt_json_diags(doc), MT_NO_ADDR, "%s", long_one.s);
        mt_json_report(doc, "f", &said);
        mt_test_row(t, "%d bytes before", shift);
        const char *const end = strstr(said.lines.s, "...\n");
        if (CHECK(t, end != NULL && end - said.lines.s > 3 &&
                         strlen(said.lines.s) < strlen(long_one.s))) {
            CHECK(t, memcmp(end - 3, "\xE2\x82\xAC", 3) == 0);
            CHECK(t, strncmp(said.lines.s, "f: error: ", 10) == 0);
        }
        mt_text_free(&long_one);
        mt_diagnostics_free(&said);
        mt_json_delete(doc);
    }
}

static void json__only_numbers_and_strings_have_a_span(mt_test *t)
{
    static const char text[] = "{\"a\": 12.5, \"b\": \"x\\\"y\", \"c\": true, \"d\": []}";
    mt_json *doc = NULL;
    size_t begin = 0;
    size_t end = 0;
    REQUIRE(t, mt_json_parse(text, strlen(text), &doc, NULL) == MT_OK);
    CHECK(t, mt_json_span(doc, mt_json_member(doc, MT_JSON_ROOT, "a"), &begin, &end));
    CHECK(t, end - begin == 4 && memcmp(text + begin, "12.5", 4) == 0);
    CHECK(t, mt_json_span(doc, mt_json_member(doc, MT_JSON_ROOT, "b"), &begin, &end));
    CHECK(t, end - begin == 6 && memcmp(text + begin, "\"x\\\"y\"", 6) == 0);
    CHECK(t, !mt_json_span(doc, mt_json_member(doc, MT_JSON_ROOT, "c"), &begin, &end));
    CHECK(t, !mt_json_span(doc, mt_json_member(doc, MT_JSON_ROOT, "d"), &begin, &end));
    CHECK(t, !mt_json_span(doc, MT_NO_ADDR, &begin, &end));
    CHECK(t, !mt_json_span(doc, 1000, &begin, &end));
    mt_json_delete(doc);
}

static mt_status parse_once(mt_test *t, const void *context)
{
    static const char text[] = "{\"a\": [1.5, \"x\", {\"b\": 1e999}], \"a\": 2}";
    mt_json *doc = NULL;
    const mt_status rc = mt_json_parse(text, strlen(text), &doc, NULL);
    (void)context;
    CHECK(t, (rc == MT_OK) == (doc != NULL));
    mt_json_delete(doc);
    return rc;
}

static void json__every_failing_allocation_is_survived(mt_test *t)
{
    mt_refuse_each(t, "parse_once", parse_once, NULL, MT_OK);
}

MT_TEST_MAIN(MT_TEST(json__syntax_errors_are_told_exactly),
             MT_TEST(json__what_stands_wrongly_is_told_exactly),
             MT_TEST(json__what_the_standard_allows_is_accepted),
             MT_TEST(json__nesting_and_length_are_limited),
             MT_TEST(json__numbers_are_the_nearest_doubles),
             MT_TEST(json__the_locale_changes_nothing),
             MT_TEST(json__values_and_places_are_found_by_address),
             MT_TEST(json__more_problems_than_the_limit_are_counted),
             MT_TEST(json__the_scan_ends_with_the_fiftieth_problem),
             MT_TEST(json__values_are_limited),
             MT_TEST(json__long_lines_are_cut_between_characters),
             MT_TEST(json__only_numbers_and_strings_have_a_span),
             MT_TEST(json__every_failing_allocation_is_survived))
