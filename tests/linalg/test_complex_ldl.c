/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors of complex symmetric matrices: solutions by their residuals, on both sides of the
 * order up to which they are made by hand; what is singular; the condition. */
#include <float.h>
#include <math.h>

#include "linalg/complex.h"
#include "linalg/ldl.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 40, COLUMNS = 2, RUNS = 400 };

static mt_arena mem;

static double complex random_number(mt_random *g)
{
    const double re = mt_random_in(g, -1.0, 1.0);
    return mt_complex(re, mt_random_in(g, -1.0, 1.0));
}

/* Symmetric; of two `kinds` in three with a small or no diagonal, which takes pivots of order
 * two. */
static void fill(mt_random *g, int n, int kind, double complex *a)
{
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            a[i + (j * n)] = random_number(g);
            a[j + (i * n)] = a[i + (j * n)];
        }
        a[j + (j * n)] *= kind == 0 ? 1.0 : kind == 1 ? 1e-9 : 0.0;
    }
}

/* The largest entry of A x - b, and of |A| |x|. */
static double residual(int n, const double complex *a, const double complex *x,
                       const double complex *b, double *size)
{
    double most = 0.0;
    *size = 0.0;
    for (int i = 0; i < n; i++) {
        double complex sum = -b[i];
        double terms = 0.0;
        for (int j = 0; j < n; j++) {
            sum += a[i + (j * n)] * x[j];
            terms += cabs(a[i + (j * n)]) * cabs(x[j]);
        }
        most = fmax(most, cabs(sum));
        *size = fmax(*size, terms);
    }
    return most;
}

static void complex_ldl__solves_to_rounding(mt_test *t)
{
    /* partial pivoting lets entries grow, seldom by more than this */
    static const double GROWTH = 1e3;
    mt_random g = mt_random_seed(17);
    for (int run = 0; run < RUNS; run++) {
        const int n = 1 + (run % MOST);
        double complex a[MOST * MOST];
        double complex factored[MOST * MOST];
        double complex b[MOST * COLUMNS];
        double complex x[MOST * COLUMNS];
        mt_complex_ldl f;
        mt_arena_clear(&mem);
        fill(&g, n, n == 1 ? 0 : run / MOST % 3, a);
        for (int at = 0; at < n * n; at++) {
            factored[at] = at % n >= at / n ? a[at] : 0.0;
        }
        for (int at = 0; at < n * COLUMNS; at++) {
            b[at] = random_number(&g);
            x[at] = b[at];
        }
        mt_test_row(t, "run %d, order %d", run, n);
        CHECK_INT(t, mt_complex_factor(n, factored, &mem, &f, NULL), MT_OK);
        CHECK(t, !f.singular);
        CHECK_INT(t, mt_complex_solve(&f, COLUMNS, x, NULL), MT_OK);
        for (int c = 0; c < COLUMNS; c++) {
            double size = 0.0;
            const double off =
                residual(n, a, x + ((ptrdiff_t)c * n), b + ((ptrdiff_t)c * n), &size);
            CHECK(t, off <= GROWTH * n * DBL_EPSILON * size);
        }
    }
}

/* Of diag(d) the reciprocal condition is min |d| / max |d|, in sums of both parts. */
static void complex_ldl__estimates_the_condition(mt_test *t)
{
    for (int n = 2; n <= MOST; n += MOST - 2) {
        double complex a[MOST * MOST] = {0.0};
        double rcond = 0.0;
        mt_complex_ldl f;
        mt_arena_clear(&mem);
        for (int i = 0; i < n; i++) {
            a[(ptrdiff_t)i * (n + 1)] = i == 0 ? 8.0 : i == 1 ? mt_complex(0.0, 0.5) : 2.0;
        }
        mt_test_row(t, "order %d", n);
        const double norm = mt_complex_norm(n, a);
        CHECK_INT(t, mt_complex_factor(n, a, &mem, &f, NULL), MT_OK);
        CHECK_INT(t, mt_complex_rcond(&f, norm, &rcond, &mem, NULL), MT_OK);
        CHECK_NEAR(t, rcond, 1.0 / 16.0, 1e-15);
    }
}

static void complex_ldl__says_what_is_singular(mt_test *t)
{
    for (int n = 3; n <= MOST; n += MOST - 3) {
        double complex a[MOST * MOST] = {0.0};
        double rcond = 1.0;
        mt_complex_ldl f;
        mt_arena_clear(&mem);
        for (int i = 0; i < n; i++) {
            a[(ptrdiff_t)i * (n + 1)] = i == 1 ? 0.0 : 1.0;
        }
        mt_test_row(t, "order %d", n);
        const double norm = mt_complex_norm(n, a);
        CHECK_INT(t, mt_complex_factor(n, a, &mem, &f, NULL), MT_OK);
        CHECK(t, f.singular);
        CHECK_INT(t, mt_complex_rcond(&f, norm, &rcond, &mem, NULL), MT_OK);
        CHECK(t, rcond == 0.0);
        a[0] = nan("");
        CHECK_INT(t, mt_complex_factor(n, a, &mem, &f, NULL), MT_E_DOMAIN);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(complex_ldl__solves_to_rounding),
        MT_TEST(complex_ldl__estimates_the_condition),
        MT_TEST(complex_ldl__says_what_is_singular),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
