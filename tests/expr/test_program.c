/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "expr/op.h"
#include "expr_fixture.h"
#include "mt_alloc.h"
#include "mt_test.h"

static void program__equal_nodes_are_shared(mt_test *t)
{
    mt_arena mem;
    mt_program p;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_program_init(&p, 2, &mem, NULL), MT_OK);
    const mt_node x = mt_program_input(&p, 0, 1);
    const mt_node y = mt_program_input(&p, 1, 2);
    CHECK_INT(t, mt_program_input(&p, 0, 3), x);
    CHECK_INT(t, mt_program_add(&p, x, y), mt_program_add(&p, y, x));
    CHECK_INT(t, mt_program_mul(&p, x, y), mt_program_mul(&p, y, x));
    CHECK(t, mt_program_sub(&p, x, y) != mt_program_sub(&p, y, x));
    CHECK(t, mt_program_div(&p, x, y) != mt_program_div(&p, y, x));
    CHECK_INT(t, mt_program_unary(&p, MT_OP_SIN, x, 4), mt_program_unary(&p, MT_OP_SIN, x, 5));
    CHECK(t, mt_program_unary(&p, MT_OP_SIN, x, 4) != mt_program_unary(&p, MT_OP_COS, x, 4));
    CHECK_INT(t, mt_program_const(&p, 0.1), mt_program_const(&p, 0.1));
    CHECK(t, mt_program_const(&p, 0.1) != mt_program_const(&p, nextafter(0.1, 1.0)));
    mt_arena_free(&mem);
}

static void program__sharing_survives_growth(mt_test *t)
{
    enum { N = 5000 };
    mt_arena mem;
    mt_program p;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_program_init(&p, 1, &mem, NULL), MT_OK);
    const mt_node x = mt_program_input(&p, 0, MT_NO_ADDR);
    mt_node first[N] = {0};
    bool same = true;
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < N; i++) {
            const mt_node c = mt_program_const(&p, 2.0 + i);
            const mt_node product = mt_program_mul(&p, c, x);
            same = same && (round == 0 || product == first[i]);
            first[i] = product;
        }
    }
    CHECK(t, same);
    CHECK_INT(t, p.count, 2 * N + 1);
    mt_arena_free(&mem);
}

static void program__constants_are_folded_and_neutral_operations_dropped(mt_test *t)
{
    static const struct {
        const char *text;
        const char *as; /* must be the same node */
    } rows[] = {
        {"2*pi*3", "6*pi"}, {"sqrt(16)", "4"}, {"x+0", "x"}, {"0+x", "x"},
        {"x-0", "x"},       {"1*x", "x"},      {"x/1", "x"}, {"x^1", "x"},
        {"x*0", "0"},       {"x-x", "0"},      {"x^0", "1"}, {"--x", "x"},
        {"x*(2-1)", "x"},   {"y+x", "x+y"},    {"+x", "x"},  {"pow(x, y)", "x^y"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s = %s", rows[i].text, rows[i].as);
        fixture f;
        mt_expr as;
        mt_err err;
        if (CHECK(t, fixture_init(&f, rows[i].text, &err))) {
            CHECK_INT(t, parse_text(rows[i].as, &f.mem, &as, NULL), MT_OK);
            const mt_node inputs[N_PARAMS] = {0, 1, 2, 3};
            CHECK_INT(t, mt_program_expr(&f.p, &as, inputs, ADDR), f.root);
        }
        fixture_free(&f);
    }
}

static void program__values_that_are_not_finite_are_errors_with_their_address(mt_test *t)
{
    /* at x = 0, y = -3, z = 1e300, k_1 = 1 */
    static const double inputs[N_PARAMS] = {0.0, -3.0, 1e300, 1.0};
    static const struct {
        const char *text;
        const char *want;
    } rows[] = {
        {"1/0", "1 / 0 has no finite value"},
        {"y/x", "-3 / 0 has no finite value"},
        {"0/x", "0 / 0 has no finite value"},
        {"sqrt(y)", "sqrt(-3) has no finite value"},
        {"ln(x)", "ln(0) has no finite value"},
        {"log10(y)", "log10(-3) has no finite value"},
        {"asin(y)", "asin(-3) has no finite value"},
        {"acos(2)", "acos(2) has no finite value"},
        {"y^0.5", "-3 ^ 0.5 has no finite value"},
        {"x^-1", "0 ^ -1 has no finite value"},
        {"z*z", "1e+300 * 1e+300 has no finite value"},
        {"exp(z)", "exp(1e+300) has no finite value"},
        /* unused, and still an error */
        {"1 + 0*ln(y)", "ln(-3) has no finite value"},
        {"(1/0)^0 * x", "1 / 0 has no finite value"},
        {"sqrt(-1) - sqrt(-1)", "sqrt(-1) has no finite value"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        fixture f;
        mt_err err = {.code = MT_OK};
        if (CHECK(t, fixture_init(&f, rows[i].text, &err))) {
            mt_node bad = MT_NO_NODE;
            CHECK_INT(t, mt_program_eval(&f.p, inputs, f.value, &bad, &err), MT_E_DOMAIN);
            CHECK_STR(t, err.text, rows[i].want);
            CHECK(t, bad >= 0 && bad < f.p.count && f.p.nodes[bad].addr == ADDR);
            CHECK_INT(t, mt_program_gradient(&f.p, inputs, f.value, f.grad, NULL, NULL),
                      MT_E_DOMAIN);
        }
        fixture_free(&f);
    }
}

static void program__inputs_that_are_not_finite_are_errors(mt_test *t)
{
    const double inputs[N_PARAMS] = {1.0, nan(""), 1.0, 1.0};
    fixture f;
    mt_err err;
    if (CHECK(t, fixture_init(&f, "x", &err))) {
        mt_node bad = MT_NO_NODE;
        CHECK_INT(t, mt_program_eval(&f.p, inputs, f.value, &bad, &err), MT_E_DOMAIN);
        CHECK_STR(t, err.text, "a parameter has no finite value");
        CHECK_INT(t, bad, 1);
    }
    fixture_free(&f);
}

static void program__knows_what_depends_on_what(mt_test *t)
{
    enum { N = 150 }; /* more than two words of 64 */
    mt_arena mem;
    mt_program p;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_program_init(&p, N, &mem, NULL), MT_OK);
    const mt_node c = mt_program_const(&p, 3.0);
    const mt_node low = mt_program_input(&p, 2, MT_NO_ADDR);
    const mt_node high = mt_program_input(&p, 149, MT_NO_ADDR);
    const mt_node mid = mt_program_mul(&p, c, mt_program_input(&p, 64, MT_NO_ADDR));
    const mt_node sum = mt_program_add(&p, low, mt_program_mul(&p, mid, high));
    const mt_node bad = mt_program_div(&p, c, mt_program_const(&p, 0.0));
    CHECK_INT(t, mt_program_finish(&p, NULL), MT_OK);
    CHECK(t, mt_program_is_constant(&p, c) && mt_program_is_constant(&p, bad));
    CHECK(t, !mt_program_is_constant(&p, low) && !mt_program_is_constant(&p, sum));
    bool depends[N];
    mt_program_depends(&p, sum, depends);
    int right = 0;
    for (int i = 0; i < N; i++) {
        right += depends[i] == (i == 2 || i == 64 || i == 149);
    }
    CHECK_INT(t, right, N);
    mt_program_depends(&p, bad, depends);
    CHECK(t, !depends[0] && !depends[149]);
    CHECK_INT(t, p.n_active, p.count - 3);
    mt_arena_free(&mem);
}

static mt_status build(mt_err *err)
{
    mt_arena mem;
    mt_status rc = mt_arena_init(&mem, 64, err);
    if (rc != MT_OK) {
        return rc;
    }
    mt_program p;
    rc = mt_program_init(&p, 1, &mem, err);
    if (rc == MT_OK) {
        mt_node sum = mt_program_input(&p, 0, MT_NO_ADDR);
        for (int i = 0; i < 200; i++) {
            const mt_node c = mt_program_const(&p, 0.5 + i);
            sum = mt_program_unary(&p, MT_OP_SIN, mt_program_add(&p, sum, c), MT_NO_ADDR);
        }
        rc = mt_program_finish(&p, err);
    }
    mt_arena_free(&mem);
    return rc;
}

static void program__every_failing_allocation_is_reported(mt_test *t)
{
    CHECK_INT(t, build(NULL), MT_OK);
    for (long nth = 0; mt_alloc_works(); nth++) {
        mt_err err = {.code = MT_OK};
        const long before = mt_alloc_live();
        mt_alloc_fail_after(nth);
        const mt_status rc = build(&err);
        mt_alloc_fail_after(-1);
        mt_test_row(t, "allocation %ld fails", nth);
        CHECK_INT(t, mt_alloc_live(), before);
        if (rc == MT_OK) {
            CHECK(t, nth > 5);
            break;
        }
        CHECK_INT(t, rc, MT_E_MEMORY);
        CHECK_INT(t, err.code, MT_E_MEMORY);
    }
}

/* Again: the same bits, whatever design and however far an evaluation went before. */
static void program__does_again_only_what_depends_on_inputs(mt_test *t)
{
    static const char *const texts[] = {
        "sqrt(x*y) + sin(z)^2 * ln(k_1) / atan2(x, y) + 2^3/7 + pi",
        "min(x, y) + max(3, 4)*z - abs(k_1)", "x", "5", "x*x*x*x + hypot(y, 2)"};
    static const double designs[][N_PARAMS] = {{1.0, 2.0, 3.0, 4.0},
                                               {1.5, 2.0, -3.0, 4.5},
                                               {-1.0, 2.0, 3.0, 4.0},
                                               {0.5, 0.25, 2.0, 8.0}};
    for (int i = 0; i < MT_COUNT(texts); i++) {
        fixture f = {.root = 0};
        fixture g = {.root = 0};
        mt_err err;
        if (fixture_init(&f, texts[i], &err) && fixture_init(&g, texts[i], &err) &&
            CHECK_INT(t, mt_program_eval(&g.p, designs[0], g.value, NULL, &err), MT_OK)) {
            const size_t n = (size_t)f.p.count;
            for (int d = 0; d < 2 * MT_COUNT(designs); d++) {
                const double *const at = designs[(3 * d) % MT_COUNT(designs)];
                mt_test_row(t, "%s, design %d", texts[i], d);
                const mt_status rc = mt_program_gradient(&f.p, at, f.value, f.grad, NULL, &err);
                CHECK_INT(t, mt_program_again(&g.p, at, g.value, g.grad, NULL, &err), rc);
                CHECK(t, rc != MT_OK || memcmp(f.value, g.value, n * sizeof *f.value) == 0);
                CHECK(t, rc != MT_OK ||
                             memcmp(f.grad, g.grad, n * N_PARAMS * sizeof *f.grad) == 0);
                CHECK_INT(t, mt_program_again(&g.p, at, g.value, NULL, NULL, &err), rc);
            }
        }
        fixture_free(&g);
        fixture_free(&f);
    }
}

/* z is a number here, x and y vary. */
static mt_node conditional(const char *text, mt_arena *mem, mt_program *p)
{
    mt_expr e;
    mt_node nodes[N_PARAMS];
    if (mt_arena_init(mem, 0, NULL) != MT_OK ||
        mt_program_init(p, N_PARAMS, mem, NULL) != MT_OK ||
        parse_text(text, mem, &e, NULL) != MT_OK) {
        return MT_NO_NODE;
    }
    for (int i = 0; i < N_PARAMS; i++) {
        nodes[i] = i < 2 ? mt_program_input(p, i, ADDR) : mt_program_const(p, 5.0);
    }
    return mt_program_expr(p, &e, nodes, ADDR);
}

static void program__of_a_condition_only_the_chosen_branch_is_there(mt_test *t)
{
    static const double at[N_PARAMS] = {2.0, -3.0, 0.0, 0.0};
    static const double upper[N_PARAMS] = {2.5, -2.0, 0.0, 0.0};
    static const struct {
        const char *text;
        const char *as; /* has value, slopes and enclosures of this */
    } rows[] = {
        {"if(z > 4, x^2*y, sqrt(y))", "x^2*y"},
        {"if(z > 6, ln(y), y*sin(x))", "y*sin(x)"},
        {"if(z == 5 and not z < 0, hypot(x, y), 1/0)", "hypot(x, y)"},
        {"3*if(z < 0 or z > 4, if(z < 5, 1/(z - z), exp(x)), ln(y)) + y", "3*exp(x) + y"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        mt_arena mem;
        mt_program p;
        const mt_node root = conditional(rows[i].text, &mem, &p);
        fixture f;
        mt_err err;
        if (CHECK(t, root != MT_NO_NODE && mt_program_finish(&p, NULL) == MT_OK) &&
            CHECK(t, fixture_init(&f, rows[i].as, &err))) {
            const size_t n = (size_t)p.count;
            double *const v = mt_arena_f64(&mem, n, 3);
            double *const d = mt_arena_f64(&mem, n * N_PARAMS, 3);
            double *const dlo = d + n * N_PARAMS;
            double *const dhi = dlo + n * N_PARAMS;
            CHECK_INT(t, mt_program_gradient(&p, at, v, d, NULL, &err), MT_OK);
            CHECK_INT(t, mt_program_gradient(&f.p, at, f.value, f.grad, NULL, &err), MT_OK);
            mt_program_interval_gradient(&p, at, upper, v + n, v + 2 * n, dlo, dhi);
            mt_program_interval_gradient(&f.p, at, upper, f.lo, f.hi, f.dlo, f.dhi);
            CHECK(t, v[root] == f.value[f.root]);
            CHECK(t, v[n + (size_t)root] == f.lo[f.root]);
            CHECK(t, v[2 * n + (size_t)root] == f.hi[f.root]);
            for (int k = 0; k < N_PARAMS; k++) {
                const ptrdiff_t own = (ptrdiff_t)root * N_PARAMS + k;
                CHECK(t, d[own] == root_row(&f, f.grad)[k]);
                CHECK(t, dlo[own] == root_row(&f, f.dlo)[k]);
                CHECK(t, dhi[own] == root_row(&f, f.dhi)[k]);
            }
            fixture_free(&f);
        }
        mt_arena_free(&mem);
    }
}

static void program__a_condition_of_inputs_is_refused(mt_test *t)
{
    static const struct {
        const char *text;
        int input; /* -1: decided */
    } rows[] = {
        {"if(x > 1, 1, 2)", 0},
        {"if(2 > 1, 1, if(y < 3, 1, 2))", -1},
        {"if(2 < 1, 1, if(y < 3, 1, 2))", 1},
        {"if(z > 1 or sin(y) == 0, 1, 2)", 1},
        {"if(x - x == 0, 1, 2)", -1},
        {"if(if(z > 1, z, x) > 2, x, y)", -1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].text);
        mt_arena mem;
        mt_program p;
        mt_err err = {.code = MT_OK};
        CHECK(t, conditional(rows[i].text, &mem, &p) != MT_NO_NODE);
        CHECK_INT(t, mt_program_finish(&p, &err), rows[i].input < 0 ? MT_OK : MT_E_INPUT);
        CHECK(t, p.undecided == (rows[i].input >= 0));
        if (p.undecided) {
            CHECK_INT(t, p.undecided_addr, ADDR);
            CHECK_INT(t, p.undecided_input, rows[i].input);
            CHECK(t, strstr(err.text, "condition of an if()") != NULL);
        }
        mt_arena_free(&mem);
    }
}

/* 1/0 > 2 is neither true nor false. */
static void program__a_condition_without_a_value_is_an_error(mt_test *t)
{
    double value = 0.0;
    mt_arena mem;
    mt_program p;
    mt_expr e;
    mt_err err = {.code = MT_OK};
    double at[N_PARAMS] = {1.0, 1.0, 1.0, 1.0};
    double all[16];
    CHECK(t, conditional("if(1/0 > 2, x, y)", &mem, &p) != MT_NO_NODE);
    CHECK_INT(t, mt_program_finish(&p, &err), MT_OK);
    REQUIRE(t, p.count <= MT_COUNT(all));
    CHECK_INT(t, mt_program_eval(&p, at, all, NULL, &err), MT_E_DOMAIN);
    CHECK_STR(t, err.text, "1 / 0 has no finite value");
    REQUIRE(t, parse_text("if(1/0 > 2, 3, 4)", &mem, &e, &err) == MT_OK);
    CHECK(t, mt_expr_is_constant(&e, &value) && isnan(value));
    REQUIRE(t, parse_text("if(1 > 2, 1/0, 4)", &mem, &e, &err) == MT_OK);
    CHECK(t, mt_expr_is_constant(&e, &value) && value == 4.0);
    REQUIRE(t, parse_text("if(1 < 2, 3, x)", &mem, &e, &err) == MT_OK);
    CHECK(t, !mt_expr_is_constant(&e, &value));
    mt_arena_free(&mem);
}

static void program__evaluation_allocates_nothing(mt_test *t)
{
    const double inputs[N_PARAMS] = {1.0, 2.0, 3.0, 4.0};
    const double upper[N_PARAMS] = {1.5, 2.5, 3.5, 4.5};
    fixture f;
    mt_err err;
    if (CHECK(t, fixture_init(&f, "sqrt(x*y) + sin(z)^2 * ln(k_1) / atan2(x, y)", &err))) {
        const long before = mt_alloc_count();
        const mt_status rc = mt_program_gradient(&f.p, inputs, f.value, f.grad, NULL, &err);
        mt_program_interval_gradient(&f.p, inputs, upper, f.lo, f.hi, f.dlo, f.dhi);
        CHECK_INT(t, mt_alloc_count(), before);
        CHECK_INT(t, rc, MT_OK);
    }
    fixture_free(&f);
}

MT_TEST_MAIN(MT_TEST(program__equal_nodes_are_shared),
             MT_TEST(program__sharing_survives_growth),
             MT_TEST(program__constants_are_folded_and_neutral_operations_dropped),
             MT_TEST(program__values_that_are_not_finite_are_errors_with_their_address),
             MT_TEST(program__inputs_that_are_not_finite_are_errors),
             MT_TEST(program__knows_what_depends_on_what),
             MT_TEST(program__every_failing_allocation_is_reported),
             MT_TEST(program__does_again_only_what_depends_on_inputs),
             MT_TEST(program__of_a_condition_only_the_chosen_branch_is_there),
             MT_TEST(program__a_condition_of_inputs_is_refused),
             MT_TEST(program__a_condition_without_a_value_is_an_error),
             MT_TEST(program__evaluation_allocates_nothing))
