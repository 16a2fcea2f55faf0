/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * JSON class by class (RFC 8259): documents that are valid, invalid, or for the implementation
 * to decide, each with what we do: it is accepted, or refused at a place.
 */
#include "io/json_verdict.h"
#include "mt_test.h"

typedef struct row {
    const char *text;
    size_t size;
    const char *place; /* "line:column" of the first problem; NULL: accepted */
} row;

#define YES(text)                      \
    {                                  \
        (text), sizeof(text) - 1, NULL \
    }
#define NOT(text, place)                  \
    {                                     \
        (text), sizeof(text) - 1, (place) \
    }

/* clang-format off: one document a line */
static const row STRUCTURE[] = {
    YES("[]"),
    YES("{}"),
    YES("[[],{}]"),
    YES("{\"a\":{\"b\":[]}}"),
    YES("[1,[2,[3]]]"),
    YES("{\"\":\"\"}"),
    NOT("[", "1:2"),
    NOT("]", "1:1"),
    NOT("{", "1:2"),
    NOT("}", "1:1"),
    NOT("[[]", "1:4"),
    NOT("[]]", "1:3"),
    NOT("{}}", "1:3"),
    NOT("[}", "1:2"),
    NOT("{]", "1:2"),
    NOT("[,]", "1:2"),
    NOT("[1,,2]", "1:4"),
    NOT("[,1]", "1:2"),
    NOT("{,}", "1:2"),
    NOT("{\"a\":1,,\"b\":2}", "1:8"),
    NOT("{\"a\"}", "1:5"),
    NOT("{\"a\":}", "1:6"),
    NOT("{:1}", "1:2"),
    NOT("{1:1}", "1:2"),
    NOT("{null:1}", "1:2"),
    NOT("{[]:1}", "1:2"),
    NOT("{\"a\"::1}", "1:6"),
    NOT("{\"a\":1:2}", "1:7"),
    NOT("[\"a\":1]", "1:5"),
    NOT("{\"a\",\"b\"}", "1:5"),
    NOT("[1 2]", "1:4"),
    NOT("{\"a\":1 \"b\":2}", "1:8"),
    NOT("[1;2]", "1:3"),
    NOT("{\"a\"=1}", "1:5"),
    NOT("(1)", "1:1"),
    NOT("[1,2", "1:5"),
    NOT("{\"a\":1", "1:7"),
    NOT("<a/>", "1:1"),
    NOT("a: 1", "1:1"),
};
static const row WHITE_SPACE[] = {
    YES(" [ 1 , 2 ] "),
    YES("\t{\t\"a\"\t:\t1\t}\t"),
    YES("\r\n[\r\n]\r\n"),
    YES("\n\n 7 \n"),
    NOT("", "1:1"),
    NOT(" ", "1:1"),
    NOT("\n\n", "1:1"),
    NOT("[1]\f", "1:4"),
    NOT("[\v1]", "1:2"),
    NOT("[1\xC2\xA0]", "1:3"),
    NOT("\xE2\x80\xA8[1]", "1:1"),
    NOT("[\xE3\x80\x80]", "1:2"),
    NOT("[\b]", "1:2"),
    NOT("\n\n[1\f]", "3:3"),
};
static const row LITERALS[] = {
    YES("true"),
    YES("false"),
    YES("null"),
    YES("[true,false,null]"),
    NOT("True", "1:1"),
    NOT("FALSE", "1:1"),
    NOT("nul", "1:1"),
    NOT("nulll", "1:1"),
    NOT("[tru]", "1:2"),
    NOT("[truefalse]", "1:2"),
    NOT("undefined", "1:1"),
    NOT("nil", "1:1"),
    NOT("[yes]", "1:2"),
    NOT("[true\x00]", "1:6"),
};
static const row NUMBERS[] = {
    YES("0"),
    YES("-0"),
    YES("-1"),
    YES("10"),
    YES("1.5"),
    YES("0.0"),
    YES("1e1"),
    YES("1E+1"),
    YES("1e-1"),
    YES("0e0"),
    YES("1.25e-05"),
    YES("-0.0e-0"),
    YES("1e-400"),
    YES("123456789012345678901234567890"),
    YES("0.1000000000000000055511151231257827021181583404541015625"),
    YES("1.7976931348623157e308"),
    YES("4e-324"),
    NOT("+1", "1:1"),
    NOT("01", "1:1"),
    NOT("-01", "1:1"),
    NOT("00", "1:1"),
    NOT("1.", "1:1"),
    NOT(".1", "1:1"),
    NOT("-.1", "1:1"),
    NOT("1.e1", "1:1"),
    NOT("1e", "1:1"),
    NOT("1e+", "1:1"),
    NOT("1e1.5", "1:1"),
    NOT("1e1e1", "1:1"),
    NOT("-", "1:1"),
    NOT("--1", "1:1"),
    NOT("- 1", "1:1"),
    NOT("1-", "1:1"),
    NOT("0x1", "1:1"),
    NOT("0b1", "1:1"),
    NOT("1_000", "1:1"),
    NOT("1 000", "1:3"),
    NOT("1,5", "1:2"),
    NOT("[1,000]", "1:4"),
    NOT("1f", "1:1"),
    NOT("1d0", "1:1"),
    NOT("NaN", "1:1"),
    NOT("nan", "1:1"),
    NOT("Infinity", "1:1"),
    NOT("-Infinity", "1:1"),
    NOT("inf", "1:1"),
    NOT("1#INF", "1:2"),
    NOT("1/2", "1:2"),
    NOT("[1\x00]", "1:3"),
    NOT("\xEF\xBC\x91", "1:1"),
    NOT("1.8e308", "1:1"),
    NOT("-1e309", "1:1"),
    NOT("[0,\n 1e99999999999]", "2:2"),
    NOT("1e+9999999999999999999999", "1:1"),
};
static const row STRINGS[] = {
    YES("\"\""),
    YES("\"a\""),
    YES("\" \""),
    YES("\"\x7F\""),
    YES("\"/\""),
    YES("\"//\""),
    YES("\"'\""),
    YES("\"{[,:]}\""),
    NOT("\"", "1:1"),
    NOT("\"a", "1:1"),
    NOT("\"a\\", "1:1"),
    NOT("\"a\\\"", "1:1"),
    NOT("'a'", "1:1"),
    NOT("`a`", "1:1"),
    NOT("[\"a\" \"b\"]", "1:6"),
    NOT("\"a\"\"b\"", "1:4"),
    NOT("[\"a\nb\"]", "1:2"),
    NOT("[\"a\rb\"]", "1:2"),
    NOT("a", "1:1"),
    NOT("\\u0061", "1:1"),
    NOT("\"a\" + \"b\"", "1:5"),
};
static const row CONTROL_CHARACTERS[] = {
    YES("\"\\u0001\\u001f\\u007f\\u0080\\u009f\\u2028\\ufeff\""),
    YES("\"\\t\\n\\r\\b\\f\""),
    NOT("\"\x01\"", "1:2"),
    NOT("\"a\tb\"", "1:3"),
    NOT("\"\x1F\"", "1:2"),
    NOT("\"\x1B[2J\"", "1:2"),
    NOT("[1,\x07]", "1:4"),
    NOT("\x1A", "1:1"),
    NOT("{\"\t\":1}", "1:3"),
};
static const row NUL[] = {
    NOT("\x00", "1:1"),
    NOT("[1]\x00", "1:4"),
    NOT("[\x00\x31]", "1:2"),
    NOT("\"a\x00\x62\"", "1:3"),
    NOT("{\"a\x00\":1}", "1:4"),
    NOT("\"\\u0000\"", "1:2"),
    NOT("{\"\\u0000\":1}", "1:3"),
    NOT("\"a\\u0000\"", "1:3"),
    NOT("\x00\x00\x00\x31", "1:1"),
};
static const row ESCAPES[] = {
    YES("\"\\\"\\\\\\/\""),         YES("\"\\u00e9\\u00E9\""),
    YES("\"\\u0022\\u005c\""),      YES("\"\\uFFFF\\uFFFE\""),
    YES("{\"\\u0061\":1,\"b\":2}"), NOT("\"\\x41\"", "1:2"),
    NOT("\"\\a\"", "1:2"),          NOT("\"\\v\"", "1:2"),
    NOT("\"\\0\"", "1:2"),          NOT("\"\\'\"", "1:2"),
    NOT("\"\\U0041\"", "1:2"),      NOT("\"\\ \"", "1:2"),
    NOT("\"\\\n\"", "1:1"),         NOT("\"\\u\"", "1:2"),
    NOT("\"\\u1\"", "1:2"),         NOT("\"\\u12\"", "1:2"),
    NOT("\"\\u123\"", "1:2"),       NOT("\"\\u 123\"", "1:2"),
    NOT("\"\\u-123\"", "1:2"),      NOT("\"\\u00G0\"", "1:2"),
    NOT("\"\\u{41}\"", "1:2"),      NOT("\"a\\u00\xC3\xA9\"", "1:3"),
    NOT("\"\\\xC3\xA9\"", "1:2"),
};
static const row SURROGATES[] = {
    YES("\"\\ud800\\udc00\""),
    YES("\"\\uDBFF\\uDFFF\""),
    YES("\"\\ud83d\\uDE00x\""),
    NOT("\"\\ud800\"", "1:2"),
    NOT("\"\\udfff\"", "1:2"),
    NOT("\"\\udc00\\ud800\"", "1:2"),
    NOT("\"\\ud800\\ud800\\udc00\"", "1:2"),
    NOT("\"\\ud800x\\udc00\"", "1:2"),
    NOT("\"\\ud800\\n\"", "1:2"),
    NOT("\"\\ud800\\u0041\"", "1:2"),
    NOT("\"x\\ud800\\ue000\"", "1:3"),
    NOT("\"\\ud800\\uDC0\"", "1:2"),
    NOT("\"\xED\xA0\x80\xED\xB0\x80\"", "1:2"),
};
static const row UTF_8[] = {
    YES("\"\xC2\x80\xDF\xBF\""),
    YES("\"\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80\xEF\xBF\xBF\""),
    YES("\"\xF0\x90\x80\x80\xF4\x8F\xBF\xBF\""),
    YES("{\"\xC3\xA4\":\"\xE2\x82\xAC\"}"),
    NOT("\"\x80\"", "1:2"),
    NOT("\"\xBF\"", "1:2"),
    NOT("\"\xC3\"", "1:2"),
    NOT("\"\xC3(\"", "1:2"),
    NOT("\"\xC0\xAF\"", "1:2"),
    NOT("\"\xC1\xBF\"", "1:2"),
    NOT("\"\xE0\x80\xAF\"", "1:2"),
    NOT("\"\xE0\x9F\xBF\"", "1:2"),
    NOT("\"\xF0\x80\x80\xAF\"", "1:2"),
    NOT("\"\xF0\x8F\xBF\xBF\"", "1:2"),
    NOT("\"\xED\xA0\x80\"", "1:2"),
    NOT("\"\xED\xBF\xBF\"", "1:2"),
    NOT("\"\xF4\x90\x80\x80\"", "1:2"),
    NOT("\"\xF5\x80\x80\x80\"", "1:2"),
    NOT("\"\xF8\x88\x80\x80\x80\"", "1:2"),
    NOT("\"\xFC\x84\x80\x80\x80\x80\"", "1:2"),
    NOT("\"\xFE\"", "1:2"),
    NOT("\"\xFF\"", "1:2"),
    NOT("\"\xE2\x82\"", "1:2"),
    NOT("\"\xF0\x9F\x98\"", "1:2"),
    NOT("\"\xC3\xA4\xFF\"", "1:3"),
    NOT("{\"\xFF\":1}", "1:3"),
    NOT("[\xFF]", "1:2"),
    NOT("\"\xE9\"", "1:2"),
};
static const row BYTE_ORDER_MARKS[] = {
    YES("\"\xEF\xBB\xBF\""),
    NOT("\xEF\xBB\xBF[]", "1:1"),
    NOT("\xEF\xBB\xBF", "1:1"),
    NOT("\xFE\xFF\x00[", "1:1"),
    NOT("\xFF\xFE[\x00]\x00", "1:1"),
    NOT("[]\xEF\xBB\xBF", "1:3"),
    NOT("\xEF\xBB[]", "1:1"),
    NOT("\x00[\x00]", "1:1"),
    NOT("\xFF\xFE\x00\x00[\x00\x00\x00", "1:1"),
};
static const row WHAT_FOLLOWS[] = {
    YES("[] "),           YES("{}\n"),
    NOT("[][]", "1:3"),   NOT("{}{}", "1:3"),
    NOT("1 1", "1:3"),    NOT("[]1", "1:3"),
    NOT("[],", "1:3"),    NOT("[]x", "1:3"),
    NOT("\"a\"1", "1:4"), NOT("true false", "1:6"),
    NOT("{}#", "1:3"),    NOT("[]\n[]", "2:1"),
    NOT("{}\\n", "1:3"),  NOT("[]//", "1:3"),
};
static const row COMMENTS[] = {
    YES("\"/* x */\""),           NOT("//\n1", "1:1"),
    NOT("/**/1", "1:1"),          NOT("1//", "1:2"),
    NOT("[1/**/]", "1:3"),        NOT("#\n1", "1:1"),
    NOT("{/*x*/\"a\":1}", "1:2"), NOT("--x\n1", "1:1"),
};
static const row NAMES_GIVEN_TWICE[] = {
    YES("{\"a\":1,\"A\":2}"),
    YES("[{\"a\":1},{\"a\":2}]"),
    YES("{\"a\":{\"a\":1}}"),
    YES("{\"a\":1,\"a \":2}"),
    YES("{\"\xC3\xA4\":1,\"a\\u0308\":2}"),
    NOT("{\"a\":1,\"a\":1}", "1:8"),
    NOT("{\"a\":1,\"b\":2,\"a\":3}", "1:14"),
    NOT("{\"\":1,\"\":2}", "1:7"),
    NOT("{\"\\u0061\":1,\"a\":2}", "1:13"),
    NOT("{\"\xC3\xA4\":1,\"\\u00e4\":2}", "1:8"),
    NOT("[{\n\"x\":[],\n\"x\":{}}]", "3:1"),
};
static const row TRAILING_COMMAS[] = {
    NOT("[1,]", "1:3"),     NOT("[,]", "1:2"),      NOT("{\"a\":1,}", "1:7"),
    NOT("[[1,],2]", "1:4"), NOT("[1\n,\n]", "2:1"), NOT("1,", "1:2"),
};
static const row PLACES[] = {
    NOT("[1,\n2,\n\n  x]", "4:3"),          NOT("[1,\r2,\r\n  x]", "3:3"),
    NOT("[\"\xC3\xA4\xC3\xA4\",x]", "1:7"), NOT("[\"\xF0\x9F\x98\x80\",x]", "1:6"),
    NOT("[\"\\ud83d\\ude00\",x]", "1:17"),  NOT("[\t\tx]", "1:4"),
};
#define CLASS(name, rows)              \
    {                                  \
        (name), (rows), MT_COUNT(rows) \
    }
static const struct json_class {
    const char *name;
    const row *rows;
    int n;
} CLASSES[] = {
    CLASS("structure", STRUCTURE),
    CLASS("white space", WHITE_SPACE),
    CLASS("literals", LITERALS),
    CLASS("numbers", NUMBERS),
    CLASS("strings", STRINGS),
    CLASS("control characters", CONTROL_CHARACTERS),
    CLASS("NUL", NUL),
    CLASS("escapes", ESCAPES),
    CLASS("surrogates", SURROGATES),
    CLASS("UTF-8", UTF_8),
    CLASS("byte order marks", BYTE_ORDER_MARKS),
    CLASS("what follows", WHAT_FOLLOWS),
    CLASS("comments", COMMENTS),
    CLASS("names given twice", NAMES_GIVEN_TWICE),
    CLASS("trailing commas", TRAILING_COMMAS),
    CLASS("places", PLACES),
};
/* clang-format on */

static void classes__are_accepted_or_refused_at_their_place(mt_test *t)
{
    for (int c = 0; c < MT_COUNT(CLASSES); c++) {
        for (int i = 0; i < CLASSES[c].n; i++) {
            const row *const r = &CLASSES[c].rows[i];
            const verdict v = judge(r->text, r->size);
            mt_test_row(t, "%s, %d: %.40s", CLASSES[c].name, i, r->text);
            CHECK(t, v.accepted == (r->place == NULL));
            CHECK_STR(t, v.place, r->place == NULL ? "" : r->place);
        }
    }
}

static void classes__depth_is_limited_wherever_it_is(mt_test *t)
{
    static const char *const opens[] = {"[", "{\"a\":", "[{\"a\":"};
    static const char *const closes[] = {"]", "}", "}]"};
    static const int levels[] = {1, 1, 2};
    for (int i = 0; i < MT_COUNT(opens); i++) {
        for (int depth = MT_JSON_MAX_DEPTH - 2; depth <= MT_JSON_MAX_DEPTH + 2; depth += 2) {
            mt_text text = {0};
            for (int k = 0; k < depth; k += levels[i]) {
                mt_text_add(&text, opens[i]);
            }
            mt_text_add(&text, "0");
            for (int k = 0; k < depth; k += levels[i]) {
                mt_text_add(&text, closes[i]);
            }
            mt_test_row(t, "%s to depth %d", opens[i], depth);
            CHECK(t, judge(text.s, text.length).accepted == (depth <= MT_JSON_MAX_DEPTH));
            mt_text_free(&text);
        }
    }
}

static void numbers__are_what_they_say(mt_test *t)
{
    static const char *const rows[] = {"0",
                                       "-0",
                                       "12",
                                       "-3.25",
                                       "1e3",
                                       "5E-1",
                                       "0.1e1",
                                       "123456789.125",
                                       "1e-320",
                                       "1e-400",
                                       "9007199254740993"};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const verdict v = judge(rows[i], strlen(rows[i]));
        const double wanted = strtod(rows[i], NULL);
        mt_test_row(t, "%s", rows[i]);
        CHECK(t, v.accepted && v.number == wanted && signbit(v.number) == signbit(wanted));
    }
}

MT_TEST_MAIN(MT_TEST(classes__are_accepted_or_refused_at_their_place),
             MT_TEST(classes__depth_is_limited_wherever_it_is),
             MT_TEST(numbers__are_what_they_say))
