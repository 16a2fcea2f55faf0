/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Second derivatives of expressions of one input: values and first derivatives are those of
 * mt_program_gradient, second ones the slope of the first, by differences of fourth order. */
#include <math.h>
#include <string.h>

#include "expr/program.h"
#include "support/mt_test.h"

static int only_t(const void *context, const char *name, size_t length)
{
    (void)context;
    return length == 1 && name[0] == 't' ? 0 : -1;
}

static void compile(mt_test *t, const char *text, mt_arena *mem, mt_program *p, mt_node *node)
{
    mt_expr e;
    CHECK(t, mt_expr_parse(text, &(mt_expr_scope){.lookup = only_t}, mem, &e, NULL) == MT_OK);
    CHECK(t, mt_program_init(p, 1, mem, NULL) == MT_OK);
    const mt_node time = mt_program_input(p, 0, MT_NO_ADDR);
    *node = mt_program_expr(p, &e, &time, MT_NO_ADDR);
    CHECK(t, mt_program_finish(p, NULL) == MT_OK);
}

static double slope(mt_test *t, const mt_program *p, mt_node node, double at, double *v,
                    double *g)
{
    CHECK(t, mt_program_gradient(p, &at, v, g, NULL, NULL) == MT_OK);
    return g[node];
}

static void second__is_the_slope_of_the_slope(mt_test *t)
{
    static const char *const texts[] = {
        "3*t - 2",
        "t*t*t",
        "1/(1 + t)",
        "t^3",
        "t^1.7",
        "2^t",
        "t^t",
        "sqrt(t)",
        "cbrt(t)",
        "exp(-t)",
        "ln(t)",
        "log10(t)",
        "sin(3*t)",
        "cos(3*t)",
        "tan(t)",
        "asin(t/3)",
        "acos(t/3)",
        "atan(2*t)",
        "sinh(t)",
        "cosh(t)",
        "tanh(t)",
        "abs(t)",
        "atan2(t, 2)",
        "atan2(t^2, 1 + t)",
        "hypot(t, 2)",
        "hypot(t^2, 3*t)",
        "min(t, 3*t)",
        "max(t^2, t/9)",
        "(t*sin(t))/(2 + cos(t))",
        "-t^2",
        "pow(t, 2 + t)",
    };
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const double at = 0.7;
        const double h = 1e-3;
        mt_program p;
        mt_node node = MT_NO_NODE;
        mt_test_row(t, "%s", texts[i]);
        compile(t, texts[i], &mem, &p, &node);
        double(*const out)[3] = mt_arena_alloc(&mem, (size_t)p.count, sizeof *out);
        double *const v = mt_arena_f64(&mem, (size_t)p.count, 1);
        double *const g = mt_arena_f64(&mem, (size_t)p.count, 1);
        CHECK(t, mt_program_second(&p, at, out, NULL) == MT_OK);
        const double far =
            slope(t, &p, node, at + (2.0 * h), v, g) - slope(t, &p, node, at - (2.0 * h), v, g);
        const double near = slope(t, &p, node, at + h, v, g) - slope(t, &p, node, at - h, v, g);
        const double want = ((8.0 * near) - far) / (12.0 * h);
        CHECK_NEAR_ABS(t, out[node][1], slope(t, &p, node, at, v, g),
                       1e-14 * (1.0 + fabs(g[node])));
        CHECK_NEAR_ABS(t, out[node][0], v[node], 1e-15 * (1.0 + fabs(v[node])));
        CHECK_NEAR_ABS(t, out[node][2], want, 1e-8 * (1.0 + fabs(want)));
    }
    mt_arena_free(&mem);
}

static void second__has_no_value_where_there_is_none(mt_test *t)
{
    mt_arena mem = {0};
    mt_err err = {.text = ""};
    mt_program p;
    mt_node node = MT_NO_NODE;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    compile(t, "sqrt(t - 1)", &mem, &p, &node);
    double(*const out)[3] = mt_arena_alloc(&mem, (size_t)p.count, sizeof *out);
    CHECK_INT(t, mt_program_second(&p, 0.5, out, &err), MT_E_DOMAIN);
    CHECK(t, strstr(err.text, "sqrt") != NULL);
    CHECK_INT(t, mt_program_second(&p, 1.0, out, &err), MT_E_DOMAIN); /* a vertical tangent */
    CHECK_INT(t, mt_program_second(&p, 1.5, out, &err), MT_OK);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(second__is_the_slope_of_the_slope),
             MT_TEST(second__has_no_value_where_there_is_none))
