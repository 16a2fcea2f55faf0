/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "expr/interpolant.h"
#include "expr/interval.h"
#include "expr/op.h"
#include "expr_fixture.h"
#include "mt_test.h"

static int below(uint64_t *state, int n)
{
    return (int)(next(state) % (uint64_t)n);
}

/* A number of a random size; now and then one that functions treat specially. */
static double any_number(uint64_t *state)
{
    static const double special[] = {0.0,    1.0,  -1.0, 2.0, 0.5, -3.0, 3.141592653589793,
                                     1e-300, 1e300};
    if (below(state, 4) == 0) {
        return special[below(state, MT_COUNT(special))];
    }
    const double size = exp(12.0 * (uniform(state) - 0.6));
    return (below(state, 2) == 0 ? size : -size) * (0.5 + uniform(state));
}

enum { N_OPS = 8, N_BOXES = 4, N_POINTS = 8 };

typedef struct box {
    double lower[N_PARAMS];
    double upper[N_PARAMS];
} box;

/* points, needles and wide boxes */
static box any_box(uint64_t *state)
{
    static const double widths[] = {0.0, 1e-15, 1e-6, 0.1, 1.0, 10.0};
    box b;
    for (int i = 0; i < N_PARAMS; i++) {
        const double x = any_number(state);
        const double width = widths[below(state, MT_COUNT(widths))] * fmax(fabs(x), 1e-3);
        b.lower[i] = x - width * uniform(state);
        b.upper[i] = fmax(b.lower[i], x + width * uniform(state));
    }
    return b;
}

/* inside, or with some coordinates on the faces */
static void any_point(uint64_t *state, const box *b, double *x)
{
    for (int i = 0; i < N_PARAMS; i++) {
        const int where = below(state, 4);
        const double inner = b->lower[i] + uniform(state) * (b->upper[i] - b->lower[i]);
        x[i] = where == 0 ? b->lower[i] : where == 1 ? b->upper[i] : inner;
        x[i] = fmin(fmax(x[i], b->lower[i]), b->upper[i]);
    }
}

/* A random program: operations on whatever is there already. */
static bool any_program(uint64_t *state, fixture *f)
{
    *f = (fixture){.root = MT_NO_NODE};
    if (mt_arena_init(&f->mem, 0, NULL) != MT_OK ||
        mt_program_init(&f->p, N_PARAMS, &f->mem, NULL) != MT_OK) {
        return false;
    }
    static const double x[] = {-3.0, -1.0, 0.0, 0.5, 4.0, 1e3};
    static const double y[] = {2.0, 1.0, 1.0, -1e-3, 7.0, 7.5};
    mt_interpolant *const curve = mt_arena_alloc(&f->mem, 1, sizeof *curve);
    if (curve == NULL ||
        mt_interpolant_init(curve, "c", MT_COUNT(x), x, y, &f->mem, NULL) != MT_OK) {
        return false;
    }
    for (int i = 0; i < N_PARAMS; i++) {
        (void)mt_program_input(&f->p, i, MT_NO_ADDR);
    }
    for (int i = 0; i < N_OPS; i++) {
        const mt_op op = (mt_op)(MT_OP_NEG + below(state, MT_OP_COUNT - MT_OP_NEG));
        const mt_node a = below(state, f->p.count);
        const mt_node b = below(state, 3) == 0 ? mt_program_const(&f->p, any_number(state))
                                               : below(state, f->p.count);
        if (op == MT_OP_INTERP) {
            (void)mt_program_interp(&f->p, curve, a, MT_NO_ADDR);
        } else if (mt_op_operands(op) == 2) {
            (void)mt_program_binary(&f->p, op, a, b, MT_NO_ADDR);
        } else {
            (void)mt_program_unary(&f->p, op, a, MT_NO_ADDR);
        }
    }
    return mt_program_finish(&f->p, NULL) == MT_OK && fixture_buffers(f);
}

typedef struct tally {
    long values;      /* values compared with an enclosure that says something */
    long derivatives; /* the same for derivatives */
    long missed;      /* of both, how many lay outside */
    mt_op missed_op;  /* the operation of the last such */
} tally;

/* Move the bounds inwards by that part of the width: a sabotage that the test must notice. */
static mt_interval shrunk(double lo, double hi, double part)
{
    const double cut = isfinite(hi - lo) ? part * (hi - lo) : 0.0;
    return (mt_interval){lo + cut, hi - cut};
}

/* Everything that can be evaluated at x: whole, or up to the node that fails. */
static void tally_point(const fixture *f, const double *x, double sabotage, tally *sum)
{
    mt_node bad = f->p.count;
    const mt_status rc = mt_program_gradient(&f->p, x, f->value, f->grad, &bad, NULL);
    const int n = rc == MT_OK ? f->p.count : bad;
    for (int i = 0; i < n; i++) {
        const mt_interval v = shrunk(f->lo[i], f->hi[i], sabotage);
        sum->values += isfinite(v.lo) || isfinite(v.hi);
        if (!mt_interval_has(v, f->value[i])) {
            sum->missed++;
            sum->missed_op = f->p.nodes[i].op;
        }
    }
    /* a value that fails leaves no derivatives at all */
    mt_node bad_value = f->p.count;
    if (mt_program_eval(&f->p, x, f->value, &bad_value, NULL) != MT_OK) {
        return;
    }
    for (int i = 0; i < n * N_PARAMS; i++) {
        const mt_interval d = shrunk(f->dlo[i], f->dhi[i], sabotage);
        sum->derivatives += isfinite(d.lo) || isfinite(d.hi);
        if (!mt_interval_has(d, f->grad[i])) {
            sum->missed++;
            sum->missed_op = f->p.nodes[i / N_PARAMS].op;
        }
    }
}

static tally tally_program(uint64_t seed, double sabotage)
{
    tally sum = {.missed_op = MT_OP_COUNT};
    uint64_t state = seed;
    fixture f;
    if (any_program(&state, &f)) {
        for (int k = 0; k < N_BOXES; k++) {
            const box b = any_box(&state);
            mt_program_interval_gradient(&f.p, b.lower, b.upper, f.lo, f.hi, f.dlo, f.dhi);
            for (int j = 0; j < N_POINTS; j++) {
                double x[N_PARAMS];
                any_point(&state, &b, x);
                tally_point(&f, x, sabotage, &sum);
            }
        }
    }
    fixture_free(&f);
    return sum;
}

static void interval__holds_values_and_derivatives_of_random_programs(mt_test *t)
{
    const uint64_t programs = getenv("MT_TEST_LAUNCHED") != NULL ? 1000 : 20000;
    long values = 0;
    long derivatives = 0;
    for (uint64_t seed = 1; seed <= programs; seed++) {
        const tally sum = tally_program(seed, 0.0);
        values += sum.values;
        derivatives += sum.derivatives;
        if (sum.missed != 0) {
            mt_test_row(t, "seed %d: %s", (int)seed, mt_op_name(sum.missed_op));
            CHECK_INT(t, sum.missed, 0);
        }
    }
    mt_test_row(t, "the test means something");
    CHECK(t, values > 50 * (long)programs);
    CHECK(t, derivatives > 100 * (long)programs);
}

static void interval__that_is_too_narrow_is_noticed(mt_test *t)
{
    long missed = 0;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        missed += tally_program(seed, 1e-3).missed;
    }
    CHECK(t, missed > 1000);
}

#define ALL HUGE_VAL
#define PI  3.14159265358979323846

static const struct {
    const char *text; /* of x and y */
    double x[2];
    double y[2];
    double want[2];
} close_rows[] = {
    {"-x", {1, 2}, {0, 0}, {-2, -1}},
    {"x+y", {1, 2}, {-5, 7}, {-4, 9}},
    {"x-y", {1, 2}, {-5, 7}, {-6, 7}},
    {"x*y", {-1, 2}, {-5, 7}, {-10, 14}},
    {"x*x", {-1, 2}, {0, 0}, {0, 4}},
    {"x^2", {-3, 2}, {0, 0}, {0, 9}},
    {"x^2", {-3, -2}, {0, 0}, {4, 9}},
    {"x^3", {-1, 2}, {0, 0}, {-1, 8}},
    {"x^4", {0, 2}, {0, 0}, {0, 16}},
    {"x^-2", {-4, -2}, {0, 0}, {0.0625, 0.25}},
    {"x^-3", {1, 2}, {0, 0}, {0.125, 1}},
    {"x^-1", {-4, -2}, {0, 0}, {-0.5, -0.25}},
    {"x^-1", {-1, 1}, {0, 0}, {-ALL, ALL}},
    {"x^-2", {0, 1}, {0, 0}, {-ALL, ALL}},
    {"x^0.5", {4, 9}, {0, 0}, {2, 3}},
    {"x^0.5", {0, 9}, {0, 0}, {0, 3}},
    {"x^0.5", {-1, 9}, {0, 0}, {-ALL, ALL}},
    {"x^y", {0.5, 2}, {-1, 2}, {0.25, 4}},
    {"x^y", {0, 2}, {1, 3}, {0, 8}},
    {"x^y", {-2, -1}, {1, 2}, {-ALL, ALL}},
    {"x/y", {1, 2}, {4, 8}, {0.125, 0.5}},
    {"x/y", {-1, 2}, {-4, -2}, {-1, 0.5}},
    {"x/y", {1, 2}, {-1, 1}, {-ALL, ALL}},
    {"x/y", {1, 2}, {0, 1}, {-ALL, ALL}},
    {"0/x", {1, 2}, {0, 0}, {0, 0}},
    {"1/x", {1, ALL}, {0, 0}, {0, 1}},
    {"x/y", {-ALL, -1}, {2, ALL}, {-ALL, 0}},
    {"sqrt(x)", {0, 4}, {0, 0}, {0, 2}},
    {"sqrt(x)", {-1, 4}, {0, 0}, {-ALL, ALL}},
    {"cbrt(x)", {-8, 27}, {0, 0}, {-2, 3}},
    {"exp(x)", {0, 1}, {0, 0}, {1, 2.71828182845904523536}},
    {"exp(x)", {-1000, 1000}, {0, 0}, {0, ALL}},
    {"ln(x)", {1, 2.71828182845904523536}, {0, 0}, {0, 1}},
    {"ln(x)", {0, 1}, {0, 0}, {-ALL, ALL}},
    {"log10(x)", {0.01, 100}, {0, 0}, {-2, 2}},
    {"sin(x)", {0, 7}, {0, 0}, {-1, 1}},
    {"sin(x)", {0, 2}, {0, 0}, {0, 1}},
    {"sin(x)", {-2, 0}, {0, 0}, {-1, 0}},
    {"sin(x)", {2, 4}, {0, 0}, {-0.75680249530792825137, 0.90929742682568169540}},
    {"sin(x)", {0, 0.5}, {0, 0}, {0, 0.47942553860420300027}},
    {"cos(x)", {-1, 2}, {0, 0}, {-0.41614683654714238700, 1}},
    {"cos(x)", {3, 4}, {0, 0}, {-1, -0.65364362086361191464}},
    {"cos(x)", {1, 2}, {0, 0}, {-0.41614683654714238700, 0.54030230586813971740}},
    {"sin(x)", {1e300, 1e301}, {0, 0}, {-1, 1}},
    {"tan(x)", {-0.5, 0.5}, {0, 0}, {-0.54630248984379051326, 0.54630248984379051326}},
    {"tan(x)", {1, 2}, {0, 0}, {-ALL, ALL}},
    {"tan(x)", {2, 4}, {0, 0}, {-2.18503986326151899164, 1.15782128234957758313}},
    {"asin(x)", {-1, 1}, {0, 0}, {-PI / 2, PI / 2}},
    {"asin(x)", {0, 1.5}, {0, 0}, {-ALL, ALL}},
    {"acos(x)", {-1, 1}, {0, 0}, {0, PI}},
    {"atan(x)", {-ALL, ALL}, {0, 0}, {-PI / 2, PI / 2}},
    {"sinh(x)", {-0.69314718055994530942, 0.69314718055994530942}, {0, 0}, {-0.75, 0.75}},
    {"cosh(x)", {-0.69314718055994530942, 0.5}, {0, 0}, {1, 1.25}},
    {"tanh(x)", {-1000, 1000}, {0, 0}, {-1, 1}},
    {"abs(x)", {-3, 2}, {0, 0}, {0, 3}},
    {"abs(x)", {-3, -2}, {0, 0}, {2, 3}},
    {"min(x,y)", {1, 4}, {2, 3}, {1, 3}},
    {"max(x,y)", {1, 4}, {2, 3}, {2, 4}},
    {"hypot(x,y)", {-3, 2}, {4, 4}, {4, 5}},
    {"atan2(y,x)", {1, 2}, {-1, 1}, {-PI / 4, PI / 4}},
    {"atan2(y,x)", {-1, 1}, {1, 2}, {PI / 4, 3 * PI / 4}},
    {"atan2(y,x)", {-1, 1}, {-1, 1}, {-PI, PI}},
    {"atan2(y,x)", {-2, -1}, {0, 1}, {-PI, PI}},
    {"sqrt(x^2+y^2)", {-3, 3}, {-4, 4}, {0, 5}},
};

/* Enclosures are not only safe but close: bounds of one operation, to a few roundings. */
static void interval__of_one_operation_is_close(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(close_rows); i++) {
        mt_test_row(t, "%s, x in [%g, %g], y in [%g, %g]", close_rows[i].text,
                    close_rows[i].x[0], close_rows[i].x[1], close_rows[i].y[0],
                    close_rows[i].y[1]);
        const double lower[N_PARAMS] = {close_rows[i].x[0], close_rows[i].y[0], 0.0, 0.0};
        const double upper[N_PARAMS] = {close_rows[i].x[1], close_rows[i].y[1], 0.0, 0.0};
        fixture f;
        mt_err err;
        if (CHECK(t, fixture_init(&f, close_rows[i].text, &err))) {
            mt_program_interval(&f.p, lower, upper, f.lo, f.hi);
            const double want[2] = {close_rows[i].want[0], close_rows[i].want[1]};
            const double got[2] = {f.lo[f.root], f.hi[f.root]};
            for (int k = 0; k < 2; k++) {
                /* one operation widened by up to 8 ulps, and the rounding of the wanted
                 * number */
                const double tol = 16.0 * DBL_EPSILON * fabs(want[k]) + DBL_MIN;
                CHECK(t, got[k] == want[k] || fabs(got[k] - want[k]) <= tol);
            }
        }
        fixture_free(&f);
    }
}

/* d/dx, where it matters for proofs that something grows with x: the sign. */
static void interval__derivatives_keep_their_sign(mt_test *t)
{
    static const struct {
        const char *text;
        double x[2];
        double want[2];
    } rows[] = {
        {"7*x", {1, 2}, {7, 7}},
        {"x^3", {1, 2}, {3, 12}},
        {"x^3", {0, 2}, {0, 12}},
        {"x^2", {-1, 2}, {-2, 4}},
        {"x*x", {-1, 2}, {-2, 4}},
        {"1/x", {1, 2}, {-1, -0.25}},
        {"1/x", {-1, 2}, {-ALL, ALL}},
        {"sqrt(x)", {1, 4}, {0.25, 0.5}},
        {"sqrt(x)", {0, 4}, {-ALL, ALL}},
        {"abs(x)", {-2, 1}, {-1, 1}},
        {"abs(x)", {0, 1}, {1, 1}},
        {"abs(x)", {-2, -1}, {-1, -1}},
        {"min(2*x, 3*x)", {1, 2}, {2, 3}},
        {"min(x, 5)", {1, 2}, {1, 1}},
        {"max(x, 5)", {1, 2}, {0, 0}},
        {"hypot(x, 0)", {0, 2}, {-1, 1}},
        {"0.25*x^3", {2, 4}, {3, 12}},
        {"x^0", {-1, 1}, {0, 0}},
        {"2^x", {0, 1}, {0.69314718055994530942, 1.38629436111989061883}},
        {"y", {0, 1}, {0, 0}},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s, x in [%g, %g]", rows[i].text, rows[i].x[0], rows[i].x[1]);
        const double lower[N_PARAMS] = {rows[i].x[0], 1.0, 1.0, 1.0};
        const double upper[N_PARAMS] = {rows[i].x[1], 1.0, 1.0, 1.0};
        fixture f;
        mt_err err;
        if (CHECK(t, fixture_init(&f, rows[i].text, &err))) {
            mt_program_interval_gradient(&f.p, lower, upper, f.lo, f.hi, f.dlo, f.dhi);
            const double got[2] = {root_row(&f, f.dlo)[0], root_row(&f, f.dhi)[0]};
            for (int k = 0; k < 2; k++) {
                const double want = rows[i].want[k];
                const double tol = 64.0 * DBL_EPSILON * fabs(want); /* a few operations each */
                CHECK(t, got[k] == want || fabs(got[k] - want) <= tol);
            }
        }
        fixture_free(&f);
    }
}

static void interval__arithmetic_at_the_ends_of_the_range_stays_valid(mt_test *t)
{
    const mt_interval big = {DBL_MAX, DBL_MAX};
    const mt_interval tiny = {DBL_TRUE_MIN, DBL_MIN};
    const mt_interval sum = mt_interval_add(big, big);
    CHECK(t, sum.lo == DBL_MAX && sum.hi == HUGE_VAL);
    const mt_interval product = mt_interval_mul(tiny, tiny);
    CHECK(t, product.lo == 0.0 && product.hi > 0.0);
    const mt_interval quotient = mt_interval_div(tiny, big);
    CHECK(t, quotient.lo == 0.0 && quotient.hi > 0.0);
    const mt_interval all = mt_interval_all();
    CHECK(t, mt_interval_mul(all, (mt_interval){0.0, 0.0}).hi == 0.0);
    const mt_interval third = mt_interval_div((mt_interval){1.0, 1.0}, (mt_interval){3.0, 3.0});
    CHECK(t, third.lo < third.hi && third.hi - third.lo <= 2.0 * DBL_EPSILON);
    const mt_interval half = mt_interval_div((mt_interval){1.0, 1.0}, (mt_interval){2.0, 2.0});
    CHECK(t, half.lo == 0.5 && half.hi == 0.5);
}

MT_TEST_MAIN(MT_TEST(interval__holds_values_and_derivatives_of_random_programs),
             MT_TEST(interval__that_is_too_narrow_is_noticed),
             MT_TEST(interval__of_one_operation_is_close),
             MT_TEST(interval__derivatives_keep_their_sign),
             MT_TEST(interval__arithmetic_at_the_ends_of_the_range_stays_valid))
