/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exponentials with closed forms, and the balance of a quadratic form that A itself gives:
 * with P = A^T S + S A the integral of z^T P z is the change of z^T S z. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/exponential.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 12 };

static mt_arena mem;

/* A damped oscillator z = (x, x'), x'' + 2 d x' + w^2 x = 0, w > d. */
static void exponential__a_damped_oscillator_follows_its_formula(mt_test *t)
{
    static const struct {
        double w;
        double d;
        double h;
    } rows[] = {{1.0, 0.0, 0.3},   {1.0, 0.1, 40.0},   {1e6, 0.0, 1e-3}, {1e3, 999.0, 0.01},
                {1e-4, 0.0, 1e-2}, {50.0, 10.0, 1e-9}, {7.0, 1.0, 0.0}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double w = rows[i].w;
        const double d = rows[i].d;
        const double h = rows[i].h;
        const double v = sqrt((w - d) * (w + d));
        const double e = exp(-d * h);
        /* states w x and x' */
        const double a[4] = {0.0, -w, w, -2.0 * d};
        const double want[4] = {e * (cos(v * h) + (d / v * sin(v * h))),
                                -e * w / v * sin(v * h), e * w / v * sin(v * h),
                                e * (cos(v * h) - (d / v * sin(v * h)))};
        mt_exponential x;
        mt_test_row(t, "w %g, d %g, h %g", w, d, h);
        REQUIRE(t, mt_exponential_make(&(mt_exponential_of){2, a, NULL, h}, 3, false, &mem, &x,
                                       NULL) == MT_OK);
        CHECK_INT(t, x.kept, 3);
        /* the phase is known to its rounding, and so is the way through doublings */
        const double tol = 32.0 * DBL_EPSILON * (1.0 + (w * h));
        for (int k = 0; k < 4; k++) {
            const double one = k % 3 == 0 ? 1.0 : 0.0;
            CHECK_NEAR_ABS(t, x.f[0][k] + one, want[k], tol);
        }
        /* small parts have their digits */
        CHECK_NEAR_ABS(t, x.f[0][2], want[2], tol * fmax(fabs(want[2]), w * h * 1e-3));
        double z[2] = {0.25, -0.5};
        double eighths[2] = {0.25, -0.5};
        double work[2];
        mt_exponential_step(&x, 0, z, work);
        for (int k = 0; k < 8; k++) {
            mt_exponential_step(&x, 3, eighths, work);
        }
        CHECK_NEAR_ABS(t, eighths[0], z[0], tol);
        CHECK_NEAR_ABS(t, eighths[1], z[1], tol);
        mt_arena_clear(&mem);
    }
}

/* A chain of derivatives: exp is Taylor's polynomial, to the last digits. */
static void exponential__a_chain_of_integrals_is_a_polynomial(mt_test *t)
{
    enum { N = 7 };
    double a[N * N] = {0.0};
    mt_exponential x;
    const double h = 0.7;
    for (int k = 0; k + 1 < N; k++) {
        a[k + ((k + 1) * N)] = 1.0;
    }
    REQUIRE(t, mt_exponential_make(&(mt_exponential_of){N, a, NULL, h}, 0, true, &mem, &x,
                                   NULL) == MT_OK);
    CHECK(t, x.kept >= 1);
    double term = 1.0;
    for (int k = 1; k < N; k++) {
        term *= h / k;
        for (int i = 0; i + k < N; i++) {
            CHECK_NEAR(t, x.f[0][i + ((i + k) * N)], term, 8.0 * DBL_EPSILON);
        }
    }
    mt_arena_clear(&mem);
}

static void exponential__quadratic_forms_balance(mt_test *t)
{
    mt_random g = mt_random_seed(5);
    for (int i = 0; i < 300; i++) {
        const int n = 1 + mt_random_int(&g, MOST);
        double a[MOST * MOST];
        double s[MOST * MOST];
        double p[MOST * MOST] = {0.0};
        double z[MOST];
        double work[MOST];
        mt_exponential x;
        mt_test_row(t, "case %d, order %d", i, n);
        mt_random_fill(&g, n * n, a);
        mt_random_fill(&g, n * n, s);
        mt_random_fill(&g, n, z);
        mt_symmetrise_lower(n, s);
        /* A^T S + S A is symmetric; a factor keeps what grows in bounds */
        mt_gemm(true, false, n, n, n, 1.0, a, n, s, n, 0.0, p, n);
        mt_gemm(false, false, n, n, n, 1.0, s, n, a, n, 1.0, p, n);
        const double h = pow(10.0, mt_random_in(&g, -4.0, 0.5));
        REQUIRE(t, mt_exponential_make(&(mt_exponential_of){n, a, p, h}, 0, false, &mem, &x,
                                       NULL) == MT_OK);
        mt_gemv(false, n, n, 1.0, s, n, z, 0.0, work);
        const double before = mt_dot(n, z, work);
        const double integral = mt_exponential_integral(&x, 0, z, work);
        const double size = mt_dot(n, z, z);
        mt_exponential_step(&x, 0, z, work);
        mt_gemv(false, n, n, 1.0, s, n, z, 0.0, work);
        CHECK_NEAR_ABS(t, mt_dot(n, z, work) - before, integral,
                       1e-13 * n * (size + mt_dot(n, z, z)));
        mt_arena_clear(&mem);
    }
}

static void exponential__what_is_not_finite_is_refused(mt_test *t)
{
    mt_exponential x;
    CHECK_INT(t,
              mt_exponential_make(&(mt_exponential_of){1, (double[]){nan("")}, NULL, 1.0}, 0,
                                  false, &mem, &x, NULL),
              MT_E_DOMAIN);
    CHECK_INT(t,
              mt_exponential_make(&(mt_exponential_of){1, (double[]){1e40}, NULL, 1.0}, 0,
                                  false, &mem, &x, NULL),
              MT_E_DOMAIN);
    CHECK_INT(t,
              mt_exponential_make(&(mt_exponential_of){1, (double[]){1e4}, NULL, 1.0}, 0, false,
                                  &mem, &x, NULL),
              MT_E_DOMAIN);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(exponential__a_damped_oscillator_follows_its_formula),
             MT_TEST(exponential__a_chain_of_integrals_is_a_polynomial),
             MT_TEST(exponential__quadratic_forms_balance),
             MT_TEST(exponential__what_is_not_finite_is_refused))
