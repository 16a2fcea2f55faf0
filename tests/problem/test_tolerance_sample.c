/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The least and greatest of numbers over a box, sampled, against closed forms: at corners, also
 * of more inputs than all corners are tried of, inside, on ridges that no axis and no slope
 * leads along, and of numbers that do not exist somewhere.
 */
#include <math.h>

#include "mt_test.h"
#include "problem/tolerance.h"

enum { MOST = 8 };

typedef struct function {
    const char *name;
    int n;
    double (*value)(const double *x);
    void (*slope)(const double *x, double *slope);
    double least; /* over [0, 1]^n, but the last input of an even n stands at 0.5 */
    double greatest;
    double tolerance; /* of what was found: of the span */
} function;

/* Rises with some inputs, falls with others. */
static double plane(const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < MOST - 1; i++) {
        sum += (i == 2 ? -1.0 : 1.0) * x[i];
    }
    return sum;
}

static void plane_slope(const double *x, double *slope)
{
    (void)x;
    for (int i = 0; i < MOST; i++) {
        slope[i] = i == MOST - 1 ? 0.0 : i == 2 ? -1.0 : 1.0;
    }
}

static double bowl(const double *x)
{
    const double a = x[0] - 0.31;
    const double b = x[1] - 0.77;
    return (a * a) + (a * b) + (2.0 * b * b);
}

static void bowl_slope(const double *x, double *slope)
{
    const double a = x[0] - 0.31;
    const double b = x[1] - 0.77;
    slope[0] = (2.0 * a) + b;
    slope[1] = a + (4.0 * b);
    slope[2] = 0.0;
}

/* As two frequencies that meet, of which the lower one is asked for: greatest on a line across
 * the box, along which it rises to one point. */
static double ridge(const double *x)
{
    return -fabs((3.0 * (x[0] - 0.62)) - (2.0 * (x[1] - 0.43))) -
           (0.3 * (x[0] - 0.62) * (x[0] - 0.62));
}

static void ridge_slope(const double *x, double *slope)
{
    const double side = (3.0 * (x[0] - 0.62)) - (2.0 * (x[1] - 0.43)) > 0.0 ? 1.0 : -1.0;
    slope[0] = (-3.0 * side) - (0.6 * (x[0] - 0.62));
    slope[1] = 2.0 * side;
    slope[2] = 0.0;
}

/* Each input alone has its extreme inside. */
static double wave(const double *x)
{
    return sin(2.0 * x[0]) + cos(3.0 * x[1]);
}

static void wave_slope(const double *x, double *slope)
{
    slope[0] = 2.0 * cos(2.0 * x[0]);
    slope[1] = -3.0 * sin(3.0 * x[1]);
    slope[2] = 0.0;
}

static const function functions[] = {
    {"plane", MOST, plane, plane_slope, -1.0, 6.0, 1e-12},
    {"bowl", 3, bowl, bowl_slope, 0.0, 0.0961 + 0.2387 + 1.1858, 1e-6},
    {"ridge", 3, ridge, ridge_slope, -3.0 - 0.11532, 0.0, 5e-3},
    {"wave", 3, wave, wave_slope, -0.98999249660044545, 2.0, 1e-6},
};

typedef struct probe {
    const function *f;
    double at[MOST];
    double bad; /* no value where x[0] is above this */
} probe;

static mt_status eval(void *context, const double *x, bool with_gradient, double *value,
                      mt_err *err)
{
    probe *const p = context;
    (void)with_gradient;
    for (int i = 0; i < p->f->n; i++) {
        p->at[i] = x[i];
    }
    value[0] = p->f->value(x);
    return x[0] > p->bad ? mt_fail(err, MT_E_DOMAIN, "no value") : MT_OK;
}

static mt_status slope(void *context, int k, double *to, mt_err *err)
{
    probe *const p = context;
    (void)k;
    (void)err;
    p->f->slope(p->at, to);
    return MT_OK;
}

static bool sample(mt_test *t, const function *f, double bad, mt_arena *mem,
                   mt_tolerance_range *out)
{
    double lo[MOST];
    double hi[MOST];
    probe p = {.f = f, .bad = bad};
    for (int i = 0; i < f->n; i++) {
        const bool fixed = f->n % 2 == 0 && i == f->n - 1;
        lo[i] = fixed ? 0.5 : 0.0;
        hi[i] = fixed ? 0.5 : 1.0;
    }
    const mt_tolerance_probe q = {.n = f->n,
                                  .lo = lo,
                                  .hi = hi,
                                  .m = 1,
                                  .n_descend = 1,
                                  .context = &p,
                                  .eval = eval,
                                  .slope = slope};
    return CHECK_INT(t, mt_tolerance_range_init(f->n, mem, out, NULL), MT_OK) &&
           CHECK_INT(t, mt_tolerance_sample(&q, mem, out, NULL), MT_OK);
}

static void sample__finds_extremes_in_closed_form(mt_test *t)
{
    mt_arena mem = {0};
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(functions); i++) {
        const function *const f = &functions[i];
        mt_tolerance_range r;
        mt_test_row(t, "%s", f->name);
        if (sample(t, f, HUGE_VAL, &mem, &r)) {
            const double room = f->tolerance * (f->greatest - f->least);
            CHECK_NEAR_ABS(t, r.value[MT_LOWEST], f->least, room);
            CHECK_NEAR_ABS(t, r.value[MT_HIGHEST], f->greatest, room);
            for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
                CHECK(t, r.value[side] == f->value(r.at[side]));
                for (int k = 0; k < f->n; k++) {
                    CHECK(t, r.at[side][k] >= 0.0 && r.at[side][k] <= 1.0);
                }
            }
        }
    }
    mt_arena_free(&mem);
}

/* What has no value somewhere has neither a least nor a greatest. */
static void sample__of_what_does_not_exist_somewhere_is_nothing(mt_test *t)
{
    mt_arena mem = {0};
    mt_tolerance_range r;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    for (int i = 0; i < MT_COUNT(functions); i++) {
        mt_test_row(t, "%s", functions[i].name);
        if (sample(t, &functions[i], 0.9, &mem, &r)) {
            CHECK(t, isnan(r.value[MT_LOWEST]) && isnan(r.value[MT_HIGHEST]));
            CHECK(t, r.at[MT_LOWEST][0] > 0.9 && r.at[MT_HIGHEST][0] > 0.9);
        }
    }
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(sample__finds_extremes_in_closed_form),
             MT_TEST(sample__of_what_does_not_exist_somewhere_is_nothing))
