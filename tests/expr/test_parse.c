/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "expr/expr.h"
#include "expr/kind.h"
#include "expr_fixture.h"
#include "mt_alloc.h"
#include "mt_test.h"

static const double PI = 3.14159265358979323846;

/* Value at x = 2, y = 3, z = 5, k_1 = 7; NaN where text is refused. */
static double value_of(const char *text)
{
    static const double inputs[N_PARAMS] = {2.0, 3.0, 5.0, 7.0};
    fixture f;
    mt_err err;
    double value = nan("");
    if (fixture_init(&f, text, &err) &&
        mt_program_eval(&f.p, inputs, f.value, NULL, &err) == MT_OK) {
        value = f.value[f.root];
    }
    fixture_free(&f);
    return value;
}

static void parse__precedence_and_associativity(mt_test *t)
{
    static const struct {
        const char *text;
        double want;
    } rows[] = {
        {"1+2*3", 7.0},
        {"(1+2)*3", 9.0},
        {"7-4-2", 1.0},
        {"7-(4-2)", 5.0},
        {"24/4/2", 3.0},
        {"24/4*2", 12.0},
        {"2^3^2", 512.0},
        {"(2^3)^2", 64.0},
        {"-2^2", -4.0},
        {"(-2)^2", 4.0},
        {"2^-1", 0.5},
        {"2^-2^2", 0.0625},
        {"-2^-2", -0.25},
        {"2*-3", -6.0},
        {"2--3", 5.0},
        {"2+-+-3", 5.0},
        {"--2", 2.0},
        {"+x", 2.0},
        {"-x^2+y*z", 11.0},
        {"x*y^2/z", 3.6},
        {"2^x*y", 12.0},
        {"x/y*z", 2.0 / 3.0 * 5.0},
        {"k_1-x-y", 2.0},
        {" \t\r\n( x + y ) * 2 ", 10.0},
        {"max(x,y)+min(y,z)*2", 9.0},
        {"hypot(y,4)^2", 25.0},
        {"atan2(y-y, -x)", 3.14159265358979323846},
        {"if(1 < 2, x, y)", 2.0},
        {"if(2 < 1, x, y)*10", 30.0},
        {"1+if(2<=2,x,y)+1", 4.0},
        {"if(2 > 2, x, y)", 3.0},
        {"if(2 >= 2, x, y)", 2.0},
        {"if(1+1 == 4/2, x, y)", 2.0},
        {"if(not 1 < 2, x, y)", 3.0},
        {"if(not not 1 < 2, x, y)", 2.0},
        /* "and" binds tighter than "or", "not" tighter than both */
        {"if(1 < 2 or 1 < 2 and 2 < 1, x, y)", 2.0},
        {"if((1 < 2 or 1 < 2) and 2 < 1, x, y)", 3.0},
        {"if(not 2 < 1 and 2 < 1, x, y)", 3.0},
        {"if(not (2 < 1 and 2 < 1), x, y)", 2.0},
        {"if((1 + 1)*2 < ((5)), x, y)", 2.0},
        {"if(if(1 < 2, 3, 4) == 3, if(2 < 1, x, y), z)", 3.0},
        {"if(1 < if(0 == 1, 0, 2), x, y)", 2.0},
        {"if(max(1, 2) < 3, min(x, if(1 == 1, y, z)), z)", 2.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        CHECK_NEAR(t, value_of(rows[i].text), rows[i].want, 2.0 * DBL_EPSILON);
    }
}

static void parse__functions_and_constants_have_their_values(mt_test *t)
{
    static const struct {
        const char *text;
        double want;
    } rows[] = {
        {"sqrt(16)", 4.0},
        {"cbrt(-27)", -3.0},
        {"exp(1)", 2.71828182845904523536},
        {"ln(exp(3))", 3.0},
        {"log10(1e-5)", -5.0},
        {"sin(pi/6)", 0.5},
        {"cos(60*deg)", 0.5},
        {"tan(45*deg)", 1.0},
        {"asin(0.5)", 0.52359877559829887308},
        {"acos(0.5)", 1.04719755119659774615},
        {"atan(1)", 0.78539816339744830962},
        {"sinh(ln(2))", 0.75},
        {"cosh(ln(2))", 1.25},
        {"tanh(ln(2))", 0.6},
        {"abs(-x)", 2.0},
        {"atan2(1,-1)", 2.35619449019234492885},
        {"min(3,2)", 2.0},
        {"max(3,2)", 3.0},
        {"hypot(5,12)", 13.0},
        {"pow(2,10)", 1024.0},
        {"pow(0,0)", 1.0},
        {"258*rpm", 4.3},
        {"10*deg", 0.17453292519943295769},
        {"pi", 3.14159265358979323846},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        CHECK_NEAR(t, value_of(rows[i].text), rows[i].want, 4.0 * DBL_EPSILON);
    }
    CHECK(t, value_of("pi") == PI);
}

/* The compiler's reading of the same literal is the oracle: correctly rounded. */
static void parse__numbers_are_rounded_correctly(mt_test *t)
{
    static const struct {
        const char *text;
        double want;
    } rows[] = {
        {"0", 0.0},
        {"0.1", 0.1},
        {".5", 0.5},
        {"5.", 5.0},
        {"1e3", 1e3},
        {"1E+03", 1e3},
        {"12.50e-1", 1.25},
        {"007", 7.0},
        {"2.8284271247461903", 2.8284271247461903},
        {"9007199254740993", 9007199254740993.0},
        {"2.2250738585072011e-308", 2.2250738585072011e-308},
        {"4.9406564584124654e-324", 4.9406564584124654e-324},
        {"1.7976931348623157e308", 1.7976931348623157e308},
        {"1e-400", 0.0},
        {"1e-99999999999", 0.0},
        {"0e99999999999", 0.0},
        {"0.000000000000000000000000000000000000000000000001e48", 1.0},
        {"1000000000000000000000000000000000000000000000000e-48", 1.0},
        /* just below the tie: down */
        {"1.00000000000000011102230246251565404", 1.0},
        {"1.00000000000000011102230246251565405", 1.0000000000000002220446049250313},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        CHECK(t, value_of(rows[i].text) == rows[i].want);
    }
}

typedef struct wrong_text {
    const char *text;
    const char *want;
} wrong_text;

static void expect_problems(mt_test *t, int n, const wrong_text *rows)
{
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < n; i++) {
        mt_test_row(t, "%s", rows[i].text);
        mt_expr e;
        mt_err err = {.code = MT_OK};
        CHECK_INT(t, parse_text(rows[i].text, &mem, &e, &err), MT_E_INPUT);
        CHECK_STR(t, err.text, rows[i].want);
        CHECK_INT(t, parse_text(rows[i].text, &mem, &e, NULL), MT_E_INPUT);
    }
    mt_arena_free(&mem);
}

static void parse__problems_are_named_with_their_place(mt_test *t)
{
    static const wrong_text rows[] = {
        {"", "at character 1: the expression ends where a number, a name or \"(\" is expected"},
        {"x +",
         "at character 4: the expression ends where a number, a name or \"(\" is expected"},
        {"x + * y", "at character 5: \"*\" where a number, a name or \"(\" is expected"},
        {"2 x", "at character 3: \"x\" where an operator or the end is expected; did you mean "
                "\"2*x\"?"},
        {"x y", "at character 3: \"y\" where an operator or the end is expected"},
        {"x)", "at character 2: \")\" where an operator or the end is expected"},
        {"(x", "at character 3: the expression ends where an operator or the \")\" for the "
               "\"(\" at character 1 is expected"},
        {"(x + (y * 2)", "at character 13: the expression ends where an operator or the \")\" "
                         "for the \"(\" at character 1 is expected"},
        {"2 + (x y)", "at character 8: \"y\" where an operator or the \")\" for the \"(\" at "
                      "character 5 is expected"},
        {"1 + k_2", "at character 5: unknown name \"k_2\"; did you mean \"k_1\"?"},
        {"1 + qqq", "at character 5: unknown name \"qqq\""},
        {"pie", "at character 1: unknown name \"pie\"; did you mean \"pi\"?"},
        {"e", "at character 1: unknown name \"e\""},
        {"sine(x)", "at character 1: unknown function \"sine\"; did you mean \"sin\"?"},
        {"x(2)", "at character 1: unknown function \"x\""},
        {"2*sin", "at character 3: function \"sin\" without \"(\""},
        {"sin()", "at character 5: \")\" where a number, a name or \"(\" is expected"},
        {"sin(x, y)", "at character 1: function \"sin\" takes 1 argument, not 2"},
        {"1+atan2(x)", "at character 3: function \"atan2\" takes 2 arguments, not 1"},
        {"max(x,y,z)", "at character 1: function \"max\" takes 2 arguments, not 3"},
        {"min(x,)", "at character 7: \")\" where a number, a name or \"(\" is expected"},
        {"sin(x", "at character 6: the expression ends where an operator or the \")\" for the "
                  "\"(\" at character 4 is expected"},
        {"1.2.3", "at character 1: \"1.2.3\" is not a number; a product needs \"*\""},
        {"10deg", "at character 1: \"10deg\" is not a number; did you mean \"10*deg\"?"},
        {"2x", "at character 1: \"2x\" is not a number; did you mean \"2*x\"?"},
        {"1 + 2sin(x)", "at character 5: \"2sin\" is not a number; did you mean \"2*sin\"?"},
        {"2qqq", "at character 1: \"2qqq\" is not a number; a product needs \"*\""},
        {"15\xC2\xB0", "at character 3: \"\xC2\xB0\" is not part of a number; did you mean "
                       "\"15*deg\"?"},
        {"5 %", "at character 3: \"%\" is not part of a number; did you mean \"5/100\"?"},
        {"x %", "at character 3: \"%\" where an operator or the end is expected"},
        {"x**2", "at character 2: \"**\" is not an operator; did you mean \"^\"?"},
        {"x* *2", "at character 4: \"*\" where a number, a name or \"(\" is expected"},
        {"0x10", "at character 1: \"0x10\" is not a number; a product needs \"*\""},
        {"1e", "at character 1: \"1e\" is not a number"},
        {"1e+x", "at character 1: \"1e\" is not a number"},
        {".", "at character 1: \".\" is not a number"},
        {"x*1e309", "at character 3: \"1e309\" is too large for a number"},
        {"inf", "at character 1: unknown name \"inf\"; did you mean \"if\"?"},
        {"nan", "at character 1: unknown name \"nan\"; did you mean \"tan\"?"},
        {"x,y", "at character 2: \",\" where an operator or the end is expected"},
        {"1,5", "at character 2: \",\" where an operator or the end is expected; did you mean "
                "\"1.5\"?"},
        {"1.2,5", "at character 4: \",\" where an operator or the end is expected"},
        {"x ** y", "at character 3: \"**\" is not an operator; did you mean \"^\"?"},
        {"x %y", "at character 3: \"%\" where an operator or the end is expected"},
        /* characters are counted, not bytes: omega, a minus sign of typography */
        {"x+\xCF\x89",
         "at character 3: \"\xCF\x89\" where a number, a name or \"(\" is expected"},
        {"x \xE2\x88\x92 \xCF\x89",
         "at character 3: \"\xE2\x88\x92\" where an operator or the end is expected"},
        {"\xCF\x89 y",
         "at character 1: \"\xCF\x89\" where a number, a name or \"(\" is expected"},
        {"x\x01", "at character 2: control character where an operator or the end is expected"},
    };
    expect_problems(t, MT_COUNT(rows), rows);
}

static void parse__problems_of_cases_are_named_with_their_place(mt_test *t)
{
    static const wrong_text rows[] = {
        {"x < y",
         "at character 3: \"<\" where an operator or the end (comparisons stand in the "
         "condition of if(condition, a, b)) is expected"},
        {"if(x, 1, 2)", "at character 4: a number where a condition is expected, such as "
                        "\"a > 0\""},
        {"if(1 < 2 < 3, 1, 2)",
         "at character 10: a second comparison; write \"a < b and b < c\""},
        {"if((1 < 2) + 1 < 3, 1, 2)", "at character 5: a condition where a number is expected"},
        {"if(1 and 2 < 3, 1, 2)",
         "at character 4: a number where a condition is expected, such as \"a > 0\""},
        {"if(not 2, 1, 2)",
         "at character 8: a number where a condition is expected, such as \"a > 0\""},
        {"if(1 = 2, 1, 2)",
         "at character 6: \"=\" is not part of a condition; did you mean \"==\"?"},
        {"if(1 < 2 && 2 < 3, 1, 2)",
         "at character 10: \"&\" is not part of a condition; did you mean \"and\"?"},
        {"if(1 != 2, 1, 2)",
         "at character 6: \"!=\" is not part of a condition; did you mean \"not a == b\"?"},
        {"if(1 < 2)", "at character 9: \")\" where \",\" behind the condition of if(condition, "
                      "a, b) is expected"},
        {"if(1 < 2, x)", "at character 12: \")\" where \",\" and what if(condition, a, b) is "
                         "where the condition is false is expected"},
        {"if(1 < 2, x, y, z)", "at character 15: \",\" where an operator or the \")\" for the "
                               "\"(\" at character 3 is expected"},
        {"if(abs(1 < 2) < 4, x, y)",
         "at character 10: \"<\" where an operator or the \")\" for "
         "the \"(\" at character 7 is expected"},
        {"if", "at character 1: function \"if\" without \"(\""},
    };
    expect_problems(t, MT_COUNT(rows), rows);
}

/* `open` n times, "x", `close` n times */
static void nest(char *text, size_t size, const char *open, const char *close, int n)
{
    size_t at = 0;
    for (int i = 0; i < n && at < size; i++) {
        at += (size_t)snprintf(text + at, size - at, "%s", open);
    }
    at += (size_t)snprintf(text + at, size - at, "x");
    for (int i = 0; i < n && at < size; i++) {
        at += (size_t)snprintf(text + at, size - at, "%s", close);
    }
}

static void parse__nesting_is_limited(mt_test *t)
{
    static const struct {
        const char *open;
        const char *close;
        int more;         /* levels at which the text still fits into MT_EXPR_MAX_LENGTH */
        const char *want; /* place of the first level too many */
    } rows[] = {
        {"(", ")", 2000, "at character 66: nested more than 64 levels deep"},
        {"-", "", 4000, "at character 66: nested more than 64 levels deep"},
        {"+", "", 4000, "at character 66: nested more than 64 levels deep"},
        {"2^", "", 2000, "at character 131: nested more than 64 levels deep"},
        {"abs(", ")", 800, "at character 261: nested more than 64 levels deep"},
        {"min(1,", ")", 580, "at character 389: nested more than 64 levels deep"},
    };
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].open);
        const int levels[] = {MT_EXPR_MAX_DEPTH, MT_EXPR_MAX_DEPTH + 1, rows[i].more};
        for (int k = 0; k < MT_COUNT(levels); k++) {
            char text[MT_EXPR_MAX_LENGTH + 1];
            nest(text, sizeof text, rows[i].open, rows[i].close, levels[k]);
            mt_expr e;
            mt_err err = {.code = MT_OK};
            CHECK_INT(t, parse_text(text, &mem, &e, &err), k == 0 ? MT_OK : MT_E_INPUT);
            CHECK_STR(t, err.text, k == 0 ? "" : rows[i].want);
        }
    }
    mt_arena_free(&mem);
}

static void parse__length_and_parts_are_limited(mt_test *t)
{
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    char text[MT_EXPR_MAX_LENGTH + 2];
    mt_expr e;
    mt_err err;
    memset(text, ' ', sizeof text);
    text[0] = 'x';
    text[MT_EXPR_MAX_LENGTH] = '\0';
    CHECK_INT(t, parse_text(text, &mem, &e, &err), MT_OK);
    text[MT_EXPR_MAX_LENGTH] = ' ';
    text[MT_EXPR_MAX_LENGTH + 1] = '\0';
    CHECK_INT(t, parse_text(text, &mem, &e, &err), MT_E_INPUT);
    CHECK_STR(t, err.text, "the expression is longer than 4096 bytes");

    /* a sum of n terms has 2n - 1 parts */
    for (int terms = 512; terms <= 513; terms++) {
        memset(text, 0, sizeof text);
        for (int i = 0; i < terms; i++) {
            memcpy(text + (ptrdiff_t)2 * i, i + 1 < terms ? "x+" : "x", i + 1 < terms ? 2 : 1);
        }
        const mt_status rc = parse_text(text, &mem, &e, &err);
        CHECK_INT(t, rc, terms == 512 ? MT_OK : MT_E_INPUT);
    }
    CHECK_STR(t, err.text, "at character 1026: the expression has more than 1024 parts");

    /* the longest name and the longest number */
    memset(text, 'x', MT_EXPR_MAX_LENGTH);
    text[MT_EXPR_MAX_LENGTH] = '\0';
    CHECK_INT(t, parse_text(text, &mem, &e, &err), MT_E_INPUT);
    CHECK(t, strncmp(err.text, "at character 1: unknown name \"xxxx", 34) == 0);
    CHECK(t, strlen(err.text) < 200);
    memset(text, '1', MT_EXPR_MAX_LENGTH);
    CHECK_INT(t, parse_text(text, &mem, &e, &err), MT_E_INPUT);
    text[0] = '.';
    CHECK_INT(t, parse_text(text, &mem, &e, &err), MT_OK);
    double value = 0.0;
    CHECK(t, mt_expr_is_constant(&e, &value));
    CHECK_NEAR(t, value, 1.0 / 9.0, DBL_EPSILON);
    mt_arena_free(&mem);
}

static void parse__names_are_reserved_and_constants_recognised(mt_test *t)
{
    int n = 0;
    const char *const *const names = mt_expr_names(&n);
    CHECK_INT(t, n, 29);
    for (int i = 0; i < n; i++) {
        mt_test_row(t, "%s", names[i]);
        /* "if" was free before there were cases, and is one only before a "(" */
        CHECK(t, mt_expr_reserved(names[i]) == (strcmp(names[i], "if") != 0));
    }
    CHECK(t, !mt_expr_reserved("e") && !mt_expr_reserved("x") && !mt_expr_reserved("sin_"));

    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_expr e;
    double value = 0.0;
    CHECK_INT(t, parse_text("2*max(3, -4)^2", &mem, &e, NULL), MT_OK);
    CHECK(t, mt_expr_is_constant(&e, &value) && value == 18.0);
    CHECK_INT(t, parse_text("1/0", &mem, &e, NULL), MT_OK);
    CHECK(t, mt_expr_is_constant(&e, &value) && !isfinite(value));
    CHECK_INT(t, parse_text("0*x", &mem, &e, NULL), MT_OK);
    CHECK(t, !mt_expr_is_constant(&e, &value));
    CHECK_INT(t, mt_expr_number(0.1, &mem, &e, NULL), MT_OK);
    CHECK(t, mt_expr_is_constant(&e, &value) && value == 0.1);
    /* without a lookup there are no parameters */
    mt_err err;
    CHECK_INT(t, mt_expr_parse("x", NULL, &mem, &e, &err), MT_E_INPUT);
    CHECK_STR(t, err.text, "at character 1: unknown name \"x\"");
    mt_arena_free(&mem);
}

static void parse__out_of_memory_is_reported(mt_test *t)
{
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 64, NULL) == MT_OK);
    mt_expr e;
    mt_err err = {.code = MT_OK};
    CHECK_INT(t, mt_expr_number(1.0, &mem, &e, &err), MT_OK); /* fills the block */
    if (mt_alloc_works()) {
        mt_alloc_fail_after(0);
        const mt_status number = mt_expr_number(1.0, &mem, &e, &err);
        const mt_status text = parse_text("x+y", &mem, &e, &err);
        mt_alloc_fail_after(-1);
        CHECK_INT(t, number, MT_E_MEMORY);
        CHECK_INT(t, text, MT_E_MEMORY);
    }
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(parse__precedence_and_associativity),
             MT_TEST(parse__functions_and_constants_have_their_values),
             MT_TEST(parse__numbers_are_rounded_correctly),
             MT_TEST(parse__problems_are_named_with_their_place),
             MT_TEST(parse__problems_of_cases_are_named_with_their_place),
             MT_TEST(parse__nesting_is_limited), MT_TEST(parse__length_and_parts_are_limited),
             MT_TEST(parse__names_are_reserved_and_constants_recognised),
             MT_TEST(parse__out_of_memory_is_reported))
