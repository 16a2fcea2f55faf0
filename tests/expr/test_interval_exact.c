/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Intervals against 113 bits: what the exact operation makes of any numbers within the operands
 * lies within the enclosure (a double that was rounded the same way would not show a missing
 * outward rounding), and an enclosure is no wider than its promise.
 */
#include <float.h>
#include <math.h>

#include "expr/exact.h"
#include "expr/interval.h"
#include "mt_test.h"
#include "support/mt_random.h"

typedef struct domain {
    mt_op op;
    double x[2];
    double y[2];
} domain;

/* Where the operation exists, away from where 113 bits lose its digits. */
static const domain domains[] = {
    {MT_OP_NEG, {-9, 9}, {0, 0}},        {MT_OP_SQRT, {0, 9}, {0, 0}},
    {MT_OP_CBRT, {-9, 9}, {0, 0}},       {MT_OP_EXP, {-9, 9}, {0, 0}},
    {MT_OP_LN, {1e-3, 9}, {0, 0}},       {MT_OP_LOG10, {1e-3, 1e3}, {0, 0}},
    {MT_OP_SIN, {-20, 20}, {0, 0}},      {MT_OP_COS, {-20, 20}, {0, 0}},
    {MT_OP_TAN, {-20, 20}, {0, 0}},      {MT_OP_ASIN, {-0.99, 0.99}, {0, 0}},
    {MT_OP_ACOS, {-0.99, 0.99}, {0, 0}}, {MT_OP_ATAN, {-9, 9}, {0, 0}},
    {MT_OP_SINH, {-9, 9}, {0, 0}},       {MT_OP_COSH, {-9, 9}, {0, 0}},
    {MT_OP_TANH, {-9, 9}, {0, 0}},       {MT_OP_ABS, {-9, 9}, {0, 0}},
    {MT_OP_ADD, {-9, 9}, {-9, 9}},       {MT_OP_SUB, {-9, 9}, {-9, 9}},
    {MT_OP_MUL, {-9, 9}, {-9, 9}},       {MT_OP_DIV, {-9, 9}, {0.1, 9}},
    {MT_OP_DIV, {-9, 9}, {-9, -0.1}},    {MT_OP_POW, {0.1, 9}, {-3, 3}},
    {MT_OP_POW, {-9, 9}, {2, 2}},        {MT_OP_POW, {-9, 9}, {3, 3}},
    {MT_OP_POW, {-9, -0.1}, {-2, -2}},   {MT_OP_POW, {-9, -0.1}, {-3, -3}},
    {MT_OP_ATAN2, {-9, 9}, {0.1, 9}},    {MT_OP_ATAN2, {0.1, 9}, {-9, 9}},
    {MT_OP_ATAN2, {-9, -0.1}, {-9, 9}},  {MT_OP_MIN, {-9, 9}, {-9, 9}},
    {MT_OP_MAX, {-9, 9}, {-9, 9}},       {MT_OP_HYPOT, {-9, 9}, {-9, 9}},
};

enum { BOXES = 100, POINTS = 4 };

/* A point, a needle, a short or a long part of the range; now and then with an end at a whole
 * number, 0 among them. */
static mt_interval any_part(mt_random *r, const double *range)
{
    static const double widths[] = {0.0, 1e-15, 1e-7, 0.1, 1.0};
    const double size = range[1] - range[0];
    const double width = size * widths[mt_random_int(r, MT_COUNT(widths))];
    double lo = mt_random_in(r, range[0], range[1] - width);
    double hi = fmin(lo + (width * mt_random_in(r, 0.0, 1.0)), range[1]);
    if (mt_random_int(r, 4) == 0 && floor(hi) >= range[0]) {
        hi = floor(hi);
        lo = fmin(lo, hi);
    }
    if (mt_random_int(r, 4) == 0 && ceil(lo) <= hi) {
        lo = ceil(lo);
    }
    return (mt_interval){lo, hi};
}

static double any_within(mt_random *r, mt_interval a)
{
    const int where = mt_random_int(r, 4);
    return where == 0   ? a.lo
           : where == 1 ? a.hi
                        : fmin(fmax(mt_random_in(r, a.lo, a.hi), a.lo), a.hi);
}

static bool holds(mt_interval a, quad x)
{
    return (quad)a.lo <= x && x <= (quad)a.hi;
}

/* What the difference that gives a derivative, and 113 bits elsewhere, leave open. */
static bool nearly_holds(mt_interval a, quad x)
{
    const quad open = (quad)1e-19 * (1 + quad_abs(x));
    return (quad)a.lo - open <= x && x <= (quad)a.hi + open;
}

static bool has_kink(mt_op op, double x, double y)
{
    const bool chooses = op == MT_OP_MIN || op == MT_OP_MAX; /* has no partials of its own */
    const bool corner = op == MT_OP_ABS || op == MT_OP_SQRT || op == MT_OP_CBRT;
    return chooses || (corner && x == 0.0) || (op == MT_OP_HYPOT && x == 0.0 && y == 0.0);
}

static void interval__holds_what_113_bits_make_of_points_within(mt_test *t)
{
    mt_random r = mt_random_seed(28);
    for (int i = 0; i < MT_COUNT(domains); i++) {
        const domain *const d = &domains[i];
        for (int k = 0; k < BOXES; k++) {
            const mt_interval a = any_part(&r, d->x);
            const mt_interval b = any_part(&r, d->y);
            const mt_interval v = mt_interval_op(d->op, a, b);
            const mt_interval_partials p = mt_interval_op_partials(d->op, a, b, v);
            for (int j = 0; j < POINTS; j++) {
                const double x = any_within(&r, a);
                const double y = any_within(&r, b);
                mt_test_row(t, "%s of [%a, %a], [%a, %a] at %a, %a", mt_op_name(d->op), a.lo,
                            a.hi, b.lo, b.hi, x, y);
                CHECK(t, holds(v, exact_op(d->op, (quad)x, (quad)y)));
                if (!has_kink(d->op, x, y)) {
                    CHECK(t, nearly_holds(p.a, exact_partial(d->op, (quad)x, (quad)y, false)));
                    CHECK(t,
                          mt_op_operands(d->op) == 1 || (d->op == MT_OP_POW && x <= 0.0) ||
                              nearly_holds(p.b, exact_partial(d->op, (quad)x, (quad)y, true)));
                }
            }
        }
    }
}

/* Units of the last place between a bound and what it bounds. */
static double ulps(double bound, quad x)
{
    const double at = fabs((double)x);
    const double size = nextafter(at, HUGE_VAL) - at;
    return (double)(quad_abs((quad)bound - x) / (quad)size);
}

/* Points only: + - * / are rounded to a neighbour, and not at all where the result is a double;
 * functions are widened by MT_INTERVAL_ULPS. */
static void interval__of_points_is_as_narrow_as_it_says(mt_test *t)
{
    mt_random r = mt_random_seed(29);
    for (int i = 0; i < MT_COUNT(domains); i++) {
        const domain *const d = &domains[i];
        const bool arithmetic = (d->op >= MT_OP_ADD && d->op <= MT_OP_DIV) ||
                                d->op == MT_OP_NEG || d->op == MT_OP_ABS ||
                                d->op == MT_OP_MIN || d->op == MT_OP_MAX;
        for (int k = 0; k < BOXES; k++) {
            const bool whole = k % 3 == 0; /* numbers whose sums and products are doubles */
            const double x = whole ? rint(mt_random_in(&r, d->x[0], d->x[1]))
                                   : mt_random_in(&r, d->x[0], d->x[1]);
            const double y = whole ? rint(mt_random_in(&r, d->y[0], d->y[1]))
                                   : mt_random_in(&r, d->y[0], d->y[1]);
            const mt_interval v =
                mt_interval_op(d->op, mt_interval_of(x, x), mt_interval_of(y, y));
            const quad want = exact_op(d->op, (quad)x, (quad)y);
            if (x < d->x[0] || x > d->x[1] || y < d->y[0] || y > d->y[1] || want == 0) {
                continue; /* rounded out of the range */
            }
            mt_test_row(t, "%s of %a, %a", mt_op_name(d->op), x, y);
            const bool is_double = arithmetic && (quad)(double)want == want;
            const double most = is_double    ? 0.0
                                : arithmetic ? 2.0
                                             : MT_INTERVAL_ULPS + MT_LIBM_ULPS;
            CHECK(t, ulps(v.lo, want) <= most);
            CHECK(t, ulps(v.hi, want) <= most);
        }
    }
}

/* The extremes over an interval: 1 where a crest (at `crest` + 2 k pi) lies within, else that
 * of the ends. */
static quad wave_extreme(mt_op op, mt_interval a, quad crest, quad extreme)
{
    const quad turn = 2 * exact_pi();
    const quad at_lo = exact_op(op, (quad)a.lo, 0);
    const quad at_hi = exact_op(op, (quad)a.hi, 0);
    const double first = ceil((double)(((quad)a.lo - crest) / turn));
    const bool within = crest + (turn * (quad)first) <= (quad)a.hi;
    return within ? extreme : (at_lo > at_hi) == (extreme > 0) ? at_lo : at_hi;
}

static void interval__of_a_wave_ends_at_its_crests_and_nowhere_else(mt_test *t)
{
    static const mt_op ops[] = {MT_OP_SIN, MT_OP_COS};
    mt_random r = mt_random_seed(30);
    for (int k = 0; k < 2000; k++) {
        const mt_op op = ops[k % 2];
        const quad crest = op == MT_OP_SIN ? exact_pi() / 2 : 0;
        const double lo = mt_random_in(&r, -40.0, 40.0);
        const mt_interval a = {lo, lo + mt_random_in(&r, 0.0, k % 4 < 2 ? 1.0 : 7.0)};
        const mt_interval v = mt_interval_op(op, a, a);
        mt_test_row(t, "%s of [%a, %a]", mt_op_name(op), a.lo, a.hi);
        /* near 0 the ends are known to the size of the argument's rounding only */
        const double near = (MT_INTERVAL_ULPS + MT_LIBM_ULPS) * DBL_EPSILON;
        CHECK_NEAR_ABS(t, v.hi, (double)wave_extreme(op, a, crest, 1), near);
        CHECK_NEAR_ABS(t, v.lo, (double)wave_extreme(op, a, crest + exact_pi(), -1), near);
        CHECK(t, v.lo >= -1.0 && v.hi <= 1.0);
    }
}

/* tan: everything where a pole lies within, its ends elsewhere, up to a part in a million of a
 * pole. */
static void interval__of_a_tangent_knows_its_poles(mt_test *t)
{
    for (int k = -12; k <= 12; k++) {
        const double pole = (k + 0.5) * (double)exact_pi();
        const mt_interval across = {pole - 0.1, pole + 1e-6};
        const mt_interval before = {pole - 3.0, pole - 1e-6};
        const mt_interval after = {pole + 1e-6, pole + 3.0};
        mt_test_row(t, "the pole at %.3f", pole);
        CHECK(t, mt_interval_op(MT_OP_TAN, across, across).hi == HUGE_VAL);
        CHECK(t, mt_interval_op(MT_OP_TAN, across, across).lo == -HUGE_VAL);
        CHECK_NEAR(t, mt_interval_op(MT_OP_TAN, before, before).hi, 1e6, 1e-6);
        CHECK_NEAR(t, mt_interval_op(MT_OP_TAN, after, after).lo, -1e6, 1e-6);
        const mt_interval wide = {pole + 0.1, pole + 3.3};
        CHECK(t, mt_interval_op(MT_OP_TAN, wide, wide).hi == HUGE_VAL);
    }
}

/* What has a kink has the slopes of both its sides where it lies on an end, too. At 0 itself
 * the slope of abs is 1 by convention. */
static void interval__slopes_at_a_kink_are_those_of_both_sides(mt_test *t)
{
    static const struct {
        double x[2];
        double want[2];
    } rows[] = {
        {{-2, -1}, {-1, -1}},
        {{-1, 0}, {-1, 1}},
        {{0, 0}, {1, 1}},
        {{0, 1}, {1, 1}},
        {{-1, 1}, {-1, 1}},
        {{1, 2}, {1, 1}},
        {{-1, -0.0}, {-1, 1}},
        {{-DBL_TRUE_MIN, 1}, {-1, 1}},
        {{-1, -DBL_TRUE_MIN}, {-1, -1}},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const mt_interval a = {rows[i].x[0], rows[i].x[1]};
        const mt_interval v = mt_interval_op(MT_OP_ABS, a, a);
        const mt_interval d = mt_interval_op_partials(MT_OP_ABS, a, a, v).a;
        mt_test_row(t, "abs of [%g, %g]", a.lo, a.hi);
        CHECK(t, d.lo == rows[i].want[0] && d.hi == rows[i].want[1]);
    }
}

/* What may leave its domain, by however little, is the whole line: nothing is known. */
static void interval__beyond_a_domain_is_the_whole_line(mt_test *t)
{
    static const struct {
        mt_op op;
        double x[2];
        double y[2];
        bool all;
    } rows[] = {
        {MT_OP_SQRT, {0, 1}, {0, 0}, false},
        {MT_OP_SQRT, {-DBL_TRUE_MIN, 1}, {0, 0}, true},
        {MT_OP_LN, {DBL_TRUE_MIN, 1}, {0, 0}, false},
        {MT_OP_LN, {0, 1}, {0, 0}, true},
        {MT_OP_LOG10, {0, 1}, {0, 0}, true},
        {MT_OP_ASIN, {-1, 1}, {0, 0}, false},
        {MT_OP_ASIN, {-1 - DBL_EPSILON, 1}, {0, 0}, true},
        {MT_OP_ASIN, {-1, 1 + DBL_EPSILON}, {0, 0}, true},
        {MT_OP_ACOS, {-1, 1}, {0, 0}, false},
        {MT_OP_ACOS, {-1, 1 + DBL_EPSILON}, {0, 0}, true},
        {MT_OP_DIV, {1, 2}, {DBL_MIN, 1}, false},
        {MT_OP_DIV, {1, 2}, {0, 1}, true},
        {MT_OP_DIV, {1, 2}, {-1, 0}, true},
        {MT_OP_POW, {0, 2}, {0.5, 1.5}, false},
        {MT_OP_POW, {0, 2}, {0, 1.5}, true},
        {MT_OP_POW, {-DBL_TRUE_MIN, 2}, {0.5, 1.5}, true},
        {MT_OP_POW, {0, 2}, {-1, -1}, true},
        {MT_OP_POW, {-1, 0}, {-2, -2}, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const mt_interval a = {rows[i].x[0], rows[i].x[1]};
        const mt_interval b = {rows[i].y[0], rows[i].y[1]};
        const mt_interval v = mt_interval_op(rows[i].op, a, b);
        mt_test_row(t, "%s of [%g, %g], [%g, %g]", mt_op_name(rows[i].op), a.lo, a.hi, b.lo,
                    b.hi);
        CHECK_INT(t, v.lo == -HUGE_VAL && v.hi == HUGE_VAL, rows[i].all);
    }
}

MT_TEST_MAIN(MT_TEST(interval__holds_what_113_bits_make_of_points_within),
             MT_TEST(interval__of_points_is_as_narrow_as_it_says),
             MT_TEST(interval__of_a_wave_ends_at_its_crests_and_nowhere_else),
             MT_TEST(interval__of_a_tangent_knows_its_poles),
             MT_TEST(interval__slopes_at_a_kink_are_those_of_both_sides),
             MT_TEST(interval__beyond_a_domain_is_the_whole_line))
