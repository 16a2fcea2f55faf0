/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sparse factor of symmetric matrices against dense ones: solutions, inertia, rank, norms.
 * */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 60, RUNS = 300 };

/* Of solutions, relative to |A^-1| |A| eps: growth by 1/THRESHOLD in some steps, sums of MOST.
 * */
static const double ROUNDING = 1e4;
static const double TOL = 1e-11;

static mt_arena mem;

/* A saddle-point matrix of a chain: blocks of `states` coordinates and of `equations` rows of A
 * that couple neighbours, the last equation of the chain doubled where it is to be redundant.
 * */
typedef struct chain {
    int n;
    int equations;
    double a[MOST * MOST]; /* dense */
    mt_envelope e;
    double value[MOST * MOST];
} chain;

static void set(chain *c, int i, int j, double v)
{
    c->a[i + (j * c->n)] = v;
    c->a[j + (i * c->n)] = v;
}

static void seal(chain *c)
{
    const size_t n = (size_t)c->n;
    c->e = (mt_envelope){.n = c->n,
                         .first = mt_arena_int(&mem, n),
                         .last = mt_arena_int(&mem, n),
                         .row = mt_arena_alloc(&mem, n, sizeof(ptrdiff_t))};
    for (int i = 0; i < c->n; i++) {
        c->e.first[i] = i;
        c->e.last[i] = i;
        for (int j = 0; j < c->n; j++) {
            if (c->a[i + (j * c->n)] != 0.0) {
                c->e.first[i] = j < c->e.first[i] ? j : c->e.first[i];
                c->e.last[i] = j > c->e.last[i] ? j : c->e.last[i];
            }
        }
        c->e.row[i] = (ptrdiff_t)c->e.count - c->e.first[i];
        for (int j = c->e.first[i]; j <= i; j++) {
            c->value[c->e.count++] = c->a[i + (j * c->n)];
        }
    }
}

/* One link: its states with each other and with those of the link before, its equations. */
static void add_link(mt_random *g, int at, int states, int rows, chain *c)
{
    const int before = at - states - rows; /* where the link before begins, if there is one */
    for (int i = at; i < at + states; i++) {
        for (int j = rows < states ? before : at; j <= i; j++) {
            if (j >= at || (j >= 0 && j < at - rows)) {
                set(c, i, j, mt_random_in(g, -1.0, 1.0));
            }
        }
    }
    for (int r = at + states; r < at + states + rows; r++) {
        c->equations++;
        for (int j = at; j < at + states; j++) {
            set(c, r, j, mt_random_in(g, -1.0, 1.0));
        }
        for (int j = before; j < at - rows && j >= 0; j++) {
            set(c, r, j, mt_random_in(g, -1.0, 1.0));
        }
    }
}

static void make(mt_random *g, bool redundant, chain *c)
{
    const int states = 2 + mt_random_int(g, 2);
    const int rows = mt_random_int(g, states);
    const int links = 1 + mt_random_int(g, MOST / (states + rows + 1) - 1);
    *c = (chain){.n = links * (states + rows) + (redundant ? 1 : 0)};
    for (int k = 0; k < links; k++) {
        add_link(g, k * (states + rows), states, rows, c);
    }
    /* twice the row before, which has no diagonal */
    for (int j = 0; redundant && j < c->n - 1; j++) {
        const double v = c->a[c->n - 2 + (j * c->n)];
        set(c, c->n - 1, j, rows > 0 ? 2.0 * v : 0.0);
    }
    seal(c);
}

static void ldl__solutions_and_inertia_are_those_of_the_dense_matrix(mt_test *t)
{
    mt_random g = mt_random_seed(7);
    static chain c;
    for (int run = 0; run < RUNS; run++) {
        mt_ldl f;
        double w[MOST];
        double x[MOST];
        double b[MOST];
        double norm = 0.0;
        double exact = 0.0;
        mt_test_row(t, "run %d", run);
        mt_arena_clear(&mem);
        make(&g, false, &c);
        const int n = c.n;
        CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, MOST, &mem, &f, NULL), MT_OK);
        CHECK(t, f.whole);
        CHECK_INT(t, f.rank, n);
        mt_random_fill(&g, n, x);
        mt_gemv(false, n, n, 1.0, c.a, n, x, 0.0, b);
        mt_ldl_solve(&f, b);
        double *const inverse = mt_arena_f64(&mem, (size_t)n, (size_t)n);
        CHECK_INT(t, mt_pinv(n, n, c.a, DBL_EPSILON, inverse, NULL, &mem, NULL), MT_OK);
        for (int j = 0; j < n; j++) {
            double sum = 0.0;
            for (int i = 0; i < n; i++) {
                sum += fabs(inverse[i + (j * n)]);
            }
            exact = fmax(exact, sum);
        }
        for (int i = 0; i < n; i++) {
            CHECK_NEAR_ABS(t, b[i], x[i], ROUNDING * DBL_EPSILON * exact);
        }
        CHECK_INT(t, mt_ldl_inverse_norm(&f, &mem, &norm, NULL), MT_OK);
        CHECK(t, norm <= exact * (1.0 + (ROUNDING * DBL_EPSILON * exact)));
        CHECK(t, norm >= exact / 10.0);
        int negative = 0;
        CHECK_INT(t, mt_eig_sym(n, c.a, w, false, &mem, NULL), MT_OK);
        for (int i = 0; i < n; i++) {
            negative += w[i] < 0.0 ? 1 : 0;
        }
        CHECK_INT(t, f.negative, negative);
    }
}

static void ldl__dependent_rows_give_no_pivot(mt_test *t)
{
    mt_random g = mt_random_seed(8);
    static chain c;
    for (int run = 0; run < RUNS; run++) {
        mt_ldl f;
        double x[MOST];
        double b[MOST];
        double back[MOST];
        double norm = 0.0;
        mt_test_row(t, "run %d", run);
        mt_arena_clear(&mem);
        make(&g, true, &c);
        const int n = c.n;
        CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, MOST, &mem, &f, NULL), MT_OK);
        CHECK_INT(t, f.rank, n - 1);
        CHECK_INT(t, f.n_rest, 1);
        CHECK_INT(t, mt_ldl_inverse_norm(&f, &mem, &norm, NULL), MT_OK);
        CHECK(t, norm == HUGE_VAL);
        mt_random_fill(&g, n, x); /* b in the range: some x with A x = b is found */
        mt_gemv(false, n, n, 1.0, c.a, n, x, 0.0, b);
        memcpy(x, b, sizeof x);
        mt_ldl_solve(&f, x);
        mt_gemv(false, n, n, 1.0, c.a, n, x, 0.0, back);
        const double size = mt_max_abs(n, x);
        for (int i = 0; i < n; i++) {
            CHECK_NEAR_ABS(t, back[i], b[i], 1e-12 * fmax(size, 1.0));
        }
    }
}

/* Two rows that would be a singular pivot of order two while their partner is not yet whole. */
static void ldl__a_singular_pair_waits_for_its_partner(mt_test *t)
{
    static chain c;
    mt_ldl f;
    double x[4] = {1.0, -2.0, 3.0, 0.5};
    double b[4];
    mt_arena_clear(&mem);
    c = (chain){.n = 4};
    set(&c, 0, 0, 0.05);
    set(&c, 0, 1, 0.05);
    set(&c, 1, 1, 0.05);
    set(&c, 0, 2, 1.0);
    set(&c, 1, 2, -1.0);
    set(&c, 2, 2, 0.5);
    set(&c, 2, 3, 1.0);
    set(&c, 3, 3, 1.0);
    seal(&c);
    mt_gemv(false, 4, 4, 1.0, c.a, 4, x, 0.0, b);
    CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, MOST, &mem, &f, NULL), MT_OK);
    CHECK_INT(t, f.rank, 4);
    mt_ldl_solve(&f, b);
    for (int i = 0; i < 4; i++) {
        CHECK_NEAR_ABS(t, b[i], x[i], 1e-13);
    }
}

static void ldl__a_front_that_is_too_small_and_bad_entries_are_told(mt_test *t)
{
    mt_random g = mt_random_seed(9);
    static chain c;
    mt_ldl f;
    mt_arena_clear(&mem);
    do {
        make(&g, false, &c);
    } while (c.n < MOST / 2);
    CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, 2, &mem, &f, NULL), MT_OK);
    CHECK(t, !f.whole);
    c.value[c.e.count / 2] = nan("");
    CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, MOST, &mem, &f, NULL), MT_E_DOMAIN);
    c.e = (mt_envelope){.n = 0};
    CHECK_INT(t, mt_ldl_factor(&c.e, c.value, TOL, MOST, &mem, &f, NULL), MT_OK);
    CHECK(t, f.whole && f.rank == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(ldl__solutions_and_inertia_are_those_of_the_dense_matrix),
        MT_TEST(ldl__dependent_rows_give_no_pivot),
        MT_TEST(ldl__a_singular_pair_waits_for_its_partner),
        MT_TEST(ldl__a_front_that_is_too_small_and_bad_entries_are_told),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
