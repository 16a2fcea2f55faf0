/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 9 };

static const double TOL = 1e-13;

static mt_arena mem;

static void svd__thin_factors_reproduce_the_matrix(mt_test *t)
{
    static const int sizes[][2] = {{5, 3}, {3, 5}, {4, 4}, {1, 7}, {9, 1}, {9, 9}};
    mt_random g = mt_random_seed(2);
    for (int k = 0; k < MT_COUNT(sizes); k++) {
        const int m = sizes[k][0];
        const int n = sizes[k][1];
        const int r = m < n ? m : n;
        double a[MOST * MOST] = {0};
        double copy[MOST * MOST];
        double s[MOST];
        double only[MOST];
        double u[MOST * MOST];
        double vt[MOST * MOST];
        double back[MOST * MOST];
        mt_test_row(t, "%d x %d", m, n);
        mt_random_fill(&g, m * n, a);
        memcpy(copy, a, sizeof a);
        CHECK_INT(t, mt_svd(m, n, copy, s, u, vt, &mem, NULL), MT_OK);
        for (int j = 0; j < r; j++) {
            CHECK(t, s[j] >= 0.0 && (j == 0 || s[j] <= s[j - 1]));
            for (int i = 0; i < m; i++) {
                u[i + j * m] *= s[j];
            }
        }
        mt_gemm(false, false, m, n, r, 1.0, u, m, vt, r, 0.0, back, m);
        for (int i = 0; i < m * n; i++) {
            CHECK_NEAR_ABS(t, back[i], a[i], TOL);
        }
        memcpy(copy, a, sizeof a);
        CHECK_INT(t, mt_svd(m, n, copy, only, NULL, NULL, &mem, NULL), MT_OK);
        for (int j = 0; j < r; j++) {
            CHECK_NEAR_ABS(t, only[j], s[j], TOL);
        }
    }
    CHECK_INT(t, mem.used, 0);
}

/*
 * D C with C = [1 1; 1 -1; ...] well conditioned and D = 1, 1e-10: for the 2 x 2 matrix [1 1; d
 * -d] the rows are orthogonal, so the singular values are sqrt 2 and d sqrt 2 exactly, and so
 * are the right vectors (1, +-1)/sqrt 2.
 */
static void svd__jacobi_keeps_tiny_values_to_full_relative_accuracy(mt_test *t)
{
    static const double scales[] = {1.0, 1e-6, 1e-10, 1e-20, 1e-60};
    for (int k = 0; k < MT_COUNT(scales); k++) {
        const double d = scales[k];
        double a[4] = {1.0, d, 1.0, -d};
        double s[2];
        double v[4];
        mt_test_row(t, "d = %g", d);
        CHECK_INT(t, mt_svd_jacobi(2, 2, a, s, v, &mem, NULL), MT_OK);
        CHECK_NEAR(t, s[0], sqrt(2.0), 8.0 * DBL_EPSILON);
        CHECK_NEAR(t, s[1], d * sqrt(2.0), 8.0 * DBL_EPSILON);
        for (int i = 0; i < 4 && k > 0; i++) {
            CHECK_NEAR(t, fabs(v[i]), sqrt(0.5), 8.0 * DBL_EPSILON);
        }
    }
    double wide[2] = {1.0, 2.0};
    double s[2];
    CHECK_INT(t, mt_svd_jacobi(1, 2, wide, s, NULL, &mem, NULL), MT_E_INTERNAL);
}

/* The four equations of Penrose. */
static void svd__pinv_satisfies_penrose(mt_test *t)
{
    enum { M = 6, N = 4, RANK = 2 };
    mt_random g = mt_random_seed(9);
    double left[M * RANK];
    double right[RANK * N];
    double a[M * N];
    double p[N * M];
    double ap[M * M];
    double pa[N * N];
    double apa[M * N];
    double pap[N * M];
    int rank = 0;
    mt_random_fill(&g, M * RANK, left);
    mt_random_fill(&g, RANK * N, right);
    mt_gemm(false, false, M, N, RANK, 1.0, left, M, right, RANK, 0.0, a, M);
    CHECK_INT(t, mt_pinv(M, N, a, 1e-10, p, &rank, &mem, NULL), MT_OK);
    CHECK_INT(t, rank, RANK);
    mt_gemm(false, false, M, M, N, 1.0, a, M, p, N, 0.0, ap, M);
    mt_gemm(false, false, N, N, M, 1.0, p, N, a, M, 0.0, pa, N);
    mt_gemm(false, false, M, N, M, 1.0, ap, M, a, M, 0.0, apa, M);
    mt_gemm(false, false, N, M, N, 1.0, pa, N, p, N, 0.0, pap, N);
    for (int i = 0; i < M * N; i++) {
        CHECK_NEAR_ABS(t, apa[i], a[i], 10.0 * TOL);
        CHECK_NEAR_ABS(t, pap[i], p[i], 10.0 * TOL);
    }
    for (int i = 0; i < M; i++) {
        for (int j = 0; j < i; j++) {
            CHECK_NEAR_ABS(t, ap[i + j * M], ap[j + i * M], TOL);
            if (i < N) {
                CHECK_NEAR_ABS(t, pa[i + j * N], pa[j + i * N], TOL);
            }
        }
    }
    const double zero[2] = {0.0, 0.0};
    CHECK_INT(t, mt_pinv(1, 2, zero, 1e-10, p, &rank, &mem, NULL), MT_OK);
    CHECK_INT(t, rank, 0);
    CHECK_NEAR(t, fabs(p[0]) + fabs(p[1]), 0.0, 0.0);
}

static void svd__entries_that_are_not_finite_are_errors(mt_test *t)
{
    const double a[4] = {1.0, 0.0, nan(""), 1.0};
    double c[4];
    double s[2];
    memcpy(c, a, sizeof a);
    CHECK_INT(t, mt_svd(2, 2, c, s, NULL, NULL, &mem, NULL), MT_E_DOMAIN);
    memcpy(c, a, sizeof a);
    CHECK_INT(t, mt_svd_jacobi(2, 2, c, s, NULL, &mem, NULL), MT_E_DOMAIN);
    CHECK_INT(t, mt_pinv(2, 2, a, 1e-10, c, NULL, &mem, NULL), MT_E_DOMAIN);
    CHECK_INT(t, mem.used, 0);
}

static void kernels__norms_see_nan_and_products_have_edges(mt_test *t)
{
    const double x[3] = {1.0, nan(""), -5.0};
    CHECK(t, isnan(mt_max_abs(3, x)));
    CHECK(t, isnan(mt_max_abs(2, x)));
    CHECK_NEAR(t, mt_max_abs(1, x), 1.0, 0.0);
    CHECK_NEAR(t, mt_max_abs(0, x), 0.0, 0.0);
    CHECK(t, !mt_all_finite(3, x) && mt_all_finite(1, x) && mt_all_finite(0, x));
    const double huge[1] = {-HUGE_VAL};
    CHECK(t, !mt_all_finite(1, huge));
    double y[2] = {nan(""), 3.0};
    /* an empty sum with beta 0 is 0, whatever y was */
    mt_gemv(false, 2, 0, 1.0, x, 2, x, 0.0, y);
    CHECK_NEAR(t, fabs(y[0]) + fabs(y[1]), 0.0, 0.0);
    double c[4] = {nan(""), nan(""), nan(""), nan("")};
    mt_gemm(false, false, 2, 2, 0, 1.0, x, 2, x, 1, 0.0, c, 2);
    CHECK_NEAR(t, mt_max_abs(4, c), 0.0, 0.0);
    const double a[6] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    double b[6];
    mt_transpose(2, 3, a, b);
    CHECK_NEAR(t, b[1], 3.0, 0.0);
    CHECK_NEAR(t, b[3], 2.0, 0.0);
    CHECK(t, mt_blas_description() != NULL && mt_blas_description()[0] != '\0');
    mt_blas_set_threads(1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(svd__thin_factors_reproduce_the_matrix),
        MT_TEST(svd__jacobi_keeps_tiny_values_to_full_relative_accuracy),
        MT_TEST(svd__pinv_satisfies_penrose),
        MT_TEST(svd__entries_that_are_not_finite_are_errors),
        MT_TEST(kernels__norms_see_nan_and_products_have_edges),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
