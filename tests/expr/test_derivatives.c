/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>

#include "expr_fixture.h"
#include "mt_slope.h"
#include "mt_test.h"

static const double LN_10 = 2.302585092994045684;

typedef struct derivative_row {
    const char *text; /* of x and y */
    double x;
    double y;
    double dx; /* closed form */
    double dy;
} derivative_row;

static double value_at(const void *ctx, int n, const double *x)
{
    const fixture *const f = ctx;
    (void)n;
    return mt_program_eval(&f->p, x, f->value, NULL, NULL) == MT_OK ? f->value[f->root]
                                                                    : nan("");
}

/* The gradient against the closed form, against differences, and a wrong one against
 * differences. */
static void check_row(mt_test *t, const derivative_row *row)
{
    double at[N_PARAMS] = {row->x, row->y, 0.0, 0.0};
    const double want[2] = {row->dx, row->dy};
    fixture f;
    mt_err err = {.code = MT_OK};
    if (!CHECK(t, fixture_init(&f, row->text, &err)) ||
        !CHECK_INT(t, mt_program_gradient(&f.p, at, f.value, f.grad, NULL, &err), MT_OK)) {
        fixture_free(&f);
        return;
    }
    for (int i = 0; i < 2; i++) {
        const double got = root_row(&f, f.grad)[i];
        CHECK_NEAR_ABS(t, got, want[i], 16.0 * DBL_EPSILON * (fabs(want[i]) + DBL_MIN));
        const double step = 1e-3 * fmax(fabs(at[i]), 0.1);
        CHECK(t, mt_slope_agrees(value_at, &f, N_PARAMS, at, i, got, step, 2.0 * DBL_EPSILON));
        const double wrong = got + 1e-6 * fmax(fabs(got), 0.1);
        CHECK(t,
              !mt_slope_agrees(value_at, &f, N_PARAMS, at, i, wrong, step, 2.0 * DBL_EPSILON));
    }
    fixture_free(&f);
}

static void derivatives__of_every_function_match_the_closed_form(mt_test *t)
{
    const double x = 0.7;
    const double y = -1.3;
    const double s = x * x + y * y;
    const derivative_row rows[] = {
        {"-x", x, y, -1.0, 0.0},
        {"sqrt(x)", x, y, 0.5 / sqrt(x), 0.0},
        {"cbrt(y)", x, y, 0.0, 1.0 / (3.0 * pow(1.3, 2.0 / 3.0))},
        {"exp(x)", x, y, exp(x), 0.0},
        {"ln(x)", x, y, 1.0 / x, 0.0},
        {"log10(x)", x, y, 1.0 / (x * LN_10), 0.0},
        {"sin(y)", x, y, 0.0, cos(y)},
        {"cos(y)", x, y, 0.0, -sin(y)},
        {"tan(y)", x, y, 0.0, 1.0 / (cos(y) * cos(y))},
        {"asin(x)", x, y, 1.0 / sqrt(1.0 - x * x), 0.0},
        {"acos(x)", x, y, -1.0 / sqrt(1.0 - x * x), 0.0},
        {"atan(y)", x, y, 0.0, 1.0 / (1.0 + y * y)},
        {"sinh(y)", x, y, 0.0, cosh(y)},
        {"cosh(y)", x, y, 0.0, sinh(y)},
        {"tanh(y)", x, y, 0.0, 1.0 / (cosh(y) * cosh(y))},
        {"abs(y)", x, y, 0.0, -1.0},
        {"abs(x)", x, y, 1.0, 0.0},
        {"x+y", x, y, 1.0, 1.0},
        {"x-y", x, y, 1.0, -1.0},
        {"x*y", x, y, y, x},
        {"x*x", x, y, 2.0 * x, 0.0},
        {"x/y", x, y, 1.0 / y, -x / (y * y)},
        {"x^y", x, y, y * pow(x, y - 1.0), log(x) * pow(x, y)},
        {"y^3", x, y, 0.0, 3.0 * y * y},
        {"y^-2", x, y, 0.0, -2.0 / (y * y * y)},
        {"x^2.5", x, y, 2.5 * pow(x, 1.5), 0.0},
        {"2^y", x, y, 0.0, log(2.0) * exp2(y)},
        {"atan2(y,x)", x, y, -y / s, x / s},
        {"atan2(x,y)", x, y, y / s, -x / s},
        {"min(x,y)", x, y, 0.0, 1.0},
        {"max(x,y)", x, y, 1.0, 0.0},
        {"hypot(x,y)", x, y, x / sqrt(s), y / sqrt(s)},
        {"tanh(15*x)", x, y, 15.0 / (cosh(10.5) * cosh(10.5)), 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        check_row(t, &rows[i]);
    }
}

static void derivatives__of_nested_expressions_follow_the_chain_rule(mt_test *t)
{
    const double x = 1.7;
    const double y = 0.4;
    const double r = sqrt(x * x + y);
    const derivative_row rows[] = {
        {"sqrt(x^2+y)", x, y, x / r, 0.5 / r},
        {"sin(x*y)*x", x, y, sin(x * y) + x * y * cos(x * y), x * x * cos(x * y)},
        {"exp(-x)/(1+y)^2", x, y, -exp(-x) / (1.4 * 1.4), -2.0 * exp(-x) / (1.4 * 1.4 * 1.4)},
        {"(x*y)^2 + (x*y)", x, y, 2.0 * x * y * y + y, 2.0 * x * x * y + x},
        {"0.05*x^3/12", x, y, 0.0125 * x * x, 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        check_row(t, &rows[i]);
    }
}

/* Where there is a choice, the header says which: these are exact. */
static void derivatives__at_kinks_and_powers_of_zero_are_those_documented(mt_test *t)
{
    static const derivative_row rows[] = {
        {"abs(x)", 0.0, 0.0, 1.0, 0.0},   {"min(x,y)", 1.0, 1.0, 1.0, 0.0},
        {"max(x,y)", 1.0, 1.0, 1.0, 0.0}, {"min(y,x)", 1.0, 1.0, 0.0, 1.0},
        {"x^2", 0.0, 0.0, 0.0, 0.0},      {"pow(x,1+0*y)", 0.0, 0.0, 1.0, 0.0},
        {"x^3", -2.0, 0.0, 12.0, 0.0},    {"x^-1", -2.0, 0.0, -0.25, 0.0},
        {"0^y", 0.0, 2.0, 0.0, 0.0},      {"x^1.5", 0.0, 0.0, 0.0, 0.0},
        {"x^(2*y)", 0.0, 0.5, 1.0, 0.0}, /* 0^1 with a variable exponent */
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s at %g, %g", rows[i].text, rows[i].x, rows[i].y);
        const double at[N_PARAMS] = {rows[i].x, rows[i].y, 0.0, 0.0};
        fixture f;
        mt_err err = {.code = MT_OK};
        if (CHECK(t, fixture_init(&f, rows[i].text, &err))) {
            CHECK_INT(t, mt_program_gradient(&f.p, at, f.value, f.grad, NULL, &err), MT_OK);
            CHECK(t, root_row(&f, f.grad)[0] == rows[i].dx);
            CHECK(t, root_row(&f, f.grad)[1] == rows[i].dy);
        }
        fixture_free(&f);
    }
}

static void derivatives__that_do_not_exist_are_errors(mt_test *t)
{
    static const struct {
        const char *text; /* at x = 0, y = -2 */
        const char *want;
    } rows[] = {
        {"sqrt(x)", "sqrt(0) has no finite derivative"},
        {"cbrt(x)", "cbrt(0) has no finite derivative"},
        {"x^0.5", "0 ^ 0.5 has no finite derivative"},
        {"x^x", "0 ^ 0 has no finite derivative"},
        {"y^(x+2)", "-2 ^ 2 has no finite derivative"}, /* exists at integers only */
        {"hypot(x,0)", "hypot(0, 0) has no finite derivative"},
        {"atan2(x,0*y)", "atan2(0, 0) has no finite derivative"},
        {"asin(1+x)", "asin(1) has no finite derivative"},
        {"acos(1+x)", "acos(1) has no finite derivative"},
        {"sqrt(x^2)", "sqrt(0) has no finite derivative"},
    };
    static const double at[N_PARAMS] = {0.0, -2.0, 0.0, 0.0};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        fixture f;
        mt_err err = {.code = MT_OK};
        if (CHECK(t, fixture_init(&f, rows[i].text, &err))) {
            mt_node bad = MT_NO_NODE;
            CHECK_INT(t, mt_program_eval(&f.p, at, f.value, NULL, &err), MT_OK);
            CHECK_INT(t, mt_program_gradient(&f.p, at, f.value, f.grad, &bad, &err),
                      MT_E_DOMAIN);
            CHECK_STR(t, err.text, rows[i].want);
            CHECK(t, bad >= 0 && f.p.nodes[bad].addr == ADDR);
        }
        fixture_free(&f);
    }
}

/* A function that has no derivative is no problem where it depends on nothing. */
static void derivatives__of_constants_need_not_exist(mt_test *t)
{
    static const double at[N_PARAMS] = {3.0, 0.0, 0.0, 0.0};
    fixture f;
    mt_err err = {.code = MT_OK};
    if (CHECK(t, fixture_init(&f, "x*abs(sqrt(0)) + x^2 + hypot(0,0) + 0^0*x", &err))) {
        CHECK_INT(t, mt_program_gradient(&f.p, at, f.value, f.grad, NULL, &err), MT_OK);
        CHECK(t, root_row(&f, f.grad)[0] == 7.0);
    }
    fixture_free(&f);
}

MT_TEST_MAIN(MT_TEST(derivatives__of_every_function_match_the_closed_form),
             MT_TEST(derivatives__of_nested_expressions_follow_the_chain_rule),
             MT_TEST(derivatives__at_kinks_and_powers_of_zero_are_those_documented),
             MT_TEST(derivatives__that_do_not_exist_are_errors),
             MT_TEST(derivatives__of_constants_need_not_exist))
