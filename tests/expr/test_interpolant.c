/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of interp(): GSL's Steffen interpolant first, what follows from monotony next, and
 * that enclosures hold every value and slope. */
#include <float.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <string.h>

#include "expr/interpolant.h"
#include "expr_fixture.h"
#include "mt_test.h"

enum { POINTS = 9 };

typedef struct points {
    double x[POINTS];
    double y[POINTS];
} points;

/* Rising, falling, flat and wavy ones, of sizes from 1e-6 to 1e6. */
static points any_points(uint64_t *state)
{
    points p;
    const double size = exp(28.0 * (uniform(state) - 0.5));
    const int form = (int)(uniform(state) * 4.0);
    double x = 10.0 * (uniform(state) - 0.5);
    double y = size * (uniform(state) - 0.5);
    for (int i = 0; i < POINTS; i++) {
        const double step = size * uniform(state) * (uniform(state) < 0.2 ? 0.0 : 1.0);
        const double sign = form == 0 ? 1.0 : form == 1 ? -1.0 : uniform(state) - 0.5;
        p.x[i] = x;
        p.y[i] = y;
        x += 1e-3 + (uniform(state) * uniform(state));
        y += form == 3 ? 0.0 : sign * step;
    }
    return p;
}

static double largest(const double *a)
{
    double most = 0.0;
    for (int i = 0; i < POINTS; i++) {
        most = fmax(most, fabs(a[i]));
    }
    return most;
}

static void interpolant__is_gsl_s(mt_test *t)
{
    enum { CURVES = 200, LOOKS = 60 };
    uint64_t state = 1;
    mt_arena mem;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    double worst = 0.0;
    double worst_slope = 0.0;
    double worst_second = 0.0;
    for (int c = 0; c < CURVES; c++) {
        const points p = any_points(&state);
        gsl_interp *const theirs = gsl_interp_alloc(gsl_interp_steffen, POINTS);
        CHECK(t, gsl_interp_init(theirs, p.x, p.y, POINTS) == 0);
        mt_interpolant ours;
        CHECK_INT(t, mt_interpolant_init(&ours, "c", POINTS, p.x, p.y, &mem, NULL), MT_OK);
        const double size = largest(p.y) + DBL_MIN;
        double steep = DBL_MIN;
        for (int k = 0; k + 1 < POINTS; k++) {
            steep = fmax(steep, fabs((p.y[k + 1] - p.y[k]) / (p.x[k + 1] - p.x[k])));
        }
        for (int i = 0; i < LOOKS; i++) {
            const double x =
                fmin(p.x[0] + (uniform(&state) * (p.x[POINTS - 1] - p.x[0])), p.x[POINTS - 1]);
            double at[3];
            mt_interpolant_at(&ours, x, at);
            worst =
                fmax(worst, fabs(at[0] - gsl_interp_eval(theirs, p.x, p.y, x, NULL)) / size);
            worst_slope =
                fmax(worst_slope,
                     fabs(at[1] - gsl_interp_eval_deriv(theirs, p.x, p.y, x, NULL)) / steep);
            worst_second = fmax(
                worst_second,
                fabs(at[2] - gsl_interp_eval_deriv2(theirs, p.x, p.y, x, NULL)) / steep * 1e-3);
        }
        gsl_interp_free(theirs);
    }
    CHECK(t, worst < 1e-14);
    CHECK(t, worst_slope < 1e-12);
    CHECK(t, worst_second < 1e-12);
    mt_arena_free(&mem);
}

static void interpolant__goes_through_its_points_and_not_beyond_them(mt_test *t)
{
    static const double x[] = {0, 1, 2, 3, 5};
    static const double y[] = {1, 4, 4, 0, 0};
    mt_arena mem;
    mt_interpolant c;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_interpolant_init(&c, "c", 5, x, y, &mem, NULL), MT_OK);
    double at[3];
    for (int i = 0; i < 5; i++) {
        mt_interpolant_at(&c, x[i], at);
        CHECK_NEAR(t, at[0], y[i], 0.0);
    }
    double before = 1.0;
    for (int i = 0; i <= 1000; i++) {
        mt_interpolant_at(&c, i * 1e-3, at);
        CHECK(t, at[0] >= before && at[0] <= 4.0 && at[1] >= 0.0);
        before = at[0];
        mt_interpolant_at(&c, 1.0 + (i * 1e-3), at);
        CHECK(t, at[0] == 4.0 && at[1] == 0.0);
    }
    /* an end that is written another way: 9*mm is one rounding above 9/1000 */
    static const double mm[] = {0, 2.0 / 1000.0, 9.0 / 1000.0};
    mt_interpolant shop;
    CHECK(t, 9.0 * 0.001 > mm[2]);
    CHECK_INT(t, mt_interpolant_init(&shop, "shop", 3, mm, y, &mem, NULL), MT_OK);
    mt_interpolant_at(&shop, 9.0 * 0.001, at);
    CHECK_NEAR(t, at[0], 4.0, 0.0);
    mt_interpolant_at(&shop, -1e-18, at);
    CHECK(t, at[0] == 1.0);
    mt_interpolant_at(&c, -1e-12, at);
    CHECK(t, isnan(at[0]) && isnan(at[1]) && isnan(at[2]));
    mt_interpolant_at(&c, 5.0 + 1e-12, at);
    CHECK(t, isnan(at[0]));
    /* two points are a line */
    CHECK_INT(t, mt_interpolant_init(&c, "c", 2, x, y, &mem, NULL), MT_OK);
    mt_interpolant_at(&c, 0.25, at);
    CHECK_NEAR(t, at[0], 1.75, 1e-15);
    CHECK_NEAR(t, at[1], 3.0, 1e-15);
    mt_arena_free(&mem);
}

static void interpolant__that_is_too_steep_is_refused(mt_test *t)
{
    static const double x[] = {0, 1e-300, 1};
    static const double y[] = {0, 1e10, 1};
    mt_arena mem;
    mt_interpolant c;
    mt_err err = {.code = MT_OK};
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_interpolant_init(&c, "c", 3, x, y, &mem, &err), MT_E_INPUT);
    CHECK_STR(t, err.text, "between x = 0 and 1e-300 the curve is too steep");
    mt_arena_free(&mem);
}

/* Boxes of all widths, also with ends on points; values and slopes within and at their ends. */
static void interpolant__enclosures_hold_all(mt_test *t)
{
    enum { CURVES = 300, BOXES = 30, LOOKS = 12 };
    uint64_t state = 7;
    mt_arena mem;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    int missed = 0;
    int looked = 0;
    double widest = 0.0; /* of a point's enclosure, in parts of the largest value */
    for (int c = 0; c < CURVES; c++) {
        const points p = any_points(&state);
        mt_interpolant ours;
        CHECK_INT(t, mt_interpolant_init(&ours, "c", POINTS, p.x, p.y, &mem, NULL), MT_OK);
        const double from = p.x[0];
        const double span = p.x[POINTS - 1] - from;
        for (int b = 0; b < BOXES; b++) {
            const int point = (int)(uniform(&state) * POINTS);
            const double lo = b % 3 == 0 ? p.x[point] : from + (uniform(&state) * span);
            const double width = b % 5 == 0 ? 0.0 : span * pow(uniform(&state), 8.0);
            const mt_interval a = {fmin(lo, p.x[POINTS - 1]),
                                   fmin(fmin(lo, p.x[POINTS - 1]) + width, p.x[POINTS - 1])};
            mt_interval v;
            mt_interval s;
            mt_interpolant_enclose(&ours, a, &v, &s);
            for (int i = 0; i < LOOKS; i++) {
                const double x = i == 0 ? a.lo
                                 : i == 1
                                     ? a.hi
                                     : fmin(a.lo + (uniform(&state) * (a.hi - a.lo)), a.hi);
                double at[3];
                mt_interpolant_at(&ours, x, at);
                looked++;
                missed += !mt_interval_has(v, at[0]) || !mt_interval_has(s, at[1]);
            }
            if (width == 0.0) {
                widest = fmax(widest, (v.hi - v.lo) / (largest(p.y) + DBL_MIN));
            }
        }
    }
    CHECK_INT(t, missed, 0);
    CHECK_INT(t, looked, CURVES * BOXES * LOOKS);
    CHECK(t, widest < 1e-12);
    mt_arena_free(&mem);
}

static const double curve_x[] = {0, 1, 2, 4};
static const double curve_y[] = {1, 2, 5, 6};

static mt_status parse_with_curve(const char *text, mt_interpolant *curve, mt_arena *mem,
                                  mt_expr *e, mt_err *err)
{
    const mt_expr_scope scope = {.lookup = find_param,
                                 .names = param_names,
                                 .n_names = N_PARAMS,
                                 .curves = curve,
                                 .n_curves = 1};
    return mt_expr_parse(text, &scope, mem, e, err);
}

static void interp__in_expressions(mt_test *t)
{
    mt_arena mem;
    mt_interpolant curve;
    mt_expr e;
    mt_program p;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_interpolant_init(&curve, "rubber", 4, curve_x, curve_y, &mem, NULL), MT_OK);
    CHECK_INT(
        t,
        parse_with_curve("2*interp('rubber', x*y) + interp(rubber, 1)", &curve, &mem, &e, NULL),
        MT_OK);
    CHECK_INT(t, mt_program_init(&p, 2, &mem, NULL), MT_OK);
    const mt_node params[N_PARAMS] = {mt_program_input(&p, 0, ADDR),
                                      mt_program_input(&p, 1, ADDR), MT_NO_NODE, MT_NO_NODE};
    const mt_node node = mt_program_expr(&p, &e, params, ADDR);
    CHECK_INT(t, mt_program_expr(&p, &e, params, ADDR), node); /* shared */
    CHECK_INT(t, mt_program_finish(&p, NULL), MT_OK);
    double *const v = mt_arena_f64(&mem, (size_t)p.count, 1);
    double *const g = mt_arena_f64(&mem, (size_t)p.count, 2);
    const double at[2] = {1.5, 0.8};
    double want[3];
    CHECK_INT(t, mt_program_gradient(&p, at, v, g, NULL, NULL), MT_OK);
    mt_interpolant_at(&curve, 1.5 * 0.8, want);
    CHECK_NEAR(t, v[node], (2.0 * want[0]) + 2.0, 1e-15);
    CHECK_NEAR(t, g[(2 * node) + 0], 2.0 * want[1] * 0.8, 1e-15);
    CHECK_NEAR(t, g[(2 * node) + 1], 2.0 * want[1] * 1.5, 1e-15);
    const double outside[2] = {5.0, 1.0};
    mt_err err = {.code = MT_OK};
    CHECK_INT(t, mt_program_eval(&p, outside, v, NULL, &err), MT_E_DOMAIN);
    CHECK_STR(t, err.text, "5 is outside of the curve \"rubber\", whose x goes from 0 to 4");
    mt_arena_free(&mem);
}

static void interp__wrong_texts(mt_test *t)
{
    static const struct {
        const char *text;
        const char *want;
    } rows[] = {
        {"interp(ruber, x)",
         "at character 8: unknown curve \"ruber\"; did you mean \"rubber\"?"},
        {"interp(quite_another, x)", "at character 8: unknown curve \"quite_another\""},
        {"interp(2, x)", "at character 8: \"2\" where the name of a curve is expected"},
        {"interp(rubber)",
         "at character 14: \")\" where \",\" and where to read the curve is expected"},
        {"interp('rubber\", x)",
         "at character 15: \"\"\" where the end of the curve's name in quotes is expected"},
        {"interp(rubber, x, y)", "at character 17: \",\" where an operator or the \")\" for "
                                 "the \"(\" at character 7 is "
                                 "expected"},
        {"interp", "at character 1: function \"interp\" without \"(\""},
        {"rubber", "at character 1: unknown name \"rubber\""},
    };
    mt_arena mem;
    mt_interpolant curve;
    CHECK(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_interpolant_init(&curve, "rubber", 4, curve_x, curve_y, &mem, NULL), MT_OK);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_expr e;
        mt_err err = {.code = MT_OK};
        mt_test_row(t, "%s", rows[i].text);
        CHECK_INT(t, parse_with_curve(rows[i].text, &curve, &mem, &e, &err), MT_E_INPUT);
        CHECK_STR(t, err.text, rows[i].want);
    }
    mt_expr e;
    mt_err err = {.code = MT_OK};
    CHECK_INT(t, parse_text("interp(rubber, x)", &mem, &e, &err), MT_E_INPUT);
    CHECK_STR(t, err.text,
              "at character 8: unknown curve \"rubber\" (the model has no \"curves\")");
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(interpolant__is_gsl_s),
             MT_TEST(interpolant__goes_through_its_points_and_not_beyond_them),
             MT_TEST(interpolant__that_is_too_steep_is_refused),
             MT_TEST(interpolant__enclosures_hold_all), MT_TEST(interp__in_expressions),
             MT_TEST(interp__wrong_texts))
